/*
   Operator: a table applied to sparse matrices. The result maps the state before a step to the state after it. A large
   operator in two or three dimensions is not assembled: it applies the table to vectors.
*/
#pragma once
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>
#include <petscmat.h>

/*S
   MpmOperator - the assembled operator of a scheme on a layout: the map of one step or, under drift, of the period
   after which the particles have the same places in cells again.

   layout, scheme, step - as given to MpmOperatorCreate; layout and scheme are NULL for a matrix that was given
   assembled - A is a parallel AIJ matrix: in one dimension, and in more up to order MPM_MATRIX_ORDER. Else it is a
              MATSHELL, with products A x and A^T x, and exponent is 0. A step couples a particle to all those that
              share a node with it, and in three dimensions a matrix would not fit.
   A        - the matrix, or the shell; the operator is A times 2^exponent, so that long periods of unstable schemes
              stay in range. The state is numbered particle by particle: row = fields x global id + field, in the units
              of docs/theory.md. A rank holds the particles that rest in its part of the cells.
   balanced - D A D^-1, the operator in variables whose squares add up to the energy. Where masses or stiffnesses differ
              by orders of magnitude, A is badly scaled, and rounding spoils its eigenvalues. Where particles are alike,
              balanced is A.
   unit     - the diagonal of D: powers of two, so that nothing is rounded. NULL where particles are alike.
   p2g      - P2G at the first step: nodes x particles; NULL for a matrix that was given
   fields   - the number of fields of the state; 1 for a matrix that was given
   order    - the order of A: fields x particles
   period   - the number of steps in a period (MpmStepPeriod), which A covers
   parts    - the number of matrices that MpmOperatorStep has: period, or 1 for a matrix that was given
   exponent - see A
   nonzeros - the number of nonzeros of A, or of the maps of all its steps
   bytes    - the memory that they take on all ranks together
   assemble_s - the time that assembly took, in seconds

   Source: docs/theory.md, section 3; the one-step and the one-period (Floquet) operator.
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  MpmStep          step;
  Mat              A, balanced, p2g;
  Vec              unit;
  PetscInt         fields, order, period, parts, exponent;
  PetscReal        nonzeros, bytes, assemble_s;
  PetscBool        assembled;
} MpmOperator;

#define MPM_MATRIX_ORDER 4096 /* all eigenvalues of such an order can be computed */

/*
   MpmOperatorCreate - assembles the operator of a scheme on a layout, with the Courant number and the drift of step.

   Collective. layout and scheme must outlive the operator, which is destroyed with MpmOperatorDestroy.

   Errors: refuses (PETSC_ERR_USER_INPUT) drifts without a short period (MpmStepPeriod), and operators that would fill
   the memory.
*/
PetscErrorCode MpmOperatorCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                 MpmOperator **op);
PetscErrorCode MpmOperatorDestroy(MpmOperator **op);

/*
   MpmOperatorFromMatrix - makes an operator of a square matrix, wherever it comes from, that covers so many steps. All
   that an operator is asked is then asked of it, but for what needs a scene: p2g, MpmOperatorMismatch.

   Collective. The operator keeps a reference to A, which is AIJ and has every entry of its diagonal, if only as 0, or
   is a MATSHELL with products and an infinity norm. It is destroyed with MpmOperatorDestroy. balanced is D A D^-1 with
   powers of two for D that make rows and columns of about the same size (Parlett and Reinsch 1969), where this divides
   the norm of A by more than 4: in SI units a stress is 1e9 times a strain, and rounding would hide what strains do. Of
   a shell it is A, and nonzeros and bytes are NaN.
*/
PetscErrorCode MpmOperatorFromMatrix(Mat A, PetscInt period, MpmOperator **op);

/*
   MpmOperatorWeigh - computes W A W^-1 with W diagonal. W^2 is m for a velocity, a displacement or the affine part of
   apic, and V / E for a stress. The 2-norm of the result is then the norm of A in which a state is measured by its
   energy, if every field has a part in the energy.

   Collective. A is op->A or the matrix of a step. Where particles are alike the result is A itself. It is destroyed
   with MatDestroy.

   MpmOperatorWeights - the diagonal of W over that of unit, so that with it balanced becomes that result. NULL where
   particles are alike. Collective. It is destroyed with VecDestroy.

   MpmOperatorNorm - says in a few words which norm that is. Not collective.
*/
PetscErrorCode MpmOperatorWeigh(const MpmOperator *op, Mat A, Mat *weighed);
PetscErrorCode MpmOperatorWeights(const MpmOperator *op, Vec *weights);
const char    *MpmOperatorNorm(const MpmOperator *op);

/*
   MpmOperatorStep - the matrix of one of the parts of the period, or its shell; the operator of the part is A times
   2^exponent. A part is one step; of a matrix that was given it is the whole period.

   Collective. A is destroyed with MatDestroy.
*/
PetscErrorCode MpmOperatorStep(const MpmOperator *op, PetscInt step, Mat *A, PetscInt *exponent);

/*
   MpmOperatorToState - turns an eigenvector of balanced, with real and imaginary part, into one of A of 2-norm 1.

   Collective.
*/
PetscErrorCode MpmOperatorToState(const MpmOperator *op, Vec re, Vec im);

/*
   MpmOperatorMismatch - compares the operator with the march, which is the code that runs. The result is the largest
   norm(A q - march(q)), relative to the larger of norm(q) and norm(A q), over three periods that start from random
   data.

   Collective. The result is NaN when the march leaves the range of doubles.
*/
PetscErrorCode MpmOperatorMismatch(const MpmOperator *op, PetscReal *mismatch);
