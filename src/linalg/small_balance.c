/* Balances a small complex matrix whose columns have their real parts first and then their imaginary parts. */
#include "linalg/small_balance.h"
#include <math.h>

#define ROUNDS 30 /* over all rows and columns */
#define GAIN 0.95 /* a row and its column are scaled where that shrinks their norm so far */

static void Exchange(PetscInt n, PetscReal a[], PetscInt i, PetscInt j)
{
  for (PetscInt k = 0; k < 2 * n && i != j; k++) {
    const PetscReal kept = a[2 * n * i + k];

    a[2 * n * i + k] = a[2 * n * j + k];
    a[2 * n * j + k] = kept;
  }
  for (PetscInt k = 0; k < 2 * n && i != j; k++) {
    const PetscReal kept = a[n * k + i];

    a[n * k + i] = a[n * k + j];
    a[n * k + j] = kept;
  }
}

/* Whether row i has only zeros at columns lo .. hi beside the diagonal; column i where columns. */
static PetscBool IsAlone(PetscInt n, const PetscReal a[], PetscInt i, PetscInt lo, PetscInt hi, PetscBool columns)
{
  for (PetscInt j = lo; j <= hi; j++)
    if (j != i && (columns ? MpmEntry(n, a, j, i) : MpmEntry(n, a, i, j)) != 0) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Moves eigenvalues that stand alone in their row to the end and those alone in their column to the front. */
static void Permute(PetscInt n, PetscReal a[], PetscInt *lo, PetscInt *hi)
{
  *lo = 0;
  *hi = n - 1;
  for (PetscInt i = *hi; i >= 0; i--) {
    if (!IsAlone(n, a, i, 0, *hi, PETSC_FALSE)) continue;
    Exchange(n, a, i, *hi);
    if (--*hi < 0) return;
    i = *hi + 1;
  }
  for (PetscInt j = *lo; j <= *hi; j++) {
    if (!IsAlone(n, a, j, *lo, *hi, PETSC_TRUE)) continue;
    Exchange(n, a, j, *lo);
    ++*lo;
    j = *lo - 1;
  }
}

/* Multiplies column i by a power of two and divides row i by it, where that makes them shorter. */
static PetscBool ScaleOne(PetscInt n, PetscReal a[], PetscInt lo, PetscInt hi, PetscInt i)
{
  PetscReal *re = MpmRe(n, a, i), *im = MpmIm(n, a, i), column = 0, row = 0, f;
  int        power;

  for (PetscInt j = lo; j <= hi; j++) {
    if (j == i) continue;
    column += fabs(re[j]) + fabs(im[j]);
    row += fabs(MpmRe(n, a, j)[i]) + fabs(MpmIm(n, a, j)[i]);
  }
  if (column == 0 || row == 0 || (row <= 2 * column && column <= 2 * row)) return PETSC_FALSE;
  power = (int)lrint(log2(row / column) / 2);
  f     = scalbn(1, power);
  if (!(f * column + row / f < GAIN * (column + row))) return PETSC_FALSE;
  for (PetscInt k = 0; k < 2 * n; k++) re[k] *= f;
  for (PetscInt k = 0; k < 2 * n; k++) a[n * k + i] *= 1 / f;
  return PETSC_TRUE;
}

void MpmSmallBalance(PetscInt n, PetscReal a[], PetscInt *lo, PetscInt *hi)
{
  PetscBool again = PETSC_TRUE;

  Permute(n, a, lo, hi);
  for (PetscInt round = 0; again && round < ROUNDS; round++) {
    again = PETSC_FALSE;
    for (PetscInt i = *lo; i <= *hi; i++)
      if (ScaleOne(n, a, *lo, *hi, i)) again = PETSC_TRUE;
  }
}
