/* Transient growth: how large a state can become within n steps, whatever the eigenvalues say of the end. */
#pragma once
#include <mpmstab/operator.h>

/*S
   MpmTransient - norm(A^n), the largest singular value, at steps n = 0 .. last; under drift of the product of the
   first n steps, which begin anew after a period.

   norm is NaN where it is beyond the range of doubles or the solver did not converge (missing: at so many steps);
   log_norm, its natural logarithm, is NaN only in the second case. largest (NaN: out of range) is at at_step. excess
   is the largest norm(A^n) / growth^n, at excess_at; power, p where its largest so far grows like n^p over the late
   steps;
   both NaN when growth is not known, power also when there are too few steps.

   The norm is that of MpmOperatorWeigh. Source: Trefethen and Embree 2005, Spectra and Pseudospectra, ch. 14-18.
*/
typedef struct {
  PetscInt   n, *steps, at_step, excess_at, missing;
  PetscReal *norm, *log_norm, largest, excess, power, seconds;
} MpmTransient;

/*
   MpmTransientCreate - norms up to a last step: at all steps up to 16, then at steps spaced by a quarter.

   Collective; needs SLEPc initialized. growth: per step, of the spectrum (NaN: not known). A norm is right to 1e-6 at
   least, and where it is apart from the next singular value to rounding.
*/
PetscErrorCode MpmTransientCreate(const MpmOperator *op, PetscInt last, PetscReal growth, MpmTransient **transient);
PetscErrorCode MpmTransientDestroy(MpmTransient **transient);
