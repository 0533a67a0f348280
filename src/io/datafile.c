/* Data files: the scene becomes attributes of an HDF5 file, which has a temporary name until it is whole. */
#include "io/datafile.h"
#include <mpmstab/errors.h>
#include "base/textfile.h"
#include "scene/fields.h"
#include <string.h>

/* A fraction is written as text too, so that 1/7 stays exact. */
static PetscErrorCode WriteOne(MpmHdf5 *file, const MpmValue *value, PetscInt a)
{
  MpmAttribute of[2];
  char         name[80], text[64];
  PetscInt     n;

  PetscFunctionBegin;
  MpmValueAttributes(value, a, &n, of);
  for (PetscInt i = 0; i < n; i++) {
    if (of[i].kind == MPM_AS_COUNT)
      MpmHdf5WriteInteger(file, "/", of[i].name, of[i].count);
    else if (of[i].kind == MPM_AS_REAL)
      MpmHdf5WriteReal(file, "/", of[i].name, of[i].number);
    else
      MpmHdf5WriteText(file, "/", of[i].name, of[i].text);
  }
  if (value->kind != MPM_AS_FRACTION || !value->fraction[a].den) PetscFunctionReturn(PETSC_SUCCESS);
  (void)snprintf(name, sizeof name, "%s_exact", of[0].name);
  PetscCall(MpmValueOneText(value, a, sizeof text, text));
  MpmHdf5WriteText(file, "/", name, text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteSceneAttributes(const MpmScene *scene, const MpmRequest *request, MpmHdf5 *file)
{
  MpmValue values[MPM_MAX_VALUES];
  PetscInt n;

  PetscFunctionBegin;
  MpmHdf5WriteText(file, "/", "version", MPMSTAB_VERSION);
  PetscCall(MpmValuesIn(MPM_IN_FILE, scene, request, &n, values));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt a = 0; a < values[i].n; a++) PetscCall(WriteOne(file, &values[i], a));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileCreate(MPI_Comm comm, const char path[], MpmDataFile *file)
{
  int error;

  PetscFunctionBegin;
  (void)snprintf(file->path, sizeof file->path, "%s", path);
  PetscCall(MpmFileCreate(comm, file->path, file->part, &error));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscCall(MpmHdf5Create(comm, file->part, 0, &file->hdf5));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileOpen(MPI_Comm comm, const MpmScene *scene, const MpmRequest *request, MpmDataFile *file)
{
  PetscFunctionBegin;
  PetscCall(MpmDataFileCreate(comm, request->output, file));
  PetscCall(WriteSceneAttributes(scene, request, &file->hdf5));
  PetscCall(MpmDataFileCheck(file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileCheck(MpmDataFile *file)
{
  PetscBool failed;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Failed(&file->hdf5, &failed));
  if (!failed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmDataFileDrop(file));
  MpmRefuse("%s: cannot be written: %s; allowed: a disk with room for it", file->path, file->hdf5.why);
}

PetscErrorCode MpmDataFileClose(MpmDataFile *file)
{
  int       error;
  PetscBool failed;

  PetscFunctionBegin;
  PetscCall(MpmDataFileCheck(file));
  PetscCall(MpmHdf5Close(&file->hdf5, &failed));
  if (failed) PetscCall(MpmDataFileDrop(file));
  MpmCheckInput(!failed, "%s: cannot be written: %s; allowed: a disk with room for it", file->path, file->hdf5.why);
  PetscCall(MpmFileFinish(file->hdf5.comm, file->path, file->part, &error));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The file is removed before it is closed: closing may fail on a full disk, and the file must not stay. */
PetscErrorCode MpmDataFileDrop(MpmDataFile *file)
{
  PetscBool failed;

  PetscFunctionBegin;
  MpmUnfinishedDrop(file->part);
  PetscCall(MpmHdf5Close(&file->hdf5, &failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileArray(MpmDataFile *file, const char group[], const char name[], PetscInt rows,
                                PetscInt columns, const PetscReal values[])
{
  char path[256];

  PetscFunctionBegin;
  (void)snprintf(path, sizeof path, "%s/%s", group, name);
  PetscCall(MpmHdf5Write(&file->hdf5, path, H5T_NATIVE_DOUBLE, MpmRankOf(file->hdf5.comm) ? 0 : rows, columns, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileVector(MpmDataFile *file, const char path[], PetscInt n, const PetscInt row[], Vec vector)
{
  const PetscReal *values;
  PetscInt         size, width;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(vector, &size));
  PetscCall(VecGetBlockSize(vector, &width));
  PetscCall(VecGetArrayRead(vector, &values));
  PetscCall(MpmHdf5WriteRows(&file->hdf5, path, H5T_NATIVE_DOUBLE, n ? size / width : size, n, row, values));
  PetscCall(VecRestoreArrayRead(vector, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}
