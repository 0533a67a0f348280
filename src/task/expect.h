/* Compares what a scene expects with what came out. */
#pragma once
#include "analysis/run.h"

/*
   Collective. Print each expectation that is missed and add to their number: of a run; of the verdict and growth of a
   computed spectrum or symbol; of one number.
*/
PetscErrorCode MpmExpectRun(const MpmRun *run, PetscInt *missed);
PetscErrorCode MpmExpectFinding(const MpmExpect *expect, const MpmFinding *finding, PetscInt *missed);
PetscErrorCode MpmExpectNumber(const MpmExpect *expect, MpmExpected which, PetscReal value, PetscInt *missed);
