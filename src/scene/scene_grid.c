/*
   From settings to a scene: the grid, where particles are in it, the time step, and how far particles move in one.
*/
#include "scene/layout.h"
#include "scene/settings.h"
#include <math.h>
#include <string.h>

#define MOST_PARTICLES (PETSC_MAX_INT / 2)
#define MOST_DRIFT 1e6 /* cells per step */
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
  PetscFunctionReturn(PETSC_SUCCESS);
}
