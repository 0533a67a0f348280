/* Eigenvalues of an assembled operator, by SLEPc. */
#pragma once
#include <mpmstab/compat.h>
#include <slepcbv.h>
#include <slepceps.h>

/*E
   MpmEigenMethod - how eigenvalues are found.

   MPM_EIGEN_DENSE   - all of them (LAPACK)
   MPM_EIGEN_TARGET  - those near a complex target (shift-and-invert; LU of a band, or MUMPS where there is none)
   MPM_EIGEN_LARGEST - those of largest magnitude (Krylov-Schur); converges where modes are localised
E*/
typedef enum { MPM_EIGEN_DENSE, MPM_EIGEN_TARGET, MPM_EIGEN_LARGEST } MpmEigenMethod;

/* Not collective. The method for an order, and for a layout with a symbol to name targets or without. */
MpmEigenMethod MpmEigenChoose(PetscInt order, PetscBool has_symbol);

/*S
   MpmEigen - eigenvalues re + i im of a matrix, largest abs first, with residual norm(A x - lambda x) / (norm(A)
   norm(x)) in the infinity norm of A.

   complete: all of them. converged: as many as were asked for. largest: converged, the largest abs of all were
   sought, and none of what was found was rejected. failed: the solver gave up (a factorization broke down, or A is
   not finite). solver says what was done, options included. What is not an eigenpair to ACCEPTED (1e-7) is not
   listed.
*/
typedef struct {
  Mat        A;
  PetscInt   order, n;
  PetscReal *re, *im, *residual, norm, solve_s;
  PetscBool  complete, converged, largest, failed;
  char       solver[160];
  /* where the vectors are */
  EPS        eps;
  BV         ritz;
  PetscInt  *place; /* of the listed pair in eps, in dense, or of its Ritz vector */
  PetscReal *coefficients, *dense_re, *dense_im, *dense; /* dense: see MpmEigenDenseSolve */
} MpmEigen;

/*
   MpmEigenSolve - solves with SLEPc; -eps_*, -st_*, -bv_* and -ds_* override what the method sets;
   all eigenvalues by LAPACK itself, unless -eps_type lapack asks for SLEPc's way.

   Collective. prefix: of the options. Refuses options that SLEPc refuses. target (re, im) for MPM_EIGEN_TARGET; not
   an eigenvalue itself, least of all 1.

   Real arithmetic: for a target a + ib the eigenvalues of T = (A - a I)^2 + b^2 I near 0 are sought; the eigenvalues
   of A are those it has on the space that T's eigenvectors X span with A X (Rayleigh-Ritz).
*/
PetscErrorCode MpmEigenSolve(Mat A, const char prefix[], MpmEigenMethod method, const PetscReal target[2],
                             MpmEigen **eigen);
PetscErrorCode MpmEigenDestroy(MpmEigen **eigen);

/* Collective. The eigenvector of a listed eigenvalue, of norm 1 (re and im together). */
PetscErrorCode MpmEigenVector(const MpmEigen *eigen, PetscInt j, Vec re, Vec im);

/*
   MpmEigenCondition - condition number 1 / abs(y^H x) of a listed simple eigenvalue, from its left vector y.

   Collective. Infinite when no left vector was found.
*/
PetscErrorCode MpmEigenCondition(const MpmEigen *eigen, PetscInt j, PetscReal *condition);
