/* Operator: the second reader. A formulation's table over sparse matrices gives the map from state to state. */
#pragma once
#include <mpmstab/scene.h>
#include <petscmat.h>

/*S
   MpmOperator - the assembled operator of a scene: of one step, or under drift of the period after which the particles
   are back in their places.

   The state is numbered particle by particle: row = fields x global id + field, units as in THEORY.md. A is
   parallel AIJ; a rank holds the particles of its part of the cells. The operator is A times 2^exponent, so that long
   periods of unstable schemes stay in range. p2g (nodes x particles) is at the first step; bytes is what A takes on all
   ranks.

   Source: THEORY.md, section 3; the one-step and the one-period (Floquet) operator.
*/
typedef struct {
  const MpmScene *scene;
  Mat             A, p2g;
  PetscInt        fields, order, period, exponent;
  PetscReal       nonzeros, bytes, assemble_s;
} MpmOperator;

/* Collective. Refuses drifts without a short period, and operators that would fill the memory. */
PetscErrorCode MpmOperatorCreate(MPI_Comm comm, const MpmScene *scene, MpmOperator **op);
PetscErrorCode MpmOperatorDestroy(MpmOperator **op);

/*
   MpmOperatorMismatch - largest norm(A q - march(q)) relative to the larger of norm(q) and norm(A q), over periods that
   start from random data: whether the operator is the code that runs.

   Collective. NaN when the march leaves the range of doubles.
*/
PetscErrorCode MpmOperatorMismatch(const MpmOperator *op, PetscReal *mismatch);
