/* Reads and writes the blocks of a lattice as named arrays, and takes them out of the matrix of a whole grid. */
#include "base/textfile.h"
#include "io/arrays.h"
#include "io/datafile.h"
#include "io/matrix_file.h"
#include "probe/lattice.h"
#include "scene/request.h"
#include <mpmstab/errors.h>
#include <errno.h>
#include <math.h>
#include <string.h>

/*
   Blocks of a matrix whose particles have known places. Particle i is in cell c(i), at site j(i) of it. The block A_d
   has the entries from the particles of the middle cell m to those of the cell m + d:

     A_d[j(i), j(k)] = A[i, k]   with c(k) = m, c(i) = m + d

   Cells are alike when every cell c has the same entries from c to c + d.
*/

#define NEAR 1e-4        /* of a cell width: places that are alike */
#define FELT 1e-9        /* an entry above this is none of rounding, over the largest */
#define FELT_SINGLE 1e-4 /* of a matrix in single precision */
#define ALIKE 1e-6       /* entries of cells that are alike differ by less, over the largest */
#define ALIKE_SINGLE 0.01

/*S
   Felt - the cells of a matrix. width: the numbers of a particle; reach: how far the middle cell is felt in each
   direction, in cells.
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
    MpmWhy(why, "it does not say where its particles are; allowed: a matrix that the hook has written, with "
                "a place, or blocks in HDF5 or .npz");
  else if (!(h->numbers >= 1) || h->numbers * (PetscReal)h->places != (PetscReal)e->rows)
    MpmWhy(why,
           "%" PetscInt64_FMT " particles with %.6g numbers, and order %" PetscInt64_FMT
           "; allowed: as many unknowns as its particles have numbers",
           h->places, h->numbers, e->rows);
  else if (h->place_dim != h->dim || (h->scales && (PetscReal)h->scales != h->numbers) ||
           h->scales > MPM_HOOKED_NUMBERS)
    MpmWhy(why,
           "places of %" PetscInt_FMT " numbers, a period of %" PetscInt_FMT " and %" PetscInt64_FMT
           " scales of %.6g numbers; allowed: as many of each as belong together",
           h->place_dim, h->dim, h->scales, h->numbers);
  else if (e->steps > MPM_MATRIX_MOST_STEPS)
    MpmWhy(why, "it says that it covers %" PetscInt64_FMT " steps; allowed: from 1 to %d", e->steps,
           MPM_MATRIX_MOST_STEPS);
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
    if (h->period[a] > 0 && !l->cells.wraps[a]) MpmWhy(why, "some cells have none of the particles");
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
  if (!FindReach(l, e, &largest)) MpmWhy(why, "a step reaches so far that the grid has no cell away from its edges");
  *b = (MpmBlocks){
      .dim = l->said->dim, .size = order, .n = 1, .period = (PetscInt)e->steps, .cell_width = l->said->cell_width};
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) b->n *= 2 * l->reach[a] + 1;
  n *= (size_t)b->n;
  if (!why[0] && (order > MPM_BLOCKS_SIZE || (PetscReal)n > MPM_BLOCKS_NUMBERS))
    MpmWhy(why, "blocks of order %" PetscInt_FMT "; allowed: up to %d", order, MPM_BLOCKS_SIZE);
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
    MpmWhy(why, "its cells differ by %.2g of their largest entry; allowed: up to %.2g", differ / largest, alike);
    PetscCall(MpmBlocksFree(b));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OfMatrix(MpmEntries *e, MpmBlocks *b, char why[MPM_WHY_TEXT])
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

/* ---- files ---- */

#define FARTHEST 1e6 /* cells that a block may reach */

