/*
   The initial data of a scene: which wave it starts from, whether that wave exists between its ends, and the exact
   solution that follows.
*/
#include "scene/solution.h"
#include <mpmstab/scene.h>
#include <math.h>
#include <string.h>

/*
   The exact solution of a scene. Its mode is a plane wave, or the sum of a plane wave and its mirror images.

   A mirror at the left end of direction a takes a velocity field v(X) to R v(R X), where R changes the sign of
   component a, and a scalar u(X) to u(R X), or to -u(R X) where it vanishes at the end. The continuous problem is the
   same on both sides. So the mean of a plane wave and of its images is a solution. It fulfils the conditions of
   symmetry, and for a scalar those of any ends. The conditions at the right end choose the wave number.
*/

/* How a mode meets the ends. wave: the plane wave itself. */
typedef struct {
  const MpmScene *scene;
  PetscBool       vector;         /* its first field is a vector, with more than one dimension */
  PetscReal       K[MPM_MAX_DIM]; /* wave vector */
  PetscBool       ends[MPM_MAX_DIM], odd[MPM_MAX_DIM][2];
  PetscInt        directions, free; /* in how many it goes, and how many of these are periodic */
  MpmPlaneWave    wave;
} Mode;

static PetscBool IsAlong(const Mode *m, PetscInt a)
{
  return m->scene->mode[a] != 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* The length of the material, since a bar may end before its domain does. */
static PetscReal LengthOf(const MpmScene *scene, PetscInt a)
{
  return MpmLayoutIsPeriodic(&scene->layout) || scene->layout.given || scene->layout.particles == scene->layout.sites ||
                 scene->layout.dim > 1
             ? scene->length[a]
             : scene->cell_width * (PetscReal)scene->layout.particles / scene->layout.ppc[0];
}

/* The unit vector along which the material moves, when the wave goes along n. */
static void SetDirection(const MpmScene *scene, const PetscReal n[], PetscReal direction[])
{
  const PetscReal across = scene->layout.dim > 1 ? hypot(n[0], n[1]) : 0;

  for (PetscInt a = 0; a < scene->layout.dim; a++) direction[a] = n[a];
  if (scene->polarisation != MPM_S_WAVE) return;
  for (PetscInt a = 0; a < scene->layout.dim; a++) direction[a] = 0;
  direction[0] = across > 0 ? -n[1] / across : 1;
  direction[1] = across > 0 ? n[0] / across : 0;
}

/*
   The wave vector, and the signs at the ends. A velocity is odd about the ends of a direction that it has a component
   in, at others only where it must not slip. Half a wave more or less fits between ends that are not alike.
*/
static void SetWaveVector(Mode *m)
{
  const MpmScene *s       = m->scene;
  const PetscInt  dim     = s->layout.dim;
  PetscReal       squares = 0;

  for (PetscInt a = 0; a < dim; a++) {
    m->wave.normal[a] = s->mode[a] / s->length[a];
    squares += PetscSqr(m->wave.normal[a]);
  }
  for (PetscInt a = 0; a < dim; a++) m->wave.normal[a] /= sqrt(squares);
  SetDirection(s, m->wave.normal, m->wave.direction);
  for (PetscInt a = 0; a < dim; a++) {
    const PetscBool normal = dim == 1 || (m->vector && m->wave.direction[a] != 0) ? PETSC_TRUE : PETSC_FALSE;

    m->K[a]    = 2 * PETSC_PI * s->mode[a] / LengthOf(s, a);
    m->ends[a] = s->layout.grid[a].ends[0] != MPM_PERIODIC ? PETSC_TRUE : PETSC_FALSE;
    for (int e = 0; e < 2; e++)
      m->odd[a][e] = MpmEndIsOdd(s->layout.grid[a].ends[e], normal ? MPM_NORMAL : MPM_TANGENTIAL);
    if (m->ends[a])
      m->K[a] = (m->odd[a][0] == m->odd[a][1] ? s->mode[a] : s->mode[a] - 0.5) * PETSC_PI / LengthOf(s, a);
    m->directions += IsAlong(m, a);
    m->free += IsAlong(m, a) && !m->ends[a];
  }
}

/* Whether the mode fulfils the conditions at the ends of direction a. */
static PetscBool Fits(const Mode *m, PetscInt a)
{
  const MpmEnd   *ends     = m->scene->layout.grid[a].ends;
  const PetscBool symmetry = ends[0] == MPM_SYMMETRY && ends[1] == MPM_SYMMETRY ? PETSC_TRUE : PETSC_FALSE;

  if (!m->ends[a]) return PETSC_TRUE;
  if (!m->vector) return IsAlong(m, a) || (!m->odd[a][0] && !m->odd[a][1]) ? PETSC_TRUE : PETSC_FALSE;
  if (IsAlong(m, a)) return m->directions == 1 || symmetry ? PETSC_TRUE : PETSC_FALSE;
  return symmetry && m->wave.direction[a] == 0 ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Adds the images of the waves that there are so far, in all directions with ends but the first that the mode goes in.
*/
static void AddImages(const Mode *m, MpmProfile *p)
{
  PetscBool first = m->free ? PETSC_FALSE : PETSC_TRUE;

  for (PetscInt a = 0; a < p->dim; a++) {
    const PetscInt n = p->nwaves;

    if (!m->ends[a] || !IsAlong(m, a)) continue;
    for (PetscInt w = 0; w < n && !first; w++) {
      p->wave[w].weight /= 2;
      p->wave[n + w] = p->wave[w];
      p->wave[n + w].normal[a] *= -1;
      p->wave[n + w].direction[a] *= -1;
      if (!m->vector && m->odd[a][0]) p->wave[n + w].weight *= -1;
      p->nwaves++;
    }
    first = PETSC_FALSE;
  }
}

static void SetMode(const MpmScene *scene, MpmProfile *p)
{
  const MpmSpace *space   = &scene->scheme.space;
  const PetscReal mu      = (1 - 2 * p->poisson) / (2 * (1 - p->poisson));
  PetscReal       squares = 0;
  PetscInt        sines;
  Mode            m = {.scene = scene, .wave = {.weight = 1}};

  m.vector =
      scene->layout.dim > 1 && scene->scheme.formulation->particle_ranks[0] == MPM_VECTOR ? PETSC_TRUE : PETSC_FALSE;
  SetWaveVector(&m);
  for (PetscInt a = 0; a < p->dim; a++) squares += PetscSqr(m.K[a]);
  p->wavenumber = sqrt(squares);
  p->speed      = scene->polarisation == MPM_S_WAVE ? p->wave_speed * sqrt(mu) : p->wave_speed;
  p->decay      = p->wave_speed / p->cell_width *
             (space->damping +
              (space->viscous[1] + (scene->polarisation == MPM_S_WAVE ? 0 : space->viscous[0] + space->viscous[1])) *
                  squares * PetscSqr(p->cell_width));
  /* the sine and cosine factors of the mode make a wave with this phase at X = 0 */
  sines = m.free > 0;
  for (PetscInt a = 0; a < p->dim; a++) sines += m.ends[a] && IsAlong(&m, a) && m.odd[a][0];
  if (m.vector) sines = PetscMin(sines, 1); /* each component is odd in one direction at most */
  p->phase = (1 - sines) * (PETSC_PI / 2);
  for (PetscInt a = 0; a < p->dim; a++) m.wave.normal[a] = m.K[a] / p->wavenumber;
  SetDirection(scene, m.wave.normal, m.wave.direction);
  for (PetscInt a = 0; a < p->dim; a++)
    if (!Fits(&m, a)) return;
  p->nwaves  = 1;
  p->wave[0] = m.wave;
  AddImages(&m, p);
}

MpmProfile MpmSceneProfile(const MpmScene *scene, PetscReal amplitude)
{
  MpmProfile profile = {.initial    = scene->initial,
                        .dim        = scene->layout.dim,
                        .length     = LengthOf(scene, 0),
                        .wave_speed = scene->wave_speed,
                        .cell_width = scene->cell_width,
                        .amplitude  = amplitude,
                        .poisson    = MpmSceneHasPoisson(scene) ? scene->scheme.space.poisson : 0.5};

  SetMode(scene, &profile);
  for (int end = 0; end < 2 && scene->layout.grid[0].ends[0] != MPM_PERIODIC; end++)
    profile.image[end] = MpmEndIsFixed(scene->layout.grid[0].ends[end]) ? -1 : 1;
  return profile;
}

PetscReal MpmSceneExact(const MpmScene *scene, const MpmProfile *profile, PetscInt r, const PetscReal X[], PetscReal t)
{
  const MpmTable *table = scene->scheme.table;
  const PetscInt  field = table->field[r];
  const PetscBool lags  = scene->stagger && field == scene->scheme.formulation->staggered ? PETSC_TRUE : PETSC_FALSE;

  return scene->scheme.formulation->wave->value(profile, field, table->component[r], X, lags ? t - scene->dt / 2 : t);
}

/* ---- what follows from a scene ---- */

PetscBool MpmSceneHasPoisson(const MpmScene *scene)
{
  for (PetscInt f = 0; scene->scheme.formulation->particle_fields[f]; f++)
    if (scene->scheme.formulation->particle_ranks[f] == MPM_TENSOR && scene->layout.dim > 1) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscBool MpmSceneHasExact(const MpmScene *scene)
{
  if (!scene->scheme.formulation->wave) return PETSC_FALSE;
  if (scene->scheme.space.finite) return MpmSolutionOf(scene) ? PETSC_TRUE : PETSC_FALSE;
  if (!MpmInitialHasExact(scene->initial) || scene->layout.material.kind != MPM_MATERIAL_UNIFORM) return PETSC_FALSE;
  if (MpmSpaceIsDamped(&scene->scheme.space) &&
      (scene->initial != MPM_INITIAL_MODE || scene->scheme.space.displaced || scene->scheme.space.local != 0))
    return PETSC_FALSE;
  if (MpmSceneIsFull(scene)) return PETSC_TRUE;
  return scene->layout.dim == 1 && scene->layout.first[0] == 0 && scene->layout.grid[0].ends[1] == MPM_FREE
             ? PETSC_TRUE
             : PETSC_FALSE;
}

const char *MpmSceneEquations(const MpmScene *scene)
{
  const MpmWave *wave = scene->scheme.formulation->wave;

  if (scene->scheme.space.finite) return MpmSolutionOf(scene)->equations;
  return scene->layout.dim == 1 ? wave->equations : wave->equations_nd;
}

PetscInt MpmSceneExponent(const MpmScene *scene)
{
  const MpmProfile profile = MpmSceneProfile(scene, scene->amplitude);
  PetscReal        largest = 0;

  if (!MpmInitialHasExact(scene->initial)) return ilogb(scene->amplitude);
  for (PetscInt r = 0; r < scene->scheme.table->nstate; r++)
    largest = PetscMax(largest, scene->scheme.formulation->wave->amplitude(&profile, scene->scheme.table->field[r]));
  return ilogb(largest);
}

void MpmSceneCountsText(const MpmScene *scene, size_t room, char text[])
{
  text[0] = '\0';
  for (PetscInt r = 0; r < scene->layout.counts.n; r++) {
    const size_t used = strlen(text);

    (void)snprintf(text + used, room - used, "%s%" PetscInt_FMT, r ? "," : "", scene->layout.counts.of[r]);
  }
}

/* ---- initial data ---- */

/* asked: the initial data that the settings name. Where there is no such solution scene->initial has others. */
static PetscErrorCode ReadStagger(const MpmSettings *settings, MpmInitial asked, MpmScene *scene)
{
  PetscFunctionBegin;
  if (scene->stagger && scene->scheme.formulation->staggered == MPM_NONE) {
    scene->stagger = PETSC_FALSE;
    STANDS("stagger", "formulation", PETSC_TRUE,
           "no field of this formulation lags half a step; allowed: with those where one does");
  }
  if (scene->stagger && scene->initial != MPM_INITIAL_MODE && scene->initial != MPM_INITIAL_PULSE &&
      !MpmSolutionOf(scene)) {
    scene->stagger = PETSC_FALSE;
    STANDS("stagger", asked != scene->initial ? "boundary,initial" : "initial", PETSC_TRUE,
           "these data have no half step; allowed: with initial mode or pulse, or an exact solution at finite strain");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In one dimension, and of an eigenvector, a number; else the waves in each direction, where one number is along x. */
static PetscErrorCode ReadMode(const MpmSettings *settings, MpmScene *scene)
{
  static const char positive[] = "allowed: a whole number from 1 to 2147483646";
  const MpmLayout  *l          = &scene->layout;
  const char       *text = MpmSettingsText(settings, "mode"), *end = text + strspn(text, "+0123456789");
  const PetscBool   list   = strchr(text, ',') ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool   number = l->dim == 1 || scene->initial == MPM_INITIAL_EIGENMODE ? PETSC_TRUE : PETSC_FALSE;
  PetscInt64        mode[MPM_MAX_DIM] = {0};
  PetscBool         fits = PETSC_TRUE, none = PETSC_TRUE;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(number && *end, settings, "mode", positive);
  if (number || !list)
    PetscCall(MpmSettingsIntegers(settings, "mode", 1, mode));
  else
    PetscCall(MpmSettingsIntegers(settings, "mode", l->dim, mode));
  MpmSettingsRefuseIf(number && mode[0] < 1, settings, "mode", positive);
  for (PetscInt a = 0; a < l->dim; a++) {
    const PetscBool  ends = l->grid[a].ends[0] != MPM_PERIODIC ? PETSC_TRUE : PETSC_FALSE;
    const PetscInt64 most = PetscMax(1, ends ? l->grid[a].cells : l->grid[a].cells / 2);

    scene->mode[a] = (PetscInt)mode[a];
    if (mode[a] > most || mode[a] < (ends ? 0 : -most)) fits = PETSC_FALSE;
    if (mode[a]) none = PETSC_FALSE;
  }
  if (none && scene->initial != MPM_INITIAL_MODE) scene->mode[0] = 1; /* a scene's mode that is not read any more */
  if (scene->initial != MPM_INITIAL_MODE || (fits && !none)) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(l->dim > 1, settings, "mode",
                      "allowed: one whole number for each direction, not all 0; from -cells / 2 to cells / 2 "
                      "in a periodic direction, from 0 to cells between ends");
  PetscCall(MpmSettingsRefuse(settings, "mode",
                              MpmSceneIsPeriodic(scene) ? "allowed: a whole number from 1 to cells / 2"
                                                        : "allowed: a whole number from 1 to cells"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Data that were asked for and do not exist are refused. Otherwise runs start from random data: also when a scene asks
   for them, and the command line has another value of the option by.
*/
static PetscErrorCode FallBack(const MpmSettings *settings, MpmScene *scene, const char by[], const char why[])
{
  PetscFunctionBegin;
  STANDS("initial,mode,polarisation", by, PETSC_TRUE, why);
  scene->initial = MPM_INITIAL_RANDOM;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses data without an exact solution to start from. */
static PetscErrorCode CheckExact(const MpmSettings *settings, MpmScene *scene)
{
  const PetscBool mode = scene->initial == MPM_INITIAL_MODE ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (!MpmInitialHasExact(scene->initial)) PetscFunctionReturn(PETSC_SUCCESS);
  if (!scene->scheme.formulation->wave)
    PetscCall(FallBack(settings, scene, "formulation",
                       "the formulation has no exact solution to start from; allowed: random or eigenmode"));
  else if (scene->layout.dim > 1 && MpmSpaceIsPrestressed(&scene->scheme.space))
    PetscCall(FallBack(settings, scene, scene->law == &MpmLawLinear ? "prestress" : "material",
                       "waves about a prestressed state have no exact solution here; allowed: with dim 1, or random or "
                       "eigenmode"));
  else if (mode && !MpmSceneProfile(scene, 1).nwaves)
    PetscCall(FallBack(settings, scene, "boundary",
                       "no such wave stands between these ends; allowed: another mode, boundary periodic or symmetry, "
                       "or initial random"));
  else if (!mode && scene->layout.dim > 1)
    PetscCall(FallBack(settings, scene, "dim",
                       "its exact solution is of one dimension; allowed: with dim 1, or mode, random or eigenmode"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadInitial(const MpmSettings *settings, MpmScene *scene)
{
  const MpmInitial asked     = scene->initial;
  const PetscBool  has_shear = MpmSceneHasPoisson(scene), fluid = MpmSpaceIsFluid(&scene->scheme.space);
  PetscBool        is_mode;

  PetscFunctionBegin;
  if (!scene->scheme.space.finite && scene->initial >= MPM_INITIAL_MANUFACTURED)
    PetscCall(FallBack(settings, scene, "kinematics",
                       "allowed: with kinematics finite; or mode, random, pulse, eigenmode and step"));
  PetscCall(ReadMode(settings, scene));
  is_mode = scene->initial == MPM_INITIAL_MODE ? PETSC_TRUE : PETSC_FALSE;
  STANDS("polarisation", "dim,formulation", !has_shear,
         "allowed: only with dim 2 or 3, and a formulation with a stress (usl, usf, musl, usavg)");
  STANDS("polarisation", "initial", !is_mode, "allowed: only with initial mode");
  STANDS("polarisation", "poisson", scene->polarisation == MPM_S_WAVE && fluid,
         "a fluid has no S waves; allowed: p, or poisson below 0.5");
  if (!has_shear || !is_mode || fluid) scene->polarisation = MPM_P_WAVE;
  PetscCall(CheckExact(settings, scene));
  MpmSettingsRefuseIf(scene->initial == MPM_INITIAL_STEP &&
                          (!MpmEndIsFixed(scene->layout.grid[0].ends[0]) || scene->layout.grid[0].ends[1] != MPM_FREE),
                      settings, "initial", "a load needs an end to act on; allowed: with boundary fixed,free");
  STANDS("mode", "initial", asked != MPM_INITIAL_MODE && asked != MPM_INITIAL_EIGENMODE,
         "allowed: only with initial mode or eigenmode");
  PetscCall(ReadStagger(settings, asked, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
