/*
   The operator of a code as it was probed: blocks of cells that are alike, or the matrix of all particles. What is done
   with operators does not ask which of the two it is.

   Some unknowns are only integrated: numbers of a particle that change by what others give to them, and that give
   nothing back. Places at rest, plastic memory and strain that is kept for output are such. They hold an eigenvalue of
   their own, mostly 1, and add none to the others.
*/
#pragma once
#include "probe/columns.h"
#include "probe/lattice.h"

/*S
   MpmProbed - A is NULL where it is blocks.
S*/
typedef struct {
  MpmBlocks blocks;
  Mat       A;
} MpmProbed;

/*S
   MpmUnread - apart[c]: whether number c of a particle is set apart; n: how many are not, which keep their order;
   factor: the largest abs of the eigenvalues that are set apart, 0 without any.
S*/
typedef struct {
  PetscInt   width, n;
  PetscBool *apart;
  PetscReal  factor;
} MpmUnread;

/*
   MpmUnreadFind - finds them by the strongly connected sets of the pattern. A number that is alone in its set, and that
   no particle but its own feels, has an eigenvalue by itself, its diagonal. noise: entries up to it are none. All are
   kept when a diagonal is above 1 + noise.

   MpmProbedReduce - the rows and columns that are not set apart. MpmProbedCombine - the sum of n operators, each times
   its weight. Free both with MpmProbedFree.

   MpmProbedDistance - a norm of the difference: the Euclidean one of matrices; of blocks the largest Frobenius norm at
   some phases; of shells what a few random vectors show of it.

   Collective.
*/
PetscErrorCode MpmUnreadFind(const MpmProbed *probed, PetscInt width, PetscReal noise, MpmUnread *unread);
PetscErrorCode MpmUnreadDestroy(MpmUnread *unread);
PetscErrorCode MpmProbedReduce(const MpmProbed *probed, const MpmUnread *unread, MpmProbed *reduced);
PetscErrorCode MpmProbedCombine(PetscInt n, const MpmProbed each[], const PetscReal weight[], MpmProbed *sum);
PetscErrorCode MpmProbedDistance(const MpmProbed *one, const MpmProbed *other, PetscReal *distance);
PetscErrorCode MpmProbedFree(MpmProbed *probed);

/*
   MpmProbedCompare - compares a response with what the operator gives: of blocks in all cells that no edge can have
                      touched.

   Collective. amount, response: as MpmProbeRandom has them. apart[c]: whether number c of a particle is left out.
   differ: the largest difference, over the largest number of the response; NaN where there is nothing to compare. most:
   its unknown, or MPM_NONE.
*/
PetscErrorCode MpmProbedCompare(const MpmProbed *probed, const MpmProbe *probe, const MpmProbeLattice *lattice,
                                const PetscReal amount[], const PetscReal response[], const PetscBool apart[],
                                PetscReal *differ, PetscInt64 *most);
