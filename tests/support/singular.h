/* Singular values of a dense matrix by LAPACK, for comparison. */
#pragma once
#include "check.h"
#include <petscblaslapack.h>

/* Finds the smallest and largest singular value of an n x n matrix, which is overwritten. */
static inline PetscErrorCode DenseSingular(PetscInt n, PetscReal a[], PetscReal ends[2])
{
  PetscBLASInt order = (PetscBLASInt)n, one = 1, room = 10 * order, info;
  PetscReal   *sigma, *work;

  PetscFunctionBegin;
  ends[0] = ends[1] = NAN;
  PetscCall(PetscMalloc2(n, &sigma, room, &work));
  PetscCallBLAS("LAPACKgesvd",
                LAPACKgesvd_("N", "N", &order, &order, a, &order, sigma, NULL, &one, NULL, &one, work, &room, &info));
  CHECK(info == 0, "dgesvd: %d", (int)info);
  ends[0] = sigma[n - 1];
  ends[1] = sigma[0];
  PetscCall(PetscFree2(sigma, work));
  PetscFunctionReturn(PETSC_SUCCESS);
}
