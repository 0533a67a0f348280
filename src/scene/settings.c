/*
   What the user said: in the scene file, then where PETSc finds options, then on the command line. Options that do not
   exist, and those that the task does not read, are refused here.
*/
#include "base/launch.h"
#include "base/text.h"
#include "scene/settings.h"
#include <mpmstab/compat.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/*
   PETSc keeps the options of all places in one database. Here each place is read once more, and the one that has the
   option with the database's value is the one that counts.
*/

/* Where on the command line an option is; 0: nowhere. */
static PetscErrorCode FindOnCommandLine(const char name[], int *at, char ***argv)
{
  int argc;

  PetscFunctionBegin;
  PetscCall(PetscGetArgs(&argc, argv));
  for (*at = argc - 1; *at > 0; --*at)
    if ((*argv)[*at][0] == '-' && !strcmp((*argv)[*at] + 1, name)) break;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the variable PETSC_OPTIONS (file NULL), or a file, gives the option this value. */
static PetscErrorCode Gives(const char file[], const char name[], const char value[], PetscBool *gives)
{
  const char  *variable = getenv("PETSC_OPTIONS"), *text;
  char         key[256];
  PetscOptions options;

  PetscFunctionBegin;
  (void)snprintf(key, sizeof key, "-%s", name);
  PetscCall(PetscOptionsCreate(&options));
  if (file)
    PetscCall(PetscOptionsInsertFile(PETSC_COMM_WORLD, options, file, PETSC_FALSE));
  else if (variable)
    PetscCall(PetscOptionsInsertString(options, variable));
  PetscCall(PetscOptionsFindPair(options, NULL, key, &text, gives));
  if (*gives && strcmp(text ? text : "", value ? value : "")) *gives = PETSC_FALSE;
  PetscCall(PetscOptionsDestroy(&options));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsPlaceFile(int i, size_t room, char file[], PetscBool *there)
{
  char **argv;
  int    skipped, at;

  PetscFunctionBegin;
  *there = PETSC_FALSE;
  PetscCall(FindOnCommandLine("options_file", &at, &argv));
  if (at && i == 0 && argv[at + 1]) {
    (void)snprintf(file, room, "%s", argv[at + 1]);
    *there = PETSC_TRUE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(FindOnCommandLine("skip_petscrc", &skipped, &argv));
  if (!skipped) *there = MpmLaunchOptionFile(at ? i - 1 : i, room, file) ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsPlace(const char name[], const char value[], char place[MPM_PLACE_TEXT])
{
  char      file[MPM_PLACE_TEXT - 16], **argv;
  PetscBool is, there = PETSC_TRUE;
  int       at;

  PetscFunctionBegin;
  place[0] = '\0';
  PetscCall(FindOnCommandLine(name, &at, &argv));
  if (at) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Gives(NULL, name, value, &is));
  if (is) (void)snprintf(place, MPM_PLACE_TEXT, "%s", ", from PETSC_OPTIONS");
  for (int i = 0; !is && there; i++) {
    PetscCall(MpmSettingsPlaceFile(i, sizeof file, file, &there));
    if (there) PetscCall(Gives(file, name, value, &is));
    if (is) (void)snprintf(place, MPM_PLACE_TEXT, ", from %s", file);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- names of the field, and those of this program ---- */

/* clang-format off */
static const char *const options[][2] = {
    {"cfl", "courant"}, {"cfl_number", "courant"}, {"courant_number", "courant"}, {"E", "young"},
    {"youngs_modulus", "young"}, {"nu", "poisson"}, {"poissons_ratio", "poisson"}, {"rho", "density"}, {"K", "bulk"},
    {"G", "shear"}, {"o", "output"}, {"out", "output"}, {"dx", "cell_width"}, {"time_step", "dt"}, {"timestep", "dt"},
    {"delta_t", "dt"}, {"particles_per_cell", "ppc"}, {"n_cells", "cells"}, {"ncells", "cells"}, {"dimension", "dim"},
    {"dimensions", "dim"}, {"ndim", "dim"}, {"method", "formulation"}, {"stress_update", "formulation"},
    {"shape", "basis"}, {"shape_function", "basis"}, {"kernel", "basis"}, {"flip_ratio", "blend_ratio"},
    {"bc", "boundary"}, {"U0", "velocity"}, {"speed", "velocity"}, {"tol", "tolerance"},
};
/* clang-format on */

/* option, the word, and what it is here */
static const char *const words[][3] = {
    {"formulation", "mls-mpm", "-formulation usl -transfer apic -gradient mls -basis quadratic"},
    {"formulation", "mlsmpm", "-formulation usl -transfer apic -gradient mls -basis quadratic"},
    {"formulation", "mls", "-formulation usl -transfer apic -gradient mls -basis quadratic"},
    {"formulation", "apic", "-formulation usl -transfer apic"},
    {"formulation", "flip", "-formulation usl, with -transfer flip"},
    {"formulation", "pic", "-formulation usl -transfer pic"},
    {"formulation", "gimp", "-formulation usl -basis gimp"},
    {"formulation", "mpm", "usl, usf, musl or usavg, by when the stress is updated"},
    {"basis", "bspline", "quadratic or cubic"},
    {"basis", "b-spline", "quadratic or cubic"},
    {"basis", "spline", "quadratic or cubic"},
    {"basis", "quadratic-spline", "quadratic"},
    {"basis", "cubic-spline", "cubic"},
    {"basis", "hat", "linear"},
    {"basis", "tent", "linear"},
    {"basis", "ugimp", "gimp"},
    {"transfer", "mls-mpm", "apic, with -gradient mls"},
    {"transfer", "mls", "apic, with -gradient mls"},
    {"gradient", "spline", "basis"},
    {"boundary", "wall", "fixed"},
};

const char *MpmOptionCalledHere(const char name[])
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(options); i++)
    if (strlen(options[i][0]) == 1 ? !strcmp(options[i][0], name) : !strcasecmp(options[i][0], name))
      return options[i][1];
  return NULL;
}

const char *MpmWordCalledHere(const char option[], const char word[])
{
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(words); i++)
    if (!strcmp(words[i][0], option) && !strcasecmp(words[i][1], word)) return words[i][2];
  return NULL;
}

/* ---- what the user said ---- */

/* Takes away what a weaker source said in another way; the same source must not say it twice. */
PetscErrorCode MpmSettingsDisplace(MpmSettings *settings, PetscInt option, PetscInt other, MpmOrigin source)
{
  PetscFunctionBegin;
  MpmCheckInput(settings->source[other] != source, "%s and %s are both given %s%s; allowed: one of them",
                MpmOptions[PetscMin(option, other)].name, MpmOptions[PetscMax(option, other)].name,
                source == MPM_FROM_SCENE     ? "in "
                : source == MPM_FROM_OUTSIDE ? "outside command line and scene"
                                             : "on the command line",
                source == MPM_FROM_SCENE ? settings->scene : "");
  PetscCall(PetscFree(settings->text[other]));
  settings->source[other] = MPM_FROM_DEFAULT;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsSet(MpmSettings *settings, const char name[], const char text[], MpmOrigin source, int line)
{
  PetscInt i = MpmSettingsIndex(settings, name);

  PetscFunctionBegin;
  if (i == MPM_NOT_AN_OPTION) {
    MpmCheckInput(settings->n < MPM_MOST_SAID, "%s:%d: key '%s': more keys that are no options than the %d that fit",
                  settings->scene, line, name, MPM_MOST_SAID);
    PetscCall(PetscStrallocpy(name, &settings->name[settings->n]));
    i = MPM_MAX_OPTIONS + settings->n++;
  }
  for (const char *rival = i < MPM_MAX_OPTIONS ? MpmOptions[i].rival : NULL; rival && *rival;
       rival += strcspn(rival, ",")) {
    char other[64];

    if (*rival == ',') rival++;
    (void)snprintf(other, strcspn(rival, ",") + 1, "%s", rival);
    PetscCall(MpmSettingsDisplace(settings, i, MpmOptionIndex(other), source));
  }
  PetscCall(PetscFree(settings->text[i]));
  PetscCall(PetscStrallocpy(text, &settings->text[i]));
  settings->source[i] = source;
  settings->line[i]   = line;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadOption(MpmSettings *settings, const char name[], MpmOrigin source)
{
  char        key[96], place[MPM_PLACE_TEXT];
  const char *text;
  PetscBool   given;
  MpmOrigin   from;

  PetscFunctionBegin;
  (void)snprintf(key, sizeof key, "-%s", name);
  PetscCall(PetscOptionsFindPair(NULL, NULL, key, &text, &given));
  if (!given) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsPlace(name, text, place));
  from = place[0] ? MPM_FROM_OUTSIDE : MPM_FROM_COMMAND_LINE;
  if (source == MPM_FROM_DEFAULT || source == from)
    PetscCall(MpmSettingsSet(settings, name, text ? text : "", from, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadCommandLine(MpmSettings *settings)
{
  PetscFunctionBegin;
  for (MpmOrigin source = MPM_FROM_OUTSIDE; source <= MPM_FROM_COMMAND_LINE; source++)
    for (PetscInt i = 0; MpmOptions[i].name; i++)
      PetscCall(MpmSettingsReadOption(settings, MpmOptions[i].name, source));
  settings->has_options = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCreate(MpmSettings **settings)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(settings));
  PetscCall(PetscNew(&(*settings)->files));
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    PetscCheck(i < MPM_MAX_OPTIONS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_OPTIONS");
    if (MpmOptions[i].fallback) PetscCall(PetscStrallocpy(MpmOptions[i].fallback, &(*settings)->text[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsDestroy(MpmSettings **settings)
{
  PetscFunctionBegin;
  if (*settings) {
    for (PetscInt i = 0; i < MPM_MOST_SETTINGS; i++) PetscCall(PetscFree((*settings)->text[i]));
    for (PetscInt i = 0; i < MPM_MOST_SAID; i++) PetscCall(PetscFree((*settings)->name[i]));
    PetscCall(MpmWrittenDestroy(&(*settings)->inside));
    PetscCall(MpmWrittenDestroy(&(*settings)->outside));
    MpmTextFree((*settings)->files);
    PetscCall(PetscFree((*settings)->files));
  }
  PetscCall(PetscFree(*settings));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- options that do not exist, that the task does not read, or that stand elsewhere ---- */

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

PetscBool MpmSettingsIsLibrary(const char name[])
{
  static const char *const help[] = {"h", "help", "v", "version"};

  if (Begins(name, PETSC_STATIC_ARRAY_LENGTH(any), any) || Begins(name, PETSC_STATIC_ARRAY_LENGTH(slepc), slepc))
    return PETSC_TRUE;
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

/* Whether an option is map_ and a word of map_axes; the parameters of a code are known when it has been started. */
static PetscErrorCode IsSpan(const char name[], PetscBool *is)
{
  const char *text = NULL;
  PetscBool   given;

  PetscFunctionBegin;
  PetscCall(PetscOptionsFindPair(NULL, NULL, "-map_axes", &text, &given));
  *is = PETSC_FALSE;
  for (size_t n; text && *text && !strncmp(name, "map_", 4); text += n + strspn(text + n, ", ")) {
    n = strcspn(text, ", ");
    if (strlen(name) == n + 4 && !strncmp(name + 4, text, n)) *is = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Refuses an option that is not on the list, unless it is a library's (is_theirs), a parameter of the scheme that the
   scene, or the option scheme, names, or the span of a code's parameter.
*/
static PetscErrorCode CheckOther(const char task[], const char scene[], const char name[], const char place[],
                                 PetscBool *is_theirs)
{
  const PetscBool solves   = Begins(name, PETSC_STATIC_ARRAY_LENGTH(slepc), slepc);
  PetscBool       is       = PETSC_FALSE, file;
  char            near[64] = "";

  PetscFunctionBegin;
  MpmCheckInput(!solves || !strcmp(task, eigen[0]) || !strcmp(task, eigen[1]),
                "-%.200s%s: task %s does not read it; allowed: with task %s or %s", name, place, task, eigen[0],
                eigen[1]);
  *is_theirs = solves || Begins(name, PETSC_STATIC_ARRAY_LENGTH(any), any) ? PETSC_TRUE : PETSC_FALSE;
  if (*is_theirs) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscOptionsHasName(NULL, NULL, "-scheme", &file));
  if (scene || file) PetscCall(MpmSettingsHasParameter(scene, name, &is, sizeof near, near));
  if (!is) PetscCall(IsSpan(name, &is));
  MpmCheckInput(is || !near[0], "unknown option -%.200s%s; did you mean -%s, a parameter of the scheme?", name, place,
                near);
  if (!is) PetscCall(RefuseUnknown(name, place, ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsKey(const char word[])
{
  return word[0] == '-' && (word[1] == '-' || (word[1] | 32) >= 'a') ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmSettingsCheckCommandLine(const char task[], int argc, char **argv, int first)
{
  PetscFunctionBegin;
  for (int i = first; i < argc; i++) {
    const char    *name      = argv[i] + 1;
    const PetscInt option    = MpmOptionIndex(name);
    PetscBool      is_theirs = PETSC_FALSE;

    MpmCheckInput(IsKey(argv[i]), "unexpected word '%.200s'; allowed: TASK [SCENE.yaml] [-option value]...", argv[i]);
    if (option == MPM_NOT_AN_OPTION) PetscCall(CheckOther(task, first ? argv[0] : NULL, name, "", &is_theirs));
    for (int j = first; j < i && !is_theirs; j++)
      MpmCheckInput(strcmp(argv[i], argv[j]), "%s is given a second time; allowed: once", argv[i]);
    /* a scene file may hold options that other tasks read; on the command line such an option is a mistake */
    MpmCheckInput(option == MPM_NOT_AN_OPTION || MpmFieldIsOf(&MpmOptions[option], task),
                  "-%s: task %s does not read it; allowed: with task %s", name, task, MpmOptions[option].tasks);
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

/* Adds an option to the line of its place, of those that begin with 'from PETSC_OPTIONS' or 'from FILE'. */
static PetscErrorCode Say(const char task[], const char name[], const char value[], const char place[], MpmText *line)
{
  const PetscInt option = MpmOptionIndex(name);
  const size_t   length = strlen(place);
  const MpmText *last   = line + MOST_PLACES - 1;

  PetscFunctionBegin;
  while (line < last && line->text && (strncmp(line->text, place, length) || line->text[length] != ':')) line++;
  if (!line->text) PetscCall(MpmTextAdd(line, "%s:", place));
  PetscCall(MpmTextAdd(line, " -%s%s%s", name, value && value[0] ? " " : "", value ? value : ""));
  if (option != MPM_NOT_AN_OPTION && !MpmFieldIsOf(&MpmOptions[option], task))
    PetscCall(MpmTextAdd(line, " (not read by this task)"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsCheckOutside(const char task[], const char scene[])
{
  MpmText   line[MOST_PLACES] = {{NULL, 0}};
  char      place[MPM_PLACE_TEXT], **names, **values;
  PetscBool is_theirs;
  PetscInt  n;

  PetscFunctionBegin;
  PetscCall(PetscOptionsLeftGet(NULL, &n, &names, &values));
  for (PetscInt i = 0; i < n; i++) {
    if (IsReadLast(names[i])) continue;
    PetscCall(MpmSettingsPlace(names[i], values[i], place));
    if (!place[0]) continue;
    if (MpmOptionIndex(names[i]) == MPM_NOT_AN_OPTION) PetscCall(CheckOther(task, scene, names[i], place, &is_theirs));
    PetscCall(Say(task, names[i], values[i], place + strlen(", "), line));
  }
  for (int i = 0; i < MOST_PLACES && line[i].text; i++) {
    MpmPrint("%s\n", line[i].text);
    MpmTextFree(&line[i]);
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
