/* The task spectrum: mpmstab spectrum [SCENE.yaml] [-option value]... */
#include "task/expect.h"
#include "io/spectrum_files.h"
#include "report/results.h"
#include "task/task.h"

static PetscErrorCode Run(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmSpectrum *spectrum;

  PetscFunctionBegin;
  PetscCall(MpmSpectrumCreate(scene, request, started, &spectrum));
  PetscCall(MpmSpectrumWriteFiles(spectrum));
  if (request->json[0]) PetscCall(MpmSpectrumWriteJson(spectrum));
  PetscCall(MpmSpectrumPrint(spectrum));
  PetscCall(MpmExpectFinding(&request->expect, &spectrum->finding, missed));
  PetscCall(MpmSpectrumDestroy(&spectrum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskSpectrum(int argc, char **argv, PetscReal started, int *status)
{
  PetscFunctionBegin;
  PetscCall(MpmTaskOnScene("spectrum", Run, argc, argv, started, status));
  PetscFunctionReturn(PETSC_SUCCESS);
}
