/* Text files that appear whole or not at all: they are written aside (unfinished.h) and get their name when finished. */
#pragma once
#include <mpmstab/compat.h>
#include <stdio.h>

/*
   MpmFileCheck - refuses a file that cannot be written, before the work is done, and removes what programs that were
   killed have left of it.

   Collective. name is the option that named the file.
*/
PetscErrorCode MpmFileCheck(const char name[], const char path[]);

/*
   MpmFileCreate, MpmFileFinish - make a file aside, and give it its name; the first rank alone holds it.

   Collective. part is its name aside, on all ranks. error is the first rank's errno, on all ranks.
*/
PetscErrorCode MpmFileCreate(MPI_Comm comm, const char path[], char part[PETSC_MAX_PATH_LEN], int *error);
PetscErrorCode MpmFileFinish(MPI_Comm comm, const char path[], const char part[], int *error);

/* A text file that rank 0 writes. On other ranks stream is NULL. */
typedef struct {
  FILE *stream;
  char  path[PETSC_MAX_PATH_LEN], part[PETSC_MAX_PATH_LEN];
} MpmTextFile;

/* Not collective. Writes a comma and a value; a value that is not finite is an empty cell. The stream must be there. */
void MpmTextFileCell(const MpmTextFile *file, PetscReal value);

/* Collective. MpmTextFileClose refuses when anything could not be written. */
PetscErrorCode MpmTextFileOpen(const char path[], MpmTextFile *file);
PetscErrorCode MpmTextFileClose(MpmTextFile *file);

/* Collective. All that has been written so far, on the rank that writes; NULL elsewhere. Free with PetscFree. */
PetscErrorCode MpmTextFileSoFar(const MpmTextFile *file, char **text);

/* Not collective. Removes a file that is not to be kept. */
void MpmTextFileDrop(MpmTextFile *file);
