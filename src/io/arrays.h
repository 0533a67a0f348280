/*
   Arrays by name in a file: of numpy's .npz, or of HDF5. Matrices and blocks of other programs come and go in them.

   The functions are not collective: the first rank reads and writes, and tells the others. A file that cannot be read
   is no error of the program; why then says what is wrong with it and what is allowed, and else it is "".
*/
#pragma once
#include <mpmstab/compat.h>
#include <stdio.h>

#define MPM_ARRAY_DIMS 3
#define MPM_ARRAY_NAME 32
#define MPM_MOST_ARRAYS 12
#define MPM_WHY_TEXT 256

/* Sets why to what a format of printf and its arguments say. */
#define MpmWhy(why, ...) (void)snprintf(why, MPM_WHY_TEXT, __VA_ARGS__)

/*S
   MpmArray - one array: numbers or a text.

   name  - in the file
   dims, shape, n - its extents, and their product; a number alone has dims 0 and n 1
   real  - the numbers, the last index fastest. Whole numbers are also kept so: they are exact up to 2^53.
   text  - a text has no numbers, and n is 0
S*/
typedef struct {
  char       name[MPM_ARRAY_NAME], text[32];
  int        dims;
  PetscInt64 shape[MPM_ARRAY_DIMS], n;
  PetscReal *real;
} MpmArray;

typedef struct {
  int      n;
  MpmArray array[MPM_MOST_ARRAYS];
} MpmArrays;

/*
   MpmArraysRead - reads those arrays of a file, HDF5 or .npz, whose names are listed (NULL after the last). In HDF5
   they are in the root, or in the first group that has the first of them, as datasets or as attributes of one value.
   MpmArraysWriteNpz - writes arrays to an open stream. whole: the names of those that are written as 64-bit integers.

   Not collective. The arrays are freed with MpmArraysFree.
*/
PetscErrorCode MpmArraysRead(const char path[], const char *const names[], MpmArrays *arrays, char why[MPM_WHY_TEXT]);
PetscErrorCode MpmArraysWriteNpz(const MpmArrays *arrays, const char *const whole[], FILE *stream);
PetscErrorCode MpmArraysFree(MpmArrays *arrays);

/* Not collective. Adds an array with room for its numbers; a text has dims -1 and the shape is not looked at. */
PetscErrorCode MpmArraysAdd(MpmArrays *arrays, const char name[], int dims, const PetscInt64 shape[], MpmArray **array);

/* Not collective. The array of a name, or NULL. MpmArrayIsWhole: whether all its numbers are whole and at least lo. */
const MpmArray *MpmArraysFind(const MpmArrays *arrays, const char name[]);
PetscBool       MpmArrayIsWhole(const MpmArray *array, PetscReal lo);
