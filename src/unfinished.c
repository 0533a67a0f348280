/* The files that have not got their names yet. */
#include <mpmstab/unfinished.h>
#include <string.h>
#include <unistd.h>

#define MOST 8

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

PetscBool MpmUnfinishedRemove(void)
{
  PetscBool was_there = PETSC_FALSE;

  for (PetscInt i = 0; i < MOST; i++) {
    if (!parts[i][0]) continue;
    if (!unlink(parts[i]) && i == last) was_there = PETSC_TRUE;
    parts[i][0] = '\0';
  }
  return was_there;
}
