/* Closed forms against numbers worked out by hand and the oracle's rows at rest. */
#include "check.h"
#include "symbol/predict.h"

static PetscErrorCode Predicts(const char options[], PetscReal published, PetscReal corrected, PetscReal mode)
{
  MpmScene       *scene;
  MpmPredictions  p;
  const PetscReal expected[3] = {published, corrected, mode};
  PetscReal       found[3];

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmPredict(scene, &p));
  found[0] = p.published;
  found[1] = p.corrected;
  found[2] = p.corrected_mode;
  for (int i = 0; i < 3; i++)
    CHECK(isnan(expected[i]) ? isnan(found[i]) : fabs(found[i] - expected[i]) < 1e-9, "%s: %d: %.12g, not %.12g",
          options, i, found[i], expected[i]);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(Predicts("-formulation gas1 -cells 16 -courant 0.5 -initial random", sqrt(2), 1.118033989 + 2.5e-10, NAN));
  PetscCall(Predicts("-formulation gas1 -cells 16 -courant 0.5 -mode 4", sqrt(2), sqrt(1.25), sqrt(1.25)));
  PetscCall(Predicts("-formulation gas2 -cells 16 -courant 0.5 -mode 4", 1, 1, 1));
  PetscCall(Predicts("-formulation gas2 -cells 16 -courant 2.05 -mode 4", NAN, 1.5625, 1.5625));
  /* off-centre: one particle a cell at xi = 1/4, e = -1/2; at beta = pi, mu = -1: G^2 - (2 + k^2) G + 1 = 0 */
  PetscCall(Predicts("-formulation gas2 -cells 2 -ppc 1 -offset 1/4 -courant 1 -mode 1", NAN, (3 + sqrt(5)) / 2,
                     (3 + sqrt(5)) / 2));
  PetscCall(Predicts("-formulation elastic -cells 16 -courant 0.5 -mode 8", 1, 1, sqrt(1 - 0.25 * 0.75)));
  PetscCall(Predicts("-formulation gas1 -drift 1/8", NAN, NAN, NAN));
  PetscCall(Predicts("-formulation gas1 -jitter 0.1", NAN, NAN, NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
