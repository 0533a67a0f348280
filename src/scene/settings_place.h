/* Places where PETSc finds options: the command line, the variable PETSC_OPTIONS, and files. */
#pragma once
#include <mpmstab/compat.h>

#define MPM_PLACE_TEXT 512

/*
   MpmSettingsPlace - says where an option of PETSc's database comes from: ", from PETSC_OPTIONS", ", from .petscrc" or
   another file of options; "" for the command line, or the program itself.

   Collective on PETSC_COMM_WORLD. name: without its '-'. value: NULL or "" for none.
*/
PetscErrorCode MpmSettingsPlace(const char name[], const char value[], char place[MPM_PLACE_TEXT]);

/*
   MpmSettingsPlaceFile - gives the names of the files of options, the one that overrules the others first; the command
   line may name one. there: whether there is an i-th name. There need be no such file.

   Not collective.
*/
PetscErrorCode MpmSettingsPlaceFile(int i, size_t room, char file[], PetscBool *there);
