/*
   What the weights of one direction say of every layout: the limit of a lone particle, and Courant numbers up to which
   a scheme is stable on every layout of particles that are alike.

   Of MLS-MPM: k <= 2 sqrt(D / chi), with chi = 1 + (d - 1) nu / (1 - nu) and D = sum_i phi_ip (x_i - x_p)^2, the least
   over the places that particles may have. With F, S and A the operators on the nodes, of P2G G2P with the affine part,
   of DIV STRESS GRAD and of P2G G2P, a step is stable where S <= 2 (1 + F), and S <= k^2 chi / D (F - A).

   Of schemes with a step_bound w: k <= w / sqrt(lambda), and lambda is at most that of a lone particle at its worst
   place, chi times the largest sum_i (phi_i')^2 / phi_i of a direction. docs/theory.md, section 4.
*/
#include "analysis/lone.h"
#include "analysis/neighbourhood.h"
#include "analysis/search.h"
#include "linalg/small_eigen.h"
#include "scene/layout.h"
#include "scheme/maps.h"
#include <math.h>

#define PLACES 64     /* in a cell, at which H is taken first, and D */
#define UNBOUNDED 1e6 /* H comes near so much only where it has no bound */
#define SAME 1e-9     /* relative difference of H that is rounding */
#define BESIDE 1e-6   /* distance from the place at which a jump shows */
#define A_JUMP 0.01   /* relative */
#define BELOW 1e-8    /* relative: a largest sum that is sought may be a little less than it is */
#define NONE 1e-9     /* hats have D = 0 on a node */

/*
   The largest H = sum_i g_i^2 / phi_i over the places of a particle in its cell, along one direction. g are
   the weights of GRAD, and the sum is over the nodes that have mass. With gradient mls H is 1 / D.

   largest    - its value; infinite: it has no bound
   place      - where it is, in [0, 1); NaN: it is the same everywhere
   approached - it is a limit at place from one side, and not the value there
   fits       - g = phi r / D everywhere, as gradient mls has it and hats have it by themselves
*/
typedef struct {
  PetscReal largest, place;
  PetscBool approached, fits;
} Steepest;

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
static PetscBool Jumps(const Weights *w, const Steepest *slope)
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

