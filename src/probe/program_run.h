/* Growth by running a code: measured, where its operator proves nothing. */
#pragma once
#include "probe/program.h"

/*S
   MpmProgramRun - what was measured.

   steps, perturbations - that were run. Perturbations are random, of all unknowns, and beside the base state. After each request they
                  are scaled to their first size, so that they stay small
   growth       - per step, over the second half of the run: the mean of the perturbations; low, high: limits around it: Student's t for 95%, and
                  what the two last quarters differ by
   factor       - by which they have grown in that half. Growth that is linear in time makes it 2
   ended        - the code had no answer to more steps
S*/
typedef struct {
  PetscInt  steps, perturbations;
  PetscReal growth, low, high, factor;
  PetscBool ended;
} MpmProgramRun;

/*
   MpmProgramRunFind - runs a code for about so many steps, and judges: growth by a factor that only an exponential makes is
   unstable, all else is undecided, since a run does not prove that nothing grows.

   Collective; the first rank runs it. The program must be prepared. Errors: PETSC_ERR_USER_INPUT when the code fails in the first steps.
*/
PetscErrorCode MpmProgramRunFind(MpmProgram *program, PetscInt steps, MpmProgramRun *run, MpmFinding *finding);
