/* Formulation, transfer, boundary and layout together: what exists, and what is missing when something does not. */
#include <mpmstab/scene.h>
#include <math.h>
#include <string.h>

/* The names of all formulations that can do something, for messages. */
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

PetscErrorCode MpmSettingsRequire(const MpmSettings *settings, const MpmScene *scene, const char option[],
                                  PetscBool (*can)(const MpmFormulation *), const char why[])
{
  char names[256], message[512];

  PetscFunctionBegin;
  if (can(scene->scheme.formulation)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Those(can, names, sizeof names));
  PetscCall(PetscSNPrintf(message, sizeof message, "%s has no %s; allowed: with formulation %s",
                          scene->scheme.formulation->name, why, names));
  PetscCall(MpmSettingsRefuse(settings, option, message));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A number that only one transfer reads. */
static PetscErrorCode CheckReader(const MpmSettings *settings, const MpmScene *scene, const char option[])
{
  char message[128];

  PetscFunctionBegin;
  if (MpmSettingsSource(settings, option) == MPM_FROM_DEFAULT || MpmSettingsOverruled(settings, option, "transfer"))
    PetscFunctionReturn(PETSC_SUCCESS);
  if (scene->scheme.transfer->option && !strcmp(scene->scheme.transfer->option, option))
    PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt t = 0; MpmTransfers[t]; t++) {
    if (!MpmTransfers[t]->option || strcmp(MpmTransfers[t]->option, option)) continue;
    PetscCall(PetscSNPrintf(message, sizeof message, "allowed: only with transfer %s", MpmTransfers[t]->name));
    PetscCall(MpmSettingsRefuse(settings, option, message));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadTransfer(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt64 order;

  PetscFunctionBegin;
  PetscCall(MpmSettingsInteger(settings, "xpic_order", &order));
  scene->scheme.numbers.order = (PetscInt)order;
  PetscCall(MpmSettingsReal(settings, "blend_ratio", &scene->scheme.numbers.ratio));
  PetscCall(CheckReader(settings, scene, "xpic_order"));
  PetscCall(CheckReader(settings, scene, "blend_ratio"));
  if (scene->scheme.transfer->affine)
    PetscCall(MpmSettingsRequire(settings, scene, "transfer", CanBeAffine, "momentum to carry an affine velocity"));
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
    scene->layout.grid.ends[e] = (MpmEnd)end[e];
    if (end[e] == MPM_FREE)
      PetscCall(MpmSettingsRequire(settings, scene, "boundary", CanBeFree,
                                   "condition for a free end (fixed: a wall reflects)"));
    if (end[e] == MPM_FIXED_REACTION)
      PetscCall(MpmSettingsRequire(settings, scene, "boundary", CanReact, "nodal increment that a wall could add to"));
  }
  scene->layout.grid.nodes = scene->layout.grid.cells + (MpmSceneIsPeriodic(scene) ? 0 : 1);
  PetscCall(PetscStrncpy(scene->boundary, MpmEndNames[end[0]], sizeof scene->boundary));
  if (MpmSceneIsPeriodic(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscStrlcat(scene->boundary, ",", sizeof scene->boundary));
  PetscCall(PetscStrlcat(scene->boundary, MpmEndNames[end[1]], sizeof scene->boundary));
  MpmCheckInput(!MpmSceneDrifts(scene),
                "drift %g with boundary %s: particles would leave the domain; allowed: drift 0, or boundary periodic",
                scene->step.drift.value, scene->boundary);
  MpmCheckInput(
      scene->layout.offset.value >= scene->layout.jitter / 2 &&
          scene->layout.offset.value + scene->layout.jitter / 2 <= 1,
      "jitter %g with offset %g and boundary %s: a particle may start beyond the end; allowed: offset - jitter/2 "
      ">= 0 and offset + jitter/2 <= 1",
      scene->layout.jitter, scene->layout.offset.value, scene->boundary);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The particles between two places, given in cells; whole particles, counted in spacings. */
static PetscErrorCode ReadFill(const MpmSettings *settings, MpmScene *scene)
{
  PetscReal range[2], first, end;

  PetscFunctionBegin;
  if (!MpmSettingsGiven(settings, "fill")) PetscFunctionReturn(PETSC_SUCCESS);
  if (scene->layout.counts.n > 1) {
    if (!MpmSettingsOverruled(settings, "fill", "counts"))
      PetscCall(MpmSettingsRefuse(settings, "fill", "allowed: with ppc (counts may be 0 where there is nothing)"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSettingsRange(settings, "fill", range));
  first = range[0] * scene->layout.ppc;
  end   = range[1] * scene->layout.ppc;
  if (!(first >= 0 && end <= (PetscReal)scene->layout.grid.cells * scene->layout.ppc && end > first) ||
      fabs(first - round(first)) > 1e-9 || fabs(end - round(end)) > 1e-9)
    PetscCall(MpmSettingsRefuse(settings, "fill",
                                "allowed: cells lo,hi within 0 and cells, each a multiple of 1 / ppc, lo < hi"));
  scene->layout.first     = (PetscInt64)round(first);
  scene->layout.particles = (PetscInt64)round(end) - scene->layout.first;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsScheme(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(ReadTransfer(settings, scene));
  PetscCall(ReadBoundary(settings, scene));
  PetscCall(ReadFill(settings, scene));
  PetscCall(MpmTableCreate(scene->scheme.formulation, scene->scheme.transfer, &scene->scheme.numbers,
                           scene->layout.grid.ends, &scene->scheme.table));
  PetscFunctionReturn(PETSC_SUCCESS);
}
