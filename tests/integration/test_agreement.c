/*
   The main test: for every example scene of a linear scheme measured growth, spectrum and symbol agree, and A q = march(q). For unstable
   scenes symbol and spectrum agree to 1e-9, and the measured rate is within 2% of the logarithm. For stable scenes none
   of the three grows.

   More ranks march fewer steps. A slow mode that has grown by less than e^15 in them has not yet left the others behind;
   there the logarithm is within 10%.
*/
#include "check.h"
#include "analysis/spectrum.h"

#define EFOLDS 15

static PetscErrorCode Agrees(const char path[])
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(MpmSceneCreate("spectrum", path, &scene, &check_request));
  PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &s));
  CHECK(s->step_mismatch <= 1e-14 * s->op->period, "%s: A q and march(q) differ by %.3g", path, s->step_mismatch);
  CHECK(s->eigen->complete && s->max_residual <= 1e-12, "%s: %d eigenvalues, residual %.3g", path, (int)s->eigen->n,
        s->max_residual);
  CHECK((MpmSymbolWhyNot(&scene->layout) == NULL) == (s->symbol != NULL),
        "%s: a symbol of cells that differ, or none of like ones", path);
  CHECK(!s->symbol || fabs(s->symbol->growth - s->growth) <= 3e-8, "%s: symbol %.12g, spectrum %.12g", path,
        s->symbol ? s->symbol->growth : 0, s->growth);
  CHECK(!s->symbol || s->symbol_mismatch <= 1e-6, "%s: off the symbol's set by %.3g", path, s->symbol_mismatch);
  CHECK(s->run && s->run->growth.measured, "%s: nothing measured", path);
  CHECK(s->run && s->run->verdict == s->finding.verdict, "%s: measured %s, computed %s", path,
        MpmVerdictNames[s->run->verdict], MpmVerdictNames[s->finding.verdict]);
  if (s->growth > 1 + 1e-6) {
    const PetscReal share = s->run && (PetscReal)s->run->steps * log(s->growth) < EFOLDS ? 0.1 : 0.02;

    CHECK(s->run && fabs(log(s->run->growth.per_step) / log(s->growth) - 1) <= share,
          "%s: measured %.9g, spectrum %.9g", path, s->run->growth.per_step, s->growth);
  } else
    CHECK(s->run && s->run->growth.per_step <= 1 + 1e-3, "%s: measured %.9g", path, s->run->growth.per_step);
  PetscCall(MpmSpectrumDestroy(&s));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  PetscCall(SlepcInitializeNoArguments());
  CHECK(argc > 5, "only %d scenes", argc - 1);
  for (int i = 1; i < argc; i++) {
    PetscBool turn;

    PetscCall(CheckHasTurn(i, &turn));
    if (turn) PetscCall(Agrees(argv[i]));
  }
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
