/* The condition number of an eigenvalue. Its left vector is an eigenvector of A transposed, which is sought near it. */
#include "linalg/eigen.h"
#include <math.h>

#define BESIDE 1e-7 /* relative distance of the shift from the eigenvalue */
#define SAME 1e-6   /* largest distance, over norm(A), between the eigenvalues of A and of A transposed */

PetscErrorCode MpmEigenCondition(const MpmEigen *e, PetscInt j, PetscReal *condition)
{
  const PetscReal target[2] = {e->re[j] * (1 + BESIDE), e->im[j] * (1 + BESIDE)};
  PetscReal       nearest   = PETSC_MAX_REAL, dot[4];
  PetscInt        match     = 0;
  Mat             transposed;
  MpmEigen       *left;
  Vec             x[2], y[2];

  PetscFunctionBegin;
  PetscCall(MatTranspose(e->A, MAT_INITIAL_MATRIX, &transposed));
  PetscCall(MpmEigenSolve(transposed, "left_", MPM_EIGEN_TARGET, target, &left));
  for (PetscInt i = 0; i < left->n; i++) {
    const PetscReal distance = hypot(left->re[i] - e->re[j], left->im[i] + e->im[j]); /* A^T y = conj(lambda) y */

    if (distance < nearest) match = i;
    nearest = PetscMin(nearest, distance);
  }
  *condition = INFINITY;
  if (nearest <= SAME * e->norm) {
    PetscCall(MatCreateVecs(e->A, &x[0], &x[1]));
    PetscCall(MatCreateVecs(e->A, &y[0], &y[1]));
    PetscCall(MpmEigenVector(e, j, x[0], x[1]));
    PetscCall(MpmEigenVector(left, match, y[0], y[1]));
    for (int a = 0; a < 2; a++)
      for (int b = 0; b < 2; b++) PetscCall(VecDot(x[a], y[b], &dot[2 * a + b]));
    *condition = 1 / hypot(dot[0] + dot[3], dot[2] - dot[1]);
    for (int part = 0; part < 2; part++) {
      PetscCall(VecDestroy(&x[part]));
      PetscCall(VecDestroy(&y[part]));
    }
  }
  PetscCall(MpmEigenDestroy(&left));
  PetscCall(MatDestroy(&transposed));
  PetscFunctionReturn(PETSC_SUCCESS);
}
