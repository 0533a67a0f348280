/*
   Halo sums by a star forest over the nodes that ranks share. Each rank sends the sums of its copies to all ranks that
   have the node too, and each of them adds up. So there is one message to a neighbour, where a sum at the owner and its
   way back to the ghosts would take two, one after the other. DMLocalToGlobal with ADD_VALUES and back would also copy
   every node twice, for a few that are shared, and send a message for each field.
*/
#include "march/halo.h"

/* Lists this rank's copies of the nodes, or the first copy on each lower or each higher rank. */
static void ListCopies(PetscMPIInt rank, PetscInt n, const PetscInt start[], const PetscSFNode all[], MpmHalo *h)
{
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt c = start[i]; c < start[i + 1]; c++) {
      if (all[c].rank != rank) continue;
      h->copy[h->ncopies]        = all[c].index;
      h->copy_node[h->ncopies++] = i;
    }
  }
}

static void ListOthers(PetscMPIInt rank, PetscBool lower, PetscInt n, const PetscInt start[], const PetscSFNode all[],
                       MpmHalo *h, PetscSFNode others[])
{
  for (PetscInt i = 0; i < n; i++) {
    for (PetscInt c = start[i]; c < start[i + 1]; c++) {
      if (lower ? all[c].rank >= rank : all[c].rank <= rank) continue;
      if (c > start[i] && all[c].rank == all[c - 1].rank) continue;
      others[h->nothers]          = all[c];
      h->other_node[h->nothers++] = i;
    }
  }
}

/* Connects the nodes of this rank with those of others, which are given by their first copy there. */
static PetscErrorCode Connect(MPI_Comm comm, PetscInt size, MpmHalo *h, PetscSFNode others[])
{
  const PetscInt nothers = h->nothers;
  PetscInt      *number, *found;
  PetscSF        every; /* with all nodes of a local array as roots */

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(size, &number, nothers, &found));
  for (PetscInt c = 0; c < h->ncopies; c++) number[h->copy[c]] = h->copy_node[c];
  PetscCall(PetscSFCreate(comm, &every));
  PetscCall(PetscSFSetGraph(every, size, nothers, NULL, PETSC_COPY_VALUES, others, PETSC_COPY_VALUES));
  PetscCall(PetscSFBcastBegin(every, MPIU_INT, number, found, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(every, MPIU_INT, number, found, MPI_REPLACE));
  PetscCall(PetscSFDestroy(&every));
  for (PetscInt l = 0; l < nothers; l++) others[l].index = found[l];
  PetscCall(PetscFree2(number, found));
  PetscCall(PetscSFCreate(comm, &h->sf));
  PetscCall(PetscSFSetGraph(h->sf, h->nnodes, nothers, NULL, PETSC_COPY_VALUES, others, PETSC_COPY_VALUES));
  PetscCall(PetscSFSetUp(h->sf));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHaloCreate(MPI_Comm comm, PetscInt size, PetscInt n, const PetscInt start[], const PetscSFNode all[],
                             MpmHalo **halo)
{
  PetscMPIInt  rank, ranks;
  PetscSFNode *others;
  MpmHalo     *h;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(PetscNew(halo));
  h         = *halo;
  h->nnodes = n;
  for (PetscInt f = 0; f <= MPM_HALO_FIELDS; f++) h->unit[f] = MPI_DATATYPE_NULL;
  PetscCall(PetscMalloc3(start[n], &h->copy, start[n], &h->copy_node, start[n], &h->other_node));
  PetscCall(PetscMalloc1(start[n], &others));
  ListCopies(rank, n, start, all, h);
  ListOthers(rank, PETSC_TRUE, n, start, all, h, others);
  h->nlower = h->nothers;
  ListOthers(rank, PETSC_FALSE, n, start, all, h, others);
  if (ranks > 1) PetscCall(Connect(comm, size, h, others));
  PetscCall(PetscFree(others));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHaloDestroy(MpmHalo **halo)
{
  MpmHalo *h = *halo;

  PetscFunctionBegin;
  PetscCall(PetscSFDestroy(&h->sf));
  for (PetscInt f = 0; f <= MPM_HALO_FIELDS; f++)
    if (h->unit[f] != MPI_DATATYPE_NULL) PetscCallMPI(MPI_Type_free(&h->unit[f]));
  PetscCall(PetscFree3(h->own, h->others, h->total));
  PetscCall(PetscFree3(h->copy, h->copy_node, h->other_node));
  PetscCall(PetscFree(*halo));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes room for n fields. */
static PetscErrorCode MakeRoom(MpmHalo *h, PetscInt n)
{
  PetscFunctionBegin;
  PetscCheck(n <= MPM_HALO_FIELDS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "more fields than the halo has room for");
  if (n <= h->room) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3(h->own, h->others, h->total));
  PetscCall(PetscMalloc3(n * h->nnodes, &h->own, n * h->nothers, &h->others, h->sf ? n * h->nnodes : 0, &h->total));
  h->room = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The type of a node's values. */
static PetscErrorCode GetUnit(MpmHalo *h, PetscInt n, MPI_Datatype *unit)
{
  PetscFunctionBegin;
  if (h->unit[n] == MPI_DATATYPE_NULL) {
    PetscCallMPI(MPI_Type_contiguous((PetscMPIInt)n, MPIU_REAL, &h->unit[n]));
    PetscCallMPI(MPI_Type_commit(&h->unit[n]));
  }
  *unit = h->unit[n];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the sums of other ranks, n numbers each. */
static void AddOthers(const MpmHalo *h, PetscInt n, PetscInt begin, PetscInt end)
{
  for (PetscInt l = begin; l < end; l++)
    for (PetscInt f = 0; f < n; f++) h->total[n * h->other_node[l] + f] += h->others[n * l + f];
}

/* Exchanges the sums of ranks, and adds all in the order of ranks. */
static PetscErrorCode AddUp(MpmHalo *h, PetscInt n)
{
  MPI_Datatype unit;

  PetscFunctionBegin;
  PetscCall(GetUnit(h, n, &unit));
  PetscCall(PetscSFBcastBegin(h->sf, unit, h->own, h->others, MPI_REPLACE));
  PetscCall(PetscSFBcastEnd(h->sf, unit, h->own, h->others, MPI_REPLACE));
  PetscCall(PetscArrayzero(h->total, n * h->nnodes));
  AddOthers(h, n, 0, h->nlower);
  for (PetscInt i = 0; i < n * h->nnodes; i++) h->total[i] += h->own[i];
  AddOthers(h, n, h->nlower, h->nothers);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmHaloSum(MpmHalo *h, PetscInt n, PetscReal *const arrays[])
{
  PetscFunctionBegin;
  if (n == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MakeRoom(h, n));
  PetscCall(PetscArrayzero(h->own, n * h->nnodes));
  for (PetscInt f = 0; f < n; f++) {
    PetscReal *restrict own         = h->own + f;
    const PetscReal *restrict array = arrays[f];

    for (PetscInt c = 0; c < h->ncopies; c++) own[n * h->copy_node[c]] += array[h->copy[c]];
  }
  if (h->sf) PetscCall(AddUp(h, n));
  for (PetscInt f = 0; f < n; f++) {
    const PetscReal *restrict sum = (h->sf ? h->total : h->own) + f;
    PetscReal *restrict array     = arrays[f];

    for (PetscInt c = 0; c < h->ncopies; c++) array[h->copy[c]] = sum[n * h->copy_node[c]];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
