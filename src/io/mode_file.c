/* Reading what MpmModesWrite has written. */
#include "io/mode_file.h"
#include <math.h>
#include <petscviewerhdf5.h>

PetscErrorCode MpmModeFileGroup(const MpmScene *scene, char group[], size_t room)
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(group, room, "/modes/%04" PetscInt_FMT, scene->mode));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileGrowth(const MpmScene *scene, PetscReal *growth)
{
  PetscViewer viewer;
  char        group[64];

  PetscFunctionBegin;
  PetscCall(MpmModeFileGroup(scene, group, sizeof group));
  PetscCall(PetscViewerHDF5Open(PETSC_COMM_WORLD, scene->mode_file, FILE_MODE_READ, &viewer));
  PetscCall(PetscViewerHDF5ReadAttribute(viewer, group, "growth", PETSC_REAL, NULL, growth));
  PetscCall(PetscViewerDestroy(&viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The values of one field and part at this rank's particles. */
static PetscErrorCode ReadField(const MpmScene *scene, PetscViewer viewer, const char name[],
                                const MpmParticles *particles, PetscReal values[])
{
  const PetscInt64 *id;
  PetscInt         *rows;
  const PetscReal  *a;
  Vec               by_id, mine;
  IS                where;
  VecScatter        scatter;

  PetscFunctionBegin;
  PetscCall(
      VecCreateMPI(PetscObjectComm((PetscObject)viewer), PETSC_DECIDE, (PetscInt)scene->layout.particles, &by_id));
  PetscCall(PetscObjectSetName((PetscObject)by_id, name));
  PetscCall(VecLoad(by_id, viewer));
  PetscCall(PetscMalloc1(particles->count, &rows));
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt p = 0; p < particles->count; p++) rows[p] = (PetscInt)id[p];
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscCall(ISCreateGeneral(PETSC_COMM_SELF, particles->count, rows, PETSC_OWN_POINTER, &where));
  PetscCall(VecCreateSeq(PETSC_COMM_SELF, particles->count, &mine));
  PetscCall(VecScatterCreate(by_id, where, mine, NULL, &scatter));
  PetscCall(VecScatterBegin(scatter, by_id, mine, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(scatter, by_id, mine, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(mine, &a));
  PetscCall(PetscArraycpy(values, a, particles->count));
  PetscCall(VecRestoreArrayRead(mine, &a));
  PetscCall(VecScatterDestroy(&scatter));
  PetscCall(ISDestroy(&where));
  PetscCall(VecDestroy(&mine));
  PetscCall(VecDestroy(&by_id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All fields of one part ("re" or "im") into the particles, and the largest number among them. */
static PetscErrorCode ReadPart(const MpmScene *scene, PetscViewer viewer, const char part[], MpmParticles *particles,
                               PetscReal *largest)
{
  char name[128];

  PetscFunctionBegin;
  *largest = 0;
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    PetscReal *q;

    PetscCall(PetscSNPrintf(name, sizeof name, "%s_%s", scene->scheme.table->fields[f], part));
    PetscCall(MpmParticlesGet(particles, scene->scheme.table->fields[f], &q));
    PetscCall(ReadField(scene, viewer, name, particles, q));
    for (PetscInt p = 0; p < particles->count; p++) *largest = PetscMax(*largest, fabs(q[p]));
    PetscCall(MpmParticlesRestore(particles, scene->scheme.table->fields[f], &q));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 1, MPIU_REAL, MPI_MAX, PetscObjectComm((PetscObject)viewer)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileFill(const MpmScene *scene, PetscInt exponent, MpmParticles *particles)
{
  PetscReal   largest, imaginary;
  PetscViewer viewer;
  char        group[64];

  PetscFunctionBegin;
  PetscCall(MpmModeFileGroup(scene, group, sizeof group));
  PetscCall(
      PetscViewerHDF5Open(PetscObjectComm((PetscObject)particles->swarm), scene->mode_file, FILE_MODE_READ, &viewer));
  PetscCall(PetscViewerHDF5PushGroup(viewer, group));
  PetscCall(ReadPart(scene, viewer, "im", particles, &imaginary));
  PetscCall(ReadPart(scene, viewer, "re", particles, &largest));
  if (imaginary > largest) PetscCall(ReadPart(scene, viewer, "im", particles, &largest));
  PetscCall(PetscViewerHDF5PopGroup(viewer));
  PetscCall(PetscViewerDestroy(&viewer));
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    PetscReal *q;

    PetscCall(MpmParticlesGet(particles, scene->scheme.table->fields[f], &q));
    for (PetscInt p = 0; p < particles->count; p++) q[p] *= scalbn(scene->amplitude, -(int)exponent) / largest;
    PetscCall(MpmParticlesRestore(particles, scene->scheme.table->fields[f], &q));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
