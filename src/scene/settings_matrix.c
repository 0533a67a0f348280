/* A matrix, the blocks of a lattice, or a code in the place of a scene: which options go with it. */
#include "scene/request.h"
#include "scene/settings.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

const char *const MpmProbeNames[] = {"bloch", "coloured", "matrix_free", NULL};

/* The options that name one. Each option's tasks are those that read it. */
static const char *const sources[] = {"matrix", "matrix_blocks", "program", "plugin"};

/* Whether an option was given and this task reads it. A scene file may have those of other tasks. */
static PetscBool IsSaid(const MpmSettings *settings, const char task[], PetscInt i)
{
  return settings->source[i] != MPM_FROM_DEFAULT && MpmFieldIsOf(&MpmOptions[i], task) ? PETSC_TRUE : PETSC_FALSE;
}

/* A code can be set to the places of a drift, for all that takes its base state. */
static PetscBool IsMotion(const char source[], const char task[], const char name[])
{
  return (!strcmp(source, "program") || !strcmp(source, "plugin")) && strcmp(task, "map") &&
                 (!strcmp(name, "drift") || !strcmp(name, "mach"))
             ? PETSC_TRUE
             : PETSC_FALSE;
}

PetscErrorCode MpmSettingsNameMatrix(const MpmSettings *settings, const char task[], PetscBool *named)
{
  const char *source = NULL;
  char        why[128];

  PetscFunctionBegin;
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(sources); s++) {
    const char *reads = MpmOptions[MpmOptionIndex(sources[s])].tasks;

    if (!MpmSettingsGiven(settings, sources[s])) continue;
    MpmSettingsRefuseIf(!MpmFieldIsOf(&MpmOptions[MpmOptionIndex(sources[s])], task), settings, sources[s],
                        "task %s does not read it; allowed: with task %s", task, reads);
    MpmSettingsRefuseIf(source, settings, sources[s], "%s takes the place of a scene too; allowed: one of them",
                        source);
    source = sources[s];
  }
  *named = source ? PETSC_TRUE : PETSC_FALSE;
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    const char *with = MpmOptions[i].with;

    MpmSettingsRefuseIf(with && IsSaid(settings, task, i) && !(source && strstr(with, source)), settings,
                        MpmOptions[i].name, "allowed: only with %s", with);
  }
  if (!source) PetscFunctionReturn(PETSC_SUCCESS);
  (void)snprintf(why, sizeof why, "it describes a scene, and %s takes the place of a scene; allowed: one of them",
                 source);
  for (PetscInt i = 0; MpmOptions[i].name; i++)
    MpmSettingsRefuseIf(IsSaid(settings, task, i) && !MpmOptions[i].of_matrix &&
                            !IsMotion(source, task, MpmOptions[i].name),
                        settings, MpmOptions[i].name, "%s", why);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A number for each direction, or one for all; how many there are is known when the code has described itself. */
static PetscErrorCode ReadMotion(const MpmSettings *settings, MpmRequest *request)
{
  const char *name = IsSaid(settings, request->task, MpmOptionIndex("mach")) ? "mach" : "drift";
  const char *text = MpmSettingsText(settings, name);
  PetscInt    n    = 0;

  PetscFunctionBegin;
  if (!IsSaid(settings, request->task, MpmOptionIndex(name))) PetscFunctionReturn(PETSC_SUCCESS);
  request->program_mach = strcmp(name, "drift") ? PETSC_TRUE : PETSC_FALSE;
  for (const char *at = text; at && n <= MPM_MAX_DIM; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL, n++) {
    char        one[64];
    MpmFraction number;

    (void)snprintf(one, sizeof one, "%.*s", (int)strcspn(at, ","), at);
    MpmSettingsRefuseIf(n == MPM_MAX_DIM || !MpmFractionParse(one, &number) || !number.den || fabs(number.value) > 1e6,
                        settings, name, "allowed: a number or a fraction such as 1/8, or one for each direction");
    for (PetscInt a = n; a < (n ? n + 1 : MPM_MAX_DIM); a++) request->program_drift[a] = number;
  }
  MpmSettingsRefuseIf(
      request->at[0] || request->program_run, settings, name,
      "particles are set along it from where the code describes them; allowed: without at and program_run");
  MpmSettingsRefuseIf(request->program_mach && !strcmp(request->task, "critical"), settings, name,
                      "the places would change with the time step; allowed: drift");
  MpmSettingsRefuseIf(request->compare[0], settings, name, "allowed: without compare, which takes the code as it is");
  MpmSettingsRefuseIf(request->write_blocks[0], settings, name,
                      "the blocks are those of one step; allowed: without write_blocks");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadProgram(const MpmSettings *settings, MpmRequest *request)
{
  const char *const task = request->task;
  PetscInt          kind = MPM_PROBE_ANY;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(request->program_dt[0] && strcmp(task, "critical") && !request->compare[0], settings,
                      "program_dt", "allowed: with task critical, or with compare");
  MpmSettingsRefuseIf(request->compare[0] && request->at[0], settings, "compare",
                      "it is about the state that the code describes; allowed: without at");
  if (request->program[0] || request->plugin[0]) PetscCall(ReadMotion(settings, request));
  if (MpmSettingsGiven(settings, "probe")) PetscCall(MpmSettingsWord(settings, "probe", &kind));
  request->probe = (MpmProbeKind)kind;
  MpmSettingsRefuseIf(!strcmp(task, "symbol") &&
                          (request->probe == MPM_PROBE_COLOURED || request->probe == MPM_PROBE_MATRIX_FREE),
                      settings, "probe", "a symbol needs cells that are alike; allowed: bloch");
  MpmSettingsRefuseIf(!strcmp(task, "spectrum") && request->probe == MPM_PROBE_BLOCH, settings, "probe",
                      "a spectrum is of all particles; allowed: coloured or matrix_free, or task symbol");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRequestPhases(const MpmRequest *request, PetscInt dim, PetscInt phases[])
{
  static const PetscInt fallback[MPM_MAX_DIM] = {64, 32, 16};

  PetscFunctionBegin;
  MpmCheckInput(request->given_phases <= 1 || request->given_phases == dim,
                "-phases: %" PetscInt_FMT " numbers, and the blocks of %s have %" PetscInt_FMT
                " direction%s; allowed: one number for all directions, or one for each",
                request->given_phases, MpmRequestSource(request), dim, dim == 1 ? "" : "s");
  for (PetscInt a = 0; a < dim; a++) phases[a] = request->given_phases ? request->phases[a] : fallback[dim - 1];
  PetscFunctionReturn(PETSC_SUCCESS);
}
