/* Bloch probing: cells that are alike, and the blocks of one of them. */
#include "probe/lattice.h"
#include "probe/columns.h"
#include "base/hash.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

#define BESIDE 1e-4 /* sites of a cell are farther apart, in cell widths */

/* ---- the lattice ---- */

typedef struct {
  PetscInt   cell;
  PetscReal  xi[MPM_MAX_DIM];
  PetscInt64 particle;
} Place;

/* Sites are numbered with x fastest. */
static int ByPlace(const void *one, const void *other)
{
  const Place *p = one, *q = other;

  if (p->cell != q->cell) return p->cell < q->cell ? -1 : 1;
  for (PetscInt a = MPM_MAX_DIM - 1; a >= 0; a--)
    if (PetscAbsReal(p->xi[a] - q->xi[a]) > BESIDE) return p->xi[a] < q->xi[a] ? -1 : 1;
  return p->particle < q->particle ? -1 : p->particle > q->particle;
}

/*
   The box of cells that has all particles, and the cell of each. Particles beyond a period are where they would be
   without. A place just below a face is on it. Returns whether there are as many particles as cells, so that none needs
   to be empty.
*/
static PetscBool FindCells(const MpmProbePlaces *p, MpmProbeLattice *l, Place places[])
{
  PetscInt all = 1;

  for (PetscInt64 i = 0; i < p->n; i++) places[i] = (Place){.particle = i};
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) l->cells[a] = 1;
  for (PetscInt a = 0; a < p->dim; a++) {
    const PetscReal around = rint(p->period[a]);
    PetscReal       first = INFINITY, last = -INFINITY, cells;

    for (PetscInt64 i = 0; i < p->n; i++) {
      first = PetscMin(first, floor(p->at[i * p->dim + a] + p->near));
      last  = PetscMax(last, floor(p->at[i * p->dim + a] + p->near));
    }
    cells = around > 0 ? PetscMin(last - first + 1, around) : last - first + 1;
    if (!(cells * all <= (PetscReal)p->n)) return PETSC_FALSE;
    l->cells[a] = (PetscInt)cells;
    l->wraps[a] = around > 0 && PetscAbsReal(p->period[a] - cells) < p->near * cells ? PETSC_TRUE : PETSC_FALSE;
    for (PetscInt64 i = 0; i < p->n; i++) {
      const PetscReal at = p->at[i * p->dim + a], cell = floor(at + p->near);

      places[i].xi[a] = at - cell;
      places[i].cell += all * (PetscInt)fmod(cell - first, cells);
    }
    all *= l->cells[a];
  }
  return PETSC_TRUE;
}

/* Whether cells have as many particles, at the same sites; places are sorted. */
static void CheckSites(const MpmProbePlaces *p, const MpmProbeLattice *l, const Place places[], size_t room,
                       char why_not[])
{
  const PetscInt all = l->cells[0] * l->cells[1] * l->cells[2];

  for (PetscInt64 i = 0; i < p->n && !why_not[0]; i++)
    if (p->n % all || places[i].cell != i / l->sites)
      (void)snprintf(why_not, room, "cells have different numbers of particles");
  for (PetscInt64 i = l->sites; i < p->n && !why_not[0]; i++)
    for (PetscInt a = 0; a < p->dim; a++)
      if (PetscAbsReal(places[i].xi[a] - places[i % l->sites].xi[a]) > p->near)
        (void)snprintf(why_not, room, "the particles of some cells have other places in them");
}

