/*
   norm(A^n) is the largest singular value of the product of n steps. The product is never formed; it is applied as

     x -> A(n-1) ... A(0) x,   y -> A(0)^T ... A(n-1)^T y

   by Lanczos bidiagonalization (linalg/singular.h). After some steps the product is divided by a power of two, so that
   growth over any number of steps stays in range. One vector is followed once to find these powers. Where a smaller
   matrix has the powers of A, its products take the place of those of A (linalg/reduced.h).
*/
#include "base/power_of_two.h"
#include "linalg/singular.h"
#include "scene/layout.h"
#include <mpmstab/errors.h>
#include "base/progress.h"
#include "analysis/transient.h"
#include "linalg/reduced.h"
#include <math.h>

#define EVERY 16          /* norms are computed at all steps up to this one, and later at spaced ones */
#define SPACING 1.25      /* ratio of spaced steps */
#define RESCALE_AT 64     /* exponent of two at which the product is rescaled */
#define BASIS 32          /* vectors of the Krylov space */
#define TOLERANCE 1e-6    /* relative residual; the error is about its square over the gap */
#define OF_NONZERO 12     /* bytes of a nonzero */
#define NORMS_DIFFER 1e-9 /* norms whose logarithms differ by less count as equal */
#define LATE 4            /* the power is fitted from step last / LATE on */
#define FEWEST 4          /* norms needed for a fit */

/*
   The steps of a period, and the power of two that is taken out after each of the product's n steps. powers: those of a
   smaller matrix, where there is one.
*/
typedef struct {
  PetscInt         n, period, exponent, *shift;
  Mat             *step;
  Vec              work[2], weights;
  PetscReal        nonzeros;
  PetscBool        smaller;
  MpmReducedPowers powers;
} Product;

