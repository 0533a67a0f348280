/*
   Blocks of a matrix whose particles have known places. Particle i is in cell c(i), at site j(i) of it. The block A_d has the
   entries from the particles of the middle cell m to those of the cell m + d:

     A_d[j(i), j(k)] = A[i, k]   with c(k) = m, c(i) = m + d

   Cells are alike when every cell c has the same entries from c to c + d.
*/
#include "io/blocks_of_matrix.h"
#include "probe/lattice.h"
#include "scene/request.h"
#include <math.h>
#include <string.h>

#define NEAR 1e-4        /* of a cell width: places that are alike */
#define FELT 1e-9        /* an entry above this is none of rounding, over the largest */
#define FELT_SINGLE 1e-4 /* of a matrix in single precision */
#define ALIKE 1e-6       /* entries of cells that are alike differ by less, over the largest */
#define ALIKE_SINGLE 0.01

/*S
   Felt - the cells of a matrix. width: the numbers of a particle; reach: how far the middle cell is felt in each direction, in
   cells.
S*/
typedef struct {
  const MpmHooked *said;
  MpmProbeLattice  cells;
  PetscInt         width, middle, reach[MPM_MAX_DIM];
} Felt;

static void CheckSaid(const MpmEntries *e, char why[MPM_WHY_TEXT])
{
  const MpmHooked *h = &e->hooked;

  if (!h->places || h->dim < 1 || !(h->cell_width > 0))
    (void)snprintf(why, MPM_WHY_TEXT, "%s",
                   "it does not say where its particles are; allowed: a matrix that the hook has written, with "
                   "a place, or blocks in HDF5 or .npz");
  else if (!(h->numbers >= 1) || h->numbers * (PetscReal)h->places != (PetscReal)e->rows)
    (void)snprintf(why, MPM_WHY_TEXT,
                   "%" PetscInt64_FMT " particles with %.6g numbers, and order %" PetscInt64_FMT
                   "; allowed: as many unknowns as its particles have numbers",
                   h->places, h->numbers, e->rows);
  else if (h->place_dim != h->dim || (h->scales && (PetscReal)h->scales != h->numbers) ||
           h->scales > MPM_HOOKED_NUMBERS)
    (void)snprintf(why, MPM_WHY_TEXT,
                   "places of %" PetscInt_FMT " numbers, a period of %" PetscInt_FMT " and %" PetscInt64_FMT
                   " scales of %.6g numbers; allowed: as many of each as belong together",
                   h->place_dim, h->dim, h->scales, h->numbers);
  else if (e->steps > MPM_MATRIX_MOST_STEPS)
    (void)snprintf(why, MPM_WHY_TEXT, "it says that it covers %" PetscInt64_FMT " steps; allowed: from 1 to %d",
                   e->steps, MPM_MATRIX_MOST_STEPS);
}

/* Without a period cells begin at the first particle. */
static PetscErrorCode FindCells(Felt *l, char why[MPM_WHY_TEXT])
{
  const MpmHooked *h      = l->said;
  MpmProbePlaces   places = {.dim = h->dim, .n = h->places, .near = NEAR};
  PetscReal       *at;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(h->places * h->dim, &at));
  for (PetscInt a = 0; a < h->dim; a++) {
    PetscReal low = h->period[a] > 0 ? 0 : INFINITY;

    for (PetscInt64 i = 0; i < h->places && !(h->period[a] > 0); i++) low = PetscMin(low, h->x[MPM_MAX_DIM * i + a]);
    for (PetscInt64 i = 0; i < h->places; i++) at[i * h->dim + a] = (h->x[MPM_MAX_DIM * i + a] - low) / h->cell_width;
    places.period[a] = h->period[a] / h->cell_width;
  }
  places.at = at;
  PetscCall(MpmProbeLatticeFind(&places, &l->cells, MPM_WHY_TEXT, why));
  for (PetscInt a = 0; a < h->dim; a++)
    if (h->period[a] > 0 && !l->cells.wraps[a])
      (void)snprintf(why, MPM_WHY_TEXT, "%s", "some cells have none of the particles");
  PetscCall(PetscFree(at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Distance(const Felt *l, PetscInt to, PetscInt from, PetscInt d[])
{
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) d[a] = MpmProbeLatticeDistance(&l->cells, to, from, a);
}

/* Whether what a cell gives, and what it gets, stays away from edges by the reach of a step. */
static PetscBool IsInside(const Felt *l, PetscInt cell)
{
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) {
    const PetscInt at = cell % l->cells.cells[a];

    if (a < l->said->dim && !(l->said->period[a] > 0) &&
        (at <= l->reach[a] || at >= l->cells.cells[a] - 1 - l->reach[a]))
      return PETSC_FALSE;
    cell /= l->cells.cells[a];
  }
  return PETSC_TRUE;
}

