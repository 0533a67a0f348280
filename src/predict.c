/* The formulations' closed forms over the phases beta = 2 pi m / cells of a grid. */
#include <mpmstab/layout.h>
#include <mpmstab/predict.h>
#include <math.h>

/* Beyond this many phases the maximum is the same to all digits that matter. */
#define MOST_PHASES 65536

static PetscErrorCode Moments(const MpmScene *scene, PetscReal xi[], MpmCellMoments *cell)
{
  PetscReal mean = 0;

  PetscFunctionBegin;
  for (PetscInt j = 0; j < scene->ppc; j++) {
    PetscInt n;

    MpmLayoutPlace(scene, j, &n, &xi[j]);
    mean += xi[j] / scene->ppc;
  }
  *cell = (MpmCellMoments){.e = 2 * mean - 1, .ppc = scene->ppc, .xi = xi};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPredict(const MpmScene *scene, MpmPredictions *predictions)
{
  const MpmFormulation *f      = scene->formulation;
  const PetscInt        phases = PetscMin(scene->cells, MOST_PHASES);
  MpmCellMoments        cell;
  PetscReal            *xi;

  PetscFunctionBegin;
  *predictions = (MpmPredictions){.published = NAN, .corrected = NAN, .corrected_mode = NAN};
  if (MpmSceneDrifts(scene) || scene->jitter != 0 || !scene->basis->hat) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(scene->ppc, &xi));
  PetscCall(Moments(scene, xi, &cell));
  for (PetscInt m = 0; m < phases; m++) {
    const PetscReal beta = 2 * PETSC_PI * m / phases;

    predictions->published = fmax(predictions->published, f->published(scene->courant, beta));
    predictions->corrected = fmax(predictions->corrected, f->corrected(&cell, scene->courant, beta));
  }
  if (scene->initial == MPM_INITIAL_MODE)
    predictions->corrected_mode = f->corrected(&cell, scene->courant, 2 * PETSC_PI * scene->mode / scene->cells);
  PetscCall(PetscFree(xi));
  PetscFunctionReturn(PETSC_SUCCESS);
}
