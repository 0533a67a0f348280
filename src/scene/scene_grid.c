/*
   From settings to a scene: wave speed and units, the grid, where particles are in it, the time step, and how far
   particles move in one.
*/
#include "base/text.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "scene/settings.h"
#include <mpmstab/scheme.h>
#include <math.h>
#include <string.h>

/*
   The wave speed of a scene, from moduli and density or as it is given, and whether the scene is in physical units.

   With K the bulk and G the shear modulus, M = K + 4/3 G is the stiffness against a strain in one direction alone, and
   c = sqrt(M / rho) the speed of pressure waves. M = E (1 - nu) / ((1 + nu) (1 - 2 nu)). In one dimension E is that of
   a bar whose sides are free, where M = E. See any book on elasticity, such as Landau and Lifshitz (1986), sections 5,
   22.
*/

#define MOST_DRIFT 1e6 /* cells per step */

static const char *const moduli[] = {"young", "bulk", "shear"};

/* Refuses a modulus without the others that it needs; density and poisson have a meaning beside a wave speed, too. */
static PetscErrorCode CheckComplete(const MpmSettings *settings, const MpmScene *scene, const char modulus[])
{
  static const char *const names[]     = {"bulk", "shear", "poisson", "density"};
  const PetscBool          young       = MpmSettingsGiven(settings, "young");
  const PetscBool          needs[]     = {!young, !young, young && scene->layout.dim > 1, PETSC_TRUE};
  char                     missing[64] = "";

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(names); i++) {
    if (!needs[i] || MpmSettingsSource(settings, names[i]) != MPM_FROM_DEFAULT) continue;
    if (missing[0]) MpmTextJoin(missing, " and ", sizeof missing);
    MpmTextJoin(missing, names[i], sizeof missing);
  }
  MpmSettingsRefuseIf(missing[0], settings, modulus,
                      "the wave speed needs %s besides; allowed: %s, bulk with shear and density, or sound_speed",
                      missing, scene->layout.dim > 1 ? "young with poisson and density" : "young with density");
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
  *stiffness *= MpmMaterialStiffness(scene->layout.dim, nu);
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

/* ---- velocities and Mach numbers, and the drift that they make ---- */

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

