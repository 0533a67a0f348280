/* Sealed: a checkpoint as arrays in memory, which an input edits, and the file made of what they are then. */
#pragma once
#include <mpmstab/compat.h>
#include <hdf5.h>
#include <stdint.h>

#define MOST_ARRAYS 24

/* What an array is in the file; PLAIN is what the program writes. */
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
  hsize_t  n, declared; /* declared: of an array that is UNALLOCATED */
  uint8_t *data;
  Shape    shape;
} Array;

typedef struct {
  int   n;
  Array array[MOST_ARRAYS];
} Sealed;

/* All arrays of a file. */
void SealedLoad(const char path[], Sealed *sealed);

/* Another with the same contents, to be freed. */
void SealedCopy(const Sealed *from, Sealed *to);
void SealedFree(Sealed *sealed);

/* Does what an input says: records of an array, an edit, and what that needs. */
void SealedEdit(Sealed *sealed, const uint8_t *data, size_t size);

/* Makes the file, with a seal that is right. */
void SealedWrite(const Sealed *sealed, const char path[]);
