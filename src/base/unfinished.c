/* The files that have not got their names yet. */
#include "base/unfinished.h"
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define MOST 8
#define COMMUNICATORS 16 /* of Open MPI's that may have a file open */

static char     parts[MOST][PETSC_MAX_PATH_LEN];
static PetscInt last;

void MpmUnfinishedAdd(const char part[])
{
  for (PetscInt i = 0; i < MOST; i++) {
    if (parts[i][0]) continue;
    (void)PetscStrncpy(parts[i], part, sizeof parts[i]);
    last = i;
    return;
  }
}

void MpmUnfinishedDone(const char part[])
{
  for (PetscInt i = 0; i < MOST; i++)
    if (!strcmp(parts[i], part)) parts[i][0] = '\0';
}

/* What Open MPI has beside a file that one process keeps open (sharedfp lockedfile), named by communicator and process. */
static void RemoveLock(const char part[])
{
  char lock[PETSC_MAX_PATH_LEN];

  for (int communicator = 0; communicator < COMMUNICATORS; communicator++)
    if (snprintf(lock, sizeof lock, "%s-%d-%ld.lock", part, communicator, (long)getpid()) < (int)sizeof lock)
      (void)unlink(lock);
}

PetscBool MpmUnfinishedRemove(void)
{
  PetscBool was_there = PETSC_FALSE;

  for (PetscInt i = 0; i < MOST; i++) {
    if (!parts[i][0]) continue;
    if (!unlink(parts[i]) && i == last) was_there = PETSC_TRUE;
    RemoveLock(parts[i]);
    parts[i][0] = '\0';
  }
  return was_there;
}
