/* The blocks of a matrix that the hook has written for a whole grid, where all cells are alike. */
#pragma once
#include "io/matrix_csr.h"
#include "symbol/blocks.h"

/*
   MpmBlocksOfMatrix - makes numbers relative to the scales of their fields where the file says these, and takes the columns of the cell in the middle as blocks, and compares those of all other cells with
   them. Cells beside an edge are left out of the comparison, since their columns are others.

   Not collective. why: what stands against it ("": nothing); then there are no blocks.
*/
PetscErrorCode MpmBlocksOfMatrix(MpmEntries *entries, MpmBlocks *blocks, char why[MPM_WHY_TEXT]);
