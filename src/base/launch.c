/* Prepares the process before MPI and PETSc start. */
#include "base/launch.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

void MpmLaunchAlone(void)
{
  static const char *const launchers[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};

  for (unsigned i = 0; i < sizeof launchers / sizeof launchers[0]; i++)
    if (getenv(launchers[i])) return;
  (void)setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  (void)setenv("OMPI_MCA_pml", "ob1", 0);
  /* All such processes would share one session folder, and the first one that ends would remove it under the others. */
  (void)setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
}

void MpmLaunchStandardFiles(void)
{
  for (int file = 0; file < 3; file++)
    if (fcntl(file, F_GETFD) < 0 && errno == EBADF) (void)open("/dev/null", O_RDONLY); /* gets the lowest number */
}

static int IsFirst(void)
{
  static const char *const ranks[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"};

  for (unsigned i = 0; i < sizeof ranks / sizeof ranks[0]; i++)
    if (getenv(ranks[i])) return !strcmp(getenv(ranks[i]), "0");
  return 1;
}

int MpmLaunchOptionFiles(int argc, char **argv)
{
  const char *home           = getenv("HOME");
  char        names[3][4096] = {"", ".petscrc", "petscrc"};

  for (int i = 1; i < argc; i++)
    if (!strcmp(argv[i], "-skip_petscrc")) return 1;
  if (home) (void)snprintf(names[0], sizeof names[0], "%s/.petscrc", home);
  for (int i = 0; i < 3; i++) {
    struct stat is;

    if (!names[i][0] || stat(names[i], &is) || S_ISREG(is.st_mode)) continue;
    if (IsFirst())
      fprintf(stderr,
              "mpmstab: %s: PETSc looks for options there, and it is not a regular file; allowed: a text file, "
              "or -skip_petscrc\n",
              names[i]);
    if (!IsFirst()) (void)sleep(1); /* a launcher ends the other ranks when the first rank ends */
    return 0;
  }
  return 1;
}
