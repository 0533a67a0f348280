/*
   Names of files. They are refused before any work is done when they cannot be written, or would overwrite one
   another.
*/
#include "base/textfile.h"
#include "scene/settings.h"
#include "scene/request.h"
#include <string.h>
#include <sys/stat.h>

#define LONGEST 1024 /* characters, so that a message of PETSc's length can name it and the remedy */

static PetscErrorCode ReadPath(const MpmSettings *settings, const char name[], PetscBool written, char path[])
{
  const char *text;

  PetscFunctionBegin;
  PetscCall(MpmSettingsPath(settings, name, &text));
  if (!text) PetscFunctionReturn(PETSC_SUCCESS);
  if (strlen(text) >= LONGEST) PetscCall(MpmSettingsRefuse(settings, name, "allowed: a shorter name"));
  PetscCall(PetscStrncpy(path, text, LONGEST));
  if (written) PetscCall(MpmFileCheck(name, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the ending of a file's name begins, with its point; NULL: it has none. */
static const char *Ending(const char path[])
{
  const char *slash = strrchr(path, '/');

  return strrchr(slash ? slash : path, '.');
}

/* HDF5 under the name of another kind of file would be taken for that kind. */
static PetscErrorCode ReadOutput(const MpmSettings *settings, char path[])
{
  const char *text, *ending;

  PetscFunctionBegin;
  PetscCall(MpmSettingsPath(settings, "output", &text));
  if (!text) PetscFunctionReturn(PETSC_SUCCESS);
  ending = Ending(text);
  if (ending && strcmp(ending, ".h5") && strcmp(ending, ".hdf5"))
    PetscCall(MpmSettingsRefuse(settings, "output",
                                "it is HDF5; allowed: a name that ends in .h5 or .hdf5, or has no ending"));
  PetscCall(ReadPath(settings, "output", PETSC_TRUE, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* XDMF names its datasets as FILE:PATH inside XML. */
static PetscErrorCode NameXmf(const MpmSettings *settings, MpmRequest *request)
{
  const char *ending = Ending(request->output);
  const int   length = (int)(ending ? (size_t)(ending - request->output) : strlen(request->output));

  PetscFunctionBegin;
  if (strpbrk(request->output, "<>&\":"))
    PetscCall(MpmSettingsRefuse(settings, "output", "allowed: a name without < > & : and quotes"));
  PetscCall(PetscSNPrintf(request->xmf, sizeof request->xmf, "%.*s.xmf", length, request->output));
  PetscCall(MpmFileCheck("output", request->xmf));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether two names are of one file: the same in the same folder, however that is spelt. */
static PetscBool IsSameName(const char a[], const char b[])
{
  const char *const paths[2] = {a, b};
  const char       *names[2];
  struct stat       folder[2];

  for (int i = 0; i < 2; i++) {
    const char *slash = strrchr(paths[i], '/');
    char        text[PETSC_MAX_PATH_LEN];

    names[i] = slash ? slash + 1 : paths[i];
    (void)snprintf(text, sizeof text, "%.*s.", (int)(names[i] - paths[i]), paths[i]);
    if (stat(text, &folder[i])) return PETSC_FALSE;
  }
  return !strcmp(names[0], names[1]) && folder[0].st_ino == folder[1].st_ino && folder[0].st_dev == folder[1].st_dev
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* Whether a file that would be written is one that is read, under this name or another. */
static PetscBool IsInput(const char written[], const char read[])
{
  struct stat a, b;

  return written[0] && read[0] && !stat(written, &a) && !stat(read, &b) && a.st_ino == b.st_ino && a.st_dev == b.st_dev
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* The ending says in which format a matrix is written; blocks are arrays by name, which only some formats have. */
static PetscErrorCode ReadWritten(const MpmSettings *settings, const char name[], PetscBool blocks, char path[])
{
  static const char *const endings[] = {".npz", ".h5", ".hdf5", ".mtx", ".petsc"};
  const char              *text, *ending;
  PetscBool                known = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MpmSettingsPath(settings, name, &text));
  if (!text) PetscFunctionReturn(PETSC_SUCCESS);
  ending = Ending(text);
  for (int i = 0; i < (blocks ? 3 : 5) && ending; i++)
    if (!strcmp(ending, endings[i])) known = PETSC_TRUE;
  if (!known)
    PetscCall(MpmSettingsRefuse(settings, name,
                                blocks ? "allowed: a name that ends in .npz, .h5 or .hdf5"
                                       : "allowed: a name that ends in .mtx, .npz, .h5, .hdf5 or .petsc"));
  PetscCall(ReadPath(settings, name, PETSC_TRUE, path));
  PetscFunctionReturn(PETSC_SUCCESS);
}

enum { CHECKPOINT = 4, FILES = 7 }; /* of those written */
enum { RESTART = 2, INPUTS = 5 };   /* of those read */

/* The first rank alone looks at the files, so that all ranks refuse the same. */
PetscErrorCode MpmSettingsReadFiles(const MpmSettings *settings, MpmRequest *request)
{
  static const char *const names[] = {"output", "output", "json", "csv", "checkpoint", "write_matrix", "write_blocks"};
  static const char *const roles[] = {"scene", "mode_file", "checkpoint to restart from", "matrix", "matrix_blocks"};

  const char *const paths[]   = {request->output,     request->xmf,          request->json,        request->csv,
                                 request->checkpoint, request->write_matrix, request->write_blocks};
  const char *const inputs[]  = {settings->scene, request->mode_file, request->restart, request->matrix,
                                 request->matrix_blocks};
  char              why[4096] = "";
  PetscMPIInt       rank;

  PetscFunctionBegin;
  PetscCall(ReadOutput(settings, request->output));
  PetscCall(ReadPath(settings, "json", PETSC_TRUE, request->json));
  PetscCall(ReadPath(settings, "csv", PETSC_TRUE, request->csv));
  if (!strcmp(request->task, "run")) {
    PetscCall(ReadPath(settings, "checkpoint", PETSC_TRUE, request->checkpoint));
    PetscCall(ReadPath(settings, "restart", PETSC_FALSE, request->restart));
  }
  if (!strcmp(request->task, "spectrum")) {
    PetscCall(ReadPath(settings, "matrix", PETSC_FALSE, request->matrix));
    PetscCall(ReadWritten(settings, "write_matrix", PETSC_FALSE, request->write_matrix));
  }
  if (!strcmp(request->task, "symbol")) {
    PetscCall(ReadPath(settings, "matrix_blocks", PETSC_FALSE, request->matrix_blocks));
    PetscCall(ReadWritten(settings, "write_blocks", PETSC_TRUE, request->write_blocks));
  }
  if (request->output[0] && !strcmp(request->task, "run")) PetscCall(NameXmf(settings, request));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  for (int i = 0; i < FILES && rank == 0; i++) {
    for (int j = 0; j < i && !why[0]; j++) {
      if (paths[i][0] && paths[j][0] && IsSameName(paths[j], paths[i]))
        PetscCall(PetscSNPrintf(why, sizeof why, "%s and %s would both write %s; allowed: different files", names[j],
                                names[i], paths[j]));
    }
    for (int j = 0; j < INPUTS && !why[0]; j++) {
      if (i == CHECKPOINT && j == RESTART) continue; /* the next one may take its place */
      if (IsInput(paths[i], inputs[j]))
        PetscCall(PetscSNPrintf(why, sizeof why, "-%s %s: that is the %s; allowed: another file", names[i], paths[i],
                                roles[j]));
    }
  }
  PetscCallMPI(MPI_Bcast(why, sizeof why, MPI_CHAR, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!why[0], "%s", why);
  PetscFunctionReturn(PETSC_SUCCESS);
}
