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

/*
   The name of the XDMF file beside an output. XDMF names datasets as FILE:PATH inside XML, so some characters are out.
*/
static PetscErrorCode NameXmf(const MpmSettings *settings, MpmRequest *request)
{
  size_t length = strlen(request->output);

  PetscFunctionBegin;
  if (strpbrk(request->output, "<>&\":"))
    PetscCall(MpmSettingsRefuse(settings, "output", "allowed: a name without < > & : and quotes"));
  if (length > 3 && !strcmp(request->output + length - 3, ".h5")) length -= 3;
  PetscCall(PetscSNPrintf(request->xmf, sizeof request->xmf, "%.*s.xmf", (int)length, request->output));
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

/*
   The file that both of two would write, under its own name or under the one that it has until it is whole; "": none.
*/
static PetscErrorCode FindShared(const char a[], const char b[], char shared[], size_t room)
{
  char part[2][PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  shared[0] = '\0';
  if (!a[0] || !b[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(part[0], sizeof part[0], "%s.part", a));
  PetscCall(PetscSNPrintf(part[1], sizeof part[1], "%s.part", b));
  if (IsSameName(a, b) || IsSameName(a, part[1]))
    PetscCall(PetscStrncpy(shared, a, room));
  else if (IsSameName(part[0], b))
    PetscCall(PetscStrncpy(shared, b, room));
  PetscFunctionReturn(PETSC_SUCCESS);
}

enum { CHECKPOINT = 4, FILES = 5 }; /* of those written */
enum { RESTART = 2 };               /* of those read */

/* The first rank alone looks at the files, so that all ranks refuse the same. */
PetscErrorCode MpmSettingsReadFiles(const MpmSettings *settings, MpmRequest *request)
{
  static const char *const names[] = {"output", "output", "json", "csv", "checkpoint"};
  static const char *const roles[] = {"scene", "mode_file", "checkpoint to restart from"};

  const char *const paths[]   = {request->output, request->xmf, request->json, request->csv, request->checkpoint};
  const char *const inputs[]  = {settings->scene, request->mode_file, request->restart};
  char              why[4096] = "", shared[PETSC_MAX_PATH_LEN];
  PetscMPIInt       rank;

  PetscFunctionBegin;
  PetscCall(ReadPath(settings, "output", PETSC_TRUE, request->output));
  PetscCall(ReadPath(settings, "json", PETSC_TRUE, request->json));
  PetscCall(ReadPath(settings, "csv", PETSC_TRUE, request->csv));
  if (!strcmp(request->task, "run")) {
    PetscCall(ReadPath(settings, "checkpoint", PETSC_TRUE, request->checkpoint));
    PetscCall(ReadPath(settings, "restart", PETSC_FALSE, request->restart));
  }
  if (request->output[0] && !strcmp(request->task, "run")) PetscCall(NameXmf(settings, request));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  for (int i = 0; i < FILES && rank == 0; i++) {
    for (int j = 0; j < i && !why[0]; j++) {
      PetscCall(FindShared(paths[j], paths[i], shared, sizeof shared));
      if (shared[0])
        PetscCall(PetscSNPrintf(why, sizeof why, "%s and %s would both write %s; allowed: different files", names[j],
                                names[i], shared));
    }
    for (int j = 0; j < 3 && !why[0]; j++) {
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
