/* From settings to Mach numbers, and to the drift that they make. */
#include "scene/settings.h"
#include <mpmstab/scheme.h>
#include <math.h>

#define MOST_DRIFT 1e6 /* cells per step */

PetscErrorCode MpmSettingsReadMach(const MpmSettings *settings, PetscInt dim, MpmMach *mach)
{
  MpmFraction number[MPM_MAX_DIM];
  PetscBool   ok;

  PetscFunctionBegin;
  *mach = (MpmMach){.dim = dim, .unit = {.den = 1}};
  if (!MpmSettingsGiven(settings, "mach")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsFractions(settings, "mach", dim, number));
  MpmMachCreate(dim, number, mach, &ok);
  MpmSettingsRefuseIf(!ok, settings, "mach", "allowed: numbers of at most 15 digits, or fractions");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first of two options that was given, as a fraction; the number itself where neither was. */
static PetscErrorCode OneOf(const MpmSettings *settings, const char name[], const char other[], PetscReal number,
                            MpmFraction *fraction)
{
  MpmFraction each[MPM_MAX_DIM];
  const char *given = MpmSettingsGiven(settings, name) ? name : MpmSettingsGiven(settings, other) ? other : NULL;

  PetscFunctionBegin;
  *fraction = (MpmFraction){.value = number};
  if (!given) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsFractions(settings, given, 1, each));
  *fraction = each[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   k as a fraction: courant as it was given, or c dt / h. Where these are no fractions with short terms it is the double,
   and then the drift is the short fraction that is the same double, if there is one.
*/
static PetscErrorCode CourantOf(const MpmSettings *settings, const MpmScene *scene, MpmFraction *courant)
{
  const PetscInt cells     = MpmSettingsGiven(settings, "cell_width") ? 1 : scene->layout.grid[0].cells;
  MpmFraction    factor[4] = {[2] = {cells, 1, cells}}, width[MPM_MAX_DIM];

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "dt")) {
    PetscCall(OneOf(settings, "courant", "courant", scene->step.courant, courant));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(OneOf(settings, "wave_speed", "sound_speed", scene->wave_speed, &factor[0]));
  PetscCall(OneOf(settings, "dt", "dt", scene->dt, &factor[1]));
  if (MpmSettingsGiven(settings, "cell_width"))
    PetscCall(MpmSettingsFractions(settings, "cell_width", 1, width));
  else
    PetscCall(MpmSettingsFractions(settings, "length", scene->layout.dim, width));
  factor[3] = (MpmFraction){width[0].den, width[0].num, 1 / width[0].value};
  *courant  = MpmFractionProduct(4, factor);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsMachDrift(const MpmSettings *settings, MpmScene *scene)
{
  MpmFraction factors[2], part;
  MpmMach     mach;

  PetscFunctionBegin;
  PetscCall(MpmSettingsReadMach(settings, scene->layout.dim, &mach));
  if (!MpmSettingsGiven(settings, "mach")) PetscFunctionReturn(PETSC_SUCCESS);
  factors[0] = mach.unit;
  PetscCall(CourantOf(settings, scene, &factors[1]));
  part = MpmFractionProduct(2, factors);
  if (!part.den) part = MpmFractionNear(mach.unit.value * scene->step.courant, MPM_LONGEST_PERIOD);
  MpmMachDrift(&mach, &part, scene->step.drift);
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    MpmSettingsRefuseIf(!(PetscAbsReal(scene->step.drift[a].value) <= MOST_DRIFT), settings, "mach",
                        "allowed: at most 1e6 cells per step");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCheckPeriod(const MpmSettings *settings, const MpmScene *scene, const MpmMach *mach)
{
  const PetscReal part = mach->unit.value * scene->step.courant;
  MpmFraction     near, courant;
  PetscInt64      common = 1;
  char            over[32];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < scene->layout.dim; a++) {
    const PetscInt64 den = scene->step.drift[a].den;

    common = den ? common / MpmCommonDivisor(common, den) * den : MPM_LONGEST_PERIOD + 1;
    if (common > MPM_LONGEST_PERIOD) break;
  }
  if (common <= MPM_LONGEST_PERIOD) PetscFunctionReturn(PETSC_SUCCESS);
  near = MpmFractionNearest(part, MPM_LONGEST_PERIOD);
  if (!near.num) near = (MpmFraction){1, MPM_LONGEST_PERIOD, 1.0 / MPM_LONGEST_PERIOD};
  courant = MpmMachCourant(mach, &near);
  (void)snprintf(over, sizeof over, courant.den == 1 ? "" : "/%" PetscInt64_FMT, courant.den);
  PetscCall(
      MpmSettingsRefuse(settings, "mach",
                        "at Courant number %.10g particles are not back in their places within %d steps; allowed: the "
                        "nearest Courant number is %" PetscInt64_FMT "%s ('mpmstab run' takes any)",
                        scene->step.courant, MPM_LONGEST_PERIOD, courant.num, over));
  PetscFunctionReturn(PETSC_SUCCESS);
}
