/*
   Stencils: the nodes of a few particles at a time, with their weights and slopes side by side, for those who go through all
   particles and sum over their nodes.
*/
#pragma once
#include "march/march_private.h"
#include "march/slopes.h"

#define MPM_STENCILS 16

/*S
   MpmStencils - up to MPM_STENCILS particles that follow one another: begin to begin + n - 1 of this rank. Particle q of them has
   weight S[i MPM_STENCILS + q] at its i-th node, MpmStencilsNode(s, i, q) of a local array, and slope
   g[((i comps + c) dim + b) MPM_STENCILS + q] of component c there. Away from walls all components have the same, and comps is 1.
   Where n is less, the other numbers are of use to nobody.

   slopes, memory - of particles near walls
   whole, part, cell, xi - where particles are
S*/
typedef struct {
  MpmMarch  *march;
  MpmSlopes  slopes;
  PetscInt   dim, begin, n, nodes, comps, step, *node, *offset;
  PetscReal *S, *g, *memory;
  PetscInt   whole[MPM_MAX_DIM], *cell[MPM_MAX_DIM];
  PetscReal  part[MPM_MAX_DIM], *xi[MPM_MAX_DIM];
} MpmStencils;

static inline PetscInt MpmStencilsNode(const MpmStencils *s, PetscInt i, PetscInt q)
{
  return s->node[i * s->step + q] + s->offset[i];
}

/*
   MpmStencilsCreate - of a march's particles at their present places; the march must not change meanwhile.
   MpmStencilsNext   - the next particles; false: there are no more, and the next call begins anew.

   Not collective.
*/
PetscErrorCode MpmStencilsCreate(MpmMarch *march, MpmStencils *stencils);
PetscErrorCode MpmStencilsDestroy(MpmStencils *stencils);
PetscBool      MpmStencilsNext(MpmStencils *stencils);
