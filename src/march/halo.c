/*
   Halo sums by a star forest over the nodes that ranks share. DMLocalToGlobal with ADD_VALUES and back would copy every node
   twice, for a few that are shared, and send a message for each field.
*/
#include "march/halo.h"

/* Numbers the owned nodes that are ghosts of other ranks, and tells each such ghost, leaf[], the number of its node. */
static PetscErrorCode Number(MPI_Comm comm, PetscInt all, PetscSFNode owner[], MpmHalo *h)
{
  const PetscInt *degree;
  PetscInt       *number;
  PetscSF         every; /* with all nodes of a local array as roots */

  PetscFunctionBegin;
  PetscCall(PetscSFCreate(comm, &every));
  PetscCall(PetscSFSetGraph(every, all, h->nleaves, h->leaf, PETSC_COPY_VALUES, owner, PETSC_COPY_VALUES));
  PetscCall(PetscSFComputeDegreeBegin(every, &degree));
  PetscCall(PetscSFComputeDegreeEnd(every, &degree));
  for (PetscInt i = 0; i < all; i++) h->nroots += degree[i] > 0;
  PetscCall(PetscMalloc1(h->nroots, &h->root));
  PetscCall(PetscMalloc1(all, &number));
  for (PetscInt i = 0, r = 0; i < all; i++) {
    number[i] = r;
    if (degree[i]) h->root[r++] = i;
  }
  PetscCall(PetscSFBcastBegin(every, MPIU_INT, number, number, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(every, MPIU_INT, number, number, MPI_REPLACE));
  for (PetscInt l = 0; l < h->nleaves; l++) owner[l].index = number[h->leaf[l]];
  PetscCall(PetscSFCreate(comm, &h->sf));
  PetscCall(PetscSFSetGraph(h->sf, h->nroots, h->nleaves, NULL, PETSC_COPY_VALUES, owner, PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(h->sf));
  PetscCall(PetscFree(number));
  PetscCall(PetscSFDestroy(&every));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHaloCreate(MPI_Comm comm, PetscInt all, PetscInt n, const PetscInt ghost[], const PetscSFNode owner[],
                             MpmHalo **halo)
{
  PetscMPIInt  rank, size;
  PetscSFNode *far;
  MpmHalo     *h;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscNew(halo));
  h = *halo;
  for (PetscInt f = 0; f <= MPM_HALO_FIELDS; f++) h->unit[f] = MPI_DATATYPE_NULL;
  PetscCall(PetscMalloc3(n, &h->near[0], n, &h->near[1], n, &h->leaf));
  PetscCall(PetscMalloc1(n, &far));
  for (PetscInt i = 0; i < n; i++) {
    if (owner[i].rank == rank) {
      h->near[0][h->nnear]   = ghost[i];
      h->near[1][h->nnear++] = owner[i].index;
    } else {
      h->leaf[h->nleaves] = ghost[i];
      far[h->nleaves++]   = owner[i];
    }
  }
  if (size > 1) PetscCall(Number(comm, all, far, h));
  PetscCall(PetscFree(far));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHaloDestroy(MpmHalo **halo)
{
  MpmHalo *h = *halo;

  PetscFunctionBegin;
  PetscCall(PetscSFDestroy(&h->sf));
  for (PetscInt f = 0; f <= MPM_HALO_FIELDS; f++)
    if (h->unit[f] != MPI_DATATYPE_NULL) PetscCallMPI(MPI_Type_free(&h->unit[f]));
  PetscCall(PetscFree2(h->roots, h->leaves));
  PetscCall(PetscFree(h->root));
  PetscCall(PetscFree3(h->near[0], h->near[1], h->leaf));
  PetscCall(PetscFree(*halo));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for n fields, and the type of a node's values. The sums of a star forest take one number only as itself. */
static PetscErrorCode Begin(MpmHalo *h, PetscInt n, MPI_Datatype *unit)
{
  PetscFunctionBegin;
  PetscCheck(n <= MPM_HALO_FIELDS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "more fields than the halo has room for");
  if (n > h->room) {
    PetscCall(PetscFree2(h->roots, h->leaves));
    PetscCall(PetscMalloc2(n * h->nroots, &h->roots, n * h->nleaves, &h->leaves));
    h->room = n;
  }
  if (n > 1 && h->unit[n] == MPI_DATATYPE_NULL) {
    PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)n, MPIU_REAL, &h->unit[n]));
    PetscCallMPI(MPI_Type_commit(&h->unit[n]));
  }
  *unit = n == 1 ? MPIU_REAL : h->unit[n];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Pack(PetscInt count, const PetscInt index[], PetscInt n, PetscReal *const arrays[],
                 PetscReal *restrict values)
{
  for (PetscInt f = 0; f < n; f++)
    for (PetscInt i = 0; i < count; i++) values[n * i + f] = arrays[f][index[i]];
}

static void Unpack(PetscInt count, const PetscInt index[], PetscInt n, const PetscReal *restrict values,
                   PetscReal *const arrays[])
{
  for (PetscInt f = 0; f < n; f++)
    for (PetscInt i = 0; i < count; i++) arrays[f][index[i]] = values[n * i + f];
}

PetscErrorCode MpmHaloSum(MpmHalo *h, PetscInt n, PetscReal *const arrays[])
{
  MPI_Datatype unit;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++)
    for (PetscInt i = 0; i < h->nnear; i++) arrays[f][h->near[1][i]] += arrays[f][h->near[0][i]];
  if (n == 0 || !h->sf) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Begin(h, n, &unit));
  Pack(h->nroots, h->root, n, arrays, h->roots);
  Pack(h->nleaves, h->leaf, n, arrays, h->leaves);
  PetscCall(PetscSFReduceBegin(h->sf, unit, h->leaves, h->roots, MPI_SUM));
  PetscCall(PetscSFReduceEnd(h->sf, unit, h->leaves, h->roots, MPI_SUM));
  Unpack(h->nroots, h->root, n, h->roots, arrays);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHaloSpread(MpmHalo *h, PetscInt n, PetscReal *const arrays[])
{
  MPI_Datatype unit;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < n; f++)
    for (PetscInt i = 0; i < h->nnear; i++) arrays[f][h->near[0][i]] = arrays[f][h->near[1][i]];
  if (n == 0 || !h->sf) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Begin(h, n, &unit));
  Pack(h->nroots, h->root, n, arrays, h->roots);
  PetscCall(PetscSFBcastBegin(h->sf, unit, h->roots, h->leaves, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(h->sf, unit, h->roots, h->leaves, MPI_REPLACE));
  Unpack(h->nleaves, h->leaf, n, h->leaves, arrays);
  PetscFunctionReturn(PETSC_SUCCESS);
}
