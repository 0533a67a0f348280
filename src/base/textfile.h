/*
   Files that appear whole or not at all: a file is written under a temporary name, PATH.HOST-PID-RANDOM.part, and gets
   its own name when it is finished. The temporary name belongs to this process alone, so that no other program writes
   to the file or removes it; the file is locked (flock) until then.
*/
#pragma once
#include <mpmstab/compat.h>
#include <stdio.h>

/*
   MpmFileCheck - refuses a file that cannot be written, before the work is done. It also removes the unfinished files
   that killed programs have left beside it.

   Collective. name: the option that named the file.
*/
PetscErrorCode MpmFileCheck(const char name[], const char path[]);

/*
   MpmFileCreate, MpmFileFinish - create a file under a temporary name, and give it its own name. Only the first rank
   has it open.

   Collective. part: the temporary name, on all ranks. error: the errno of the first rank, on all ranks.
*/
PetscErrorCode MpmFileCreate(MPI_Comm comm, const char path[], char part[PETSC_MAX_PATH_LEN], int *error);
PetscErrorCode MpmFileFinish(MPI_Comm comm, const char path[], const char part[], int *error);

/*
   Not collective; only the first rank writes files. MpmUnfinishedDrop removes one file, MpmUnfinishedRemove all files
   that this process has not finished. The second function may be called from a signal handler.
*/
void MpmUnfinishedDrop(const char part[]);
void MpmUnfinishedRemove(void);

/*
   MpmFileOpen - opens a file to read. MpmFileReason - what its error means.

   Not collective. Returns NULL, and error as an errno or -1, where there is no such file, or where it is a folder, a
   pipe or a device: what reads a file of a user must neither wait nor read without end.
*/
FILE       *MpmFileOpen(const char path[], int *error);
const char *MpmFileReason(int error);

/* A text file that rank 0 writes. On other ranks stream is NULL. */
typedef struct {
  FILE *stream;
  char  path[PETSC_MAX_PATH_LEN], part[PETSC_MAX_PATH_LEN];
} MpmTextFile;

/*
   Not collective. Writes a comma and a value; a value that is not finite makes an empty cell. The rank must have a
   stream.
*/
void MpmTextFileCell(const MpmTextFile *file, PetscReal value);

/* Collective. MpmTextFileOpen refuses a file that cannot be created, MpmTextFileClose one that could not be written. */
PetscErrorCode MpmTextFileOpen(const char path[], MpmTextFile *file);
PetscErrorCode MpmTextFileClose(MpmTextFile *file);

/* Collective. Gives rank 0 all that has been written so far, and NULL to other ranks. Free it with PetscFree. */
PetscErrorCode MpmTextFileSoFar(const MpmTextFile *file, char **text);

/* Not collective. Removes an unfinished file that is not to be kept. */
void MpmTextFileDrop(MpmTextFile *file);

/*
   MpmTextFileAbandon - closes all text files without a word, when the program ends by an error. PETSc flushes them at
   its end and would complain of a full disk once more.

   Not collective. Part of MpmFinalize.
*/
void MpmTextFileAbandon(void);

/*
   MpmFileIsSame - whether two names are of one file: there is one file with both names, by links of any kind, or they
   are the same name in the same folder, where there may be no file yet.

   Not collective.
*/
PetscBool MpmFileIsSame(const char a[], const char b[]);

/*
   MpmFileIsHere - whether a file is in the current folder, or in one below it, and no part of its name from there on is
   hidden (begins with a point). A folder that does not exist is none in which a file can be.
*/
PetscBool MpmFileIsHere(const char path[]);

/* Whether a name has one of the endings of a text such as ".npz, .h5 or .hdf5". */
PetscBool MpmFileHasEnding(const char path[], const char endings[]);