static PetscErrorCode Steepness(const MpmBasis *basis, MpmGradient gradient, PetscReal half_width, Steepest *slope)
{
  const PetscBool mls    = gradient == MPM_GRADIENT_MLS ? PETSC_TRUE : PETSC_FALSE;
  Weights         w      = {.basis = basis, .kind = mls ? MPM_GRAD_MLS : MPM_GRAD, .half_width = half_width};
  Weights         fitted = {.basis = basis, .kind = MPM_GRAD_MLS, .half_width = half_width};
  PetscReal       least  = INFINITY, inverse;

  PetscFunctionBegin;
  *slope = (Steepest){.fits = PETSC_TRUE};
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

PetscErrorCode MpmLoneFind(const MpmLayout *layout, const MpmScheme *scheme, PetscReal courant, MpmNeighbourhood *lone)
{
  const MpmFormulation *f      = scheme->formulation;
  const PetscBool       affine = scheme->table->affine != MPM_NONE ? PETSC_TRUE : PETSC_FALSE;
  MpmCellSymbols        cell   = {
               .alpha = affine ? 1 : 0, .filter = 1, .kappa = 1, .transfer = scheme->transfer, .numbers = &scheme->numbers};
  PetscReal H[MPM_MAX_DIM];
  PetscBool bounded = PETSC_TRUE;

  PetscFunctionBegin;
  *lone        = MpmNeighbourhoodOf(MPM_ALONE);
  lone->closed = !MpmSpaceIsPrestressed(&scheme->space) && f->limit && f->corrected &&
                         (!MpmSpaceIsDamped(&scheme->space) || scheme->space.proportional) &&
                         MpmFormulationHas(f, MPM_DIV) && !scheme->transfer->sharpen
                     ? PETSC_TRUE
                     : PETSC_FALSE;
  for (PetscInt a = 0; a < layout->dim; a++) {
    Steepest slope;

    PetscCall(Steepness(scheme->basis, scheme->space.gradient, layout->half_width[a], &slope));
    if (affine && !slope.fits) lone->closed = PETSC_FALSE;
    if (slope.approached) lone->approached = PETSC_TRUE;
    if (isinf(slope.largest)) bounded = PETSC_FALSE;
    lone->place[a] = slope.place;
    H[a]           = slope.largest;
  }
  if (!lone->closed) PetscFunctionReturn(PETSC_SUCCESS);
  if (bounded) cell.kappa = Stiffest(&scheme->space, H);
  cell.stiff    = cell.kappa;
  cell.drag     = MpmSpaceDrag(&scheme->space, cell.kappa);
  lone->courant = f->limit(&cell);
  lone->growth  = f->corrected(&cell, courant);
  if (isinf(lone->courant)) {
    for (PetscInt a = 0; a < layout->dim; a++)
      if (Loses(scheme->basis, scheme->space.gradient, layout->half_width[a])) lone->closed = PETSC_FALSE;
    lone->approached = PETSC_FALSE;
    for (PetscInt a = 0; a < layout->dim; a++) lone->place[a] = NAN;
  } else if (!bounded) {
    lone->courant = 0;
    lone->growth  = INFINITY;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- bounds for every layout ---- */

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
    Steepest slope;

    PetscCall(Steepness(scheme->basis, MPM_GRADIENT_BASIS, layout->half_width[a], &slope));
    steepest = PetscMax(steepest, slope.largest);
  }
  *bound = (1 - BELOW) * w / sqrt(Chi(layout->dim, &scheme->space) * steepest);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- which cases grow by real eigenvalues below -1 alone ---- */

/* Whether a particle of a file is exactly on a node, where hats have a slope at a node that they give no mass. */
static PetscBool IsOnNode(const MpmLayout *layout)
{
  PetscInt  cell[MPM_MAX_DIM];
  PetscReal xi[MPM_MAX_DIM];

  for (PetscInt64 id = 0; layout->given && id < layout->particles; id++) {
    MpmLayoutPlace(layout, id, cell, xi);
    for (PetscInt a = 0; a < layout->dim; a++)
      if (xi[a] == 0) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Whether the particles are those of the proofs: at rest, with DIV the adjoint of GRAD. */
static PetscBool Holds(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step)
{
  const MpmSpace *space = &scheme->space;

  if (MpmSpaceIsPrestressed(space) || space->displaced || space->finite || MpmSpaceIsDamped(space)) return PETSC_FALSE;
  if (layout->colliders || MpmStepDrifts(step) || (!MpmLayoutIsFull(layout) && !MpmLayoutIsScattered(layout)))
    return PETSC_FALSE;
  if (scheme->basis->hat && IsOnNode(layout)) return PETSC_FALSE;
  for (PetscInt a = 0; a < layout->dim; a++)
    for (int end = 0; end < 2; end++)
      if (layout->grid[a].ends[end] == MPM_FIXED_REACTION) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscBool MpmLeftmostDecides(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step)
{
  return scheme->formulation->leftmost && scheme->transfer->leftmost && Holds(layout, scheme, step) ? PETSC_TRUE
                                                                                                    : PETSC_FALSE;
}

/* implicit has a bound without a limit, and solves on the grid */
PetscBool MpmGrowthStays(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step)
{
  const MpmFormulation *f = scheme->formulation;

  if (MpmLeftmostDecides(layout, scheme, step)) return PETSC_TRUE;
  return f->step_bound && !f->leftmost && !scheme->transfer->filter &&
                 f->step_bound(&scheme->numbers, scheme->transfer) > 0 && !MpmTableSolves(scheme->table) &&
                 Holds(layout, scheme, step)
             ? PETSC_TRUE
             : PETSC_FALSE;
}
