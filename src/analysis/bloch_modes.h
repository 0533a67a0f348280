/* Bloch modes: eigenvectors of an operator, from the symbol of its scene. */
#pragma once
#include <mpmstab/operator.h>
#include <mpmstab/symbol.h>

#define MPM_BLOCH_VECTORS 8

/*
   MpmBlochModesCreate - the states of the leading modes of a symbol: e^(i beta . cell) times the eigenvector of the
   phase's matrix, real and imaginary part after one another. Leading are the amplification factors that are away from 1,
   of largest abs, and farthest from 1; one of a class of phases is taken (see MpmSymbolTarget).

   Collective. The operator must be that of the symbol's scene, and the symbol must have kept its amplification factors.

   Output Parameters:
+  n       - the number of vectors, at most MPM_BLOCH_VECTORS
-  vectors - MPM_BLOCH_VECTORS of them, destroyed with VecDestroyVecs
*/
PetscErrorCode MpmBlochModesCreate(const MpmOperator *op, const MpmSymbol *symbol, PetscInt *n, Vec **vectors);
