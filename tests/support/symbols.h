/* The symbol of a whole scene, as tests ask for it, beside the oracle and the closed forms. */
#pragma once
#include "check.h"
#include "symbol/predict.h"
#include <mpmstab/scene.h>
#include <mpmstab/symbol.h>
#include <mpmstab/verdict.h>

/* Where the oracle has 1 + 1e-8, its rounding has split a defective pair; our rounding splits it differently. */
#define SPLIT 3e-8

/* The symbol at so many phases in each direction, with the tolerance 1e-6; keep says whether the amplification factors are kept. */
static inline PetscErrorCode CheckSymbol(MPI_Comm comm, const MpmScene *scene, PetscInt phases, PetscBool keep,
                                         MpmSymbol **symbol)
{
  const MpmSymbolWish wish = {.phases = {phases, phases, phases}, .keep = keep, .tolerance = 1e-6};

  PetscFunctionBegin;
  PetscCall(MpmSymbolCreate(comm, &scene->layout, &scene->scheme, &scene->step, &wish, symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A row of the oracle: growth of the symbol on the phases of the grid, and its verdict. */
static inline PetscErrorCode CheckSymbolRow(const char row[], const char options[], PetscReal oracle)
{
  MpmScene  *scene;
  MpmSymbol *symbol;
  MpmFinding finding;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, scene->layout.grid[0].cells, PETSC_FALSE, &symbol));
  CHECK(fabs(symbol->growth - oracle) <= (fabs(oracle - 1) < 1e-6 ? SPLIT : 1e-8), "%s: %.12g", row, symbol->growth);
  finding = (MpmFinding){.growth          = symbol->growth,
                         .tolerance       = 1e-6,
                         .uncertainty     = symbol->uncertainty,
                         .defective_error = symbol->defective_error};
  CHECK(MpmVerdictOf(&finding) == (oracle > 1 + 1e-6 ? MPM_UNSTABLE : MPM_STABLE),
        "%s: uncertainty %g, defective_error %g", row, symbol->uncertainty, symbol->defective_error);
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The symbol at so many phases in each direction (0: those of the grid) beside the closed form, and the symbol's growth. */
static inline PetscErrorCode CompareClosedForm(const char options[], PetscInt phases, MpmComparison *comparison,
                                               PetscReal *growth)
{
  MpmScene    *scene;
  MpmSymbol   *symbol;
  MpmPredictor predictor;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, phases ? phases : scene->layout.grid[0].cells, PETSC_FALSE, &symbol));
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, MpmSceneDrifts(scene), NULL, &predictor));
  PetscCall(MpmPredictCompare(PETSC_COMM_WORLD, &predictor, symbol, comparison));
  *growth = symbol->growth;
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
