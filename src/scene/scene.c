/*
   From settings to a scene: reads the fields in the order in which one needs another, forms the numbers that follow
   from them, and refuses what does not exist or does not go together.
*/
#include "base/memory.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "scene/settings.h"
#include <math.h>
#include <string.h>

#define MOST_PARTICLES (PETSC_MAX_INT / 2)
#define MOST_DRIFT 1e6 /* cells per step */

/* ---- words ---- */

static PetscErrorCode ReadWords(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt i;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "formulation", &i));
  scene->formulation = MpmFormulations[i];
  PetscCall(MpmSettingsWord(settings, "basis", &i));
  scene->basis = MpmBases[i];
  PetscCall(MpmSettingsWord(settings, "transfer", &i));
  scene->transfer = MpmTransfers[i];
  PetscCall(MpmSettingsWord(settings, "layout", &i));
  scene->layout = MpmOptions[MpmOptionIndex("layout")].word(i);
  PetscCall(MpmSettingsWord(settings, "initial", &i));
  scene->initial = (MpmInitial)i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- units, grid and time ---- */

static PetscErrorCode ReadGrid(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  scene->cell_width = scene->length / scene->cells;
  if (!isnormal(scene->cell_width))
    PetscCall(MpmSettingsRefuse(settings, "length", "cells of this length vanish; allowed: a larger length"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of time step and Courant number one was given; the other follows. */
static PetscErrorCode ReadTime(const MpmSettings *settings, MpmScene *scene)
{
  static const char *const with_dt[] = {"dt", "wave_speed", "length"}, *const with_courant[] = {"courant", "wave_speed",
                                                                                                "length"};

  PetscFunctionBegin;
  if (MpmSettingsGiven(settings, "dt")) {
    scene->courant = scene->wave_speed * scene->dt / scene->cell_width;
    if (!isnormal(scene->courant))
      PetscCall(MpmSettingsRefuse(settings, MpmSettingsFarthest(settings, 3, with_dt),
                                  "c dt / h is out of range; allowed: a finite Courant number"));
  } else {
    scene->dt = scene->courant * scene->cell_width / scene->wave_speed;
    if (!isnormal(scene->dt))
      PetscCall(MpmSettingsRefuse(settings, MpmSettingsFarthest(settings, 3, with_courant),
                                  "dt = k h / c is out of range; allowed: a finite time step"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The drift U0 dt / h of a velocity U0. With the Courant number it is U0 k / c, with the time step U0 dt cells / L: a
   fraction when the numbers that were given are, so that particles come back to their places. Where its terms are too
   long it is the short fraction that is the same double, if there is one.
*/
static PetscErrorCode ReadVelocity(const MpmSettings *settings, MpmScene *scene)
{
  const PetscBool has_dt    = MpmSettingsGiven(settings, "dt");
  const char     *names[3]  = {"velocity", has_dt ? "dt" : "courant", has_dt ? "length" : "wave_speed"};
  MpmFraction     factor[4] = {{.num = scene->cells, .den = 1, .value = scene->cells}};
  MpmFraction    *last      = &factor[3];
  PetscReal       velocity;
  PetscBool       ok;

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "velocity")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsReal(settings, "velocity", &velocity));
  for (int i = 0; i < 3; i++) PetscCall(MpmFractionParse(MpmSettingsText(settings, names[i]), &factor[i + 1], &ok));
  *last = (MpmFraction){.num = last->den, .den = last->num, .value = 1 / last->value};
  if (!has_dt) factor[0] = (MpmFraction){.num = 1, .den = 1, .value = 1};
  scene->drift = MpmFractionProduct(4, factor);
  if (!scene->drift.den) scene->drift = MpmFractionNear(velocity * scene->dt / scene->cell_width, MPM_LONGEST_PERIOD);
  if (!(PetscAbsReal(scene->drift.value) <= MOST_DRIFT))
    PetscCall(MpmSettingsRefuse(settings, "velocity", "allowed: at most 1e6 cells per step"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- layout ---- */

void MpmSceneSetPpc(MpmScene *scene, PetscInt ppc)
{
  scene->ppc              = ppc;
  scene->half_width       = 0.5 / ppc;
  scene->counts.of[0]     = ppc;
  scene->counts.before[1] = ppc;
  scene->sites = scene->particles = (PetscInt64)scene->cells * ppc;
}

/* Reads counts or ppc. With counts, ppc is the number of particles in the fullest cell. */
static PetscErrorCode ReadCounts(const MpmSettings *settings, MpmScene *scene)
{
  MpmCounts *c = &scene->counts;
  PetscInt64 ppc;

  PetscFunctionBegin;
  if (MpmSettingsGiven(settings, "counts"))
    PetscCall(MpmSettingsList(settings, "counts", MPM_MAX_COUNTS, &c->n, c->of));
  else {
    PetscCall(MpmSettingsInteger(settings, "ppc", &ppc));
    c->n     = 1;
    c->of[0] = (PetscInt)ppc;
  }
  for (PetscInt r = 0; r < c->n; r++) {
    scene->ppc       = PetscMax(scene->ppc, c->of[r]);
    c->before[r + 1] = c->before[r] + c->of[r];
    c->voids         = c->voids || (!c->of[r] && r < scene->cells) ? PETSC_TRUE : PETSC_FALSE;
  }
  scene->sites = scene->cells / c->n * c->before[c->n] + c->before[scene->cells % c->n];
  if (!scene->sites) PetscCall(MpmSettingsRefuse(settings, "counts", "there is no particle; allowed: at least one"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadLayout(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(ReadCounts(settings, scene));
  if (scene->sites > MOST_PARTICLES)
    PetscCall(MpmSettingsRefuse(settings,
                                MpmSettingsGiven(settings, "counts") ? "counts"
                                : MpmSettingsSource(settings, "ppc") ? "ppc"
                                                                     : "cells",
                                "cells times ppc is too large; allowed: at most 1073741823 particles"));
  scene->particles  = scene->sites;
  scene->half_width = 0.5 / scene->ppc;
  if (scene->counts.n > 1 && scene->basis->wide)
    PetscCall(MpmSettingsRefuse(settings, "counts",
                                "particles of different width; allowed: with another basis than gimp, or ppc"));
  if (!(scene->cluster[0] >= 0 && scene->cluster[1] <= 1))
    PetscCall(MpmSettingsRefuse(settings, "cluster", "allowed: a part lo,hi of a cell, 0 <= lo <= hi <= 1"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- scheme ---- */

/* The names of all formulations that can do something, to be told in a message. */
static PetscErrorCode Those(PetscBool (*can)(const MpmFormulation *), char names[], size_t room)
{
  PetscFunctionBegin;
  names[0] = '\0';
  for (PetscInt f = 0; MpmFormulations[f]; f++) {
    if (!can(MpmFormulations[f])) continue;
    if (names[0]) PetscCall(PetscStrlcat(names, ", ", room));
    PetscCall(PetscStrlcat(names, MpmFormulations[f]->name, room));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool CanBeAffine(const MpmFormulation *f)
{
  return f->affine != MPM_NONE ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool CanBeFree(const MpmFormulation *f)
{
  return f->free_ends;
}

static PetscBool CanReact(const MpmFormulation *f)
{
  return MpmFormulationHas(f, MPM_REACT);
}

/* Refuses an option that the scene's formulation cannot do, says why, and names the formulations that can. */
static PetscErrorCode Require(const MpmSettings *settings, const MpmScene *scene, const char option[],
                              PetscBool (*can)(const MpmFormulation *), const char why[])
{
  char names[256], message[512];

  PetscFunctionBegin;
  if (can(scene->formulation)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Those(can, names, sizeof names));
  PetscCall(PetscSNPrintf(message, sizeof message, "%s has no %s; allowed: with formulation %s",
                          scene->formulation->name, why, names));
  PetscCall(MpmSettingsRefuse(settings, option, message));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a number that only one transfer reads, when the scene has another transfer. */
static PetscErrorCode CheckTransferReads(const MpmSettings *settings, const MpmScene *scene, const char option[])
{
  char message[128];

  PetscFunctionBegin;
  if (MpmSettingsSource(settings, option) == MPM_FROM_DEFAULT || MpmSettingsOverruled(settings, option, "transfer"))
    PetscFunctionReturn(PETSC_SUCCESS);
  if (scene->transfer->option && !strcmp(scene->transfer->option, option)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt t = 0; MpmTransfers[t]; t++) {
    if (!MpmTransfers[t]->option || strcmp(MpmTransfers[t]->option, option)) continue;
    PetscCall(PetscSNPrintf(message, sizeof message, "allowed: only with transfer %s", MpmTransfers[t]->name));
    PetscCall(MpmSettingsRefuse(settings, option, message));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadTransfer(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(CheckTransferReads(settings, scene, "xpic_order"));
  PetscCall(CheckTransferReads(settings, scene, "blend_ratio"));
  if (scene->transfer->affine)
    PetscCall(Require(settings, scene, "transfer", CanBeAffine, "momentum to carry an affine velocity"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadBoundary(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt end[2];

  PetscFunctionBegin;
  PetscCall(MpmSettingsEnds(settings, "boundary", end));
  if ((end[0] == MPM_PERIODIC) != (end[1] == MPM_PERIODIC))
    PetscCall(MpmSettingsRefuse(settings, "boundary", "allowed: periodic at both ends or at none"));
  for (int e = 0; e < 2; e++) {
    scene->ends[e] = (MpmEnd)end[e];
    if (end[e] == MPM_FREE)
      PetscCall(Require(settings, scene, "boundary", CanBeFree, "condition for a free end (fixed: a wall reflects)"));
    if (end[e] == MPM_FIXED_REACTION)
      PetscCall(Require(settings, scene, "boundary", CanReact, "nodal increment that a wall could add to"));
  }
  scene->nodes = scene->cells + (MpmSceneIsPeriodic(scene) ? 0 : 1);
  PetscCall(PetscStrncpy(scene->boundary, MpmEndNames[end[0]], sizeof scene->boundary));
  if (MpmSceneIsPeriodic(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrlcat(scene->boundary, ",", sizeof scene->boundary));
  PetscCall(PetscStrlcat(scene->boundary, MpmEndNames[end[1]], sizeof scene->boundary));
  MpmCheckInput(!MpmSceneDrifts(scene),
                "drift %g with boundary %s: particles would leave the domain; allowed: drift 0, or boundary periodic",
                scene->drift.value, scene->boundary);
  MpmCheckInput(
      scene->offset.value >= scene->jitter / 2 && scene->offset.value + scene->jitter / 2 <= 1,
      "jitter %g with offset %g and boundary %s: a particle may start beyond the end; allowed: offset - jitter/2 "
      ">= 0 and offset + jitter/2 <= 1",
      scene->jitter, scene->offset.value, scene->boundary);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the particles between two places, which are given in cells and lie between two particles' widths. */
static PetscErrorCode ReadFill(const MpmSettings *settings, MpmScene *scene)
{
  PetscReal range[2], first, end;

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "fill")) PetscFunctionReturn(PETSC_SUCCESS);
  if (scene->counts.n > 1) {
    if (!MpmSettingsOverruled(settings, "fill", "counts"))
      PetscCall(MpmSettingsRefuse(settings, "fill", "allowed: with ppc (counts may be 0 where there is nothing)"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSettingsRange(settings, "fill", range));
  first = range[0] * scene->ppc;
  end   = range[1] * scene->ppc;
  if (!(first >= 0 && end <= (PetscReal)scene->cells * scene->ppc && end > first) ||
      fabs(first - round(first)) > 1e-9 || fabs(end - round(end)) > 1e-9)
    PetscCall(MpmSettingsRefuse(settings, "fill",
                                "allowed: cells lo,hi within 0 and cells, each a multiple of 1 / ppc, lo < hi"));
  scene->first     = (PetscInt64)round(first);
  scene->particles = (PetscInt64)round(end) - scene->first;
  if (!scene->particles)
    PetscCall(MpmSettingsRefuse(settings, "fill",
                                "there is no particle between them; allowed: cells lo,hi at least 1 / ppc apart"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- material ---- */

/* Refuses a number of a material when the scene has no such material. */
static PetscErrorCode CheckMaterialReads(const MpmSettings *settings, const char option[], const char why[])
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
  MpmMaterial *m = &scene->material;

  PetscFunctionBegin;
  PetscCall(Require(settings, scene, "material", CanDiffer, "density and stiffness of each particle"));
  if (m->kind != MPM_MATERIAL_TWO)
    PetscCall(CheckMaterialReads(settings, "inclusion", "allowed: only with material two"));
  if (m->kind != MPM_MATERIAL_TWO || !MpmSettingsGiven(settings, "inclusion")) {
    m->inclusion[0] = scene->cells / 2.0;
    m->inclusion[1] = scene->cells;
  }
  if (!(m->inclusion[0] >= 0 && m->inclusion[0] < m->inclusion[1] && m->inclusion[1] <= scene->cells))
    PetscCall(MpmSettingsRefuse(settings, "inclusion", "allowed: cells lo,hi within 0 and cells, lo < hi"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadMaterial(const MpmSettings *settings, MpmScene *scene)
{
  PetscBool *varies = scene->table->varies;
  PetscInt   i;

  PetscFunctionBegin;
  PetscCall(MpmSettingsWord(settings, "material", &i));
  scene->material.kind = (MpmMaterialKind)i;
  if (scene->material.kind != MPM_MATERIAL_UNIFORM)
    PetscCall(ReadRatios(settings, scene));
  else {
    PetscCall(CheckMaterialReads(settings, "density_ratio", "allowed: only with material two or graded"));
    PetscCall(CheckMaterialReads(settings, "stiffness_ratio", "allowed: only with material two or graded"));
    PetscCall(CheckMaterialReads(settings, "inclusion", "allowed: only with material two"));
    scene->material = (MpmMaterial){.kind = MPM_MATERIAL_UNIFORM, .density = 1, .stiffness = 1};
  }
  varies[MPM_VOLUME]    = scene->counts.n > 1 ? PETSC_TRUE : PETSC_FALSE;
  varies[MPM_MASS]      = varies[MPM_VOLUME] || scene->material.density != 1 ? PETSC_TRUE : PETSC_FALSE;
  varies[MPM_STIFFNESS] = scene->material.stiffness != 1 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- initial data ---- */

static PetscErrorCode ReadStagger(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  if (scene->stagger && scene->formulation->staggered == MPM_NONE) {
    scene->stagger = PETSC_FALSE;
    if (!MpmSettingsOverruled(settings, "stagger", "formulation"))
      PetscCall(MpmSettingsRefuse(settings, "stagger",
                                  "no field of this formulation lags half a step; allowed: with those where one does"));
  }
  if (scene->stagger && scene->initial != MPM_INITIAL_MODE && scene->initial != MPM_INITIAL_PULSE) {
    scene->stagger = PETSC_FALSE;
    if (!MpmSettingsOverruled(settings, "stagger", "initial"))
      PetscCall(
          MpmSettingsRefuse(settings, "stagger", "these data have no half step; allowed: with initial mode or pulse"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadInitial(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  if (scene->initial == MPM_INITIAL_MODE &&
      scene->mode > PetscMax(1, MpmSceneIsPeriodic(scene) ? scene->cells / 2 : scene->cells))
    PetscCall(MpmSettingsRefuse(settings, "mode",
                                MpmSceneIsPeriodic(scene) ? "allowed: a whole number from 1 to cells / 2"
                                                          : "allowed: a whole number from 1 to cells"));
  if (scene->initial == MPM_INITIAL_STEP && (!MpmEndIsFixed(scene->ends[0]) || scene->ends[1] != MPM_FREE))
    PetscCall(
        MpmSettingsRefuse(settings, "initial", "a load needs an end to act on; allowed: with boundary fixed,free"));
  if (scene->initial != MPM_INITIAL_MODE && scene->initial != MPM_INITIAL_EIGENMODE &&
      MpmSettingsSource(settings, "mode") != MPM_FROM_DEFAULT && !MpmSettingsOverruled(settings, "mode", "initial"))
    PetscCall(MpmSettingsRefuse(settings, "mode", "allowed: only with initial mode or eigenmode"));
  PetscCall(ReadStagger(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses units in which the amplitude of a field is out of the range of doubles. */
static PetscErrorCode CheckSizes(const MpmSettings *settings, const MpmScene *scene)
{
  static const char *const given[] = {"wave_speed", "amplitude", "length"};
  const char *const        blamed  = MpmSettingsFarthest(settings, 3, given);
  const MpmProfile         profile = MpmSceneProfile(scene, scene->amplitude);

  PetscFunctionBegin;
  for (PetscInt f = 0; f < scene->table->nstate; f++)
    if (!isnormal(scene->formulation->wave->amplitude(&profile, f)))
      PetscCall(MpmSettingsRefuse(
          settings, blamed,
          strcmp(blamed, "wave_speed")
              ? "a field's amplitude is out of range with it; allowed: a number nearer to 1"
              : "a field's amplitude is out of range with it; allowed: a speed nearer to length / time"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The order matters: what is read later needs what was read before. */
PetscErrorCode MpmSettingsReadProblem(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(MpmSettingsReadFields(settings, MPM_OF_SCENE, scene));
  PetscCall(ReadWords(settings, scene));
  PetscCall(ReadGrid(settings, scene));
  PetscCall(ReadLayout(settings, scene));
  PetscCall(ReadTime(settings, scene));
  PetscCall(ReadVelocity(settings, scene));
  PetscCall(ReadTransfer(settings, scene));
  PetscCall(ReadBoundary(settings, scene));
  PetscCall(ReadFill(settings, scene));
  PetscCall(MpmTableCreate(scene->formulation, scene->transfer, &scene->numbers, scene->ends, &scene->table));
  PetscCall(ReadMaterial(settings, scene));
  PetscCall(ReadInitial(settings, scene));
  PetscCall(CheckSizes(settings, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes a scene from a file or from text. A refusal frees what there is, so that the caller can go on. */
static PetscErrorCode FromYaml(const char path[], const char yaml[], MpmScene **scene)
{
  MpmSettings   *settings = NULL;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(PetscNew(scene));
  ierr = MpmSettingsCreate(&settings);
  if (!ierr) ierr = path ? MpmSettingsReadScene(settings, path) : MpmSettingsReadText(settings, yaml);
  if (!ierr) ierr = MpmSettingsReadProblem(settings, *scene);
  PetscCall(MpmSettingsDestroy(&settings));
  if (ierr) PetscCall(MpmSceneDestroy(scene));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneFromText(const char yaml[], MpmScene **scene)
{
  PetscFunctionBegin;
  PetscCall(FromYaml(NULL, yaml, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneFromFile(const char path[], MpmScene **scene)
{
  PetscFunctionBegin;
  PetscCall(FromYaml(path, NULL, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneDestroy(MpmScene **scene)
{
  PetscFunctionBegin;
  PetscCall(MpmTableDestroy(&(*scene)->table));
  PetscCall(PetscFree(*scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneCheckMemory(MPI_Comm comm, const MpmScene *scene, PetscReal bytes, const char what[])
{
  char size[64];

  PetscFunctionBegin;
  PetscCall(
      PetscSNPrintf(size, sizeof size, "cells %" PetscInt_FMT " with ppc %" PetscInt_FMT, scene->cells, scene->ppc));
  PetscCall(MpmMemoryCheck(comm, size, bytes, what));
  PetscFunctionReturn(PETSC_SUCCESS);
}
