/* Bloch probing: cells that are alike, and the blocks of one of them. */
#include "probe/lattice.h"
#include "base/hash.h"
#include "base/progress.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

#define PHASES 12   /* at which two operators are compared */
#define BESIDE 1e-4 /* sites of a cell are farther apart, in cell widths */

/* ---- the lattice ---- */

/* The cell of a particle along a direction, and its place in it. A place just below a face is on it. */
static PetscInt CellAlong(const MpmProbe *p, PetscInt64 i, PetscInt a, PetscReal *xi)
{
  const MpmStepper *s = p->stepper;
  PetscReal         at;

  *xi = 0;
  if (s->place == MPM_NONE) return s->cell[i * s->dim + a];
  at  = s->base[i * s->width + s->fields[s->place].first + a] / s->cell_width;
  *xi = at - floor(at + p->near);
  return (PetscInt)floor(at + p->near);
}

typedef struct {
  PetscInt   cell;
  PetscReal  xi[MPM_MAX_DIM];
  PetscInt64 particle;
} Place;

static int ByPlace(const void *one, const void *other)
{
  const Place *p = one, *q = other;

  if (p->cell != q->cell) return p->cell < q->cell ? -1 : 1;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++)
    if (PetscAbsReal(p->xi[a] - q->xi[a]) > BESIDE) return p->xi[a] < q->xi[a] ? -1 : 1;
  return p->particle < q->particle ? -1 : p->particle > q->particle;
}

