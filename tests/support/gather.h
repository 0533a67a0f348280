/* Gathers particle fields in the order of global ids on every rank, so that runs can be compared. */
#pragma once
#include "check.h"
#include "march/march_private.h"

/*
   Collective. Gives values[id] of all particles of the march, in true size (2^exponent applied). Free them with
   PetscFree.
*/
static inline PetscErrorCode GatherField(const MpmMarch *march, const char name[], PetscReal **values)
{
  const PetscInt64 *id;
  const PetscReal  *q;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(march->particles->total, values));
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesGet(march->particles, name, &q));
  for (PetscInt p = 0; p < march->particles->count; p++) (*values)[id[p]] += scalbn(q[p], (int)march->exponent);
  PetscCall(MpmParticlesRestore(march->particles, name, &q));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, *values, (PetscMPIInt)march->particles->total, MPIU_REAL, MPI_SUM,
                             PetscObjectComm((PetscObject)march->grid->da)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Collective. Marches a scene to its last step on a communicator. */
static inline PetscErrorCode MarchScene(MPI_Comm comm, const MpmScene *scene, MpmMarch **march)
{
  PetscFunctionBegin;
  PetscCall(MpmMarchCreate(comm, scene, march));
  for (PetscInt64 step = 0; step < check_request.steps; step++) PetscCall(MpmMarchStep(*march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscReal LargestDifference(PetscInt64 n, const PetscReal a[], const PetscReal b[])
{
  PetscReal largest = 0;

  for (PetscInt64 i = 0; i < n; i++) largest = PetscMax(largest, fabs(a[i] - b[i]));
  return largest;
}

static inline PetscReal LargestNumber(PetscInt64 n, const PetscReal a[])
{
  PetscReal largest = 0;

  for (PetscInt64 i = 0; i < n; i++) largest = PetscMax(largest, fabs(a[i]));
  return largest;
}
