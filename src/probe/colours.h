/*
   Coloured probing: a step reaches a few cells, so unknowns whose particles are farther apart than twice that are probed
   in one call. The number of calls does not grow with the number of particles.
*/
#pragma once
#include "probe/probe.h"

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
   MpmProbeMatrix - the operator as a parallel AIJ matrix, with perturbations of a size. Where a response leaks, it begins
   again with a larger reach.

   Collective: the ranks share the colours.
*/
PetscErrorCode MpmProbeMatrix(MpmProbe *probe, PetscReal size, MpmProbeColours *colours, Mat *A);
