/*
   Lines: how the maps along one direction serve in more dimensions.

   The weights of a map are products over the directions. Particles that differ in their first coordinate alone share
   all other factors. For these particles a gather first contracts rows of nodes to one line of nodes, and a kernel of
   the basis goes on from there; a scatter does the same in the opposite order. A stencil has at most MPM_MOST_ROWS rows.
*/
#pragma once
#include "scheme/kernels.h"

#define MPM_MOST_ROWS (MPM_MOST_NODES * MPM_MOST_NODES) /* in three dimensions */
#define MPM_MOST_LINES 3                                /* that are spread at once */

/*
   MpmLineWeights - the weights of the nodes of one particle at xi in its cell along one direction, for a kind of
   operation that goes to nodes. There are basis->nodes of them. wall is counted from the cell (MpmDirectionWalls).

   Not collective. Returns the first of these nodes, counted from the cell's left node.
*/
PetscInt MpmLineWeights(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal half_width,
                        const PetscInt wall[2], PetscReal weight[]);

/*
   Not collective. The kind of operation to nodes that has the weights of a kind, and the first of the kinds that have
   the same kernel.
*/
MpmOpKind MpmLineKind(const MpmBasis *basis, MpmOpKind kind);
MpmOpKind MpmLineFirstAlike(const MpmBasis *basis, MpmOpKind kind);

/*
   Runs that are alike: the particles of each run of a block have the same places in their cells as those of the next one.
   So a row has few different weights: weight[d * block->length + i] is that of node d of the i-th particle of a run.

   Not collective. MpmRunsFind says whether the runs of a block are alike, those at its ends too, which may be parts of
   runs. It finds none for a basis of 1 node or of more than MPM_MOST_RUN_NODES, whose own kernels are then used.
   MpmRunsWeights finds the weights of a kind of operation that goes to nodes. MpmRunsGather and MpmRunsSpread are the
   kernels that have these weights: MpmKernel says what they add. A gather adds a[t] times its sums to each of n particle
   fields, at most MPM_MOST_TARGETS.
*/
#define MPM_LONGEST_RUN 4
#define MPM_MOST_RUN_NODES 4 /* of a particle along one direction; each number has loops of its own */
#define MPM_MOST_TARGETS 3
PetscBool MpmRunsFind(const MpmBasis *basis, const MpmBlock *block);
void      MpmRunsWeights(const MpmBasis *basis, MpmOpKind kind, const MpmBlock *block, PetscReal weight[]);
void MpmRunsGather(const MpmBlock *block, PetscInt nodes, const PetscReal weight[], PetscInt n, const PetscReal a[],
                   PetscReal *const particle[], const PetscReal node[]);
void MpmRunsSpread(const MpmBlock *block, PetscInt nodes, const PetscReal weight[], PetscReal a,
                   const PetscReal particle[], PetscReal node[]);

/*
   Rows of n nodes begin at node + offset[r]. MpmLinesGather sets line[i] = sum_r weight[r] row_r[i]. MpmLinesSpread adds
   the sum over lines l of weight[l][r] line[l][i] to row_r[i].

   Not collective. There are nodes^(dim - 1) rows, and at most MPM_MOST_LINES lines.
*/
void MpmLinesGather(PetscInt rows, const PetscInt offset[], const PetscReal weight[], PetscInt n,
                    const PetscReal node[], PetscReal line[]);
void MpmLinesSpread(PetscInt rows, const PetscInt offset[], PetscInt lines, const PetscReal weight[][MPM_MOST_ROWS],
                    const PetscReal *const line[], PetscInt n, PetscReal node[]);
