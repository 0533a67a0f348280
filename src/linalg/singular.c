/* The largest singular value, by SLEPc. */
#include "base/hash.h"
#include "linalg/singular.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <slepcsvd.h>

#define RESTARTS 500

PetscErrorCode MpmSingularStart(PetscInt64 seed, Vec start)
{
  PetscInt   begin, end;
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(start, &begin, &end));
  PetscCall(VecGetArray(start, &x));
  for (PetscInt row = begin; row < end; row++) x[row - begin] = MpmHash(seed, row) - 0.5;
  PetscCall(VecRestoreArray(start, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSolver(PetscInt basis, PetscReal tolerance, SVD *svd)
{
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(SVDCreate(PETSC_COMM_WORLD, svd));
  PetscCall(SVDSetImplicitTranspose(*svd, PETSC_TRUE));
  PetscCall(SVDSetType(*svd, SVDTRLANCZOS));
  PetscCall(SVDSetDimensions(*svd, 1, basis, PETSC_DETERMINE));
  PetscCall(SVDSetTolerances(*svd, tolerance, RESTARTS));
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  error = SVDSetFromOptions(*svd);
  PetscCall(PetscPopErrorHandler());
  MpmCheckInput(!error, "-svd_*: SLEPc refuses one of them; allowed: see its manual pages");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSingularTryOptions(void)
{
  SVD svd;

  PetscFunctionBegin;
  PetscCall(CreateSolver(1, 1, &svd));
  PetscCall(SVDDestroy(&svd));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a matrix is zero: it maps a random vector to 0 exactly. SLEPc breaks down on it. */
static PetscErrorCode IsZero(Mat matrix, Vec start, PetscBool *zero)
{
  Vec       image;
  PetscReal norm;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(start, &image));
  PetscCall(MatMult(matrix, start, image));
  PetscCall(VecNorm(image, NORM_INFINITY, &norm));
  PetscCall(VecDestroy(&image));
  *zero = norm == 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSingularLargest(Mat matrix, Vec start, PetscInt basis, PetscReal tolerance, PetscReal *sigma)
{
  SVD            svd;
  PetscInt       order, found = 0;
  PetscBool      zero = PETSC_FALSE;
  PetscErrorCode error;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &order, NULL));
  PetscCall(CreateSolver(PetscMin(basis, order), tolerance, &svd));
  PetscCall(SVDSetOperators(svd, matrix, NULL));
  PetscCall(SVDSetInitialSpaces(svd, 1, &start, 0, NULL));
  PetscCall(SVDSetWhichSingularTriplets(svd, SVD_LARGEST)); /* overrides the options */
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  error = SVDSolve(svd);
  PetscCall(PetscPopErrorHandler());
  if (!error) PetscCall(SVDGetConverged(svd, &found));
  if (!found) PetscCall(IsZero(matrix, start, &zero));
  *sigma = zero ? 0 : NAN;
  if (found) PetscCall(SVDGetSingularTriplet(svd, 0, sigma, NULL, NULL));
  PetscCall(SVDDestroy(&svd));
  PetscFunctionReturn(PETSC_SUCCESS);
}
