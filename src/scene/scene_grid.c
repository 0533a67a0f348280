/*
   From settings to a scene: wave speed and units, the grid, where particles are in it, the time step, and how far particles
   move in one.
*/
#include "base/text.h"
#include "scene/layout.h"
#include "scene/settings.h"
#include <mpmstab/scheme.h>
#include <math.h>
#include <string.h>

#define MOST_DRIFT 1e6 /* cells per step */

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

/* From settings to Mach numbers, and to the drift that they make. */

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

/* The drift M k of a scene whose Courant number is known, if mach is given. */
static PetscErrorCode MachDrift(const MpmSettings *settings, MpmScene *scene)
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

/*
   From settings to a scene: the grid, where particles are in it, the time step, and how far particles move in one.
*/

#define MOST_PARTICLES (PETSC_MAX_INT / 2)
#define SAME_WIDTH 1e-12

/* ---- units, grid and time ---- */

/* The domain has the length of its cells, whose width is given. */
static PetscErrorCode ReadLengths(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < scene->layout.dim; a++) {
    scene->length[a] = scene->cell_width * scene->layout.grid[a].cells;
    MpmSettingsRefuseIf(!isnormal(scene->cell_width) || !isfinite(scene->length[a]), settings, "cell_width",
                        "the domain's length is out of range; allowed: a number nearer to 1");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All directions have cells of one width. Where no length is given, the first direction has that of the default. */
static PetscErrorCode ReadGrid(const MpmSettings *settings, MpmScene *scene)
{
  const MpmLayout *l = &scene->layout;

  PetscFunctionBegin;
  scene->scheme.space.dim = l->dim;
  if (MpmSettingsGiven(settings, "cell_width")) {
    PetscCall(ReadLengths(settings, scene));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  scene->cell_width = scene->length[0] / l->grid[0].cells;
  MpmSettingsRefuseIf(!isnormal(scene->cell_width), settings, "length",
                      "cells of this length vanish; allowed: a larger length");
  for (PetscInt a = 1; a < l->dim; a++) {
    const PetscReal width = scene->length[a] / l->grid[a].cells;

    if (MpmSettingsSource(settings, "length") == MPM_FROM_DEFAULT) {
      scene->length[a] = scene->cell_width * l->grid[a].cells;
      continue;
    }
    MpmSettingsRefuseIf(!(fabs(width - scene->cell_width) <= SAME_WIDTH * scene->cell_width), settings, "length",
                        "cells are %.6g wide in the first direction and %.6g in direction %" PetscInt_FMT
                        "; allowed: the same width in all",
                        scene->cell_width, width, a + 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of time step and Courant number one was given; the other follows. */
static PetscErrorCode ReadTime(const MpmSettings *settings, MpmScene *scene)
{
  static const char *const given[] = {"dt",      "courant", "wave_speed", "length", "sound_speed",
                                      "density", "young",   "bulk",       "shear",  "cell_width"};
  const PetscInt           n       = PETSC_STATIC_ARRAY_LENGTH(given);

  PetscFunctionBegin;
  if (MpmSettingsGiven(settings, "dt")) {
    scene->step.courant = scene->wave_speed * scene->dt / scene->cell_width;
    MpmSettingsRefuseIf(!isnormal(scene->step.courant), settings, MpmSettingsFarthest(settings, n, given),
                        "c dt / h is out of range; allowed: a finite Courant number");
  } else {
    scene->dt = scene->step.courant * scene->cell_width / scene->wave_speed;
    MpmSettingsRefuseIf(!isnormal(scene->dt), settings, MpmSettingsFarthest(settings, n, given),
                        "dt = k h / c is out of range; allowed: a finite time step");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What the numbers that are a fraction's text are divided by: with the time step the width of a cell, or the length of
   which it is a part; with the Courant number the wave speed, which is no such text where moduli are given.
*/
static PetscErrorCode Divisor(const MpmSettings *settings, const MpmScene *scene, PetscBool has_dt,
                              MpmFraction *divisor)
{
  const char *const names[] = {has_dt ? "cell_width" : "wave_speed", has_dt ? "length" : "sound_speed"};
  MpmFraction       each[MPM_MAX_DIM];

  PetscFunctionBegin;
  *divisor = (MpmFraction){.value = scene->wave_speed};
  for (int i = 0; i < 2; i++) {
    if (!MpmSettingsGiven(settings, names[i])) continue;
    PetscCall(MpmSettingsFractions(settings, names[i], i && has_dt ? scene->layout.dim : 1, each));
    *divisor = each[0];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The drift U0 dt / h of a velocity U0. With the Courant number it is U0 k / c, with the time step U0 dt cells / L: a
   fraction when the numbers that were given are, so that particles come back to their places. Where its terms are too
   long it is the short fraction that is the same double, if there is one.
*/
static PetscErrorCode DriftOf(const MpmSettings *settings, const MpmScene *scene, const MpmFraction *velocity,
                              MpmFraction *drift)
{
  const PetscBool   has_dt    = MpmSettingsGiven(settings, "dt");
  const char *const step      = has_dt ? "dt" : "courant";
  MpmFraction       factor[4] = {{.num = 1, .den = 1, .value = 1}}, over;

  PetscFunctionBegin;
  factor[1] = *velocity;
  (void)MpmFractionParse(MpmSettingsNumberText(settings, step), &factor[2]);
  if (has_dt && MpmSettingsGiven(settings, "length")) {
    const PetscInt cells = scene->layout.grid[0].cells;

    factor[0] = (MpmFraction){.num = cells, .den = 1, .value = cells};
  }
  PetscCall(Divisor(settings, scene, has_dt, &over));
  factor[3] = (MpmFraction){.num = over.den, .den = over.num, .value = 1 / over.value};
  *drift    = MpmFractionProduct(4, factor);
  if (!drift->den) *drift = MpmFractionNear(velocity->value * scene->dt / scene->cell_width, MPM_LONGEST_PERIOD);
  MpmSettingsRefuseIf(!(PetscAbsReal(drift->value) <= MOST_DRIFT), settings, "velocity",
                      "allowed: at most 1e6 cells per step");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadVelocity(const MpmSettings *settings, MpmScene *scene)
{
  MpmFraction velocity[MPM_MAX_DIM];

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "velocity")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsFractions(settings, "velocity", scene->layout.dim, velocity));
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    PetscCall(DriftOf(settings, scene, &velocity[a], &scene->step.drift[a]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- layout ---- */

/* Refuses an option of one dimension where there are more. */
static PetscErrorCode OneDimensional(const MpmSettings *settings, const MpmScene *scene, const char option[])
{
  PetscFunctionBegin;
  if (scene->layout.dim > 1) PetscCall(MpmSettingsRefuseUnless(settings, option, "dim", "allowed: only with dim 1"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With counts, ppc is the number of particles in the fullest cell. */
static PetscErrorCode ReadCounts(const MpmSettings *settings, MpmScene *scene)
{
  MpmLayout *l = &scene->layout;
  MpmCounts *c = &l->counts;
  PetscInt64 ppc[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(OneDimensional(settings, scene, "counts"));
  c->n = 1;
  if (MpmSettingsGiven(settings, "counts") && l->dim == 1)
    PetscCall(MpmSettingsList(settings, "counts", MPM_MAX_COUNTS, &c->n, c->of));
  else {
    PetscCall(MpmSettingsIntegers(settings, "ppc", l->dim, ppc));
    for (PetscInt a = 0; a < l->dim; a++) l->ppc[a] = (PetscInt)ppc[a];
    c->of[0] = l->ppc[0];
  }
  for (PetscInt r = 0; r < c->n; r++) {
    l->ppc[0]        = PetscMax(l->ppc[0], c->of[r]);
    c->before[r + 1] = c->before[r] + c->of[r];
    c->voids         = c->voids || (!c->of[r] && r < l->grid[0].cells) ? PETSC_TRUE : PETSC_FALSE;
  }
  l->row[0] = l->grid[0].cells / c->n * c->before[c->n] + c->before[l->grid[0].cells % c->n];
  for (PetscInt a = 1; a < l->dim; a++) l->row[a] = (PetscInt64)l->grid[a].cells * l->ppc[a];
  MpmSettingsRefuseIf(!l->row[0], settings, "counts", "there is no particle; allowed: at least one");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadLayout(const MpmSettings *settings, MpmScene *scene)
{
  MpmLayout *l     = &scene->layout;
  PetscReal  sites = 1;

  PetscFunctionBegin;
  PetscCall(ReadCounts(settings, scene));
  for (PetscInt a = 0; a < l->dim; a++) sites *= (PetscReal)l->row[a];
  if (sites > MOST_PARTICLES)
    PetscCall(MpmSettingsRefuse(settings,
                                l->dim == 1 && MpmSettingsGiven(settings, "counts") ? "counts"
                                : MpmSettingsSource(settings, "ppc")                ? "ppc"
                                                                                    : "cells",
                                "cells times ppc is too large; allowed: at most 1073741823 particles"));
  l->sites = l->particles = (PetscInt64)sites;
  for (PetscInt a = 0; a < l->dim; a++) l->half_width[a] = 0.5 / l->ppc[a];
  MpmSettingsRefuseIf(l->counts.n > 1 && scene->scheme.basis->wide, settings, "counts",
                      "particles of different width; allowed: with another basis than gimp, or ppc");
  PetscCall(OneDimensional(settings, scene, "cluster"));
  MpmSettingsRefuseIf(!(l->cluster[0] >= 0 && l->cluster[1] <= 1), settings, "cluster",
                      "allowed: a part lo,hi of a cell, 0 <= lo <= hi <= 1");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadGrid(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(ReadGrid(settings, scene));
  PetscCall(ReadLayout(settings, scene));
  PetscCall(ReadTime(settings, scene));
  PetscCall(ReadVelocity(settings, scene));
  PetscCall(MachDrift(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
