/* Compares the memory that a task needs with the memory that the machine has left. */
#include "base/launch.h"
#include "base/memory.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <stdio.h>
#include <sys/resource.h>
#include <unistd.h>

#define PLENTY 1e8 /* bytes: less is not worth asking the machine for */
#define GB 1073741824.0
#define LAPACK_BYTES 201326592 /* bytes: OpenBLAS asks for up to 128 MB at once */

/* Reads one number from a file of the system, in bytes; INFINITY when there is no such file or number. */
static PetscReal Number(const char path[], const char format[], PetscReal unit)
{
  FILE  *file = fopen(path, "r");
  char   line[256];
  double value = INFINITY;

  if (!file) return INFINITY;
  while (isinf(value) && fgets(line, sizeof line, file))
    if (sscanf(line, format, &value) != 1) value = INFINITY;
  fclose(file);
  return unit * value;
}

/* The least of three: memory that the machine has left, that a container may use, and what of the shell's is left. */
static PetscReal Available(PetscReal ranks)
{
  PetscReal     available = Number("/proc/meminfo", "MemAvailable: %lf", 1024);
  struct rlimit limit;

  available = PetscMin(available, Number("/sys/fs/cgroup/memory.max", "%lf", 1));
  if (!getrlimit(RLIMIT_AS, &limit) && limit.rlim_cur != RLIM_INFINITY) {
    const PetscReal used = Number("/proc/self/statm", "%lf", (PetscReal)sysconf(_SC_PAGESIZE));

    available = PetscMin(available, ranks * PetscMax(0, (PetscReal)limit.rlim_cur - (isinf(used) ? 0 : used)));
  }
  return available;
}

/* The least of all ranks of the bytes that each may use if the ranks of a machine share its memory evenly. */
static PetscErrorCode OfRank(MPI_Comm comm, PetscReal *bytes)
{
  PetscMPIInt here;
  MPI_Comm    machine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine));
  here = MpmRanksOf(machine);
  PetscCallMPI(MPI_Comm_free(&machine));
  *bytes = Available(here) / here;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bytes, 1, MPIU_REAL, MPI_MIN, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMemoryCheck(MPI_Comm comm, const char size[], PetscReal bytes, const char what[])
{
  const PetscMPIInt ranks = MpmRanksOf(comm);
  PetscReal         least;

  PetscFunctionBegin;
  if (bytes < PLENTY) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(OfRank(comm, &least));
  MpmCheckInput(bytes / ranks <= least,
                "%s: %s needs about %.2g GB, %.2g GB on each of %d "
                "ranks; allowed: %.2g GB a rank, so fewer cells or particles, or more machines",
                size, what, bytes / GB, bytes / ranks / GB, ranks, least / GB);
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmMemoryRoom(PetscReal bytes, size_t room, char why[])
{
  PetscReal available;

  if (bytes < PLENTY) return;
  available = Available(1);
  if (!(bytes <= available))
    (void)snprintf(why, room, "to read it takes about %.2g GB; allowed: %.2g GB, which is what is left here",
                   bytes / GB, available / GB);
}

PetscErrorCode MpmMemoryCheckLapack(void)
{
  int fits = MpmLaunchGrants(LAPACK_BYTES);

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &fits, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD));
  MpmCheckInput(fits, "memory: the shell grants too little to start with (ulimit -v); allowed: 0.2 GB more");
  PetscFunctionReturn(PETSC_SUCCESS);
}
