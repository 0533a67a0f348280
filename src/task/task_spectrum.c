/* mpmstab spectrum [SCENE.yaml] [-option value]... */
#include "task/expect.h"
#include "io/spectrum_files.h"
#include "report/results.h"
#include "task/task.h"

/* SLEPc is there for this task alone: the others start without it. */
static PetscErrorCode Run(const MpmScene *scene, PetscReal started, PetscInt *missed)
{
  MpmSpectrum *spectrum;

  PetscFunctionBegin;
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(MpmSpectrumCreate(scene, started, &spectrum));
  PetscCall(MpmSpectrumPrint(spectrum));
  PetscCall(MpmSpectrumWriteFiles(spectrum));
  if (scene->json[0]) PetscCall(MpmSpectrumWriteJson(spectrum));
  PetscCall(MpmExpectFinding(&scene->expect, &spectrum->finding, missed));
  PetscCall(MpmSpectrumDestroy(&spectrum));
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskSpectrum(int argc, char **argv, PetscReal started, int *status)
{
  PetscFunctionBegin;
  PetscCall(MpmTaskOnScene("spectrum", Run, argc, argv, started, status));
  PetscFunctionReturn(PETSC_SUCCESS);
}
