/*
   Density rho and stiffness E of a particle at resting place x, relative to the first material's. Its mass is rho V,
   and the wave speed there is c sqrt(E / rho).
*/
#include "scene/layout.h"
#include "scene/material.h"
#include <math.h>

const char *const MpmPropertyNames[] = {NULL, "mass", "volume", "stiffness"};
const char *const MpmMaterialNames[] = {"uniform", "two", "graded", NULL};

/* Returns the power to which the ratios are raised at place x, in cells. */
static PetscReal Share(const MpmLayout *layout, PetscReal x)
{
  const MpmMaterial *m = &layout->material;
  const PetscReal    s = x / layout->grid.cells;

  if (m->kind == MPM_MATERIAL_TWO) return x >= m->inclusion[0] && x < m->inclusion[1] ? 1 : 0;
  return MpmLayoutIsPeriodic(layout) ? 1 - fabs(2 * s - 1) : s;
}

static PetscReal Ratio(const MpmLayout *layout, PetscReal ratio, PetscInt64 id)
{
  PetscInt  cell;
  PetscReal xi;

  if (layout->material.kind == MPM_MATERIAL_UNIFORM || ratio == 1) return 1;
  MpmLayoutPlace(layout, id, &cell, &xi);
  cell = (cell + layout->grid.cells) % layout->grid.cells; /* jitter may cross the end of a periodic domain */
  return pow(ratio, Share(layout, cell + xi));
}

PetscReal MpmMaterialProperty(const MpmLayout *layout, MpmProperty property, PetscInt64 id)
{
  PetscInt  cell, j, count;
  PetscReal volume;

  if (property == MPM_STIFFNESS) return Ratio(layout, layout->material.stiffness, id);
  MpmLayoutSite(layout, layout->first + id, &cell, &j, &count);
  volume = (PetscReal)layout->ppc / count;
  return property == MPM_MASS ? volume * Ratio(layout, layout->material.density, id) : volume;
}

void MpmMaterialBounds(const MpmLayout *layout, PetscReal bound[MPM_PROPERTIES])
{
  const PetscBool varied = layout->material.kind != MPM_MATERIAL_UNIFORM ? PETSC_TRUE : PETSC_FALSE;

  bound[MPM_MASS]      = varied ? PetscMin(1, layout->material.density) : 1;
  bound[MPM_STIFFNESS] = varied ? PetscMax(1, layout->material.stiffness) : 1;
  bound[MPM_VOLUME]    = 1;
  for (PetscInt r = 0; r < layout->counts.n; r++)
    if (layout->counts.of[r])
      bound[MPM_VOLUME] = PetscMax(bound[MPM_VOLUME], (PetscReal)layout->ppc / layout->counts.of[r]);
}
