/* The phases of a symbol that have to be computed: one of each class that the symmetries of the layout make. */
#pragma once
#include "symbol/source.h"

/*
   MpmPhasesFind - sets alike and reflects: the symmetries of the source that hold at these numbers of phases.
   MpmPhasesList - sets the classes and their phases. all must be set.

   Not collective.
*/
void           MpmPhasesFind(const MpmSource *source, MpmSymbol *symbol);
PetscErrorCode MpmPhasesList(MpmSymbol *symbol);

/*
   Not collective. The symmetries of a uniform layout: mirror[a] is true where it is its own mirror image in direction
   a, about the middle of a cell, and alike[a] is the first direction that may be exchanged with a.
*/
void MpmPhasesSymmetries(const MpmLayout *layout, const MpmSpace *space, const MpmFraction drift[], PetscBool mirror[],
                         PetscInt alike[]);

/* Not collective. The numbers of an option with one for each direction, for a message. */
PetscErrorCode MpmPhasesText(PetscInt dim, const PetscInt each[], size_t room, char text[]);
