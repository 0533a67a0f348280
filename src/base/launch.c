/* Prepares the process before MPI and PETSc start. */
#define _DEFAULT_SOURCE /* MAP_ANONYMOUS */
#include "base/launch.h"
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#define LARGEST 1048576       /* bytes of a file of options */
#define START_BYTES 209715200 /* bytes: Open MPI maps up to 180 MB when it starts */

void MpmLaunchAlone(void)
{
  static const char *const launchers[] = {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"};

  for (unsigned i = 0; i < sizeof launchers / sizeof launchers[0]; i++)
    if (getenv(launchers[i])) return;
  (void)setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
  (void)setenv("OMPI_MCA_pml", "ob1", 0);
  /* All such processes would share one session folder, and the first one that ends would remove it under the others. */
  (void)setenv("OMPI_MCA_orte_create_session_dirs", "0", 0);
  /* hwloc would look for devices. In a virtual machine each takes a millisecond, and gl asks for the displays of X. */
  (void)setenv("HWLOC_COMPONENTS", "-linuxio,-pci,-gl,-opencl", 0);
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

/* A launcher ends the other ranks when the first rank ends. */
void MpmLaunchRefuse(const char what[], const char why[])
{
  if (IsFirst())
    fprintf(stderr, "mpmstab: %s: %s\n", what, why);
  else
    (void)sleep(1);
}

int MpmLaunchGrants(size_t bytes)
{
  void *space = mmap(NULL, bytes, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);

  return space != MAP_FAILED && !munmap(space, bytes);
}

int MpmLaunchMemory(void)
{
  if (MpmLaunchGrants(START_BYTES)) return 1;
  MpmLaunchRefuse("memory", "the shell grants too little to start with (ulimit -v); allowed: 0.4 GB more");
  return 0;
}

int MpmLaunchOptionFile(int i, size_t room, char name[])
{
  static const char *const here[] = {"petscrc", ".petscrc"};
  const char *const        home   = getenv("HOME");

  if (i > 2 || (i == 2 && !home)) return 0;
  (void)snprintf(name, room, "%s%s", i < 2 ? here[i] : home, i < 2 ? "" : "/.petscrc");
  return 1;
}

/*
   Returns whether PETSc can read a file of options without waiting, and whole. PETSc says itself which file is not
   there.
*/
static int CanBeRead(const char name[], const char instead[])
{
  char        why[160];
  struct stat is;

  if (stat(name, &is) || (S_ISREG(is.st_mode) && is.st_size <= LARGEST)) return 1;
  (void)snprintf(why, sizeof why, "PETSc looks for options there, and it is %s; allowed: a text file%s",
                 S_ISREG(is.st_mode) ? "larger than 1 MiB" : "not a regular file", instead);
  MpmLaunchRefuse(name, why);
  return 0;
}

int MpmLaunchOptionFiles(int argc, char **argv)
{
  char name[4096];
  int  skip = 0;

  for (int i = 1; i < argc; i++) {
    if (!strcmp(argv[i], "-skip_petscrc")) skip = 1;
    if (i + 1 < argc && !strcmp(argv[i], "-options_file") && !CanBeRead(argv[i + 1], "")) return 0;
  }
  for (int i = 0; !skip && MpmLaunchOptionFile(i, sizeof name, name); i++)
    if (!CanBeRead(name, ", or -skip_petscrc")) return 0;
  return 1;
}
