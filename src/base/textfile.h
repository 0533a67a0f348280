/* Files that appear whole or not at all: they are written aside and get their name when they are finished. */
#pragma once
#include <mpmstab/compat.h>
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
