/*
   Probe: the one-step operator of a code, built from the steps of a stepper. A column is a central difference,

     A e_j = (F(q + s e_j) - F(q - s e_j)) / (2 s)    with F the step and q the base state,

   divided by the perturbation as the code's own arithmetic has rounded it. Unknowns are numbered particle by particle,
   fields in the order described, and are in units of the fields' scales, so that A and its error do not depend on the
   code's units.
*/
#pragma once
#include "probe/stepper.h"
#include <petscmat.h>

/*S
   MpmProbe - a base state and how it is perturbed.

   steps   - of one application: after them every particle has moved by the same whole number of cells
   shift   - that number in each direction; 0 at rest
   single  - the code computes in single precision: everything that it gives is a float
   near    - places that differ by less, in cell widths, are the same
   scale   - for each number of a particle what a change of order 1 means
   size, other - the two sizes of perturbations, in scales
   apart   - numbers of a particle that are not perturbed at random, and of which no response counts; NULL: none
   rest    - the state after steps from the base
   first   - the response to the first perturbation, of size least, before any that is larger
   noise   - what responses to the smallest perturbations differ by, if larger ones make it smaller, as that of
             rounding; or 0
   composed - by how much steps in one request differ from requests of one step each, over the size of a perturbation
S*/
typedef struct {
  MpmStepper      *stepper;
  PetscInt         steps, shift[MPM_MAX_DIM];
  PetscBool        single;
  PetscReal       *scale, near, size, other, least, *rest, *first, composed, noise;
  const PetscBool *apart;
} MpmProbe;

/*
   MpmProbeCreate - finds the scales. MpmProbeBegin steps the base state, and finds out how to perturb it. If steps
   change with their number, it finds after how many they repeat, and these are from then on the steps of the stepper.

   Collective. longest: the largest number of steps after which particles may have the same places in cells again.
*/
PetscErrorCode MpmProbeCreate(MpmStepper *stepper, MpmProbe *probe);
PetscErrorCode MpmProbeBegin(MpmProbe *probe, PetscInt longest);
PetscErrorCode MpmProbeDestroy(MpmProbe *probe);

/*
   Not collective. Takes precision and sizes from another probe, before MpmProbeBegin, which then does not look for
   them.
*/
void MpmProbeSizesOf(MpmProbe *probe, const MpmProbe *other);

/*
   MpmProbeRespond - the response to a perturbation: (F(q + d) - F(q - d)) / 2, in scales. d is amount[i] scales of
   unknown[i], which must be different ones, or where unknown is NULL of unknown i; amount[i] is replaced by what the
   code's arithmetic makes of it.

   Not collective. response: particles x width numbers. forward: F(q + d) - F(q) instead. MpmProbeRespondAll: to m
   perturbations.
*/
typedef struct {
  PetscInt64 n, *unknown;
  PetscReal *amount, *response;
} MpmPerturbation;

PetscErrorCode MpmProbeRespond(MpmProbe *probe, PetscBool forward, PetscInt64 n, PetscInt64 unknown[],
                               PetscReal amount[], PetscReal response[]);
PetscErrorCode MpmProbeRespondAll(MpmProbe *probe, PetscBool forward, PetscInt m, MpmPerturbation each[]);

/*
   MpmProbeRandom - the response to a random perturbation of all unknowns that are not set apart, amount[i] = at most
   size, over size. The response of those that are is 0.

   Not collective. seed chooses the perturbation. part[c]: whether number c of a particle is perturbed; NULL: all are.
   amount (or NULL), response: particles x width numbers.
*/
PetscErrorCode MpmProbeRandom(MpmProbe *probe, PetscInt64 seed, PetscReal size, const PetscBool part[],
                              PetscReal amount[], PetscReal response[]);

/* Not collective. Whether a number of a particle is set apart. */
PetscBool MpmProbeIsApart(const MpmProbe *probe, PetscInt number);

/*
   MpmProbeRespondFirst - the response to the perturbation that is the first of all. Not collective.

   MpmProbeBends - how much the response to a random perturbation depends on its size, relative to it; where nothing
   switches it is small. Not collective. at: the unknown of which that is so, or MPM_NONE.
*/
PetscErrorCode MpmProbeRespondFirst(MpmProbe *probe, PetscReal response[]);
PetscErrorCode MpmProbeBends(MpmProbe *probe, PetscReal *bends, PetscInt64 *at);

/*
   Not collective. MpmProbeDifference: of number i of two states, in its scale. The largest difference of two states
   over the scales, of unknowns that are not set apart; whole periods are taken out. MpmProbeMoved: that of the base
   before and after an application, without the shift. at: its unknown, or MPM_NONE.
*/
PetscReal MpmProbeDifference(const MpmProbe *probe, PetscInt64 i, const PetscReal one[], const PetscReal other[]);
PetscReal MpmProbeDistance(const MpmProbe *probe, const PetscReal one[], const PetscReal other[]);
PetscReal MpmProbeMoved(const MpmProbe *probe, PetscInt64 *at);
