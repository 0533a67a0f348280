/*
   Checked: a checkpoint held as arrays in memory. An input edits the arrays, and a file with a right checksum is made
   of them.
*/
#pragma once
#include <mpmstab/compat.h>
#include <hdf5.h>
#include <stdint.h>

#define MOST_ARRAYS 24

/* How an array is stored in the file; PLAIN is how the program writes it. */
typedef enum {
  PLAIN,
  MISSING,
  GROUP,
  SCALAR,
  MATRIX,
  DANGLING,
  LOOP,
  UNALLOCATED,
  CHUNKED,
  NARROW,
  UNSIGNED,
  BACKWARDS,
  STRING,
  OTHER_CLASS,
  SHAPES
} Shape;

typedef struct {
  char     name[32];
  hid_t    type;
  size_t   width;
  hsize_t  n, declared; /* declared: the length of an array that is UNALLOCATED */
  uint8_t *data;
  Shape    shape;
} Array;

typedef struct {
  int   n;
  Array array[MOST_ARRAYS];
} Checked;

/* Reads all arrays of a file. */
void CheckedLoad(const char path[], Checked *checked);

/* Copies all arrays. Free the copy with CheckedFree. */
void CheckedCopy(const Checked *from, Checked *to);
void CheckedFree(Checked *checked);

/* Edits the arrays as an input says. An input names an array, an edit, and what that edit needs. */
void CheckedEdit(Checked *checked, const uint8_t *data, size_t size);

/* Writes the arrays to a file with a right checksum. */
void CheckedWrite(const Checked *checked, const char path[]);
