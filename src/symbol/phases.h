/* The phases of a symbol that have to be computed: one of each class that the symmetries of the layout make. */
#pragma once
#include <mpmstab/symbol.h>

/*
   MpmPhasesFind - sets alike and reflects, the symmetries that hold.
   MpmPhasesList - sets the classes and their phases. all must be set.

   Not collective.
*/
void           MpmPhasesFind(MpmSymbol *symbol);
PetscErrorCode MpmPhasesList(MpmSymbol *symbol);
