/* A lattice of particles at one place in the grid and one set of phases: its nodal operator and what that says. */
#pragma once
#include "operator/nodal.h"
#include <mpmstab/critical.h>

/*E
   MpmPatchEnd - how a lattice is in a direction: it has no end, begins at a free surface, or is a single particle.
E*/
typedef enum { MPM_PATCH_ENDLESS, MPM_PATCH_SURFACE, MPM_PATCH_SINGLE } MpmPatchEnd;

/*S
   MpmPatchSpot - a place of the lattice and its phases. The first particle is at (j + t) / ppc in its cell, 0 <= j < ppc
   and 0 <= t < 1, in each direction: with j apart, t near 0 or 1 is exact. beta counts where there is no end.
S*/
typedef struct {
  PetscInt  j[MPM_MAX_DIM];
  PetscReal t[MPM_MAX_DIM], beta[MPM_MAX_DIM];
} MpmPatchSpot;

/*S
   MpmPatchLattice - what all spots of a lattice share.

   end   - in each direction
   depth - the number of cells behind a surface
   held  - the nodes of the first half of them are held too: what is left has no surface
   count - the number of limits and growths computed
S*/
typedef struct {
  const MpmCriticalCase *of;
  const MpmNodalPlan    *plan;
  MpmPatchEnd            end[MPM_MAX_DIM];
  PetscInt               depth;
  PetscBool              held;
  PetscInt64             count;
} MpmPatchLattice;

/* Not collective. The plan of a scheme's table without the walls that its grid may have. */
PetscErrorCode MpmPatchPlanCreate(const MpmScheme *scheme, MpmNodalPlan **plan);

/*
   MpmPatchOperator - the nodal operator of a spot as a polynomial (see MpmNodalRun), in units in which a node's value is
   multiplied by the root of its mass.

   Not collective. coefficient: room for pointers to plan->degree + 1 matrices of order n; free each with PetscFree.
   unseen: the largest abs of the eigenvalues that are left out, those of nodal fields that a lone particle neither reads
   nor gives; 0 where there are none. They are not -1.

   Behind a surface the nodes beyond depth are held: their values are 0. On them nothing happens that could grow, and
   for apic with equal maps there and back the limit comes from above as depth grows, since the quotient that has it is
   largest over fewer nodal fields. With pic it may come from below. Waves of a gas may gain at each reflection, so that
   a shallow lattice grows and a deep one does not. A held end may even have a mode of its own: held shows it. A second
   surface there would have its own limit.
*/
PetscErrorCode MpmPatchOperator(const MpmPatchLattice *lattice, const MpmPatchSpot *spot, PetscInt *n,
                                double complex *coefficient[], PetscReal *unseen);

/*
   MpmPatchCrossing - the least Courant number at which an eigenvalue of a spot is -1; infinite where there is none.
   MpmPatchGrowth   - the largest abs of its eigenvalues at a Courant number. rounding: the growth that rounding may make
                      of a defective pair there (see MpmDefectiveErrorOf); it is large for a node that has hardly any
                      mass.

   Not collective.
*/
PetscErrorCode MpmPatchCrossing(MpmPatchLattice *lattice, const MpmPatchSpot *spot, PetscReal *courant);
PetscErrorCode MpmPatchGrowth(MpmPatchLattice *lattice, const MpmPatchSpot *spot, PetscReal courant, PetscReal *growth,
                              PetscReal *rounding);
