/* Suggest: finds the name that a misspelled word may have meant. */
#pragma once
#include <mpmstab/compat.h>

/*
   MpmSuggest - the one of n names that is nearest to a misspelled word, or NULL when none is near.

   Not collective. Near is a distance of at most a third of the word's length, or 2 for short words, where the distance
   counts letters that are inserted, deleted or replaced (Levenshtein).
*/
const char *MpmSuggest(const char misspelled[], PetscInt n, const char *const names[]);
