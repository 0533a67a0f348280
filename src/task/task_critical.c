/* mpmstab critical [SCENE.yaml] [-option value]... */
#include "report/results.h"
#include "task/expect.h"
#include "task/task.h"

static PetscErrorCode One(const MpmScene *scene, PetscReal started, PetscInt *missed)
{
  MpmExpect   expect = scene->expect;
  MpmCritical critical;

  PetscFunctionBegin;
  expect.has_spectrum = PETSC_FALSE; /* that is of the waves on the scene's grid */
  PetscCall(MpmCriticalFind(scene, PETSC_FALSE, &critical));
  if (scene->csv[0]) PetscCall(MpmCriticalWriteCsv(scene->csv, scene, 1, &scene, &critical));
  if (scene->json[0]) PetscCall(MpmCriticalWriteJson(scene, &critical, MPI_Wtime() - started));
  PetscCall(MpmCriticalPrint(scene, &critical));
  PetscCall(MpmExpectFinding(&expect, &critical.asked, missed));
  PetscCall(MpmExpectCritical(&expect, critical.courant, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Run(const MpmScene *scene, PetscReal started, PetscInt *missed)
{
  PetscFunctionBegin;
  *missed = 0;
  if (scene->survey)
    PetscCall(MpmCriticalSurvey(scene));
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
