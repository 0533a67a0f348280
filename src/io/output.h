/* Output: files that appear whole or not at all, and the fields of a run as HDF5 with XDMF beside it. */
#pragma once
#include <mpmstab/march.h>
#include <stdio.h>

/*
   MpmFileCheck - refuses a file that cannot be written, before the work is done.

   Collective. name is the option that named the file.
*/
PetscErrorCode MpmFileCheck(const char name[], const char path[]);

/*
   MpmFileReserve - refuses when there is no room for a file of so many bytes, before HDF5 and MPI find out and say it
   in
   their own words.

   Collective. what begins the message; part is removed again.
*/
PetscErrorCode MpmFileReserve(MPI_Comm comm, const char what[], const char part[], PetscInt64 bytes);

/* A text file of rank 0: written aside as PATH.part, then renamed. On other ranks stream is NULL. */
typedef struct {
  FILE *stream;
  char  path[PETSC_MAX_PATH_LEN], part[PETSC_MAX_PATH_LEN];
} MpmTextFile;

/* Not collective. A comma and a value; a value that is not finite is an empty cell. The stream must be there. */
void MpmTextFileCell(const MpmTextFile *file, PetscReal value);

/* Collective. MpmTextFileClose refuses when anything was not written. */
PetscErrorCode MpmTextFileOpen(const char path[], MpmTextFile *file);
PetscErrorCode MpmTextFileClose(MpmTextFile *file);

/* Collective. All that has been written so far, on the rank that writes; NULL elsewhere. Free with PetscFree. */
PetscErrorCode MpmTextFileSoFar(const MpmTextFile *file, char **text);

/* Not collective. Removes a file that is not to be. */
void MpmTextFileDrop(MpmTextFile *file);

/*S
   MpmOutput - the HDF5 file of a run.

   Groups /step_NNNNNNNNNN with attributes step and time hold particles/coordinates (n x 3, in units of
   length, wrapped into the domain), particles/FIELD (n) in the order of global ids and nodes/FIELD (cells),
   the P2G of each particle field. Values beyond the range of doubles are infinite. The scene and the version
   are attributes of the root.
*/
typedef struct MpmOutput_ MpmOutput;

/* Collective. */
PetscErrorCode MpmOutputCreate(const MpmMarch *march, MpmOutput **output);
PetscErrorCode MpmOutputStep(MpmOutput *output, MpmMarch *march);

/* Collective. Writes PATH.xmf (PATH without .h5) and gives both files their names, or, not keep, removes both. */
PetscErrorCode MpmOutputDestroy(PetscBool keep, MpmOutput **output);
