/*
   Unknowns that are only integrated: numbers of a particle that change by what others give to them, and that give nothing
   back. Places at rest, plastic memory and strain that is kept for output are such. They hold an eigenvalue of their own,
   mostly 1, and add none to the others.
*/
#pragma once
#include "probe/colours.h"
#include "probe/lattice.h"

/*S
   MpmUnread - apart[c]: whether number c of a particle is set apart; n: how many are not, which keep their order; factor: the
   largest abs of the eigenvalues that are set apart, 0 without any.
S*/
typedef struct {
  PetscInt   width, n;
  PetscBool *apart;
  PetscReal  factor;
} MpmUnread;

/*
   MpmUnreadOfBlocks, MpmUnreadOfMatrix - find them by the strongly connected sets of the pattern. A number that is alone in
   its set, and that no particle but its own feels, has an eigenvalue by itself, its diagonal. noise: entries up to it are
   none. All are kept when a diagonal is above 1 + noise.

   Collective for the matrix.
*/
PetscErrorCode MpmUnreadOfBlocks(const MpmBlocks *blocks, PetscInt width, PetscReal noise, MpmUnread *unread);
PetscErrorCode MpmUnreadOfMatrix(Mat A, PetscInt width, PetscReal noise, MpmUnread *unread);
PetscErrorCode MpmUnreadDestroy(MpmUnread *unread);

/* The rows and columns of a matrix, or of blocks, that are not set apart. Collective for the matrix. */
PetscErrorCode MpmUnreadReduce(const MpmUnread *unread, Mat A, Mat *reduced);
PetscErrorCode MpmUnreadReduceBlocks(const MpmUnread *unread, const MpmBlocks *blocks, MpmBlocks *reduced);
