/* Jacobi's method. With matrices this small it is as fast as LAPACK, and needs neither work space nor error codes. */
#include "linalg/hermitian.h"
#include <math.h>

#define MOST_SWEEPS 30 /* it converges quadratically: five are many */

typedef double complex Matrix[MPM_MOST_HERMITIAN][MPM_MOST_HERMITIAN];

/*
   Makes A_pq zero: A becomes R^H A R with the rotation R of columns p and q, and V becomes R^T V, whose rows are the
   columns of the product of all rotations.
*/
static void Rotate(PetscInt n, Matrix A, Matrix V, PetscInt p, PetscInt q)
{
  const PetscReal      size = cabs(A[p][q]), half = (creal(A[q][q]) - creal(A[p][p])) / (2 * size);
  const PetscReal      t = (half < 0 ? -1 : 1) / (fabs(half) + hypot(half, 1)), c = 1 / hypot(t, 1), s = t * c;
  const double complex turn = A[p][q] / size;

  for (PetscInt i = 0; i < n; i++) { /* columns: p' = c p - s conj(turn) q, q' = s turn p + c q */
    const double complex a = A[i][p], b = A[i][q], v = V[p][i], w = V[q][i];

    A[i][p] = c * a - s * conj(turn) * b;
    A[i][q] = s * turn * a + c * b;
    V[p][i] = c * v - s * conj(turn) * w;
    V[q][i] = s * turn * v + c * w;
  }
  for (PetscInt i = 0; i < n; i++) { /* and the same rows, conjugated */
    const double complex a = A[p][i], b = A[q][i];

    A[p][i] = c * a - s * turn * b;
    A[q][i] = s * conj(turn) * a + c * b;
  }
}

/* The largest number beside the diagonal, relative to the whole matrix. */
static PetscReal Beside(PetscInt n, Matrix A)
{
  PetscReal beside = 0, all = 0;

  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      all = fmax(all, cabs(A[i][j]));
      if (i != j) beside = fmax(beside, cabs(A[i][j]));
    }
  return beside > 0 ? beside / all : 0;
}

void MpmHermitianSolve(PetscInt n, Matrix A, PetscReal value[MPM_MOST_HERMITIAN], Matrix V)
{
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) V[i][j] = i == j;
  for (PetscInt sweep = 0; sweep < MOST_SWEEPS && Beside(n, A) > PETSC_MACHINE_EPSILON; sweep++)
    for (PetscInt p = 0; p < n; p++)
      for (PetscInt q = p + 1; q < n; q++)
        if (cabs(A[p][q]) > 0) Rotate(n, A, V, p, q);
  for (PetscInt i = 0; i < n; i++) value[i] = creal(A[i][i]);
  for (PetscInt i = 0; i < n; i++) /* sorts */
    for (PetscInt j = i + 1; j < n; j++) {
      if (value[j] <= value[i]) continue;
      const PetscReal kept = value[i];

      value[i] = value[j];
      value[j] = kept;
      for (PetscInt a = 0; a < n; a++) {
        const double complex component = V[i][a];

        V[i][a] = V[j][a];
        V[j][a] = component;
      }
    }
}
