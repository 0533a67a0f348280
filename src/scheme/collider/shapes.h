/* What the files of shapes share. */
#pragma once
#include <mpmstab/collider.h>
#include <math.h>

static inline PetscReal Dot(PetscInt dim, const PetscReal a[], const PetscReal b[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < dim; i++) sum += a[i] * b[i];
  return sum;
}
