#include "checked.h"
#include "fuzz.h"
#include "io/checkpoint_file.h"
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_EDITS 64
#define MOST_NUMBERS 2048

/*
   The first arrays have fixed numbers, since inputs name arrays by number. One that is not in the file is MISSING;
   other arrays follow.
*/
static const char *const first_names[] = {"scene",       "where", "numbers",        "series_step", "series_state",
                                          "series_grid", "csv",   "rank_particles", "rank_nodes",  "DMSwarm_pid",
                                          "cell",        "xi",    "inverse_mass",   "node_0",      "node_1"};

static void LoadArray(hid_t file, const char name[], Checked *checked)
{
  Array      *a     = &checked->array[checked->n++];
  const hid_t array = H5Dopen2(file, name, H5P_DEFAULT), space = H5Dget_space(array), type = H5Dget_type(array);

  FuzzNeed(checked->n <= MOST_ARRAYS && strlen(name) < sizeof a->name, "raise MOST_ARRAYS");
  (void)strcpy(a->name, name);
  a->width = H5Tget_size(type);
  a->type  = H5Tget_class(type) == H5T_FLOAT ? H5T_NATIVE_DOUBLE : a->width == 1 ? H5T_NATIVE_CHAR : H5T_NATIVE_INT64;
  a->n     = (hsize_t)H5Sget_simple_extent_npoints(space);
  a->data  = calloc(a->n + 1, a->width);
  FuzzNeed(a->data && H5Dread(array, a->type, H5S_ALL, H5S_ALL, H5P_DEFAULT, a->data) >= 0, "no array");
  (void)H5Tclose(type);
  (void)H5Sclose(space);
  (void)H5Dclose(array);
}

static void AddMissing(const char name[], Checked *checked)
{
  Array *a = &checked->array[checked->n++];

  *a = (Array){.type = H5T_NATIVE_INT64, .width = 8, .data = calloc(1, 8), .shape = MISSING};
  (void)strcpy(a->name, name);
}

static PetscBool Has(const Checked *checked, const char name[])
{
  for (int i = 0; i < checked->n; i++)
    if (!strcmp(checked->array[i].name, name)) return PETSC_TRUE;
  return PETSC_FALSE;
}

void CheckedLoad(const char path[], Checked *checked)
{
  const hid_t file = H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT);
  H5G_info_t  root;
  char        name[32];

  FuzzNeed(file >= 0 && H5Gget_info(file, &root) >= 0, "no checkpoint");
  checked->n = 0;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(first_names); i++)
    if (H5Lexists(file, first_names[i], H5P_DEFAULT) > 0)
      LoadArray(file, first_names[i], checked);
    else
      AddMissing(first_names[i], checked);
  for (hsize_t i = 0; i < root.nlinks; i++) {
    (void)H5Lget_name_by_idx(file, ".", H5_INDEX_NAME, H5_ITER_INC, i, name, sizeof name, H5P_DEFAULT);
    if (!Has(checked, name)) LoadArray(file, name, checked);
  }
  (void)H5Fclose(file);
}

void CheckedCopy(const Checked *from, Checked *to)
{
  *to = *from;
  for (int i = 0; i < to->n; i++) {
    Array *a = &to->array[i];

    a->data = malloc((a->n + 1) * a->width);
    FuzzNeed(a->data ? PETSC_TRUE : PETSC_FALSE, "no memory");
    memcpy(a->data, from->array[i].data, (a->n + 1) * a->width);
  }
}

void CheckedFree(Checked *checked)
{
  for (int i = 0; i < checked->n; i++) free(checked->array[i].data);
  checked->n = 0;
}

typedef struct {
  const uint8_t *next, *end;
} Bytes;

static uint8_t Byte(Bytes *b)
{
  return b->next < b->end ? *b->next++ : 0;
}

static uint64_t Number(Bytes *b, int bytes)
{
  uint64_t value = 0;

  for (int i = 0; i < bytes; i++) value |= (uint64_t)Byte(b) << 8 * i;
  return value;
}

