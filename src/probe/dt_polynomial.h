/*
   The operator of a code as a polynomial of its time step. Steps of most codes are: A(dt) = sum over i of w_i(dt) A(dt_i), with
   Lagrange's weights w_i of a few dt_i at which the operator is probed. So limits are sought without new probes. Responses at
   other time steps show whether it is so.
*/
#pragma once
#include "probe/program.h"

#define MPM_DT_NODES 6

/*S
   MpmDtPolynomial - the operators at n time steps: blocks of a lattice, or matrices A.

   name   - of the parameter that is the time step
   unread - of the first operator
   small  - of matrices: the operators on the space that their columns span, on every rank. They have the same eigenvalues, but
            for zeros
   given  - numbers of a particle that are known to be read by nothing, whose columns are not probed; NULL: none
S*/
typedef struct {
  MpmProgram      *program;
  const char      *name;
  PetscInt         n;
  PetscReal        dt[MPM_DT_NODES];
  MpmBlocks        blocks[MPM_DT_NODES];
  Mat              A[MPM_DT_NODES], small[MPM_DT_NODES];
  MpmUnread        unread;
  const PetscBool *given;
} MpmDtPolynomial;

/*
   MpmDtPolynomialFind - probes at time steps around a centre, and takes more of them until responses at others are foretold. fits:
   whether they are. A base state that moves has no such polynomial.

   MpmDtPolynomialHolds - whether a response at a time step is foretold. differs: by how much it is not, relative to it.

   Collective. The program must have been opened, and not be prepared; so it is afterwards.
*/
PetscErrorCode MpmDtPolynomialFind(MpmProgram *program, PetscReal centre, MpmDtPolynomial *polynomial, PetscBool *fits);
PetscErrorCode MpmDtPolynomialHolds(MpmDtPolynomial *polynomial, PetscReal dt, PetscBool *holds);
PetscErrorCode MpmDtPolynomialDestroy(MpmDtPolynomial *polynomial);

/*
   The operator at a time step, without numbers that nothing reads back: blocks, a matrix, or its eigenvalue of largest abs. Collective; not
   collective for blocks.
*/
PetscErrorCode MpmDtPolynomialBlocks(const MpmDtPolynomial *polynomial, PetscReal dt, MpmBlocks *blocks);
PetscErrorCode MpmDtPolynomialMatrix(const MpmDtPolynomial *polynomial, PetscReal dt, Mat *A);
PetscErrorCode MpmDtPolynomialLargest(MpmDtPolynomial *polynomial, PetscReal dt, PetscReal value[2]);
