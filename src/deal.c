/* Parts of work dealt to the ranks in turn. */
#include <mpmstab/deal.h>
#include <mpmstab/progress.h>

PetscErrorCode MpmDeal(const MpmScene *scene, const char unit[], PetscInt n, MpmPart part, void *context)
{
  PetscMPIInt rank, size;
  MpmProgress progress;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  PetscCall(MpmProgressBegin(scene, unit, &progress));
  for (PetscInt i = rank; i < n; i += size) {
    PetscCall(part(context, i));
    PetscCall(MpmProgressUpdate(&progress, PetscMin(i + size, n), n));
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDealtReals(PetscInt n, PetscReal values[])
{
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(PetscMPIIntCast(n, &count));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, values, count, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDealtInts(PetscInt n, PetscInt values[])
{
  PetscMPIInt count;

  PetscFunctionBegin;
  PetscCall(PetscMPIIntCast(n, &count));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, values, count, MPIU_INT, MPI_SUM, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}
