/* Reading what MpmModesWrite has written. */
#include <mpmstab/errors.h>
#include <mpmstab/mode_file.h>
#include <hdf5.h>
#include <math.h>
#include <petscviewerhdf5.h>
#include <stdio.h>
#include <string.h>

static PetscErrorCode Group(const MpmScene *scene, char group[], size_t room)
{
  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(group, room, "/modes/%04" PetscInt_FMT, scene->mode));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether rank 0 finds an HDF5 file there; HDF5 itself would print a stack of complaints. */
static PetscErrorCode CheckKind(const char path[])
{
  PetscMPIInt rank;
  int         is = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) {
    FILE *file = fopen(path, "rb");

    if (file) {
      fclose(file);
      is = H5Fis_hdf5(path) > 0 ? 2 : 1;
    }
  }
  PetscCallMPI(MPI_Bcast(&is, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  MpmCheckInput(is == 2, "mode_file %s: %s; allowed: a file that 'mpmstab spectrum -output' has written", path,
                is ? "not an HDF5 file" : "cannot be read");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SameText(PetscViewer viewer, const char path[], const char name[], const char mine[])
{
  PetscBool has;
  char     *theirs;

  PetscFunctionBegin;
  PetscCall(PetscViewerHDF5HasAttribute(viewer, "/", name, &has));
  MpmCheckInput(has, "mode_file %s: no %s in it; allowed: a file that 'mpmstab spectrum -output' has written", path,
                name);
  PetscCall(PetscViewerHDF5ReadAttribute(viewer, "/", name, PETSC_STRING, NULL, &theirs));
  MpmCheckInput(!strcmp(mine, theirs), "mode_file %s: its %s is %s, the scene's is %s; allowed: the same", path, name,
                theirs, mine);
  PetscCall(PetscFree(theirs));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SameNumber(PetscViewer viewer, const char path[], const char name[], PetscReal mine)
{
  PetscReal theirs;

  PetscFunctionBegin;
  PetscCall(PetscViewerHDF5ReadAttribute(viewer, "/", name, PETSC_REAL, NULL, &theirs));
  MpmCheckInput(theirs == mine, "mode_file %s: its %s is %.17g, the scene's is %.17g; allowed: the same", path, name,
                theirs, mine);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SameCount(PetscViewer viewer, const char path[], const char name[], PetscInt mine)
{
  PetscInt theirs;

  PetscFunctionBegin;
  PetscCall(PetscViewerHDF5ReadAttribute(viewer, "/", name, PETSC_INT, NULL, &theirs));
  MpmCheckInput(theirs == mine,
                "mode_file %s: its %s is %" PetscInt_FMT ", the scene's is %" PetscInt_FMT "; allowed: the same", path,
                name, theirs, mine);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileCheck(const MpmScene *s)
{
  const char *path = s->mode_file;
  PetscViewer viewer;
  PetscBool   has;
  char        group[64];

  PetscFunctionBegin;
  PetscCall(CheckKind(path));
  PetscCall(PetscViewerHDF5Open(PETSC_COMM_WORLD, path, FILE_MODE_READ, &viewer));
  PetscCall(SameText(viewer, path, "formulation", s->formulation->name));
  PetscCall(SameText(viewer, path, "basis", s->basis->name));
  PetscCall(SameText(viewer, path, "transfer", s->transfer->name));
  PetscCall(SameText(viewer, path, "boundary", s->boundary));
  PetscCall(SameCount(viewer, path, "cells", s->cells));
  PetscCall(SameCount(viewer, path, "ppc", s->ppc));
  PetscCall(SameNumber(viewer, path, "offset", s->offset.value));
  PetscCall(SameNumber(viewer, path, "jitter", s->jitter));
  if (s->jitter != 0) PetscCall(SameNumber(viewer, path, "seed", (PetscReal)s->seed));
  PetscCall(SameNumber(viewer, path, "courant", s->courant));
  PetscCall(SameNumber(viewer, path, "first", (PetscReal)s->first));
  PetscCall(SameNumber(viewer, path, "particles", (PetscReal)s->particles));
  if (s->transfer->option) PetscCall(SameNumber(viewer, path, s->transfer->option, s->transfer->number(&s->numbers)));
  PetscCall(SameNumber(viewer, path, "drift", s->drift.value));
  PetscCall(Group(s, group, sizeof group));
  PetscCall(PetscViewerHDF5HasAttribute(viewer, group, "growth", &has));
  MpmCheckInput(has,
                "mode %" PetscInt_FMT ": mode_file %s does not hold it; allowed: one of those that 'mpmstab "
                "spectrum -modes' has kept",
                s->mode, path);
  PetscCall(PetscViewerDestroy(&viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileGrowth(const MpmScene *scene, PetscReal *growth)
{
  PetscViewer viewer;
  char        group[64];

  PetscFunctionBegin;
  PetscCall(Group(scene, group, sizeof group));
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
  PetscCall(VecCreateMPI(PetscObjectComm((PetscObject)viewer), PETSC_DECIDE, (PetscInt)scene->particles, &by_id));
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
  for (PetscInt f = 0; scene->table->fields[f]; f++) {
    PetscReal *q;

    PetscCall(PetscSNPrintf(name, sizeof name, "%s_%s", scene->table->fields[f], part));
    PetscCall(MpmParticlesGet(particles, scene->table->fields[f], &q));
    PetscCall(ReadField(scene, viewer, name, particles, q));
    for (PetscInt p = 0; p < particles->count; p++) *largest = PetscMax(*largest, fabs(q[p]));
    PetscCall(MpmParticlesRestore(particles, scene->table->fields[f], &q));
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
  PetscCall(Group(scene, group, sizeof group));
  PetscCall(
      PetscViewerHDF5Open(PetscObjectComm((PetscObject)particles->swarm), scene->mode_file, FILE_MODE_READ, &viewer));
  PetscCall(PetscViewerHDF5PushGroup(viewer, group));
  PetscCall(ReadPart(scene, viewer, "im", particles, &imaginary));
  PetscCall(ReadPart(scene, viewer, "re", particles, &largest));
  if (imaginary > largest) PetscCall(ReadPart(scene, viewer, "im", particles, &largest));
  PetscCall(PetscViewerHDF5PopGroup(viewer));
  PetscCall(PetscViewerDestroy(&viewer));
  for (PetscInt f = 0; scene->table->fields[f]; f++) {
    PetscReal *q;

    PetscCall(MpmParticlesGet(particles, scene->table->fields[f], &q));
    for (PetscInt p = 0; p < particles->count; p++) q[p] *= scalbn(scene->amplitude, -(int)exponent) / largest;
    PetscCall(MpmParticlesRestore(particles, scene->table->fields[f], &q));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
