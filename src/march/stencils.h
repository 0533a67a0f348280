/*
   The nodes of a particle with its weights and their slopes, for those who make matrices and bounds of them; and
   stencils: those of a few particles side by side, for those who go through all particles and sum over their nodes.
*/
#pragma once
#include "march/march_private.h"

/*S
   MpmSlopes - how the slopes of a vector's components are found. Beyond walls nodes stand for their images, with the
   sign of the component, and a component that a wall fixes has no slope there.

   kind   - the kind of operation that has the slopes, one of GRAD, DIV, GRAD_MLS and DIV_MLS; those of DIV are found
            faster
   parity - parity[c]: of component c
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmBasis  *basis;
  const MpmGrid   *grid;
  MpmOpKind        kind;
  const MpmParity (*parity)[MPM_MAX_DIM];
} MpmSlopes;

/* Not collective. Whether a component of a vector is fixed at a node, which at[] has in the grid. */
PetscBool MpmSlopesFix(const MpmSlopes *slopes, PetscInt component, const PetscInt at[]);

#define MPM_STENCILS 16

/*S
   MpmStencils - up to MPM_STENCILS particles that follow one another: begin to begin + n - 1 of this rank. Particle q has
   weight S[i MPM_STENCILS + q] at its i-th node, node[i MPM_STENCILS + q] of a local array, and slope
   g[((i components + c) dim + b) MPM_STENCILS + q] of component c there. Where n is less, the others are as particle 0 or
   have no weights.

   nodes  - the most nodes of a particle; where one has fewer, the rest has no weights
   inside - the particles are away from walls, where no node is there twice
   components - 1 there, where all components have the same slopes; else dim
   all, memory - no particle is near a wall; of particles near walls
   at     - the particles and nodes, which nobody else may get meanwhile
S*/
typedef struct {
  MpmMarch      *march;
  MpmMarchArrays at;
  MpmSlopes      slopes;
  PetscInt       dim, begin, n, nodes, components, *node;
  PetscBool      inside, all;
  PetscReal     *S, *g, *memory;
} MpmStencils;

/*
   MpmStencilsCreate - of a march's particles at the places of a step; the march must not change meanwhile.
   MpmStencilsNext   - the next particles; false: there are no more, and the next call begins anew.

   Not collective.
*/
PetscErrorCode MpmStencilsCreate(MpmMarch *march, PetscInt64 step, MpmStencils *stencils);
PetscErrorCode MpmStencilsDestroy(MpmStencils *stencils);
PetscBool      MpmStencilsNext(MpmStencils *stencils);
