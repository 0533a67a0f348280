/*
   For every formulation with every transfer (of those with the same operations one) and basis: A q = march(q), spectrum = symbol, corrected = symbol. The
   layouts are at rest, jittered, drifting, and between walls, where there is no symbol. More ranks try fewer of them.
*/
#include "check.h"
#include "linalg/eigen.h"
#include <mpmstab/operator.h>
#include "symbol/predict.h"

static PetscBool Exists(const MpmFormulation *f, const MpmTransfer *t, const MpmBasis *b, const char rest[])
{
  if (strstr(rest, "material") && !f->materials) return PETSC_FALSE;
  if (strstr(rest, "damping") &&
      (!MpmFormulationHas(f, MPM_DIV) || MpmFormulationHas(f, MPM_IMPLICIT) || (f->lines && !t->filter)))
    return PETSC_FALSE; /* rk with flip has its stages on particles, which cannot have viscosity */
  if (strstr(rest, "counts") && b->wide) return PETSC_FALSE;
  if (t->same_as || (t->affine && f->affine == MPM_NONE)) return PETSC_FALSE;
  if (strstr(rest, "reaction") && !MpmFormulationHas(f, MPM_REACT)) return PETSC_FALSE;
  return strstr(rest, "free") && !f->free_ends ? PETSC_FALSE : PETSC_TRUE;
}

/* Numbers that are not the defaults, where these leave something out. */
static const char *More(const MpmTransfer *t)
{
  if (!t->option) return "";
  return strcmp(t->option, "xpic_order") ? strcmp(t->option, "aflip_ratio") ? "" : "-aflip_ratio 0.7" : "-xpic_order 3";
}

/* Finds the largest abs of all eigenvalues, per step. */
static PetscErrorCode Growth(const MpmOperator *op, PetscReal *growth)
{
  MpmEigen *eigen;

  PetscFunctionBegin;
  PetscCall(MpmEigenSolve(op->A, NULL, MPM_EIGEN_DENSE, NULL, &eigen));
  CHECK(eigen->complete, "%d of %d eigenvalues", (int)eigen->n, (int)op->order);
  *growth = eigen->n ? MpmGrowthPerStep(hypot(eigen->re[0], eigen->im[0]), op->exponent, op->period) : NAN;
  PetscCall(MpmEigenDestroy(&eigen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Symbols(const char options[], const MpmOperator *op)
{
  const MpmSymbolWish wish = {.phases = {op->layout->grid[0].cells}, .tolerance = 1e-6};
  MpmSymbol          *symbol;
  MpmPredictor        predictor;
  MpmComparison       comparison;
  PetscReal           growth = NAN;

  PetscFunctionBegin;
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, op->layout, op->scheme, &op->step, &wish, &symbol));
  PetscCall(Growth(op, &growth));
  /* eigenvalues at 1 may be defective, in blocks of up to three, and periods have several steps */
  CHECK_NEAR(growth, symbol->growth, (fabs(symbol->growth - 1) < 1e-4 ? 3e-5 : 1e-8) * symbol->growth);
  PetscCall(MpmPredictorCreate(op->layout, op->scheme, MpmStepDrifts(&op->step), NULL, &predictor));
  PetscCall(MpmPredictCompare(PETSC_COMM_WORLD, &predictor, symbol, &comparison));
  CHECK(predictor.why_not || comparison.corrected <= 1e-7 * symbol->growth, "%s: corrected off by %g at %g", options,
        comparison.corrected, comparison.corrected_beta[0]);
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Agrees(const char options[])
{
  MpmScene    *scene;
  MpmOperator *op;
  PetscReal    mismatch;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmOperatorMismatch(op, &mismatch));
  CHECK(mismatch <= (MpmTableSolves(scene->scheme.table) ? 1e-12 : 1e-14) * op->period, "%s: %.3g", options, mismatch);
  if (!MpmSymbolWhyNot(&scene->layout)) PetscCall(Symbols(options, op));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const rests[] = {
      "-cells 12 -courant 0.4",
      "-cells 15 -ppc 1 -offset 0.2 -courant 1.3",
      "-cells 16 -ppc 3 -jitter 0.7 -courant 0.6",
      "-cells 12 -drift 1/4 -courant 0.2",
      "-cells 15 -drift -2/5 -courant 0.3 -ppc 1 -offset 0.1",
      "-cells 13 -boundary fixed -courant 0.7",
      "-cells 16 -boundary fixed,free -jitter 0.9 -courant 0.5",
      "-cells 12 -boundary fixed_reaction,free -ppc 1 -courant 0.6",
      "-cells 16 -boundary free,fixed_reaction -ppc 3 -jitter 0.6 -courant 0.3",
      "-cells 12 -cluster 0.3,0.5 -courant 0.3",
      "-cells 14 -counts 1,4,0,2 -offset 0.3 -drift 1/2 -courant 0.2",
      "-cells 12 -material two -density_ratio 9 -stiffness_ratio 30 -jitter 0.5 -courant 0.05",
      "-cells 13 -material graded -density_ratio 20 -stiffness_ratio 0.1 -boundary fixed,free -courant 0.2",
      "-cells 18 -boundary fixed,free -fill 0,13.5 -courant 0.5",
      "-cells 12 -viscosity 0.2 -grid_damping 0.3 -courant 0.9",
      "-cells 13 -boundary fixed_reaction,free -jitter 0.6 -viscosity 0.1 -grid_damping 0.2 -courant 0.4",
  };
  char              options[512];
  PetscInt          tried = 0;
  const PetscMPIInt size  = MpmRanksOf(PETSC_COMM_WORLD);
  PetscBool         turn  = PETSC_FALSE;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++)
      for (PetscInt b = 0; MpmBases[b]; b++)
        for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) {
          if (!Exists(MpmFormulations[f], MpmTransfers[t], MpmBases[b], rests[r])) continue;
          PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -transfer %s -basis %s %s %s",
                                  MpmFormulations[f]->name, MpmTransfers[t]->name, MpmBases[b]->name,
                                  More(MpmTransfers[t]), rests[r]));
          PetscCall(CheckHasTurn(tried++ + (PetscInt)(t / 2), &turn));
          if (size == 1 && (tried + t / 2) % 2)
            continue; /* at night two ranks have this half, and three a third of all */
          if (turn) PetscCall(Agrees(options));
        }
  CHECK(tried > 1000, "only %d schemes", (int)tried);
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
