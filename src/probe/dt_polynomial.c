/* A code's operator as a polynomial of its time step. */
#include "probe/dt_polynomial.h"
#include "linalg/dense.h"
#include "linalg/singular.h"
#include <slepcbv.h>
#include <math.h>

#define FEWEST 3      /* time steps: most steps are quadratic */
#define FORETOLD 1e-7 /* relative; a response that differs by more is not foretold */
#define FORETOLD_SINGLE 1e-4

static const PetscReal nodes[]  = {1, 0.5, 1.5, 0.75, 1.25, 0.25}; /* times the centre */
static const PetscReal others[] = {0.35, 1.35};

/* Prepares the program for a time step. */
static PetscErrorCode GoTo(const MpmDtPolynomial *f, PetscReal dt)
{
  PetscFunctionBegin;
  PetscCall(MpmStepperSet(f->program->stepper, f->name, dt));
  PetscCall(MpmProgramPrepare(f->program));
  if (f->motion) PetscCall(MpmMotionGoTo(f->program, f->motion, f->step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Leave(const MpmDtPolynomial *f)
{
  PetscFunctionBegin;
  PetscCall(MpmProgramForget(f->program));
  if (f->motion) PetscCall(MpmMotionReturn(f->program, f->motion));
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
  PetscReal   reach;

  PetscFunctionBegin;
  PetscCall(GoTo(f, dt));
  *fits = Fits(p);
  if (*fits) {
    p->probe.apart = f->given;
    PetscCall(MpmProgramProbe(p, p->probe.size, &f->at[f->n], &reach));
    p->probe.apart = NULL;
    if (!f->n) PetscCall(MpmUnreadFind(&f->at[0], p->stepper->width, MpmProgramNoise(p), &f->unread));
    f->dt[f->n++] = dt;
  }
  PetscCall(Leave(f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of operators at a time step, by Lagrange's weights. */
static PetscErrorCode Combine(const MpmDtPolynomial *f, const MpmProbed at[], PetscReal dt, MpmProbed *sum)
{
  PetscReal weight[MPM_DT_NODES];

  PetscFunctionBegin;
  for (PetscInt i = 0; i < f->n; i++) {
    weight[i] = 1;
    for (PetscInt j = 0; j < f->n; j++)
      if (j != i) weight[i] *= (dt - f->dt[j]) / (f->dt[i] - f->dt[j]);
  }
  PetscCall(MpmProbedCombine(f->n, at, weight, sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where nothing can be compared, nothing is known against it. */
PetscErrorCode MpmDtPolynomialHolds(MpmDtPolynomial *f, PetscReal dt, PetscBool *holds)
{
  MpmProgram *p = f->program;
  PetscReal   differs;
  PetscInt64  most;
  MpmProbed   sum;

  PetscFunctionBegin;
  PetscCall(GoTo(f, dt));
  PetscCall(Combine(f, f->at, dt, &sum));
  PetscCall(MpmCertifyColumns(&p->probe, &p->lattice, &sum, f->unread.apart, &differs, &most));
  PetscCall(MpmProbedFree(&sum));
  PetscCallMPI(MPI_Bcast(&differs, 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
  *holds = differs > (p->probe.single ? FORETOLD_SINGLE : FORETOLD) ? PETSC_FALSE : PETSC_TRUE;
  PetscCall(Leave(f));
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
    PetscCall(MpmProbedFree(&f->at[i]));
    PetscCall(MpmProbedFree(&f->small[i]));
  }
  f->n = 0;
  PetscCall(MpmUnreadDestroy(&f->unread));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDtPolynomialAt(const MpmDtPolynomial *f, PetscReal dt, MpmProbed *probed)
{
  MpmProbed all;

  PetscFunctionBegin;
  PetscCall(Combine(f, f->at, dt, &all));
  PetscCall(MpmProbedReduce(&all, &f->unread, probed));
  PetscCall(MpmProbedFree(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds what the operators make of random vectors to a basis, until nothing new comes. */
static PetscErrorCode Span(PetscInt n, const MpmProbed of[], PetscReal noise, BV basis)
{
  PetscInt  order, size = 0;
  PetscReal all, norm   = 1;
  Vec       x, v;

  PetscFunctionBegin;
  PetscCall(MatGetSize(of[0].A, &order, NULL));
  PetscCall(MatCreateVecs(of[0].A, &x, NULL));
  while (size < order && norm > 0) {
    PetscCall(BVGetColumn(basis, size, &v));
    PetscCall(VecZeroEntries(v));
    for (PetscInt k = 0; k < n; k++) {
      PetscCall(MpmSingularStart(91 + n * size + k, x));
      PetscCall(MatMultAdd(of[k].A, x, v, v));
    }
    PetscCall(VecNorm(v, NORM_2, &all));
    PetscCall(BVRestoreColumn(basis, size, &v));
    PetscCall(BVOrthonormalizeColumn(basis, size, PETSC_FALSE, &norm, NULL));
    if (norm <= noise * all) norm = 0;
    size += norm > 0;
  }
  PetscCall(BVSetActiveColumns(basis, 0, size));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the columns of all operators span holds their eigenvectors, but those of 0. */
static PetscErrorCode Shrink(MpmDtPolynomial *f)
{
  MpmProbed at[MPM_DT_NODES];
  PetscInt  order, size;
  Vec       x;
  BV        basis;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < f->n; i++) PetscCall(MpmProbedReduce(&f->at[i], &f->unread, &at[i]));
  PetscCall(MatGetSize(at[0].A, &order, NULL));
  PetscCall(MatCreateVecs(at[0].A, &x, NULL));
  PetscCall(BVCreate(PETSC_COMM_WORLD, &basis));
  PetscCall(BVSetSizesFromVec(basis, x, order));
  PetscCall(BVSetFromOptions(basis));
  PetscCall(Span(f->n, at, MpmProgramNoise(f->program), basis));
  PetscCall(BVGetActiveColumns(basis, NULL, &size));
  for (PetscInt i = 0; i < f->n; i++) {
    PetscCall(MatCreateSeqDense(PETSC_COMM_SELF, PetscMax(size, 1), PetscMax(size, 1), NULL, &f->small[i].A));
    PetscCall(BVMatProject(basis, at[i].A, basis, f->small[i].A));
    PetscCall(MpmProbedFree(&at[i]));
  }
  PetscCall(BVDestroy(&basis));
  PetscCall(VecDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDtPolynomialLargest(MpmDtPolynomial *f, PetscReal dt, PetscReal value[2])
{
  MpmProbed sum;

  PetscFunctionBegin;
  if (!f->small[0].A) PetscCall(Shrink(f));
  PetscCall(Combine(f, f->small, dt, &sum));
  PetscCall(MpmDenseLargest(sum.A, value));
  PetscCall(MpmProbedFree(&sum));
  PetscCallMPI(MPI_Bcast(value, 2, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}
