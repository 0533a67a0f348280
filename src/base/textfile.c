/*
   Files: which one a name means; temporary names, and the list of files that this process has not finished; text files,
   which are written under such a name, checked, and renamed. MpmFileCreate and MpmFileFinish serve any file that the
   first rank writes.
*/
#include "base/hash.h"
#include "base/textfile.h"
#include <mpmstab/errors.h>
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

/* Splits a path into its folder, which ends with "/.", and returns the name in it. */
static const char *SplitPath(const char path[], char folder[PETSC_MAX_PATH_LEN])
{
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;

  (void)snprintf(folder, PETSC_MAX_PATH_LEN, "%.*s.", (int)(name - path), path);
  return name;
}

static PetscBool IsSameInode(const char a[], const char b[])
{
  struct stat of_a, of_b;

  return !stat(a, &of_a) && !stat(b, &of_b) && of_a.st_ino == of_b.st_ino && of_a.st_dev == of_b.st_dev ? PETSC_TRUE
                                                                                                        : PETSC_FALSE;
}

PetscBool MpmFileIsSame(const char a[], const char b[])
{
  char        folder_a[PETSC_MAX_PATH_LEN], folder_b[PETSC_MAX_PATH_LEN];
  const char *name_a = SplitPath(a, folder_a), *name_b = SplitPath(b, folder_b);

  if (!a[0] || !b[0]) return PETSC_FALSE;
  if (IsSameInode(a, b)) return PETSC_TRUE;
  return !strcmp(name_a, name_b) && IsSameInode(folder_a, folder_b) ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmFileIsHere(const char path[])
{
  char        folder[PETSC_MAX_PATH_LEN], place[PATH_MAX], here[PATH_MAX];
  const char *name = SplitPath(path, folder);
  size_t      length;

  if (name[0] == '.' || !realpath(folder, place) || !realpath(".", here)) return PETSC_FALSE;
  length = strcmp(here, "/") ? strlen(here) : 0;
  if (strncmp(place, here, length) || (place[length] && place[length] != '/')) return PETSC_FALSE;
  return strstr(place + length, "/.") ? PETSC_FALSE : PETSC_TRUE;
}

PetscBool MpmFileHasEnding(const char path[], const char endings[])
{
  const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path;

  for (endings = strchr(endings, '.'); endings; endings = strchr(endings + 1, '.')) {
    const size_t n = strcspn(endings, ", "), m = strlen(name);

    if (m > n && !strncmp(name + m - n, endings, n)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

#define MOST 8       /* files that are unfinished at the same time */
#define MOST_HOST 32 /* characters of the host's name; the name of a file has at most 255 */
#define MOST_NAMES 8 /* random names to try */

/* stream: of a text file that is open, else NULL. */
static struct {
  char  part[PETSC_MAX_PATH_LEN];
  int   descriptor;
  FILE *stream;
} files[MOST];

/* Writes the host's name in characters that are safe in the name of a file. */
static void NameHost(char host[MOST_HOST + 1])
{
  char name[256] = "";

  if (gethostname(name, sizeof name - 1) || !name[0]) (void)snprintf(name, sizeof name, "unknown");
  (void)snprintf(host, MOST_HOST + 1, "%.*s", MOST_HOST, name);
  for (char *c = host; *c; c++)
    if (!isalnum((unsigned char)*c)) *c = '_';
}

static unsigned Random(void)
{
  static uint64_t calls;
  struct timespec now = {0, 0};

  (void)clock_gettime(CLOCK_REALTIME, &now);
  return (unsigned)MpmHashMix((uint64_t)now.tv_nsec + ((uint64_t)now.tv_sec << 30) + ((uint64_t)getpid() << 40) +
                              ++calls * MPM_HASH_INCREMENT);
}

/*
   Creates an empty file under a new temporary name beside path. Returns an errno. The name is registered before the
   file is made, so that a signal in between leaves no file.
*/
static int CreatePart(const char path[], char part[PETSC_MAX_PATH_LEN])
{
  char host[MOST_HOST + 1];
  int  i = 0, file = -1;

  while (i < MOST && files[i].part[0]) i++;
  if (i == MOST) return EMFILE;
  NameHost(host);
  for (int tries = 0; file < 0 && tries < MOST_NAMES; tries++) {
    const int length = snprintf(part, PETSC_MAX_PATH_LEN, "%s.%s-%ld-%08x.part", path, host, (long)getpid(), Random());

    if (length >= PETSC_MAX_PATH_LEN) return ENAMETOOLONG;
    (void)PetscStrncpy(files[i].part, part, sizeof files[i].part);
    file = open(part, O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
    if (file < 0) {
      files[i].part[0] = '\0';
      if (errno != EEXIST) return errno;
    }
  }
  if (file < 0) return EEXIST;
  (void)flock(file, LOCK_EX | LOCK_NB); /* without locks, only the process id tells whether the owner lives */
  files[i].descriptor = file;
  return 0;
}

static int Find(const char part[])
{
  for (int i = 0; i < MOST; i++)
    if (files[i].part[0] && !strcmp(files[i].part, part)) return i;
  return -1;
}

static void Forget(int i)
{
  files[i].part[0] = '\0';
  (void)close(files[i].descriptor);
}

/* Gives a whole file its own name, or removes it where that fails. Returns an errno. */
static int FinishPart(const char part[], const char path[])
{
  const int i     = Find(part);
  int       error = 0;

  if (i < 0) return ENOENT;
  if (rename(part, path)) error = errno;
  if (error) (void)unlink(part);
  Forget(i);
  return error;
}

void MpmUnfinishedDrop(const char part[])
{
  const int i = Find(part);

  if (i < 0) return;
  (void)unlink(part);
  Forget(i);
}

void MpmUnfinishedRemove(void)
{
  for (int i = 0; i < MOST; i++) {
    if (!files[i].part[0]) continue;
    (void)unlink(files[i].part);
    files[i].part[0] = '\0';
  }
}

/* A process that has ended is still listed (as a zombie) until its parent asks for its status. */
static PetscBool IsZombie(long process)
{
  char  path[64], state = '?';
  FILE *file;

  (void)snprintf(path, sizeof path, "/proc/%ld/stat", process);
  file = fopen(path, "r");
  if (!file) return PETSC_FALSE;
  if (fscanf(file, "%*d (%*[^)]) %c", &state) != 1) state = '?';
  (void)fclose(file);
  return state == 'Z' || state == 'X' ? PETSC_TRUE : PETSC_FALSE;
}

/* Returns whether a temporary name belongs to a process of this host that has died. */
static PetscBool IsDead(const char name[], const char before[])
{
  const size_t length = strlen(before);
  int          end    = 0;
  long         process;
  unsigned     random;

  if (strncmp(name, before, length)) return PETSC_FALSE;
  if (sscanf(name + length, "%ld-%8x.part%n", &process, &random, &end) != 2 || !end || name[length + (size_t)end])
    return PETSC_FALSE;
  if (process <= 0) return PETSC_FALSE;
  return (kill((pid_t)process, 0) && errno == ESRCH) || IsZombie(process) ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Removes a file unless somebody holds its lock. A process id that is dead here may belong to a living process in
   another container that shares the folder; that process holds the lock.
*/
static void RemoveUnlocked(const char part[])
{
  const int file = open(part, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);

  if (file < 0) return;
  if (!flock(file, LOCK_EX | LOCK_NB)) (void)unlink(part);
  (void)close(file);
}

/*
   Removes the unfinished files that dead processes of this host have left beside path. It keeps a file of another host,
   of a process that runs, or one that is locked.
*/
static void ClearParts(const char path[])
{
  const char          *slash  = strrchr(path, '/');
  const size_t         folder = slash ? (size_t)(slash - path) + 1 : 0;
  char                 host[MOST_HOST + 1], before[PETSC_MAX_PATH_LEN], part[2 * PETSC_MAX_PATH_LEN];
  DIR                 *entries;
  const struct dirent *entry;

  NameHost(host);
  if (snprintf(before, sizeof before, "%s.%s-", path + folder, host) >= (int)sizeof before) return;
  (void)snprintf(part, sizeof part, "%.*s.", (int)folder, path);
  entries = opendir(part);
  if (!entries) return;
  while ((entry = readdir(entries)) != NULL) {
    if (!IsDead(entry->d_name, before)) continue;
    (void)snprintf(part, sizeof part, "%.*s%s", (int)folder, path, entry->d_name);
    RemoveUnlocked(part);
  }
  (void)closedir(entries);
}

#define NOT_A_FILE -1 /* a value that errno never has */

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
    else if (!(error = CreatePart(path, part))) {
      MpmUnfinishedDrop(part);
      ClearParts(path);
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
  if (MpmRankOf(comm) == 0) *error = CreatePart(path, part);
  PetscCall(ShareErrno(comm, error));
  PetscCallMPI(MPI_Bcast(part, PETSC_MAX_PATH_LEN, MPI_CHAR, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFileFinish(MPI_Comm comm, const char path[], const char part[], int *error)
{
  PetscFunctionBegin;
  *error = 0;
  if (MpmRankOf(comm) == 0) *error = FinishPart(part, path);
  PetscCall(ShareErrno(comm, error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Closes the stream of an unfinished file. Returns an errno. */
static int CloseStream(int i)
{
  FILE *stream = files[i].stream;

  files[i].stream = NULL;
  return fclose(stream) ? errno : 0;
}

static int OpenStream(MpmTextFile *file)
{
  const int i = Find(file->part), own = dup(files[i].descriptor);

  if (own < 0) return errno;
  file->stream = files[i].stream = fdopen(own, "w+");
  return file->stream ? 0 : errno;
}

void MpmTextFileAbandon(void)
{
  for (int i = 0; i < MOST; i++)
    if (files[i].stream) (void)CloseStream(i);
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
  (void)CloseStream(Find(file->part));
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
      (void)CloseStream(Find(file->part));
    else
      error = CloseStream(Find(file->part));
    file->stream = NULL;
    if (error)
      MpmUnfinishedDrop(file->part);
    else
      error = FinishPart(file->part, file->path);
  }
  PetscCall(ShareErrno(PETSC_COMM_WORLD, &error));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}
