/* Bloch modes: eigenvectors of an operator, from the symbol of its scene. */
#pragma once
#include "symbol/source.h"
#include <mpmstab/operator.h>

#define MPM_BLOCH_VECTORS 8

/*S
   MpmBlochCells - the periodic lattice of an operator that has no scene: its symbol, the number of cells in each direction, and
   the cell and the site in it of a particle.
S*/
typedef struct {
  MpmSource   source;
  PetscInt    cells[MPM_MAX_DIM], fields;
  const void *of;
  void (*at)(const void *of, PetscInt64 particle, PetscInt64 cell[], PetscInt *site);
} MpmBlochCells;

/*
   MpmBlochModesCreate - the states of the leading modes of a symbol: e^(i beta . cell) times the eigenvector of the
   phase's matrix, real and imaginary part after one another. Leading are the amplification factors that are away from 1,
   of largest abs, and farthest from 1; one of a class of phases is taken (see MpmSymbolTarget).

   Collective. The operator must be that of the symbol's scene, or of cells, and the symbol must have kept its amplification
   factors.

   Output Parameters:
+  n       - the number of vectors, at most MPM_BLOCH_VECTORS
-  vectors - MPM_BLOCH_VECTORS of them, destroyed with VecDestroyVecs
*/
PetscErrorCode MpmBlochModesCreate(const MpmOperator *op, const MpmSymbol *symbol, const MpmBlochCells *cells,
                                   PetscInt *n, Vec **vectors);
