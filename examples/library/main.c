/* Prints the critical Courant number of the scene in a YAML file; without one, of usl on hats, two particles a cell. */
#include <mpmstab/mpmstab.h>

static PetscErrorCode PrintLimit(const char path[])
{
  MpmScene       *scene;
  MpmCriticalCase of;
  MpmCritical     limit;

  PetscFunctionBeginUser;
  if (path)
    PetscCall(MpmSceneFromFile(path, &scene));
  else
    PetscCall(MpmSceneFromText("{formulation: usl, basis: linear, ppc: 2}", &scene));
  of = MpmCriticalCaseOf(scene, 1e-6); /* growth up to 1 + 1e-6 per step counts as stable */
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &limit));
  MpmPrint("critical Courant number %.6g\n", (double)limit.courant);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

int main(int argc, char **argv)
{
  if (MpmInitialize(&argc, &argv)) return MPM_EXIT_REFUSED;
  return MpmFinalize(PrintLimit(argc > 1 ? argv[1] : NULL), MPM_EXIT_DONE);
}
