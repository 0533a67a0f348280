/* The list of tasks, the steps that all tasks on a scene share, and the usage text. */
#include <mpmstab/errors.h>
#include "base/memory.h"
#include "base/stop.h"
#include "io/checkpoint.h"
#include "io/mode_file.h"
#include "scene/settings.h"
#include "task/task.h"

const MpmTask MpmTasks[] = {
    {"run", "march a scene: error against the exact solution, measured growth, energy, throughput", MpmTaskRun},
    {"spectrum", "eigenvalues of the assembled operator beside symbol, closed forms and measured growth",
     MpmTaskSpectrum},
    {"symbol", "abs(G) over the phase beta, exact for uniform layouts", MpmTaskSymbol},
    {"critical", "the largest stable Courant number, and the wave or mode that limits it", MpmTaskCritical},
    {"map", "growth over two of Courant number, drift, offset and particles per cell", MpmTaskMap},
    {"ensemble", "the share of random layouts that are unstable, with its 95% confidence interval", MpmTaskEnsemble},
    {"list", "formulations, bases, transfers, boundaries, layouts, options; 'list codes': public codes", MpmTaskList},
    {NULL, NULL, NULL},
};

/* Refuses files from which a run is to start and cannot. A matrix in the place of a scene has no run. */
static PetscErrorCode CheckStart(const MpmScene *scene, const MpmRequest *request)
{
  PetscFunctionBegin;
  if (!scene) PetscFunctionReturn(PETSC_SUCCESS);
  if (scene->initial == MPM_INITIAL_EIGENMODE && request->mode_file[0])
    PetscCall(MpmModeFileCheck(scene, request->mode_file));
  if (request->restart[0]) PetscCall(MpmCheckpointCheck(request->restart, scene, request->steps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskOnScene(const char task[], MpmSceneWork work, int argc, char **argv, PetscReal started,
                              int *status)
{
  const char *path   = argc > 0 && argv[0][0] != '-' ? argv[0] : NULL;
  PetscInt    missed = 0;
  MpmScene   *scene;
  MpmRequest  request;

  PetscFunctionBegin;
  PetscCall(MpmSettingsCheckCommandLine(task, argc, argv, path ? 1 : 0));
  PetscCall(MpmSettingsCheckOutside(task, path));
  PetscCall(MpmMemoryCheckLapack());
  PetscCall(MpmSceneCreate(task, path, &scene, &request));
  PetscCall(CheckStart(scene, &request));
  MpmProgressShow(request.progress);
  PetscCall(work(scene, &request, started, &missed));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(MpmSettingsCheckUnused());
  *status = MpmStopped() ? MPM_EXIT_STOPPED : missed ? MPM_EXIT_MISSED : MPM_EXIT_DONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPrintUsage(void)
{
  PetscFunctionBegin;
  MpmPrint("mpmstab %s: is this material point scheme stable, for which time step, and how accurate?\n"
           "  [mpirun -n R] mpmstab TASK [SCENE.yaml] [-option value]...\n",
           MPMSTAB_VERSION);
  for (const MpmTask *task = MpmTasks; task->name; task++) MpmPrint("  %-9s%s\n", task->name, task->summary);
  MpmPrint("  mpmstab spectrum -drift 1/8 -cells 16 -courant 0.1    a first answer\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}
