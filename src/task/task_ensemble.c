/* mpmstab ensemble [SCENE.yaml] [-option value]... */
#include "report/results.h"
#include "task/expect.h"
#include "task/task.h"
#include <slepcsys.h>

static PetscErrorCode Run(const MpmScene *scene, PetscReal started, PetscInt *missed)
{
  MpmExpect    expect = scene->expect;
  MpmEnsemble *ensemble;

  PetscFunctionBegin;
  expect.has_spectrum = PETSC_FALSE; /* that is of one layout */
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(MpmEnsembleCreate(scene, &ensemble));
  PetscCall(MpmEnsemblePrint(ensemble));
  if (scene->csv[0]) PetscCall(MpmEnsembleWriteCsv(ensemble));
  if (scene->json[0]) PetscCall(MpmEnsembleWriteJson(ensemble, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&expect, &ensemble->finding, missed));
  PetscCall(MpmExpectShare(&expect, ensemble->share, missed));
  PetscCall(MpmEnsembleDestroy(&ensemble));
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskEnsemble(int argc, char **argv, PetscReal started, int *status)
{
  PetscFunctionBegin;
  PetscCall(MpmTaskOnScene("ensemble", Run, argc, argv, started, status));
  PetscFunctionReturn(PETSC_SUCCESS);
}
