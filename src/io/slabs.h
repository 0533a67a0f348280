/* Slabs: an HDF5 file of one-dimensional arrays, each the ranks' parts one after another. */
#pragma once
#include <mpmstab/compat.h>
#include <hdf5.h>

/*S
   MpmSlabs - an open file. HDF5's own complaints are kept silent; failed says that something went wrong on this rank,
   and whoever works with the file carries on, since the others do, until MpmSlabsClose asks all of them.
S*/
typedef struct {
  MPI_Comm  comm;
  hid_t     file, transfer;
  PetscBool failed;
} MpmSlabs;

/* Collective. Opens a new file, with reserved bytes before the HDF5 part, or one to read. */
PetscErrorCode MpmSlabsCreate(MPI_Comm comm, const char path[], PetscInt reserved, MpmSlabs *slabs);
PetscErrorCode MpmSlabsOpen(MPI_Comm comm, const char path[], MpmSlabs *slabs);

/* Collective. failed: whether anything went wrong on any rank so far. */
PetscErrorCode MpmSlabsFailed(const MpmSlabs *slabs, PetscBool *failed);
PetscErrorCode MpmSlabsClose(MpmSlabs *slabs, PetscBool *failed);

/* Collective. Writes a new array of which this rank has n numbers. */
PetscErrorCode MpmSlabsWrite(MpmSlabs *slabs, const char name[], hid_t type, PetscInt64 n, const void *part);

/* Collective. How long an array is; -1 when there is none of this name, or of another class than type,
   or longer than the file. */
PetscErrorCode MpmSlabsLength(MpmSlabs *slabs, const char name[], hid_t type, PetscInt64 *length);

/* Collective. Reads n numbers from begin on; the array must be that long. */
PetscErrorCode MpmSlabsRead(MpmSlabs *slabs, const char name[], hid_t type, PetscInt64 begin, PetscInt64 n, void *part);
