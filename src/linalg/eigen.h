/* Eigenvalues of an operator, by SLEPc. */
#pragma once
#include "linalg/reduced.h"
#include <slepcbv.h>
#include <slepceps.h>

/*E
   MpmEigenMethod - how eigenvalues are found.

     MPM_EIGEN_DENSE   - all of them (LAPACK)
     MPM_EIGEN_TARGET  - those near a complex target (shift-and-invert, LU by MUMPS)
     MPM_EIGEN_LARGEST - those of largest magnitude (Krylov-Schur); it converges where modes are localised
     MPM_EIGEN_LEFTMOST - those of least real part (Krylov-Schur); it converges where the spectrum ends there
E*/
typedef enum { MPM_EIGEN_DENSE, MPM_EIGEN_TARGET, MPM_EIGEN_LARGEST, MPM_EIGEN_LEFTMOST } MpmEigenMethod;

/*
   Not collective. Chooses the method for an operator's order. has_symbol: the layout has a symbol, which names targets.
*/
MpmEigenMethod MpmEigenChoose(PetscInt order, PetscBool has_symbol);

/*S
   MpmEigen - eigenvalues re + i im of a matrix, sorted by abs with the largest first, and their residuals

     norm(A x - lambda x) / (norm(A) norm(x)), with the infinity norm of A.

   A result with a residual above 1e-7 is no eigenpair and is not listed. solver describes what was done, options
   included.

   complete: all eigenvalues are listed. converged: as many were found as were asked for. largest: the solver has
   converged, it sought the largest abs of all eigenvalues, and no result was rejected. leftmost: the same of the least
   real part. failed: the solver gave up, since a factorization broke down or A is not finite. nilpotent: all
   eigenvalues are 0, and one of them is listed, with the unit vector of the unknown unit (MpmNilpotentFind,
   linalg/eigen_parts.h). small: of a solve by a smaller matrix (reduced), its eigenvalues; else NULL. vector: gives the
   vector of listed pair j of such a solve, before it is scaled.
S*/
typedef struct MpmEigen MpmEigen;
struct MpmEigen {
  Mat               A;
  PetscInt          order, n;
  PetscReal        *re, *im, *residual, norm, solve_s;
  PetscBool         complete, converged, largest, leftmost, failed, nilpotent;
  char              solver[160];
  MpmEigen         *small;
  const MpmReduced *reduced;
  PetscErrorCode (*vector)(const MpmEigen *eigen, PetscInt j, Vec re, Vec im);
  /* where the eigenvectors are kept */
  EPS        eps;
  BV         ritz;
  Vec        work[3]; /* while they are listed */
  PetscInt   unit;
  PetscInt  *place;                                      /* of the listed pair in eps or dense, or of its Ritz vector */
  PetscReal *coefficients, *dense_re, *dense_im, *dense; /* dense: as MpmEigenDenseSolve sets it */
};

/*
   MpmEigenSolve - solves with SLEPc. The options -eps_*, -st_*, -bv_* and -ds_* override what the method sets. LAPACK
   itself finds all eigenvalues, unless -eps_type lapack asks for SLEPc's way.

   Collective. prefix: that of the options. target: (re, im), for MPM_EIGEN_TARGET; it must not be an eigenvalue itself,
   in particular not 1. Refuses options that SLEPc refuses.

   Arithmetic is real. For a target a + ib the solver seeks the eigenvalues near 0 of

     T = (A - a I)^2 + b^2 I

   The listed eigenvalues are those of A on the space that T's eigenvectors X and A X span (Rayleigh-Ritz).
*/
PetscErrorCode MpmEigenSolve(Mat A, const char prefix[], MpmEigenMethod method, const PetscReal target[2],
                             MpmEigen **eigen);

/*
   MpmEigenSolveReduced - MpmEigenSolve of a matrix that has a smaller one, which must outlive the result. Eigenvalues
   are sought of the smaller one and listed, with their lifted vectors, as those of A. The numbers that A keeps are
   listed beside all eigenvalues, beside those of largest abs where they belong to them, and once beside the leftmost;
   vectors for these are random.

   Collective.
*/
PetscErrorCode MpmEigenSolveReduced(Mat A, const MpmReduced *reduced, const char prefix[], MpmEigenMethod method,
                                    const PetscReal target[2], MpmEigen **eigen);

PetscErrorCode MpmEigenDestroy(MpmEigen **eigen);

/*
   MpmEigenRitz - the eigenvalues of A on the space of given vectors and their images, if they are eigenvalues of A:
   those with a residual above 1e-7 are not listed.

   Collective. The vectors are scaled. A may be a shell.
*/
PetscErrorCode MpmEigenRitz(Mat A, PetscInt given, Vec vectors[], MpmEigen **eigen);

/*
   MpmEigenTryOptions - sets up a solver of this method with its options for a matrix of a few unknowns, so that what
   SLEPc refuses is refused before the work. MpmEigenRefuseUnread then refuses options of SLEPc's solvers that none of
   those set up by then has read.

   MpmEigenAsked says whether any option asks for something of SLEPc's solvers.

   Collective on PETSC_COMM_WORLD. Options that are read only while a solver solves, as views are, are let through.
*/
PetscErrorCode MpmEigenAsked(PetscBool *asked);
PetscErrorCode MpmEigenTryOptions(MpmEigenMethod method);
PetscErrorCode MpmEigenRefuseUnread(void);

/* Collective. Gives the eigenvector of a listed eigenvalue; re and im together have norm 1. */
PetscErrorCode MpmEigenVector(const MpmEigen *eigen, PetscInt j, Vec re, Vec im);

/*
   MpmEigenCondition - the condition number 1 / abs(y^H x) of a listed simple eigenvalue with right vector x and left
   vector y.

   Collective. It is infinite when no left vector was found. Of a shell, left vectors are sought among those of largest
   magnitude.
*/
PetscErrorCode MpmEigenCondition(const MpmEigen *eigen, PetscInt j, PetscReal *condition);

/* ---- for the files that list eigenvalues ---- */

/*
   MpmEigenListBegin - memory for up to so many pairs
   MpmEigenTry - lists a pair if its vector, which place says, is an eigenvector. rest: its residual where that is
             known, or NAN
   MpmEigenListEnd - sorts by -abs, then by the angle from the positive real axis; of a pair the upper half comes first.
             The angle enters the key with a small weight, so that rounding of the abs does not decide the order.

   Collective.
*/
PetscErrorCode MpmEigenListBegin(MpmEigen *e, PetscInt room);
PetscErrorCode MpmEigenTry(MpmEigen *e, PetscInt place, PetscReal re, PetscReal im, PetscReal rest, PetscBool *listed);
PetscErrorCode MpmEigenListEnd(MpmEigen *e);

/* Collective. The infinity norm; that of a transposed shell is not known, and a lower bound of its own is. */
PetscErrorCode MpmEigenNorm(Mat A, PetscReal *norm);

/*
   MpmPencilLeastKrylov - the least x > 0 at which C_0 + x C_1 has the eigenvalue -1, of sparse matrices, by a Krylov
   space. NaN: the solver found no eigenvalue.

   Collective. C_0 is overwritten by C_0 + 1, whose systems GMRES solves: C_0 is what a transfer keeps of nodal
   velocities, with eigenvalues from 0 to 1.
*/
PetscErrorCode MpmPencilLeastKrylov(Mat C0, Mat C1, PetscReal *x);
