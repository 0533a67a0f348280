/* mpmstab spectrum [SCENE.yaml] [-option value]... */
#include <mpmstab/expect.h>
#include <mpmstab/spectrum.h>
#include <mpmstab/task.h>

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
  PetscCall(MpmSettingsCheckUnused());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskSpectrum(int argc, char **argv, PetscReal started, int *status)
{
  const char *path   = argc > 0 && argv[0][0] != '-' ? argv[0] : NULL;
  PetscInt    missed = 0;
  MpmScene   *scene;

  PetscFunctionBegin;
  PetscCall(MpmSettingsCheckCommandLine("spectrum", argc, argv, path ? 1 : 0));
  PetscCall(MpmSceneCreate("spectrum", path, &scene));
  PetscCall(Run(scene, started, &missed));
  PetscCall(MpmSceneDestroy(&scene));
  *status = missed ? MPM_EXIT_MISSED : MPM_EXIT_DONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
