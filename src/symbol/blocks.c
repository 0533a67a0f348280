/* Blocks of a lattice as a source of a symbol, and back from any source to its blocks. */
#include "symbol/blocks.h"
#include <mpmstab/errors.h>
#include <math.h>

#define FEWEST 8       /* phases in each direction that are tried first */
#define MOST 256       /* and last */
#define AGREES 1e-12   /* relative to the largest number of G: the blocks give a matrix again */
#define NOISE 1e-15    /* relative to the largest number of all blocks: a block that is smaller is rounding */
#define OTHER_PHASES 2 /* at which the blocks are tried */
#define GOLDEN 0.6180339887498949

PetscErrorCode MpmBlocksAllocate(MpmBlocks *b)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc2((size_t)b->dim * b->n, &b->d, (size_t)b->n * b->size * b->size, &b->A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlocksFree(MpmBlocks *b)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(b->d, b->A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The block at a distance, or MPM_NONE. */
static PetscInt BlockAt(const MpmBlocks *b, const PetscInt d[])
{
  for (PetscInt k = 0; k < b->n; k++) {
    PetscBool same = PETSC_TRUE;

    for (PetscInt a = 0; a < b->dim; a++)
      if (b->d[b->dim * k + a] != d[a]) same = PETSC_FALSE;
    if (same) return k;
  }
  return MPM_NONE;
}

PetscErrorCode MpmBlocksCombine(PetscInt n, const MpmBlocks blocks[], const PetscReal weight[], MpmBlocks *sum)
{
  const PetscInt square = blocks[0].size * blocks[0].size;

  PetscFunctionBegin;
  *sum   = blocks[0];
  sum->n = 0;
  for (PetscInt i = 0; i < n; i++) sum->n += blocks[i].n;
  PetscCall(MpmBlocksAllocate(sum));
  PetscCall(PetscArrayzero(sum->A, (size_t)sum->n * square));
  sum->n = 0;
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt k = 0; k < blocks[i].n; k++) {
      const PetscInt *d  = &blocks[i].d[sum->dim * k];
      PetscInt        at = BlockAt(sum, d);

      if (at == MPM_NONE) {
        at = sum->n++;
        PetscCall(PetscArraycpy(&sum->d[sum->dim * at], d, sum->dim));
      }
      for (PetscInt e = 0; e < square; e++)
        sum->A[(size_t)at * square + e] += weight[i] * blocks[i].A[(size_t)k * square + e];
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Matrices(void *context, PetscInt cases, const PetscInt which[], const PetscReal beta[],
                               PetscBool noisy, double complex G[], PetscInt *exponent)
{
  const MpmBlocks *b = context;
  const PetscInt   n = b->size;

  PetscFunctionBegin;
  (void)cases;
  (void)which;
  (void)noisy;
  *exponent = 0;
  PetscCall(PetscArrayzero(G, n * n));
  for (PetscInt k = 0; k < b->n; k++) {
    const PetscReal *A     = b->A + (size_t)k * n * n;
    PetscReal        angle = 0;
    double complex   wave;

    for (PetscInt a = 0; a < b->dim; a++) angle -= beta[a] * b->d[b->dim * k + a];
    wave = cexp(I * angle);
    for (PetscInt e = 0; e < n * n; e++) G[e] += A[e] * wave;
  }
  for (PetscInt i = 0; i < n; i++) { /* the blocks are by rows, G is by columns */
    for (PetscInt j = 0; j < i; j++) {
      const double complex other = G[n * j + i];

      G[n * j + i] = G[n * i + j];
      G[n * i + j] = other;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlocksSource(const MpmBlocks *b, const char name[], MpmSource *source)
{
  PetscFunctionBegin;
  *source = (MpmSource){.dim      = b->dim,
                        .size     = b->size,
                        .period   = b->period,
                        .cases    = 1,
                        .together = 1,
                        .matrices = Matrices,
                        .context  = (void *)b,
                        .alike    = {0, 1, 2},
                        .null_all = MPM_NONE};
  PetscCall(PetscStrncpy(source->name, name, sizeof source->name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The last step is on the left. */
static PetscErrorCode Product(void *context, PetscInt cases, const PetscInt which[], const PetscReal beta[],
                              PetscBool noisy, double complex G[], PetscInt *exponent)
{
  const MpmBlocksSteps *s = context;
  const PetscInt        n = s->step->size;
  double complex       *one, *product;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n * n, &one, n * n, &product));
  PetscCall(Matrices((void *)s->step, cases, which, beta, noisy, G, exponent));
  for (PetscInt k = 1; k < s->n; k++) {
    PetscCall(Matrices((void *)&s->step[k], cases, which, beta, noisy, one, exponent));
    PetscCall(PetscArrayzero(product, n * n));
    for (PetscInt j = 0; j < n; j++)
      for (PetscInt l = 0; l < n; l++)
        for (PetscInt i = 0; i < n; i++) product[n * j + i] += one[n * l + i] * G[n * j + l];
    PetscCall(PetscArraycpy(G, product, n * n));
  }
  PetscCall(PetscFree2(one, product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlocksSourceOfSteps(const MpmBlocksSteps *steps, const char name[], MpmSource *source)
{
  PetscFunctionBegin;
  PetscCall(MpmBlocksSource(steps->step, name, source));
  source->period   = steps->n * steps->step->period;
  source->matrices = Product;
  source->context  = (void *)steps;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- from matrices to blocks ---- */

static PetscInt Power(PetscInt n, PetscInt dim)
{
  return dim == 1 ? n : n * Power(n, dim - 1);
}

/* The matrices at all phases, one after the other, dealt to the ranks and then known to all. */
static PetscErrorCode Sample(MPI_Comm comm, const MpmSource *source, PetscInt n, double complex G[])
{
  const PetscInt all = Power(n, source->dim), numbers = source->size * source->size;
  PetscMPIInt    rank, ranks;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  PetscCall(PetscArrayzero(G, (size_t)all * numbers));
  for (PetscInt phase = rank; phase < all; phase += ranks) {
    double complex *at = G + (size_t)phase * numbers;
    PetscReal       beta[MPM_MAX_DIM];
    PetscInt        rest = phase, exponent;

    for (PetscInt a = 0; a < source->dim; a++) {
      beta[a] = MpmSymbolPhase(rest % n, n);
      rest /= n;
    }
    PetscCall(MpmSourceMatrix(source, beta, at, &exponent));
    for (PetscInt i = 0; i < numbers && exponent; i++) at[i] *= scalbn(1, (int)exponent);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, G, 2 * all * numbers, MPIU_REAL, MPI_SUM, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The transform along one direction of a line of n matrices, stride matrices apart. */
static void TransformLine(PetscInt n, PetscInt stride, PetscInt numbers, const double complex wave[],
                          double complex line[], double complex G[])
{
  for (PetscInt i = 0; i < numbers; i++) {
    for (PetscInt d = 0; d < n; d++) {
      line[d] = 0;
      for (PetscInt m = 0; m < n; m++) line[d] += G[(size_t)m * stride * numbers + i] * wave[m * d % n];
    }
    for (PetscInt d = 0; d < n; d++) G[(size_t)d * stride * numbers + i] = line[d] / n;
  }
}

static PetscErrorCode Transform(PetscInt dim, PetscInt n, PetscInt numbers, double complex G[])
{
  const PetscInt  all = Power(n, dim);
  double complex *wave, *line;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &wave, n, &line));
  for (PetscInt m = 0; m < n; m++) wave[m] = cexp(I * MpmSymbolPhase(m, n));
  for (PetscInt a = 0, stride = 1; a < dim; a++, stride *= n)
    for (PetscInt begin = 0; begin < all; begin++)
      if (begin / stride % n == 0) TransformLine(n, stride, numbers, wave, line, G + (size_t)begin * numbers);
  PetscCall(PetscFree2(wave, line));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Largest(PetscInt numbers, const double complex block[])
{
  PetscReal largest = 0;

  for (PetscInt i = 0; i < numbers; i++)
    if (!(fabs(creal(block[i])) <= largest)) largest = fabs(creal(block[i]));
  return largest;
}

/* Keeps the blocks that are more than rounding. Distances beyond half of n are negative. */
static PetscErrorCode Keep(const MpmSource *source, PetscInt n, const double complex G[], MpmBlocks *b)
{
  const PetscInt  all = Power(n, source->dim), size = source->size, numbers = size * size;
  const PetscReal largest = Largest(all * numbers, G);

  PetscFunctionBegin;
  *b = (MpmBlocks){.dim = source->dim, .size = size, .period = source->period};
  for (PetscInt k = 0; k < all; k++) b->n += Largest(numbers, G + (size_t)k * numbers) > NOISE * largest;
  PetscCall(MpmBlocksAllocate(b));
  for (PetscInt k = 0, to = 0; k < all; k++) {
    const double complex *block = G + (size_t)k * numbers;
    PetscInt              rest  = k;

    if (!(Largest(numbers, block) > NOISE * largest)) continue;
    for (PetscInt a = 0; a < b->dim; a++) {
      b->d[b->dim * to + a] = rest % n > n / 2 ? rest % n - n : rest % n;
      rest /= n;
    }
    for (PetscInt i = 0; i < size; i++)
      for (PetscInt j = 0; j < size; j++) b->A[((size_t)to * size + i) * size + j] = creal(block[size * j + i]);
    to++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether blocks give the source's matrices at phases that they do not come from. */
static PetscErrorCode Agree(const MpmSource *source, const MpmBlocks *b, PetscBool *agree)
{
  const PetscInt  numbers = source->size * source->size;
  double complex *G[2];

  PetscFunctionBegin;
  *agree = PETSC_TRUE;
  PetscCall(PetscMalloc2(numbers, &G[0], numbers, &G[1]));
  for (PetscInt t = 1; t <= OTHER_PHASES; t++) {
    PetscReal beta[MPM_MAX_DIM], largest = 0, apart = 0;
    PetscInt  exponent, none;

    for (PetscInt a = 0; a < b->dim; a++) beta[a] = 2 * PETSC_PI * fmod(GOLDEN * (PetscReal)(t * (2 * a + 1)), 1);
    PetscCall(MpmSourceMatrix(source, beta, G[0], &exponent));
    PetscCall(Matrices((void *)b, 1, NULL, beta, PETSC_FALSE, G[1], &none));
    for (PetscInt i = 0; i < numbers; i++) {
      const double complex exact = G[0][i] * scalbn(1, (int)exponent);

      largest = PetscMax(largest, cabs(exact));
      if (!(cabs(G[1][i] - exact) <= apart)) apart = cabs(G[1][i] - exact);
    }
    if (!(apart <= AGREES * largest)) *agree = PETSC_FALSE;
  }
  PetscCall(PetscFree2(G[0], G[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlocksFromSource(MPI_Comm comm, const MpmSource *source, const char option[], MpmBlocks *b)
{
  const PetscInt numbers = source->size * source->size;
  PetscBool      agree   = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt n = FEWEST; !agree; n *= 2) {
    PetscReal       room = (PetscReal)numbers;
    double complex *G;

    for (PetscInt a = 0; a < source->dim; a++) room *= (PetscReal)n;
    MpmCheckInput(
        n <= MOST && room <= MPM_BLOCKS_NUMBERS,
        "-%s: %s: a cell reaches beyond %" PetscInt_FMT
        " others, or the numbers leave the range of doubles; allowed: a scheme with a shorter reach, or a drift "
        "with a smaller denominator",
        option, source->name, n / 4);
    PetscCall(PetscMalloc1((size_t)room, &G));
    PetscCall(Sample(comm, source, n, G));
    PetscCall(Transform(source->dim, n, numbers, G));
    PetscCall(Keep(source, n, G, b));
    PetscCall(PetscFree(G));
    PetscCall(Agree(source, b, &agree));
    if (!agree) PetscCall(MpmBlocksFree(b));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