/* Finds the reach of the middle cell. Returns whether what is felt has not come from, or gone on, beyond an edge. */
static PetscBool FindReach(Felt *l, const MpmEntries *e, PetscReal *largest)
{
  *largest = 0;
  for (PetscInt64 k = 0; k < e->n; k++) *largest = PetscMax(*largest, fabs(e->value[k]));
  for (PetscInt64 k = 0; k < e->n; k++) {
    const PetscInt to = l->cells.cell_of[e->row[k] / l->width], from = l->cells.cell_of[e->column[k] / l->width];
    PetscInt       d[MPM_MAX_DIM];

    Distance(l, to, from, d);
    for (PetscInt a = 0; a < MPM_MAX_DIM; a++)
      if (from == l->middle && fabs(e->value[k]) > (l->said->single > 0 ? FELT_SINGLE : FELT) * *largest)
        l->reach[a] = PetscMax(l->reach[a], PetscAbsInt(d[a]));
  }
  for (PetscInt a = 0; a < l->said->dim; a++) {
    const PetscInt n = l->cells.cells[a], reach = l->reach[a];

    if (l->said->period[a] > 0 ? 2 * reach >= n - 1 && n > 1 : 2 * reach >= n - 2) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

static PetscBool IsBeyond(const Felt *l, const PetscInt d[])
{
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++)
    if (PetscAbsInt(d[a]) > l->reach[a]) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* The place of an entry in the blocks: which = number of the block round the middle, times order squared, and so on. */
static size_t PlaceOf(const Felt *l, const MpmEntries *e, PetscInt64 k, const PetscInt d[])
{
  const PetscInt order = l->cells.sites * l->width, i = e->row[k] / l->width, j = e->column[k] / l->width;
  size_t         block = 0;

  for (PetscInt a = MPM_MAX_DIM - 1; a >= 0; a--)
    block = block * (size_t)(2 * l->reach[a] + 1) + (size_t)(d[a] + l->reach[a]);
  return (block * (size_t)order + (size_t)(l->cells.site_of[i] * l->width + e->row[k] % l->width)) * (size_t)order +
         (size_t)(l->cells.site_of[j] * l->width + e->column[k] % l->width);
}

/* The largest difference between the columns of a cell that is inside and those of the middle one. */
static PetscReal Differ(const Felt *l, const MpmEntries *e, const PetscReal A[], size_t n)
{
  const PetscInt all = l->cells.cells[0] * l->cells.cells[1] * l->cells.cells[2];
  PetscReal     *sum, *square, whole = 0, differ = 0;

  if (PetscCalloc2(all, &sum, all, &square)) return INFINITY;
  for (size_t i = 0; i < n; i++) whole += PetscSqr(A[i]);
  for (PetscInt64 k = 0; k < e->n; k++) {
    const PetscInt from = l->cells.cell_of[e->column[k] / l->width];
    PetscInt       d[MPM_MAX_DIM];
    PetscReal      of;

    if (!IsInside(l, from)) continue;
    Distance(l, l->cells.cell_of[e->row[k] / l->width], from, d);
    of = IsBeyond(l, d) ? 0 : A[PlaceOf(l, e, k, d)];
    sum[from] += PetscSqr(e->value[k] - of);
    square[from] += PetscSqr(of);
  }
  for (PetscInt c = 0; c < all; c++)
    if (IsInside(l, c)) differ = PetscMax(differ, sqrt(sum[c] + PetscMax(0, whole - square[c])));
  (void)PetscFree2(sum, square);
  return differ;
}

static PetscErrorCode Take(Felt *l, const MpmEntries *e, MpmBlocks *b, char why[MPM_WHY_TEXT])
{
  const PetscInt  order = l->cells.sites * l->width;
  const PetscReal alike = l->said->single > 0 ? ALIKE_SINGLE : ALIKE;
  PetscReal       largest, differ;
  size_t          n = (size_t)order * (size_t)order;

  PetscFunctionBegin;
  if (!FindReach(l, e, &largest))
    (void)snprintf(why, MPM_WHY_TEXT, "%s", "a step reaches so far that the grid has no cell away from its edges");
  *b = (MpmBlocks){
      .dim = l->said->dim, .size = order, .n = 1, .period = (PetscInt)e->steps, .cell_width = l->said->cell_width};
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) b->n *= 2 * l->reach[a] + 1;
  n *= (size_t)b->n;
  if (!why[0] && (order > MPM_BLOCKS_SIZE || (PetscReal)n > MPM_BLOCKS_NUMBERS))
    (void)snprintf(why, MPM_WHY_TEXT, "blocks of order %" PetscInt_FMT "; allowed: up to %d", order, MPM_BLOCKS_SIZE);
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmBlocksAllocate(b));
  PetscCall(PetscArrayzero(b->A, n));
  for (PetscInt k = 0; k < b->n; k++)
    for (PetscInt a = 0, rest = k; a < MPM_MAX_DIM; rest /= 2 * l->reach[a++] + 1)
      if (a < b->dim) b->d[k * b->dim + a] = rest % (2 * l->reach[a] + 1) - l->reach[a];
  for (PetscInt64 k = 0; k < e->n; k++) {
    PetscInt d[MPM_MAX_DIM];

    if (l->cells.cell_of[e->column[k] / l->width] != l->middle) continue;
    Distance(l, l->cells.cell_of[e->row[k] / l->width], l->middle, d);
    if (!IsBeyond(l, d)) b->A[PlaceOf(l, e, k, d)] += e->value[k];
  }
  differ = Differ(l, e, b->A, n);
  if (!(differ <= alike * largest)) {
    (void)snprintf(why, MPM_WHY_TEXT, "its cells differ by %.2g of their largest entry; allowed: up to %.2g",
                   differ / largest, alike);
    PetscCall(MpmBlocksFree(b));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlocksOfMatrix(MpmEntries *e, MpmBlocks *b, char why[MPM_WHY_TEXT])
{
  Felt l = {.said = &e->hooked, .width = (PetscInt)e->hooked.numbers};

  PetscFunctionBegin;
  CheckSaid(e, why);
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FindCells(&l, why));
  MpmEntriesToScales(e);
  l.middle = MpmProbeLatticeMiddle(&l.cells);
  if (!why[0]) PetscCall(Take(&l, e, b, why));
  PetscCall(MpmProbeLatticeDestroy(&l.cells));
  PetscFunctionReturn(PETSC_SUCCESS);
}
