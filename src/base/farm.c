/* Task farm: the ranks take the parts of some work in turn, and sums give the results to all ranks. */
#include "base/farm.h"
#include <mpmstab/errors.h>

PetscErrorCode MpmFarm(const char unit[], PetscInt n, MpmPart part, void *context)
{
  const PetscMPIInt rank = MpmRankOf(PETSC_COMM_WORLD), size = MpmRanksOf(PETSC_COMM_WORLD);
  MpmProgress       progress;

  PetscFunctionBegin;
  PetscCall(MpmProgressBegin(unit, &progress));
  for (PetscInt i = rank; i < n; i += size) {
    PetscCall(part(context, i));
    PetscCall(MpmProgressUpdate(&progress, PetscMin(i + size, n), n));
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Sum(PetscInt n, void *values, MPI_Datatype type)
{
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(PetscMPIIntCast(n, &count));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, values, count, type, MPI_SUM, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFarmSumReals(PetscInt n, PetscReal values[])
{
  return Sum(n, values, MPIU_REAL);
}

PetscErrorCode MpmFarmSumInts(PetscInt n, PetscInt values[])
{
  return Sum(n, values, MPIU_INT);
}