/* Keeps the places of sites, and how far apart they are at most along each direction, also across a face. */
static PetscErrorCode KeepSites(PetscInt dim, const Place places[], MpmProbeLattice *l)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1(l->sites * MPM_MAX_DIM, &l->xi));
  for (PetscInt j = 0; j < l->sites; j++) PetscCall(PetscArraycpy(l->xi + j * MPM_MAX_DIM, places[j].xi, MPM_MAX_DIM));
  for (PetscInt a = 0; a < dim; a++) {
    l->lo[a] = l->hi[a] = l->xi[a];
    for (PetscInt j = 0; j < l->sites; j++) {
      const PetscReal at   = l->xi[j * MPM_MAX_DIM + a];
      PetscReal       next = 1;

      for (PetscInt k = 0; k < l->sites; k++) {
        const PetscReal ahead = l->xi[k * MPM_MAX_DIM + a] - at;

        if (PetscAbsReal(ahead) > BESIDE) next = PetscMin(next, ahead > 0 ? ahead : 1 + ahead);
      }
      l->lo[a]  = PetscMin(l->lo[a], at);
      l->hi[a]  = PetscMax(l->hi[a], at);
      l->gap[a] = PetscMax(l->gap[a], next);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeLatticeFind(const MpmProbePlaces *p, MpmProbeLattice *l, size_t room, char why_not[])
{
  Place *places;

  PetscFunctionBegin;
  *l         = (MpmProbeLattice){.sites = 0};
  why_not[0] = '\0';
  PetscCall(PetscMalloc1(p->n, &places));
  if (FindCells(p, l, places)) {
    l->sites = (PetscInt)(p->n / (l->cells[0] * l->cells[1] * l->cells[2]));
    qsort(places, (size_t)p->n, sizeof *places, ByPlace);
    CheckSites(p, l, places, room, why_not);
  } else
    (void)snprintf(why_not, room, "some cells have none of the particles");
  if (!why_not[0]) {
    PetscCall(PetscMalloc3(p->n, &l->particle, p->n, &l->cell_of, p->n, &l->site_of));
    for (PetscInt64 i = 0; i < p->n; i++) {
      l->particle[i]                 = places[i].particle;
      l->cell_of[places[i].particle] = (PetscInt)(i / l->sites);
      l->site_of[places[i].particle] = (PetscInt)(i % l->sites);
    }
    PetscCall(KeepSites(p->dim, places, l));
  }
  PetscCall(PetscFree(places));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether site by site the particles of all cells have the same values. */
static PetscBool ValuesAlike(const MpmProbe *p, const MpmProbeLattice *l)
{
  const MpmStepper *s = p->stepper;

  for (PetscInt64 i = l->sites; i < s->particles; i++)
    for (PetscInt c = 0; c < s->width; c++) {
      const PetscReal *one   = s->base + l->particle[i] * s->width,
                      *first = s->base + l->particle[i % l->sites] * s->width;
      const PetscInt axis    = s->place == MPM_NONE ? -1 : c - s->fields[s->place].first;

      if ((axis < 0 || axis >= s->dim) && PetscAbsReal(one[c] - first[c]) > p->near * p->scale[c]) return PETSC_FALSE;
    }
  return PETSC_TRUE;
}

PetscErrorCode MpmProbeLatticeOf(const MpmProbe *p, MpmProbeLattice *l, size_t room, char why_not[])
{
  const MpmStepper *s      = p->stepper;
  MpmProbePlaces    places = {.dim = s->dim, .n = s->particles, .near = p->near};
  PetscReal        *at;

  PetscFunctionBegin;
  *l = (MpmProbeLattice){.sites = 0};
  if (s->place == MPM_NONE && !s->cell) {
    (void)snprintf(why_not, room, "no field is the place, and there are no cells");
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMalloc1(s->particles * s->dim, &at));
  for (PetscInt64 i = 0; i < s->particles * s->dim; i++)
    at[i] = s->place == MPM_NONE ? (PetscReal)s->cell[i] : MpmStepperPlace(s, i / s->dim)[i % s->dim] / s->cell_width;
  for (PetscInt a = 0; a < s->dim; a++) places.period[a] = s->period[a] / s->cell_width;
  places.at = at;
  PetscCall(MpmProbeLatticeFind(&places, l, room, why_not));
  if (!why_not[0] && !ValuesAlike(p, l)) (void)snprintf(why_not, room, "the particles of some cells have other values");
  PetscCall(PetscFree(at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeLatticeDestroy(MpmProbeLattice *l)
{
  PetscFunctionBegin;
  if (l->particle) PetscCall(PetscFree3(l->particle, l->cell_of, l->site_of));
  PetscCall(PetscFree(l->xi));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt Along(const MpmProbeLattice *l, PetscInt cell, PetscInt a)
{
  for (PetscInt b = 0; b < a; b++) cell /= l->cells[b];
  return cell % l->cells[a];
}

PetscInt MpmProbeLatticeMiddle(const MpmProbeLattice *l)
{
  PetscInt cell = 0;

  for (PetscInt a = MPM_MAX_DIM - 1; a >= 0; a--) cell = cell * l->cells[a] + l->cells[a] / 2;
  return cell;
}

/* ---- blocks ---- */

PetscInt MpmProbeLatticeDistance(const MpmProbeLattice *l, PetscInt cell, PetscInt from, PetscInt a)
{
  const PetscInt n = l->cells[a];
  PetscInt       d = Along(l, cell, a) - Along(l, from, a);

  if (!l->wraps[a]) return d;
  d = (d % n + n) % n;
  return d > n / 2 ? d - n : d;
}

/*
   Whether a site of a cell is so far from one of another cell that what arrives there could have come, or gone on,
   beyond the edge: it is in the last layer of particles, or nearly half a period away. Of a cell half a period away it
   is not known on which side it is.
*/
static PetscBool IsFar(const MpmStepper *s, const MpmProbeLattice *l, PetscInt cell, PetscInt site, PetscInt from,
                       PetscInt from_site)
{
  for (PetscInt a = 0; a < s->dim; a++) {
    const PetscReal xi = l->xi[site * MPM_MAX_DIM + a], apart = xi - l->xi[from_site * MPM_MAX_DIM + a];
    const PetscInt  at = Along(l, cell, a), n = l->cells[a];

    if (l->wraps[a]) {
      const PetscInt  d    = MpmProbeLatticeDistance(l, cell, from, a);
      const PetscReal away = remainder((PetscReal)d + apart, (PetscReal)n);

      if (2 * d == n || 2 * PetscAbsReal(away) + l->gap[a] > n - BESIDE) return PETSC_TRUE;
    } else if ((at == 0 && xi < l->lo[a] + BESIDE) || (at == n - 1 && xi > l->hi[a] - BESIDE))
      return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* all: the blocks of all cells, column by column. */
typedef struct {
  const MpmProbe        *probe;
  const MpmProbeLattice *lattice;
  PetscInt               cell;
  PetscReal              size, *all;
} Cell;

static PetscErrorCode Perturb(void *context, PetscInt j, MpmPerturbation *d)
{
  const Cell    *c = context;
  const PetscInt w = c->probe->stepper->width;

  PetscFunctionBegin;
  if (MpmProbeIsApart(c->probe, j % w)) PetscFunctionReturn(PETSC_SUCCESS);
  d->unknown[0]     = c->lattice->particle[c->cell * c->lattice->sites + j / w] * w + j % w;
  d->amount[d->n++] = c->size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The response to unknown j of a cell is column j of the blocks of all cells. */
static PetscErrorCode Take(void *context, PetscInt j, const MpmPerturbation *d)
{
  const Cell            *cell  = context;
  const MpmStepper      *s     = cell->probe->stepper;
  const MpmProbeLattice *l     = cell->lattice;
  const PetscInt         order = l->sites * s->width;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < s->particles; i++)
    for (PetscInt c = 0; c < s->width; c++)
      cell->all[((size_t)(l->cell_of[i] * l->sites + l->site_of[i]) * s->width + c) * order + j] =
          d->response[i * s->width + c] / d->amount[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the cells where something arrives, as blocks; all[(cell x order + row) x order + column]. */
static PetscErrorCode Keep(const MpmProbe *p, const MpmProbeLattice *l, PetscInt from, const PetscReal all[],
                           MpmBlocks *b, PetscReal *farthest)
{
  const MpmStepper *s     = p->stepper;
  const PetscInt    cells = l->cells[0] * l->cells[1] * l->cells[2], square = b->size * b->size;
  PetscReal        *peak, largest = 0, far = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(cells, &peak));
  for (PetscInt c = 0; c < cells; c++) {
    for (PetscInt e = 0; e < square; e++) {
      const PetscReal value = PetscAbsReal(all[(size_t)c * square + e]);

      if (value > far && IsFar(s, l, c, e / b->size / s->width, from, e % b->size / s->width)) far = value;
      peak[c] = PetscMax(peak[c], value);
    }
    largest = PetscMax(largest, peak[c]);
    if (peak[c] > 0) b->n++;
  }
  *farthest = largest > 0 ? far / largest : 0;
  PetscCall(MpmBlocksAllocate(b));
  for (PetscInt c = 0, k = 0; c < cells; c++) {
    if (!(peak[c] > 0)) continue;
    for (PetscInt a = 0; a < s->dim; a++) b->d[k * s->dim + a] = MpmProbeLatticeDistance(l, c, from, a);
    PetscCall(PetscArraycpy(b->A + (size_t)k++ * square, all + (size_t)c * square, square));
  }
  PetscCall(PetscFree(peak));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeBlocks(MpmProbe *p, const MpmProbeLattice *l, PetscInt cell, PetscReal size, MpmBlocks *b,
                              PetscReal *farthest)
{
  const MpmStepper *s     = p->stepper;
  const PetscInt    cells = l->cells[0] * l->cells[1] * l->cells[2], order = l->sites * s->width;
  Cell              c = {.probe = p, .lattice = l, .cell = cell, .size = size};

  PetscFunctionBegin;
  *b = (MpmBlocks){.dim = s->dim, .size = order, .period = p->steps, .cell_width = s->cell_width};
  PetscCall(PetscCalloc1((size_t)cells * order * order, &c.all));
  PetscCall(MpmProbeEach(p, order, 1, Perturb, Take, &c));
  for (PetscInt i = 0; i < cells; i++)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, c.all + (size_t)i * order * order, order * order, MPIU_REAL, MPI_SUM,
                               PETSC_COMM_WORLD));
  PetscCall(Keep(p, l, cell, c.all, b, farthest));
  PetscCall(PetscFree(c.all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what blocks give ---- */

/* The cell from which block k reaches a cell, or MPM_NONE beyond an edge. */
static PetscInt From(const MpmProbeLattice *l, PetscInt dim, const PetscInt d[], PetscInt cell)
{
  PetscInt from = 0;

  for (PetscInt a = MPM_MAX_DIM - 1; a >= 0; a--) {
    const PetscInt n  = l->cells[a];
    PetscInt       at = Along(l, cell, a) - (a < dim ? d[a] : 0);

    if (l->wraps[a]) at = (at % n + n) % n;
    if (at < 0 || at >= n) return MPM_NONE;
    from = from * n + at;
  }
  return from;
}

void MpmProbeLatticeAt(const void *of, PetscInt64 particle, PetscInt64 cell[], PetscInt *site)
{
  const MpmProbeLattice *l = of;

  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) cell[a] = Along(l, l->cell_of[particle], a);
  *site = l->site_of[particle];
}

PetscErrorCode MpmProbeBlocksMatrix(const MpmProbe *p, const MpmProbeLattice *l, const MpmBlocks *b, Mat *A)
{
  const PetscInt w = b->size / l->sites;
  PetscInt       first, last, *columns;

  PetscFunctionBegin;
  PetscCall(MpmProbeNewMatrix(p->stepper, w, b->n * b->size, A));
  PetscCall(MatGetOwnershipRange(*A, &first, &last));
  PetscCall(PetscMalloc1(w, &columns));
  for (PetscInt i = first / w; i < last / w; i++) {
    for (PetscInt k = 0; k < b->n; k++) {
      const PetscInt from = From(l, b->dim, &b->d[k * b->dim], l->cell_of[i]);

      for (PetscInt j = 0; j < l->sites; j++)
        for (PetscInt r = 0; r < w; r++) {
          const PetscReal *values = b->A + ((size_t)k * b->size + l->site_of[i] * w + r) * b->size + j * w;
          const PetscInt   row    = i * w + r;

          for (PetscInt c = 0; c < w; c++) columns[c] = (PetscInt)l->particle[from * l->sites + j] * w + c;
          PetscCall(MatSetValues(*A, 1, &row, w, columns, values, INSERT_VALUES));
        }
    }
  }
  PetscCall(PetscFree(columns));
  PetscCall(MpmProbeFillDiagonal(*A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether blocks reach a cell, and it reaches others, without going beyond an edge. */
static PetscBool IsInside(const MpmProbeLattice *l, const MpmBlocks *b, PetscInt cell)
{
  for (PetscInt k = 0; k < b->n; k++) {
    const PetscInt *d = &b->d[k * b->dim];
    PetscInt        back[MPM_MAX_DIM];

    for (PetscInt a = 0; a < b->dim; a++) back[a] = -d[a];
    if (From(l, b->dim, d, cell) == MPM_NONE || From(l, b->dim, back, cell) == MPM_NONE) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

void MpmProbeBlocksCompare(const MpmProbe *p, const MpmProbeLattice *l, const MpmBlocks *b, const PetscReal amount[],
                           const PetscReal response[], const PetscBool apart[], PetscReal *differ, PetscInt *compared)
{
  const PetscInt w = p->stepper->width, all = l->cells[0] * l->cells[1] * l->cells[2], order = b->size;
  PetscReal      largest = 0;

  *differ   = 0;
  *compared = 0;
  for (PetscInt cell = 0; cell < all; cell++) {
    if (!IsInside(l, b, cell)) continue;
    (*compared)++;
    for (PetscInt row = 0; row < order; row++) {
      const PetscReal felt = response[l->particle[cell * l->sites + row / w] * w + row % w];
      PetscReal       sum  = 0;

      if (apart[row % w]) continue;
      for (PetscInt k = 0; k < b->n; k++) {
        const PetscInt from = From(l, b->dim, &b->d[k * b->dim], cell);

        for (PetscInt j = 0; j < order; j++)
          sum += b->A[((size_t)k * order + row) * order + j] * amount[l->particle[from * l->sites + j / w] * w + j % w];
      }
      *differ = PetscMax(*differ, PetscAbsReal(felt - sum));
      largest = PetscMax(largest, PetscAbsReal(felt));
    }
  }
  if (largest > 0) *differ /= largest;
}
