/*
   Text files: they are written under a temporary name, checked, and renamed. MpmFileCreate and MpmFileFinish serve any
   file that the first rank writes.
*/
#include <mpmstab/errors.h>
#include "base/textfile.h"
#include "base/unfinished.h"
#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define NOT_A_FILE -1 /* a value that errno never has */
#define MOST 8        /* text files that are open at the same time */

static FILE *streams[MOST]; /* those that are open, on the first rank */

const char *MpmFileReason(int error)
{
  return error == NOT_A_FILE ? "not a regular file" : strerror(error);
}

/* To open a pipe without O_NONBLOCK would wait for its writer, and a device may have no end. */
FILE *MpmFileOpen(const char path[], int *error)
{
  const int   file   = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  FILE       *stream = NULL;
  struct stat is;

  *error = 0;
  if (file < 0 || fstat(file, &is))
    *error = errno;
  else if (!S_ISREG(is.st_mode))
    *error = S_ISDIR(is.st_mode) ? EISDIR : NOT_A_FILE;
  else if (!(stream = fdopen(file, "rb")))
    *error = errno;
  if (!stream && file >= 0) (void)close(file);
  return stream;
}

/* Gives all ranks the first rank's errno, so that they refuse together. */
static PetscErrorCode ShareErrno(MPI_Comm comm, int *error)
{
  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(error, 1, MPI_INT, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsFirst(void)
{
  return MpmRankOf(PETSC_COMM_WORLD) == 0 ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmFileCheck(const char name[], const char path[])
{
  int error = 0;

  PetscFunctionBegin;
  if (IsFirst()) {
    char        part[PETSC_MAX_PATH_LEN];
    struct stat is;

    /*
       The finished file replaces what has its name. A device must not be replaced, nor a link, whose target would stay
       as it was.
    */
    if (!lstat(path, &is) && !S_ISREG(is.st_mode))
      error = S_ISDIR(is.st_mode) ? EISDIR : NOT_A_FILE;
    else if (!(error = MpmUnfinishedCreate(path, part))) {
      MpmUnfinishedDrop(part);
      MpmUnfinishedClear(path);
    }
  }
  PetscCall(ShareErrno(PETSC_COMM_WORLD, &error));
  MpmCheckInput(!error, "-%s %s: %s; allowed: a file in a folder that can be written", name, path,
                MpmFileReason(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFileCreate(MPI_Comm comm, const char path[], char part[PETSC_MAX_PATH_LEN], int *error)
{
  PetscFunctionBegin;
  part[0] = '\0';
  *error  = 0;
  if (MpmRankOf(comm) == 0) *error = MpmUnfinishedCreate(path, part);
  PetscCall(ShareErrno(comm, error));
  PetscCallMPI(MPI_Bcast(part, PETSC_MAX_PATH_LEN, MPI_CHAR, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFileFinish(MPI_Comm comm, const char path[], const char part[], int *error)
{
  PetscFunctionBegin;
  *error = 0;
  if (MpmRankOf(comm) == 0) *error = MpmUnfinishedFinish(part, path);
  PetscCall(ShareErrno(comm, error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Closes a stream. Returns an errno. */
static int CloseStream(FILE *stream)
{
  for (int i = 0; i < MOST; i++)
    if (streams[i] == stream) streams[i] = NULL;
  return fclose(stream) ? errno : 0;
}

static int OpenStream(MpmTextFile *file)
{
  int i = 0, own;

  while (i < MOST && streams[i]) i++;
  if (i == MOST) return EMFILE;
  own = dup(MpmUnfinishedDescriptor(file->part));
  if (own < 0) return errno;
  file->stream = streams[i] = fdopen(own, "w+");
  return file->stream ? 0 : errno;
}

void MpmTextFileAbandon(void)
{
  for (int i = 0; i < MOST; i++)
    if (streams[i]) (void)CloseStream(streams[i]);
}

PetscErrorCode MpmTextFileOpen(const char path[], MpmTextFile *file)
{
  int error;

  PetscFunctionBegin;
  (void)snprintf(file->path, sizeof file->path, "%s", path);
  PetscCall(MpmFileCreate(PETSC_COMM_WORLD, path, file->part, &error));
  file->stream = NULL;
  if (!error && IsFirst()) error = OpenStream(file);
  PetscCall(ShareErrno(PETSC_COMM_WORLD, &error));
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

/* Reads the text back from the open file itself, since the file may have been renamed or removed. Returns an errno. */
static int ReadBack(const MpmTextFile *file, char **text)
{
  const long end  = fflush(file->stream) ? -1 : ftell(file->stream);
  long       done = 0;

  if (end < 0) return errno;
  if (PetscCalloc1((size_t)end + 1, text)) return ENOMEM;
  while (done < end) {
    const ssize_t n = pread(fileno(file->stream), *text + done, (size_t)(end - done), done);

    if (n < 0 && errno != EINTR) return errno;
    if (n == 0) return EIO;
    if (n > 0) done += n;
  }
  return 0;
}

PetscErrorCode MpmTextFileSoFar(const MpmTextFile *file, char **text)
{
  int error = 0;

  PetscFunctionBegin;
  *text = NULL;
  if (file->stream) error = ReadBack(file, text);
  PetscCall(ShareErrno(PETSC_COMM_WORLD, &error));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmTextFileDrop(MpmTextFile *file)
{
  if (!file->stream) return;
  (void)CloseStream(file->stream);
  file->stream = NULL;
  MpmUnfinishedDrop(file->part);
}

PetscErrorCode MpmTextFileClose(MpmTextFile *file)
{
  int error = 0;

  PetscFunctionBegin;
  if (file->stream) {
    if (fflush(file->stream) || ferror(file->stream)) error = errno ? errno : EIO;
    if (error)
      (void)CloseStream(file->stream);
    else
      error = CloseStream(file->stream);
    file->stream = NULL;
    if (error)
      MpmUnfinishedDrop(file->part);
    else
      error = MpmUnfinishedFinish(file->part, file->path);
  }
  PetscCall(ShareErrno(PETSC_COMM_WORLD, &error));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}
