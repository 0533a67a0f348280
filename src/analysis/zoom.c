/* The least value of a function of phases: a grid over all of them, then steps that shrink from the best places. */
#include "analysis/search.h"
#include "analysis/zoom.h"
#include "symbol/source.h"
#include <mpmstab/errors.h>
#include <math.h>

#define NEIGHBOURS 27 /* 3^dim, itself included */

/* The grid. In direction a its indices run over lo[a] .. points; index -i is the phase of i with the other sign. */
typedef struct {
  const MpmZoom  *zoom;
  MpmZoomFunction f;
  void           *context;
  PetscInt        lo[MPM_MAX_DIM], width[MPM_MAX_DIM], n;
  PetscReal      *value;
} Grid;

MpmZoom MpmZoomOf(const MpmLayout *layout, const MpmSpace *space, const MpmFraction drift[])
{
  MpmZoom zoom = {.dim = layout->dim};

  MpmPhasesSymmetries(layout, space, drift, zoom.mirror, zoom.alike);
  return zoom;
}

static PetscReal PhaseOf(const MpmZoom *zoom, PetscInt i)
{
  const PetscReal size = PETSC_PI / 2 * (1 - cos(PETSC_PI * PetscAbsInt(i) / zoom->points));

  return i < 0 ? -size : size;
}

static PetscReal Wrap(PetscReal beta)
{
  beta = remainder(beta, 2 * PETSC_PI);
  return beta <= -PETSC_PI ? PETSC_PI : beta;
}

void MpmZoomFold(PetscInt dim, PetscReal beta[])
{
  PetscReal sign = 0;

  for (PetscInt a = 0; a < dim; a++) {
    beta[a] = Wrap(beta[a]);
    if (beta[a] < -PETSC_PI * (1 - 8 * PETSC_MACHINE_EPSILON)) beta[a] = PETSC_PI;
    if (sign == 0 && beta[a] != PETSC_PI) sign = beta[a];
  }
  for (PetscInt a = 0; a < dim && sign < 0; a++) beta[a] = Wrap(0 - beta[a]);
}

