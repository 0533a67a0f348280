/* The task ensemble: mpmstab ensemble [SCENE.yaml] [-option value]... */
#include "report/results.h"
#include "task/expect.h"
#include "task/task.h"

PetscErrorCode MpmTaskEnsemble(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmExpect    expect = request->expect;
  MpmEnsemble *ensemble;

  PetscFunctionBegin;
  expect.has[MPM_EXPECT_SPECTRUM] = PETSC_FALSE; /* it is about one layout */
  PetscCall(MpmEnsembleCreate(scene, request, &ensemble));
  if (request->csv[0]) PetscCall(MpmEnsembleWriteCsv(ensemble));
  PetscCall(MpmEnsembleReport(ensemble, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&expect, &ensemble->finding, missed));
  PetscCall(MpmExpectNumber(&expect, MPM_EXPECT_SHARE, ensemble->share, missed));
  PetscCall(MpmEnsembleDestroy(&ensemble));
  PetscFunctionReturn(PETSC_SUCCESS);
}
