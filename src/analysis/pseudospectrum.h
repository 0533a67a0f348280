/* Pseudospectrum: sigma(z), the smallest singular value of z - A, and what it says of norm(A^n). */
#pragma once
#include "linalg/resolvent.h"
#include <mpmstab/scene.h>

/*S
   MpmPseudospectrum - sigma at points x points of a square around the unit circle and the spectrum: sigma[i points + j]
   at re[j] + i re[i], since both axes are the same.

   kreiss is the largest (abs(z) - 1) / sigma(z) found outside the circle, at kreiss_at: a lower bound of the Kreiss
   constant K; 1, and kreiss_at NaN, where nothing is above its limit at infinity; infinite when an eigenvalue is
   outside. edge_power: 0, or where it was found next to the circle, at MPM_KREISS_NEAREST, the power of 1 / distance
   with which the quotient grows there: above 0 K is larger than found, infinite for a defective eigenvalue on the
   circle. sup norm(A^n) is between K and e order K.

   Source: Kreiss 1962; Spijker 1991; Trefethen and Embree 2005, Spectra and Pseudospectra, ch. 14-18.
*/
#define MPM_KREISS_NEAREST 1e-4
typedef struct {
  PetscInt       points, order;
  PetscReal     *re, *sigma, radius, kreiss, edge_power, seconds;
  double complex kreiss_at;
} MpmPseudospectrum;

/* Collective. Refuses a scene of too many unknowns, before any work is done. */
PetscErrorCode MpmPseudospectrumCheck(const MpmScene *scene);

/*
   MpmPseudospectrumCreate - of a finite matrix of order at most MPM_RESOLVENT_ORDER; eigenvalues up to 1 + tolerance
   count as on the circle.

   Collective: the points are dealt to ranks in turn.
*/
PetscErrorCode MpmPseudospectrumCreate(Mat A, PetscInt points, PetscReal tolerance, MpmPseudospectrum **pseudospectrum);
PetscErrorCode MpmPseudospectrumDestroy(MpmPseudospectrum **pseudospectrum);
