/*
   The first window of growth of an assembled operator under drift: walls, random layouts, materials that vary. The
   operator is a polynomial in the Courant number k, so a matrix at one k takes products of small dense matrices instead
   of an assembly, and its eigenvalues can be followed as k grows (see follow.h).
*/
#include "analysis/critical_parts.h"
#include "analysis/follow.h"
#include "linalg/dense.h"
#include "operator/polynomial.h"
#include <math.h>

#define MOST_ORDER 100    /* unknowns: with more of them following takes minutes */
#define MOST_WORK 4e11    /* multiplications in all */
#define OF_EIGENVALUES 25 /* times the cube of the order: what all eigenvalues take */
#define SMALL 20          /* added to the order: small matrices cost more than their multiplications */
#define FEWEST 2000       /* places: where fewer can be afforded, following is not begun */

typedef struct {
  MpmPolynomial polynomial;
  PetscReal    *matrix, *re, *im;
} Factors;

static PetscErrorCode FactorsAt(void *context, PetscReal courant, double complex value[])
{
  Factors       *f = (Factors *)context;
  const PetscInt n = f->polynomial.order;
  PetscInt       exponent;
  int            failed;

  PetscFunctionBegin;
  PetscCall(MpmPolynomialMatrix(&f->polynomial, courant, f->matrix, &exponent));
  for (PetscInt i = 0; i < n * n; i++) {
    if (isfinite(f->matrix[i])) continue;
    for (PetscInt j = 0; j < n; j++) value[j] = INFINITY;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmDenseEigen(n, f->matrix, f->re, f->im, NULL, &failed));
  PetscCheck(!failed, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK dgeev did not converge");
  for (PetscInt i = 0; i < n; i++) value[i] = CMPLX(scalbn(f->re[i], (int)exponent), scalbn(f->im[i], (int)exponent));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* On one rank, with so many places to look at. */
static PetscErrorCode FollowFactors(const MpmCriticalCase *of, PetscInt64 allowed, MpmCriticalWay *way)
{
  Factors   factors;
  MpmFollow follow;
  PetscInt  n;
  PetscReal from;

  PetscFunctionBegin;
  PetscCall(MpmPolynomialCreate(of->layout, of->scheme, &of->step, &factors.polynomial));
  n    = factors.polynomial.order;
  from = PetscMin(MPM_CRITICAL_FROM * PetscMin(factors.polynomial.scale, 1), way->to / 2);
  PetscCall(PetscMalloc3(n * n, &factors.matrix, n, &factors.re, n, &factors.im));
  PetscCall(MpmFollowCreate(n, factors.polynomial.period, of->tolerance, FactorsAt, &factors, &follow));
  follow.allowed = allowed;
  PetscCall(MpmFollowFirst(&follow, from, from, way->to, way->bracket));
  way->done        = isfinite(way->bracket[1]) || way->bracket[0] >= way->to ? PETSC_TRUE : PETSC_FALSE;
  way->doubtful    = follow.doubtful;
  way->evaluations = follow.evaluations;
  PetscCall(MpmFollowDestroy(&follow));
  PetscCall(PetscFree3(factors.matrix, factors.re, factors.im));
  PetscCall(MpmPolynomialDestroy(&factors.polynomial));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalFollow(const MpmCriticalCase *of, MpmCriticalWay *way)
{
  const PetscReal n = (PetscReal)(of->scheme->table->nstate * of->layout->particles), size = n + SMALL;
  PetscInt        period;
  PetscReal       allowed;

  PetscFunctionBegin;
  PetscCall(MpmStepPeriod(&of->step, &period));
  allowed   = MOST_WORK / (size * size * size * (period + OF_EIGENVALUES));
  way->done = PETSC_FALSE;
  if (n > MOST_ORDER || allowed < FEWEST) PetscFunctionReturn(PETSC_SUCCESS);
  if (MpmTableHas(of->scheme->table, MPM_IMPLICIT)) PetscFunctionReturn(PETSC_SUCCESS); /* it is no polynomial in k */
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) PetscCall(FollowFactors(of, (PetscInt64)allowed, way));
  PetscCallMPI(MPI_Bcast(way, sizeof *way, MPI_BYTE, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}
