/* A sparse matrix on the first rank, between a file and the ranks. */
#pragma once
#include "io/arrays.h"
#include "probe/hooked.h"
#include <petscmat.h>

#define MPM_MATRIX_ENTRIES 3e8 /* the most that a file may have */

/*S
   MpmEntries - the entries of a matrix that is read, in any order, with room for a diagonal; those of one place are added.
   Rows and columns count from 0. steps: that the matrix covers; 0: the file does not say. hooked: what the hook says of it.
S*/
typedef struct {
  PetscInt64 rows, columns, n, steps;
  PetscInt  *row, *column;
  PetscReal *value;
  MpmHooked  hooked;
} MpmEntries;

/*S
   MpmCsr - a square matrix row by row: those of row i are begin[i] to begin[i + 1], by their columns. The first rank has
   all rows, the others none.
S*/
typedef struct {
  Mat            *whole;
  PetscInt        order;
  const PetscInt *begin, *column;
  PetscReal      *value;
} MpmCsr;

/*
   Not collective. MpmEntriesRoom - makes room, or says why a file with so many may not be; MpmEntriesCheck - says what
   is wrong with entries that are no operator, in why ("": nothing).
*/
PetscErrorCode MpmEntriesRoom(PetscReal rows, PetscReal columns, PetscReal n, MpmEntries *entries,
                              char why[MPM_WHY_TEXT]);
void           MpmEntriesCheck(const MpmEntries *entries, char why[MPM_WHY_TEXT]);
/* Not collective. Takes entries to the scales of fields that the hook says, as those of a code that mpmstab itself probes. */
void MpmEntriesToScales(MpmEntries *entries);

PetscErrorCode MpmEntriesFree(MpmEntries *entries);

/* Collective. The matrix of the first rank's entries. Each row has one on the diagonal, if only a 0, for solvers. */
PetscErrorCode MpmMatrixOfEntries(MPI_Comm comm, MpmEntries *entries, Mat *A);

/* Collective. Brings the rows of an AIJ matrix, times 2^exponent, to the first rank. */
PetscErrorCode MpmCsrGather(Mat A, PetscInt exponent, MpmCsr *csr);
PetscErrorCode MpmCsrFree(MpmCsr *csr);
