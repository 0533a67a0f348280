/* What the machine has left, and what is asked of it. */
#include "base/memory.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <stdio.h>
#include <sys/resource.h>

#define PLENTY 1e8 /* bytes: less is not worth asking the machine for */
#define GB 1073741824.0

/* One number of a file, in bytes; INFINITY when the machine has none such. */
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

/* The least of what the machine has left, what a container may have, and what the shell grants. */
static PetscReal Available(PetscReal ranks)
{
  PetscReal     available = Number("/proc/meminfo", "MemAvailable: %lf", 1024);
  struct rlimit limit;

  available = PetscMin(available, Number("/sys/fs/cgroup/memory.max", "%lf", 1));
  if (!getrlimit(RLIMIT_AS, &limit) && limit.rlim_cur != RLIM_INFINITY)
    available = PetscMin(available, ranks * (PetscReal)limit.rlim_cur);
  return available;
}

PetscErrorCode MpmMemoryOfRank(MPI_Comm comm, PetscReal *bytes)
{
  PetscMPIInt here;
  MPI_Comm    machine;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_split_type(comm, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine));
  PetscCallMPI(MPI_Comm_size(machine, &here));
  PetscCallMPI(MPI_Comm_free(&machine));
  *bytes = Available(here) / here;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, bytes, 1, MPIU_REAL, MPI_MIN, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMemoryCheck(MPI_Comm comm, const char size[], PetscReal bytes, const char what[])
{
  PetscMPIInt ranks;
  PetscReal   least;

  PetscFunctionBegin;
  if (bytes < PLENTY) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(MpmMemoryOfRank(comm, &least));
  MpmCheckInput(bytes / ranks <= least,
                "%s: %s needs about %.2g GB, %.2g GB on each of %d "
                "ranks; allowed: %.2g GB a rank, so fewer cells or particles, or more machines",
                size, what, bytes / GB, bytes / ranks / GB, ranks, least / GB);
  PetscFunctionReturn(PETSC_SUCCESS);
}
