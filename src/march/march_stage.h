/* A pass that goes through the particles. march_pass.c orders its blocks, and march_block.c runs them. */
#pragma once
#include "march/march_nodes.h"

/* Arrays of particles and nodes, and the number of particles in a block, for all passes of a group. */
typedef struct {
  const MpmMarch       *march;
  const MpmNodeVectors *nodes;
  PetscInt             *cell, block;
  PetscInt64           *id; /* of particles that move each by itself */
  PetscReal            *xi, *particle[MPM_MAX_FIELDS], *weight[MPM_PROPERTIES];
  PetscReal            *node[MPM_MAX_FIELDS], *spare[MPM_MAX_FIELDS], *mass;
} MpmMarchArrays;

/* The places of the particles of a block, and memory for them when they have moved. */
typedef struct {
  MpmBlock  block;
  PetscReal xi[MPM_BLOCK];
} MpmPlaced;

/*S
   MpmStage - one pass of a group, and how far it has gone. Its arrays are pointers, so that the loop over blocks looks
   nothing up.

   moving        - all particles move by the drift
   step          - that of the places before DRIFT
   sample        - sums of squares are wanted
   whole, part   - the drift since rest, before DRIFT (index 0) and after it (index 1)
   node, sum     - node[f]: the array of node field f that the pass reads; sum[f]: the one that it sums to
   after         - after[f]: the array that holds node field f when the pass is done
   first, next   - particles [first, next) have been through the pass, and so have
   last          - particles from last on, which are at the right end of a rank's part
   sent          - the sums at shared nodes are on their way
   lo, hi        - nodes [lo, hi) are complete
   zeroed        - nodes [zeroed[0], zeroed[1]) and from zeroed[2] on are 0 or have sums
   placed        - the places of the first block, before and after DRIFT, where cells are alike
   done          - how far each node operation has been done
S*/
typedef struct {
  const MpmPass        *pass;
  const MpmMarchArrays *arrays;
  PetscBool             moving, sample, sent;
  PetscInt64            step;
  PetscInt              whole[2];
  PetscReal             part[2];
  PetscReal            *node[MPM_MAX_FIELDS], *sum[MPM_MAX_FIELDS], *after[MPM_MAX_FIELDS], *squares;
  PetscInt              first, next, last, lo, hi, zeroed[3];
  MpmPlaced            *placed;
  MpmNodesDone          done[MPM_MAX_PASS_OPS];
} MpmStage;

/* Not collective. The number of particles in a block. Where cells are alike it is that of a number of whole cells. */
PetscInt MpmMarchBlockSize(const MpmParticles *particles);

/* Not collective. Where cells are alike, all blocks lie in their cells as the first one does: finds its places. */
void MpmStagePlace(MpmStage *stage);

/* Not collective. Takes a block, the n particles from begin on, through the pass. */
void MpmStageRunBlock(const MpmStage *stage, PetscInt begin, PetscInt n);

/* Not collective. The least and the largest node that particle p may have a weight at in this pass. */
PetscInt MpmStageLeastNode(const MpmStage *stage, PetscInt p);
PetscInt MpmStageLargestNode(const MpmStage *stage, PetscInt p);
