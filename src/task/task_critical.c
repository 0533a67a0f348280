/* The task critical: mpmstab critical [SCENE.yaml] [-option value]... */
#include "linalg/eigen.h"
#include "report/results.h"
#include "task/expect.h"
#include "task/task.h"

static PetscErrorCode One(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  const MpmCriticalCase of     = MpmCriticalCaseOf(scene, request->tolerance);
  MpmExpect             expect = request->expect;
  MpmCritical           critical;

  PetscFunctionBegin;
  expect.has_spectrum = PETSC_FALSE; /* it is about the waves on the scene's grid */
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &critical));
  if (request->csv[0]) PetscCall(MpmCriticalWriteCsv(request->csv, scene, &critical));
  if (request->json[0]) PetscCall(MpmCriticalWriteJson(request->json, scene, &critical, MPI_Wtime() - started));
  PetscCall(MpmCriticalPrint(scene, request, &critical));
  PetscCall(MpmExpectFinding(&expect, &critical.asked, missed));
  PetscCall(MpmExpectCritical(&expect, critical.courant, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Run(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  PetscFunctionBegin;
  if (MpmSymbolWhyNot(&scene->layout)) PetscCall(MpmEigenTryOptions(MPM_EIGEN_DENSE));
  PetscCall(MpmEigenRefuseUnread());
  *missed = 0;
  if (request->survey)
    PetscCall(MpmCriticalPrintSurvey(scene, request));
  else
    PetscCall(One(scene, request, started, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskCritical(int argc, char **argv, PetscReal started, int *status)
{
  PetscFunctionBegin;
  PetscCall(MpmTaskOnScene("critical", Run, argc, argv, started, status));
  PetscFunctionReturn(PETSC_SUCCESS);
}
