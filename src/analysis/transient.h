/*
   Transient growth: how large a state can become within n steps, even if no eigenvalue shows growth; and the
   pseudospectrum, sigma(z), the smallest singular value of z - A, with the bounds on norm(A^n) that follow from it.
*/
#pragma once
#include "linalg/reduced.h"
#include "linalg/singular.h"
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
   MpmTransientCreate - computes norms up to a last step, at all steps up to 16 and then at steps spaced by a quarter.
   Of a matrix that was given and covers several steps, these are periods, and last is at least one period.

   Collective; needs SLEPc initialized. nodal: NULL, or the nodes' operator of op, whose powers then take the place of
   those of the particles' (linalg/reduced.h). growth: per step, that of the spectrum (NaN: not known). The relative
   error of a norm is at most 1e-6, and that of rounding where it is separate from the next singular value.
*/
PetscErrorCode MpmTransientCreate(const MpmOperator *op, const MpmReduced *nodal, PetscInt last, PetscReal growth,
                                  MpmTransient **transient);
PetscErrorCode MpmTransientDestroy(MpmTransient **transient);

/*S
   MpmPseudospectrum - sigma at points x points of a square around the unit circle and the spectrum. sigma[i points + j]
   is at re[j] + i re[i], since both axes have the same coordinates.

   kreiss: the largest (abs(z) - 1) / sigma(z) found outside the unit circle, at kreiss_at. It is a lower bound of the
   Kreiss constant K. It is 1, with kreiss_at NaN, where no quotient exceeds the limit 1 at infinity; it is infinite
   when an eigenvalue is outside. sup norm(A^n) is between K and e order K.

   edge_power: when the largest quotient was found next to the circle, at MPM_KREISS_NEAREST, it grows there like (1 /
   distance)^edge_power; otherwise it is 0. Above 0 it shows that K is larger than kreiss. K is infinite for a defective
   eigenvalue on the circle.

   Source: Kreiss 1962; Spijker 1991; Trefethen and Embree 2005, Spectra and Pseudospectra, ch. 14-18.
S*/
#define MPM_KREISS_NEAREST 1e-4
typedef struct {
  PetscInt       points, order;
  PetscReal     *re, *sigma, radius, kreiss, edge_power, seconds;
  double complex kreiss_at;
} MpmPseudospectrum;

/* Collective. Refuses too many unknowns, before any work is done. what: has them, for the message. */
PetscErrorCode MpmPseudospectrumCheck(const char what[], PetscInt64 order);

/*
   MpmPseudospectrumCreate - computes the pseudospectrum of a finite matrix of order at most MPM_RESOLVENT_ORDER.
   Eigenvalues of abs up to 1 + tolerance count as on the circle.

   Collective; each point is computed by one rank (see farm.h).
*/
PetscErrorCode MpmPseudospectrumCreate(Mat A, PetscInt points, PetscReal tolerance, MpmPseudospectrum **pseudospectrum);
PetscErrorCode MpmPseudospectrumDestroy(MpmPseudospectrum **pseudospectrum);
