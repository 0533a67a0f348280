/* Strongly connected sets of the pattern of an operator, over the numbers of a particle. */
#include "probe/unread.h"
#include <mpmstab_scales.h>

/*
   Pattern - couples[i * width + j]: the largest abs by which number i of a particle feels number j of one; most[i]: the
   largest abs by which number i of a particle feels itself.
*/
typedef struct {
  PetscInt   width;
  PetscReal *couples, *most;
} Pattern;

static void See(Pattern *p, PetscInt row, PetscInt column, PetscBool own, PetscReal value)
{
  const PetscInt i = row % p->width, j = column % p->width;

  if (own)
    p->most[i] = PetscMax(p->most[i], PetscAbsReal(value));
  else
    p->couples[i * p->width + j] = PetscMax(p->couples[i * p->width + j], PetscAbsReal(value));
}

static PetscErrorCode Begin(PetscInt width, Pattern *p)
{
  PetscFunctionBegin;
  p->width = width;
  PetscCall(PetscCalloc2(width * width, &p->couples, width, &p->most));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetApart(Pattern *p, PetscReal noise, MpmUnread *u)
{
  const PetscInt w = p->width;
  char          *feels, *apart;

  PetscFunctionBegin;
  *u = (MpmUnread){.width = w};
  PetscCall(PetscCalloc1(w, &u->apart));
  PetscCall(PetscMalloc2(w * w, &feels, w, &apart));
  u->n = mpmstab_set_apart_of_((int)w, noise, p->couples, p->most, feels, apart);
  for (PetscInt i = 0; i < w; i++) {
    u->apart[i] = apart[i] ? PETSC_TRUE : PETSC_FALSE;
    if (u->apart[i]) u->factor = PetscMax(u->factor, p->most[i]);
  }
  PetscCall(PetscFree2(feels, apart));
  PetscCall(PetscFree2(p->couples, p->most));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmUnreadOfBlocks(const MpmBlocks *b, PetscInt width, PetscReal noise, MpmUnread *u)
{
  Pattern p;

  PetscFunctionBegin;
  PetscCall(Begin(width, &p));
  for (PetscInt k = 0; k < b->n; k++) {
    PetscBool here = PETSC_TRUE;

    for (PetscInt a = 0; a < b->dim; a++)
      if (b->d[k * b->dim + a]) here = PETSC_FALSE;
    for (PetscInt i = 0; i < b->size; i++)
      for (PetscInt j = 0; j < b->size; j++)
        See(&p, i, j, here && i == j ? PETSC_TRUE : PETSC_FALSE, b->A[((size_t)k * b->size + i) * b->size + j]);
  }
  PetscCall(SetApart(&p, noise, u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmUnreadOfMatrix(Mat A, PetscInt width, PetscReal noise, MpmUnread *u)
{
  PetscInt first, last;
  Pattern  p;

  PetscFunctionBegin;
  PetscCall(Begin(width, &p));
  PetscCall(MatGetOwnershipRange(A, &first, &last));
  for (PetscInt row = first; row < last; row++) {
    PetscInt           n;
    const PetscInt    *columns;
    const PetscScalar *values;

    PetscCall(MatGetRow(A, row, &n, &columns, &values));
    for (PetscInt i = 0; i < n; i++) See(&p, row, columns[i], row == columns[i] ? PETSC_TRUE : PETSC_FALSE, values[i]);
    PetscCall(MatRestoreRow(A, row, &n, &columns, &values));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, p.couples, width * width, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, p.most, width, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  PetscCall(SetApart(&p, noise, u));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmUnreadDestroy(MpmUnread *u)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(u->apart));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmUnreadReduce(const MpmUnread *u, Mat A, Mat *reduced)
{
  PetscInt first, last, *kept, n = 0;
  IS       is;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(A, &first, &last));
  PetscCall(PetscMalloc1(last - first, &kept));
  for (PetscInt row = first; row < last; row++)
    if (!u->apart[row % u->width]) kept[n++] = row;
  PetscCall(ISCreateGeneral(PETSC_COMM_WORLD, n, kept, PETSC_OWN_POINTER, &is));
  PetscCall(MatCreateSubMatrix(A, is, is, MAT_INITIAL_MATRIX, reduced));
  PetscCall(ISDestroy(&is));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmUnreadReduceBlocks(const MpmUnread *u, const MpmBlocks *from, MpmBlocks *to)
{
  PetscInt *kept, n = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(from->size, &kept));
  for (PetscInt i = 0; i < from->size; i++)
    if (!u->apart[i % u->width]) kept[n++] = i;
  *to      = *from;
  to->size = n;
  PetscCall(MpmBlocksAllocate(to));
  PetscCall(PetscArraycpy(to->d, from->d, from->n * from->dim));
  for (size_t b = 0; b < (size_t)from->n; b++)
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++)
        to->A[(b * n + i) * n + j] = from->A[(b * from->size + kept[i]) * from->size + kept[j]];
  PetscCall(PetscFree(kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}
