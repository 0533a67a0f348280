/* The growth of one Bloch mode. */
#include "symbol/bloch_growth.h"
#include <mpmstab/verdict.h>

PetscErrorCode MpmBlochGrowth(MpmBloch *bloch, MpmSmallEigen *eigen, PetscReal courant, const PetscReal beta[],
                              PetscReal *growth)
{
  PetscInt  exponent;
  PetscReal largest = 0;

  PetscFunctionBegin;
  PetscCall(MpmBlochTurn(bloch, courant, beta, eigen->matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(eigen, PETSC_FALSE));
  for (PetscInt i = 0; i < eigen->n; i++) largest = PetscMax(largest, cabs(eigen->value[i]));
  *growth = MpmGrowthPerStep(largest, exponent, bloch->turn);
  PetscFunctionReturn(PETSC_SUCCESS);
}
