/* Predictions: closed forms of abs(G), the largest over the modes of the scene's grid. */
#pragma once
#include <mpmstab/scene.h>

/*S
   MpmPredictions - growth per step; NaN where a formula does not cover the scene (moving or scattered
   particles, another basis, a Courant number the slides leave out).

   corrected_mode is the corrected formula at the one phase of initial mode.
*/
typedef struct {
  PetscReal published, corrected, corrected_mode;
} MpmPredictions;

/* Not collective. */
PetscErrorCode MpmPredict(const MpmScene *scene, MpmPredictions *predictions);
