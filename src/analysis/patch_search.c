/*
   The least value over places and phases. A point has, for each direction, a panel and a place s in it, or a place s in
   the spacing and a phase. Panels are not left: their neighbours have starts of their own.
*/
#include "analysis/patch_search.h"
#include "analysis/search.h"
#include "base/farm.h"
#include "scheme/maps.h"
#include <math.h>

#define MOST 6     /* starts */
#define WITHIN 1.3 /* starts have at most so many times the least value */
#define FIRST_STEP 0.125
#define ROUGH 1e-4 /* the step with which the search from each start ends */
#define FINEST 1e-8
#define FLAT 1e-10 /* relative */
#define VARIABLES (2 * MPM_MAX_DIM)

/* ---- a spot ---- */

/*
   Sets the nodes of a lattice along a direction, and returns the number of particles there. Without an end all nodes
   are one, with phases, and the particles those of a cell.
*/
static PetscInt SetNodes(const MpmPatchLattice *l, const MpmPatchSpot *spot, PetscInt axis, MpmCluster *c)
{
  const MpmBasis *basis = l->of->scheme->basis;
  const PetscInt  ppc   = l->of->layout->ppc[axis];

  c->first[axis] = -basis->reach_left;
  switch (l->end[axis]) {
  case MPM_PATCH_ENDLESS:
    c->wraps[axis] = PETSC_TRUE;
    c->beta[axis]  = spot->beta[axis];
    c->nodes[axis] = 1;
    return ppc;
  case MPM_PATCH_SINGLE:
    c->nodes[axis] = MpmMapReach(basis);
    return 1;
  default:
    if (l->held) c->first[axis] = l->depth / 2;
    c->nodes[axis] = l->depth + 1 - c->first[axis];
    return (l->depth + MpmMapReach(basis)) * ppc;
  }
}

