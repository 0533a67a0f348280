/* Damping and viscosity of a scene, in the units of a step: c / h, and rho c h. */
#include "scene/settings.h"

static PetscBool HasForce(const MpmFormulation *f)
{
  MpmOp        room[MPM_MOST_TABLE_LINES];
  PetscInt     n;
  const MpmOp *ops   = MpmFormulationLines(f, NULL, NULL, room, &n);
  PetscBool    force = PETSC_FALSE;

  for (PetscInt o = 0; o < n; o++) {
    if (ops[o].kind == MPM_IMPLICIT) return PETSC_FALSE;
    if (ops[o].kind == MPM_DIV && f->particle_ranks[ops[o].src] == MPM_TENSOR) force = PETSC_TRUE;
  }
  return force;
}

static PetscErrorCode Check(const MpmSettings *settings, const MpmScene *scene, const char option[], PetscReal value)
{
  PetscFunctionBegin;
  if (value == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRequire(settings, scene, option, HasForce, "explicit force of a stress that it could join"));
  MpmSettingsRefuseIf(
      scene->safety > 0, settings, option,
      "courant auto goes by the speed of waves, and this lowers the largest step besides; allowed: with "
      "a number for courant");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A viscosity in units of rho c h. */
static PetscErrorCode Scaled(const MpmSettings *settings, const MpmScene *scene, const char option[], PetscReal *value)
{
  PetscFunctionBegin;
  PetscCall(Check(settings, scene, option, *value));
  MpmSettingsRefuseIf(*value != 0 && scene->layout.dim > 1 && MpmSpaceIsPrestressed(&scene->scheme.space), settings,
                      option, "allowed: with dim 1, without a prestress, or with kinematics finite");
  if (*value == 0 || !MpmSceneIsPhysical(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(!(scene->density > 0), settings, option,
                      "in physical units a viscosity needs the density; allowed: with density");
  *value /= scene->density * scene->wave_speed * scene->cell_width;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadDamping(const MpmSettings *settings, MpmScene *scene)
{
  MpmSpace       *space = &scene->scheme.space;
  const PetscReal nu    = space->finite && !scene->law->solid ? 0.5 : space->poisson,
                  mu    = scene->layout.dim == 1 ? 0 : (1 - 2 * nu) / (2 * (1 - nu));
  PetscReal solid = scene->viscosity, fluid = scene->shear_viscosity, bulk = scene->bulk_viscosity;

  PetscFunctionBegin;
  PetscCall(Check(settings, scene, "grid_damping", scene->grid_damping));
  PetscCall(Check(settings, scene, "local_damping", space->local));
  PetscCall(Scaled(settings, scene, "viscosity", &solid));
  PetscCall(Scaled(settings, scene, "shear_viscosity", &fluid));
  PetscCall(Scaled(settings, scene, "bulk_viscosity", &bulk));
  space->damping      = scene->grid_damping * (MpmSceneIsPhysical(scene) ? scene->cell_width / scene->wave_speed : 1);
  space->viscous[0]   = solid * (1 - 2 * mu) - 2 * fluid / 3 + bulk;
  space->viscous[1]   = solid * mu + fluid;
  space->proportional = (fluid == 0 && bulk == 0) || scene->layout.dim == 1 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
