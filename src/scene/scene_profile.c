/* What follows from a scene: its exact solution, the size of its fields, and its numbers of particles as text. */
#include <mpmstab/scene.h>
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
  if (!MpmInitialHasExact(scene->initial) || scene->layout.material.kind != MPM_MATERIAL_UNIFORM) return PETSC_FALSE;
  return MpmSceneIsFull(scene) || (scene->layout.first[0] == 0 && scene->layout.grid[0].ends[1] == MPM_FREE)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* The length of the material, since a bar may end before its domain does. */
static PetscReal LengthOf(const MpmScene *scene)
{
  return MpmSceneIsPeriodic(scene) || scene->layout.particles == scene->layout.sites
             ? scene->length[0]
             : scene->cell_width * (PetscReal)scene->layout.particles / scene->layout.ppc[0];
}

/* Wave number K and phase of a mode in a periodic domain, between two ends alike, or between a fixed and a free end. */
static void SetWave(const MpmScene *scene, MpmProfile *p)
{
  const PetscBool fixed[2] = {MpmEndIsFixed(scene->layout.grid[0].ends[0]),
                              MpmEndIsFixed(scene->layout.grid[0].ends[1])};

  p->wavenumber = 2 * PETSC_PI * scene->mode[0] / p->length;
  if (MpmSceneIsPeriodic(scene)) return;
  p->wavenumber = (fixed[0] == fixed[1] ? scene->mode[0] : scene->mode[0] - 0.5) * PETSC_PI / p->length;
  p->phase      = fixed[0] ? 0 : PETSC_PI / 2;
  for (int end = 0; end < 2; end++) p->image[end] = fixed[end] ? -1 : 1;
}

MpmProfile MpmSceneProfile(const MpmScene *scene, PetscReal amplitude)
{
  MpmProfile profile = {.initial    = scene->initial,
                        .length     = LengthOf(scene),
                        .wave_speed = scene->wave_speed,
                        .cell_width = scene->cell_width,
                        .amplitude  = amplitude};

  SetWave(scene, &profile);
  return profile;
}

PetscInt MpmSceneExponent(const MpmScene *scene)
{
  const MpmProfile profile = MpmSceneProfile(scene, scene->amplitude);
  PetscReal        largest = 0;

  if (!MpmInitialHasExact(scene->initial)) return ilogb(scene->amplitude);
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++)
    largest = PetscMax(largest, scene->scheme.formulation->wave->amplitude(&profile, f));
  return ilogb(largest);
}

PetscErrorCode MpmSceneCountsText(const MpmScene *scene, size_t room, char text[])
{
  PetscFunctionBegin;
  text[0] = '\0';
  for (PetscInt r = 0; r < scene->layout.counts.n; r++) {
    const size_t used = strlen(text);

    PetscCall(PetscSNPrintf(text + used, room - used, "%s%" PetscInt_FMT, r ? "," : "", scene->layout.counts.of[r]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
