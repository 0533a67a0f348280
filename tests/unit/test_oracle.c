/*
   Growth of marched random data against an independent program's numbers (data/growth.csv), for the
   formulations and bases there are: exponential rates within 2% of the logarithm, no exponential growth where
   the oracle has none.
*/
#include "check.h"
#include <mpmstab/run.h>
#include <stdlib.h>

static PetscErrorCode CheckRow(const char row[], const char options[], PetscReal oracle)
{
  MpmScene *scene;
  MpmRun   *run;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmRunCreate(scene, 0, &run));
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
  FILE       *file = argc > 1 ? fopen(argv[1], "r") : NULL;
  char        row[256], formulation[32], basis[32], drift[32], options[512];
  int         ppc, cells, rows = 0;
  double      courant, growth;
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCheck(file, PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "usage: test_oracle growth.csv");
  while (fgets(row, sizeof row, file)) {
    if (sscanf(row, "%31[^,],%31[^,],%d,%d,%lf,%31[^,],%lf", formulation, basis, &ppc, &cells, &courant, drift,
               &growth) != 7)
      continue;
    row[strcspn(row, "\r\n")] = 0;
    if (!MpmFormulationFind(formulation) || !MpmBasisFind(basis)) {
      if (rank == 0) printf("skipped, no such formulation or basis yet: %s\n", row);
      continue;
    }
    PetscCall(PetscSNPrintf(options, sizeof options,
                            "-formulation %s -basis %s -ppc %d -cells %d -courant %.17g -drift %s -initial random "
                            "-steps 20000",
                            formulation, basis, ppc, cells, courant, drift));
    PetscCall(CheckRow(row, options, growth));
    rows++;
  }
  fclose(file);
  CHECK(rows >= 15, "only %d rows read", rows);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
