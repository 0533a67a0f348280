/*
   Lines: how the maps along one direction serve in more dimensions.

   The weights of a map are products over the directions. Particles that differ in their first coordinate alone share
   all other factors. For these particles a gather first contracts rows of nodes to one line of nodes, and a map along
   one direction goes on from there; a scatter does the same in the opposite order. A stencil has at most MPM_MOST_ROWS
   rows.
*/
#pragma once
#include "scheme/kernels.h"

#define MPM_MOST_ROWS (MPM_MOST_NODES * MPM_MOST_NODES) /* in three dimensions */
#define MPM_MOST_LINES 3                                /* that are spread at once */

/* Not collective. The first of the kinds of operation that have the weights of a kind. */
MpmOpKind MpmLineKind(const MpmBasis *basis, MpmOpKind kind);

/*
   Runs that are alike: particles of a block that have the same first node, whose places in their cells are those of the
   run before, a node further on. So a row has few different weights: weight[d * length + i] is that of node d of the
   i-th particle of a run.

   Not collective. MpmRunsFind finds the runs of a block, of length particles each: whole ones are particles [begin,
   end), and at both ends of the block may be parts of runs. It finds none where not all runs are alike, for a basis of
   1 node or of more than MPM_MOST_RUN_NODES, and where functions differ near walls. MpmRunsWeights finds the weights of
   a kind of operation. MpmRunsGather and MpmRunsSpread are the maps that have these weights. A gather adds a[t] times
   its sums to each of n particle fields, at most MPM_MOST_TARGETS.
*/
#define MPM_LONGEST_RUN 4
#define MPM_MOST_RUN_NODES 4 /* of a particle along one direction; each number has loops of its own */
#define MPM_MOST_TARGETS 3
typedef struct {
  PetscInt begin, end, length;
} MpmRuns;
PetscBool MpmRunsFind(const MpmBasis *basis, const MpmBlock *block, MpmRuns *runs);
void      MpmRunsWeights(const MpmBasis *basis, MpmOpKind kind, const MpmBlock *block, const MpmRuns *runs,
                         PetscReal weight[]);
void MpmRunsGather(const MpmBlock *block, const MpmRuns *runs, PetscInt nodes, const PetscReal weight[], PetscInt n,
                   const PetscReal a[], PetscReal *const particle[], const PetscReal node[]);
void MpmRunsSpread(const MpmBlock *block, const MpmRuns *runs, PetscInt nodes, const PetscReal weight[], PetscReal a,
                   const PetscReal particle[], PetscReal node[]);

/*
   Rows of n nodes begin at node + offset[r]. MpmLinesGather sets line[i] = sum_r weight[r] row_r[i]. MpmLinesSpread
   adds the sum over lines l of weight[l][r] line[l][i] to row_r[i].

   Not collective. There are nodes^(dim - 1) rows, and at most MPM_MOST_LINES lines.
*/
void MpmLinesGather(PetscInt rows, const PetscInt offset[], const PetscReal weight[], PetscInt n,
                    const PetscReal node[], PetscReal line[]);
void MpmLinesSpread(PetscInt rows, const PetscInt offset[], PetscInt lines, const PetscReal weight[][MPM_MOST_ROWS],
                    const PetscReal *const line[], PetscInt n, PetscReal node[]);
