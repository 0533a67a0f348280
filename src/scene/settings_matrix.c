/* A matrix, or the blocks of a lattice, in the place of a scene: which options go with it. */
#include "scene/settings.h"
#include <string.h>

/* The options that name one, and the task that reads each. */
static const char *const sources[] = {"matrix", "matrix_blocks"};

/* Whether an option was given and this task reads it. A scene file may have those of other tasks. */
static PetscBool IsSaid(const MpmSettings *settings, const char task[], PetscInt i)
{
  const char *tasks = MpmOptions[i].tasks;

  return settings->source[i] != MPM_FROM_DEFAULT && (!tasks || strstr(tasks, task)) ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmSettingsNameMatrix(const MpmSettings *settings, const char task[], PetscBool *named)
{
  const char *source = NULL;
  char        why[128];

  PetscFunctionBegin;
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(sources); s++) {
    const char *reads = MpmOptions[MpmOptionIndex(sources[s])].tasks;

    if (!MpmSettingsGiven(settings, sources[s])) continue;
    source = sources[s];
    PetscCall(PetscSNPrintf(why, sizeof why, "task %s does not read it; allowed: with task %s", task, reads));
    if (strcmp(reads, task)) PetscCall(MpmSettingsRefuse(settings, source, why));
  }
  *named = source ? PETSC_TRUE : PETSC_FALSE;
  if (!source && MpmSettingsGiven(settings, "matrix_steps"))
    PetscCall(MpmSettingsRefuse(settings, "matrix_steps", "allowed: only with matrix or matrix_blocks"));
  if (!source) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(why, sizeof why,
                          "it describes a scene, and %s takes the place of a scene; allowed: one of them", source));
  for (PetscInt i = 0; MpmOptions[i].name; i++)
    if (IsSaid(settings, task, i) && !MpmOptions[i].of_matrix)
      PetscCall(MpmSettingsRefuse(settings, MpmOptions[i].name, why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsPhases(const MpmSettings *settings, PetscInt *given)
{
  const char *text = MpmSettingsText(settings, "phases");

  PetscFunctionBegin;
  *given = text ? 1 : 0;
  for (; text && *text; text++) *given += *text == ',';
  PetscFunctionReturn(PETSC_SUCCESS);
}
