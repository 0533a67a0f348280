/* The check of a table that MpmTableCreate makes. */
#pragma once
#include <mpmstab/table.h>

/*
   MpmTableCheck - refuses (PETSC_ERR_SUP) a table that the interpreters do not support; MpmTableCreate says what that is.

   Not collective.
*/
PetscErrorCode MpmTableCheck(const MpmTable *table);
