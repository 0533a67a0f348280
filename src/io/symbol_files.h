/* The symbol's curves in files. */
#pragma once
#include "io/datafile.h"
#include "symbol/predict.h"

/*
   MpmSymbolWrite - /symbol/beta (phases), /symbol/growth, /symbol/published and /symbol/corrected, and where the
   factors are kept /symbol/factors (phases x 2 size: real and imaginary part of each factor in turn), over 0 <= beta
   < 2 pi.

   Collective. NaN where a formula says nothing.
*/
PetscErrorCode MpmSymbolWrite(const MpmSymbol *symbol, const MpmPredictor *predictor, MpmDataFile *file);

/*
   Collective. Writes rows of beta, growth, growth without the null space of P2G (at rest; particle data that no node
   feels), published and corrected growth, for 0 <= beta <= pi.
*/
PetscErrorCode MpmSymbolWriteCsv(const MpmSymbol *symbol, const MpmPredictor *predictor, const char path[]);
