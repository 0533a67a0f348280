/* The limit of a lone particle, from the weights of one direction at its worst place. */
#include "analysis/lone.h"
#include "analysis/search.h"
#include "linalg/small_eigen.h"
#include "scheme/maps.h"
#include <math.h>

#define PLACES 64     /* in a cell, at which H is taken first */
#define UNBOUNDED 1e6 /* H comes near so much only where it has no bound */
#define SAME 1e-9     /* relative difference of H that is rounding */
#define BESIDE 1e-6   /* distance from the place at which a jump shows */
#define A_JUMP 0.01   /* relative */

typedef struct {
  const MpmBasis *basis;
  MpmOpKind       kind;
  PetscReal       half_width;
} Weights;

/* H at a place. Nodes without weight have no mass, and no force. */
static PetscReal Slope(const Weights *w, PetscReal place)
{
  const PetscReal xi = place - floor(place);
  PetscReal       phi[MPM_MAX_REACH], g[MPM_MAX_REACH], sum = 0;

  MpmMapRow(w->basis, MPM_G2P, xi, w->half_width, MpmNoWalls, phi);
  MpmMapRow(w->basis, w->kind, xi, w->half_width, MpmNoWalls, g);
  for (PetscInt d = 0; d < MpmMapReach(w->basis); d++)
    if (phi[d] > 0) sum += PetscSqr(g[d]) / phi[d];
  return sum;
}

static PetscErrorCode Compliance(void *context, PetscReal place, PetscReal *value)
{
  PetscFunctionBegin;
  *value = 1 / Slope((const Weights *)context, place);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether H is less at the place than next to it, or on one side of it. */
static PetscBool Jumps(const Weights *w, const MpmSlope *slope)
{
  for (int side = -1; side <= 1; side++)
    if (Slope(w, slope->place + side * BESIDE) < slope->largest * (1 - A_JUMP)) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Whether a particle exactly on a node has a gradient at a node that it gives no mass: that node's share is lost. */
static PetscBool Loses(const MpmBasis *basis, MpmGradient gradient, PetscReal half_width)
{
  PetscReal phi[MPM_MAX_REACH], g[MPM_MAX_REACH];

  MpmMapRow(basis, MPM_G2P, 0, half_width, MpmNoWalls, phi);
  MpmMapRow(basis, gradient == MPM_GRADIENT_MLS ? MPM_GRAD_MLS : MPM_GRAD, 0, half_width, MpmNoWalls, g);
  for (PetscInt d = 0; d < MpmMapReach(basis); d++)
    if (!(phi[d] > 0) && fabs(g[d]) > SAME) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmSlopeFind(const MpmBasis *basis, MpmGradient gradient, PetscReal half_width, MpmSlope *slope)
{
  const PetscBool mls    = gradient == MPM_GRADIENT_MLS ? PETSC_TRUE : PETSC_FALSE;
  Weights         w      = {.basis = basis, .kind = mls ? MPM_GRAD_MLS : MPM_GRAD, .half_width = half_width};
  Weights         fitted = {.basis = basis, .kind = MPM_GRAD_MLS, .half_width = half_width};
  PetscReal       least  = INFINITY, inverse;

  PetscFunctionBegin;
  *slope = (MpmSlope){.fits = PETSC_TRUE};
  /* between the nodes and beside them: on a node hats have no D */
  for (int j = 0; j < PLACES; j++) {
    const PetscReal place = (j + 0.5) / PLACES, here = Slope(&w, place);

    if (here > slope->largest * (1 + SAME)) {
      slope->largest = here;
      slope->place   = place;
    }
    least = PetscMin(least, here);
    if (fabs(here / Slope(&fitted, place) - 1) > SAME) slope->fits = PETSC_FALSE;
  }
  if (slope->largest <= least * (1 + SAME)) {
    slope->place = NAN;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSearchLeast(Compliance, &w, MPM_SEARCH_GOLDEN, slope->place - 1.0 / PLACES, slope->place + 1.0 / PLACES,
                           &slope->place, &inverse));
  slope->largest    = 1 / inverse < UNBOUNDED ? 1 / inverse : INFINITY;
  slope->place      = BESIDE * round(slope->place / BESIDE);
  slope->approached = Jumps(&w, slope);
  slope->place -= floor(slope->place);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The largest eigenvalue of STRESS H over normal stresses, lambda 1 1^T H + 2 mu H. Those of shear stresses,
   mu (H_a + H_b), are never above it.
*/
static PetscReal Stiffest(const MpmSpace *space, const PetscReal H[])
{
  const PetscReal lambda = space->poisson / (1 - space->poisson);
  double complex  M[MPM_MOST_HERMITIAN][MPM_MOST_HERMITIAN], vector[MPM_MOST_HERMITIAN][MPM_MOST_HERMITIAN];
  PetscReal       value[MPM_MOST_HERMITIAN];

  if (space->dim == 1) return H[0];
  for (PetscInt a = 0; a < space->dim; a++)
    for (PetscInt b = 0; b < space->dim; b++) M[a][b] = (a == b ? 1 : lambda) * sqrt(H[a] * H[b]);
  MpmHermitianSolve(space->dim, M, value, vector);
  return value[0];
}

PetscErrorCode MpmLoneFind(const MpmLayout *layout, const MpmScheme *scheme, PetscReal courant, MpmLone *lone)
{
  const MpmFormulation *f      = scheme->formulation;
  const PetscBool       affine = scheme->table->affine != MPM_NONE ? PETSC_TRUE : PETSC_FALSE;
  MpmCellSymbols        cell   = {
               .alpha = affine ? 1 : 0, .filter = 1, .kappa = 1, .transfer = scheme->transfer, .numbers = &scheme->numbers};
  PetscReal H[MPM_MAX_DIM];
  PetscBool bounded = PETSC_TRUE;

  PetscFunctionBegin;
  *lone = (MpmLone){.known = !MpmSpaceIsPrestressed(&scheme->space) && f->limit && f->corrected &&
                                     (!MpmSpaceIsDamped(&scheme->space) || scheme->space.proportional) &&
                                     MpmFormulationHas(f, MPM_DIV) && !scheme->transfer->sharpen
                                 ? PETSC_TRUE
                                 : PETSC_FALSE};
  for (PetscInt a = 0; a < layout->dim; a++) {
    MpmSlope slope;

    PetscCall(MpmSlopeFind(scheme->basis, scheme->space.gradient, layout->half_width[a], &slope));
    if (affine && !slope.fits) lone->known = PETSC_FALSE;
    if (slope.approached) lone->approached = PETSC_TRUE;
    if (isinf(slope.largest)) bounded = PETSC_FALSE;
    lone->place[a] = slope.place;
    H[a]           = slope.largest;
  }
  if (!lone->known) PetscFunctionReturn(PETSC_SUCCESS);
  if (bounded) cell.kappa = Stiffest(&scheme->space, H);
  cell.stiff    = cell.kappa;
  cell.drag     = MpmSpaceDrag(&scheme->space, cell.kappa);
  lone->courant = f->limit(&cell);
  lone->growth  = f->corrected(&cell, courant);
  if (isinf(lone->courant)) {
    for (PetscInt a = 0; a < layout->dim; a++)
      if (Loses(scheme->basis, scheme->space.gradient, layout->half_width[a])) lone->known = PETSC_FALSE;
    lone->approached = PETSC_FALSE;
    for (PetscInt a = 0; a < layout->dim; a++) lone->place[a] = NAN;
  } else if (!bounded) {
    lone->courant = 0;
    lone->growth  = INFINITY;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