static void CheckShapes(const MpmArray *d, const MpmArray *A, char why[MPM_WHY_TEXT])
{
  if (!d || !A || A->dims != 3 || d->dims < 1 || d->dims > 2 || d->shape[0] != A->shape[0])
    MpmWhy(why, "it has no blocks; allowed: arrays d (blocks x directions) and A (blocks x N x N)");
  else if (A->shape[1] != A->shape[2] || A->n == 0)
    MpmWhy(why,
           "its blocks are %" PetscInt64_FMT " of %" PetscInt64_FMT " x %" PetscInt64_FMT
           "; allowed: at least one, and square",
           A->shape[0], A->shape[1], A->shape[2]);
  else if (A->shape[1] > MPM_BLOCKS_SIZE || A->n > MPM_BLOCKS_NUMBERS)
    MpmWhy(why,
           "blocks of order %" PetscInt64_FMT ", %.3g numbers; allowed: up to order %d, and up to %.2g "
           "numbers",
           A->shape[1], (PetscReal)A->n, MPM_BLOCKS_SIZE, MPM_BLOCKS_NUMBERS);
  else if (d->dims == 2 && (d->shape[1] < 1 || d->shape[1] > MPM_MAX_DIM))
    MpmWhy(why, "%" PetscInt64_FMT " directions; allowed: 1 to %d", d->shape[1], MPM_MAX_DIM);
  else if (!MpmArrayIsWhole(d, -FARTHEST))
    MpmWhy(why, "array d; allowed: whole numbers of cells from -%g to %g", FARTHEST, FARTHEST);
  for (PetscInt64 i = 0; !why[0] && i < d->n; i++)
    if (d->real[i] > FARTHEST)
      MpmWhy(why, "array d; allowed: whole numbers of cells from -%g to %g", FARTHEST, FARTHEST);
  for (PetscInt64 i = 0; !why[0] && i < A->n; i++)
    if (!isfinite(A->real[i]))
      MpmWhy(why, "array A: number %" PetscInt64_FMT " is %s; allowed: finite numbers", i + 1,
             isnan(A->real[i]) ? "nan" : "infinite");
}

