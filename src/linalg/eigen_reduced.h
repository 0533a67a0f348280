/* Eigenvalues of a matrix by its smaller one. */
#pragma once
#include "linalg/eigen.h"

/*
   MpmEigenSolveReduced - MpmEigenSolve of a matrix that has a smaller one, which must outlive the result. Eigenvalues are sought
   of the smaller one and listed, with their lifted vectors, as those of A. The numbers that A keeps are listed beside all
   eigenvalues, beside those of largest abs where they belong to them, and once beside the leftmost; vectors for these are
   random.

   Collective.
*/
PetscErrorCode MpmEigenSolveReduced(Mat A, const MpmReduced *reduced, const char prefix[], MpmEigenMethod method,
                                    const PetscReal target[2], MpmEigen **eigen);
