/* Prints the critical Courant number of a scheme: usl on hats with two particles a cell, or what the options say. */
#include <mpmstab/mpmstab.h>

static PetscErrorCode PrintLimit(void)
{
  MpmScene   *scene;
  MpmCritical limit;

  PetscFunctionBeginUser;
  PetscCall(MpmSceneCreate("critical", NULL, &scene));
  PetscCall(MpmCriticalFind(scene, PETSC_FALSE, &limit));
  MpmPrint("%s: critical Courant number %.6g\n", scene->formulation->name, (double)limit.courant);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  if (MpmInitialize(&argc, &argv)) return MPM_EXIT_REFUSED;
  return MpmFinalize(PrintLimit(), MPM_EXIT_DONE);
}
