/*
   The operator of a code as a polynomial of its time step. Steps of most codes are: A(dt) = sum over i of w_i(dt)
   A(dt_i), with Lagrange's weights w_i of a few dt_i at which the operator is probed. So limits are sought without new
   probes. Responses at other time steps show whether it is so.
*/
#pragma once
#include "probe/motion.h"

#define MPM_DT_NODES 6

/*S
   MpmDtPolynomial - the operators at n time steps.

   name   - of the parameter that is the time step
   unread - of the first operator
   small  - of matrices: the operators on the space that their columns span, on every rank. They have the same
            eigenvalues, but for zeros
   motion - the operators are those of a step of it, number step; NULL: of the base state
   given  - numbers of a particle that are known to be read by nothing, whose columns are not probed; NULL: none
S*/
typedef struct {
  MpmProgram      *program;
  const char      *name;
  PetscInt         n;
  PetscReal        dt[MPM_DT_NODES];
  MpmProbed        at[MPM_DT_NODES], small[MPM_DT_NODES];
  MpmUnread        unread;
  const PetscBool *given;
  const MpmMotion *motion;
  PetscInt         step;
} MpmDtPolynomial;

/*
   MpmDtPolynomialFind - probes at time steps around a centre, and takes more of them until responses at others are
   foretold. fits: whether they are. A base state that moves has no such polynomial.

   MpmDtPolynomialHolds - whether a response at a time step is foretold. differs: by how much it is not, relative to it.

   Collective. The program must have been opened, and not be prepared; so it is afterwards.
*/
PetscErrorCode MpmDtPolynomialFind(MpmProgram *program, PetscReal centre, MpmDtPolynomial *polynomial, PetscBool *fits);
PetscErrorCode MpmDtPolynomialHolds(MpmDtPolynomial *polynomial, PetscReal dt, PetscBool *holds);
PetscErrorCode MpmDtPolynomialDestroy(MpmDtPolynomial *polynomial);

/*
   MpmDtPolynomialAt - the operator at a time step, without numbers that nothing reads back. MpmDtPolynomialLargest - of
   a matrix its eigenvalue of largest abs. Collective; the first not for blocks.
*/
PetscErrorCode MpmDtPolynomialAt(const MpmDtPolynomial *polynomial, PetscReal dt, MpmProbed *probed);
PetscErrorCode MpmDtPolynomialLargest(MpmDtPolynomial *polynomial, PetscReal dt, PetscReal value[2]);
