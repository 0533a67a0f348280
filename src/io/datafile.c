/* HDF5 files through PETSc's parallel viewer: the scene as attributes, renamed when whole. */
#include "io/datafile.h"
#include <mpmstab/errors.h>
#include "scene/fields.h"
#include "base/unfinished.h"
#include <hdf5.h>
#include <petscvec.h>
#include <petscviewerhdf5.h>
#include <errno.h>
#include <string.h>
#include <unistd.h>

static PetscErrorCode WriteText(PetscViewer viewer, const char name[], const char text[])
{
  PetscFunctionBegin;
  PetscCall(PetscViewerHDF5WriteAttribute(viewer, "/", name, PETSC_STRING, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNumber(PetscViewer viewer, const char name[], PetscReal value)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerHDF5WriteAttribute(viewer, "/", name, PETSC_REAL, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A fraction is written as text too, which keeps 1/7 what it is; a range as its two ends. */
static PetscErrorCode WriteValue(PetscViewer viewer, const MpmValue *value)
{
  const char    *name  = value->field->name;
  const PetscInt count = (PetscInt)value->whole;
  char           other[64], text[64];

  PetscFunctionBegin;
  switch (value->kind) {
  case MPM_AS_COUNT:
    PetscCall(PetscViewerHDF5WriteAttribute(viewer, "/", name, PETSC_INT, &count));
    break;
  case MPM_AS_LONG:
    PetscCall(WriteNumber(viewer, name, (PetscReal)value->whole));
    break;
  case MPM_AS_REAL:
    PetscCall(WriteNumber(viewer, name, value->number[0]));
    break;
  case MPM_AS_RANGE:
    PetscCall(PetscSNPrintf(other, sizeof other, "%s_from", name));
    PetscCall(WriteNumber(viewer, other, value->number[0]));
    PetscCall(PetscSNPrintf(other, sizeof other, "%s_to", name));
    PetscCall(WriteNumber(viewer, other, value->number[1]));
    break;
  case MPM_AS_FRACTION:
    PetscCall(WriteNumber(viewer, name, value->fraction.value));
    if (!value->fraction.den) break;
    PetscCall(PetscSNPrintf(other, sizeof other, "%s_exact", name));
    PetscCall(MpmValueText(value, sizeof text, text));
    PetscCall(WriteText(viewer, other, text));
    break;
  default:
    PetscCall(WriteText(viewer, name, value->text));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteSceneAttributes(const MpmScene *scene, const MpmRequest *request, PetscViewer viewer)
{
  MpmValue values[MPM_MAX_VALUES];
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(WriteText(viewer, "version", MPMSTAB_VERSION));
  PetscCall(MpmValuesIn(MPM_IN_FILE, scene, request, &n, values));
  for (PetscInt i = 0; i < n; i++) PetscCall(WriteValue(viewer, &values[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileOpen(MPI_Comm comm, const MpmScene *scene, const MpmRequest *request, MpmDataFile *file)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(file->path, request->output, sizeof file->path));
  PetscCall(PetscSNPrintf(file->part, sizeof file->part, "%s.part", file->path));
  (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* a file that cannot be written is told in one line */
  MpmUnfinishedAdd(file->part);
  MpmErrorsBlame(file->path);
  PetscCall(PetscViewerHDF5Open(comm, file->part, FILE_MODE_WRITE, &file->viewer));
  PetscCall(WriteSceneAttributes(scene, request, file->viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileClose(MpmDataFile *file, const char also[])
{
  PetscMPIInt rank;
  int         error = 0;

  PetscFunctionBegin;
  PetscCall(PetscViewerDestroy(&file->viewer));
  MpmErrorsBlame("");
  MpmUnfinishedDone(file->part);
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0 && rename(file->part, file->path)) {
    error = errno;
    (void)unlink(file->part);
    if (also) (void)unlink(also);
  }
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileDrop(MpmDataFile *file)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCall(PetscViewerDestroy(&file->viewer));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) (void)unlink(file->part);
  MpmUnfinishedDone(file->part);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileArray(MpmDataFile *file, const char group[], const char name[], PetscInt rows,
                                PetscInt columns, const PetscReal values[])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)file->viewer);
  PetscMPIInt rank;
  Vec         array;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(VecCreate(comm, &array));
  PetscCall(VecSetBlockSize(array, columns));
  PetscCall(VecSetSizes(array, rank ? 0 : rows * columns, rows * columns));
  PetscCall(VecSetType(array, VECSTANDARD));
  if (rank == 0) {
    PetscReal *a;

    PetscCall(VecGetArray(array, &a));
    PetscCall(PetscArraycpy(a, values, rows * columns));
    PetscCall(VecRestoreArray(array, &a));
  }
  PetscCall(PetscObjectSetName((PetscObject)array, name));
  PetscCall(PetscViewerHDF5PushGroup(file->viewer, group));
  PetscCall(VecView(array, file->viewer));
  PetscCall(PetscViewerHDF5PopGroup(file->viewer));
  PetscCall(VecDestroy(&array));
  PetscFunctionReturn(PETSC_SUCCESS);
}
