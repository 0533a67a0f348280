/*
   Names of files. They are refused before any work is done when they cannot be written, or would overwrite one
   another.
*/
#include "base/textfile.h"
#include "scene/settings.h"
#include "scene/request.h"
#include <string.h>

#define MESSAGE 4096
#define BETWEEN_WORDS " \t\n'\"=;|&<>()"

/* Whether the task reads an option that names a file which is used so, and the option was given. */
static PetscBool IsUsed(const MpmSettings *settings, const char task[], PetscInt option, MpmFileUse use)
{
  const MpmField *o = &MpmOptions[option];

  return o->file == use && settings->text[option] && MpmFieldIsOf(o, task) ? PETSC_TRUE : PETSC_FALSE;
}

/*
   HDF5 under the name of another kind of file would be taken for that kind. XDMF names datasets as FILE:PATH inside
   XML.
*/
static PetscErrorCode CheckOutput(const MpmSettings *settings, MpmRequest *request)
{
  const char *const path  = request->output;
  const char *const slash = strrchr(path, '/'), *const ending = strrchr(slash ? slash : path, '.');
  const int length = (int)(ending ? (size_t)(ending - path) : strlen(path));

  PetscFunctionBegin;
  if (!path[0]) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(ending && !MpmFileHasEnding(path, MpmOptions[MpmOptionIndex("output")].endings), settings,
                      "output", "it is HDF5; allowed: a name that ends in .h5 or .hdf5, or has no ending");
  if (strcmp(request->task, "run")) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(strpbrk(path, "<>&\":"), settings, "output", "allowed: a name without < > & : and quotes");
  (void)snprintf(request->xmf, sizeof request->xmf, "%.*s.xmf", length, path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- no file is overwritten that is read, or that is written already ---- */

/* Whether a word of a text is the same file. */
static PetscBool HasFile(const char text[], const char separators[], const char path[])
{
  char word[PETSC_MAX_PATH_LEN];

  for (size_t n; text && *text; text += n + strspn(text + n, separators)) {
    n = strcspn(text, separators);
    (void)snprintf(word, sizeof word, "%.*s", (int)n, text);
    if (n && n < sizeof word && MpmFileIsSame(word, path)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Says as what a file is read; "": it is not. */
static PetscErrorCode FindInput(const MpmSettings *settings, const char task[], const char path[], size_t room,
                                char role[])
{
  char      file[PETSC_MAX_PATH_LEN];
  PetscBool there = PETSC_TRUE;

  PetscFunctionBegin;
  role[0] = '\0';
  if (MpmFileIsSame(settings->scene, path)) (void)snprintf(role, room, "%s", "scene");
  for (PetscInt i = 0; MpmOptions[i].name; i++)
    if (IsUsed(settings, task, i, MPM_FILE_READ) && MpmFileIsSame(settings->text[i], path))
      (void)snprintf(role, room, "%s", MpmOptions[i].name);
  if (HasFile(MpmSettingsText(settings, "program"), BETWEEN_WORDS, path)) (void)snprintf(role, room, "%s", "program");
  if (HasFile(settings->files->text, "\n", path)) (void)snprintf(role, room, "%s", "path of a body");
  for (int i = 0; there; i++) {
    PetscCall(MpmSettingsPlaceFile(i, sizeof file, file, &there));
    if (there && MpmFileIsSame(file, path)) (void)snprintf(role, room, "%s", "file of options");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A run that goes on from a checkpoint may put the next one in its place. */
static PetscErrorCode CheckWritten(const MpmSettings *settings, const MpmRequest *request, PetscInt n,
                                   const char *const names[], const char *const paths[], char why[MESSAGE])
{
  char role[64];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n && !why[0]; i++) {
    for (PetscInt j = 0; j < i && !why[0]; j++)
      if (MpmFileIsSame(paths[j], paths[i]))
        (void)snprintf(why, MESSAGE, "%s and %s would both write %s; allowed: different files", names[j], names[i],
                       paths[j]);
    if (why[0]) break;
    PetscCall(FindInput(settings, request->task, paths[i], sizeof role, role));
    if (role[0] && (strcmp(role, "restart") || strcmp(names[i], "checkpoint")))
      (void)snprintf(why, MESSAGE, "-%s %s: that is the %s; allowed: another file", names[i], paths[i], role);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The first rank alone looks at the files, so that all ranks refuse the same. Nothing is written before all are known.
*/
PetscErrorCode MpmSettingsReadFiles(const MpmSettings *settings, MpmRequest *request)
{
  const char *const task = request->task;
  const char       *names[MPM_MAX_OPTIONS + 1], *paths[MPM_MAX_OPTIONS + 1];
  char              why[MESSAGE] = "";
  PetscInt          n            = 0;

  PetscFunctionBegin;
  PetscCall(CheckOutput(settings, request));
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    const char *endings = MpmOptions[i].endings;

    if (!IsUsed(settings, task, i, MPM_FILE_WRITTEN)) continue;
    /* the ending says in which format a matrix is written; blocks are arrays by name, which only some formats have */
    MpmSettingsRefuseIf(!strncmp(MpmOptions[i].name, "write_", 6) && !MpmFileHasEnding(settings->text[i], endings),
                        settings, MpmOptions[i].name, "allowed: a name that ends in %s", endings);
    names[n]   = MpmOptions[i].name;
    paths[n++] = settings->text[i];
    if (strcmp(MpmOptions[i].name, "output") || !request->xmf[0]) continue;
    names[n]   = "output";
    paths[n++] = request->xmf;
  }
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) PetscCall(CheckWritten(settings, request, n, names, paths, why));
  PetscCallMPI(MPI_Bcast(why, sizeof why, MPI_CHAR, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!why[0], "%s", why);
  for (PetscInt i = 0; i < n; i++) PetscCall(MpmFileCheck(names[i], paths[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what a scene may do ---- */

PetscErrorCode MpmSettingsCheckTrust(const MpmSettings *settings)
{
  static const char *const run[] = {"program", "plugin"};

  PetscBool         trusted;
  int               here = 1;
  const PetscMPIInt rank = MpmRankOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  for (PetscInt i = 0; MpmOptions[i].name; i++)
    MpmSettingsRefuseIf(MpmOptions[i].no_key && settings->source[i] != MPM_FROM_DEFAULT &&
                            settings->source[i] != MPM_FROM_COMMAND_LINE,
                        settings, MpmOptions[i].name, "allowed: on the command line only");
  PetscCall(MpmSettingsSwitch(settings, "trust_scene", &trusted));
  if (trusted) PetscFunctionReturn(PETSC_SUCCESS);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(run); i++)
    MpmSettingsRefuseIf(MpmSettingsSource(settings, run[i]) == MPM_FROM_SCENE, settings, run[i],
                        "a scene that is read runs nothing; allowed: on the command line, or with "
                        "-trust_scene if you trust who wrote the scene");
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    const MpmField *o = &MpmOptions[i];

    if (o->file != MPM_FILE_WRITTEN || settings->source[i] != MPM_FROM_SCENE) continue;
    if (rank == 0) here = MpmFileIsHere(settings->text[i]) && MpmFileHasEnding(settings->text[i], o->endings);
    PetscCallMPI(MPI_Bcast(&here, 1, MPI_INT, 0, PETSC_COMM_WORLD));
    MpmSettingsRefuseIf(!here, settings, o->name,
                        "a scene may write to the current folder and below it; allowed: a name there that ends in "
                        "%s and is not hidden; any on the command line, or with -trust_scene",
                        o->endings);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
