/* mpmstab run [SCENE.yaml] [-option value]... */
#include <mpmstab/expect.h>
#include <mpmstab/task.h>

PetscErrorCode MpmTaskRun(int argc, char **argv, PetscReal started, int *status)
{
  const char *path   = argc > 0 && argv[0][0] != '-' ? argv[0] : NULL;
  PetscInt    missed = 0;
  MpmScene   *scene;
  MpmRun     *run;

  PetscFunctionBegin;
  PetscCall(MpmSettingsCheckCommandLine("run", argc, argv, path ? 1 : 0));
  PetscCall(MpmSceneCreate("run", path, &scene));
  PetscCall(MpmRunCreate(scene, started, &run));
  PetscCall(MpmRunPrint(run));
  if (scene->json[0]) PetscCall(MpmRunWriteJson(run));
  PetscCall(MpmExpectRun(run, &missed));
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(MpmSettingsCheckUnused());
  *status = missed ? MPM_EXIT_MISSED : MPM_EXIT_DONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
