/*
   Blocks of a lattice: the operator of a step that is the same at every cell. A_d takes the state of a cell to what it
   becomes in the cell d further on, so that a Bloch mode has the matrix

     G(beta) = sum over d of A_d e^(-i beta.d)
*/
#pragma once
#include "symbol/source.h"

#define MPM_BLOCKS_SIZE 1536   /* the largest order of a block */
#define MPM_BLOCKS_NUMBERS 3e8 /* the most numbers in all blocks together */

/*S
   MpmBlocks - n blocks.

   dim, size  - the number of directions, and the order of a block: the unknowns of a cell
   period     - the number of steps that they cover
   d          - d[dim b + a]: how far block b reaches in direction a, in cells
   A          - A[(b size + i) size + j]: what unknown j gives to unknown i
   cell_width - 0 where it is not known
S*/
typedef struct {
  PetscInt   dim, size, period, n, *d;
  PetscReal *A, cell_width;
} MpmBlocks;

/* Not collective. Makes room for blocks whose dim, size and n are set. */
PetscErrorCode MpmBlocksAllocate(MpmBlocks *blocks);
PetscErrorCode MpmBlocksFree(MpmBlocks *blocks);

/* Not collective. The sum of n operators of one lattice, each times its weight. Free it with MpmBlocksFree. */
PetscErrorCode MpmBlocksCombine(PetscInt n, const MpmBlocks blocks[], const PetscReal weight[], MpmBlocks *sum);

/* Not collective. The blocks as a source of a symbol, which they must outlive. name: of their file, for messages. */
PetscErrorCode MpmBlocksSource(const MpmBlocks *blocks, const char name[], MpmSource *source);

/*S
   MpmBlocksSteps - the operators of n steps that follow one another, of one lattice. MpmBlocksSourceOfSteps: their
   product as a source, which they must outlive. Not collective.
S*/
typedef struct {
  PetscInt         n;
  const MpmBlocks *step;
} MpmBlocksSteps;
PetscErrorCode MpmBlocksSourceOfSteps(const MpmBlocksSteps *steps, const char name[], MpmSource *source);

/*
   MpmBlocksFromSource - finds the blocks of a source from its matrices at n equally spaced phases in each direction,

     A_d = 1 / n^dim  sum over beta of G(beta) e^(i beta.d).

   Collective. n is doubled until the blocks give the matrices at two other phases, so no reach has to be known. Blocks
   of rounding alone are left out.

   Errors: refuses (PETSC_ERR_USER_INPUT) numbers that leave the range of doubles, and a reach that is too far; option:
   the option that asked for blocks, for the message.
*/
PetscErrorCode MpmBlocksFromSource(MPI_Comm comm, const MpmSource *source, const char option[], MpmBlocks *blocks);

/*
   MpmTableBlocks - the blocks of a scheme on a layout, of a step or under drift of a period.

   Collective. Errors: those of MpmSymbolCreate and MpmBlocksFromSource.
*/
PetscErrorCode MpmTableBlocks(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                              const char option[], MpmBlocks *blocks);