/* Values with which readers may go wrong, as the 8 bytes of an integer or a double. */
static uint64_t Special(const Array *a, uint8_t which)
{
  static const int64_t integers[] = {-1,        0,         1,         2,         7,         8,
                                     9,         12,        127,       INT32_MAX, INT32_MIN, INT64_MAX,
                                     INT64_MIN, 1LL << 32, 1LL << 31, 1LL << 53, 1LL << 62};
  static const double  reals[]    = {0,
                                     -0.0,
                                     1,
                                     -1,
                                     0.5,
                                     NAN,
                                     INFINITY,
                                     -INFINITY,
                                     DBL_MAX,
                                     -DBL_MAX,
                                     DBL_MIN,
                                     0x1p-1074,
                                     0x1.fffffffffffffp-1,
                                     1e-300,
                                     1e154,
                                     1e155,
                                     1e9};
  uint64_t             bits;

  if (a->type == H5T_NATIVE_DOUBLE)
    memcpy(&bits, &reals[which % PETSC_STATIC_ARRAY_LENGTH(reals)], 8);
  else
    memcpy(&bits, &integers[which % PETSC_STATIC_ARRAY_LENGTH(integers)], 8);
  return bits;
}

static void Set(Array *a, hsize_t i, uint64_t bits)
{
  if (i < a->n) memcpy(a->data + i * a->width, &bits, a->width);
}

/* Changes the length. A longer array repeats its contents. */
static void SetLength(Array *a, hsize_t n)
{
  uint8_t *data = calloc(n + 1, a->width);

  FuzzNeed(data ? PETSC_TRUE : PETSC_FALSE, "no memory");
  for (hsize_t i = 0; i < n && a->n; i++) memcpy(data + i * a->width, a->data + i % a->n * a->width, a->width);
  free(a->data);
  a->data = data;
  a->n    = n;
}

static void Swap(Array *a, hsize_t i, hsize_t j)
{
  uint64_t one = 0, two = 0;

  if (i >= a->n || j >= a->n) return;
  memcpy(&one, a->data + i * a->width, a->width);
  memcpy(&two, a->data + j * a->width, a->width);
  Set(a, i, two);
  Set(a, j, one);
}

static void Add(Array *a, hsize_t i, int8_t change)
{
  if (i >= a->n) return;
  if (a->type == H5T_NATIVE_DOUBLE) {
    double value;

    memcpy(&value, a->data + 8 * i, 8);
    value *= 1 + change / 16.0;
    memcpy(a->data + 8 * i, &value, 8);
  } else {
    uint64_t value = 0;

    memcpy(&value, a->data + i * a->width, a->width);
    Set(a, i, value + (uint64_t)(int64_t)change);
  }
}

static void EditArray(Array *a, Bytes *b)
{
  enum { SET, SPECIAL, ADD, SWAP, LENGTH, FILL, SHAPE, TEXT, EDITS };
  const int     edit = Byte(b) % EDITS;
  const hsize_t i    = edit == LENGTH || edit == FILL || edit == SHAPE ? 0 : Number(b, 2);

  if (edit == SET)
    Set(a, i, Number(b, (int)a->width));
  else if (edit == SPECIAL)
    Set(a, i, Special(a, Byte(b)));
  else if (edit == ADD)
    Add(a, i, (int8_t)Byte(b));
  else if (edit == SWAP)
    Swap(a, i, Number(b, 2));
  else if (edit == LENGTH)
    SetLength(a, Number(b, 2) % MOST_NUMBERS);
  else if (edit == FILL) {
    const uint64_t bits = Special(a, Byte(b));

    for (hsize_t j = 0; j < a->n; j++) Set(a, j, bits);
  } else if (edit == SHAPE) {
    a->shape = (Shape)(Byte(b) % SHAPES);
    if (a->shape == UNALLOCATED) a->declared = Number(b, 8);
  } else if (edit == TEXT)
    for (uint8_t n = Byte(b), j = 0; j < n; j++) Set(a, i + j, Byte(b));
}

