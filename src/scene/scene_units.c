/*
   The wave speed of a scene, from moduli and density or as it is given, and whether the scene is in physical units.

   With K the bulk and G the shear modulus, M = K + 4/3 G is the stiffness against a strain in one direction alone, and
   c = sqrt(M / rho) the speed of pressure waves. M = E (1 - nu) / ((1 + nu) (1 - 2 nu)). In one dimension E is that of a
   bar whose sides are free, where M = E. See any book on elasticity, such as Landau and Lifshitz (1986), sections 5, 22.
*/
#include "scene/settings.h"
#include "base/text.h"
#include <math.h>

static const char *const moduli[] = {"young", "bulk", "shear"};

/* Adds the name of an option to a list, unless it was given. */
static void AddMissing(const MpmSettings *settings, const char name[], size_t room, char list[])
{
  if (MpmSettingsSource(settings, name) != MPM_FROM_DEFAULT) return;
  if (list[0]) MpmTextJoin(list, " and ", room);
  MpmTextJoin(list, name, room);
}

/* Refuses a modulus without the others that it needs; density and poisson have a meaning beside a wave speed, too. */
static PetscErrorCode CheckComplete(const MpmSettings *settings, const MpmScene *scene, const char modulus[])
{
  const PetscBool is_young    = MpmSettingsGiven(settings, "young");
  char            missing[64] = "";

  PetscFunctionBegin;
  if (!is_young) AddMissing(settings, "bulk", sizeof missing, missing);
  if (!is_young) AddMissing(settings, "shear", sizeof missing, missing);
  if (is_young && scene->layout.dim > 1) AddMissing(settings, "poisson", sizeof missing, missing);
  AddMissing(settings, "density", sizeof missing, missing);
  if (!missing[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRefuse(
      settings, modulus, "the wave speed needs %s besides; allowed: %s, bulk with shear and density, or sound_speed",
      missing, scene->layout.dim > 1 ? "young with poisson and density" : "young with density"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A formulation without a stress, in more than one dimension, has a bulk modulus at most. */
static PetscErrorCode CheckStress(const MpmSettings *settings, const MpmScene *scene, const char modulus[])
{

  PetscFunctionBegin;
  if (scene->layout.dim == 1 || MpmSceneHasPoisson(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRefuse(settings, modulus,
                              "%s has no stress with dim %" PetscInt_FMT "; allowed: bulk with shear 0, or sound_speed",
                              scene->scheme.formulation->name, scene->layout.dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FromYoung(const MpmSettings *settings, const MpmScene *scene, PetscReal *stiffness)
{
  PetscReal nu = 0;

  PetscFunctionBegin;
  PetscCall(MpmSettingsReal(settings, "young", stiffness));
  PetscCall(CheckStress(settings, scene, "young"));
  PetscCall(CheckComplete(settings, scene, "young"));
  if (scene->layout.dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  nu = scene->scheme.space.poisson;
  MpmSettingsRefuseIf(nu == 0.5, settings, "poisson",
                      "with young, the wave speed would be infinite; allowed: less than 0.5, or bulk with "
                      "shear 0, or sound_speed");
  *stiffness *= (1 - nu) / ((1 + nu) * (1 - 2 * nu));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* nu = (3 K - 2 G) / (2 (3 K + G)). */
static PetscErrorCode FromBulkAndShear(const MpmSettings *settings, MpmScene *scene, PetscReal *stiffness)
{
  PetscReal bulk, shear, nu;

  PetscFunctionBegin;
  PetscCall(CheckComplete(settings, scene, MpmSettingsGiven(settings, "bulk") ? "bulk" : "shear"));
  PetscCall(MpmSettingsReal(settings, "bulk", &bulk));
  PetscCall(MpmSettingsReal(settings, "shear", &shear));
  if (shear > 0) PetscCall(CheckStress(settings, scene, "shear"));
  *stiffness = bulk + 4 * shear / 3;
  nu         = (3 - 2 * (shear / bulk)) / (2 * (3 + shear / bulk));
  if (!MpmSceneHasPoisson(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(!(nu >= 0), settings, "shear",
                      "Poisson's ratio would be below 0; allowed: at most 1.5 times bulk");
  scene->scheme.space.poisson = nu;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FromModuli(const MpmSettings *settings, MpmScene *scene)
{
  static const char *const given[] = {"young", "bulk", "shear", "density"};
  PetscReal                stiffness;

  PetscFunctionBegin;
  if (MpmSettingsGiven(settings, "young"))
    PetscCall(FromYoung(settings, scene, &stiffness));
  else
    PetscCall(FromBulkAndShear(settings, scene, &stiffness));
  scene->wave_speed = sqrt(stiffness) / sqrt(scene->density);
  MpmSettingsRefuseIf(!isnormal(scene->wave_speed), settings,
                      MpmSettingsFarthest(settings, PETSC_STATIC_ARRAY_LENGTH(given), given),
                      "the wave speed is out of range with it; allowed: a number nearer to 1");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadWaveSpeed(const MpmSettings *settings, MpmScene *scene)
{
  static const char *const units[]    = {"density", "sound_speed", "cell_width", "dt"};
  PetscBool                has_moduli = PETSC_FALSE;

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(moduli); i++)
    if (MpmSettingsGiven(settings, moduli[i])) has_moduli = PETSC_TRUE;
  scene->physical = has_moduli;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(units); i++)
    if (MpmSettingsGiven(settings, units[i])) scene->physical = PETSC_TRUE;
  scene->has_step = MpmSettingsGiven(settings, "dt") || MpmSettingsSource(settings, "courant") != MPM_FROM_DEFAULT
                        ? PETSC_TRUE
                        : PETSC_FALSE;
  if (has_moduli)
    PetscCall(FromModuli(settings, scene));
  else if (MpmSettingsGiven(settings, "density") && !MpmSettingsGiven(settings, "sound_speed") &&
           MpmSettingsSource(settings, "wave_speed") == MPM_FROM_DEFAULT)
    PetscCall(MpmSettingsRefuse(settings, "density",
                                "there is no stiffness beside it; allowed: with young (and poisson with dim 2 or 3), "
                                "with bulk and shear, or with sound_speed"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
