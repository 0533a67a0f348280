/* One-dimensional arrays in HDF5, read and written by all ranks together. */
#include "io/slabs.h"

/* What HDF5 returns when it fails is negative. */
static hid_t Try(MpmSlabs *s, hid_t result)
{
  if (result < 0) s->failed = PETSC_TRUE;
  return result;
}

static PetscErrorCode Access(MPI_Comm comm, MpmSlabs *s, hid_t *access)
{
  PetscFunctionBegin;
  *s = (MpmSlabs){.comm = comm, .file = -1};
  PetscCheck(H5Eset_auto2(H5E_DEFAULT, NULL, NULL) >= 0, comm, PETSC_ERR_LIB, "HDF5 cannot be kept silent");
  *access = Try(s, H5Pcreate(H5P_FILE_ACCESS));
  (void)Try(s, H5Pset_fapl_mpio(*access, comm, MPI_INFO_NULL));
  s->transfer = Try(s, H5Pcreate(H5P_DATASET_XFER));
  (void)Try(s, H5Pset_dxpl_mpio(s->transfer, H5FD_MPIO_COLLECTIVE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSlabsCreate(MPI_Comm comm, const char path[], PetscInt reserved, MpmSlabs *s)
{
  hid_t access, creation;

  PetscFunctionBegin;
  PetscCall(Access(comm, s, &access));
  creation = Try(s, H5Pcreate(H5P_FILE_CREATE));
  (void)Try(s, H5Pset_userblock(creation, (hsize_t)reserved));
  s->file = Try(s, H5Fcreate(path, H5F_ACC_TRUNC, creation, access));
  (void)Try(s, H5Pclose(creation));
  (void)Try(s, H5Pclose(access));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSlabsOpen(MPI_Comm comm, const char path[], MpmSlabs *s)
{
  hid_t access;

  PetscFunctionBegin;
  PetscCall(Access(comm, s, &access));
  s->file = Try(s, H5Fopen(path, H5F_ACC_RDONLY, access));
  (void)Try(s, H5Pclose(access));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSlabsFailed(const MpmSlabs *s, PetscBool *failed)
{
  int any = s->failed ? 1 : 0; /* PETSc has changed MPI's name of its own type */

  PetscFunctionBegin;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &any, 1, MPI_INT, MPI_MAX, s->comm));
  *failed = any ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSlabsClose(MpmSlabs *s, PetscBool *failed)
{
  PetscFunctionBegin;
  if (s->file >= 0) (void)Try(s, H5Fclose(s->file));
  (void)Try(s, H5Pclose(s->transfer));
  PetscCall(MpmSlabsFailed(s, failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The part of an array that a rank reads or writes; one that has none still takes part. */
static hid_t Part(MpmSlabs *s, hid_t space, PetscInt64 begin, PetscInt64 n)
{
  const hsize_t offset = (hsize_t)begin, count = (hsize_t)n;

  if (n == 0)
    (void)Try(s, H5Sselect_none(space));
  else
    (void)Try(s, H5Sselect_hyperslab(space, H5S_SELECT_SET, &offset, NULL, &count, NULL));
  return Try(s, H5Screate_simple(1, &count, NULL));
}

PetscErrorCode MpmSlabsWrite(MpmSlabs *s, const char name[], hid_t type, PetscInt64 n, const void *part)
{
  PetscInt64 begin = 0, total = n;
  hsize_t    length;
  hid_t      space, array, memory;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Exscan(&n, &begin, 1, MPIU_INT64, MPI_SUM, s->comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPIU_INT64, MPI_SUM, s->comm));
  length = (hsize_t)total;
  space  = Try(s, H5Screate_simple(1, &length, NULL));
  array  = Try(s, H5Dcreate2(s->file, name, type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  memory = Part(s, space, begin, n);
  (void)Try(s, H5Dwrite(array, type, memory, space, s->transfer, part));
  (void)Try(s, H5Sclose(memory));
  (void)Try(s, H5Dclose(array));
  (void)Try(s, H5Sclose(space));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An array of one dimension with numbers of the right class, and its length; more than the file holds is none. */
static hid_t Find(MpmSlabs *s, const char name[], hid_t type, PetscInt64 *length)
{
  hid_t   array, space, has;
  hsize_t n = 0, bytes = 0;

  *length = -1;
  if (H5Lexists(s->file, name, H5P_DEFAULT) <= 0) return -1;
  array = H5Dopen2(s->file, name, H5P_DEFAULT);
  if (array < 0) return -1;
  space = H5Dget_space(array);
  has   = H5Dget_type(array);
  (void)Try(s, H5Fget_filesize(s->file, &bytes));
  if (H5Tget_class(has) == H5Tget_class(type) && H5Sget_simple_extent_ndims(space) == 1 &&
      H5Sget_simple_extent_dims(space, &n, NULL) == 1 && n <= bytes / H5Tget_size(has))
    *length = (PetscInt64)n;
  (void)Try(s, H5Tclose(has));
  (void)Try(s, H5Sclose(space));
  return array;
}

PetscErrorCode MpmSlabsLength(MpmSlabs *s, const char name[], hid_t type, PetscInt64 *length)
{
  const hid_t array = Find(s, name, type, length);

  PetscFunctionBegin;
  if (array >= 0) (void)Try(s, H5Dclose(array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSlabsRead(MpmSlabs *s, const char name[], hid_t type, PetscInt64 begin, PetscInt64 n, void *part)
{
  PetscInt64  length;
  const hid_t array = Find(s, name, type, &length);
  hid_t       space, memory;

  PetscFunctionBegin;
  if (array < 0 || begin + n > length) s->failed = PETSC_TRUE;
  space  = Try(s, H5Dget_space(array));
  memory = Part(s, space, begin, n);
  (void)Try(s, H5Dread(array, type, memory, space, s->transfer, part));
  (void)Try(s, H5Sclose(memory));
  (void)Try(s, H5Sclose(space));
  if (array >= 0) (void)Try(s, H5Dclose(array));
  PetscFunctionReturn(PETSC_SUCCESS);
}