/* Values that are not known or belong to too long waves count as infinite. */
static PetscErrorCode Value(const MpmZoom *zoom, MpmZoomFunction f, void *context, const PetscReal beta[],
                            PetscReal *value)
{
  PetscReal largest = 0;

  PetscFunctionBegin;
  *value = INFINITY;
  for (PetscInt a = 0; a < zoom->dim; a++) largest = PetscMax(largest, PetscAbsReal(beta[a]));
  if (largest < zoom->least) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(f(context, beta, value));
  if (isnan(*value)) *value = INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Swap(PetscInt *a, PetscInt *b)
{
  const PetscInt kept = *a;

  *a = *b;
  *b = kept;
}

/* Finds the place on the grid whose value is that of the given indices, by all symmetries that there are. */
static void Normalise(const MpmZoom *zoom, PetscInt i[])
{
  const PetscInt n = zoom->points;

  for (PetscInt a = 0; a < zoom->dim; a++) {
    if (i[a] > n) i[a] -= 2 * n;
    if (i[a] <= -n) i[a] += 2 * n;
    if (zoom->mirror[a]) i[a] = PetscAbsInt(i[a]);
  }
  if (i[0] < 0)
    for (PetscInt a = 0; a < zoom->dim; a++)
      if (!zoom->mirror[a] && i[a] != n) i[a] = -i[a];
  for (PetscInt a = 0; a < zoom->dim; a++)
    for (PetscInt b = a + 1; b < zoom->dim; b++)
      if (zoom->alike[a] == zoom->alike[b] && i[b] > i[a]) Swap(&i[a], &i[b]);
}

static PetscInt PlaceOf(const Grid *g, const PetscInt i[])
{
  PetscInt place = 0;

  for (PetscInt a = g->zoom->dim - 1; a >= 0; a--) place = place * g->width[a] + i[a] - g->lo[a];
  return place;
}

static void IndicesOf(const Grid *g, PetscInt place, PetscInt i[])
{
  for (PetscInt a = 0; a < g->zoom->dim; a++) {
    i[a] = g->lo[a] + place % g->width[a];
    place /= g->width[a];
  }
}

/* Whether a place is one that others are reduced to by symmetry. */
static PetscBool IsNormal(const Grid *g, const PetscInt i[])
{
  PetscInt  j[MPM_MAX_DIM];
  PetscBool same = PETSC_TRUE;

  for (PetscInt a = 0; a < g->zoom->dim; a++) j[a] = i[a];
  Normalise(g->zoom, j);
  for (PetscInt a = 0; a < g->zoom->dim; a++)
    if (i[a] != j[a]) same = PETSC_FALSE;
  return same;
}

/* Computes the values on the grid, spread over the ranks. */
static PetscErrorCode GridCreate(const MpmZoom *zoom, MpmZoomFunction f, void *context, Grid *g)
{
  PetscInt          part = 0;
  const PetscMPIInt rank = MpmRankOf(zoom->comm), size = MpmRanksOf(zoom->comm);

  PetscFunctionBegin;
  *g = (Grid){.zoom = zoom, .f = f, .context = context, .n = 1};
  for (PetscInt a = 0; a < zoom->dim; a++) {
    g->lo[a]    = a == 0 || zoom->mirror[a] ? 0 : 1 - zoom->points;
    g->width[a] = zoom->points + 1 - g->lo[a];
    g->n *= g->width[a];
  }
  PetscCall(PetscMalloc1(g->n, &g->value));
  for (PetscInt place = g->n - 1; place >= 0; place--) { /* short waves first: theirs are mostly the least limits */
    PetscInt  i[MPM_MAX_DIM];
    PetscReal beta[MPM_MAX_DIM];

    g->value[place] = INFINITY;
    IndicesOf(g, place, i);
    if (!IsNormal(g, i) || part++ % size != rank) continue;
    for (PetscInt a = 0; a < zoom->dim; a++) beta[a] = PhaseOf(zoom, i[a]);
    PetscCall(Value(zoom, f, context, beta, &g->value[place]));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, g->value, (PetscMPIInt)g->n, MPIU_REAL, MPI_MIN, zoom->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt NeighboursOf(PetscInt dim)
{
  return dim == 3 ? NEIGHBOURS : dim == 2 ? NEIGHBOURS / 3 : NEIGHBOURS / 9;
}

/* The step of direction a towards neighbour m: -1, 0 or 1. */
static PetscInt Towards(PetscInt m, PetscInt a)
{
  const PetscInt power[] = {1, 3, 9};

  return m / power[a] % 3 - 1;
}

/* Whether no neighbour of a place has a smaller value; of equal ones the first counts. */
static PetscBool IsLowest(const Grid *g, PetscInt place)
{
  PetscInt i[MPM_MAX_DIM], j[MPM_MAX_DIM];

  IndicesOf(g, place, i);
  if (isinf(g->value[place]) || !IsNormal(g, i)) return PETSC_FALSE;
  for (PetscInt m = 0; m < NeighboursOf(g->zoom->dim); m++) {
    PetscInt other;

    for (PetscInt a = 0; a < g->zoom->dim; a++) j[a] = i[a] + Towards(m, a);
    Normalise(g->zoom, j);
    other = PlaceOf(g, j);
    if (g->value[other] < g->value[place] || (g->value[other] == g->value[place] && other < place)) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* Finds the lowest places, the best of them first. */
static PetscInt FindStarts(const Grid *g, PetscInt starts[])
{
  PetscInt n = 0;

  for (PetscInt place = 0; place < g->n; place++) {
    PetscInt at;

    if (!IsLowest(g, place)) continue;
    if (n < g->zoom->starts)
      n++;
    else if (g->value[place] >= g->value[starts[n - 1]])
      continue;
    for (at = n - 1; at > 0 && g->value[starts[at - 1]] > g->value[place]; at--) starts[at] = starts[at - 1];
    starts[at] = place;
  }
  while (n > 1 && g->value[starts[n - 1]] > g->zoom->within * g->value[starts[0]]) n--;
  return n;
}

typedef struct {
  const MpmZoom  *zoom;
  MpmZoomFunction f;
  void           *context;
} Downhill;

static PetscErrorCode ValueThere(void *context, PetscReal beta[], PetscReal *value)
{
  const Downhill *d = (const Downhill *)context;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < d->zoom->dim; a++) beta[a] = Wrap(beta[a]);
  PetscCall(Value(d->zoom, d->f, d->context, beta, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmZoomFrom(const MpmZoom *zoom, MpmZoomFunction f, void *context, PetscReal step, PetscReal beta[],
                           PetscReal *value)
{
  Downhill               there   = {zoom, f, context};
  const MpmSearchDescent descent = {
      .f = ValueThere, .context = &there, .n = zoom->dim, .together = zoom->dim, .finest = zoom->finest};

  PetscFunctionBegin;
  PetscCall(MpmSearchDescend(&descent, step, beta, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives every rank the best of what the ranks have found; of equal values that of the first start. */
static PetscErrorCode Choose(const MpmZoom *zoom, PetscInt n, PetscReal found[][MPM_MAX_DIM + 1], PetscReal beta[],
                             PetscReal *value)
{
  PetscFunctionBegin;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, found, (PetscMPIInt)(n * (MPM_MAX_DIM + 1)), MPIU_REAL, MPI_SUM, zoom->comm));
  *value = INFINITY;
  for (PetscInt a = 0; a < zoom->dim; a++) beta[a] = NAN;
  for (PetscInt s = 0; s < n; s++) {
    if (!(found[s][MPM_MAX_DIM] < *value)) continue;
    *value = found[s][MPM_MAX_DIM];
    PetscCall(PetscArraycpy(beta, found[s], zoom->dim));
  }
  MpmZoomFold(zoom->dim, beta);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmZoomLeast(const MpmZoom *zoom, MpmZoomFunction f, void *context, PetscReal beta[], PetscReal *value)
{
  PetscReal         found[MPM_ZOOM_STARTS][MPM_MAX_DIM + 1] = {{0}};
  PetscInt          starts[MPM_ZOOM_STARTS], n;
  const PetscMPIInt rank = MpmRankOf(zoom->comm), size = MpmRanksOf(zoom->comm);
  Grid              grid;

  PetscFunctionBegin;
  PetscCall(GridCreate(zoom, f, context, &grid));
  n = FindStarts(&grid, starts);
  for (PetscInt s = rank; s < n; s += size) {
    PetscInt i[MPM_MAX_DIM];

    IndicesOf(&grid, starts[s], i);
    for (PetscInt a = 0; a < zoom->dim; a++) found[s][a] = PhaseOf(zoom, i[a]);
    found[s][MPM_MAX_DIM] = grid.value[starts[s]];
    PetscCall(MpmZoomFrom(zoom, f, context, PETSC_PI / 2 / (PetscReal)zoom->points, found[s], &found[s][MPM_MAX_DIM]));
  }
  PetscCall(PetscFree(grid.value));
  PetscCall(Choose(zoom, n, found, beta, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}
