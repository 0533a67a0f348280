/* Operators that were probed: which numbers nothing reads, sums, and distances. */
#include "probe/probed.h"
#include "base/hash.h"
#include "linalg/singular.h"
#include <mpmstab_scales.h>
#include <math.h>

#define NORM_STEPS 20 /* of the power method */
#define PHASES 12     /* at which two operators are compared */

/* ---- numbers that nothing reads: strongly connected sets of the pattern, over the numbers of a particle ---- */

/*
   couples[i * width + j]: the largest abs by which number i of a particle feels number j of one; most[i]: the
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

static void SeeBlocks(Pattern *p, const MpmBlocks *b)
{
  for (PetscInt k = 0; k < b->n; k++) {
    PetscBool here = PETSC_TRUE;

    for (PetscInt a = 0; a < b->dim; a++)
      if (b->d[k * b->dim + a]) here = PETSC_FALSE;
    for (PetscInt i = 0; i < b->size; i++)
      for (PetscInt j = 0; j < b->size; j++)
        See(p, i, j, here && i == j ? PETSC_TRUE : PETSC_FALSE, b->A[((size_t)k * b->size + i) * b->size + j]);
  }
}

static PetscErrorCode SeeMatrix(Pattern *p, Mat A)
{
  PetscInt first, last;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(A, &first, &last));
  for (PetscInt row = first; row < last; row++) {
    PetscInt           n;
    const PetscInt    *columns;
    const PetscScalar *values;

    PetscCall(MatGetRow(A, row, &n, &columns, &values));
    for (PetscInt i = 0; i < n; i++) See(p, row, columns[i], row == columns[i] ? PETSC_TRUE : PETSC_FALSE, values[i]);
    PetscCall(MatRestoreRow(A, row, &n, &columns, &values));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, p->couples, p->width * p->width, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, p->most, p->width, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmUnreadFind(const MpmProbed *probed, PetscInt w, PetscReal noise, MpmUnread *u)
{
  Pattern p = {.width = w};
  char   *feels, *apart;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(w * w, &p.couples, w, &p.most));
  if (probed->A)
    PetscCall(SeeMatrix(&p, probed->A));
  else
    SeeBlocks(&p, &probed->blocks);
  *u = (MpmUnread){.width = w};
  PetscCall(PetscCalloc1(w, &u->apart));
  PetscCall(PetscMalloc2(w * w, &feels, w, &apart));
  u->n = mpmstab_set_apart_of_((int)w, noise, p.couples, p.most, feels, apart);
  for (PetscInt i = 0; i < w; i++) {
    u->apart[i] = apart[i] ? PETSC_TRUE : PETSC_FALSE;
    if (u->apart[i]) u->factor = PetscMax(u->factor, p.most[i]);
  }
  PetscCall(PetscFree2(feels, apart));
  PetscCall(PetscFree2(p.couples, p.most));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmUnreadDestroy(MpmUnread *u)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(u->apart));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReduceMatrix(const MpmUnread *u, Mat A, Mat *reduced)
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

static PetscErrorCode ReduceBlocks(const MpmUnread *u, const MpmBlocks *from, MpmBlocks *to)
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

PetscErrorCode MpmProbedReduce(const MpmProbed *from, const MpmUnread *u, MpmProbed *to)
{
  PetscFunctionBegin;
  *to = (MpmProbed){.A = NULL};
  PetscCall(from->A ? ReduceMatrix(u, from->A, &to->A) : ReduceBlocks(u, &from->blocks, &to->blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- sums and distances ---- */

