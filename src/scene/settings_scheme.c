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
  if (can(scene->formulation)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Those(can, names, sizeof names));
  PetscCall(PetscSNPrintf(message, sizeof message, "%s has no %s; allowed: with formulation %s",
                          scene->formulation->name, why, names));
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
  PetscInt64 order;

  PetscFunctionBegin;
  PetscCall(MpmSettingsInteger(settings, "xpic_order", &order));
  scene->numbers.order = (PetscInt)order;
  PetscCall(MpmSettingsReal(settings, "blend_ratio", &scene->numbers.ratio));
  PetscCall(CheckReader(settings, scene, "xpic_order"));
  PetscCall(CheckReader(settings, scene, "blend_ratio"));
  if (scene->transfer->affine)
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
    scene->ends[e] = (MpmEnd)end[e];
    if (end[e] == MPM_FREE)
      PetscCall(MpmSettingsRequire(settings, scene, "boundary", CanBeFree,
                                   "condition for a free end (fixed: a wall reflects)"));
    if (end[e] == MPM_FIXED_REACTION)
      PetscCall(MpmSettingsRequire(settings, scene, "boundary", CanReact, "nodal increment that a wall could add to"));
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

/* The particles between two places, given in cells; whole particles, counted in spacings. */
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
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsScheme(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  PetscCall(ReadTransfer(settings, scene));
  PetscCall(ReadBoundary(settings, scene));
  PetscCall(ReadFill(settings, scene));
  PetscCall(MpmTableCreate(scene->formulation, scene->transfer, &scene->numbers, scene->ends, &scene->table));
  PetscFunctionReturn(PETSC_SUCCESS);
}
