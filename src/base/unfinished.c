/* Temporary names, and the list of files that this process has not finished. */
#include "base/unfinished.h"
#include "base/hash.h"
#include <ctype.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

#define MOST 8       /* files that are unfinished at the same time */
#define MOST_HOST 32 /* characters of the host's name; the name of a file has at most 255 */
#define MOST_NAMES 8 /* random names to try */

static struct {
  char part[PETSC_MAX_PATH_LEN];
  int  descriptor;
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

/* The name is registered before the file is made, so that a signal in between leaves no file. */
int MpmUnfinishedCreate(const char path[], char part[PETSC_MAX_PATH_LEN])
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

int MpmUnfinishedDescriptor(const char part[])
{
  const int i = Find(part);

  return i < 0 ? -1 : files[i].descriptor;
}

static void Forget(int i)
{
  files[i].part[0] = '\0';
  (void)close(files[i].descriptor);
}

int MpmUnfinishedFinish(const char part[], const char path[])
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

void MpmUnfinishedClear(const char path[])
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
