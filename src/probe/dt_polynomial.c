/* A code's operator as a polynomial of its time step. */
#include "probe/dt_polynomial.h"
#include "base/hash.h"
#include "linalg/dense.h"
#include <slepcbv.h>
#include <math.h>

#define FEWEST 3      /* time steps: most steps are quadratic */
#define FORETOLD 1e-7 /* relative; a response that differs by more is not foretold */
#define FORETOLD_SINGLE 1e-4

static const PetscReal nodes[]  = {1, 0.5, 1.5, 0.75, 1.25, 0.25}; /* times the centre */
static const PetscReal others[] = {0.35, 1.35};

static void Weights(const MpmDtPolynomial *f, PetscReal dt, PetscReal weight[])
{
  for (PetscInt i = 0; i < f->n; i++) {
    weight[i] = 1;
    for (PetscInt j = 0; j < f->n; j++)
      if (j != i) weight[i] *= (dt - f->dt[j]) / (f->dt[i] - f->dt[j]);
  }
}

/* Prepares the program for a time step. */
static PetscErrorCode GoTo(const MpmDtPolynomial *f, PetscReal dt)
{
  PetscFunctionBegin;
  PetscCall(MpmStepperSet(f->program->stepper, f->name, dt));
  PetscCall(MpmProgramPrepare(f->program));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the operator is one of a state that stays where it is, and has a matrix. */
static PetscBool Fits(const MpmProgram *p)
{
  PetscInt64 at;

  for (PetscInt a = 0; a < p->stepper->dim; a++)
    if (p->probe.shift[a]) return PETSC_FALSE;
  return !p->shell && p->probe.steps == p->stepper->steps && MpmProbeMoved(&p->probe, &at) <= MPM_AT_REST ? PETSC_TRUE
                                                                                                          : PETSC_FALSE;
}

/* Adds the operator at a time step. */
static PetscErrorCode Add(MpmDtPolynomial *f, PetscReal dt, PetscBool *fits)
{
  MpmProgram *p = f->program;
  PetscReal   farthest;

  PetscFunctionBegin;
  PetscCall(GoTo(f, dt));
  *fits = Fits(p);
  if (*fits && p->kind == MPM_PROBE_BLOCH) {
    PetscCall(MpmProbeBlocks(&p->probe, &p->lattice, MpmProbeLatticeMiddle(&p->lattice), p->probe.size,
                             &f->blocks[f->n], &farthest));
    if (!f->n) PetscCall(MpmUnreadOfBlocks(&f->blocks[0], p->stepper->width, MpmProgramNoise(p), &f->unread));
  } else if (*fits) {
    p->probe.apart = f->given;
    PetscCall(MpmProgramColumns(p, p->probe.size, &f->A[f->n]));
    p->probe.apart = NULL;
    if (!f->n) PetscCall(MpmUnreadOfMatrix(f->A[0], p->stepper->width, MpmProgramNoise(p), &f->unread));
  }
  if (*fits) f->dt[f->n++] = dt;
  PetscCall(MpmProgramForget(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of matrices at a time step. */
static PetscErrorCode Combine(const MpmDtPolynomial *f, const Mat A[], PetscReal dt, Mat *sum)
{
  PetscReal weight[MPM_DT_NODES];

  PetscFunctionBegin;
  Weights(f, dt, weight);
  PetscCall(MatDuplicate(A[0], MAT_COPY_VALUES, sum));
  PetscCall(MatScale(*sum, weight[0]));
  for (PetscInt i = 1; i < f->n; i++) PetscCall(MatAXPY(*sum, weight[i], A[i], DIFFERENT_NONZERO_PATTERN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDtPolynomialHolds(MpmDtPolynomial *f, PetscReal dt, PetscBool *holds)
{
  MpmProgram *p = f->program;
  PetscReal   weight[MPM_DT_NODES], differs = 0;
  PetscInt64  at;
  MpmBlocks   blocks;
  Mat         A;

  PetscFunctionBegin;
  PetscCall(GoTo(f, dt));
  if (f->A[0]) {
    PetscCall(Combine(f, f->A, dt, &A));
    PetscCall(MpmCertifyColumns(&p->probe, A, f->unread.apart, &differs, &at));
    PetscCall(MatDestroy(&A));
  } else {
    Weights(f, dt, weight);
    PetscCall(MpmBlocksCombine(f->n, f->blocks, weight, &blocks));
    PetscCall(MpmCertifyBlockColumns(&p->probe, &p->lattice, &blocks, f->unread.apart, &differs));
    PetscCall(MpmBlocksFree(&blocks));
  }
  PetscCallMPI(MPI_Bcast(&differs, 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
  *holds = differs <= (p->probe.single ? FORETOLD_SINGLE : FORETOLD) ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(MpmProgramForget(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDtPolynomialFind(MpmProgram *p, PetscReal centre, MpmDtPolynomial *f, PetscBool *fits)
{
  PetscBool foretold = PETSC_FALSE;

  PetscFunctionBegin;
  f->program = p;
  *fits      = PETSC_TRUE;
  while (*fits && !foretold && f->n < MPM_DT_NODES) {
    PetscCall(Add(f, nodes[f->n] * centre, fits));
    foretold = f->n >= FEWEST ? PETSC_TRUE : PETSC_FALSE;
    for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(others) && foretold && *fits; i++)
      PetscCall(MpmDtPolynomialHolds(f, others[i] * centre, &foretold));
  }
  *fits = foretold && *fits ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDtPolynomialDestroy(MpmDtPolynomial *f)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < MPM_DT_NODES; i++) {
    PetscCall(MpmBlocksFree(&f->blocks[i]));
    PetscCall(MatDestroy(&f->A[i]));
    PetscCall(MatDestroy(&f->small[i]));
  }
  f->n = 0;
  PetscCall(MpmUnreadDestroy(&f->unread));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDtPolynomialBlocks(const MpmDtPolynomial *f, PetscReal dt, MpmBlocks *blocks)
{
  PetscReal weight[MPM_DT_NODES];
  MpmBlocks all;

  PetscFunctionBegin;
  Weights(f, dt, weight);
  PetscCall(MpmBlocksCombine(f->n, f->blocks, weight, &all));
  PetscCall(MpmUnreadReduceBlocks(&f->unread, &all, blocks));
  PetscCall(MpmBlocksFree(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDtPolynomialMatrix(const MpmDtPolynomial *f, PetscReal dt, Mat *A)
{
  Mat all;

  PetscFunctionBegin;
  PetscCall(Combine(f, f->A, dt, &all));
  PetscCall(MpmUnreadReduce(&f->unread, all, A));
  PetscCall(MatDestroy(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds what the operators make of random vectors to a basis, until nothing new comes. */
static PetscErrorCode Span(PetscInt n, const Mat A[], PetscReal noise, BV basis)
{
  PetscInt  order, size = 0, first, last;
  PetscReal all, norm   = 1;
  Vec       x, y, v;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A[0], &order, NULL));
  PetscCall(MatCreateVecs(A[0], &x, &y));
  PetscCall(VecGetOwnershipRange(x, &first, &last));
  while (size < order && norm > 0) {
    PetscCall(BVGetColumn(basis, size, &v));
    PetscCall(VecZeroEntries(v));
    for (PetscInt k = 0; k < n; k++) {
      for (PetscInt i = first; i < last; i++)
        PetscCall(VecSetValue(x, i, 2 * MpmHash(91 + n * size + k, i) - 1, INSERT_VALUES));
      PetscCall(VecAssemblyBegin(x));
      PetscCall(VecAssemblyEnd(x));
      PetscCall(MatMultAdd(A[k], x, v, v));
    }
    PetscCall(VecNorm(v, NORM_2, &all));
    PetscCall(BVRestoreColumn(basis, size, &v));
    PetscCall(BVOrthonormalizeColumn(basis, size, PETSC_FALSE, &norm, NULL));
    if (norm <= noise * all) norm = 0;
    size += norm > 0;
  }
  PetscCall(BVSetActiveColumns(basis, 0, size));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the columns of all operators span holds their eigenvectors, but those of 0. */
static PetscErrorCode Shrink(MpmDtPolynomial *f)
{
  Mat      A[MPM_DT_NODES];
  PetscInt order, size;
  Vec      x;
  BV       basis;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < f->n; i++) PetscCall(MpmUnreadReduce(&f->unread, f->A[i], &A[i]));
  PetscCall(MatGetSize(A[0], &order, NULL));
  PetscCall(MatCreateVecs(A[0], &x, NULL));
  PetscCall(BVCreate(PETSC_COMM_WORLD, &basis));
  PetscCall(BVSetSizesFromVec(basis, x, order));
  PetscCall(BVSetFromOptions(basis));
  PetscCall(Span(f->n, A, MpmProgramNoise(f->program), basis));
  PetscCall(BVGetActiveColumns(basis, NULL, &size));
  for (PetscInt i = 0; i < f->n; i++) {
    PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, PetscMax(size, 1), PetscMax(size, 1), NULL, &f->small[i]));
    PetscCall(BVMatProject(basis, A[i], basis, f->small[i]));
    PetscCall(MatDestroy(&A[i]));
  }
  PetscCall(BVDestroy(&basis));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDtPolynomialLargest(MpmDtPolynomial *f, PetscReal dt, PetscReal value[2])
{
  Mat A;

  PetscFunctionBegin;
  if (!f->small[0]) PetscCall(Shrink(f));
  PetscCall(Combine(f, f->small, dt, &A));
  PetscCall(MpmDenseLargest(A, value));
  PetscCall(MatDestroy(&A));
  PetscCallMPI(MPI_Bcast(value, 2, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}
