/* Ensemble: finds which share of random layouts is unstable. */
#pragma once
#include "scene/request.h"

/*S
   MpmEnsemble - the result of the task ensemble: n layouts that differ only in their seed. The first seed is
   scene->layout.seed; the others follow it.

   growth (per step), uncertainty and verdict of each layout are in the order of seeds, on every rank. share is unstable
   / n. interval holds the share among all seeds with 95% confidence, whichever way the undecided layouts would turn
   out. growth_min, growth_median and growth_max are over the layouts whose growth is known, and NaN when there is none;
   worst_seed has the largest. order is that of each layout's operator, nodal that of the nodes' own, which has its
   eigenvalues, or 0 where that is not used. finding is unstable when any layout is, and stable when all are.
S*/
typedef struct {
  const MpmScene   *scene;
  const MpmRequest *request;
  PetscInt          n, unstable, undecided, order, nodal;
  PetscReal        *growth, *uncertainty;
  PetscInt         *verdict; /* an MpmVerdict for each layout */
  PetscReal         share, interval[2], growth_min, growth_median, growth_max, seconds;
  PetscInt64        worst_seed;
  MpmFinding        finding;
} MpmEnsemble;

/*
   MpmEnsembleCreate - finds all eigenvalues of the operator of one step (or one period) of each layout.

   Collective on PETSC_COMM_WORLD, with SLEPc initialized. Each layout is solved by one rank alone (see farm.h), so that
   nothing depends on the number of ranks. Refuses scenes without jitter, too many unknowns, seeds out of range, and
   whatever an operator or a march refuses, all of it before the first layout is solved.

   The verdict on a layout is that of the task spectrum. It is undecided where the condition number of the eigenvalue
   shows that rounding may have changed the verdict, where the operator is not what the march does, or where LAPACK did
   not converge.
*/
PetscErrorCode MpmEnsembleCreate(const MpmScene *scene, const MpmRequest *request, MpmEnsemble **ensemble);
PetscErrorCode MpmEnsembleDestroy(MpmEnsemble **ensemble);

/*
   MpmWilson - the interval that holds a probability with 95% confidence when an event has occurred in hits of n trials.

   Not collective. With p = hits / n and z = 1.96 its ends are

     (p + z^2 / 2n +- z sqrt(p (1 - p) / n + z^2 / 4n^2)) / (1 + z^2 / n)

   Source: Wilson 1927, Probable Inference, the Law of Succession, and Statistical Inference, J. Am. Stat. Assoc. 22.
*/
void MpmWilson(PetscInt hits, PetscInt trials, PetscReal interval[2]);
