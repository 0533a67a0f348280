/* The growth of one Bloch mode. */
#include "symbol/bloch_gained.h"
#include "symbol/bloch_nodal.h"
#include <mpmstab/verdict.h>

/* Growth by the matrix of a turn, divided by 2^exponent, which takes the place of eigen's. */
static PetscErrorCode OfTurn(const MpmBloch *bloch, MpmSmallEigen *eigen, PetscInt exponent, PetscReal *growth,
                             PetscReal *without_null)
{
  PetscReal largest = 0;

  PetscFunctionBegin;
  PetscCall(MpmSmallEigenSolve(eigen, PETSC_FALSE));
  for (PetscInt i = 0; i < eigen->n; i++) largest = PetscMax(largest, cabs(eigen->value[i]));
  *growth       = MpmGrowthPerStep(largest, exponent, bloch->turn);
  *without_null = bloch->nodal && bloch->nodal->all != MPM_NONE ? *growth : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same for up to as many Courant numbers as there are lanes. */
static PetscErrorCode OfTurns(MpmBloch *bloch, MpmSmallEigen *eigen, PetscInt n, const PetscReal courant[],
                              const PetscReal beta[], PetscReal growth[], PetscReal without_null[])
{
  const PetscInt  numbers = bloch->turn_size * bloch->turn_size;
  double complex *G       = n == 1 ? eigen->matrix : bloch->turns;
  PetscInt        exponent[MPM_BLOCH_LANES];

  PetscFunctionBegin;
  PetscCall(MpmBlochTurns(bloch, n, courant, beta, G, exponent));
  for (PetscInt i = 0; i < n; i++) {
    if (n > 1) PetscCall(PetscArraycpy(eigen->matrix, G + i * numbers, numbers));
    PetscCall(OfTurn(bloch, eigen, exponent[i], &growth[i], &without_null[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where the nodal operator is too large for doubles, growth is not that of the null space. */
PetscErrorCode MpmBlochGrowths(MpmBloch *bloch, MpmSmallEigen *eigen, PetscInt n, const PetscReal courant[],
                               const PetscReal beta[], PetscReal growth[], PetscReal without_null[])
{
  PetscFunctionBegin;
  for (PetscInt i = 0, some; i < n; i += some) {
    PetscBool ok = PETSC_FALSE;

    some = bloch->nodal ? 1 : PetscMin(bloch->most, n - i);
    if (bloch->nodal)
      PetscCall(MpmBlochNodalGrowths(bloch->nodal, bloch, courant[i], beta, &growth[i], &without_null[i], &ok));
    if (bloch->gained) PetscCall(MpmBlochGainedGrowth(bloch->gained, bloch, courant[i], beta, &growth[i], &ok));
    if (bloch->gained) without_null[i] = NAN;
    if (!ok) PetscCall(OfTurns(bloch, eigen, some, courant + i, beta, growth + i, without_null + i));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
