/* What follows from a scene: whether it has an exact solution, the size of its fields, and its numbers of particles. */
#include "scene/solution.h"
#include <math.h>
#include <string.h>

PetscBool MpmSceneHasPoisson(const MpmScene *scene)
{
  for (PetscInt f = 0; scene->scheme.formulation->particle_fields[f]; f++)
    if (scene->scheme.formulation->particle_ranks[f] == MPM_TENSOR && scene->layout.dim > 1) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscBool MpmSceneHasExact(const MpmScene *scene)
{
  if (!scene->scheme.formulation->wave) return PETSC_FALSE;
  if (scene->scheme.space.finite) return MpmSolutionOf(scene) ? PETSC_TRUE : PETSC_FALSE;
  if (!MpmInitialHasExact(scene->initial) || scene->layout.material.kind != MPM_MATERIAL_UNIFORM) return PETSC_FALSE;
  if (MpmSpaceIsDamped(&scene->scheme.space) &&
      (scene->initial != MPM_INITIAL_MODE || scene->scheme.space.displaced || scene->scheme.space.local != 0))
    return PETSC_FALSE;
  if (MpmSceneIsFull(scene)) return PETSC_TRUE;
  return scene->layout.dim == 1 && scene->layout.first[0] == 0 && scene->layout.grid[0].ends[1] == MPM_FREE
             ? PETSC_TRUE
             : PETSC_FALSE;
}

const char *MpmSceneEquations(const MpmScene *scene)
{
  const MpmWave *wave = scene->scheme.formulation->wave;

  if (scene->scheme.space.finite) return MpmSolutionOf(scene)->equations;
  return scene->layout.dim == 1 ? wave->equations : wave->equations_nd;
}

PetscInt MpmSceneExponent(const MpmScene *scene)
{
  const MpmProfile profile = MpmSceneProfile(scene, scene->amplitude);
  PetscReal        largest = 0;

  if (!MpmInitialHasExact(scene->initial)) return ilogb(scene->amplitude);
  for (PetscInt r = 0; r < scene->scheme.table->nstate; r++)
    largest = PetscMax(largest, scene->scheme.formulation->wave->amplitude(&profile, scene->scheme.table->field[r]));
  return ilogb(largest);
}

void MpmSceneCountsText(const MpmScene *scene, size_t room, char text[])
{
  text[0] = '\0';
  for (PetscInt r = 0; r < scene->layout.counts.n; r++) {
    const size_t used = strlen(text);

    (void)snprintf(text + used, room - used, "%s%" PetscInt_FMT, r ? "," : "", scene->layout.counts.of[r]);
  }
}
