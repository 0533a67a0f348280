/* Which file a name means, however it is spelt. The functions are not collective: one rank asks for all. */
#pragma once
#include <mpmstab/compat.h>

/*
   MpmFileIsSame - whether two names are of one file: there is one file with both names, by links of any kind, or they are
   the same name in the same folder, where there may be no file yet.
*/
PetscBool MpmFileIsSame(const char a[], const char b[]);

/*
   MpmFileIsHere - whether a file is in the current folder, or in one below it, and no part of its name from there on is
   hidden (begins with a point). A folder that does not exist is none in which a file can be.
*/
PetscBool MpmFileIsHere(const char path[]);

/* Whether a name has one of the endings of a text such as ".npz, .h5 or .hdf5". */
PetscBool MpmFileHasEnding(const char path[], const char endings[]);
