/* The growth of one Bloch mode. */
#include "symbol/bloch_growth.h"
#include "symbol/bloch_nodal.h"
#include <mpmstab/verdict.h>

/* Where the nodal operator is too large for doubles, growth is not that of the null space. */
PetscErrorCode MpmBlochGrowths(MpmBloch *bloch, MpmSmallEigen *eigen, PetscReal courant, const PetscReal beta[],
                               PetscReal *growth, PetscReal *without_null)
{
  PetscInt  exponent;
  PetscReal largest = 0;
  PetscBool ok      = PETSC_FALSE;

  PetscFunctionBegin;
  if (bloch->nodal) PetscCall(MpmBlochNodalGrowths(bloch->nodal, bloch, courant, beta, growth, without_null, &ok));
  if (ok) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmBlochTurn(bloch, courant, beta, eigen->matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(eigen, PETSC_FALSE));
  for (PetscInt i = 0; i < eigen->n; i++) largest = PetscMax(largest, cabs(eigen->value[i]));
  *growth       = MpmGrowthPerStep(largest, exponent, bloch->turn);
  *without_null = bloch->nodal ? *growth : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochGrowth(MpmBloch *bloch, MpmSmallEigen *eigen, PetscReal courant, const PetscReal beta[],
                              PetscReal *growth)
{
  PetscReal without_null;

  PetscFunctionBegin;
  PetscCall(MpmBlochGrowths(bloch, eigen, courant, beta, growth, &without_null));
  PetscFunctionReturn(PETSC_SUCCESS);
}
