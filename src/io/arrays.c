/* Arrays by name: in memory, in HDF5 and in numpy's .npz. */
#include "base/hdf5.h"
#include "base/memory.h"
#include "base/text.h"
#include "base/textfile.h"
#include "io/arrays.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zip.h>

#define EXACT 9007199254740992.0 /* 2^53: doubles beyond it are not all whole numbers */

PetscErrorCode MpmArraysAdd(MpmArrays *arrays, const char name[], int dims, const PetscInt64 shape[], MpmArray **array)
{
  MpmArray *a = &arrays->array[arrays->n];

  PetscFunctionBegin;
  PetscCheck(arrays->n < MPM_MOST_ARRAYS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MOST_ARRAYS");
  *a = (MpmArray){.dims = dims, .n = dims < 0 ? 0 : 1};
  (void)snprintf(a->name, sizeof a->name, "%s", name);
  for (int i = 0; i < dims; i++) {
    a->shape[i] = shape[i];
    a->n *= shape[i];
  }
  PetscCall(PetscMalloc1((size_t)a->n, &a->real));
  arrays->n++;
  *array = a;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmArraysFree(MpmArrays *arrays)
{
  PetscFunctionBegin;
  for (int i = 0; i < arrays->n; i++) PetscCall(PetscFree(arrays->array[i].real));
  arrays->n = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmArray *MpmArraysFind(const MpmArrays *arrays, const char name[])
{
  for (int i = 0; i < arrays->n; i++)
    if (!strcmp(arrays->array[i].name, name)) return &arrays->array[i];
  return NULL;
}

PetscBool MpmArrayIsWhole(const MpmArray *array, PetscReal lo)
{
  for (PetscInt64 i = 0; i < array->n; i++)
    if (!(array->real[i] >= lo && array->real[i] <= EXACT && array->real[i] == rint(array->real[i])))
      return PETSC_FALSE;
  return PETSC_TRUE;
}

/*
   Arrays by name in HDF5, as many programs write them: datasets of the root or of a group, with attributes for what is
   one number or a text.
*/

#define PATH_TEXT 160

/* The group that has an array: "" for the root, else "/NAME"; the root if none has it. */
static void FindGroup(const MpmHdf5 *file, const char first[], char group[PATH_TEXT])
{
  char name[64], path[PATH_TEXT];

  group[0] = '\0';
  if (MpmHdf5Has(file, first)) return;
  for (PetscInt i = 0; MpmHdf5Group(file, i, sizeof name, name); i++) {
    if (!name[0]) continue;
    (void)snprintf(path, sizeof path, "/%s/%s", name, first);
    if (!MpmHdf5Has(file, path)) continue;
    (void)snprintf(group, PATH_TEXT, "/%s", name);
    break;
  }
}

/* Reads what has a name in a group: a dataset of numbers, or an attribute that is one number or a text. */
static PetscErrorCode ReadNamed(MpmHdf5 *file, const char group[], const char name[], MpmArrays *arrays,
                                char why[MPM_WHY_TEXT])
{
  const char *object = group[0] ? group : "/";
  char        path[PATH_TEXT], text[32];
  int         dims;
  PetscInt64  shape[MPM_ARRAY_DIMS] = {0};
  PetscReal   number, bytes = sizeof(PetscReal);
  MpmArray   *a = NULL;

  PetscFunctionBegin;
  (void)snprintf(path, sizeof path, "%s/%s", group, name);
  if (MpmHdf5Has(file, path)) {
    if (!MpmHdf5Array(file, path, MPM_ARRAY_DIMS, &dims, shape)) {
      MpmWhy(why, "array %s; allowed: whole or real numbers in up to %d dimensions, in a whole file", name,
             MPM_ARRAY_DIMS);
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    for (int d = 0; d < dims; d++) bytes *= (PetscReal)shape[d];
    MpmMemoryRoom(bytes, MPM_WHY_TEXT, why);
    if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(MpmArraysAdd(arrays, name, dims, shape, &a));
    MpmHdf5ReadArray(file, path, a->real);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (MpmHdf5ReadText(file, object, name, sizeof text, text)) {
    PetscCall(MpmArraysAdd(arrays, name, -1, NULL, &a));
    (void)snprintf(a->text, sizeof a->text, "%s", text);
  } else if (MpmHdf5ReadAttribute(file, object, name, H5T_NATIVE_DOUBLE, &number)) {
    PetscCall(MpmArraysAdd(arrays, name, 0, NULL, &a));
    a->real[0] = number;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadHdf5(const char path[], const char *const names[], MpmArrays *arrays, char why[MPM_WHY_TEXT])
{
  MpmHdf5   file;
  PetscBool failed;
  char      group[PATH_TEXT];

  PetscFunctionBegin;
  *arrays = (MpmArrays){.n = 0};
  why[0]  = '\0';
  PetscCall(MpmHdf5Open(PETSC_COMM_SELF, path, &file));
  if (file.file >= 0) {
    FindGroup(&file, names[0], group);
    for (int k = 0; names[k] && !why[0]; k++) PetscCall(ReadNamed(&file, group, names[k], arrays, why));
  }
  PetscCall(MpmHdf5Close(&file, &failed));
  if (failed && !why[0]) MpmWhy(why, "HDF5 cannot read it; allowed: a whole file");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   numpy's .npz: a zip archive whose members NAME.npy are arrays (NEP 1). An array is a line of Python that says type
   and shape, and then its numbers.
*/

#define MAGIC "\x93NUMPY"
#define MAGIC_SIZE 6
#define NUMBERS "whole or real numbers of up to 64 bits"
#define ARCHIVE "a zip archive in memory"
#define DAY 315619200 /* 2 January 1980, since 1970: a file does not depend on when it was written */

/*
   The type of an array's numbers: 'f', 'i', 'u', 'b', 'S' or 'U', bytes of one, and whether bytes come the other way.
*/
typedef struct {
  char      kind;
  size_t    width;
  PetscBool swapped;
} Type;

/* Finds the text that follows a key of the header, such as 'descr'. */
static const char *After(const char header[], const char key[])
{
  const char *at = strstr(header, key);

  if (!at) return NULL;
  at = strchr(at + strlen(key), ':');
  if (!at) return NULL;
  at++;
  return at + strspn(at, " ");
}

static PetscBool ParseType(const char text[], Type *type)
{
  char *end;

  if (!text || *text++ != '\'' || !strchr("<>|=", *text)) return PETSC_FALSE;
  type->swapped = *text++ == '>' ? PETSC_TRUE : PETSC_FALSE;
  type->kind    = *text++;
  type->width   = (size_t)strtoul(text, &end, 10);
  return *end == '\'' ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool ParseShape(const char text[], int *dims, PetscInt64 shape[])
{
  if (!text || *text++ != '(') return PETSC_FALSE;
  for (*dims = 0; *dims <= MPM_ARRAY_DIMS; ++*dims) {
    char *end;

    text += strspn(text, ", ");
    if (*text == ')') return PETSC_TRUE;
    if (*dims == MPM_ARRAY_DIMS || *text < '0' || *text > '9') return PETSC_FALSE;
    shape[*dims] = strtoll(text, &end, 10);
    text         = end;
  }
  return PETSC_FALSE;
}

/* One number of the types that numpy writes, as a double. */
static PetscReal Number(const unsigned char *at, const Type *type)
{
  unsigned char b[8];
  union {
    double   f8;
    float    f4;
    int64_t  i8;
    int32_t  i4;
    int16_t  i2;
    int8_t   i1;
    uint64_t u8;
    uint32_t u4;
    uint16_t u2;
    uint8_t  u1;
  } as;

  for (size_t i = 0; i < type->width; i++) b[i] = at[type->swapped ? type->width - 1 - i : i];
  memcpy(&as, b, type->width);
  if (type->kind == 'f') return type->width == 8 ? as.f8 : as.f4;
  if (type->kind == 'i')
    return (PetscReal)(type->width == 8 ? as.i8 : type->width == 4 ? as.i4 : type->width == 2 ? as.i2 : as.i1);
  return (PetscReal)(type->width == 8 ? as.u8 : type->width == 4 ? as.u4 : type->width == 2 ? as.u2 : as.u1);
}

static PetscBool IsNumber(const Type *type)
{
  const PetscBool whole = strchr("iub", type->kind) ? PETSC_TRUE : PETSC_FALSE;

  return type->width == 8 || type->width == 4 || (whole && (type->width == 2 || type->width == 1)) ? PETSC_TRUE
                                                                                                   : PETSC_FALSE;
}

/* Puts an array's numbers in their places: those of Fortran's order have the first index fastest. */
static void Fill(const unsigned char *bytes, const Type *type, PetscBool fortran, MpmArray *a)
{
  for (PetscInt64 i = 0; i < a->n; i++) {
    PetscInt64 place = i;

    if (fortran) {
      PetscInt64 rest = i;

      place = 0;
      for (int d = 0; d < a->dims; d++) {
        PetscInt64 stride = 1;

        for (int e = d + 1; e < a->dims; e++) stride *= a->shape[e];
        place += rest % a->shape[d] * stride;
        rest /= a->shape[d];
      }
    }
    a->real[place] = Number(bytes + (size_t)i * type->width, type);
  }
}

/* A text of one byte or of four bytes for a character. */
static void FillText(const unsigned char *bytes, const Type *type, MpmArray *a)
{
  const size_t step = type->kind == 'U' ? 4 : 1;

  for (size_t i = 0; i * step < type->width * step && i + 1 < sizeof a->text && i < type->width; i++)
    a->text[i] = (char)bytes[type->swapped ? i * step + step - 1 : i * step];
}

/* Reads one member from memory. */
static PetscErrorCode ParseNpy(const char name[], const unsigned char *bytes, size_t size, MpmArrays *arrays,
                               char why[MPM_WHY_TEXT])
{
  const size_t prefix = size > MAGIC_SIZE && bytes[MAGIC_SIZE] > 1 ? 12 : 10;
  size_t       length = 0;
  char         header[1024];
  Type         type;
  int          dims;
  PetscInt64   shape[MPM_ARRAY_DIMS] = {0};
  PetscReal    n                     = 1;
  const char  *order;
  MpmArray    *a = NULL;

  PetscFunctionBegin;
  MpmWhy(why, "array %s is not one of numpy's; allowed: what numpy.savez writes", name);
  if (size < prefix || memcmp(bytes, MAGIC, MAGIC_SIZE)) PetscFunctionReturn(PETSC_SUCCESS);
  for (size_t i = prefix; i > 8; i--) length = length << 8 | bytes[i - 1];
  if (length >= sizeof header || length > size - prefix) PetscFunctionReturn(PETSC_SUCCESS);
  memcpy(header, bytes + prefix, length);
  header[length] = '\0';
  bytes += prefix + length;
  size -= prefix + length;
  order = After(header, "'fortran_order'");
  if (!ParseType(After(header, "'descr'"), &type) || !order || !ParseShape(After(header, "'shape'"), &dims, shape)) {
    MpmWhy(why, "array %s: its type or shape; allowed: %s, in up to %d dimensions", name, NUMBERS, MPM_ARRAY_DIMS);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (type.kind == 'S' || type.kind == 'U') {
    if (dims || size < type.width * (type.kind == 'U' ? 4 : 1)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(MpmArraysAdd(arrays, name, -1, NULL, &a));
    FillText(bytes, &type, a);
    why[0] = '\0';
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmWhy(why, "array %s has %s; allowed: %s", name, type.kind == 'c' ? "complex numbers" : "no numbers", NUMBERS);
  if (!strchr("fiub", type.kind) || !IsNumber(&type)) PetscFunctionReturn(PETSC_SUCCESS);
  for (int d = 0; d < dims; d++) n *= (PetscReal)shape[d];
  MpmWhy(why, "array %s is shorter than its shape says; allowed: a whole file", name);
  if (n * (PetscReal)type.width > (PetscReal)size) PetscFunctionReturn(PETSC_SUCCESS);
  why[0] = '\0';
  MpmMemoryRoom(sizeof(PetscReal) * n, MPM_WHY_TEXT, why);
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmArraysAdd(arrays, name, dims, shape, &a));
  Fill(bytes, &type, *order == 'T' ? PETSC_TRUE : PETSC_FALSE, a);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Unpacks a member of an archive, and compares its checksum. wrong: why that could not be done, or NULL. */
static PetscErrorCode Unpack(zip_t *archive, const zip_stat_t *member, unsigned char **bytes, const char **wrong)
{
  zip_file_t *file = zip_fopen_index(archive, member->index, 0);

  PetscFunctionBegin;
  *bytes = NULL;
  *wrong =
      zip_error_code_zip(zip_get_error(archive)) == ZIP_ER_COMPNOTSUPP
          ? "one of its arrays is compressed in a way that is not known; allowed: stored or deflated, as numpy does"
          : "it is cut off, or damaged";
  if (!file) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1((size_t)member->size + 1, bytes));
  if (zip_fread(file, *bytes, member->size) == (zip_int64_t)member->size &&
      zip_fread(file, *bytes + member->size, 1) == 0) /* the end, where the checksum is compared */
    *wrong = NULL;
  else
    PetscCall(PetscFree(*bytes));
  (void)zip_fclose(file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadMembers(zip_t *archive, const char *const names[], MpmArrays *arrays, char why[MPM_WHY_TEXT])
{
  const char *wrong = NULL;

  PetscFunctionBegin;
  for (int k = 0; names[k] && !wrong && !why[0]; k++) {
    char           name[MPM_ARRAY_NAME + 4];
    zip_stat_t     member;
    unsigned char *bytes;

    (void)snprintf(name, sizeof name, "%s.npy", names[k]);
    if (zip_stat(archive, name, 0, &member)) continue;
    MpmMemoryRoom((PetscReal)member.size + (PetscReal)member.comp_size, MPM_WHY_TEXT, why);
    if (why[0]) break;
    PetscCall(Unpack(archive, &member, &bytes, &wrong));
    if (wrong) break;
    PetscCall(ParseNpy(names[k], bytes, (size_t)member.size, arrays, why));
    PetscCall(PetscFree(bytes));
  }
  if (wrong) MpmWhy(why, "%s%s", wrong, strstr(wrong, "allowed") ? "" : "; allowed: a whole .npz");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadNpz(const char path[], const char *const names[], MpmArrays *arrays, char why[MPM_WHY_TEXT])
{
  int           error;
  FILE         *stream = MpmFileOpen(path, &error);
  zip_source_t *source = stream ? zip_source_filep_create(stream, 0, -1, NULL) : NULL;
  zip_t        *archive;

  PetscFunctionBegin;
  *arrays = (MpmArrays){.n = 0};
  why[0]  = '\0';
  if (!stream) {
    MpmWhy(why, "it cannot be opened; allowed: a file that can be read");
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCheck(source, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for an archive");
  archive = zip_open_from_source(source, ZIP_RDONLY, NULL);
  if (archive) {
    PetscCall(ReadMembers(archive, names, arrays, why));
    zip_discard(archive); /* which closes the stream */
  } else {
    zip_source_free(source);
    MpmWhy(why, "it is cut off, or no zip archive; allowed: a whole .npz");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmArraysRead(const char path[], const char *const names[], MpmArrays *arrays, char why[MPM_WHY_TEXT])
{
  PetscBool hdf5;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Is(path, &hdf5));
  PetscCall(hdf5 ? ReadHdf5(path, names, arrays, why) : ReadNpz(path, names, arrays, why));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- writing .npz ---- */

#define HEADER 128 /* bytes of an array before its numbers */

static void Header(const MpmArray *a, PetscBool whole, char header[HEADER + 1])
{
  char   shape[96] = "", type[16];
  size_t used;

  for (int d = 0; d < a->dims; d++) {
    char part[32];

    (void)snprintf(part, sizeof part, "%" PetscInt64_FMT ",", a->shape[d]);
    MpmTextJoin(shape, part, sizeof shape);
  }
  if (a->dims < 0)
    (void)snprintf(type, sizeof type, "|S%d", (int)strlen(a->text));
  else
    (void)snprintf(type, sizeof type, "%s", whole ? "<i8" : "<f8");
  memset(header, ' ', HEADER);
  memcpy(header, MAGIC "\x01\x00", MAGIC_SIZE + 2);
  header[8] = (char)(HEADER - 10);
  header[9] = 0;
  (void)snprintf(header + 10, HEADER - 10, "{'descr': '%s', 'fortran_order': False, 'shape': (%s), }", type, shape);
  used               = strlen(header + 10);
  header[10 + used]  = ' '; /* in place of the end of the string */
  header[HEADER - 1] = '\n';
  header[HEADER]     = '\0';
}

/* The bytes of an array, which the archive frees. */
static PetscErrorCode Pack(const MpmArray *a, PetscBool whole, size_t *size, char **bytes)
{
  const size_t text = a->dims < 0 ? strlen(a->text) : 0;
  char         header[HEADER + 1];

  PetscFunctionBegin;
  *size  = HEADER + text + 8 * (size_t)a->n;
  *bytes = malloc(*size);
  PetscCheck(*bytes, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for %zu bytes of %s", *size, a->name);
  Header(a, whole, header);
  memcpy(*bytes, header, HEADER);
  memcpy(*bytes + HEADER, a->text, text);
  for (PetscInt64 i = 0; i < a->n; i++) {
    const int64_t as_whole = whole ? (int64_t)a->real[i] : 0;

    memcpy(*bytes + HEADER + 8 * i, whole ? (const void *)&as_whole : (const void *)&a->real[i], 8);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies what was written to memory to a stream. Whoever closes the stream finds what could not be written. */
static PetscErrorCode CopyOut(zip_source_t *memory, FILE *stream)
{
  char        block[BUFSIZ];
  zip_int64_t n = 0;

  PetscFunctionBegin;
  PetscCheck(!zip_source_open(memory), PETSC_COMM_SELF, PETSC_ERR_FILE_READ, "%s", ARCHIVE);
  while ((n = zip_source_read(memory, block, sizeof block)) > 0) (void)fwrite(block, 1, (size_t)n, stream);
  PetscCheck(n == 0, PETSC_COMM_SELF, PETSC_ERR_FILE_READ, "%s", ARCHIVE);
  (void)zip_source_close(memory);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmArraysWriteNpz(const MpmArrays *arrays, const char *const whole[], FILE *stream)
{
  zip_source_t *memory  = zip_source_buffer_create(NULL, 0, 0, NULL);
  zip_t        *archive = memory ? zip_open_from_source(memory, ZIP_CREATE | ZIP_TRUNCATE, NULL) : NULL;

  PetscFunctionBegin;
  PetscCheck(archive, PETSC_COMM_SELF, PETSC_ERR_MEM, "%s", ARCHIVE);
  zip_source_keep(memory);
  for (int i = 0; i < arrays->n; i++) {
    const MpmArray *a          = &arrays->array[i];
    PetscBool       as_integer = PETSC_FALSE;
    char            name[MPM_ARRAY_NAME + 4], *bytes;
    size_t          size;
    zip_int64_t     place;

    for (int k = 0; whole[k]; k++)
      if (!strcmp(whole[k], a->name)) as_integer = PETSC_TRUE;
    PetscCall(Pack(a, as_integer, &size, &bytes));
    (void)snprintf(name, sizeof name, "%s.npy", a->name);
    place = zip_file_add(archive, name, zip_source_buffer(archive, bytes, size, 1), 0);
    PetscCheck(place >= 0 && !zip_set_file_compression(archive, (zip_uint64_t)place, ZIP_CM_STORE, 0) &&
                   !zip_file_set_mtime(archive, (zip_uint64_t)place, DAY, 0),
               PETSC_COMM_SELF, PETSC_ERR_LIB, "%s: %s", ARCHIVE, zip_strerror(archive));
  }
  PetscCheck(!zip_close(archive), PETSC_COMM_SELF, PETSC_ERR_LIB, "%s: %s", ARCHIVE, zip_strerror(archive));
  PetscCall(CopyOut(memory, stream));
  zip_source_free(memory);
  PetscFunctionReturn(PETSC_SUCCESS);
}
