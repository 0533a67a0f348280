/* Suggest: finds the name that a misspelled word may have meant. */
#pragma once
#include "base/text.h"

/*
   MpmSuggest - the one of n names that is nearest to a misspelled word, or NULL when none is near.

   Not collective. Near is a distance of at most a third of the word's length, or 2 for short words, where the distance
   counts letters that are inserted, deleted or replaced (Levenshtein).
*/
const char *MpmSuggest(const char misspelled[], PetscInt n, const char *const names[]);

/* Not collective. Adds n names as 'a, b or c', and after them '; did you mean b?' where one is near to a word, if any. */
PetscErrorCode MpmSuggestAdd(MpmText *text, const char word[], PetscInt n, const char *const names[]);

/*
   Collective. Refuses a word: what a printf format and its arguments say, and then the names as MpmSuggestAdd adds them.
*/
PetscErrorCode MpmSuggestRefuse(const char word[], PetscInt n, const char *const names[], const char format[], ...)
    __attribute__((format(printf, 4, 5)));
