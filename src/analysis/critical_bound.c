/*
   The Courant number up to which MLS-MPM is stable on every layout: k <= 2 sqrt(D / chi), with chi = 1 + (d - 1) nu /
   (1 - nu) and D = sum_i phi_ip (x_i - x_p)^2, the least over the places that particles may have.

   With F, S and A the operators on the nodes, of P2G G2P with the affine part, of DIV STRESS GRAD and of P2G G2P, a step
   is stable where S <= 2 (1 + F), and S <= k^2 chi / D (F - A). docs/theory.md, section 4.
*/
#include "analysis/critical_parts.h"
#include "scheme/maps.h"
#include <math.h>

#define PLACES 64 /* in a cell, the node among them; D is least there where it is not the same everywhere */
#define NONE 1e-9 /* hats have D = 0 on a node */

void MpmCriticalSpread(const MpmBasis *basis, PetscReal half_width, PetscReal ends[2])
{
  ends[0] = INFINITY;
  ends[1] = 0;
  for (int place = 0; place < PLACES; place++) {
    const PetscReal xi = (PetscReal)place / PLACES;
    PetscReal       row[MPM_MAX_REACH], spread = 0;

    MpmMapRow(basis, MPM_G2P, xi, half_width, MpmNoWalls, row);
    for (PetscInt d = 0; d < MpmMapReach(basis); d++) spread += row[d] * PetscSqr(d - basis->reach_left - xi);
    ends[0] = PetscMin(ends[0], spread);
    ends[1] = PetscMax(ends[1], spread);
  }
}

PetscReal MpmCriticalBound(const MpmLayout *layout, const MpmScheme *scheme)
{
  const MpmSpace *space = &scheme->space;
  PetscReal       least = INFINITY, chi = 1, spread[2];

  if (MpmSpaceIsPrestressed(space) || !scheme->formulation->mls_bound || !scheme->transfer->mls_bound ||
      space->gradient != MPM_GRADIENT_MLS || layout->material.kind != MPM_MATERIAL_UNIFORM ||
      MpmBasisIsAltered(scheme->basis) || (layout->given && (layout->given->has[1] || layout->given->has[2])))
    return 0;
  for (PetscInt a = 0; a < layout->dim; a++) {
    MpmCriticalSpread(scheme->basis, layout->half_width[a], spread);
    least = PetscMin(least, spread[0]);
  }
  if (layout->dim > 1) chi += (PetscReal)(layout->dim - 1) * space->poisson / (1 - space->poisson);
  return least > NONE ? 2 * sqrt(least / chi) : 0;
}
