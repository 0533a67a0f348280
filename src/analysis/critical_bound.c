/*
   Courant numbers up to which a scheme is stable on every layout of particles that are alike.

   Of MLS-MPM: k <= 2 sqrt(D / chi), with chi = 1 + (d - 1) nu /
   (1 - nu) and D = sum_i phi_ip (x_i - x_p)^2, the least over the places that particles may have.

   With F, S and A the operators on the nodes, of P2G G2P with the affine part, of DIV STRESS GRAD and of P2G G2P, a step
   is stable where S <= 2 (1 + F), and S <= k^2 chi / D (F - A).

   Of schemes with a step_bound w: k <= w / sqrt(lambda), and lambda is at most that of a lone particle at its worst place,
   chi times the largest sum_i (phi_i')^2 / phi_i of a direction. docs/theory.md, section 4.
*/
#include "analysis/critical_parts.h"
#include "analysis/search.h"
#include "scheme/maps.h"
#include <math.h>

#define PLACES 64  /* in a cell, the node among them; D is least there where it is not the same everywhere */
#define BELOW 1e-8 /* relative: a largest sum that is sought may be a little less than it is */
#define NONE 1e-9  /* hats have D = 0 on a node */

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

/* chi: how much stiffer particles are against strains in all directions than in one. */
static PetscReal Chi(PetscInt dim, const MpmSpace *space)
{
  return dim > 1 ? 1 + (PetscReal)(dim - 1) * space->poisson / (1 - space->poisson) : 1;
}

/* Whether a bound of any layout may hold for a scheme and these particles. */
static PetscBool MayHold(const MpmLayout *layout, const MpmScheme *scheme)
{
  return !MpmSpaceIsPrestressed(&scheme->space) && !MpmSpaceIsDamped(&scheme->space) &&
                 layout->material.kind == MPM_MATERIAL_UNIFORM && !MpmBasisIsAltered(scheme->basis) &&
                 !(layout->given && (layout->given->has[1] || layout->given->has[2]))
             ? PETSC_TRUE
             : PETSC_FALSE;
}

PetscReal MpmCriticalBound(const MpmLayout *layout, const MpmScheme *scheme)
{
  const MpmSpace *space = &scheme->space;
  PetscReal       least = INFINITY, spread[2];

  if (!MayHold(layout, scheme) || !scheme->formulation->mls_bound || !scheme->transfer->mls_bound ||
      space->gradient != MPM_GRADIENT_MLS)
    return 0;
  for (PetscInt a = 0; a < layout->dim; a++) {
    MpmCriticalSpread(scheme->basis, layout->half_width[a], spread);
    least = PetscMin(least, spread[0]);
  }
  return least > NONE ? 2 * sqrt(least / Chi(layout->dim, space)) : 0;
}

/* Of a particle at xi in a cell: the sum over its nodes, with the sign that makes the largest one the least value. */
typedef struct {
  const MpmBasis *basis;
  PetscReal       half_width;
} Along;

static PetscErrorCode Steepness(void *context, PetscReal xi, PetscReal *value)
{
  const Along *along = (const Along *)context;
  PetscReal    phi[MPM_MAX_REACH], slope[MPM_MAX_REACH];

  MpmMapRow(along->basis, MPM_G2P, xi, along->half_width, MpmNoWalls, phi);
  MpmMapRow(along->basis, MPM_GRAD, xi, along->half_width, MpmNoWalls, slope);
  *value = 0;
  for (PetscInt d = 0; d < MpmMapReach(along->basis); d++)
    if (phi[d] > 0) *value -= PetscSqr(slope[d]) / phi[d];
  return PETSC_SUCCESS;
}

PetscErrorCode MpmCriticalLoneBound(const MpmLayout *layout, const MpmScheme *scheme, PetscReal *bound)
{
  const MpmFormulation *f        = scheme->formulation;
  const PetscReal       w        = f->step_bound ? f->step_bound(&scheme->numbers, scheme->transfer) : 0;
  PetscReal             steepest = 0;

  PetscFunctionBegin;
  *bound = 0;
  if (!(w > 0) || isinf(w) || scheme->basis->hat || !MayHold(layout, scheme) ||
      scheme->space.gradient != MPM_GRADIENT_BASIS || scheme->space.displaced || scheme->space.finite)
    PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < layout->dim; a++) {
    Along along = {scheme->basis, layout->half_width[a]};

    for (PetscInt place = 0; place < PLACES;
         place++) { /* each is between two of the ends of the functions' pieces, or beside one */
      PetscReal xi, value;

      PetscCall(MpmSearchLeast(Steepness, &along, MPM_SEARCH_GOLDEN, (PetscReal)place / PLACES,
                               (PetscReal)(place + 1) / PLACES, &xi, &value));
      steepest = PetscMax(steepest, -value);
    }
  }
  *bound = (1 - BELOW) * w / sqrt(Chi(layout->dim, &scheme->space) * steepest);
  PetscFunctionReturn(PETSC_SUCCESS);
}
