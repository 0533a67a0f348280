/*
   Windows of growth under drift. Some limits were once found too large, because a window was stepped over. Random
   schemes are scanned below their limits by brute force: ten times the phases of the search, small steps in Courant
   number, and ten times smaller ones where two amplification factors are near each other. Nothing may grow there by
   more than twice the tolerance. The same holds for particles moved at random, where there are no phases and the
   assembled operator is searched.

   test_windows [SCHEMES [PHASES [FIRST]]]: the number of random schemes, of phases of each, and of the first scheme.
*/
#include "check.h"
#include <mpmstab/critical.h>
#include "linalg/dense.h"
#include "linalg/small_eigen.h"
#include "operator/polynomial.h"
#include "scene/layout.h"
#include "symbol/bloch.h"
#include <slepceps.h>

#define STEP 0.003
#define FINER 10
#define NEAR 0.01 /* distance of two amplification factors at which steps become finer */
#define MOST 3.0  /* largest Courant number of the scan */
#define PLACES 20 /* Courant numbers below the limit of an assembled operator, for each of the phases asked for */

/* The limit of a scene. Of the case, only its numbers outlive this function. */
static PetscErrorCode Find(const char options[], PetscBool alone, MpmCriticalCase *of, MpmCritical *c)
{
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  *of = MpmCriticalCaseOf(scene, check_request.tolerance);
  PetscCall(MpmCriticalFind(of, alone, c));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* limit: a Courant number beyond which growth has been seen; the search must not find a larger limit. */
static PetscErrorCode CheckLimit(const char options[], PetscReal limit, PetscReal relative)
{
  MpmCriticalCase of;
  MpmCritical     c;

  PetscFunctionBegin;
  PetscCall(Find(options, PETSC_TRUE, &of, &c));
  CHECK(c.courant <= limit * (1 + 1e-6) && c.courant >= limit * (1 - relative), "%s: %.9g, not %.9g", options,
        c.courant, limit);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckLimits(void)
{
  PetscFunctionBegin;
  PetscCall(CheckLimit("-formulation usavg -transfer nullspace -basis quadratic -drift 1/3", 1.27616, 1e-4));
  PetscCall(CheckLimit("-formulation usavg -transfer flip -basis quadratic -drift 1/3", 1.31700, 1e-4));
  PetscCall(CheckLimit("-formulation usavg -transfer flip -basis cubic -drift 1/8", 1.91544, 1e-4));
  PetscCall(CheckLimit("-formulation usavg -transfer nullspace -basis cubic -drift 1/8", 1.91544, 1e-4));
  PetscCall(CheckLimit("-formulation usavg -transfer apic -basis gimp -drift 1/8", 1.03675, 1e-4));
  PetscCall(CheckLimit("-basis cubic -drift 1/3", 0.069087, 1e-4));
  PetscCall(CheckLimit("-formulation usavg -transfer nullspace -basis cubic -cells 5 -ppc 3 -offset 1e-9 -drift -3/6",
                       1.91563, 1e-4));
  PetscCall(CheckLimit("-formulation usavg -transfer xpic -xpic_order 20 -basis gimp -material graded -stiffness_ratio "
                       "1e6 -drift 19/22 -cells 5 -ppc 1",
                       0.00243563934, 1e-4));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks the verdict at a Courant number inside a window that 320 phases miss; growth is that of much closer phases. */
static PetscErrorCode CheckAsked(const char options[], PetscReal growth)
{
  MpmCriticalCase of;
  MpmCritical     c;

  PetscFunctionBegin;
  PetscCall(Find(options, PETSC_FALSE, &of, &c));
  CHECK(c.asked.verdict == MPM_UNSTABLE && c.asked.growth > 1 + growth / 2, "%s: %s, growth %.9g", options,
        MpmVerdictNames[c.asked.verdict], c.asked.growth);
  CHECK(c.courant < of.step.courant, "%s: limit %.9g", options, c.courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

typedef struct {
  MpmBloch      bloch;
  MpmSmallEigen eigen;
  PetscReal     tolerance;
} Symbol;

static PetscErrorCode GrowthAt(Symbol *s, PetscReal courant, PetscReal beta, PetscReal *growth, PetscReal *nearest)
{
  PetscInt  exponent;
  PetscReal largest = 0;

  PetscFunctionBegin;
  PetscCall(MpmBlochMatrices(&s->bloch, 1, &courant, &beta, PETSC_FALSE, s->eigen.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&s->eigen, PETSC_FALSE));
  *nearest = INFINITY;
  for (PetscInt i = 0; i < s->eigen.n; i++) {
    const double complex value = s->eigen.value[i];

    largest = fmax(largest, cabs(value));
    for (PetscInt j = 0; j < i && cabs(value) > 0.9; j++)
      if (cabs(value - s->eigen.value[j]) > 1e-6) *nearest = fmin(*nearest, cabs(value - s->eigen.value[j]));
  }
  *growth = MpmGrowthPerStep(largest, exponent, s->bloch.period);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the least Courant number below limit that grows by more than twice the tolerance; infinite for none. */
static PetscErrorCode Scan(Symbol *s, PetscReal limit, PetscInt phases, PetscReal *least, PetscReal *at)
{
  const PetscReal most = 1 + 2 * s->tolerance;
  PetscReal       growth, nearest;

  PetscFunctionBegin;
  *least = INFINITY;
  for (PetscInt m = 1; m <= phases; m++) {
    const PetscReal beta = PETSC_PI / 2 * (1 - cos(PETSC_PI * (m - 0.37) / phases));

    for (PetscReal k = STEP * MpmHash(5, m); k < PetscMin(limit, *least); k += STEP) {
      PetscCall(GrowthAt(s, k, beta, &growth, &nearest));
      for (int n = 1; n < FINER && nearest < NEAR * s->bloch.period && growth <= most; n++)
        if (k + n * STEP / FINER < limit) {
          PetscReal unused;

          PetscCall(GrowthAt(s, k + n * STEP / FINER, beta, &growth, &unused));
        }
      if (growth <= most) continue;
      *least = k;
      *at    = beta;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt Draw(PetscInt seed, PetscInt n, PetscInt of)
{
  return (PetscInt)(MpmHash(seed, n) * (PetscReal)of);
}

/* Draws the options of random scheme n; "" when there is no such scheme. */
static PetscErrorCode DrawScheme(PetscInt n, size_t room, char options[])
{
  const char *const offsets[] = {"1/2", "0", "1e-9", "1/3"};
  PetscInt          count[3] = {0, 0, 0}, den = 2 + Draw(36, n, 9), num;
  char              offset[32];

  PetscFunctionBegin;
  while (MpmFormulations[count[0]]) count[0]++;
  while (MpmTransfers[count[1]]) count[1]++;
  while (MpmBases[count[2]]) count[2]++;
  num = 1 + Draw(37, n, den - 1);
  PetscCall(PetscSNPrintf(offset, sizeof offset, "%.12f", MpmHash(35, n)));
  options[0] = '\0';
  {
    const MpmFormulation *f = MpmFormulations[Draw(31, n, count[0])];
    const MpmTransfer    *t = MpmTransfers[Draw(32, n, count[1])];
    const PetscInt        o = Draw(34, n, 6);

    if (t->affine && f->affine == MPM_NONE) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(PetscSNPrintf(options, room,
                            "-formulation %s -transfer %s -basis %s -ppc %" PetscInt_FMT " -offset %s -drift "
                            "%" PetscInt_FMT "/%" PetscInt_FMT,
                            f->name, t->name, MpmBases[Draw(33, n, count[2])]->name, 1 + Draw(38, n, 4),
                            o < 4 ? offsets[o] : offset, num, den));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRandom(PetscInt n, PetscInt phases, PetscBool say)
{
  char            options[256];
  MpmScene       *scene;
  Symbol          s;
  MpmCriticalCase of;
  MpmCritical     c;
  PetscReal       least, at = NAN;

  PetscFunctionBegin;
  PetscCall(DrawScheme(n, sizeof options, options));
  if (!options[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckScene(options, &scene));
  of = MpmCriticalCaseOf(scene, check_request.tolerance);
  PetscCall(MpmCriticalFind(&of, PETSC_TRUE, &c));
  s.tolerance = check_request.tolerance;
  PetscCall(MpmBlochCreate(&scene->layout, &scene->scheme, &scene->step.drift[0], &s.bloch));
  PetscCall(MpmSmallEigenCreate(s.bloch.size, &s.eigen));
  PetscCall(Scan(&s, PetscMin(c.courant, MOST), phases, &least, &at));
  CHECK(isinf(least), "scheme %d, %s: limit %.9g, but growth at %.9g, phase %.6g", (int)n, options, c.courant, least,
        at);
  if (say)
    printf("%d %s: limit %.9g, %d matrices, %.3g s, doubt at %g, %s %.9g\n", (int)n, options, c.courant,
           (int)c.evaluations, c.seconds, c.doubtful, isinf(least) ? "none grows below" : "GROWS at", least);
  fflush(stdout);
  PetscCall(MpmSmallEigenDestroy(&s.eigen));
  PetscCall(MpmBlochDestroy(&s.bloch));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least Courant number below limit at which an assembled operator is seen to grow by more than twice the tolerance. */
static PetscErrorCode ScanAssembled(const MpmScene *scene, PetscReal limit, PetscInt places, PetscReal *least)
{
  MpmPolynomial polynomial;
  PetscReal    *matrix, *re, *im, growth;
  PetscInt      n, exponent;
  int           failed;

  PetscFunctionBegin;
  *least = INFINITY;
  PetscCall(MpmPolynomialCreate(&scene->layout, &scene->scheme, &scene->step, &polynomial));
  n = polynomial.order;
  PetscCall(PetscMalloc3(n * n, &matrix, n, &re, n, &im));
  for (PetscInt i = 0; i < places && isinf(*least); i++) {
    const PetscReal k       = limit * ((PetscReal)i + MpmHash(5, i)) / (PetscReal)places;
    PetscReal       largest = 0;

    PetscCall(MpmPolynomialMatrix(&polynomial, k, matrix, &exponent));
    PetscCall(MpmDenseEigen(n, matrix, re, im, NULL, &failed));
    for (PetscInt j = 0; j < n && !failed; j++) largest = fmax(largest, hypot(re[j], im[j]));
    growth = MpmGrowthPerStep(largest, exponent, polynomial.period);
    if (failed || !(growth <= 1 + 2 * check_request.tolerance)) *least = k;
  }
  PetscCall(PetscFree3(matrix, re, im));
  PetscCall(MpmPolynomialDestroy(&polynomial));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRandomAssembled(PetscInt n, PetscInt phases, PetscBool say)
{
  char            scheme[256], options[320];
  MpmScene       *scene;
  MpmCriticalCase of;
  MpmCritical     c;
  PetscReal       least;

  PetscFunctionBegin;
  PetscCall(DrawScheme(n, sizeof scheme, scheme));
  if (!scheme[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(options, sizeof options, "%s -jitter 0.5 -cells 5", scheme));
  PetscCall(CheckScene(options, &scene));
  of = MpmCriticalCaseOf(scene, check_request.tolerance);
  PetscCall(MpmCriticalFind(&of, PETSC_TRUE, &c));
  CHECK(c.assembled && c.followed, "scheme %d, %s: not followed", (int)n, options);
  PetscCall(ScanAssembled(scene, PetscMin(c.courant, MOST), PLACES * phases, &least));
  CHECK(isinf(least), "scheme %d, %s: limit %.9g, but growth at %.9g", (int)n, options, c.courant, least);
  if (say)
    printf("%d %s: limit %.9g, %d matrices, %.3g s, doubt at %g, %s %.9g\n", (int)n, options, c.courant,
           (int)c.evaluations, c.seconds, c.doubtful, isinf(least) ? "none grows below" : "GROWS at", least);
  fflush(stdout);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  const PetscInt schemes = argc > 1 ? atoi(argv[1]) : 12, phases = argc > 2 ? atoi(argv[2]) : 40;
  const PetscInt first = argc > 3 ? atoi(argv[3]) : 0;

  PetscFunctionBegin;
  PetscCall(SlepcInitializeNoArguments());
  if (argc <= 1) {
    PetscCall(CheckLimits());
    PetscCall(CheckAsked("-formulation usavg -basis cubic -ppc 3 -offset 0 -drift 1/2 -courant 1.9163", 7e-5));
    PetscCall(CheckAsked("-formulation musl -transfer xpic -basis quadratic -ppc 1 -offset 0 -drift 2/3 -courant 1.809",
                         7e-6));
  }
  for (PetscInt n = first; n < first + schemes; n++) {
    PetscBool turn;

    PetscCall(CheckHasTurn(n, &turn));
    if (!turn) continue;
    PetscCall(CheckRandom(n, phases, argc > 1 ? PETSC_TRUE : PETSC_FALSE));
    PetscCall(CheckRandomAssembled(n, phases, argc > 1 ? PETSC_TRUE : PETSC_FALSE));
  }
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
