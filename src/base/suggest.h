/* The right name for a misspelled one. */
#pragma once
#include <mpmstab/compat.h>

/* Not collective. The name nearest to a misspelled one among n names, or NULL when none is near. */
const char *MpmSuggest(const char misspelled[], PetscInt n, const char *const names[]);