/* Takes blocks out of arrays. steps: 0 where the file does not say. */
static PetscErrorCode FromArrays(const MpmArrays *arrays, MpmBlocks *b, char why[MPM_WHY_TEXT])
{
  const MpmArray *d = MpmArraysFind(arrays, "d"), *A = MpmArraysFind(arrays, "A"),
                 *steps = MpmArraysFind(arrays, "steps"), *width = MpmArraysFind(arrays, "cell_width");

  PetscFunctionBegin;
  CheckShapes(d, A, why);
  if (!why[0] && steps && (steps->n != 1 || !MpmArrayIsWhole(steps, 1) || steps->real[0] > MPM_MATRIX_MOST_STEPS))
    MpmWhy(why, "steps; allowed: one whole number from 1 to %d", MPM_MATRIX_MOST_STEPS);
  if (!why[0] && width && (width->n != 1 || !(width->real[0] > 0) || isinf(width->real[0])))
    MpmWhy(why, "cell_width; allowed: one number greater than 0");
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  *b = (MpmBlocks){.dim        = d->dims == 1 ? 1 : (PetscInt)d->shape[1],
                   .size       = (PetscInt)A->shape[1],
                   .n          = (PetscInt)A->shape[0],
                   .period     = steps ? (PetscInt)steps->real[0] : 0,
                   .cell_width = width ? width->real[0] : 0};
  PetscCall(MpmBlocksAllocate(b));
  for (PetscInt64 i = 0; i < d->n; i++) b->d[i] = (PetscInt)d->real[i];
  PetscCall(PetscArraycpy(b->A, A->real, (size_t)A->n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Blocks of a matrix that the hook has written. */
static PetscErrorCode FromMatrix(FILE *stream, MpmHooked *hooked, MpmBlocks *b, char why[MPM_WHY_TEXT])
{
  MpmEntries entries = {.n = 0};

  PetscFunctionBegin;
  rewind(stream);
  MpmHookedBegin(&entries.hooked);
  PetscCall(MpmMatrixReadText(stream, &entries, why));
  if (!why[0]) MpmEntriesCheck(&entries, why);
  if (!why[0]) PetscCall(OfMatrix(&entries, b, why));
  *hooked   = entries.hooked;
  hooked->x = NULL;
  PetscCall(MpmEntriesFree(&entries));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the file on the first rank. */
static PetscErrorCode ReadFile(const char path[], MpmHooked *hooked, MpmBlocks *b, char why[MPM_WHY_TEXT])
{
  static const char *const names[] = {"A", "d", "steps", "cell_width", NULL};
  int                      error;
  FILE                    *stream   = MpmFileOpen(path, &error);
  char                     begin[2] = "";
  PetscBool                hdf5     = PETSC_FALSE;
  MpmArrays                arrays   = {.n = 0};

  PetscFunctionBegin;
  if (stream) PetscCall(MpmHdf5Is(path, &hdf5));
  if (!stream || fread(begin, 1, sizeof begin, stream) != sizeof begin)
    MpmWhy(why, "%s; allowed: a file that can be read",
           !stream          ? MpmFileReason(error)
           : ferror(stream) ? strerror(errno)
                            : "it is empty");
  else if (hdf5 || !memcmp(begin, "PK", sizeof begin))
    PetscCall(MpmArraysRead(path, names, &arrays, why));
  else if (!memcmp(begin, "%%", sizeof begin))
    PetscCall(FromMatrix(stream, hooked, b, why));
  else
    MpmWhy(why, "its format is not known; allowed: HDF5, .npz of numpy.savez, or a matrix that the hook has written");
  if (!why[0] && !b->n) PetscCall(FromArrays(&arrays, b, why));
  PetscCall(MpmArraysFree(&arrays));
  if (stream) (void)fclose(stream);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlocksRead(MPI_Comm comm, const char path[], PetscInt steps, PetscReal tolerance, MpmCertificates *c,
                             MpmBlocks *b)
{
  char              why[MPM_WHY_TEXT] = "";
  PetscInt          sizes[4];
  MpmHooked         hooked;
  const PetscMPIInt rank = MpmRankOf(comm);

  PetscFunctionBegin;
  *b = (MpmBlocks){.n = 0};
  MpmHookedBegin(&hooked);
  if (rank == 0) PetscCall(ReadFile(path, &hooked, b, why));
  PetscCallMPI(MPI_Bcast(why, MPM_WHY_TEXT, MPI_CHAR, 0, comm));
  MpmCheckInput(!why[0], "-matrix_blocks %s: %s", path, why);
  PetscCall(MpmHookedCertificates(comm, &hooked, tolerance, c));
  sizes[0] = b->dim;
  sizes[1] = b->size;
  sizes[2] = b->n;
  sizes[3] = b->period;
  PetscCallMPI(MPI_Bcast(sizes, 4, MPIU_INT, 0, comm));
  MpmCheckInput(!sizes[3] || !steps || sizes[3] == steps,
                "-matrix_steps %" PetscInt_FMT ": %s says that it covers %" PetscInt_FMT "; allowed: without it", steps,
                path, sizes[3]);
  if (rank) {
    *b = (MpmBlocks){.dim = sizes[0], .size = sizes[1], .n = sizes[2]};
    PetscCall(MpmBlocksAllocate(b));
  }
  b->period = sizes[3] ? sizes[3] : PetscMax(1, steps);
  PetscCallMPI(MPI_Bcast(b->d, b->dim * b->n, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(b->A, b->n * b->size * b->size, MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast(&b->cell_width, 1, MPIU_REAL, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteHdf5(const char path[], const MpmBlocks *b)
{
  const PetscMPIInt rank = MpmRankOf(PETSC_COMM_WORLD);
  MpmDataFile       file;
  hid_t             whole;

  PetscFunctionBegin;
  PetscCall(MpmDataFileCreate(PETSC_COMM_WORLD, path, &file)); /* first, as it prepares HDF5 */
  whole = sizeof(PetscInt) == sizeof(int32_t) ? H5T_NATIVE_INT32 : H5T_NATIVE_INT64;
  PetscCall(MpmHdf5WriteRows(&file.hdf5, "/d", whole, rank ? 0 : b->n, 1, &b->dim, b->d));
  PetscCall(MpmHdf5WriteRows(&file.hdf5, "/A", H5T_NATIVE_DOUBLE, rank ? 0 : b->n, 2,
                             (const PetscInt[]){b->size, b->size}, b->A));
  MpmHdf5WriteInteger(&file.hdf5, "/", "steps", b->period);
  if (b->cell_width > 0) MpmHdf5WriteReal(&file.hdf5, "/", "cell_width", b->cell_width);
  PetscCall(MpmDataFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNpz(const MpmBlocks *b, FILE *stream)
{
  static const char *const whole[] = {"d", "steps", NULL};
  MpmArrays                arrays  = {.n = 0};
  MpmArray                *a;

  PetscFunctionBegin;
  PetscCall(MpmArraysAdd(&arrays, "d", 2, (const PetscInt64[]){b->n, b->dim}, &a));
  for (PetscInt i = 0; i < b->n * b->dim; i++) a->real[i] = b->d[i];
  PetscCall(MpmArraysAdd(&arrays, "A", 3, (const PetscInt64[]){b->n, b->size, b->size}, &a));
  PetscCall(PetscArraycpy(a->real, b->A, (size_t)a->n));
  PetscCall(MpmArraysAdd(&arrays, "steps", 0, NULL, &a));
  a->real[0] = b->period;
  if (b->cell_width > 0) {
    PetscCall(MpmArraysAdd(&arrays, "cell_width", 0, NULL, &a));
    a->real[0] = b->cell_width;
  }
  PetscCall(MpmArraysWriteNpz(&arrays, whole, stream));
  PetscCall(MpmArraysFree(&arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlocksWrite(const char path[], const MpmBlocks *b)
{
  const char *ending = strrchr(path, '.');
  MpmTextFile file;

  PetscFunctionBegin;
  if (!ending || strcmp(ending, ".npz")) {
    PetscCall(WriteHdf5(path, b));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmTextFileOpen(path, &file));
  if (file.stream) PetscCall(WriteNpz(b, file.stream));
  PetscCall(MpmTextFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}
