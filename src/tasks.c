/* The list of tasks and the program's ten lines about itself. */
#include <mpmstab/task.h>

const MpmTask MpmTasks[] = {
    {"run", "march a scene: error against the exact solution, measured growth, energy, throughput", MpmTaskRun},
    {"list", "formulations, bases, transfers, layouts and options", MpmTaskList},
    {NULL, NULL, NULL},
};

PetscErrorCode MpmPrintUsage(void)
{
  PetscFunctionBegin;
  PetscCall(PetscPrintf(PETSC_COMM_WORLD,
                        "mpmstab %s: is this material point scheme stable, for which time step, and how accurate?\n\n"
                        "  [mpirun -n R] mpmstab TASK [SCENE.yaml] [-option value]...\n\n",
                        MPMSTAB_VERSION));
  for (const MpmTask *task = MpmTasks; task->name; task++)
    PetscCall(PetscPrintf(PETSC_COMM_WORLD, "  %-5s %s\n", task->name, task->summary));
  PetscCall(PetscPrintf(PETSC_COMM_WORLD, "\n  mpmstab run -formulation gas1 -initial random    a first run\n"
                                          "  mpmstab list options                             every option\n"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
