/* Reads what MpmModesWrite has written, after MpmModeFileCheck has checked it. */
#include "io/mode_file.h"
#include <mpmstab/errors.h>
#include "march/march_private.h"
#include <math.h>

void MpmModeFileGroup(const MpmScene *scene, char group[], size_t room)
{
  (void)snprintf(group, room, "/modes/%04" PetscInt_FMT, scene->mode[0]);
}

/* Closes the file. It was whole when the program began, but somebody may have changed it since. */
static PetscErrorCode CloseRead(const char path[], MpmHdf5 *file)
{
  PetscBool failed;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Close(file, &failed));
  MpmCheckInput(!failed, "mode_file %s: cannot be read any more; allowed: a file that stays as it is", path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileGrowth(const MpmScene *scene, const char path[], PetscReal *growth)
{
  MpmHdf5 file;
  char    group[64];

  PetscFunctionBegin;
  MpmModeFileGroup(scene, group, sizeof group);
  PetscCall(MpmHdf5Open(PETSC_COMM_WORLD, path, &file));
  if (!MpmHdf5ReadAttribute(&file, group, "growth", H5T_NATIVE_DOUBLE, growth)) file.failed = PETSC_TRUE;
  PetscCall(CloseRead(path, &file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads one field's real or imaginary part at this rank's particles. The file holds it in the order of global ids. */
static PetscErrorCode ReadField(const MpmScene *scene, MpmHdf5 *file, const char name[], const MpmParticles *particles,
                                PetscReal values[])
{
  PetscInt          begin, end;
  PetscReal        *part;
  const PetscInt64 *id;
  PetscInt         *rows;
  const PetscReal  *a;
  Vec               by_id, mine;
  IS                where;
  VecScatter        scatter;

  PetscFunctionBegin;
  PetscCall(VecCreateMPI(file->comm, PETSC_DECIDE, (PetscInt)scene->layout.particles, &by_id));
  PetscCall(VecGetOwnershipRange(by_id, &begin, &end));
  PetscCall(VecGetArray(by_id, &part));
  MpmHdf5Read(file, name, H5T_NATIVE_DOUBLE, begin, end - begin, part);
  PetscCall(VecRestoreArray(by_id, &part));
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

/* Reads all fields of one part ("re" or "im") into the particles, and finds the largest number among them. */
static PetscErrorCode ReadPart(const MpmScene *scene, MpmHdf5 *file, const char part[], MpmParticles *particles,
                               PetscReal *largest)
{
  char group[64], name[128];

  PetscFunctionBegin;
  MpmModeFileGroup(scene, group, sizeof group);
  *largest = 0;
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    PetscReal *q;

    (void)snprintf(name, sizeof name, "%s/%s_%s", group, scene->scheme.table->fields[f], part);
    PetscCall(MpmParticlesGet(particles, scene->scheme.table->fields[f], &q));
    PetscCall(ReadField(scene, file, name, particles, q));
    for (PetscInt p = 0; p < particles->count; p++) *largest = PetscMax(*largest, fabs(q[p]));
    PetscCall(MpmParticlesRestore(particles, scene->scheme.table->fields[f], &q));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, largest, 1, MPIU_REAL, MPI_MAX, file->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileFill(const char path[], MpmMarch *march)
{
  const MpmScene *scene     = march->scene;
  MpmParticles   *particles = march->particles;
  PetscReal       largest, imaginary;
  MpmHdf5         file;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Open(PetscObjectComm((PetscObject)particles->swarm), path, &file));
  PetscCall(ReadPart(scene, &file, "im", particles, &imaginary));
  PetscCall(ReadPart(scene, &file, "re", particles, &largest));
  if (imaginary > largest) PetscCall(ReadPart(scene, &file, "im", particles, &largest));
  PetscCall(CloseRead(path, &file));
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    PetscReal *q;

    PetscCall(MpmParticlesGet(particles, scene->scheme.table->fields[f], &q));
    for (PetscInt p = 0; p < particles->count; p++) q[p] *= scalbn(scene->amplitude, -(int)march->exponent) / largest;
    PetscCall(MpmParticlesRestore(particles, scene->scheme.table->fields[f], &q));
  }
  PetscCall(MpmMarchStart(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}
