/*
   A turn is the steps after which each particle has the place that another one had. Its matrices are compared with those
   of a whole period, the smaller matrices of particles that only gain with the whole ones, and many Courant numbers side
   by side with each of them alone. The noise of a period is that of its steps, one by one.
*/
#include "waves.h"
#include "base/hash.h"
#include "symbol/bloch_growth.h"
#include <mpmstab/verdict.h>

/*
   The amplification factors of a period are powers of those of a turn, times the phase of the cells that particles move.
   Sorted out one by one, since a defective pair splits by rounding. The turn is of a smaller matrix where particles take
   values from nodes; those of its factors that are missing are 0. unknowns: the order of the matrix of a turn.
*/
static PetscErrorCode CheckTurn(const char options[], PetscInt turn, PetscInt unknowns)
{
  const PetscReal beta[MPM_MAX_DIM] = {0.7, -1.9, 2.6};
  double complex  value[64]         = {0};
  PetscReal       angle             = 0;
  PetscInt        exponent;
  MpmSmallEigen   smaller;
  Wave            w;

  PetscFunctionBegin;
  PetscCall(WaveCreate(options, &w));
  CHECK(w.bloch.turn == turn && w.bloch.size <= 64, "%s: a turn of %d steps", options, (int)w.bloch.turn);
  CHECK(w.bloch.turn_size == unknowns, "%s: %d unknowns of %d", options, (int)w.bloch.turn_size, (int)w.bloch.size);
  PetscCall(MpmSmallEigenCreate(w.bloch.turn_size, &smaller));
  PetscCall(MpmBlochTurns(&w.bloch, 1, &w.scene->step.courant, beta, smaller.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&smaller, PETSC_FALSE));
  for (PetscInt a = 0; a < w.scene->layout.dim; a++)
    angle += beta[a] * w.scene->step.drift[a].value * (PetscReal)w.bloch.period;
  for (PetscInt i = 0; i < smaller.n; i++)
    value[i] =
        cpow(smaller.value[i] * scalbn(1, (int)exponent), (double)(w.bloch.period / w.bloch.turn)) * cexp(I * angle);
  PetscCall(FactorsAt(&w, w.scene->step.courant, beta, PETSC_FALSE));
  for (PetscInt i = 0; i < w.eigen.n; i++) {
    PetscInt nearest = i;

    for (PetscInt j = i; j < w.eigen.n; j++)
      if (cabs(value[j] - w.eigen.value[i]) < cabs(value[nearest] - w.eigen.value[i])) nearest = j;
    CHECK(cabs(value[nearest] - w.eigen.value[i]) <= 1e-11 * fmax(1, cabs(value[nearest])), "%s: %.3g apart", options,
          cabs(value[nearest] - w.eigen.value[i]));
    value[nearest] = value[i];
  }
  PetscCall(MpmSmallEigenDestroy(&smaller));
  PetscCall(WaveDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckTurns(void)
{
  PetscFunctionBegin;
  PetscCall(CheckTurn("-formulation usl -ppc 2 -drift 1/8 -courant 0.9", 4, 4));
  PetscCall(CheckTurn("-formulation gas2 -basis quadratic -ppc 6 -drift -7/4 -offset 0.3 -courant 0.4", 2, 12));
  PetscCall(CheckTurn("-formulation musl -basis gimp -ppc 3 -drift 5/6 -courant 0.7 -transfer apic", 2, 1 + 3));
  PetscCall(CheckTurn("-formulation usl -ppc 1 -drift 1/8 -courant 0.9", 8, 2));
  PetscCall(CheckTurn("-dim 2 -formulation usl -basis quadratic -ppc 2,3 -drift 1/4,-2/3 -courant 0.5", 2, 30));
  PetscCall(
      CheckTurn("-dim 2 -formulation usf -basis cubic -ppc 2,2 -drift 1/4,1/3 -courant 0.5 -transfer apic", 6, 2 + 12));
  PetscCall(CheckTurn("-dim 3 -formulation gas1 -basis linear -ppc 2,1,2 -drift 1/2,1/2,3/4 -courant 0.2", 2, 16));
  PetscCall(CheckTurn("-formulation usl -ppc 3 -drift 1/8 -courant 1.3 -transfer pic", 8, 1 + 3));
  PetscCall(CheckTurn("-formulation usl -ppc 2 -drift 3/8 -courant 1.2 -transfer xpic -xpic_order 3", 4, 1 + 2));
  PetscCall(CheckTurn("-formulation gas2 -ppc 2 -drift 1/8 -courant 0.5 -transfer pic", 4, 2));
  PetscCall(CheckTurn("-formulation usavg -ppc 2 -drift 1/8 -courant 0.5 -transfer blend", 4, 4)); /* not set to 0 */
  PetscCall(CheckTurn("-formulation usl -ppc 2 -drift 1/8 -courant 1.2 -transfer aflip", 4, 2 * 2 + 1));
  PetscCall(CheckTurn("-dim 3 -formulation usl -basis quadratic -ppc 1,1,2 -drift 1/2 -courant 0.4 -transfer tpic "
                      "-gradient mls",
                      2, 3 + 12));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what particles gain ---- */

#define SPLIT 1e-8 /* a factor of modulus 1 that is there twice may split so far */

/*
   Growth by the numbers that particles gain is that of the matrix of a turn. order: of the smaller matrix; 0 where there is
   none. Growth 1 may be a defective factor, which splits by rounding.
*/
static PetscErrorCode CheckGained(const char options[], PetscInt order)
{
  static const PetscReal beta[][MPM_MAX_DIM] = {{0.7, -1.9, 2.6},   {0.46, 0, 0}, {1.2, 1.2, 1.2},
                                                {PETSC_PI, 0, 0.3}, {2, 2, 0},    {1e-2, 2e-2, 1e-2},
                                                {3, -3, 3},         {2e-3, 0, 0}};
  Wave                   w;
  MpmSmallEigen          turned;

  PetscFunctionBegin;
  PetscCall(WaveCreate(options, &w));
  CHECK((w.bloch.gained ? w.bloch.gained->order : 0) == order, "%s: %d unknowns", options,
        w.bloch.gained ? (int)w.bloch.gained->order : 0);
  PetscCall(MpmSmallEigenCreate(w.bloch.turn_size, &turned));
  for (size_t i = 0; w.bloch.gained && i < sizeof beta / sizeof *beta; i++) {
    MpmBlochGained *gained = w.bloch.gained;
    PetscReal       growth, whole, without;

    PetscCall(MpmBlochGrowths(&w.bloch, &turned, 1, &w.scene->step.courant, beta[i], &growth, &without));
    w.bloch.gained = NULL;
    PetscCall(MpmBlochGrowths(&w.bloch, &turned, 1, &w.scene->step.courant, beta[i], &whole, &without));
    w.bloch.gained = gained;
    CHECK(fabs(growth - whole) <= (PetscMax(growth, whole) < 1 + SPLIT ? SPLIT : 1e-9) * whole,
          "%s: growth %.17g, %.17g of a turn", options, growth, whole);
  }
  PetscCall(MpmSmallEigenDestroy(&turned));
  PetscCall(WaveDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckGains(void)
{
  PetscFunctionBegin;
  PetscCall(CheckGained("-dim 3 -formulation usl -basis quadratic -drift 1/8,1/8,1/8 -courant 0.5", 48));
  PetscCall(CheckGained("-dim 3 -formulation usl -basis quadratic -drift 1/8,1/8,1/8 -courant 1.9", 48));
  PetscCall(CheckGained("-dim 3 -formulation usavg -basis quadratic -drift 1/8,1/8,1/8 -courant 1.9", 48));
  PetscCall(CheckGained("-dim 3 -formulation usf -basis linear -drift 1/8,1/8,1/8 -courant 0.5", 48));
  PetscCall(CheckGained("-dim 3 -formulation musl -basis cubic -drift 1/4,1/8,-1/8 -courant 0.9", 48));
  PetscCall(CheckGained("-dim 3 -formulation usl -basis gimp -ppc 3 -drift 1/6,1/6,1/6 -courant 0.8 -poisson 0.5", 36));
  PetscCall(CheckGained("-dim 3 -formulation usl -basis gimp -ppc 3 -drift 1/8,1/8,0 -courant 0.8", 48));
  PetscCall(
      CheckGained("-dim 3 -formulation usl -gradient mls -ppc 3,3,2 -offset 0.2 -drift 0,-5/4,0 -courant 0.8", 24));
  PetscCall(CheckGained("-dim 2 -formulation gas2 -basis quadratic -ppc 5 -drift 1/5,2/5 -courant 0.4", 15));
  PetscCall(CheckGained("-dim 3 -formulation usl -basis linear -drift 1/8 -transfer blend", 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Along some directions without drift the vectors that particles gain are fewer. */
static PetscErrorCode CheckStill(void)
{
  PetscFunctionBegin;
  PetscCall(CheckGained("-dim 3 -formulation usl -basis quadratic -drift 1/8,0,0 -courant 0.5", 18));
  PetscCall(CheckGained("-dim 3 -formulation usl -basis quadratic -drift 0,0,1/50 -courant 1.9", 18)); /* 25 steps */
  PetscCall(CheckGained("-dim 3 -formulation usavg -basis linear -drift 0,1/8,0 -courant 0.8 -poisson 0.3", 18));
  PetscCall(CheckGained("-dim 3 -formulation musl -basis cubic -ppc 2,5,1 -drift -2/7,0,1/2 -courant 0.8", 24));
  PetscCall(CheckGained("-dim 2 -formulation usf -basis gimp -ppc 6 -offset 0.3 -drift 0,1/7 -courant 0.7", 28));
  PetscCall(CheckGained("-dim 2 -formulation gas2 -basis quadratic -ppc 5 -drift 1/5,0 -courant 0.4", 15));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- lanes ---- */

#define MANY 11 /* Courant numbers, so that some lanes are left over */

/* Whether a matrix is another one to the last bit. They may be divided by different powers of two. */
static PetscBool Same(PetscInt n, const double complex a[], PetscInt a_exponent, const double complex b[],
                      PetscInt b_exponent)
{
  for (PetscInt i = 0; i < n * n; i++)
    if (a[i] != b[i] || a_exponent != b_exponent) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* Many Courant numbers side by side have the matrices and growths of each of them alone, to the last bit. */
static PetscErrorCode CheckLanes(const char options[])
{
  const PetscReal beta[MPM_MAX_DIM] = {0.7, -1.9, 2.6};
  double complex *G, *alone;
  PetscReal       courant[MANY], growth[MANY], without[MANY];
  PetscInt        exponent[MANY], size, turn;
  MpmSmallEigen   turned;
  Wave            w;

  PetscFunctionBegin;
  PetscCall(WaveCreate(options, &w));
  size = w.bloch.size;
  turn = w.bloch.turn_size;
  for (int i = 0; i < MANY; i++) courant[i] = w.scene->step.courant * (1 + 0.37 * (i * 7 % MANY));
  courant[4] = 1e9; /* its matrices are divided on the way */
  PetscCall(PetscMalloc2(MANY * size * size, &G, size * size, &alone));
  PetscCall(MpmSmallEigenCreate(turn, &turned));
  for (int noisy = 0; noisy < 2; noisy++) {
    PetscCall(MpmBlochMatrices(&w.bloch, MANY, courant, beta, noisy ? PETSC_TRUE : PETSC_FALSE, G, exponent));
    for (int i = 0; i < MANY; i++) {
      PetscInt own;

      PetscCall(MpmBlochMatrices(&w.bloch, 1, &courant[i], beta, noisy ? PETSC_TRUE : PETSC_FALSE, alone, &own));
      CHECK(Same(size, G + i * size * size, exponent[i], alone, own), "%s: matrix %d%s", options, i,
            noisy ? " with noise" : "");
    }
  }
  PetscCall(MpmBlochTurns(&w.bloch, MANY, courant, beta, G, exponent));
  for (int i = 0; i < MANY; i++) {
    PetscInt own;

    PetscCall(MpmBlochTurns(&w.bloch, 1, &courant[i], beta, alone, &own));
    CHECK(Same(turn, G + i * turn * turn, exponent[i], alone, own), "%s: turn %d", options, i);
  }
  PetscCall(MpmBlochGrowths(&w.bloch, &turned, MANY, courant, beta, growth, without));
  for (int i = 0; i < MANY; i++) {
    PetscReal own;

    PetscCall(MpmBlochGrowths(&w.bloch, &turned, 1, &courant[i], beta, &own, &without[i]));
    CHECK(growth[i] == own, "%s: growth %d is %.17g, alone %.17g", options, i, growth[i], own);
  }
  PetscCall(PetscFree2(G, alone));
  PetscCall(MpmSmallEigenDestroy(&turned));
  PetscCall(WaveDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Schemes and transfers of all kinds: with and without a turn, with registers that are taken, and wide matrices. */
static PetscErrorCode CheckManyCourantNumbers(void)
{
  static const char *const formulations[] = {"gas1", "gas2", "elastic", "usl", "usf", "musl", "usavg"};
  static const char *const transfers[]    = {
         "flip", "pic", "blend", "xpic -xpic_order 3", "nullspace", "fmpm -xpic_order 3", "apic", "tpic", "aflip"};
  static const size_t      with_momentum = 3, affine = 6; /* from these on; an affine part is one of momentum */
  static const char *const places[] = {"-ppc 2", "-ppc 2 -drift 1/8", "-ppc 3 -drift -2/7 -offset 0.3",
                                       "-dim 2 -ppc 1,2 -drift 1/4,-2/3", "-dim 2 -ppc 2"};
  char                     options[256];

  PetscFunctionBegin;
  for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(formulations); f++)
    for (size_t t = 0; t < PETSC_STATIC_ARRAY_LENGTH(transfers); t++)
      for (size_t p = 0; p < PETSC_STATIC_ARRAY_LENGTH(places); p++) {
        if (f < with_momentum && t >= affine) continue;
        PetscCall(PetscSNPrintf(options, sizeof options,
                                "-formulation %s -transfer %s %s -courant 0.3 -basis quadratic", formulations[f],
                                transfers[t], places[p]));
        PetscCall(CheckLanes(options));
      }
  PetscCall(CheckLanes("-dim 3 -formulation usl -transfer apic -ppc 2,1,1 -drift 1/2 -courant 0.4"));
  PetscCall(CheckLanes("-dim 3 -formulation usl -basis quadratic -drift 1/2 -courant 0.4")); /* of order 72: one lane */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- noise ---- */

/* Every step moves every number by its own part of its rounding, at the first phase and at those after it. */
static PetscErrorCode CheckNoise(const char options[])
{
  const PetscReal beta[2][MPM_MAX_DIM] = {{0.3, 0.4, -0.5}, {0.7, -1.9, 2.6}};
  double complex *G, *state;
  PetscInt        exponent, n;
  Wave            w;

  PetscFunctionBegin;
  PetscCall(WaveCreate(options, &w));
  n = w.bloch.size;
  PetscCall(PetscMalloc2(n * n, &G, n, &state));
  for (int phase = 0; phase < 2; phase++) {
    PetscInt differ = 0;

    PetscCall(MpmBlochMatrices(&w.bloch, 1, &w.scene->step.courant, beta[phase], PETSC_TRUE, G, &exponent));
    for (PetscInt c = 0; c < n; c++) {
      for (PetscInt i = 0; i < n; i++) state[i] = i == c;
      for (PetscInt step = 0; step < w.bloch.period; step++) {
        PetscCall(MpmBlochStep(&w.bloch, w.scene->step.courant, beta[phase], step, state));
        for (PetscInt i = 0; i < n; i++) {
          const PetscInt row = i % w.bloch.fields * w.bloch.ppc + i / w.bloch.fields;

          state[i] *= 1 + MPM_ROUNDING * (2 * MpmHash(step, row * n + c) - 1);
        }
      }
      for (PetscInt i = 0; i < n; i++) differ += state[i] != G[c * n + i] * scalbn(1, (int)exponent);
    }
    CHECK(differ == 0, "%s: %d numbers of %d differ at phase %d", options, (int)differ, (int)(n * n), phase);
  }
  PetscCall(PetscFree2(G, state));
  PetscCall(WaveDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckTurns());
  PetscCall(CheckGains());
  PetscCall(CheckStill());
  PetscCall(CheckManyCourantNumbers());
  PetscCall(CheckNoise("-dim 2 -formulation usl -basis quadratic -drift 1/4,1/8 -courant 0.5"));
  PetscCall(
      CheckNoise("-dim 2 -formulation usl -basis quadratic -ppc 6 -drift 1/40,0 -courant 0.5")); /* too many to keep */
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
