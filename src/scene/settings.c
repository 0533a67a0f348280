/*
   Gathers what the user said, first in the scene file, then on the command line, and refuses options that do not
   exist.
*/
#include "scene/settings.h"
#include "base/suggest.h"
#include <string.h>

PetscErrorCode MpmSettingsSet(MpmSettings *settings, PetscInt option, const char text[], MpmSource source, int line)
{
  const char    *rival = MpmOptions[option].rival;
  const PetscInt other = rival ? MpmOptionIndex(rival) : MPM_NOT_AN_OPTION;

  PetscFunctionBegin;
  if (rival) {
    MpmCheckInput(settings->source[other] != source, "%s and %s are both given %s%s; allowed: one of them",
                  MpmOptions[PetscMin(option, other)].name, MpmOptions[PetscMax(option, other)].name,
                  source == MPM_FROM_SCENE ? "in " : "on the command line",
                  source == MPM_FROM_SCENE ? settings->scene : "");
    PetscCall(PetscFree(settings->text[other]));
    settings->source[other] = MPM_FROM_DEFAULT;
  }
  PetscCall(PetscFree(settings->text[option]));
  PetscCall(PetscStrallocpy(text, &settings->text[option]));
  settings->source[option] = source;
  settings->line[option]   = line;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadCommandLine(MpmSettings *settings)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    char        key[64];
    const char *text;
    PetscBool   given;

    PetscCall(PetscSNPrintf(key, sizeof key, "-%s", MpmOptions[i].name));
    PetscCall(PetscOptionsFindPair(NULL, NULL, key, &text, &given));
    if (given) PetscCall(MpmSettingsSet(settings, i, text ? text : "", MPM_FROM_COMMAND_LINE, 0));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCreate(MpmSettings **settings)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(settings));
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    PetscCheck(i < MPM_MAX_OPTIONS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_OPTIONS");
    if (MpmOptions[i].fallback) PetscCall(PetscStrallocpy(MpmOptions[i].fallback, &(*settings)->text[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsDestroy(MpmSettings **settings)
{
  PetscFunctionBegin;
  if (*settings)
    for (PetscInt i = 0; MpmOptions[i].name; i++) PetscCall(PetscFree((*settings)->text[i]));
  PetscCall(PetscFree(*settings));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Whether an option is one of PETSc's or SLEPc's. These libraries read their options while the task runs, so beforehand
   only the families are known, and which tasks call SLEPc.
*/
static PetscErrorCode CheckLibrary(const char task[], const char name[], PetscBool *is_theirs)
{
  static const char *const any[]   = {"log_",          "malloc",  "objects_", "options_", "on_error_", "info",
                                      "dm_",           "da_",     "vec_",     "mat_",     "sf_",       "viewer_",
                                      "mpi_",          "memory_", "fp_trap",  "debugger", "start_in",  "saws",
                                      "check_pointer", "ksp_",    "pc_",      "nodal_"};
  static const char *const slepc[] = {"eps_", "st_", "bv_", "ds_", "svd_"}, *const eigen[] = {"spectrum", "critical"};

  PetscFunctionBegin;
  *is_theirs = PETSC_FALSE;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(any); i++)
    if (!strncmp(name, any[i], strlen(any[i]))) *is_theirs = PETSC_TRUE;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(slepc); i++) {
    if (strncmp(name, slepc[i], strlen(slepc[i]))) continue;
    MpmCheckInput(!strcmp(task, eigen[0]) || !strcmp(task, eigen[1]),
                  "-%.200s: task %s does not read it; allowed: with task %s or %s", name, task, eigen[0], eigen[1]);
    *is_theirs = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RefuseUnknown(const char name[])
{
  const char *names[MPM_MAX_OPTIONS], *near;
  PetscInt    n = 0;

  PetscFunctionBegin;
  while (MpmOptions[n].name) {
    names[n] = MpmOptions[n].name;
    n++;
  }
  near = MpmSuggest(name, n, names);
  if (near) MpmRefuse("unknown option -%s; did you mean -%s?", name, near);
  MpmRefuse("unknown option -%.200s; 'mpmstab list options' shows those there are", name);
}

static PetscBool IsKey(const char word[])
{
  return word[0] == '-' && (word[1] == '-' || (word[1] | 32) >= 'a') ? PETSC_TRUE : PETSC_FALSE;
}

/* A scene file may hold options that other tasks read; on the command line such an option is a mistake. */
static PetscErrorCode CheckTask(const char task[], const MpmField *option)
{
  PetscFunctionBegin;
  MpmCheckInput(!option->tasks || strstr(option->tasks, task), "-%s: task %s does not read it; allowed: with task %s",
                option->name, task, option->tasks);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCheckCommandLine(const char task[], int argc, char **argv, int first)
{
  PetscBool is_theirs;

  PetscFunctionBegin;
  for (int i = first; i < argc; i++) {
    MpmCheckInput(IsKey(argv[i]), "unexpected word '%.200s'; allowed: TASK [SCENE.yaml] [-option value]...", argv[i]);
    for (int j = first; j < i; j++)
      MpmCheckInput(MpmOptionIndex(argv[i] + 1) == MPM_NOT_AN_OPTION || strcmp(argv[i], argv[j]),
                    "%s is given a second time; allowed: once", argv[i]);
    if (MpmOptionIndex(argv[i] + 1) != MPM_NOT_AN_OPTION)
      PetscCall(CheckTask(task, &MpmOptions[MpmOptionIndex(argv[i] + 1)]));
    else {
      PetscCall(CheckLibrary(task, argv[i] + 1, &is_theirs));
      if (!is_theirs) PetscCall(RefuseUnknown(argv[i] + 1));
    }
    if (i + 1 < argc && !IsKey(argv[i + 1])) i++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCheckUnused(void)
{
  PetscInt n;
  char   **names, **values;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &n, &names, &values));
  for (PetscInt i = 0; i < n; i++) {
    /* PETSc reads these when it ends */
    if (!strncmp(names[i], "options_", 8) || !strncmp(names[i], "objects_", 8) || !strncmp(names[i], "malloc", 6))
      continue;
    PetscCall(RefuseUnknown(names[i]));
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &n, &names, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}
