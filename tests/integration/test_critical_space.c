/*
   The largest stable Courant numbers in two and three dimensions: those of an independent program; numbers that are
   known exactly; limits never above those of the waves along the axes, for random schemes; the symbol just below and
   just above; drift; and the bound of MLS-MPM that holds for every layout.
*/
#include "stable_limit.h"
#include "oracle.h"
#include "base/hash.h"
#include "symbol/predict.h"
#include <mpmstab/operator.h>
#include "linalg/dense.h"
#include <slepcsys.h>

/* The independent program gives its limits with nine digits. Where one is 0 there is growth at every Courant number. */
static PetscErrorCode CheckRow(const char row[], const char options[], PetscReal oracle)
{
  const PetscBool line = strstr(options, "-dim 1") ? PETSC_TRUE : PETSC_FALSE;
  MpmCritical     c;

  PetscFunctionBegin;
  PetscCall(FindLimit(options, PETSC_TRUE, &c));
  CHECK(fabs(c.courant - oracle) <= (line ? 3e-6 : 1e-8) * oracle, "%s: %.10g", row, c.courant);
  CHECK(fabs(c.closed - oracle) <= 1e-8 * oracle, "%s: closed form %.10g", row, c.closed);
  CHECK(c.stable_at < c.unstable_at && c.threshold == (oracle > 0), "%s: [%g, %g]", row, c.stable_at, c.unstable_at);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckNumber(const char options[], PetscReal courant, MpmWaveType wave)
{
  MpmCritical c;

  PetscFunctionBegin;
  PetscCall(FindLimit(options, PETSC_TRUE, &c));
  CHECK(fabs(c.courant / courant - 1) <= 1e-6, "%s: %.9g, not %.9g", options, c.courant, courant);
  CHECK(c.wave == wave, "%s: a wave of type %s", options, MpmWaveTypeNames[c.wave]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckKnown(void)
{
  char options[256];

  PetscFunctionBegin;
  for (int dim = 2; dim <= 3; dim++)
    for (int n = 0; n < 3; n++) {
      PetscCall(PetscSNPrintf(options, sizeof options, "-dim %d -formulation usl -poisson %.17g", dim,
                              n == 0   ? 0.1
                              : n == 1 ? 0.3
                                       : 0.5));
      PetscCall(CheckNumber(options, 1 / sqrt(1.75), MPM_WAVE_P));
    }
  PetscCall(
      CheckNumber("-dim 2 -formulation usl -transfer apic -gradient mls -basis quadratic", 1.30637344, MPM_WAVE_P));
  PetscCall(CheckNumber("-dim 3 -formulation usl -transfer apic -gradient mls -basis quadratic -ppc 1", 1, MPM_WAVE_P));
  PetscCall(CheckNumber("-dim 2 -formulation usl -transfer apic -basis quadratic", 1.58583609, MPM_WAVE_P));
  PetscCall(CheckNumber("-dim 3 -formulation usl -transfer apic -basis quadratic", 1.56118171, MPM_WAVE_P));
  PetscCall(CheckNumber("-dim 2 -formulation usl -ppc 1 -offset 0", M_SQRT1_2, MPM_WAVE_P));
  PetscCall(CheckNumber("-dim 3 -formulation usl -ppc 1 -offset 0", 1 / sqrt(3), MPM_WAVE_P));
  /* particles near nodes: offset (1 - 1 / sqrt 2) / 2 in one direction, and least over it in three */
  PetscCall(CheckNumber("-dim 2 -formulation usl -ppc 1 -offset 0,0.14644660940672624", 2. / 3, MPM_WAVE_P));
  PetscCall(CheckNumber("-dim 3 -formulation usl -ppc 1 -offset 0,0,0.06698729810778065", 1 / sqrt(3.125), MPM_WAVE_P));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth by the symbol, of a grid of phases, at a Courant number. */
static PetscErrorCode GrowthAt(const char options[], PetscReal courant, PetscReal *growth)
{
  char       more[512];
  MpmScene  *scene;
  MpmSymbol *symbol;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(more, sizeof more, "%s -courant %.17g", options, courant));
  PetscCall(CheckScene(more, &scene));
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step,
                            &(MpmSymbolWish){.phases = {24, 24, 24}, .tolerance = 1e-6}, &symbol));
  *growth = symbol->growth;
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A random scheme in two dimensions has no larger limit than each of its one-dimensional ones, and nothing grows just
   below it. The search itself has compared growth on both sides of it (disputed).
*/
static PetscErrorCode CheckRandom(int n)
{
  static const char *const formulations[] = {"gas2", "elastic", "usl", "usf", "musl", "usavg"};
  static const char *const transfers[]    = {"flip", "pic", "blend", "apic", "xpic"};
  static const char *const bases[]        = {"linear", "quadratic", "cubic", "gimp"};
  const int                f = (int)(6 * MpmHash(31, n)), t = (int)((f < 2 ? 3 : 5) * MpmHash(32, n));
  const PetscReal          offset[2] = {MpmHash(34, n), MpmHash(35, n)};
  const int                ppc[2]    = {1 + (int)(2 * MpmHash(36, n)), 1 + (int)(2 * MpmHash(37, n))};
  char                     scheme[256], options[512];
  MpmCritical              c, along;
  PetscReal                growth = NAN;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(scheme, sizeof scheme, "-formulation %s -transfer %s -basis %s -gradient %s", formulations[f],
                          transfers[t], bases[(int)(4 * MpmHash(33, n))],
                          f != 1 && MpmHash(38, n) < 0.5 ? "mls" : "basis"));
  PetscCall(PetscSNPrintf(options, sizeof options, "%s -dim 2 -ppc %d,%d -offset %.15f,%.15f", scheme, ppc[0], ppc[1],
                          offset[0], offset[1]));
  if (f >= 2) PetscCall(PetscStrlcat(options, n % 2 ? " -poisson 0.45" : " -poisson 0.2", sizeof options));
  PetscCall(FindLimit(options, PETSC_TRUE, &c));
  CHECK(!c.disputed && c.courant >= 0, "%s: %g", options, c.courant);
  for (int a = 0; a < 2; a++) {
    char line[512];

    PetscCall(PetscSNPrintf(line, sizeof line, "%s -ppc %d -offset %.15f", scheme, ppc[a], offset[a]));
    PetscCall(FindLimit(line, PETSC_TRUE, &along));
    CHECK(c.closed <= along.closed * (1 + 1e-7), "%s: %.10g, along an axis %.10g", options, c.closed, along.closed);
  }
  if (!(c.courant > 0) || isinf(c.courant)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GrowthAt(options, c.courant * (1 - 1e-7), &growth));
  CHECK(growth <= 1 + 1e-6, "%s: growth %.9g below %.9g", options, growth, c.courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A reflection of y takes the offset to 1 - offset. The limits are the same, and the phase of y has the other sign. */
static PetscErrorCode CheckReflected(int n)
{
  static const char *const schemes[] = {"usl -basis quadratic -ppc 1 -poisson 0.4",
                                        "musl -basis cubic -ppc 1 -poisson 0.2",
                                        "usf -transfer pic -basis gimp -ppc 2,1 -poisson 0.1",
                                        "usl -transfer apic -gradient mls -basis quadratic -ppc 1 -poisson 0.45"};
  const PetscReal          offset[2] = {0.1 + 0.3 * MpmHash(41, n), 0.1 + 0.3 * MpmHash(42, n)};
  const char *const        scheme    = schemes[n % 4];
  char                     options[256];
  MpmCritical              c, reflected;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-dim 2 -formulation %s -offset %.15f,%.15f", scheme, offset[0],
                          offset[1]));
  PetscCall(FindLimit(options, PETSC_TRUE, &c));
  PetscCall(PetscSNPrintf(options, sizeof options, "-dim 2 -formulation %s -offset %.15f,%.15f", scheme, offset[0],
                          1 - offset[1]));
  PetscCall(FindLimit(options, PETSC_TRUE, &reflected));
  CHECK(fabs(c.courant / reflected.courant - 1) < 1e-9, "%s: %.12g, reflected %.12g", options, c.courant,
        reflected.courant);
  CHECK(!c.disputed && !reflected.disputed, "%s: disputed", options);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Jittered layouts between free ends or without ends do not grow up to the bound of MLS-MPM. Of usl on quadratic
   splines with nu = 0.3 it is k = sqrt(0.7).
*/
static PetscErrorCode CheckBound(const char formulation[], const char rest[], int seed)
{
  char         options[512];
  MpmScene    *scene;
  MpmCritical  c;
  MpmOperator *op;
  PetscReal    value[2];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options,
                          "-dim 2 -cells 3 -ppc 2 -formulation %s -transfer apic -gradient mls -basis quadratic "
                          "-jitter 1 -seed %d %s",
                          formulation, seed, rest));
  PetscCall(CheckScene(options, &scene));
  scene->step.courant = sqrt(0.7) * (1 - 1e-9);
  PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmDenseLargest(op->balanced, value));
  CHECK(hypot(value[0], value[1]) <= 1 + 1e-7, "%s: growth %.12g at the bound", options, hypot(value[0], value[1]));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(PetscSNPrintf(options, sizeof options,
                          "-dim 2 -formulation %s -transfer apic -gradient mls -basis quadratic", formulation));
  if (seed > 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FindLimit(options, PETSC_TRUE, &c));
  CHECK_NEAR(c.bound, sqrt(0.7), 1e-12);
  CHECK(c.bound < c.courant, "%s: bound %g, limit %g", options, c.bound, c.courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A lone particle attains the bound wherever it is; of gimp the least D is on a node, 1 / (4 ppc). */
static PetscErrorCode CheckLone(void)
{
  static const char *const lone[] = {"usl -basis quadratic -cells 4 -ppc 1 -fill 1,2 -offset 0.2,0.4",
                                     "usf -basis quadratic -cells 4 -ppc 1 -fill 1,2 -boundary free -offset 0.2,0.4",
                                     "usl -basis gimp -cells 5 -ppc 2 -fill 2,2.5 -offset 0"};
  char                     options[256];
  MpmCritical              c;

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(lone); i++) {
    PetscCall(PetscSNPrintf(options, sizeof options, "-dim 2 -transfer apic -gradient mls -formulation %s", lone[i]));
    PetscCall(FindLimit(options, PETSC_TRUE, &c));
    CHECK_NEAR(c.bound, i == 2 ? sqrt(0.35) : sqrt(0.7), 1e-12);
    CHECK(c.assembled && fabs(c.courant / c.bound - 1) < 2e-6, "%s: %.9g, bound %.9g", options, c.courant, c.bound);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckBounds(void)
{
  static const char *const none[] = {"-dim 2 -formulation usl -transfer apic -gradient mls",
                                     "-dim 2 -formulation usl -gradient mls -basis quadratic",
                                     "-dim 2 -formulation usl -transfer apic -basis quadratic"};
  MpmCritical              c;

  PetscFunctionBegin;
  for (int seed = 1; seed <= 4; seed++) {
    PetscCall(CheckBound("usl", "", seed));
    PetscCall(CheckBound("usf", "-boundary free,free", seed));
    PetscCall(CheckBound("musl", "", seed));
    PetscCall(CheckBound("usavg", "-boundary free,free", seed));
  }
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(none); i++) {
    PetscCall(FindLimit(none[i], PETSC_TRUE, &c));
    CHECK(c.bound == 0, "%s: bound %g", none[i], c.bound);
  }
  PetscCall(FindLimit("-formulation gas1 -transfer xpic -dim 2", PETSC_TRUE, &c)); /* long waves: 0 */
  CHECK(c.courant == 0 && c.closed == 0 && c.bound == 0, "gas1 xpic: %g", c.courant);
  PetscCall(FindLimit("-formulation usl -transfer apic -gradient mls -basis cubic", PETSC_TRUE, &c));
  CHECK_NEAR(c.bound, 2 / sqrt(3), 1e-12);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   By all eigenvalues. A layout of jitter next to 0 has the waves of the grid, of which those of two cells limit. Between
   walls across x the motions that are the same at all y are those of a bar.
*/
static PetscErrorCode CheckAssembled(void)
{
  MpmCritical c, bar;

  PetscFunctionBegin;
  PetscCall(FindLimit("-dim 2 -cells 4 -formulation usl -jitter 1e-9", PETSC_TRUE, &c));
  CHECK(c.assembled && fabs(c.courant * sqrt(1.75) - 1) < 1e-5, "jitter 1e-9: %.9g", c.courant);
  CHECK(c.wave == MPM_WAVE_P && fabs(c.beta[0] + c.beta[1] - PETSC_PI) < 1e-9, "jitter 1e-9: %g, %g, type %s",
        c.beta[0], c.beta[1], MpmWaveTypeNames[c.wave]);
  PetscCall(FindLimit("-dim 2 -cells 4,2 -formulation usl -boundary fixed-free,periodic", PETSC_TRUE, &c));
  PetscCall(FindLimit("-cells 4 -formulation usl -boundary fixed,free", PETSC_TRUE, &bar));
  CHECK(c.courant <= bar.courant * (1 + 1e-6) && c.courant > 0.75, "walls: %.9g, a bar %.9g", c.courant, bar.courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Under drift the waves along an axis are those of one dimension, and oblique ones may grow below their limit. */
static PetscErrorCode CheckDrift(void)
{
  MpmCritical c, along;

  PetscFunctionBegin;
  PetscCall(FindLimit("-formulation usl -drift 1/2", PETSC_TRUE, &along));
  PetscCall(FindLimit("-dim 2 -formulation usl -drift 1/2,0", PETSC_TRUE, &c));
  CHECK(c.courant <= along.courant * (1 + 1e-9), "usl: %.9g, along x %.9g", c.courant, along.courant);
  /* the wave along y has the limit of the one along x */
  PetscCall(FindLimit("-dim 2 -formulation musl -basis quadratic -ppc 1 -drift 0,1/8", PETSC_TRUE, &c));
  PetscCall(FindLimit("-formulation musl -basis quadratic -ppc 1 -drift 1/8", PETSC_TRUE, &along));
  CHECK(fabs(c.courant / along.courant - 1) < 1e-5 && c.beta[0] == 0 && c.beta[1] != 0,
        "musl: %.9g at %g, %g, 1-D %.9g", c.courant, c.beta[0], c.beta[1], along.courant);
  /* theory: ppc 1, (1/2, 1/2), k = 0.6: 1.371 against 1.117 in one dimension */
  PetscCall(FindLimit("-dim 2 -formulation usl -transfer apic -ppc 1 -drift 1/2 -courant 0.6", PETSC_FALSE, &c));
  CHECK(fabs(c.asked.growth - 1.371) < 1e-3 && c.asked.verdict == MPM_UNSTABLE, "apic: growth %.9g", c.asked.growth);
  CHECK(c.courant < 0.6, "apic: %.9g", c.courant);
  /* gas2 on splines grows obliquely where it does not in one dimension */
  PetscCall(FindLimit("-dim 2 -basis quadratic -drift 1/8 -courant 0.5", PETSC_FALSE, &c));
  CHECK(c.asked.growth > 1.000314 && c.asked.growth < 1.00032, "gas2: growth %.9g", c.asked.growth);
  CHECK(c.courant < 0.5 && c.beta[0] != 0 && c.beta[1] != 0, "gas2: %.9g at %g, %g", c.courant, c.beta[0], c.beta[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(OracleCriticalSpace(argv[1], 36, CheckRow));
  PetscCall(CheckKnown());
  for (int n = 0; n < 20; n++) {
    PetscBool turn;

    PetscCall(CheckHasTurn(n, &turn));
    if (turn) PetscCall(CheckRandom(n));
    if (turn && n < 8) PetscCall(CheckReflected(n));
  }
  PetscCall(CheckBounds());
  PetscCall(CheckLone());
  PetscCall(CheckAssembled());
  PetscCall(CheckDrift());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