void CheckedEdit(Checked *checked, const uint8_t *data, size_t size)
{
  Bytes bytes = {data, data + size};

  for (int edits = 0; edits < MOST_EDITS && bytes.next < bytes.end; edits++) {
    const int a = Byte(&bytes) % MOST_ARRAYS;

    if (a < checked->n) EditArray(&checked->array[a], &bytes);
  }
}

static hid_t TypeInFile(const Array *a)
{
  const PetscBool real = a->type == H5T_NATIVE_DOUBLE ? PETSC_TRUE : PETSC_FALSE;

  if (a->shape == NARROW) return real ? H5T_IEEE_F32LE : H5T_STD_I8LE;
  if (a->shape == UNSIGNED && !real) return H5T_STD_U64LE;
  if (a->shape == BACKWARDS) return real ? H5T_IEEE_F64BE : H5T_STD_I64BE;
  if (a->shape == STRING) return H5T_C_S1;
  if (a->shape == OTHER_CLASS) return real ? H5T_NATIVE_INT64 : H5T_NATIVE_DOUBLE;
  return a->type;
}

static hid_t SpaceInFile(const Array *a)
{
  const hsize_t length = a->shape == UNALLOCATED ? a->declared : a->n, matrix[] = {a->n / 2, 2};

  if (a->shape == SCALAR) return H5Screate(H5S_SCALAR);
  return a->shape == MATRIX ? H5Screate_simple(2, matrix, NULL) : H5Screate_simple(1, &length, NULL);
}

/* Writes an array. When HDF5 does not accept a declaration, the file has no such array. */
static void WriteArray(hid_t file, const Array *a)
{
  const PetscBool copied =
      a->shape != UNALLOCATED && a->shape != SCALAR && a->shape != STRING && a->shape != OTHER_CLASS ? PETSC_TRUE
                                                                                                     : PETSC_FALSE;
  const hsize_t chunk  = 2;
  const hid_t   layout = H5Pcreate(H5P_DATASET_CREATE), space = SpaceInFile(a);
  hid_t         array;

  if (a->shape == CHUNKED) (void)H5Pset_chunk(layout, 1, &chunk);
  array = H5Dcreate2(file, a->name, TypeInFile(a), space, H5P_DEFAULT, layout, H5P_DEFAULT);
  if (array >= 0 && copied && (a->shape != MATRIX || a->n % 2 == 0))
    (void)H5Dwrite(array, a->type, H5S_ALL, H5S_ALL, H5P_DEFAULT, a->data);
  if (array >= 0) (void)H5Dclose(array);
  if (space >= 0) (void)H5Sclose(space);
  (void)H5Pclose(layout);
}

void CheckedWrite(const Checked *checked, const char path[])
{
  const hid_t creation = H5Pcreate(H5P_FILE_CREATE);
  int         error;
  hid_t       file;

  (void)H5Pset_userblock(creation, MPM_CHECKSUM_BYTES);
  file = H5Fcreate(path, H5F_ACC_TRUNC, creation, H5P_DEFAULT);
  FuzzNeed(file >= 0 ? PETSC_TRUE : PETSC_FALSE, "no file to write to");
  for (int i = 0; i < checked->n; i++) {
    const Array *a = &checked->array[i];

    if (a->shape == GROUP)
      (void)H5Gclose(H5Gcreate2(file, a->name, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    else if (a->shape == DANGLING || a->shape == LOOP)
      (void)H5Lcreate_soft(a->shape == LOOP ? a->name : "nothing", file, a->name, H5P_DEFAULT, H5P_DEFAULT);
    else if (a->shape != MISSING)
      WriteArray(file, a);
  }
  (void)H5Fclose(file);
  (void)H5Pclose(creation);
  FuzzNeed(!MpmChecksumWrite(PETSC_COMM_WORLD, path, &error) && !error, "no checksum");
}
