/*
   Probe: the one-step operator of a code, built from the steps of a stepper. A column is a central difference,

     A e_j = (F(q + s e_j) - F(q - s e_j)) / (2 s)    with F the step and q the base state,

   divided by the perturbation as the code's own arithmetic has rounded it. Unknowns are numbered particle by particle,
   fields in the order described, and are in units of the fields' scales, so that A and its error do not depend on the
   code's units.
*/
#pragma once
#include "operator/stepper.h"
#include <petscmat.h>

/*S
   MpmProbe - a base state and how it is perturbed.

   steps   - of one application: after them every particle has moved by the same whole number of cells
   shift   - that number in each direction; 0 at rest
   single  - the code computes in single precision: everything that it gives is a float
   near    - places that differ by less, in cell widths, are the same
   scale   - for each number of a particle what a change of order 1 means
   size, other - the two sizes of perturbations, in scales
   bends   - how much the response to a random perturbation depends on its size, relative to it; where nothing switches
             it is small; bends_at: the unknown of which that is so
   rest    - the state after steps from the base
   moved   - the largest change of a number in an application to the base, over its scale, without the shift: 0 in
             equilibrium; moved_at: its unknown
S*/
typedef struct {
  MpmStepper *stepper;
  PetscInt    steps, shift[MPM_MAX_DIM];
  PetscBool   single;
  PetscReal  *scale, near, size, other, bends, *rest, moved;
  PetscInt64  bends_at, moved_at;
} MpmProbe;

/*
   MpmProbeCreate - finds the scales. MpmProbeBegin steps the base state, and finds out how to perturb it.

   Collective. longest: the largest number of steps after which particles may have the same places in cells again.
*/
PetscErrorCode MpmProbeCreate(MpmStepper *stepper, MpmProbe *probe);
PetscErrorCode MpmProbeBegin(MpmProbe *probe, PetscInt longest);
PetscErrorCode MpmProbeDestroy(MpmProbe *probe);

/* Not collective. Takes precision and sizes from another probe, before MpmProbeBegin, which then does not look for them. */
void MpmProbeSizesOf(MpmProbe *probe, const MpmProbe *other);

/*
   MpmProbeRespond - the response to a perturbation: (F(q + d) - F(q - d)) / 2, in scales. d is amount[i] scales of
   unknown[i], which must be different ones; amount[i] is replaced by what the code's arithmetic makes of it.

   Not collective. response: particles x width numbers. forward: F(q + d) - F(q) instead.
*/
PetscErrorCode MpmProbeRespond(MpmProbe *probe, PetscBool forward, PetscInt64 n, const PetscInt64 unknown[],
                               PetscReal amount[], PetscReal response[]);

/*
   MpmProbeRandom - the response to a random perturbation of all unknowns, amount[i] = at most size, over size.

   Not collective. seed chooses the perturbation. amount, response: particles x width numbers.
*/
PetscErrorCode MpmProbeRandom(MpmProbe *probe, PetscInt64 seed, PetscReal size, PetscReal amount[],
                              PetscReal response[]);

/* Not collective. The largest difference of two states over the scales; whole periods are taken out. */
PetscReal MpmProbeDistance(const MpmProbe *probe, const PetscReal one[], const PetscReal other[]);
