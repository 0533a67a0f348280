/* Operator: the second reader. A formulation's table over sparse matrices gives the map from state to state. */
#pragma once
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>
#include <petscmat.h>

/*S
   MpmOperator - the assembled operator of a scheme on a layout: of one step, or under drift of the period after which the particles
   are back in their places.

   The state is numbered particle by particle: row = fields x global id + field, units as in THEORY.md. A is parallel
   AIJ; a rank holds the particles of its part of the cells. The operator is A times 2^exponent, so that long periods
   of unstable schemes stay in range. balanced is D A D^-1, in variables whose squares make the energy: where masses
   or stiffnesses differ by orders of magnitude A is badly scaled and eigenvalues are lost to rounding. D = unit holds
   powers of two, so nothing is rounded; unit is NULL and balanced is A where particles are alike. p2g (nodes x
   particles) is at the first step; bytes is what A takes on all ranks.

   Source: THEORY.md, section 3; the one-step and the one-period (Floquet) operator.
*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  MpmStep          step;
  Mat              A, balanced, p2g;
  Vec              unit;
  PetscInt         fields, order, period, exponent;
  PetscReal        nonzeros, bytes, assemble_s;
} MpmOperator;

/*
   MpmOperatorCreate - assembles a scheme's operator on a layout, with the Courant number and the drift of step.

   Collective. layout and scheme must outlive the operator. Refuses drifts without a short period, and operators that
   would fill the memory.
*/
PetscErrorCode MpmOperatorCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                 MpmOperator **op);
PetscErrorCode MpmOperatorDestroy(MpmOperator **op);

/* Collective. Sets balanced and unit from A; part of MpmOperatorCreate. */
PetscErrorCode MpmOperatorBalance(MpmOperator *op);

/*
   MpmOperatorWeigh - W A W^-1, W^2 = m of a velocity (or displacement, or apic's c), V / E of a stress: the 2-norm of
   what comes out is the norm of A in which a state is measured by its energy, where every field has a part in it.

   Collective. A is op->A or a step; where particles are alike it is A itself. Destroy with MatDestroy.
   MpmOperatorNorm says in a few words which norm that is; not collective.
*/
PetscErrorCode MpmOperatorWeigh(const MpmOperator *op, Mat A, Mat *weighed);
const char    *MpmOperatorNorm(const MpmOperator *op);

/*
   MpmOperatorStep - the matrix of one step of the period, times 2^-exponent.

   Collective. Destroy with MatDestroy.
*/
PetscErrorCode MpmOperatorStep(const MpmOperator *op, PetscInt step, Mat *A, PetscInt *exponent);

/* Collective. Takes a vector of the balanced operator, real and imaginary part, back to the state, of norm 1 again. */
PetscErrorCode MpmOperatorToState(const MpmOperator *op, Vec re, Vec im);

/*
   MpmOperatorMismatch - largest norm(A q - march(q)) relative to the larger of norm(q) and norm(A q), over periods that
   start from random data: whether the operator is the code that runs.

   Collective. NaN when the march leaves the range of doubles.
*/
PetscErrorCode MpmOperatorMismatch(const MpmOperator *op, PetscReal *mismatch);
