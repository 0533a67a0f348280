/* What the march does to plain arrays besides the maps of its basis. */
#include <mpmstab/kernels.h>

void MpmScale(PetscInt n, PetscReal a, PetscReal *restrict particle)
{
  if (a == 0)
    for (PetscInt p = 0; p < n; p++) particle[p] = 0; /* whatever was there */
  else
    for (PetscInt p = 0; p < n; p++) particle[p] *= a;
}

void MpmPlaceBlock(PetscInt n, const PetscInt *restrict cell0, const PetscReal *restrict xi0, PetscInt whole,
                   PetscReal part, PetscInt *restrict cell, PetscReal *restrict xi)
{
  for (PetscInt p = 0; p < n; p++) {
    const PetscReal place = xi0[p] + part;
    const PetscInt  next  = place >= 1 - 0x1p-52;

    cell[p] = cell0[p] + whole + next;
    xi[p]   = next ? PetscMax(place - 1, 0) : place;
  }
}

PetscReal MpmSumSquares(PetscInt n, const PetscReal *restrict q)
{
  PetscReal sum = 0;

#pragma omp simd reduction(+ : sum)
  for (PetscInt p = 0; p < n; p++) sum += q[p] * q[p];
  return sum;
}

void MpmNodeLaplacian(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] = a * ((f[i + 1] - f[i]) - (f[i] - f[i - 1]));
}

void MpmNodeAdd(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] += a * f[i];
}

void MpmNodeCopy(PetscInt lo, PetscInt hi, PetscReal a, const PetscReal *restrict f, PetscReal *restrict out)
{
  for (PetscInt i = lo; i < hi; i++) out[i] = a * f[i];
}
