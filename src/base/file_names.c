/* Which file a name means. */
#include "base/file_names.h"
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Splits a path into its folder, which ends with "/.", and returns the name in it. */
static const char *Split(const char path[], char folder[PETSC_MAX_PATH_LEN])
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
  const char *name_a = Split(a, folder_a), *name_b = Split(b, folder_b);

  if (!a[0] || !b[0]) return PETSC_FALSE;
  if (IsSameInode(a, b)) return PETSC_TRUE;
  return !strcmp(name_a, name_b) && IsSameInode(folder_a, folder_b) ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmFileIsHere(const char path[])
{
  char        folder[PETSC_MAX_PATH_LEN], place[PATH_MAX], here[PATH_MAX];
  const char *name = Split(path, folder);
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