PetscErrorCode MpmProbedCombine(PetscInt n, const MpmProbed each[], const PetscReal weight[], MpmProbed *sum)
{
  MpmBlocks *blocks;

  PetscFunctionBegin;
  *sum = (MpmProbed){.A = NULL};
  if (each[0].A) {
    PetscCall(MatDuplicate(each[0].A, MAT_COPY_VALUES, &sum->A));
    PetscCall(MatScale(sum->A, weight[0]));
    for (PetscInt i = 1; i < n; i++) PetscCall(MatAXPY(sum->A, weight[i], each[i].A, DIFFERENT_NONZERO_PATTERN));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMalloc1(n, &blocks));
  for (PetscInt i = 0; i < n; i++) blocks[i] = each[i].blocks;
  PetscCall(MpmBlocksCombine(n, blocks, weight, &sum->blocks));
  PetscCall(PetscFree(blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbedFree(MpmProbed *probed)
{
  PetscFunctionBegin;
  PetscCall(MpmBlocksFree(&probed->blocks));
  PetscCall(MatDestroy(&probed->A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest Frobenius norm that the symbol of the difference has at some phases. */
static PetscErrorCode BlocksDistance(const MpmBlocks *one, const MpmBlocks *other, PetscReal *distance)
{
  const MpmBlocks both[] = {*one, *other};
  PetscReal       beta[MPM_MAX_DIM];
  double complex *differ;
  MpmBlocks       apart;
  MpmSource       source;
  PetscInt        exponent;

  PetscFunctionBegin;
  *distance = 0;
  PetscCall(MpmBlocksCombine(2, both, (const PetscReal[]){1, -1}, &apart));
  PetscCall(MpmBlocksSource(&apart, "difference", &source));
  PetscCall(PetscMalloc1(apart.size * apart.size, &differ));
  for (PetscInt i = 0; i < PHASES; i++) {
    PetscReal sum = 0;

    for (PetscInt a = 0; a < MPM_MAX_DIM; a++) beta[a] = 2 * PETSC_PI * MpmHash(3, i * MPM_MAX_DIM + a);
    PetscCall(MpmSourceMatrix(&source, beta, differ, &exponent));
    for (PetscInt e = 0; e < apart.size * apart.size; e++) sum += PetscSqr(cabs(differ[e]));
    *distance = PetscMax(*distance, sqrt(sum));
  }
  PetscCall(PetscFree(differ));
  PetscCall(MpmBlocksFree(&apart));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The Euclidean norm of a matrix, by the power method on E^T E. */
static PetscErrorCode Norm2(Mat E, PetscReal *norm)
{
  Vec x, y;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(E, &x, &y));
  PetscCall(MpmSingularStart(51, x));
  *norm = 1;
  for (int step = 0; step < NORM_STEPS && (*norm) > 0; step++) {
    PetscCall(VecNormalize(x, NULL));
    PetscCall(MatMult(E, x, y));
    PetscCall(VecNorm(y, NORM_2, norm));
    PetscCall(MatMultTranspose(E, y, x));
  }
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbedDistance(const MpmProbed *one, const MpmProbed *other, PetscReal *distance)
{
  PetscBool shell = PETSC_FALSE;
  Mat       E;

  PetscFunctionBegin;
  if (one->A) PetscCall(PetscObjectTypeCompare((PetscObject)one->A, MATSHELL, &shell));
  if (!one->A) {
    PetscCall(BlocksDistance(&one->blocks, &other->blocks, distance));
  } else if (shell) {
    PetscCall(MpmProbeShellDistance(one->A, other->A, distance));
  } else {
    PetscCall(MatDuplicate(one->A, MAT_COPY_VALUES, &E));
    PetscCall(MatAXPY(E, -1, other->A, DIFFERENT_NONZERO_PATTERN));
    PetscCall(Norm2(E, distance));
    PetscCall(MatDestroy(&E));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CompareMatrix(Mat A, PetscInt width, const PetscReal amount[], const PetscReal response[],
                                    const PetscBool apart[], PetscReal *differ, PetscInt64 *most)
{
  const PetscScalar *given;
  PetscScalar       *value;
  PetscReal          largest = 0;
  PetscInt           first, last, n, at;
  Vec                x, y;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(MatCreateVecs(A, &x, &y));
  PetscCall(VecGetOwnershipRange(x, &first, &last));
  PetscCall(VecGetArrayWrite(x, &value));
  PetscCall(PetscArraycpy(value, amount + first, last - first));
  PetscCall(VecRestoreArrayWrite(x, &value));
  PetscCall(MatMult(A, x, y));
  PetscCall(VecGetArrayRead(y, &given));
  PetscCall(VecGetArrayWrite(x, &value));
  for (PetscInt64 i = 0; i < n; i++) largest = PetscMax(largest, PetscAbsReal(response[i]));
  for (PetscInt i = first; i < last; i++)
    value[i - first] = apart[i % width] ? 0 : PetscAbsReal(given[i - first] - response[i]);
  PetscCall(VecRestoreArrayWrite(x, &value));
  PetscCall(VecRestoreArrayRead(y, &given));
  PetscCall(VecMax(x, &at, differ));
  *most   = at;
  *differ = largest > 0 ? *differ / largest : 0;
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbedCompare(const MpmProbed *probed, const MpmProbe *p, const MpmProbeLattice *l,
                                const PetscReal amount[], const PetscReal response[], const PetscBool apart[],
                                PetscReal *differ, PetscInt64 *most)
{
  PetscInt compared;

  PetscFunctionBegin;
  *most = MPM_NONE;
  if (probed->A) {
    PetscCall(CompareMatrix(probed->A, p->stepper->width, amount, response, apart, differ, most));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmProbeBlocksCompare(p, l, &probed->blocks, amount, response, apart, differ, &compared);
  if (!compared) *differ = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}
