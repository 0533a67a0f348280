/* Modes: where eigenvectors live, on particles and on the grid. */
#pragma once
#include "linalg/eigen.h"
#include "symbol/source.h"
#include <mpmstab/operator.h>

/*S
   MpmModes - where each of the first n listed eigenvectors lives.

   beta: the phase per cell of the largest Fourier component of the mode's nodal trace, which is P2G of its fields: dim
   numbers a mode, the first up to pi and the others below 2 pi. They are NaN when the trace is 0 to rounding, and on
   rank 0 only. p_share: of that component of the velocity (u of a gas), the part of the square that is along beta: 1
   for a P wave, 0 for an S wave. It is on rank 0 only, and NaN in one dimension, between ends, and where there is no
   vector. null_share: norm of the part of the mode that P2G sends to 0, relative to that of the mode.
S*/
typedef struct {
  PetscInt   n, dim;
  PetscReal *beta, *p_share, *null_share;
} MpmModes;

/* Collective. MpmModesCreate examines the first count of the listed eigenvectors, or all where they are fewer. */
PetscErrorCode MpmModesCreate(const MpmOperator *op, const MpmEigen *eigen, PetscInt count, MpmModes *modes);
PetscErrorCode MpmModesDestroy(MpmModes *modes);

/*
   Collective. The velocities of the particles in the real part of the first listed eigenvector, on all ranks: for each
   direction a number for each id. fastest: the id of the largest velocity, which is 1, the least of several; MPM_NONE:
   the state has no vector.
*/
PetscErrorCode MpmModesVelocities(const MpmOperator *op, const MpmEigen *eigen, PetscReal v[], PetscInt64 *fastest);

/*
   MpmModesNullity - counts the states that no node feels and no filter removes, at the first step. For each field it is
   the number of particles minus the rank of the map by which nodes feel the field (P2G or DIV).

   Collective. Computed by singular values, for orders that are solved whole.
*/
PetscErrorCode MpmModesNullity(const MpmOperator *op, PetscInt *nullity);

/* Not collective. The first register of the first vector, or MPM_NONE. */
PetscInt MpmModesVectorOf(const MpmScheme *scheme);

#define MPM_BLOCH_VECTORS 8

/*S
   MpmBlochCells - the periodic lattice of an operator that has no scene: its symbol, the number of cells in each
   direction, and the cell and the site in it of a particle.
S*/
typedef struct {
  MpmSource   source;
  PetscInt    cells[MPM_MAX_DIM], fields;
  const void *of;
  void (*at)(const void *of, PetscInt64 particle, PetscInt64 cell[], PetscInt *site);
} MpmBlochCells;

/*
   MpmBlochModesCreate - the states of the leading modes of a symbol: e^(i beta . cell) times the eigenvector of the
   phase's matrix, real and imaginary part after one another. Leading are the amplification factors that are away from
   1, of largest abs, and farthest from 1; one of a class of phases is taken (see MpmSymbolTarget).

   Collective. The operator must be that of the symbol's scene, or of cells, and the symbol must have kept its
   amplification factors.

   Output Parameters:
+  n       - the number of vectors, at most MPM_BLOCH_VECTORS
-  vectors - MPM_BLOCH_VECTORS of them, destroyed with VecDestroyVecs
*/
PetscErrorCode MpmBlochModesCreate(const MpmOperator *op, const MpmSymbol *symbol, const MpmBlochCells *cells,
                                   PetscInt *n, Vec **vectors);
