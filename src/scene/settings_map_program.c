/* The axes of a map of a code: parameters that the code names, which are known only when it has been started. */
#include "scene/request.h"
#include "scene/settings.h"
#include "scene/settings_place.h"
#include <mpmstab/fraction.h>
#include <math.h>
#include <string.h>

static const char map[] = "map_", separators[] = ", ";

/* The two words of map_axes, or fewer. */
static void Words(const char text[], PetscInt *n, MpmAxis axes[2], PetscBool *fit)
{
  *fit = PETSC_TRUE;
  for (*n = 0; text && *text; ++*n) {
    const size_t length = strcspn(text, separators);

    if (*n == 2 || length == 0 || length >= sizeof axes[0].name) *fit = PETSC_FALSE;
    if (!*fit) break;
    (void)snprintf(axes[*n].name, length + 1, "%s", text);
    text += length + strspn(text + length, separators);
  }
}

/* Whether it is a code that is mapped is known later: map_axes of a scene allows no word that is not its own. */
PetscErrorCode MpmSettingsIsSpanOfProgram(const char name[], PetscBool *is)
{
  MpmAxis     axes[2];
  PetscInt    n;
  const char *text;
  PetscBool   given, fit;

  PetscFunctionBegin;
  *is = PETSC_FALSE;
  if (strncmp(name, map, strlen(map))) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscOptionsFindPair(NULL, NULL, "-map_axes", &text, &given));
  if (!given) PetscFunctionReturn(PETSC_SUCCESS);
  Words(text, &n, axes, &fit);
  for (PetscInt i = 0; i < n; i++)
    if (!strcmp(axes[i].name, name + strlen(map))) *is = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadSpan(MpmAxis *axis)
{
  char        key[64], place[MPM_PLACE_TEXT];
  const char *text;
  MpmFraction span[2];
  PetscBool   given;

  PetscFunctionBegin;
  (void)snprintf(key, sizeof key, "-%s%s", map, axis->name);
  PetscCall(PetscOptionsFindPair(NULL, NULL, key, &text, &given));
  MpmCheckInput(given, "-map_axes %s: the span of that axis is missing; allowed: with %s lo,hi", axis->name, key);
  PetscCall(MpmSettingsPlace(key + 1, text, place));
  MpmCheckInput(text && MpmSettingsParseSpan(text, span),
                "%s %.200s%s: allowed: two numbers or fractions lo,hi with lo < hi", key, text ? text : "", place);
  axis->from = span[0];
  axis->to   = span[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The spans of a scene's own axes are options; only those of parameters that the code has by these names are read. */
static PetscErrorCode CheckSpans(const MpmSettings *settings, const MpmRequest *request)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    const char *name = MpmOptions[i].name + strlen(map);

    if (MpmOptions[i].kind != MPM_SPAN || !strcmp(name, request->axes[0].name) || !strcmp(name, request->axes[1].name))
      continue;
    MpmSettingsRefuseIf(settings->source[i] != MPM_FROM_DEFAULT, settings, MpmOptions[i].name,
                        "map_axes does not name it; allowed: with a parameter of the code of that name");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadProgramAxes(const MpmSettings *settings, MpmRequest *request)
{
  static const char allowed[] = "allowed: two different parameters that the code names, such as dt,E";
  PetscInt          points[2], n;
  PetscBool         fit;

  PetscFunctionBegin;
  MpmCheckInput(
      MpmSettingsSource(settings, "map_axes") != MPM_FROM_DEFAULT,
      "map of a code: map_axes is missing; allowed: -map_axes with two parameters that the code names, such as "
      "dt,E, and a span for each, as -map_dt lo,hi");
  Words(MpmSettingsText(settings, "map_axes"), &n, request->axes, &fit);
  MpmSettingsRefuseIf(!fit || n != 2 || !strcmp(request->axes[0].name, request->axes[1].name), settings, "map_axes",
                      allowed);
  PetscCall(MpmSettingsList(settings, "map_points", 2, &n, points));
  MpmSettingsRefuseIf(n != 2, settings, "map_points", "allowed: two whole numbers, one for each axis");
  for (int a = 0; a < 2; a++) {
    MpmAxis *axis = &request->axes[a];

    MpmCheckInput(!MpmSettingsIsOfMap(axis->name) && !strchr(axis->name, '/'),
                  "-map_axes %s: files of maps cannot hold numbers of that name; allowed: other parameters",
                  axis->name);
    PetscCall(ReadSpan(axis));
    axis->kind      = MPM_AXIS_PARAMETER;
    axis->parameter = MPM_NONE;
    axis->points    = points[a];
  }
  PetscCall(CheckSpans(settings, request));
  PetscFunctionReturn(PETSC_SUCCESS);
}
