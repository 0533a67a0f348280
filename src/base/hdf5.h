/*
   HDF5: the only functions that call it for files. The first rank writes what the others send to it in pieces, so that
   no rank waits for one whose write has failed, as on a full disk. To read, each rank opens the file by itself.
*/
#pragma once
#include <mpmstab/compat.h>
#include <hdf5.h>

/*S
   MpmHdf5 - an open file.

   file: -1 on ranks that do not have it open. failed: something went wrong on this rank, and why describes the first
   failure; HDF5 prints nothing of its own. The caller carries on after a failure, since the other ranks do, until
   MpmHdf5Failed or MpmHdf5Close tells all of them.
S*/
typedef struct {
  MPI_Comm  comm;
  hid_t     file;
  PetscBool failed;
  char      why[128];

  int        descriptor; /* of a file that is written, else -1 */
  PetscInt64 reserved;   /* bytes from its beginning that the disk has granted */
} MpmHdf5;

/* Collective. Opens an empty file that exists, to write. The HDF5 part begins after reserved bytes. */
PetscErrorCode MpmHdf5Create(MPI_Comm comm, const char path[], PetscInt reserved, MpmHdf5 *file);

/* Not collective. Whether a file is HDF5. */
PetscErrorCode MpmHdf5Is(const char path[], PetscBool *is);

/* Collective. Opens a file to read. */
PetscErrorCode MpmHdf5Open(MPI_Comm comm, const char path[], MpmHdf5 *file);

/*
   Collective. MpmHdf5Failed hands what has been written to the system. failed: whether anything went wrong so far on
   any rank; file->why then has the reason.
*/
PetscErrorCode MpmHdf5Failed(MpmHdf5 *file, PetscBool *failed);
PetscErrorCode MpmHdf5Close(MpmHdf5 *file, PetscBool *failed);

/*
   MpmHdf5Write - writes a new array that holds the ranks' rows one after another. It makes the groups in the array's
   name.

   Collective. This rank has rows of columns numbers. One column makes an array of one dimension.
*/
PetscErrorCode MpmHdf5Write(MpmHdf5 *file, const char name[], hid_t type, PetscInt64 rows, PetscInt columns,
                            const void *part);

/*
   Collective. The same for an array of 1 + n dimensions, where a row is an array of n dimensions itself.
*/
PetscErrorCode MpmHdf5WriteRows(MpmHdf5 *file, const char name[], hid_t type, PetscInt64 rows, PetscInt n,
                                const PetscInt row[], const void *part);

/* Collective. Write an attribute of the root ("/"), or of a group or array that has been written. */
void MpmHdf5WriteText(MpmHdf5 *file, const char object[], const char name[], const char text[]);
void MpmHdf5WriteReal(MpmHdf5 *file, const char object[], const char name[], PetscReal value);
void MpmHdf5WriteInteger(MpmHdf5 *file, const char object[], const char name[], PetscInt value);

/* Not collective. Returns whether a file that this rank has open contains such a group or array. */
PetscBool MpmHdf5Has(const MpmHdf5 *file, const char name[]);

/*
   MpmHdf5ReadAttribute - reads one value as the memory type given, a whole number also as a real one. It refuses an
   attribute of another class, an array, and a text of variable length, which would not fit.

   Not collective. Returns whether the value has been read.
*/
PetscBool MpmHdf5ReadAttribute(const MpmHdf5 *file, const char object[], const char name[], hid_t memory, void *value);

/*
   MpmHdf5Length - finds the length of an array of one dimension on the first rank. It is -1 when there is no array of
   this name, when its numbers are of another class than type, or when it claims to be longer than the file.

   Collective.
*/
PetscErrorCode MpmHdf5Length(MpmHdf5 *file, const char name[], hid_t type, PetscInt64 *length);

/* Not collective. Reads n numbers of such an array, starting at begin. If there are fewer, the file has failed. */
void MpmHdf5Read(MpmHdf5 *file, const char name[], hid_t type, PetscInt64 begin, PetscInt64 n, void *part);

/*
   MpmHdf5Array - finds the extents of an array of numbers, whole or real, of at most room dimensions. Returns whether
   there is one that does not claim more than the file can hold.
   MpmHdf5ReadArray - reads all its numbers as doubles. If that fails, the file has failed.
   MpmHdf5ReadText - reads the text of an attribute, of fixed or variable length. Returns whether it has been read.
   MpmHdf5Group - the name of the i-th member of the root, if it is a group; "" if it is none. Returns whether there is
   an i-th member.

   Not collective.
*/
PetscBool MpmHdf5Array(const MpmHdf5 *file, const char name[], int room, int *dims, PetscInt64 shape[]);
void      MpmHdf5ReadArray(MpmHdf5 *file, const char name[], PetscReal numbers[]);
PetscBool MpmHdf5ReadText(const MpmHdf5 *file, const char object[], const char name[], size_t room, char text[]);
PetscBool MpmHdf5Group(const MpmHdf5 *file, PetscInt i, size_t room, char name[]);
