/*
   The operator of all particles. Coloured probing: a step reaches a few cells, so unknowns whose particles are farther
   apart than twice that are probed in one call, and the number of calls does not grow with the number of particles. A
   step that reaches the whole domain, as an implicit one does, or particles that do not say where they are: its columns
   are probed one by one, or it is a shell whose product is two calls.
*/
#pragma once
#include "probe/probe.h"

/*
   MpmProbeEach - the responses to perturbations 0 <= j < total, which the ranks share. perturb makes one of up to most
   unknowns, or leaves it empty, so that nothing is asked; take takes its response.

   Collective.
*/
typedef PetscErrorCode (*MpmProbePerturb)(void *context, PetscInt j, MpmPerturbation *perturbation);
typedef PetscErrorCode (*MpmProbeTake)(void *context, PetscInt j, const MpmPerturbation *perturbation);
PetscErrorCode MpmProbeEach(MpmProbe *probe, PetscInt total, PetscInt64 most, MpmProbePerturb perturb,
                            MpmProbeTake take, void *context);

/*S
   MpmProbeColours - how a base state is coloured.

   reach   - the largest distance, in cells, over which a particle's perturbation is felt, in each direction
   colours - the number of groups of unknowns; a group is probed in one call
   everywhere - a particle's perturbation is felt in all cells, so that nothing can be probed together
   leaks   - the largest response that no unknown of a group can have made, over the largest response: 0 when reach is
             right
S*/
typedef struct {
  PetscInt  reach[MPM_MAX_DIM], colours;
  PetscBool everywhere;
  PetscReal leaks;
} MpmProbeColours;

/*
   MpmProbeReach - finds the reach by probing one particle, and the number of colours.

   Collective. The base state must have places or cells.
*/
PetscErrorCode MpmProbeReach(MpmProbe *probe, MpmProbeColours *colours);

/*
   MpmProbeMatrix - the operator as a parallel AIJ matrix, whose diagonal is all there. Where a response leaks, it
   begins again with a larger reach. colours: NULL: columns are probed one by one.
   MpmProbeShell - the operator as a MATSHELL with the product A x, and no transposed one. It is of no use after the
   probe is destroyed. Its infinity norm is a lower bound: the largest number that it makes of a few vectors of ones
   with random signs.

   Collective. The ranks share the calls; of a shell the first rank alone asks its code. size: of perturbations; a
   vector is scaled so that its largest number is that.
*/
PetscErrorCode MpmProbeMatrix(MpmProbe *probe, PetscReal size, MpmProbeColours *colours, Mat *A);
PetscErrorCode MpmProbeShell(MpmProbe *probe, PetscReal size, Mat *A);

/* Collective. A lower bound of norm(one - other): the largest that a few random vectors show. */
PetscErrorCode MpmProbeShellDistance(Mat one, Mat other, PetscReal *distance);

/*
   MpmProbeNewMatrix - a matrix without numbers, whose rows of a particle, width of them, are on one rank. most: numbers
   of a row that there is memory for; those that are 0 are left out. 0: memory is found as it is needed.
   MpmProbeFillDiagonal - ends its assembly with a 0 where the diagonal has nothing, which solvers need.

   Collective.
*/
PetscErrorCode MpmProbeNewMatrix(const MpmStepper *stepper, PetscInt width, PetscInt most, Mat *A);
PetscErrorCode MpmProbeFillDiagonal(Mat A);
