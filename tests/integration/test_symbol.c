/*
   The symbol is compared with the oracle, with the closed forms at random parameters, and with itself: any number of
   ranks and any multiple of the phases give the same.
*/
#include "oracle.h"
#include "symbols.h"
#include "scene/layout.h"
#include "symbol/predict.h"
#include <mpmstab/verdict.h>

/* Checks the closed forms of docs/theory.md, section 4, at random Courant numbers, offsets and particles per cell. */
static PetscErrorCode CheckClosedForms(const char formulation[], int n)
{
  MpmScene      *scene;
  MpmSymbol     *symbol;
  MpmPredictor   predictor;
  MpmPredictions predictions;
  MpmComparison  comparison;
  char           options[256];
  const double   courant = 0.01 + 2.5 * MpmHash(1, n), offset = n % 3 ? MpmHash(2, n) : 0.5;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -cells %d -ppc %d -courant %.6f -offset %.9f",
                          formulation, 8 + n, 1 + n % 4, courant, offset));
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, scene->layout.grid[0].cells, PETSC_FALSE, &symbol));
  PetscCall(MpmPredict(scene, &predictions));
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, MpmSceneDrifts(scene), NULL, &predictor));
  PetscCall(MpmPredictCompare(PETSC_COMM_WORLD, &predictor, symbol, &comparison));
  CHECK(comparison.corrected <= SPLIT * symbol->growth, "%s: off by %.3g at beta %g", options, comparison.corrected,
        comparison.corrected_beta[0]);
  CHECK(fabs(PetscMax(1, predictions.corrected) - symbol->growth) <= SPLIT * symbol->growth, "%s: %.12g and %.12g",
        options, predictions.corrected, symbol->growth);
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks where the slides' formulas fail and by how much, with numbers from docs/theory.md, section 4, by hand. */
static PetscErrorCode CheckSlip(const char options[], PetscReal off, PetscReal beta)
{
  MpmComparison comparison;
  PetscReal     growth = NAN;

  PetscFunctionBegin;
  PetscCall(CompareClosedForm(options, 0, &comparison, &growth));
  CHECK_NEAR(comparison.published, off, 1e-8);
  CHECK_NEAR(comparison.published_beta, beta, 1e-12);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRanksAndPhases(const char options[])
{
  MpmScene  *scene;
  MpmSymbol *all, *alone, *finer;
  PetscReal *factors, *finer_factors, *growth;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, scene->layout.grid[0].cells, PETSC_TRUE, &all));
  PetscCall(CheckSymbol(PETSC_COMM_SELF, scene, scene->layout.grid[0].cells, PETSC_TRUE, &alone));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, 3 * scene->layout.grid[0].cells, PETSC_TRUE, &finer));
  CHECK(all->growth == alone->growth && all->beta_at_max[0] == alone->beta_at_max[0], "%s: %.17g at %g, %.17g at %g",
        options, all->growth, all->beta_at_max[0], alone->growth, alone->beta_at_max[0]);
  CHECK(finer->growth >= all->growth - 1e-12, "%s: finer phases give %.17g", options, finer->growth);
  PetscCall(MpmSymbolGather(PETSC_COMM_SELF, alone, alone->per_phase, &growth));
  PetscCall(MpmSymbolGatherFactors(PETSC_COMM_WORLD, all, 0, &factors));
  PetscCall(MpmSymbolGatherFactors(PETSC_COMM_WORLD, finer, 0, &finer_factors));
  for (PetscInt m = 0; m < all->all; m++) {
    PetscReal largest = 0, finest = 0;
    PetscBool conjugate;

    for (PetscInt j = 0; j < all->size; j++) {
      const PetscReal *a = factors + 2 * (all->size * m + j), *b = finer_factors + 2 * (all->size * 3 * m + j);

      largest = PetscMax(largest, hypot(a[0], a[1]));
      finest  = PetscMax(finest, hypot(b[0], b[1]));
    }
    CHECK_NEAR(pow(largest, 1.0 / all->period), growth[MpmSymbolClass(all, m, &conjugate)], 1e-12);
    CHECK_NEAR(finest, largest, SPLIT);
  }
  PetscCall(PetscFree(growth));
  PetscCall(PetscFree(factors));
  PetscCall(PetscFree(finer_factors));
  PetscCall(MpmSymbolDestroy(&all));
  PetscCall(MpmSymbolDestroy(&alone));
  PetscCall(MpmSymbolDestroy(&finer));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks periods of a thousand steps: growth is within a range, and is known or lost to rounding. */
static PetscErrorCode CheckLongPeriod(const char options[], PetscReal lo, PetscReal hi, PetscBool off_range,
                                      PetscBool lost)
{
  MpmScene  *scene;
  MpmSymbol *symbol;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, scene->layout.grid[0].cells, PETSC_FALSE, &symbol));
  CHECK(isfinite(symbol->growth) && symbol->growth > lo && symbol->growth < hi, "%s: growth %g", options,
        symbol->growth);
  if (off_range) CHECK(symbol->exponent > 1024, "%s: exponent %d", options, (int)symbol->exponent);
  if (lost) CHECK(isinf(symbol->uncertainty), "%s: known to %g", options, symbol->uncertainty);
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  PetscCall(OracleGrowth(argv[1], "", 24, CheckSymbolRow));
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (int n = 0; n < 24; n++) PetscCall(CheckClosedForms(MpmFormulations[f]->name, n));
  PetscCall(CheckSlip("-formulation gas1 -cells 16 -courant 0.5", sqrt(2) - sqrt(1.25), PETSC_PI / 2));
  PetscCall(CheckSlip("-formulation gas2 -cells 16 -courant 0.5", 1 - sqrt(0.5), PETSC_PI / 2));
  PetscCall(CheckSlip("-formulation elastic -cells 2 -courant 0.5", 1 - sqrt(1 - 0.25 * 0.75), PETSC_PI));
  PetscCall(CheckRanksAndPhases("-cells 16 -courant 0.2 -drift 1/8"));
  PetscCall(CheckRanksAndPhases("-formulation elastic -cells 15 -courant 1.45 -ppc 3"));
  PetscCall(CheckRanksAndPhases("-formulation gas1 -cells 1 -ppc 1"));
  /* unstable steps whose product leaves the range of doubles */
  PetscCall(CheckLongPeriod("-cells 8 -courant 20 -drift 1/1000", 100, 2000, PETSC_TRUE, PETSC_FALSE));
  /* steps that grow beyond double precision and decay again; with 150 digits growth is 1, with 16 it can be anything */
  PetscCall(CheckLongPeriod("-formulation elastic -cells 16 -ppc 1 -courant 1.2 -drift 1/1000", 1.01, 2, PETSC_FALSE,
                            PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
