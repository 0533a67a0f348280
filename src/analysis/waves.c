/* Growth of the waves of a uniform layout, and what rounding makes of it. */
#include "analysis/waves.h"
#include <math.h>

PetscErrorCode MpmWavesCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction drift[], MpmWaves *w)
{
  PetscFunctionBegin;
  *w = (MpmWaves){.evaluations = 0};
  PetscCall(MpmBlochCreate(layout, scheme, drift, &w->bloch));
  PetscCall(MpmSmallEigenCreate(w->bloch.turn_size, &w->eigen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWavesDestroy(MpmWaves *w)
{
  PetscFunctionBegin;
  PetscCall(MpmSmallEigenDestroy(&w->eigen));
  PetscCall(MpmBlochDestroy(&w->bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWavesGrowth(MpmWaves *w, PetscReal courant, const PetscReal beta[], PetscReal *growth)
{
  PetscReal without_null;

  PetscFunctionBegin;
  w->evaluations++;
  PetscCall(MpmBlochGrowths(&w->bloch, &w->eigen, 1, &courant, beta, growth, &without_null));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWavesRounding(MpmWaves *w, PetscReal courant, const PetscReal beta[], PetscReal growth,
                                PetscReal *defective_error, PetscReal *uncertainty)
{
  MpmSmallEigen   whole, *e      = &whole;
  double complex *noisy, overlap = 0;
  PetscReal       norm = 0, moved = 0;
  PetscInt        largest = 0, exponent, other;

  PetscFunctionBegin;
  PetscCall(MpmSmallEigenCreate(w->bloch.size, e));
  noisy = e->left; /* vectors come later */
  PetscCall(MpmBlochMatrices(&w->bloch, 1, &courant, beta, PETSC_FALSE, e->matrix, &exponent));
  PetscCall(MpmBlochMatrices(&w->bloch, 1, &courant, beta, PETSC_TRUE, noisy, &other));
  for (PetscInt i = 0; i < e->n * e->n; i++) {
    norm  = hypot(norm, cabs(e->matrix[i]));
    moved = hypot(moved, cabs(noisy[i] * scalbn(1, (int)(other - exponent)) - e->matrix[i]));
  }
  moved            = PetscMax(moved, MPM_ROUNDING * norm);
  *defective_error = MpmDefectiveErrorOf(moved, exponent, w->bloch.period);
  if (uncertainty) {
    PetscCall(MpmSmallEigenSolve(e, PETSC_TRUE));
    for (PetscInt i = 1; i < e->n; i++)
      if (cabs(e->value[i]) > cabs(e->value[largest])) largest = i;
    for (PetscInt i = 0; i < e->n; i++) overlap += conj(e->left[e->n * largest + i]) * e->right[e->n * largest + i];
    *uncertainty = MpmUncertaintyOf(growth, moved / cabs(overlap) / cabs(e->value[largest]), w->bloch.period);
  }
  PetscCall(MpmSmallEigenDestroy(e));
  PetscFunctionReturn(PETSC_SUCCESS);
}
