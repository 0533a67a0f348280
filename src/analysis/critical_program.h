/* The largest stable time step of a code that is probed, in the code's own unit of time. */
#pragma once
#include "analysis/carriers.h"
#include "analysis/program.h"

/*E
   MpmProgramLimitKind - whose limit it is.

     MPM_LIMIT_INTERIOR - of the cells of a lattice without an edge
     MPM_LIMIT_BLOCK    - of 6 cells in each direction that are cut from the lattice and surrounded by nothing
     MPM_LIMIT_LONE     - of a particle alone, at the place in a cell at which it is least
     MPM_LIMIT_STATE    - of the particles that were described
E*/
typedef enum {
  MPM_LIMIT_INTERIOR,
  MPM_LIMIT_BLOCK,
  MPM_LIMIT_LONE,
  MPM_LIMIT_STATE,
  MPM_LIMIT_KINDS
} MpmProgramLimitKind;
extern const char *const MpmProgramLimitNames[];

/*S
   MpmCriticalProgram - the limits that were found.

   name      - of the parameter that is the time step; given: its value at the start, and finding: the verdict on it
   limit     - of each kind; NaN: not sought. 0: unstable at the smallest step that was tried, infinite: stable at the
               largest
   critical  - the least limit; NaN where a certificate fails, and why says which
   probes    - the operators that were built; calls: on the first rank
   beta, dim - the phase of the wave that limits the interior
   carriers  - the particles that carry the mode which limits the state
S*/
typedef struct {
  const char *name;
  PetscReal   given, limit[MPM_LIMIT_KINDS], critical, beta[MPM_MAX_DIM];
  MpmFinding  finding;
  const char *why;
  PetscInt    probes, dim;
  PetscInt64  calls;
  MpmCarriers carriers;
} MpmCriticalProgram;

/*
   MpmCriticalProgramFind - finds the limits by bisection, after doubling or halving the time step that the code came with.
   Steps below each limit are tried too, so that it is the first one.

   Collective. The program must have been opened, and not be prepared; afterwards it is prepared for the time step that it
   came with, with its certificates. Errors: PETSC_ERR_USER_INPUT when the code has no such parameter, or fails.
*/
PetscErrorCode MpmCriticalProgramFind(MpmProgram *program, PetscReal started, MpmCriticalProgram *critical);
