/*
   Probing without places: the operator of a step that reaches the whole domain, as an implicit one does, or of particles
   that do not say where they are. Its columns are probed one by one, or it is a shell whose product is two calls.
*/
#pragma once
#include "probe/probe.h"

/*
   MpmProbeColumns - the operator as a parallel AIJ matrix. Every entry of its diagonal is there.
   MpmProbeShell - the operator as a MATSHELL with the product A x, and no transposed one. It is of no use after the probe is
   destroyed. Its infinity norm is a lower bound: the largest number that it makes of a few vectors of ones with random
   signs.

   Collective. The ranks share the columns; of a shell the first rank alone asks its code. size: of perturbations; a vector
   is scaled so that its largest number is that.
*/
PetscErrorCode MpmProbeColumns(MpmProbe *probe, PetscReal size, Mat *A);
PetscErrorCode MpmProbeShell(MpmProbe *probe, PetscReal size, Mat *A);

/* Collective. A lower bound of norm(one - other): the largest that a few random vectors show. */
PetscErrorCode MpmProbeShellDistance(Mat one, Mat other, PetscReal *distance);

/*
   MpmProbeNewMatrix - a matrix without numbers, whose rows of a particle, width of them, are on one rank. most: numbers of a row
   that there is memory for; those that are 0 are left out. 0: memory is found as it is needed.
   MpmProbeFillDiagonal - ends its assembly with a 0 where the diagonal has nothing, which solvers need.

   Collective.
*/
PetscErrorCode MpmProbeNewMatrix(const MpmStepper *stepper, PetscInt width, PetscInt most, Mat *A);
PetscErrorCode MpmProbeFillDiagonal(Mat A);
