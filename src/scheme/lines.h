/*
   Lines: how the maps along one direction serve in more dimensions.

   The weights of a map are products over the directions. Particles that differ in their first coordinate alone share
   all other factors. For these particles a gather first contracts rows of nodes to one line of nodes, and a kernel of
   the basis goes on from there; a scatter does the same in the opposite order. A stencil has at most MPM_MOST_ROWS rows.
*/
#pragma once
#include "scheme/kernels.h"

#define MPM_MOST_NODES 4                                /* of a particle along one direction */
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
   Rows of n nodes begin at node + offset[r]. MpmLinesGather sets line[i] = sum_r weight[r] row_r[i]. MpmLinesSpread adds
   the sum over lines l of weight[l][r] line[l][i] to row_r[i].

   Not collective. There are nodes^(dim - 1) rows, and at most MPM_MOST_LINES lines.
*/
void MpmLinesGather(PetscInt rows, const PetscInt offset[], const PetscReal weight[], PetscInt n,
                    const PetscReal node[], PetscReal line[]);
void MpmLinesSpread(PetscInt rows, const PetscInt offset[], PetscInt lines, const PetscReal weight[][MPM_MOST_ROWS],
                    const PetscReal *const line[], PetscInt n, PetscReal node[]);
