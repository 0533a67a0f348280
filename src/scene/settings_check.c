/*
   Refuses options that do not exist and options that the task does not read, and says which options stand neither on the
   command line nor in the scene.
*/
#include "base/text.h"
#include "scene/settings.h"
#include "scene/settings_place.h"
#include "scene/synonyms.h"
#include <string.h>

/*
   Whether an option is one of PETSc's or SLEPc's. These libraries read their options while the task runs, so beforehand
   only the families are known, and which tasks call SLEPc.
*/
static const char *const any[]   = {"log_",          "malloc",  "objects_",  "options_",    "on_error_", "info",
                                    "dm_",           "da_",     "vec_",      "mat_",        "sf_",       "viewer_",
                                    "mpi_",          "memory_", "fp_trap",   "debugger",    "start_in",  "saws",
                                    "check_pointer", "nodal_",  "implicit_", "skip_petscrc"};
static const char *const slepc[] = {"eps_", "st_", "bv_", "ds_", "svd_"}, *const eigen[] = {"spectrum", "critical"};

/* Whether a name begins with one of n others. */
static PetscBool Begins(const char name[], size_t n, const char *const others[])
{
  for (size_t i = 0; i < n; i++)
    if (!strncmp(name, others[i], strlen(others[i]))) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscErrorCode CheckLibrary(const char task[], const char name[], const char place[], PetscBool *is_theirs)
{
  PetscFunctionBegin;
  *is_theirs = Begins(name, PETSC_STATIC_ARRAY_LENGTH(any), any);
  if (!Begins(name, PETSC_STATIC_ARRAY_LENGTH(slepc), slepc)) PetscFunctionReturn(PETSC_SUCCESS);
  MpmCheckInput(!strcmp(task, eigen[0]) || !strcmp(task, eigen[1]),
                "-%.200s%s: task %s does not read it; allowed: with task %s or %s", name, place, task, eigen[0],
                eigen[1]);
  *is_theirs = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmSettingsIsLibrary(const char name[])
{
  static const char *const help[] = {"h", "help", "v", "version"};

  if (Begins(name, PETSC_STATIC_ARRAY_LENGTH(any), any)) return PETSC_TRUE;
  if (Begins(name, PETSC_STATIC_ARRAY_LENGTH(slepc), slepc)) return PETSC_TRUE;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(help); i++)
    if (!strcmp(name, help[i])) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* place: where it stands, as MpmSettingsPlace says it; more: what the user has to know besides. */
static PetscErrorCode RefuseUnknown(const char name[], const char place[], const char more[])
{
  const char *near = MpmOptionNear(name);

  PetscFunctionBegin;
  if (MpmOptionCalledHere(name))
    MpmRefuse("unknown option -%.200s%s; it is called -%s here%s", name, place, MpmOptionCalledHere(name), more);
  if (near) MpmRefuse("unknown option -%.200s%s; did you mean -%s?%s", name, place, near, more);
  MpmRefuse("unknown option -%.200s%s; 'mpmstab list options' shows those there are%s", name, place, more);
}

/*
   An option that is not on the list may be a parameter of the scheme that the scene, or the option scheme, names, or the
   span of a code's parameter.
*/
static PetscErrorCode CheckParameter(const char scene[], const char name[], const char place[])
{
  PetscBool is       = PETSC_FALSE, file;
  char      near[64] = "";

  PetscFunctionBegin;
  PetscCall(PetscOptionsHasName(NULL, NULL, "-scheme", &file));
  if (scene || file) PetscCall(MpmSettingsHasParameter(scene, name, &is, sizeof near, near));
  if (!is) PetscCall(MpmSettingsIsSpanOfProgram(name, &is));
  MpmCheckInput(is || !near[0], "unknown option -%.200s%s; did you mean -%s, a parameter of the scheme?", name, place,
                near);
  if (!is) PetscCall(RefuseUnknown(name, place, ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsKey(const char word[])
{
  return word[0] == '-' && (word[1] == '-' || (word[1] | 32) >= 'a') ? PETSC_TRUE : PETSC_FALSE;
}

/* A scene file may hold options that other tasks read; on the command line such an option is a mistake. */
static PetscErrorCode CheckTask(const char task[], const MpmField *option)
{
  PetscFunctionBegin;
  MpmCheckInput(MpmFieldIsOf(option, task), "-%s: task %s does not read it; allowed: with task %s", option->name, task,
                option->tasks);
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
      PetscCall(CheckLibrary(task, argv[i] + 1, "", &is_theirs));
      if (!is_theirs) PetscCall(CheckParameter(first ? argv[0] : NULL, argv[i] + 1, ""));
      for (int j = first; j < i && !is_theirs; j++)
        MpmCheckInput(strcmp(argv[i], argv[j]), "%s is given a second time; allowed: once", argv[i]);
    }
    if (i + 1 < argc && !IsKey(argv[i + 1])) i++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* PETSc reads these when it ends. */
static PetscBool IsReadLast(const char name[])
{
  return !strncmp(name, "options_", 8) || !strncmp(name, "objects_", 8) || !strncmp(name, "malloc", 6) ? PETSC_TRUE
                                                                                                       : PETSC_FALSE;
}

#define MOST_PLACES 5 /* the variable and four files */

/* A line for each place that gives options. */
typedef struct {
  MpmText place[MOST_PLACES];
} Lines;

/* Adds an option to the line of its place, which is of the form 'from PETSC_OPTIONS'. */
static PetscErrorCode Say(const char task[], const char name[], const char value[], const char place[], Lines *lines)
{
  const PetscInt option = MpmOptionIndex(name);
  const size_t   length = strlen(place);
  MpmText       *line   = lines->place;

  PetscFunctionBegin;
  while (line < lines->place + MOST_PLACES - 1 && line->text &&
         (strncmp(line->text, place, length) || line->text[length] != ':'))
    line++;
  if (!line->text) PetscCall(MpmTextAdd(line, "%s:", place));
  PetscCall(MpmTextAdd(line, " -%s%s%s", name, value && value[0] ? " " : "", value ? value : ""));
  if (option != MPM_NOT_AN_OPTION && !MpmFieldIsOf(&MpmOptions[option], task))
    PetscCall(MpmTextAdd(line, " (not read by this task)"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCheckOutside(const char task[], const char scene[])
{
  Lines     lines = {{{NULL, 0}}};
  char      place[MPM_PLACE_TEXT], **names, **values;
  PetscBool is_theirs;
  PetscInt  n;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &n, &names, &values));
  for (PetscInt i = 0; i < n; i++) {
    if (IsReadLast(names[i])) continue;
    PetscCall(MpmSettingsPlace(names[i], values[i], place));
    if (!place[0]) continue;
    if (MpmOptionIndex(names[i]) == MPM_NOT_AN_OPTION) {
      PetscCall(CheckLibrary(task, names[i], place, &is_theirs));
      if (!is_theirs) PetscCall(CheckParameter(scene, names[i], place));
    }
    PetscCall(Say(task, names[i], values[i], place + strlen(", "), &lines));
  }
  for (int i = 0; i < MOST_PLACES && lines.place[i].text; i++) {
    MpmPrint("%s\n", lines.place[i].text);
    MpmTextFree(&lines.place[i]);
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &n, &names, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCheckUnused(void)
{
  char     place[MPM_PLACE_TEXT];
  PetscInt n;
  char   **names, **values;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &n, &names, &values));
  for (PetscInt i = 0; i < n; i++) {
    if (IsReadLast(names[i])) continue;
    PetscCall(MpmSettingsPlace(names[i], values[i], place));
    PetscCall(RefuseUnknown(names[i], place, "; nothing has read it, but the work is done and its files are written"));
  }
  PetscCall(PetscOptionsLeftRestore(NULL, &n, &names, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}