/* The product of n steps, or its transpose, which takes the steps from the last one on. */
static PetscErrorCode Apply(Mat matrix, PetscBool transpose, Vec x, Vec y)
{
  Product *p;
  Vec      in = x;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &p));
  if (p->smaller) {
    PetscCall(MpmReducedPowersMult(&p->powers, p->n, p->shift, transpose, x, y));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt i = 0; i < p->n; i++) {
    const PetscInt k   = transpose ? p->n - 1 - i : i;
    Vec            out = i == p->n - 1 ? y : p->work[i % 2];

    PetscCall((transpose ? MatMultTranspose : MatMult)(p->step[k % p->period], in, out));
    if (p->shift[k]) PetscCall(VecScale(out, scalbn(1, -(int)p->shift[k])));
    in = out;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Multiply(Mat matrix, Vec x, Vec y)
{
  return Apply(matrix, PETSC_FALSE, x, y);
}

static PetscErrorCode MultiplyTranspose(Mat matrix, Vec x, Vec y)
{
  return Apply(matrix, PETSC_TRUE, x, y);
}

static PetscErrorCode ProductCreate(const MpmOperator *op, const MpmReduced *nodal, PetscInt last, Product *p)
{
  PetscFunctionBegin;
  *p = (Product){.period = PetscMin(op->parts, last), .smaller = nodal ? PETSC_TRUE : PETSC_FALSE};
  PetscCall(PetscMalloc2(p->period, &p->step, last, &p->shift));
  for (PetscInt k = 0; k < p->period; k++) {
    Mat     A;
    MatInfo info;

    PetscCall(MpmOperatorStep(op, k, &A, &p->exponent));
    PetscCall(MpmOperatorWeigh(op, A, &p->step[k]));
    PetscCall(MatDestroy(&A));
    PetscCall(MatGetInfo(p->step[k], MAT_GLOBAL_SUM, &info));
    p->nonzeros += info.nz_used;
    if (k == 0 && op->layout)
      PetscCall(MpmLayoutCheckMemory(PetscObjectComm((PetscObject)op->A), op->layout,
                                     OF_NONZERO * p->nonzeros * p->period, "powers, with all steps of the period,"));
  }
  PetscCall(MatCreateVecs(p->step[0], &p->work[0], &p->work[1]));
  if (nodal) {
    PetscCall(MpmOperatorWeights(op, &p->weights));
    PetscCall(MpmReducedPowersCreate(nodal, p->weights, &p->powers));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ProductDestroy(Product *p)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < p->period; k++) PetscCall(MatDestroy(&p->step[k]));
  PetscCall(PetscFree2(p->step, p->shift));
  PetscCall(VecDestroy(&p->work[0]));
  PetscCall(VecDestroy(&p->work[1]));
  if (p->smaller) PetscCall(MpmReducedPowersDestroy(&p->powers));
  PetscCall(VecDestroy(&p->weights));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds the powers of two that keep the image of one vector near its size. finite: whether doubles can hold the image.
*/
static PetscErrorCode FindShifts(Product *p, Vec start, PetscInt last, PetscBool *finite)
{
  Vec       in, out;
  PetscReal norm;

  PetscFunctionBegin;
  *finite = PETSC_TRUE;
  PetscCall(PetscArrayzero(p->shift, last));
  PetscCall(VecDuplicate(start, &in));
  PetscCall(VecDuplicate(start, &out));
  PetscCall(VecCopy(start, in));
  for (PetscInt k = 0; k < last && *finite; k++) {
    PetscCall(MatMult(p->step[k % p->period], in, out));
    PetscCall(VecNorm(out, NORM_2, &norm));
    *finite     = isfinite(norm) ? PETSC_TRUE : PETSC_FALSE;
    p->shift[k] = MpmPowerToTakeOut(norm, RESCALE_AT);
    if (p->shift[k]) PetscCall(VecScale(out, scalbn(1, -(int)p->shift[k])));
    PetscCall(VecSwap(in, out));
  }
  PetscCall(VecDestroy(&in));
  PetscCall(VecDestroy(&out));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt Next(PetscInt step, PetscInt last)
{
  return PetscMin(step < EVERY ? step + 1 : (PetscInt)ceil(SPACING * step), last);
}

static PetscErrorCode Norms(const MpmOperator *op, Product *p, PetscInt last, MpmTransient *t)
{
  PetscInt    rows, exponent = 0, done = 0, work = 0;
  PetscBool   finite;
  MpmProgress progress;
  Mat         matrix;
  Vec         start;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(p->step[0], &start, NULL));
  PetscCall(MpmSingularStart(0, start));
  PetscCall(FindShifts(p, start, last, &finite));
  PetscCall(VecGetLocalSize(start, &rows));
  PetscCall(MatCreateShell(PetscObjectComm((PetscObject)start), rows, rows, op->order, op->order, p, &matrix));
  PetscCall(MatShellSetOperation(matrix, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatShellSetOperation(matrix, MATOP_MULT_TRANSPOSE, (void (*)(void))MultiplyTranspose));
  for (PetscInt i = 0; i < t->n; i++) work += t->steps[i];
  PetscCall(MpmProgressBegin("steps of powers", &progress));
  for (PetscInt i = 1; i < t->n; i++) {
    PetscReal sigma = NAN;

    for (; p->n < t->steps[i]; p->n++) exponent += p->shift[p->n] + p->exponent;
    if (finite) PetscCall(MpmSingularLargest(matrix, start, BASIS, TOLERANCE, &sigma));
    t->norm[i]     = scalbn(sigma, (int)exponent);
    t->log_norm[i] = log(sigma) + exponent * log(2);
    if (isinf(t->norm[i])) t->norm[i] = NAN;
    if (isnan(sigma)) t->missing++;
    PetscCall(MpmProgressUpdate(&progress, done += t->steps[i], work));
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscCall(MatDestroy(&matrix));
  PetscCall(VecDestroy(&start));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds the largest norm, also relative to growth^n, and fits a power of n to the late steps by least squares. It is
   fitted to the largest norm(A^n) / growth^n so far, since the norms themselves may swing.
*/
static void Judge(PetscReal growth, MpmTransient *t)
{
  const PetscReal log_growth = log(growth);
  PetscReal       largest = -INFINITY, excess = -INFINITY, points = 0, mean[2] = {0}, product = 0, square = 0;

  for (PetscInt i = 0; i < t->n; i++) {
    const PetscReal x = log(t->steps[i]), y = t->log_norm[i] - t->steps[i] * log_growth;

    if (t->log_norm[i] > largest + NORMS_DIFFER) { /* the first of several that are equal */
      largest    = t->log_norm[i];
      t->largest = t->norm[i];
      t->at_step = t->steps[i];
    }
    if (y > excess + NORMS_DIFFER) {
      excess       = y;
      t->excess_at = t->steps[i];
    }
    if (!isfinite(excess) || t->steps[i] < PetscMax(1, t->steps[t->n - 1] / LATE)) continue;
    points++;
    mean[0] += (x - mean[0]) / points;
    mean[1] += (excess - mean[1]) / points;
    product += x * excess;
    square += x * x;
  }
  t->excess = isfinite(log_growth) ? exp(excess) : NAN;
  t->power  = points >= FEWEST ? (product - points * mean[0] * mean[1]) / (square - points * mean[0] * mean[0]) : NAN;
}

PetscErrorCode MpmTransientCreate(const MpmOperator *op, const MpmReduced *nodal, PetscInt last, PetscReal growth,
                                  MpmTransient **transient)
{
  const PetscReal begin = MPI_Wtime();
  const PetscInt  each  = op->period / op->parts;
  Product         product;
  MpmTransient   *t;

  PetscFunctionBegin;
  PetscCall(PetscNew(transient));
  t    = *transient;
  t->n = 1;
  last /= each;
  for (PetscInt step = 0; step < last; step = Next(step, last)) t->n++;
  PetscCall(PetscMalloc3(t->n, &t->steps, t->n, &t->norm, t->n, &t->log_norm));
  t->steps[0]    = 0;
  t->norm[0]     = 1;
  t->log_norm[0] = 0;
  for (PetscInt i = 1; i < t->n; i++) t->steps[i] = Next(t->steps[i - 1], last);
  PetscCall(ProductCreate(op, nodal, last, &product));
  PetscCall(Norms(op, &product, last, t));
  PetscCall(ProductDestroy(&product));
  for (PetscInt i = 0; i < t->n; i++) t->steps[i] *= each;
  Judge(growth, t);
  t->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTransientDestroy(MpmTransient **transient)
{
  PetscFunctionBegin;
  if (!*transient) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3((*transient)->steps, (*transient)->norm, (*transient)->log_norm));
  PetscCall(PetscFree(*transient));
  PetscFunctionReturn(PETSC_SUCCESS);
}
