/*
   HDF5: the one place that calls it for files. The first rank writes what the others send to it in pieces, so that no
   rank waits for one whose write has failed, as on a full disk; to read, each rank opens the file by itself.
*/
#pragma once
#include <mpmstab/compat.h>
#include <hdf5.h>

/*S
   MpmHdf5 - an open file.

   file: -1 on ranks that have it not open. failed: something went wrong on this rank, and why says what first; HDF5's
   own complaints are silent. Whoever works with the file carries on, since the other ranks do, until MpmHdf5Failed or
   MpmHdf5Close asks all of them.
S*/
typedef struct {
  MPI_Comm  comm;
  hid_t     file;
  PetscBool failed;
  char      why[128];

  int        descriptor; /* of a file that is written: -1 else */
  PetscInt64 reserved;   /* bytes from its begin that the disk has granted */
} MpmHdf5;

/* Collective. Writes to a file that is there and empty; the HDF5 part begins after reserved bytes. */
PetscErrorCode MpmHdf5Create(MPI_Comm comm, const char path[], PetscInt reserved, MpmHdf5 *file);

/* Collective. Opens a file to read. */
PetscErrorCode MpmHdf5Open(MPI_Comm comm, const char path[], MpmHdf5 *file);

/* Collective. Hands what has been written to the system; failed, why: whether anything went wrong so far, and what. */
PetscErrorCode MpmHdf5Failed(MpmHdf5 *file, PetscBool *failed);
PetscErrorCode MpmHdf5Close(MpmHdf5 *file, PetscBool *failed);

/*
   MpmHdf5Write - writes a new array, the ranks' rows one after another; groups in its name are made.

   Collective. This rank has rows of columns numbers. One column makes an array of one dimension.
*/
PetscErrorCode MpmHdf5Write(MpmHdf5 *file, const char name[], hid_t type, PetscInt64 rows, PetscInt columns,
                            const void *part);

/* Collective. Writes an attribute of the root ("/"), or of a group or array that has been written. */
PetscErrorCode MpmHdf5WriteText(MpmHdf5 *file, const char object[], const char name[], const char text[]);
PetscErrorCode MpmHdf5WriteReal(MpmHdf5 *file, const char object[], const char name[], PetscReal value);
PetscErrorCode MpmHdf5WriteInteger(MpmHdf5 *file, const char object[], const char name[], PetscInt value);

/* Not collective. Whether there is such a group or array in a file that this rank has open. */
PetscBool MpmHdf5Has(const MpmHdf5 *file, const char name[]);

/*
   MpmHdf5ReadAttribute - reads one value, of the memory type given; another class than memory's, an array or a text of
   variable length is refused, as it would not fit.

   Not collective. Returns whether it has been read.
*/
PetscBool MpmHdf5ReadAttribute(const MpmHdf5 *file, const char object[], const char name[], hid_t memory, void *value);

/*
   MpmHdf5Length - how long an array of one dimension is, as the first rank finds; -1 when there is none of this name,
   when its numbers are of another class than type, or when it claims to be longer than the file.

   Collective.
*/
PetscErrorCode MpmHdf5Length(MpmHdf5 *file, const char name[], hid_t type, PetscInt64 *length);

/* Not collective. Reads n numbers of such an array from begin on; fewer make the file failed. */
PetscErrorCode MpmHdf5Read(MpmHdf5 *file, const char name[], hid_t type, PetscInt64 begin, PetscInt64 n, void *part);
