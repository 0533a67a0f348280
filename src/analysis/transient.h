/* Transient growth: how large a state can become within n steps, even if no eigenvalue shows growth. */
#pragma once
#include "linalg/reduced.h"
#include <mpmstab/operator.h>

/*S
   MpmTransient - norm(A^n), the largest singular value, at steps n = 0 .. last. Under drift it is the norm of the
   product of the first n steps; after a period the steps repeat.

   norm: NaN where it is beyond the range of doubles or the solver did not converge. missing: the number of steps at
   which it did not converge. log_norm: the natural logarithm of norm; NaN only where the solver did not converge.
   largest: the largest norm, at at_step; NaN when out of range. excess: the largest norm(A^n) / growth^n, at excess_at.
   power: the largest such quotient so far grows like n^power over the late steps. excess and power are NaN when growth
   is not known, power also when there are too few steps.

   The norm is that of MpmOperatorWeigh. Source: Trefethen and Embree 2005, Spectra and Pseudospectra, ch. 14-18.
S*/
typedef struct {
  PetscInt   n, *steps, at_step, excess_at, missing;
  PetscReal *norm, *log_norm, largest, excess, power, seconds;
} MpmTransient;

/*
   MpmTransientCreate - computes norms up to a last step, at all steps up to 16 and then at steps spaced by a quarter. Of
   a matrix that was given and covers several steps, these are periods, and last is at least one period.

   Collective; needs SLEPc initialized. nodal: NULL, or the nodes' operator of op, whose powers then take the place of
   those of the particles' (linalg/reduced.h). growth: per step, that of the spectrum (NaN: not known). The relative error of a
   norm is at most 1e-6, and that of rounding where it is separate from the next singular value.
*/
PetscErrorCode MpmTransientCreate(const MpmOperator *op, const MpmReduced *nodal, PetscInt last, PetscReal growth,
                                  MpmTransient **transient);
PetscErrorCode MpmTransientDestroy(MpmTransient **transient);
