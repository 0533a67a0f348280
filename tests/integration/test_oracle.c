/*
   Growth of marched random data is compared with numbers of an independent program (data/growth.csv) for the
   formulations and bases in it. Exponential rates must be within 2% of the logarithm, and there must be no exponential
   growth where the oracle has none.
*/
#include "oracle.h"
#include "analysis/run.h"

static PetscErrorCode CheckRow(const char row[], const char options[], PetscReal oracle)
{
  const double steps = oracle > 1 + 1e-6 ? fmax(20000, 40 / log(oracle)) : 20000;
  char         all[512];
  MpmScene    *scene;
  MpmRun      *run;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof all, "%s -steps %.0f", options, steps));
  PetscCall(CheckScene(all, &scene));
  PetscCall(MpmRunCreate(scene, &check_request, NULL, 0, &run));
  CHECK(run->growth.measured, "%s: not measured", row);
  if (oracle > 1 + 1e-6) {
    CHECK(run->verdict == MPM_UNSTABLE, "%s: %s", row, MpmVerdictNames[run->verdict]);
    CHECK(fabs(log(run->growth.per_step) / log(oracle) - 1) <= 0.02, "%s: measured %.9g", row, run->growth.per_step);
  } else {
    CHECK(run->verdict == MPM_STABLE, "%s: %s", row, MpmVerdictNames[run->verdict]);
    CHECK(fabs(run->growth.per_step - 1) <= 1e-3, "%s: measured %.9g", row, run->growth.per_step);
  }
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  PetscCall(OracleGrowth(argv[1], "-initial random", 24, CheckRow));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
