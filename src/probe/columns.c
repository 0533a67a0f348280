/* All columns one by one, and the operator as a shell. */
#include "probe/columns.h"
#include "base/hash.h"
#include <mpmstab/errors.h>
#include <math.h>

#define VECTORS 4 /* random ones, for a norm */

/* The rows of a rank are whole particles. */
static PetscInt LocalRows(const MpmStepper *s, PetscInt width)
{
  const PetscMPIInt ranks = MpmRanksOf(PETSC_COMM_WORLD), rank = MpmRankOf(PETSC_COMM_WORLD);

  return (PetscInt)(s->particles * (rank + 1) / ranks - s->particles * rank / ranks) * width;
}

PetscErrorCode MpmProbeNewMatrix(const MpmStepper *s, PetscInt width, PetscInt most, Mat *A)
{
  const PetscInt rows = LocalRows(s, width), all = (PetscInt)s->particles * width;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(PETSC_COMM_WORLD, rows, rows, all, all, most ? PetscMin(most, rows) : PETSC_DEFAULT, NULL,
                         most ? PetscMin(most, all - rows) : PETSC_DEFAULT, NULL, A));
  PetscCall(MatSetOption(*A, most ? MAT_IGNORE_ZERO_ENTRIES : MAT_NEW_NONZERO_ALLOCATION_ERR,
                         most ? PETSC_TRUE : PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- columns ---- */

PetscErrorCode MpmProbeFillDiagonal(Mat A)
{
  PetscInt first, last;

  PetscFunctionBegin;
  PetscCall(MatAssemblyBegin(A, MAT_FLUSH_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FLUSH_ASSEMBLY));
  PetscCall(MatSetOption(A, MAT_IGNORE_ZERO_ENTRIES, PETSC_FALSE));
  PetscCall(MatGetOwnershipRange(A, &first, &last));
  for (PetscInt i = first; i < last; i++) PetscCall(MatSetValue(A, i, i, 0, ADD_VALUES));
  PetscCall(MatAssemblyBegin(A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  const MpmProbe *probe;
  PetscReal       size;
  PetscInt       *rows;
  Mat             A;
} Columns;

static PetscErrorCode Perturb(void *context, PetscInt j, MpmPerturbation *d)
{
  const Columns *c = context;

  PetscFunctionBegin;
  if (MpmProbeIsApart(c->probe, j % c->probe->stepper->width)) PetscFunctionReturn(PETSC_SUCCESS);
  d->unknown[0]     = j;
  d->amount[d->n++] = c->size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Take(void *context, PetscInt j, const MpmPerturbation *d)
{
  const Columns *c = context;
  const PetscInt n = (PetscInt)c->probe->stepper->particles * c->probe->stepper->width;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < n; i++) d->response[i] /= d->amount[0];
  PetscCall(MatSetValues(c->A, n, c->rows, 1, &j, d->response, ADD_VALUES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeColumns(MpmProbe *p, PetscReal size, Mat *A)
{
  const PetscInt n = (PetscInt)p->stepper->particles * p->stepper->width;
  Columns        c = {.probe = p, .size = size};

  PetscFunctionBegin;
  PetscCall(MpmProbeNewMatrix(p->stepper, p->stepper->width, n, A));
  PetscCall(PetscMalloc1(n, &c.rows));
  for (PetscInt i = 0; i < n; i++) c.rows[i] = i;
  c.A = *A;
  PetscCall(MpmProbeEach(p, n, 1, Perturb, Take, &c));
  PetscCall(PetscFree(c.rows));
  PetscCall(MpmProbeFillDiagonal(*A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the shell ---- */

/* all: the vector on every rank; unknown, amount, response: of a product. */
typedef struct {
  MpmProbe   *probe;
  PetscReal   size, *amount, *response;
  PetscInt64 *unknown;
  Vec         all;
  VecScatter  scatter;
} Shell;

/* The response to size / largest(x) x, over that factor. */
static PetscErrorCode Respond(Shell *shell, const PetscScalar x[], PetscReal largest)
{
  const MpmStepper *s = shell->probe->stepper;
  const PetscInt64  n = s->particles * s->width;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < n; i++) {
    shell->unknown[i] = i;
    shell->amount[i]  = shell->size / largest * x[i];
  }
  if (MpmRankOf(PETSC_COMM_WORLD) == 0)
    PetscCall(MpmProbeRespond(shell->probe, PETSC_FALSE, n, shell->unknown, shell->amount, shell->response));
  PetscCall(MpmStepperAgree(shell->probe->stepper));
  PetscCallMPI(MPI_Bcast(shell->response, (PetscMPIInt)n, MPIU_REAL, 0, PETSC_COMM_WORLD));
  for (PetscInt64 i = 0; i < n; i++) shell->response[i] *= largest / shell->size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Multiply(Mat A, Vec x, Vec y)
{
  PetscReal          largest;
  PetscInt           first, last;
  const PetscScalar *values;
  PetscScalar       *own;
  Shell             *shell;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(A, &shell));
  PetscCall(VecNorm(x, NORM_INFINITY, &largest));
  PetscCall(VecSet(y, 0));
  if (!(largest > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecScatterBegin(shell->scatter, x, shell->all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(shell->scatter, x, shell->all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(shell->all, &values));
  PetscCall(Respond(shell, values, largest));
  PetscCall(VecRestoreArrayRead(shell->all, &values));
  PetscCall(VecGetOwnershipRange(y, &first, &last));
  PetscCall(VecGetArray(y, &own));
  PetscCall(PetscArraycpy(own, shell->response + first, last - first));
  PetscCall(VecRestoreArray(y, &own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A vector of random numbers, or of ones with random signs; the same on any number of ranks. */
static PetscErrorCode SetRandom(PetscInt64 seed, PetscBool signs, Vec x)
{
  PetscInt     first, last;
  PetscScalar *value;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(x, &first, &last));
  PetscCall(VecGetArray(x, &value));
  for (PetscInt i = first; i < last; i++) {
    const PetscReal number = 2 * MpmHash(seed, i) - 1;

    value[i - first] = signs ? copysign(1, number) : number;
  }
  PetscCall(VecRestoreArray(x, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Norm(Mat A, NormType type, PetscReal *norm)
{
  Vec x, y;

  PetscFunctionBegin;
  PetscCheck(type == NORM_INFINITY, PETSC_COMM_SELF, PETSC_ERR_SUP, "only the infinity norm");
  PetscCall(MatCreateVecs(A, &x, &y));
  *norm = 0;
  for (PetscInt k = 0; k < VECTORS; k++) {
    PetscReal largest;

    PetscCall(SetRandom(61 + k, PETSC_TRUE, x));
    PetscCall(MatMult(A, x, y));
    PetscCall(VecNorm(y, NORM_INFINITY, &largest));
    *norm = PetscMax(*norm, largest);
  }
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Mat A)
{
  Shell *shell;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(A, &shell));
  PetscCall(PetscFree3(shell->unknown, shell->amount, shell->response));
  PetscCall(VecDestroy(&shell->all));
  PetscCall(VecScatterDestroy(&shell->scatter));
  PetscCall(PetscFree(shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeShell(MpmProbe *p, PetscReal size, Mat *A)
{
  const PetscInt rows = LocalRows(p->stepper, p->stepper->width),
                 n    = (PetscInt)p->stepper->particles * p->stepper->width;
  Shell *shell;
  Vec    x;

  PetscFunctionBegin;
  PetscCall(PetscNew(&shell));
  shell->probe = p;
  shell->size  = size;
  PetscCall(PetscMalloc3(n, &shell->unknown, n, &shell->amount, n, &shell->response));
  PetscCall(MatCreateShell(PETSC_COMM_WORLD, rows, rows, n, n, shell, A));
  PetscCall(MatShellSetOperation(*A, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatShellSetOperation(*A, MATOP_NORM, (void (*)(void))Norm));
  PetscCall(MatShellSetOperation(*A, MATOP_DESTROY, (void (*)(void))Destroy));
  PetscCall(MatCreateVecs(*A, &x, NULL));
  PetscCall(VecScatterCreateToAll(x, &shell->scatter, &shell->all));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeShellDistance(Mat one, Mat other, PetscReal *distance)
{
  Vec x, y[2];

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(one, &x, &y[0]));
  PetscCall(VecDuplicate(y[0], &y[1]));
  *distance = 0;
  for (PetscInt k = 0; k < VECTORS; k++) {
    PetscReal of, norm;

    PetscCall(SetRandom(71 + k, PETSC_FALSE, x));
    PetscCall(MatMult(one, x, y[0]));
    PetscCall(MatMult(other, x, y[1]));
    PetscCall(VecAXPY(y[0], -1, y[1]));
    PetscCall(VecNorm(y[0], NORM_2, &norm));
    PetscCall(VecNorm(x, NORM_2, &of));
    *distance = PetscMax(*distance, norm / of);
  }
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y[0]));
  PetscCall(VecDestroy(&y[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