/* The first of two options that was given, along x, as a fraction; the number itself where neither was. */
static PetscErrorCode OneOf(const MpmSettings *settings, const MpmScene *scene, const char name[], const char other[],
                            PetscReal number, MpmFraction *fraction)
{
  MpmFraction each[MPM_MAX_DIM] = {{.value = number}};
  const char *given = MpmSettingsGiven(settings, name) ? name : MpmSettingsGiven(settings, other) ? other : NULL;

  PetscFunctionBegin;
  if (given) PetscCall(MpmSettingsFractions(settings, given, scene->layout.dim, each));
  *fraction = each[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The drift of a velocity of 1, dt / h or k / c, or of a Mach number of 1, c dt / h or k. With the time step dt / h is
   dt cells / L where the length is given. It is a fraction when the numbers that were given are, so that particles come
   back to their places; the wave speed is none where moduli are given.
*/
static PetscErrorCode DriftOfOne(const MpmSettings *settings, const MpmScene *scene, PetscBool mach, MpmFraction *drift)
{
  const PetscBool has_dt = MpmSettingsGiven(settings, "dt"), has_width = MpmSettingsGiven(settings, "cell_width");
  const PetscInt  cells = has_dt && !has_width ? scene->layout.grid[0].cells : 1;
  const char     *step = has_dt ? "dt" : "courant", *width = has_width ? "cell_width" : "length";
  MpmFraction     factor[4] = {{cells, 1, cells}, [2] = {1, 1, 1}}, speed, over = {1, 1, 1};

  PetscFunctionBegin;
  PetscCall(OneOf(settings, scene, step, step, has_dt ? scene->dt : scene->step.courant, &factor[1]));
  PetscCall(OneOf(settings, scene, "wave_speed", "sound_speed", scene->wave_speed, &speed));
  if (has_dt) PetscCall(OneOf(settings, scene, width, width, scene->cell_width, &over));
  if (has_dt && mach) factor[2] = speed;
  if (!has_dt && !mach) over = speed;
  factor[3] = (MpmFraction){over.den, over.num, 1 / over.value};
  *drift    = MpmFractionProduct(4, factor);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Reads the drift of a velocity, or the drift M k of a Mach number, if one of them is given. Where its terms are too
   long it is the short fraction that is the same double, if there is one.
*/
static PetscErrorCode ReadMotion(const MpmSettings *settings, MpmScene *scene)
{
  const PetscBool   is_mach = MpmSettingsGiven(settings, "mach");
  const char *const name    = is_mach ? "mach" : "velocity";
  MpmFraction       factor[2], number[MPM_MAX_DIM], *drift = scene->step.drift;
  MpmMach           mach;

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, name)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DriftOfOne(settings, scene, is_mach, &factor[1]));
  if (is_mach) {
    PetscCall(MpmSettingsReadMach(settings, scene->layout.dim, &mach));
    factor[0] = mach.unit;
    number[0] = MpmFractionProduct(2, factor);
    if (!number[0].den) number[0] = MpmFractionNear(mach.unit.value * scene->step.courant, MPM_LONGEST_PERIOD);
    MpmMachDrift(&mach, &number[0], drift);
  } else
    PetscCall(MpmSettingsFractions(settings, name, scene->layout.dim, number));
  for (PetscInt a = 0; a < scene->layout.dim; a++) {
    if (!is_mach) {
      factor[0] = number[a];
      drift[a]  = MpmFractionProduct(2, factor);
      if (!drift[a].den)
        drift[a] = MpmFractionNear(number[a].value * scene->dt / scene->cell_width, MPM_LONGEST_PERIOD);
    }
    MpmSettingsRefuseIf(!(PetscAbsReal(drift[a].value) <= MOST_DRIFT), settings, name,
                        "allowed: at most 1e6 cells per step");
  }
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

#define MOST_PARTICLES (PETSC_MAX_INT / 2)
#define SAME_WIDTH 1e-12

/* ---- units, grid and time ---- */

/*
   All directions have cells of one width, which is given or follows from the length. Where no length is given, the first
   direction has that of the default.
*/
static PetscErrorCode ReadGrid(const MpmSettings *settings, MpmScene *scene)
{
  const MpmLayout *l         = &scene->layout;
  const PetscBool  has_width = MpmSettingsGiven(settings, "cell_width");

  PetscFunctionBegin;
  scene->scheme.space.dim = l->dim;
  if (!has_width) scene->cell_width = scene->length[0] / l->grid[0].cells;
  MpmSettingsRefuseIf(!has_width && !isnormal(scene->cell_width), settings, "length",
                      "cells of this length vanish; allowed: a larger length");
  for (PetscInt a = 0; a < l->dim; a++) {
    if (has_width || (a && MpmSettingsSource(settings, "length") == MPM_FROM_DEFAULT))
      scene->length[a] = scene->cell_width * l->grid[a].cells;
    MpmSettingsRefuseIf(has_width && (!isnormal(scene->cell_width) || !isfinite(scene->length[a])), settings,
                        "cell_width", "the domain's length is out of range; allowed: a number nearer to 1");
    MpmSettingsRefuseIf(
        !(fabs(scene->length[a] / l->grid[a].cells - scene->cell_width) <= SAME_WIDTH * scene->cell_width), settings,
        "length",
        "cells are %.6g wide in the first direction and %.6g in direction %" PetscInt_FMT
        "; allowed: the same width in all",
        scene->cell_width, scene->length[a] / l->grid[a].cells, a + 1);
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

/* ---- layout ---- */

/* With counts, ppc is the number of particles in the fullest cell. */
static PetscErrorCode ReadCounts(const MpmSettings *settings, MpmScene *scene)
{
  MpmLayout *l = &scene->layout;
  MpmCounts *c = &l->counts;
  PetscInt64 ppc[MPM_MAX_DIM];

  PetscFunctionBegin;
  STANDS("counts", "dim", l->dim > 1, "allowed: only with dim 1");
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
  PetscCall(ReadMotion(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
