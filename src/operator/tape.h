/*
   Tape: a linear map of particle data as a list of lines on registers, each with numbers of its own at every particle or
   node. The product takes the lines in order, and the transposed product takes their transposes in the opposite order.
*/
#pragma once
#include <mpmstab/compat.h>
#include <petscmat.h>

#define MPM_MAX_SLOTS 160

/*S
   MpmTapeWork - the memory in which tapes are played: a vector for each of so many registers of particles, and after them
   for those of nodes. Several tapes of the same sizes share it.

   state, nstate - state[f]: the register that holds field f of a state
   slot, scratch - the registers, and two vectors each for what is multiplied on particles and on nodes
   users         - how many tapes, and others, refer to it
S*/
typedef struct {
  MPI_Comm comm;
  PetscInt particles, nodes, nparticles, nnodes, nstate, users;
  PetscInt state[MPM_MAX_SLOTS];
  Vec      slot[MPM_MAX_SLOTS], scratch[2][2];
} MpmTapeWork;

/*S
   MpmTapeLine - register dst += factor left * map (right * register src), where * is the product number by number.

   map         - particles x nodes, NULL: the identity. With to_nodes its transpose is meant.
   left, right - NULL: ones
   multiplies  - the line is register dst = factor left * register dst instead
S*/
typedef struct {
  PetscInt  dst, src;
  Mat       map;
  PetscBool to_nodes, multiplies;
  Vec       left, right;
  PetscReal factor;
} MpmTapeLine;

typedef struct {
  MpmTapeWork *work;
  PetscInt     n, room;
  MpmTapeLine *line;
} MpmTape;

/*
   MpmTapeWorkCreate - the memory for a number of registers of particles and of nodes, of which this rank has so many.
   state[f], f < nstate: the register of field f of a state. Unknown f of particle p has the number nstate p + f.

   Collective. It is freed with the last tape that uses it, and MpmTapeWorkDestroy takes away the caller's reference.
*/
PetscErrorCode MpmTapeWorkCreate(MPI_Comm comm, PetscInt particles, PetscInt nodes, PetscInt nparticles,
                                 PetscInt nnodes, PetscInt nstate, const PetscInt state[], MpmTapeWork **work);
PetscErrorCode MpmTapeWorkDestroy(MpmTapeWork **work);

/*
   MpmTapeCreate - an empty tape. MpmTapeAppend - appends a line; the tape keeps references to its map, left and right.
   MpmTapeMatrix - a MATSHELL that plays the tape, with transposed products and a lower bound of its infinity norm. The
   tape is the matrix's from then on, and is freed with it.

   Collective.
*/
PetscErrorCode MpmTapeCreate(MpmTapeWork *work, MpmTape **tape);
PetscErrorCode MpmTapeAppend(MpmTape *tape, MpmTapeLine line);
PetscErrorCode MpmTapeMatrix(MpmTape **tape, Mat *matrix);
PetscErrorCode MpmTapeDestroy(MpmTape **tape);

/* Collective. The bytes of the maps and numbers of such a matrix, on all ranks together. */
PetscErrorCode MpmTapeBytes(Mat shell, PetscReal *bytes);

/* Collective. A matrix of MpmTapeMatrix as a parallel AIJ matrix with every entry of its diagonal, if only as 0. */
PetscErrorCode MpmTapeAssemble(Mat shell, Mat *matrix);
