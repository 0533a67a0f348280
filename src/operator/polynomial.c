/*
   The operator as a polynomial in the Courant number k. Registers hold a block of columns for each power of k, and a
   multiplication by k moves each block to the next one. So the coefficients of a step come out of the same operations
   as its matrix at one k, without interpolation.

     A_t(k) = C_t0 + k (C_t1 + k (C_t2 + ...)),   A(k) = A_(period-1)(k) ... A_0(k)
*/
#include "base/power_of_two.h"
#include "operator/polynomial.h"
#include "program/program.h"
#include <mpmstab/operator.h>
#include <petscblaslapack.h>
#include <math.h>

#define RESCALE_AT 200 /* powers of two */

/* No power of k beyond this one can come out of a step. */
static PetscInt DegreeOf(const MpmTable *table)
{
  PetscInt degree = 0;

  for (PetscInt o = 0; o < table->nops; o++) degree += table->ops[o].coefficient;
  return degree;
}

/* Copies a step's registers into its coefficients. */
static PetscErrorCode CopyStep(const MpmMatrices *m, PetscReal coefficients[])
{
  const PetscInt fields = m->registers.nout, particles = m->registers.rows[0];

  PetscFunctionBegin;
  for (PetscInt f = 0; f < fields; f++) {
    if (!m->reg[f]) continue;
    for (PetscInt p = 0; p < particles; p++) {
      const PetscInt    *columns;
      const PetscScalar *values;
      PetscInt           n;

      PetscCall(MatGetRow(m->reg[f], p, &n, &columns, &values));
      for (PetscInt c = 0; c < n; c++) coefficients[(columns[c] * particles + p) * fields + f] = values[c];
      PetscCall(MatRestoreRow(m->reg[f], p, &n, &columns, &values));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* D C D^-1 of all coefficients, D: the units of the operator's balanced. */
static PetscErrorCode Balance(MpmPolynomial *a, const MpmOperator *op)
{
  const PetscInt   n = a->order, matrices = a->period * (a->degree + 1);
  const PetscReal *unit;

  PetscFunctionBegin;
  if (!op->unit) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(op->unit, &unit));
  for (PetscInt m = 0; m < matrices; m++)
    for (PetscInt c = 0; c < n; c++)
      for (PetscInt i = 0; i < n; i++) a->coefficients[(m * n + c) * n + i] *= unit[i] / unit[c];
  PetscCall(VecRestoreArrayRead(op->unit, &unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least k at which some C_tj k^j has a number of abs 1. */
static PetscReal ScaleOf(const MpmPolynomial *a)
{
  const PetscInt n     = a->order * a->order;
  PetscReal      scale = INFINITY;

  for (PetscInt m = 0; m < a->period * (a->degree + 1); m++) {
    const PetscInt power   = m % (a->degree + 1);
    PetscReal      largest = 0;

    for (PetscInt i = 0; i < n && power > 0; i++) largest = PetscMax(largest, fabs(a->coefficients[m * n + i]));
    if (largest > 0) scale = PetscMin(scale, pow(largest, -1.0 / (PetscReal)power));
  }
  return scale;
}

PetscErrorCode MpmPolynomialCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                   MpmPolynomial *a)
{
  MpmOperator *op;
  PetscInt     square, count;

  PetscFunctionBegin;
  PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, layout, scheme, step, &op));
  *a     = (MpmPolynomial){.order = op->order, .period = op->period, .degree = DegreeOf(scheme->table)};
  square = a->order * a->order;
  count  = a->period * (a->degree + 1) * square;
  PetscCall(PetscMalloc4(count, &a->coefficients, square, &a->step, square, &a->product, square, &a->next));
  PetscCall(PetscArrayzero(a->coefficients, count));
  for (PetscInt t = 0; t < a->period; t++) {
    MpmMatrices registers;
    MpmSlab     slab;

    PetscCall(MpmSlabOf(PETSC_COMM_SELF, layout, scheme, step, &slab));
    PetscCall(MpmMatricesOfSlab(&slab, a->degree, &registers));
    PetscCall(MpmMatricesStep(&registers, &slab, t));
    PetscCall(CopyStep(&registers, a->coefficients + t * (a->degree + 1) * square));
    PetscCall(MpmMatricesDestroy(&registers));
  }
  PetscCall(Balance(a, op));
  PetscCall(MpmOperatorDestroy(&op));
  a->scale = ScaleOf(a);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPolynomialDestroy(MpmPolynomial *a)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(a->coefficients, a->step, a->product, a->next));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A_t(k) by Horner's rule. */
static void SetStep(MpmPolynomial *a, PetscInt t, PetscReal k)
{
  const PetscInt   n     = a->order * a->order;
  const PetscReal *first = a->coefficients + t * (a->degree + 1) * n;

  for (PetscInt i = 0; i < n; i++) a->step[i] = first[a->degree * n + i];
  for (PetscInt j = a->degree - 1; j >= 0; j--)
    for (PetscInt i = 0; i < n; i++) a->step[i] = a->step[i] * k + first[j * n + i];
}

/* Keeps the product in range. */
static PetscInt Rescale(PetscInt n, PetscReal matrix[])
{
  PetscReal largest = 0;
  PetscInt  shift;

  for (PetscInt i = 0; i < n; i++) largest = PetscMax(largest, fabs(matrix[i]));
  shift = MpmPowerToTakeOut(largest, RESCALE_AT);
  for (PetscInt i = 0; i < n && shift; i++) matrix[i] *= scalbn(1, -(int)shift);
  return shift;
}

PetscErrorCode MpmPolynomialMatrix(MpmPolynomial *a, PetscReal courant, PetscReal matrix[], PetscInt *exponent)
{
  const PetscInt  square = a->order * a->order;
  const PetscReal one = 1, zero = 0;
  PetscBLASInt    n;

  PetscFunctionBegin;
  PetscCall(PetscBLASIntCast(a->order, &n));
  *exponent = 0;
  for (PetscInt t = 0; t < a->period; t++) {
    PetscReal *kept = a->product;

    SetStep(a, t, courant);
    if (t == 0) {
      PetscCall(PetscArraycpy(a->product, a->step, square));
      continue;
    }
    PetscCallBLAS("BLASgemm", BLASgemm_("N", "N", &n, &n, &n, &one, a->step, &n, a->product, &n, &zero, a->next, &n));
    a->product = a->next;
    a->next    = kept;
    *exponent += Rescale(square, a->product);
  }
  PetscCall(PetscArraycpy(matrix, a->product, square));
  PetscFunctionReturn(PETSC_SUCCESS);
}
