/* mpmstab critical [SCENE.yaml] [-option value]... */
#include "report/results.h"
#include "task/expect.h"
#include "task/task.h"
#include <slepcsys.h>

static PetscErrorCode One(const MpmScene *scene, PetscReal started, PetscInt *missed)
{
  const MpmCriticalCase of     = MpmCriticalCaseOf(scene);
  MpmExpect             expect = scene->expect;
  MpmCritical           critical;

  PetscFunctionBegin;
  expect.has_spectrum = PETSC_FALSE; /* that is of the waves on the scene's grid */
  if (MpmSymbolWhyNot(&scene->layout)) PetscCall(SlepcInitializeNoArguments());
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &critical));
  PetscCall(MpmCriticalPrint(scene, &critical));
  if (scene->csv[0]) PetscCall(MpmCriticalWriteCsv(scene->csv, scene, &critical));
  if (scene->json[0]) PetscCall(MpmCriticalWriteJson(scene, &critical, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&expect, &critical.asked, missed));
  PetscCall(MpmExpectCritical(&expect, critical.courant, missed));
  if (MpmSymbolWhyNot(&scene->layout)) PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Run(const MpmScene *scene, PetscReal started, PetscInt *missed)
{
  PetscFunctionBegin;
  *missed = 0;
  if (scene->survey)
    PetscCall(MpmCriticalPrintSurvey(scene));
  else
    PetscCall(One(scene, started, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskCritical(int argc, char **argv, PetscReal started, int *status)
{
  PetscFunctionBegin;
  PetscCall(MpmTaskOnScene("critical", Run, argc, argv, started, status));
  PetscFunctionReturn(PETSC_SUCCESS);
}
