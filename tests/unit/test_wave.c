/* The exact solutions satisfy their equations, by central differences, and have the amplitude they claim. */
#include "check.h"

static void CheckEquations(const MpmWave *wave, MpmInitial initial, PetscBool second_order)
{
  const MpmProfile p = {.initial    = initial,
                        .length     = 2,
                        .wave_speed = 1.5,
                        .cell_width = 0.1,
                        .amplitude  = 0.7,
                        .wavenumber = 2 * PETSC_PI * 3 / 2};
  const PetscReal  d = 1e-4, c = p.wave_speed, h = p.cell_width;
  PetscReal        largest[2] = {0, 0};

  for (PetscInt i = 0; i < 200; i++) {
    const PetscReal X = 0.01 * i, t = 0.37 + 0.003 * i;
    PetscReal       dt[2], dx[2], dxx;

    for (PetscInt f = 0; f < 2; f++) {
      dt[f] = (wave->value(&p, f, X, t + d) - wave->value(&p, f, X, t - d)) / (2 * d);
      dx[f] = (wave->value(&p, f, X + d, t) - wave->value(&p, f, X - d, t)) / (2 * d);
      CHECK_NEAR(wave->value(&p, f, X + p.length, t), wave->value(&p, f, X, t), 1e-12);
      for (PetscInt j = 0; j < 500; j++)
        largest[f] = PetscMax(largest[f], fabs(wave->value(&p, f, 0.004 * j, 0.004 * i)));
    }
    dxx = (wave->value(&p, 0, X + d, t) - 2 * wave->value(&p, 0, X, t) + wave->value(&p, 0, X - d, t)) / (d * d);
    if (second_order) {
      CHECK_NEAR(dt[0], c / h * wave->value(&p, 1, X, t), 1e-4);
      CHECK_NEAR(dt[1], h * c * dxx, 1e-4);
    } else {
      CHECK_NEAR(dt[0], c * dx[1], 1e-4);
      CHECK_NEAR(dt[1], c * dx[0], 1e-4);
    }
  }
  for (PetscInt f = 0; f < 2; f++) CHECK_NEAR(largest[f], wave->amplitude(&p, f), 2e-3 * largest[f]);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  CheckEquations(&MpmWaveFirstOrder, MPM_INITIAL_MODE, PETSC_FALSE);
  CheckEquations(&MpmWaveFirstOrder, MPM_INITIAL_PULSE, PETSC_FALSE);
  CheckEquations(&MpmWaveSecondOrder, MPM_INITIAL_MODE, PETSC_TRUE);
  CheckEquations(&MpmWaveSecondOrder, MPM_INITIAL_PULSE, PETSC_TRUE);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
