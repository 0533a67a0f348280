/* Files of the symbol's curves. */
#pragma once
#include "io/datafile.h"
#include "symbol/predict.h"

/*
   MpmSymbolWrite - writes curves over all phases, in the order of their numbers: /symbol/beta (phases x dim),
   /symbol/growth, /symbol/published and /symbol/corrected, and where the amplification factors are kept, /symbol/factors
   (phases x 2 size: real and imaginary part of each amplification factor in turn).

   Collective. A number is NaN where a formula does not cover the phase. predictor NULL: there are no formulas.
*/
PetscErrorCode MpmSymbolWrite(const MpmSymbol *symbol, const MpmPredictor *predictor, MpmDataFile *file);

/*
   MpmSymbolWriteCsv - writes rows of beta, growth, growth without the null space of P2G (at rest; it is the particle
   data that no node feels), published and corrected growth. In one dimension there is a row for each phase up to pi, in
   more for each phase.

   Collective.
*/
PetscErrorCode MpmSymbolWriteCsv(const MpmSymbol *symbol, const MpmPredictor *predictor, const char path[]);