/* The box of cells that has all particles. */
static PetscErrorCode Box(const MpmProbe *p, MpmProbeLattice *l)
{
  const MpmStepper *s = p->stepper;
  PetscReal         xi;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) l->cells[a] = 1;
  for (PetscInt a = 0; a < s->dim; a++) {
    PetscInt last = l->first[a] = CellAlong(p, 0, a, &xi);

    for (PetscInt64 i = 0; i < s->particles; i++) {
      const PetscInt cell = CellAlong(p, i, a, &xi);

      l->first[a] = PetscMin(l->first[a], cell);
      last        = PetscMax(last, cell);
    }
    l->cells[a] = last - l->first[a] + 1;
    l->wraps[a] =
        PetscAbsReal(s->period[a] / s->cell_width - l->cells[a]) < p->near * l->cells[a] ? PETSC_TRUE : PETSC_FALSE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether site by site the particles of two cells are alike. */
static PetscBool CellsAlike(const MpmProbe *p, const Place one[], const Place other[], PetscInt sites)
{
  const MpmStepper *s = p->stepper;

  for (PetscInt j = 0; j < sites; j++) {
    for (PetscInt a = 0; a < s->dim; a++)
      if (PetscAbsReal(one[j].xi[a] - other[j].xi[a]) > p->near) return PETSC_FALSE;
    for (PetscInt c = 0; c < s->width; c++) {
      const PetscReal difference = s->base[one[j].particle * s->width + c] - s->base[other[j].particle * s->width + c];
      const PetscInt  axis       = s->place == MPM_NONE ? -1 : c - s->fields[s->place].first;

      if ((axis < 0 || axis >= s->dim) && PetscAbsReal(difference) > p->near * p->scale[c]) return PETSC_FALSE;
    }
  }
  return PETSC_TRUE;
}

static PetscErrorCode Sort(const MpmProbe *p, MpmProbeLattice *l, Place places[], size_t room, char why_not[])
{
  const MpmStepper *s   = p->stepper;
  const PetscInt    all = l->cells[0] * l->cells[1] * l->cells[2];

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < s->particles; i++) {
    PetscInt cell = 0;

    places[i] = (Place){.particle = i};
    for (PetscInt a = s->dim - 1; a >= 0; a--)
      cell = cell * l->cells[a] + CellAlong(p, i, a, &places[i].xi[a]) - l->first[a];
    places[i].cell = cell;
  }
  qsort(places, (size_t)s->particles, sizeof *places, ByPlace);
  l->sites = (PetscInt)(s->particles / all);
  if (s->particles % all) PetscCall(PetscSNPrintf(why_not, room, "cells have different numbers of particles"));
  for (PetscInt64 i = 0; i < s->particles && !why_not[0]; i++)
    if (places[i].cell != i / l->sites)
      PetscCall(PetscSNPrintf(why_not, room, "cells have different numbers of particles"));
  for (PetscInt c = 1; c < all && !why_not[0]; c++)
    if (!CellsAlike(p, places, places + c * l->sites, l->sites))
      PetscCall(PetscSNPrintf(why_not, room, "the particles of some cells have other places or values"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the places of sites, and how far apart they are at most along each direction, also across a face. */
static PetscErrorCode KeepSites(const MpmStepper *s, const Place places[], MpmProbeLattice *l)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1(l->sites * MPM_MAX_DIM, &l->xi));
  for (PetscInt j = 0; j < l->sites; j++) PetscCall(PetscArraycpy(l->xi + j * MPM_MAX_DIM, places[j].xi, MPM_MAX_DIM));
  for (PetscInt a = 0; a < s->dim; a++) {
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

PetscErrorCode MpmProbeLatticeFind(const MpmProbe *p, MpmProbeLattice *l, size_t room, char why_not[])
{
  const MpmStepper *s = p->stepper;
  Place            *places;

  PetscFunctionBegin;
  *l         = (MpmProbeLattice){.sites = 0};
  why_not[0] = '\0';
  if (s->place == MPM_NONE && !s->cell) {
    PetscCall(PetscSNPrintf(why_not, room, "no field is the place, and there are no cells"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Box(p, l));
  PetscCall(PetscMalloc1(s->particles, &places));
  PetscCall(Sort(p, l, places, room, why_not));
  if (!why_not[0]) {
    PetscCall(PetscMalloc3(s->particles, &l->particle, s->particles, &l->cell_of, s->particles, &l->site_of));
    for (PetscInt64 i = 0; i < s->particles; i++) {
      l->particle[i]                 = places[i].particle;
      l->cell_of[places[i].particle] = (PetscInt)(i / l->sites);
      l->site_of[places[i].particle] = (PetscInt)(i % l->sites);
    }
    PetscCall(KeepSites(s, places, l));
  }
  PetscCall(PetscFree(places));
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

PetscInt MpmProbeLatticeMiddle(const MpmProbe *p, const MpmProbeLattice *l)
{
  PetscInt cell = 0;

  for (PetscInt a = p->stepper->dim - 1; a >= 0; a--) cell = cell * l->cells[a] + l->cells[a] / 2;
  return cell;
}

/* ---- blocks ---- */

/* The distance of a cell from another one, the shorter way round where there is a period. */
static PetscInt Distance(const MpmProbeLattice *l, PetscInt cell, PetscInt from, PetscInt a)
{
  const PetscInt n = l->cells[a];
  PetscInt       d = Along(l, cell, a) - Along(l, from, a);

  if (!l->wraps[a]) return d;
  d = (d % n + n) % n;
  return d > n / 2 ? d - n : d;
}

/*
   Whether a site of a cell is so far from one of another cell that what arrives there could have come, or gone on, beyond
   the edge: it is in the last layer of particles, or nearly half a period away. Of a cell half a period away it is not known
   on which side it is.
*/
static PetscBool IsFar(const MpmStepper *s, const MpmProbeLattice *l, PetscInt cell, PetscInt site, PetscInt from,
                       PetscInt from_site)
{
  for (PetscInt a = 0; a < s->dim; a++) {
    const PetscReal xi = l->xi[site * MPM_MAX_DIM + a], apart = xi - l->xi[from_site * MPM_MAX_DIM + a];
    const PetscInt  at = Along(l, cell, a), n = l->cells[a];

    if (l->wraps[a]) {
      const PetscInt  d    = Distance(l, cell, from, a);
      const PetscReal away = remainder((PetscReal)d + apart, (PetscReal)n);

      if (2 * d == n || 2 * PetscAbsReal(away) + l->gap[a] > n - BESIDE) return PETSC_TRUE;
    } else if ((at == 0 && xi < l->lo[a] + BESIDE) || (at == n - 1 && xi > l->hi[a] - BESIDE))
      return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* The response to unknown j of a cell, as column j of the blocks of all cells. */
static PetscErrorCode Column(MpmProbe *p, const MpmProbeLattice *l, PetscInt cell, PetscInt j, PetscReal size,
                             PetscReal response[], PetscReal all[])
{
  const MpmStepper *s       = p->stepper;
  const PetscInt64  unknown = l->particle[cell * l->sites + j / s->width] * s->width + j % s->width;
  const PetscInt    order   = l->sites * s->width;
  PetscReal         amount  = size;

  PetscFunctionBegin;
  PetscCall(MpmProbeRespond(p, PETSC_FALSE, 1, &unknown, &amount, response));
  for (PetscInt64 i = 0; i < s->particles; i++)
    for (PetscInt c = 0; c < s->width; c++)
      all[((size_t)(l->cell_of[i] * l->sites + l->site_of[i]) * s->width + c) * order + j] =
          response[i * s->width + c] / amount;
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
    for (PetscInt a = 0; a < s->dim; a++) b->d[k * s->dim + a] = Distance(l, c, from, a);
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
  PetscReal        *response, *all;
  PetscMPIInt       rank, ranks;
  MpmProgress       progress;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  *b = (MpmBlocks){.dim = s->dim, .size = order, .period = p->steps, .cell_width = s->cell_width};
  PetscCall(PetscMalloc1(s->particles * s->width, &response));
  PetscCall(PetscCalloc1((size_t)cells * order * order, &all));
  PetscCall(MpmProgressBegin("unknowns probed", &progress));
  for (PetscInt j = rank; j < order; j += ranks) {
    PetscCall(Column(p, l, cell, j, size, response, all));
    PetscCall(MpmProgressUpdate(&progress, j + 1, order));
  }
  PetscCall(MpmProgressEnd(&progress));
  PetscCall(MpmStepperAgree(p->stepper));
  for (PetscInt c = 0; c < cells; c++)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all + (size_t)c * order * order, order * order, MPIU_REAL, MPI_SUM,
                               PETSC_COMM_WORLD));
  PetscCall(Keep(p, l, cell, all, b, farthest));
  PetscCall(PetscFree(all));
  PetscCall(PetscFree(response));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what blocks give ---- */

/* Adds weight e^(-i beta.d) A_d of all blocks to a matrix, real and imaginary parts one after another. */
static void AddAt(const MpmBlocks *b, PetscReal weight, const PetscReal beta[], PetscReal sum[])
{
  const PetscInt square = b->size * b->size;

  for (PetscInt k = 0; k < b->n; k++) {
    const PetscReal *A     = b->A + (size_t)k * square;
    PetscReal        angle = 0, re, im;

    for (PetscInt a = 0; a < b->dim; a++) angle += beta[a] * b->d[k * b->dim + a];
    re = weight * cos(angle);
    im = -weight * sin(angle);
    for (PetscInt e = 0; e < square; e++) {
      sum[e] += re * A[e];
      sum[square + e] += im * A[e];
    }
  }
}

PetscErrorCode MpmProbeBlocksDistance(const MpmBlocks *one, const MpmBlocks *other, PetscReal *distance)
{
  const PetscInt numbers = 2 * one->size * one->size;
  PetscReal     *differ, largest = 0;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(numbers, &differ));
  for (PetscInt i = 0; i < PHASES; i++) {
    PetscReal beta[MPM_MAX_DIM], sum = 0;

    for (PetscInt a = 0; a < MPM_MAX_DIM; a++) beta[a] = 2 * PETSC_PI * MpmHash(3, i * MPM_MAX_DIM + a);
    PetscCall(PetscArrayzero(differ, numbers));
    AddAt(one, 1, beta, differ);
    AddAt(other, -1, beta, differ);
    for (PetscInt e = 0; e < numbers; e++) sum += PetscSqr(differ[e]);
    largest = PetscMax(largest, sum);
  }
  *distance = sqrt(largest);
  PetscCall(PetscFree(differ));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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

PetscErrorCode MpmProbeBlocksCompare(const MpmProbe *p, const MpmProbeLattice *l, const MpmBlocks *b,
                                     const PetscReal amount[], const PetscReal response[], const PetscBool apart[],
                                     PetscReal *differ, PetscInt *compared)
{
  const PetscInt w = p->stepper->width, all = l->cells[0] * l->cells[1] * l->cells[2], order = b->size;
  PetscReal      largest = 0;

  PetscFunctionBegin;
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
  PetscFunctionReturn(PETSC_SUCCESS);
}
