/* A pass on its way through the particles: what march_pass.c, which orders the blocks, and march_block.c share. */
#pragma once
#include "march/march_nodes.h"

/* What the passes of a group share: the arrays of particles and nodes, and how many particles a block has. */
typedef struct {
  const MpmMarch       *march;
  const MpmNodeVectors *nodes;
  PetscInt             *cell, block;
  PetscReal            *xi, *particle[MPM_MAX_FIELDS], *weight[MPM_PROPERTIES];
  PetscReal            *node[MPM_MAX_FIELDS], *spare[MPM_MAX_FIELDS], *mass;
} MpmMarchArrays;

/* Where the particles of a block are, and room for their places when they have moved. */
typedef struct {
  MpmBlock  block;
  PetscReal xi[MPM_BLOCK];
} MpmPlaced;

/*S
   MpmStage - one pass of a group, its arrays resolved so that the block loop follows pointers only.

   Particles [first, next) have been through it, nodes [lo, hi) are complete, and nodes [zeroed[0], zeroed[1]) are ready
   to be summed to. It reads node[], writes sum[] and leaves behind after[], by node field. Index 0 of whole, part and
   placed: before DRIFT, 1: after it.
S*/
typedef struct {
  const MpmPass        *pass;
  const MpmMarchArrays *arrays;
  PetscBool             moving, sample;
  PetscInt              whole[2];
  PetscReal             part[2];
  PetscReal            *node[MPM_MAX_FIELDS], *sum[MPM_MAX_FIELDS], *after[MPM_MAX_FIELDS], *squares;
  PetscInt              first, next, lo, hi, zeroed[2];
  MpmPlaced            *placed;
  MpmNodesDone          done[MPM_MAX_PASS_OPS];
} MpmStage;

/* Not collective. How many particles a block has: where cells are alike, those of whole cells. */
PetscInt MpmMarchBlockSize(const MpmParticles *particles);

/* Not collective. Where cells are alike, the places of the first block are those of all: finds them. */
void MpmStagePlace(MpmStage *stage);

/* Not collective. Takes the n particles from begin on, the beginning of a block, through the pass. */
void MpmStageRunBlock(const MpmStage *stage, PetscInt begin, PetscInt n);

/* Not collective. The least and the largest node that particle p may see in this pass. */
PetscInt MpmStageLeastNode(const MpmStage *stage, PetscInt p);
PetscInt MpmStageLargestNode(const MpmStage *stage, PetscInt p);
