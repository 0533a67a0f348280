/*
   Density rho and stiffness E relative to the first material's, at a resting place x: mass = rho V, so that the wave
   speed there is c sqrt(E / rho).
*/
#include "scene/layout.h"
#include "scene/material.h"
#include <math.h>

const char *const MpmPropertyNames[] = {NULL, "mass", "volume", "stiffness"};
const char *const MpmMaterialNames[] = {"uniform", "two", "graded", NULL};

/* The power of the ratios that holds at place x, in cells from 0 to their number. */
static PetscReal Share(const MpmScene *scene, PetscReal x)
{
  const MpmMaterial *m = &scene->material;
  const PetscReal    s = x / scene->cells;

  if (m->kind == MPM_MATERIAL_TWO) return x >= m->inclusion[0] && x < m->inclusion[1] ? 1 : 0;
  return MpmSceneIsPeriodic(scene) ? 1 - fabs(2 * s - 1) : s;
}

static PetscReal Ratio(const MpmScene *scene, PetscReal ratio, PetscInt64 id)
{
  PetscInt  cell;
  PetscReal xi;

  if (scene->material.kind == MPM_MATERIAL_UNIFORM || ratio == 1) return 1;
  MpmLayoutPlace(scene, id, &cell, &xi);
  cell = (cell + scene->cells) % scene->cells; /* jitter may take it over the end of a periodic domain */
  return pow(ratio, Share(scene, cell + xi));
}

PetscReal MpmMaterialProperty(const MpmScene *scene, MpmProperty property, PetscInt64 id)
{
  PetscInt  cell, j, count;
  PetscReal volume;

  if (property == MPM_STIFFNESS) return Ratio(scene, scene->material.stiffness, id);
  MpmLayoutSite(scene, scene->first + id, &cell, &j, &count);
  volume = (PetscReal)scene->ppc / count;
  return property == MPM_MASS ? volume * Ratio(scene, scene->material.density, id) : volume;
}

void MpmMaterialBounds(const MpmScene *scene, PetscReal bound[MPM_PROPERTIES])
{
  const PetscBool varied = scene->material.kind != MPM_MATERIAL_UNIFORM ? PETSC_TRUE : PETSC_FALSE;

  bound[MPM_MASS]      = varied ? PetscMin(1, scene->material.density) : 1;
  bound[MPM_STIFFNESS] = varied ? PetscMax(1, scene->material.stiffness) : 1;
  bound[MPM_VOLUME]    = 1;
  for (PetscInt r = 0; r < scene->counts.n; r++)
    if (scene->counts.of[r])
      bound[MPM_VOLUME] = PetscMax(bound[MPM_VOLUME], (PetscReal)scene->ppc / scene->counts.of[r]);
}
