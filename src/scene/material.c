/*
   Density rho and stiffness E of a particle at resting place x, relative to the first material's. Its mass is rho V,
   and the wave speed there is c sqrt(E / rho).
*/
#include "scene/layout.h"
#include "scene/material.h"
#include <math.h>

const char *const MpmPropertyNames[] = {NULL, "mass", "volume", "stiffness", "lambda", "shear", "mobility"};
const char *const MpmMaterialNames[] = {"uniform", "two", "graded", NULL};

/* Returns the power to which the ratios are raised at place x, in cells. */
static PetscReal Share(const MpmLayout *layout, const PetscReal x[])
{
  const MpmMaterial *m = &layout->material;
  const PetscReal    s = x[0] / layout->grid[0].cells;

  if (m->kind == MPM_MATERIAL_TWO) {
    for (PetscInt a = 0; a < layout->dim; a++)
      if (!(x[a] >= m->inclusion[a][0] && x[a] < m->inclusion[a][1])) return 0;
    return 1;
  }
  if (m->kind == MPM_MATERIAL_WAVE) return sin(2 * PETSC_PI * s);
  return layout->grid[0].ends[0] == MPM_PERIODIC ? 1 - fabs(2 * s - 1) : s;
}

static PetscReal Ratio(const MpmLayout *layout, PetscReal ratio, PetscInt64 id)
{
  PetscReal x[MPM_MAX_DIM];

  if (layout->material.kind == MPM_MATERIAL_UNIFORM || ratio == 1) return 1;
  MpmLayoutRest(layout, id, x);
  return pow(ratio, Share(layout, x));
}

PetscReal MpmMaterialDensity(const MpmLayout *layout, const PetscReal x[])
{
  return layout->material.kind == MPM_MATERIAL_UNIFORM ? 1 : pow(layout->material.density, Share(layout, x));
}

PetscReal MpmMaterialProperty(const MpmLayout *layout, MpmProperty property, PetscInt64 id)
{
  PetscInt  cell, j, count;
  PetscReal volume;

  if (layout->given) return layout->given->property[property] ? layout->given->property[property][id] : 1;
  if (property == MPM_STIFFNESS) return Ratio(layout, layout->material.stiffness, id);
  volume = 1;
  if (layout->dim == 1) {
    MpmLayoutSite(layout, layout->first[0] + id, &cell, &j, &count);
    volume = (PetscReal)layout->ppc[0] / count;
  }
  return property == MPM_MASS ? volume * Ratio(layout, layout->material.density, id) : volume;
}

void MpmMaterialBounds(const MpmLayout *layout, PetscReal bound[MPM_PROPERTIES])
{
  const PetscBool varied = layout->material.kind != MPM_MATERIAL_UNIFORM ? PETSC_TRUE : PETSC_FALSE;

  if (layout->given) {
    for (PetscInt w = MPM_NO_PROPERTY + 1; w < MPM_PROPERTIES; w++) bound[w] = MpmMaterialProperty(layout, w, 0);
    for (PetscInt64 id = 1; id < layout->particles; id++) {
      bound[MPM_MASS]      = PetscMin(bound[MPM_MASS], MpmMaterialProperty(layout, MPM_MASS, id));
      bound[MPM_VOLUME]    = PetscMax(bound[MPM_VOLUME], MpmMaterialProperty(layout, MPM_VOLUME, id));
      bound[MPM_STIFFNESS] = PetscMax(bound[MPM_STIFFNESS], MpmMaterialProperty(layout, MPM_STIFFNESS, id));
    }
    return;
  }
  bound[MPM_MASS] = varied ? PetscMin(1, layout->material.density) : 1;
  if (layout->material.kind == MPM_MATERIAL_WAVE) bound[MPM_MASS] = 1 / layout->material.density;
  bound[MPM_STIFFNESS] = varied ? PetscMax(1, layout->material.stiffness) : 1;
  bound[MPM_VOLUME]    = 1;
  for (PetscInt r = 0; r < layout->counts.n; r++)
    if (layout->counts.of[r])
      bound[MPM_VOLUME] = PetscMax(bound[MPM_VOLUME], (PetscReal)layout->ppc[0] / layout->counts.of[r]);
}

PetscReal MpmMaterialStiffness(PetscInt dim, PetscReal nu)
{
  return dim == 1 ? 1 : (1 - nu) / ((1 + nu) * (1 - 2 * nu));
}

void MpmMaterialUnits(const MpmScene *scene, PetscReal unit[MPM_PROPERTIES])
{
  const PetscReal density = scene->density > 0 ? scene->density : 1;

  for (PetscInt w = 0; w < MPM_PROPERTIES; w++) unit[w] = 1;
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    unit[MPM_VOLUME] *=
        scene->cell_width / (scene->layout.ppc[a] * (scene->scheme.space.finite ? scene->scheme.space.stretch[a] : 1));
  unit[MPM_MASS] = density * unit[MPM_VOLUME];
  unit[MPM_STIFFNESS] =
      density * PetscSqr(scene->wave_speed) / MpmMaterialStiffness(scene->layout.dim, scene->scheme.space.poisson);
}

PetscReal MpmMaterialColumn(const MpmScene *scene, const PetscReal unit[], MpmProperty property, PetscInt64 id)
{
  const MpmLayout *l     = &scene->layout;
  const PetscReal  value = MpmMaterialProperty(l, property, id);
  PetscReal        ratio;

  if (property == MPM_MOBILITY) return 1 - value;
  if (!l->varies[MPM_LAMBDA] || (property != MPM_STIFFNESS && property != MPM_LAMBDA)) return unit[property] * value;
  ratio = MpmMaterialProperty(l, MPM_LAMBDA, id) / MpmMaterialProperty(l, MPM_STIFFNESS, id);
  if (property == MPM_LAMBDA) return ratio / (1 + ratio);
  return unit[property] * value * MpmMaterialStiffness(l->dim, scene->scheme.space.poisson) /
         MpmMaterialStiffness(l->dim, ratio / (1 + ratio));
}

void MpmMaterialOne(const MpmMaterialNumbers *material, PetscInt dim, const PetscReal F[], const PetscReal dF[],
                    PetscReal tau[], PetscReal dtau[])
{
  const PetscReal *from[MPM_MOST_STRETCH], *along[MPM_MOST_STRETCH];
  PetscReal       *to[MPM_MAX_STRESS], *change[MPM_MAX_STRESS];

  for (PetscInt c = 0; c < MpmMaterialComponents(material, dim); c++) {
    from[c]  = &F[c];
    along[c] = dF ? &dF[c] : NULL;
  }
  for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++) {
    to[c]     = &tau[c];
    change[c] = dF ? &dtau[c] : NULL;
  }
  MpmMaterialStress(material, dim, 1, from, to);
  if (dF) MpmMaterialTangent(material, dim, 1, from, along, change);
}
