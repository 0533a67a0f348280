/* What particles are made of, and in what they therefore differ. */
#include "scene/material.h"
#include <mpmstab/scene.h>
#include <string.h>

/* A number of a material that there is not. */
static PetscErrorCode CheckReader(const MpmSettings *settings, const char option[], const char why[])
{
  PetscFunctionBegin;
  if (MpmSettingsSource(settings, option) != MPM_FROM_DEFAULT && !MpmSettingsOverruled(settings, option, "material"))
    PetscCall(MpmSettingsRefuse(settings, option, why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool CanDiffer(const MpmFormulation *f)
{
  return f->materials;
}

static PetscErrorCode ReadRatios(const MpmSettings *settings, MpmScene *scene)
{
  MpmMaterial *m = &scene->layout.material;

  PetscFunctionBegin;
  PetscCall(MpmSettingsRequire(settings, scene, "material", CanDiffer, "density and stiffness of each particle"));
  PetscCall(MpmSettingsReal(settings, "density_ratio", &m->density));
  PetscCall(MpmSettingsReal(settings, "stiffness_ratio", &m->stiffness));
  m->inclusion[0] = scene->layout.grid.cells / 2.0;
  m->inclusion[1] = scene->layout.grid.cells;
  if (m->kind != MPM_MATERIAL_TWO)
    PetscCall(CheckReader(settings, "inclusion", "allowed: only with material two"));
  else if (MpmSettingsGiven(settings, "inclusion"))
    PetscCall(MpmSettingsRange(settings, "inclusion", m->inclusion));
  if (!(m->inclusion[0] >= 0 && m->inclusion[0] < m->inclusion[1] && m->inclusion[1] <= scene->layout.grid.cells))
    PetscCall(MpmSettingsRefuse(settings, "inclusion", "allowed: cells lo,hi within 0 and cells, lo < hi"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsMaterial(const MpmSettings *settings, MpmScene *scene)
{
  PetscBool *varies = scene->layout.varies;
  PetscInt   i;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "material", &i));
  scene->layout.material.kind = (MpmMaterialKind)i;
  if (scene->layout.material.kind != MPM_MATERIAL_UNIFORM)
    PetscCall(ReadRatios(settings, scene));
  else {
    PetscCall(CheckReader(settings, "density_ratio", "allowed: only with material two or graded"));
    PetscCall(CheckReader(settings, "stiffness_ratio", "allowed: only with material two or graded"));
    PetscCall(CheckReader(settings, "inclusion", "allowed: only with material two"));
    scene->layout.material.density = scene->layout.material.stiffness = 1;
  }
  varies[MPM_VOLUME]    = scene->layout.counts.n > 1 ? PETSC_TRUE : PETSC_FALSE;
  varies[MPM_MASS]      = varies[MPM_VOLUME] || scene->layout.material.density != 1 ? PETSC_TRUE : PETSC_FALSE;
  varies[MPM_STIFFNESS] = scene->layout.material.stiffness != 1 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
