/* The largest stable time step of a code that is probed, in the code's own unit of time. */
#pragma once
#include "probe/motion.h"
#include "probe/program_growth.h"

/*E
   MpmProgramLimitKind - whose limit it is.

     MPM_LIMIT_INTERIOR - of the cells of a lattice without an edge
     MPM_LIMIT_BLOCK    - of some cells in each direction that are cut from the lattice and surrounded by nothing
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
   expected  - the calls that it was going to take, about
   beta, dim - the phase of the wave that limits the interior
   apart     - the columns of the free block where it was left out, since it would be probed at each time step; else 0
   parts     - a free block and a lone particle are sought, too
   block     - cells of the free block in each direction; site: of the lone particle with the least limit
   motion    - along which the particles are set, of which the interior alone is sought; NULL: they are at rest
   least     - the kind with the least limit, or MPM_NONE; carriers: the particles that carry its mode, unless it is the
               interior
S*/
typedef struct {
  const char *name;
  PetscReal   given, limit[MPM_LIMIT_KINDS], critical, beta[MPM_MAX_DIM];
  MpmFinding  finding;
  const char *why;
  PetscInt    probes, dim, block, site, least, apart;
  PetscInt64  calls, expected;
  MpmMotion  *motion;
  PetscBool   parts;
  MpmCarriers carriers;
} MpmCriticalProgram;

/*
   MpmCriticalProgramBegin - looks at the code, and says how many calls the search will take. MpmCriticalProgramFind
   finds the limits: growth at a few time steps tells where they are. Steps below each limit are tried too, so that it
   is the first one.

   Collective. The program must have been opened, and not be prepared; MpmCriticalProgramBegin prepares it. Afterwards
   it is prepared for the time step that it came with, with its certificates. Errors: PETSC_ERR_USER_INPUT when the code
   has no such parameter, or fails.
*/
PetscErrorCode MpmCriticalProgramBegin(MpmProgram *program, MpmCriticalProgram *critical);
PetscErrorCode MpmCriticalProgramFind(MpmProgram *program, PetscReal started, MpmCriticalProgram *critical);
PetscErrorCode MpmCriticalProgramDestroy(MpmCriticalProgram *critical);