PetscErrorCode MpmPatchCluster(const MpmPatchLattice *l, const MpmPatchSpot *spot, MpmCluster *c)
{
  const PetscInt dim = l->plan->dim;
  PetscInt       along[MPM_MAX_DIM];

  PetscFunctionBegin;
  *c = (MpmCluster){.of = l->of, .plan = l->plan, .n = 1};
  for (PetscInt a = 0; a < dim; a++) {
    along[a] = SetNodes(l, spot, a, c);
    c->n *= along[a];
  }
  PetscCall(MpmClusterCreate(c->n, c));
  for (PetscInt p = 0; p < c->n; p++)
    for (PetscInt a = 0, rest = p; a < dim; rest /= along[a++]) {
      const PetscInt ppc = l->of->layout->ppc[a], site = spot->j[a] + rest % along[a];

      c->cell[dim * p + a] = site / ppc;
      c->xi[dim * p + a]   = ((PetscReal)(site % ppc) + spot->t[a]) / (PetscReal)ppc;
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPatchCrossing(MpmPatchLattice *l, const MpmPatchSpot *spot, PetscReal *courant)
{
  MpmCluster cluster;

  PetscFunctionBegin;
  PetscCall(MpmPatchCluster(l, spot, &cluster));
  PetscCall(MpmClusterCrossing(&cluster, courant));
  PetscCheck(!isnan(*courant), PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK found no eigenvalues");
  PetscCall(MpmClusterDestroy(&cluster));
  l->count++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPatchGrowth(MpmPatchLattice *l, const MpmPatchSpot *spot, PetscReal courant, PetscReal *growth,
                              PetscReal *rounding)
{
  MpmCluster cluster;

  PetscFunctionBegin;
  PetscCall(MpmPatchCluster(l, spot, &cluster));
  PetscCall(MpmClusterGrowth(&cluster, courant, growth, rounding));
  PetscCheck(!isnan(*growth), PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK found no eigenvalues");
  PetscCall(MpmClusterDestroy(&cluster));
  l->count++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the points of a search ---- */

/* A point: the panel of each direction with an end, and the variables: s, and where there is no end phase / pi. */
typedef struct {
  PetscInt  panel[MPM_MAX_DIM];
  PetscReal u[VARIABLES];
} Point;

typedef struct {
  MpmPatchSearch *search;
  PetscReal      *value, *found; /* by spot of the grid; VARIABLES + MPM_MAX_DIM + 1 numbers by start */
  PetscReal       deep[MOST + MPM_PATCH_MORE];
  Point           start[MOST + MPM_PATCH_MORE];
  PetscReal       step, finest;
} Work;

#define NUMBERS (VARIABLES + MPM_MAX_DIM + 1)

static PetscBool HasEnd(const MpmPatchSearch *s, PetscInt axis)
{
  return s->lattice->end[axis] != MPM_PATCH_ENDLESS ? PETSC_TRUE : PETSC_FALSE;
}

static PetscInt Dim(const MpmPatchSearch *s)
{
  return s->lattice->plan->dim;
}

/* The first direction without an end; its phase need not be negative. */
static PetscInt FirstEndless(const MpmPatchSearch *s)
{
  PetscInt a = 0;

  while (a < Dim(s) && HasEnd(s, a)) a++;
  return a;
}

/* The number of variables of the search. */
static PetscInt Free(const MpmPatchSearch *s)
{
  PetscInt n = 0;

  for (PetscInt a = 0; a < Dim(s); a++) n += HasEnd(s, a) ? 1 : 2;
  return n;
}

static MpmPatchSpot SpotOf(const MpmPatchSearch *s, const Point *at)
{
  MpmPatchSpot spot = {.j = {0}};
  PetscInt     v    = 0;

  for (PetscInt a = 0; a < Dim(s); a++) {
    const PetscReal place = at->u[v++];

    if (HasEnd(s, a)) {
      spot.j[a] = at->panel[a] / 2;
      spot.t[a] = ((PetscReal)(at->panel[a] % 2) + place) / 2;
    } else {
      spot.t[a]    = place;
      spot.beta[a] = PETSC_PI * at->u[v++];
    }
  }
  return spot;
}

/* Moves variables back into their ranges. */
static void Confine(const MpmPatchSearch *s, Point *at)
{
  PetscInt v = 0;

  for (PetscInt a = 0; a < Dim(s); a++) {
    at->u[v] = PetscMin(PetscMax(at->u[v], MPM_PATCH_MARGIN), 1 - MPM_PATCH_MARGIN);
    v++;
    if (HasEnd(s, a)) continue;
    if (a == FirstEndless(s))
      at->u[v] = PetscMin(PetscMax(at->u[v], 0), 1);
    else if (fabs(at->u[v]) > 1)
      at->u[v] -= copysign(2, at->u[v]);
    v++;
  }
}

static Point PointOf(const MpmPatchSearch *s, const MpmPatchSpot *spot)
{
  Point    at = {.panel = {0}};
  PetscInt v  = 0;

  for (PetscInt a = 0; a < Dim(s); a++)
    if (HasEnd(s, a)) {
      const PetscInt half = spot->t[a] < 0.5 ? 0 : 1;

      at.panel[a] = 2 * spot->j[a] + half;
      at.u[v++]   = 2 * spot->t[a] - (PetscReal)half;
    } else {
      at.u[v++] = spot->t[a];
      at.u[v++] = spot->beta[a] / PETSC_PI;
    }
  Confine(s, &at);
  return at;
}

/* ---- the grid ---- */

/* The numbers of places and of phases of an axis on the grid. Matrices of more directions with ends are larger. */
static void GridOf(const MpmPatchSearch *s, PetscInt axis, PetscInt *places, PetscInt *phases)
{
  const PetscInt n = Free(s);

  *phases = 1;
  if (HasEnd(s, axis)) {
    *places = n <= 1 ? 9 : n <= 2 ? 4 : 3;
    return;
  }
  *places = n <= 3 ? 4 : 2;
  *phases = axis == FirstEndless(s) ? (n <= 3 ? 9 : 6) : 9;
}

static PetscInt PanelsOf(const MpmPatchSearch *s, PetscInt axis)
{
  return HasEnd(s, axis) ? 2 * s->lattice->of->layout->ppc[axis] : 1;
}

PetscInt MpmPatchGridSize(const MpmPatchSearch *s)
{
  PetscInt n = 1, places, phases;

  for (PetscInt a = 0; a < Dim(s); a++) {
    GridOf(s, a, &places, &phases);
    n *= PanelsOf(s, a) * places * phases;
  }
  return n;
}

/* The point of the grid of number i; cell[]: its place on the grid by variable. False: it is an image of another. */
static PetscBool GridPoint(const MpmPatchSearch *s, PetscInt i, Point *at, PetscInt cell[])
{
  PetscInt v = 0, before = -1;

  *at = (Point){.panel = {0}};
  for (PetscInt a = 0; a < Dim(s); a++) {
    const PetscInt panels = PanelsOf(s, a);
    PetscInt       places, phases, site;

    GridOf(s, a, &places, &phases);
    site = i % (panels * places);
    i /= panels * places;
    at->panel[a] = site / places;
    at->u[v]     = (PetscReal)(site % places) / (PetscReal)(HasEnd(s, a) ? places - 1 : places);
    cell[v++]    = site;
    if (HasEnd(s, a)) {
      if (s->alike && site < before) return PETSC_FALSE;
      before = site;
      continue;
    }
    cell[v] = i % phases;
    i /= phases;
    at->u[v] = a == FirstEndless(s) ? (PetscReal)cell[v] / (PetscReal)(phases - 1)
                                    : 2 * (PetscReal)(cell[v] + 1) / (PetscReal)phases - 1;
    v++;
  }
  Confine(s, at);
  return PETSC_TRUE;
}

PetscBool MpmPatchGridSpot(const MpmPatchSearch *s, PetscInt i, MpmPatchSpot *spot)
{
  PetscInt  cell[VARIABLES];
  Point     at;
  PetscBool is = GridPoint(s, i, &at, cell);

  *spot = SpotOf(s, &at);
  return is;
}

static PetscErrorCode ValueAt(const MpmPatchSearch *s, const Point *at, PetscReal *value)
{
  const MpmPatchSpot spot = SpotOf(s, at);

  PetscFunctionBegin;
  PetscCall(s->f(s->context, &spot, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GridPart(void *context, PetscInt i)
{
  Work    *w = (Work *)context;
  PetscInt cell[VARIABLES];
  Point    at;

  PetscFunctionBegin;
  w->value[i] = INFINITY;
  if (GridPoint(w->search, i, &at, cell)) PetscCall(ValueAt(w->search, &at, &w->value[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether two points of the grid are neighbours or the same. */
static PetscBool Near(const MpmPatchSearch *s, PetscInt i, PetscInt j)
{
  PetscInt a[VARIABLES], b[VARIABLES];
  Point    at;

  (void)GridPoint(s, i, &at, a);
  (void)GridPoint(s, j, &at, b);
  for (PetscInt v = 0; v < Free(s); v++)
    if (PetscAbsInt(a[v] - b[v]) > 1) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The best points of the grid, no two of them neighbours. Values may be negative where growth is sought. */
static PetscInt Starts(Work *w)
{
  const PetscInt size  = MpmPatchGridSize(w->search);
  PetscInt       n     = 0, taken[MOST], cell[VARIABLES];
  PetscReal      limit = INFINITY;

  while (n < MOST) {
    PetscInt best = -1;

    for (PetscInt i = 0; i < size; i++) {
      PetscBool near = PETSC_FALSE;

      if (!(w->value[i] < (best < 0 ? limit : w->value[best]))) continue;
      for (PetscInt t = 0; t < n && !near; t++) near = Near(w->search, i, taken[t]);
      if (!near) best = i;
    }
    if (best < 0) break;
    if (n == 0 && w->value[best] > 0) limit = WITHIN * w->value[best];
    taken[n] = best;
    (void)GridPoint(w->search, best, &w->start[n++], cell);
  }
  return n;
}

/* ---- from a start ---- */

/* Descends from a point in its panels. */
typedef struct {
  const MpmPatchSearch *search;
  Point                *at;
} Downhill;

static PetscErrorCode ValueThere(void *context, PetscReal u[], PetscReal *value)
{
  const Downhill *d    = (const Downhill *)context;
  Point           next = *d->at;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(next.u, u, Free(d->search)));
  Confine(d->search, &next);
  PetscCall(PetscArraycpy(u, next.u, Free(d->search)));
  PetscCall(ValueAt(d->search, &next, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode StartPart(void *context, PetscInt i)
{
  Work      *w     = (Work *)context;
  Point      at    = w->start[i];
  PetscReal *found = w->found + i * NUMBERS;
  Downhill   there = {w->search, &at};

  const MpmSearchDescent descent = {
      .f = ValueThere, .context = &there, .n = Free(w->search), .together = 2, .finest = w->finest};

  PetscFunctionBegin;
  PetscCall(ValueAt(w->search, &at, &found[0]));
  PetscCall(MpmSearchDescend(&descent, w->step, at.u, &found[0]));
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) found[1 + a] = (PetscReal)at.panel[a];
  for (PetscInt v = 0; v < VARIABLES; v++) found[1 + MPM_MAX_DIM + v] = at.u[v];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From each of n starts, which become the places that were come to. value: that of the first. */
static PetscErrorCode FromStarts(Work *w, PetscInt n, PetscReal step, PetscReal finest, PetscReal *value)
{
  PetscFunctionBegin;
  PetscCall(PetscArrayzero(w->found, MOST * NUMBERS));
  w->step   = step;
  w->finest = finest;
  PetscCall(MpmFarm("start", n, StartPart, w));
  PetscCall(MpmFarmSumReals(n * NUMBERS, w->found));
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal *found = w->found + i * NUMBERS;

    for (PetscInt a = 0; a < MPM_MAX_DIM; a++) w->start[i].panel[a] = (PetscInt)found[1 + a];
    for (PetscInt v = 0; v < VARIABLES; v++) w->start[i].u[v] = found[1 + MPM_MAX_DIM + v];
  }
  *value = w->found[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DeepPart(void *context, PetscInt i)
{
  Work *w = (Work *)context;

  PetscFunctionBegin;
  PetscCall(ValueAt(w->search, &w->start[i], &w->deep[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Which of n starts is the best on a deep lattice. */
static PetscErrorCode Compare(Work *w, PetscInt n, PetscInt *best)
{
  PetscFunctionBegin;
  w->search->lattice->depth = w->search->deep;
  PetscCall(PetscArrayzero(w->deep, n));
  PetscCall(MpmFarm("start", n, DeepPart, w));
  PetscCall(MpmFarmSumReals(n, w->deep));
  *best = 0;
  for (PetscInt i = 1; i < n; i++)
    if (w->deep[i] < w->deep[*best] - (isfinite(w->deep[*best]) ? FLAT * fabs(w->deep[*best]) : 0)) *best = i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether all values of the grid are the same. */
static PetscBool IsFlat(const Work *w, PetscInt size)
{
  PetscReal least = INFINITY, most = -INFINITY;

  for (PetscInt i = 0; i < size; i++) {
    if (isinf(w->value[i])) continue;
    least = PetscMin(least, w->value[i]);
    most  = PetscMax(most, w->value[i]);
  }
  return most - least <= FLAT * fabs(least) ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmPatchLeast(MpmPatchSearch *s, MpmPatchSpot *spot, PetscReal *value)
{
  const PetscInt size = MpmPatchGridSize(s);
  Work           w    = {.search = s};
  PetscBool      flat;
  PetscInt       n, best = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(size, &w.value, MOST * NUMBERS, &w.found));
  s->lattice->depth = s->coarse;
  PetscCall(MpmFarm("place", size, GridPart, &w));
  PetscCall(MpmFarmSumReals(size, w.value));
  n      = Starts(&w);
  flat   = IsFlat(&w, size);
  *value = INFINITY;
  (void)MpmPatchGridSpot(s, 0, spot);
  if (n > 0) {
    *value = w.value[0];
    if (!flat) PetscCall(FromStarts(&w, n, FIRST_STEP, ROUGH, value));
    for (PetscInt i = 0; i < s->nmore; i++) w.start[n + i] = PointOf(s, &s->more[i]);
    PetscCall(Compare(&w, n + s->nmore, &best));
    w.start[0]        = w.start[best];
    s->lattice->depth = s->fine;
    if (!flat || best > 0) PetscCall(FromStarts(&w, 1, best < n ? ROUGH : FIRST_STEP, FINEST, value));
    *spot = SpotOf(s, &w.start[0]);
  }
  PetscCall(PetscFree2(w.value, w.found));
  PetscFunctionReturn(PETSC_SUCCESS);
}
