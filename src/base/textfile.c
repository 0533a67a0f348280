/* Files that appear whole or not at all: written aside, checked, renamed. */
#include <mpmstab/errors.h>
#include "base/textfile.h"
#include "base/unfinished.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define NOT_A_FILE -1 /* beside errno's */

static const char *Reason(int error)
{
  return error == NOT_A_FILE ? "not a regular file" : strerror(error);
}

/* Rank 0's errno on all ranks, so that they refuse together. */
static PetscErrorCode ShareErrno(int *error)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(error, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsFirst(void)
{
  PetscMPIInt rank = 0;

  (void)MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  return rank == 0 ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmFileCheck(const char name[], const char path[])
{
  char part[PETSC_MAX_PATH_LEN];
  int  error = 0;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(part, sizeof part, "%s.part", path));
  if (IsFirst()) {
    struct stat is;
    FILE       *file = NULL;

    /* the finished file takes the place of what has its name: no device's, and no link's whose target would stay */
    if (!lstat(path, &is) && !S_ISREG(is.st_mode))
      error = S_ISDIR(is.st_mode) ? EISDIR : NOT_A_FILE;
    else if (!(file = fopen(part, "ab")))
      error = errno;
    else {
      fclose(file);
      if (unlink(part)) error = errno;
    }
  }
  PetscCall(ShareErrno(&error));
  MpmCheckInput(!error, "-%s %s: %s; allowed: a file in a folder that can be written", name, path, Reason(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFileReserve(MPI_Comm comm, const char what[], const char part[], PetscInt64 bytes)
{
  PetscMPIInt rank;
  int         error = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (rank == 0) {
    const int file = open(part, O_CREAT | O_WRONLY | O_TRUNC, 0666);

    error = file < 0 ? errno : posix_fallocate(file, 0, (off_t)bytes);
    if (file >= 0) (void)close(file);
    (void)unlink(part);
  }
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, comm));
  MpmCheckInput(!error, "%s: cannot be written: %s; it needs a folder that is there and %.3g MB of room", what,
                strerror(error), 1e-6 * (PetscReal)bytes);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTextFileOpen(const char path[], MpmTextFile *file)
{
  int error = 0;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(file->path, path, sizeof file->path));
  PetscCall(PetscSNPrintf(file->part, sizeof file->part, "%s.part", path));
  file->stream = NULL;
  MpmUnfinishedAdd(file->part);
  if (IsFirst()) {
    file->stream = fopen(file->part, "w");
    if (!file->stream) error = errno;
  }
  PetscCall(ShareErrno(&error));
  MpmCheckInput(!error, "%s: cannot be written: %s", path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmTextFileCell(const MpmTextFile *file, PetscReal value)
{
  if (isfinite(value))
    fprintf(file->stream, ",%.17g", value);
  else
    fprintf(file->stream, ",");
}

/* On the rank that writes; returns an errno. */
static int ReadBack(const MpmTextFile *file, char **text)
{
  const long end   = fflush(file->stream) ? -1 : ftell(file->stream);
  FILE      *again = end < 0 ? NULL : fopen(file->part, "r");
  int        error = again ? 0 : errno;

  if (again && PetscCalloc1((size_t)end + 1, text)) error = ENOMEM;
  if (!error && fread(*text, 1, (size_t)end, again) < (size_t)end) error = EIO;
  if (again) fclose(again);
  return error;
}

PetscErrorCode MpmTextFileSoFar(const MpmTextFile *file, char **text)
{
  int error = 0;

  PetscFunctionBegin;
  *text = NULL;
  if (file->stream) error = ReadBack(file, text);
  PetscCall(ShareErrno(&error));
  MpmCheckInput(!error, "%s: cannot be read back: %s", file->part, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmTextFileDrop(MpmTextFile *file)
{
  if (!file->stream) return;
  fclose(file->stream);
  (void)unlink(file->part);
  MpmUnfinishedDone(file->part);
}

PetscErrorCode MpmTextFileClose(MpmTextFile *file)
{
  int error = 0;

  PetscFunctionBegin;
  if (file->stream) {
    if (fflush(file->stream) || ferror(file->stream)) error = errno ? errno : EIO;
    if (fclose(file->stream) && !error) error = errno;
    if (!error && rename(file->part, file->path)) error = errno;
    if (error) (void)unlink(file->part);
  }
  MpmUnfinishedDone(file->part);
  PetscCall(ShareErrno(&error));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}
