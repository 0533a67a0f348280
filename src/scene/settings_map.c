/* What a map goes over. */
#include <mpmstab/scene.h>
#include <math.h>
#include <string.h>

const char *const MpmAxisNames[] = {"courant", "drift", "offset", "ppc", NULL};

static const char *const spans[] = {"map_courant", "map_drift", "map_offset", "map_ppc"};

/* What an axis takes the place of, by any name. */
static const char *const replaced[][2] = {
    {"courant", "dt"}, {"drift", "velocity"}, {"offset", "offset"}, {"ppc", "ppc"}};

static PetscErrorCode RefuseReplaced(const MpmSettings *settings, PetscInt kind)
{
  char why[128];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(why, sizeof why, "the map goes over it; allowed: -%s lo,hi", spans[kind]));
  for (int i = 0; i < 2; i++)
    if (MpmSettingsSource(settings, replaced[kind][i]) == MPM_FROM_COMMAND_LINE)
      PetscCall(MpmSettingsRefuse(settings, replaced[kind][i], why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of particles per cell every number is taken, however many points are asked for by default. */
static PetscErrorCode CountPpc(const MpmSettings *settings, PetscInt points, MpmAxis *axis)
{
  char why[128];

  PetscFunctionBegin;
  if (axis->from.den != 1 || axis->to.den != 1)
    PetscCall(MpmSettingsRefuse(settings, "map_ppc", "allowed: two whole numbers lo,hi"));
  axis->points = (PetscInt)(axis->to.num - axis->from.num) + 1;
  PetscCall(PetscSNPrintf(
      why, sizeof why, "map_ppc takes every number between its ends; allowed: %" PetscInt_FMT " for it", axis->points));
  if (MpmSettingsSource(settings, "map_points") != MPM_FROM_DEFAULT && points != axis->points)
    PetscCall(MpmSettingsRefuse(settings, "map_points", why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsAxes(const MpmSettings *settings, MpmScene *scene)
{
  PetscInt kinds[2], points[2], n;

  PetscFunctionBegin;
  PetscCall(MpmSettingsEnds(settings, "map_axes", kinds));
  if (kinds[0] == kinds[1])
    PetscCall(MpmSettingsRefuse(settings, "map_axes", "allowed: two different ones of courant, drift, offset and ppc"));
  PetscCall(MpmSettingsList(settings, "map_points", 2, &n, points));
  if (n != 2) PetscCall(MpmSettingsRefuse(settings, "map_points", "allowed: two whole numbers, one for each axis"));
  for (int a = 0; a < 2; a++) {
    MpmAxis    *axis = &scene->axes[a];
    MpmFraction span[2];

    PetscCall(RefuseReplaced(settings, kinds[a]));
    axis->kind = (MpmAxisKind)kinds[a];
    PetscCall(MpmSettingsSpan(settings, spans[kinds[a]], span));
    axis->from   = span[0];
    axis->to     = span[1];
    axis->points = points[a];
    if (axis->kind == MPM_AXIS_PPC) PetscCall(CountPpc(settings, points[a], axis));
  }
  for (PetscInt i = 0; i < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(spans); i++)
    if (MpmSettingsSource(settings, spans[i]) == MPM_FROM_COMMAND_LINE && i != kinds[0] && i != kinds[1])
      PetscCall(MpmSettingsRefuse(settings, spans[i], "map_axes does not name it; allowed: with an axis of that name"));
  PetscFunctionReturn(PETSC_SUCCESS);
}
