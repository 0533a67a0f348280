/*
   PETSc's binary format of a sparse matrix, as its manual page of MatView has it: class, rows, columns, entries, the
   number of entries of each row, their columns, their values; whole numbers of 32 bits, or of 64 where PetscInt has them,
   all with the highest byte first. Read by hand, since MatLoad takes any number in a damaged file for granted.
*/
#include "io/matrix_file.h"
#include <string.h>

#define DENSE -1 /* in place of the number of entries */

/* Reads so many numbers of so many bytes each, and turns the bytes round. */
static PetscBool Read(FILE *stream, size_t n, size_t width, void *numbers)
{
  unsigned char *bytes = numbers;

  if (fread(numbers, width, n, stream) != n) return PETSC_FALSE;
  for (size_t i = 0; i < n; i++)
    for (size_t b = 0; b < width / 2; b++) {
      const unsigned char kept = bytes[i * width + b];

      bytes[i * width + b]             = bytes[i * width + width - 1 - b];
      bytes[i * width + width - 1 - b] = kept;
    }
  return PETSC_TRUE;
}

static PetscBool ReadWhole(FILE *stream, size_t width, PetscInt64 *number)
{
  union {
    int32_t narrow;
    int64_t wide;
  } as;

  if (!Read(stream, 1, width, &as)) return PETSC_FALSE;
  *number = width == 4 ? as.narrow : as.wide;
  return PETSC_TRUE;
}

/* An index as PetscInt; what does not fit becomes -1, which is refused later. */
static PetscInt Index(PetscInt64 number)
{
  return number >= 0 && number <= PETSC_MAX_INT ? (PetscInt)number : -1;
}

static PetscBool ReadSparse(FILE *stream, size_t width, MpmEntries *e)
{
  PetscInt64 at = 0, number;

  for (PetscInt64 row = 0; row < e->rows; row++) {
    if (!ReadWhole(stream, width, &number) || number < 0 || number > e->n - at) return PETSC_FALSE;
    for (PetscInt64 i = 0; i < number; i++) e->row[at++] = (PetscInt)row;
  }
  if (at != e->n) return PETSC_FALSE;
  for (PetscInt64 i = 0; i < e->n; i++) {
    if (!ReadWhole(stream, width, &number)) return PETSC_FALSE;
    e->column[i] = Index(number);
  }
  return Read(stream, (size_t)e->n, sizeof(PetscReal), e->value);
}

static PetscBool ReadDense(FILE *stream, MpmEntries *e)
{
  for (PetscInt64 i = 0; i < e->n; i++) {
    e->row[i]    = (PetscInt)(i / e->columns);
    e->column[i] = (PetscInt)(i % e->columns);
  }
  return Read(stream, (size_t)e->n, sizeof(PetscReal), e->value);
}

PetscErrorCode MpmMatrixReadPetsc(FILE *stream, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  size_t     width = 4;
  PetscInt64 head[4], end;
  PetscReal  entries, bytes;
  PetscBool  ok;

  PetscFunctionBegin;
  (void)snprintf(why, MPM_WHY_TEXT, "%s", "it is cut off; allowed: a whole file of PETSc");
  if (!ReadWhole(stream, 4, &head[0])) PetscFunctionReturn(PETSC_SUCCESS);
  if (head[0] == 0) { /* the upper half of a wide number */
    width = 8;
    if (!ReadWhole(stream, 4, &head[0])) PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (int i = 1; i < 4; i++)
    if (!ReadWhole(stream, width, &head[i])) PetscFunctionReturn(PETSC_SUCCESS);
  if (fseeko(stream, 0, SEEK_END)) PetscFunctionReturn(PETSC_SUCCESS);
  end     = (PetscInt64)ftello(stream);
  entries = head[3] == DENSE ? (PetscReal)head[1] * (PetscReal)head[2] : (PetscReal)head[3];
  bytes   = 4.0 * (PetscReal)width + 8 * entries;
  if (head[3] != DENSE) bytes += (PetscReal)width * ((PetscReal)head[1] + entries);
  if (bytes > (PetscReal)end) PetscFunctionReturn(PETSC_SUCCESS);
  if (bytes + 8 * entries == (PetscReal)end && entries > 0)
    (void)snprintf(why, MPM_WHY_TEXT, "%s", "it has complex numbers; allowed: a file of PETSc with real ones");
  else
    why[0] = '\0';
  if (!why[0]) PetscCall(MpmEntriesRoom((PetscReal)head[1], (PetscReal)head[2], entries, e, why));
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  ok = !fseeko(stream, (off_t)(4 * width), SEEK_SET);
  if (ok) ok = head[3] == DENSE ? ReadDense(stream, e) : ReadSparse(stream, width, e);
  if (!ok)
    (void)snprintf(why, MPM_WHY_TEXT, "%s",
                   "the numbers of entries in its rows do not fit; allowed: a whole file of PETSc");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Write(FILE *stream, size_t width, const void *number)
{
  const unsigned char *bytes = number;

  for (size_t b = width; b > 0; b--) (void)fputc(bytes[b - 1], stream);
}

static void WriteWhole(FILE *stream, PetscInt number)
{
  const int32_t narrow = (int32_t)number;

  Write(stream, sizeof narrow, &narrow);
}

void MpmMatrixWritePetsc(const MpmCsr *c, FILE *stream)
{
  WriteWhole(stream, MAT_FILE_CLASSID);
  WriteWhole(stream, c->order);
  WriteWhole(stream, c->order);
  WriteWhole(stream, c->begin[c->order]);
  for (PetscInt i = 0; i < c->order; i++) WriteWhole(stream, c->begin[i + 1] - c->begin[i]);
  for (PetscInt k = 0; k < c->begin[c->order]; k++) WriteWhole(stream, c->column[k]);
  for (PetscInt k = 0; k < c->begin[c->order]; k++) Write(stream, sizeof(PetscReal), &c->value[k]);
}
