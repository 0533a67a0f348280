/*
   The columns of a small complex matrix while its eigenvalues are computed: the real parts of a column, and then its
   imaginary parts. Loops down a column then work on several rows at a time without moving parts about.
*/
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>

#define MPM_NEXT_TO_0 1e-290 /* squares of numbers below this lose digits; the matrix's largest number is about 1 */

/* The real parts of column j of a matrix of order n. */
static inline PetscReal *MpmRe(PetscInt n, PetscReal a[], PetscInt j)
{
  return a + 2 * n * j;
}

/* Its imaginary parts. */
static inline PetscReal *MpmIm(PetscInt n, PetscReal a[], PetscInt j)
{
  return a + 2 * n * j + n;
}

static inline double complex MpmEntry(PetscInt n, const PetscReal a[], PetscInt i, PetscInt j)
{
  return CMPLX(a[2 * n * j + i], a[2 * n * j + n + i]);
}

static inline void MpmSetEntry(PetscInt n, PetscReal a[], PetscInt i, PetscInt j, double complex z)
{
  a[2 * n * j + i]     = creal(z);
  a[2 * n * j + n + i] = cimag(z);
}
