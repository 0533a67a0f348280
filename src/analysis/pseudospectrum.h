/* Pseudospectrum: sigma(z), the smallest singular value of z - A, and the bounds on norm(A^n) that follow from it. */
#pragma once
#include "linalg/singular.h"

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
