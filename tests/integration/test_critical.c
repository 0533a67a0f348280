/*
   The largest stable Courant numbers are compared with those of an independent program, with the closed forms of
   docs/theory.md for the hat at random places, and with the closed form of every scheme. Further cases: walls, an isolated
   particle, a partly filled end cell, drift.
*/
#include "stable_limit.h"
#include "oracle.h"
#include "symbol/predict.h"
#include "scene/layout.h"
#include <slepcsys.h>

/*
   The oracle bisects gas2, elastic and splines on 64 phases to 2e-3. Limits with a closed form are given to four
   digits.
*/
static PetscErrorCode CheckRow(const char row[], const char options[], PetscReal oracle)
{
  const PetscBool coarse = strstr(row, "elastic") || strstr(row, "quadratic") || strstr(row, "cubic") ||
                                   strstr(row, "usf") || strstr(row, "musl")
                               ? PETSC_TRUE
                               : PETSC_FALSE;
  MpmCritical     c;

  PetscFunctionBegin;
  PetscCall(FindLimit(options, PETSC_FALSE, &c));
  CHECK(fabs(c.courant / oracle - 1) <= (coarse ? 4e-3 : 1e-4), "%s: %.8g", row, c.courant);
  CHECK(c.threshold && c.stable_at <= c.unstable_at, "%s: [%g, %g]", row, c.stable_at, c.unstable_at);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* docs/theory.md, section 4: q = mean of xi (1 - xi). */
static PetscErrorCode CheckHat(int n)
{
  const int    ppc    = 1 + n % 4;
  const double offset = MpmHash(11, n);
  char         options[256];
  double       q = 0;
  MpmCritical  c;

  PetscFunctionBegin;
  for (int j = 0; j < ppc; j++) {
    const double xi = (j + offset) / ppc;

    q += xi * (1 - xi) / ppc;
  }
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation usl -ppc %d -offset %.16f", ppc, offset));
  PetscCall(FindLimit(options, PETSC_FALSE, &c));
  CHECK(fabs(c.courant * sqrt(1 + 4 * q) - 1) <= 2e-6, "%s: %.9g", options, c.courant);
  CHECK(fabs(c.closed * sqrt(1 + 4 * q) - 1) <= 1e-9, "%s: closed form %.9g", options, c.closed);
  CHECK_NEAR(c.beta[0], PETSC_PI, 1e-12);
  PetscCall(PetscStrlcat(options, " -transfer pic", sizeof options));
  PetscCall(FindLimit(options, PETSC_FALSE, &c));
  CHECK(fabs(c.courant / sqrt(1 - 2 * q) - 1) <= 2e-6, "%s: %.9g", options, c.courant);
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -ppc %d -offset %.16f",
                          n % 3 ? n % 3 == 1 ? "usf" : "usavg" : "musl", ppc, offset));
  PetscCall(FindLimit(options, PETSC_FALSE, &c));
  CHECK(fabs(c.courant / (q <= 0.125 ? 1 / sqrt(1 - 4 * q) : 4 * sqrt(q)) - 1) <= 2e-6, "%s: %.9g", options, c.courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Compares search and closed form, for every scheme that has a closed form. */
static PetscErrorCode CheckScheme(const MpmFormulation *f, const MpmTransfer *t, const MpmBasis *b, const char rest[])
{
  /* a gradient that is no fit is its own mirror image where the layout is */
  const PetscBool closed =
      t->filter_symbol && !(t->taylor && !b->hat && strstr(rest, "offset")) ? PETSC_TRUE : PETSC_FALSE;
  char        options[256];
  MpmCritical c;

  PetscFunctionBegin;
  if (!t->filter_symbol || (t->affine && f->affine == MPM_NONE)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -transfer %s -basis %s %s", f->name, t->name,
                          b->name, rest));
  PetscCall(FindLimit(options, PETSC_FALSE, &c));
  CHECK(isnan(c.closed) == !closed, "%s: closed form %g", options, c.closed);
  if (isnan(c.closed)) PetscFunctionReturn(PETSC_SUCCESS);
  CHECK(
      c.courant >= c.closed * (1 - 1e-9) && c.courant <= c.closed * (1 + 1e-5) && c.stable_at >= c.closed * (1 - 1e-9),
      "%s: %.9g, closed form %.9g at %g, stable at %.9g", options, c.courant, c.closed, c.closed_beta[0], c.stable_at);
  /* gas with a filter loses stability first at the longest waves, by less than the tolerance; on wide bases even less */
  CHECK(c.stable_at <= c.closed * (1 + 1e-5) ||
            c.stable_at - c.closed < (t->filter ? 0.04 : 2e-3) * (b->nodes > 4 ? 5 : 1),
        "%s: stable at %.9g, closed form %.9g", options, c.stable_at, c.closed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckNumber(const char options[], PetscReal courant, PetscReal tolerance)
{
  MpmCritical c;

  PetscFunctionBegin;
  PetscCall(FindLimit(options, PETSC_FALSE, &c));
  CHECK(fabs(c.courant / courant - 1) <= tolerance, "%s: %.9g, not %.9g", options, c.courant, courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks a lone particle at xi: usl's limit goes to 0 with its distance from a face; those of usf and musl do not. */
static PetscErrorCode CheckIsolated(PetscReal xi)
{
  char        options[256];
  MpmCritical c;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation usl -cells 8 -ppc 1 -fill 3,4 -offset %.16f", xi));
  PetscCall(CheckNumber(options, sqrt(2 * xi * (1 - xi)), 1e-5));
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation usf -cells 8 -ppc 1 -fill 3,4 -offset %.16f", xi));
  PetscCall(FindLimit(options, PETSC_FALSE, &c));
  CHECK(isinf(c.courant), "%s: %g", options, c.courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks a bar whose last cell holds one particle of two, at xi = eps of its cell. The node behind it has only the mass
   eps, and usl's limit goes to 0 with eps. It is the limit of the bar's one stiff mode, for which k^2 (1/eps + ...) <=
   2.
*/
static PetscErrorCode CheckPartlyFilled(void)
{
  MpmCritical near, nearer, musl;

  PetscFunctionBegin;
  PetscCall(FindLimit("-formulation usl -cells 8 -boundary fixed,free -fill 0,6.5 -offset 0.02", PETSC_FALSE, &near));
  PetscCall(
      FindLimit("-formulation usl -cells 8 -boundary fixed,free -fill 0,6.5 -offset 0.005", PETSC_FALSE, &nearer));
  PetscCall(FindLimit("-formulation musl -cells 8 -boundary fixed,free -fill 0,6.5 -offset 0.005", PETSC_FALSE, &musl));
  CHECK_NEAR(near.courant / sqrt(2 * 0.01), 1, 0.05);
  CHECK_NEAR(nearer.courant / sqrt(2 * 0.0025), 1, 0.02);
  CHECK_NEAR(musl.courant, 1.41624, 1e-4);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that the limit found is the one given, and that the scheme is stable at Courant numbers all over the range
   below.
*/
static PetscErrorCode CheckBelow(const char options[], PetscReal limit)
{
  MpmCritical c;
  MpmScene   *scene;
  MpmStep     at;
  MpmSymbol  *symbol;

  PetscFunctionBegin;
  PetscCall(FindLimit(options, PETSC_FALSE, &c));
  CHECK(fabs(c.courant / limit - 1) <= 2e-4, "%s: %.9g, not %.9g", options, c.courant, limit);
  PetscCall(CheckScene(options, &scene));
  at = scene->step;
  for (int n = 1; n <= 100; n++) {
    at.courant = c.courant * MpmHash(21, n);
    PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &at,
                              &(MpmSymbolWish){.phases = {97}, .tolerance = 1e-6}, &symbol));
    CHECK(symbol->growth <= 1 + 1e-6, "%s: growth %.9g at %.9g", options, symbol->growth, at.courant);
    PetscCall(MpmSymbolDestroy(&symbol));
  }
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckDrift(void)
{
  MpmCritical c, half;

  PetscFunctionBegin;
  PetscCall(FindLimit("-drift 1/8 -courant 0.1", PETSC_FALSE, &c)); /* growth is proportional to k */
  CHECK(c.courant > 0 && c.courant < 1e-5 && fabs(c.fading - 1) < 0.01, "gas2: %g, power %g", c.courant, c.fading);
  CHECK(c.asked.verdict == MPM_UNSTABLE && fabs(c.asked.growth - 1.0149) < 1e-4, "gas2: growth %.9g", c.asked.growth);
  PetscCall(FindLimit("-formulation musl -basis quadratic -drift 1/8 -courant 0.2", PETSC_FALSE, &c));
  CHECK(c.courant > 0.01 && c.courant < 0.0125 && !c.threshold && fabs(c.fading - 2) < 0.05, "musl: %g, power %g",
        c.courant, c.fading);
  PetscCall(
      FindLimit("-formulation musl -basis quadratic -drift 1/8 -courant 0.2 -tolerance 4e-6", PETSC_FALSE, &half));
  CHECK(fabs(half.courant / c.courant - 2) < 0.05, "musl: four times the tolerance gives %g times",
        half.courant / c.courant);
  PetscCall(FindLimit("-formulation musl -basis quadratic -courant 0.2", PETSC_FALSE,
                      &half)); /* at rest; moving: with drift */
  CHECK(half.threshold && fabs(half.moving[0] - c.asked.growth) < 1e-9, "musl: %.9g when moving, %.9g", half.moving[0],
        c.asked.growth);
  PetscCall(FindLimit("-drift 1/2 -courant 0.1", PETSC_FALSE, &c)); /* each particle alternates between two places */
  CHECK(c.courant > 1 && c.threshold, "gas2 at 1/2: %g", c.courant);
  /* windows that open and close; an independent program found these limits by fine scans */
  PetscCall(CheckBelow("-basis cubic -drift 1/8", 1.0235));
  PetscCall(CheckBelow("-formulation usavg -basis gimp -drift 1/8", 0.68998));
  PetscCall(CheckBelow("-formulation usavg -basis quadratic -drift 1/8", 1.37901));
  PetscCall(CheckBelow("-basis cubic -drift 1/3", 0.069086)); /* waves of nearly two cells */
  PetscCall(CheckBelow("-formulation musl -transfer xpic -basis gimp -drift 1/8", 0.7718));
  /* the limit of an assembled operator, where the waves are those of the grid */
  PetscCall(FindLimit("-transfer nullspace -pic_filter before -cells 4 -ppc 3 -jitter 0.2 -seed 72 -drift 2/5",
                      PETSC_FALSE, &c));
  CHECK(c.courant < 0.45 && c.courant > 0.43 && c.asked.verdict == MPM_UNSTABLE, "jittered: %g", c.courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Phases are in (-pi, pi], and of a wave and its conjugate the first phase other than 0 and pi is positive. */
static PetscErrorCode CheckPhases(void)
{
  static const char *const options[] = {"-formulation usl -cells %d -boundary fixed,free",
                                        "-formulation musl -cells %d -jitter 0.9 -seed %d",
                                        "-formulation musl -transfer pic -cells %d -jitter 0.9 -drift 1/2 -seed %d",
                                        "-formulation usl -dim 2 -cells 2,%d -ppc 2,1 -jitter 0.9 -seed %d",
                                        "-formulation gas2 -dim 2 -cells 2,%d -ppc 1 -jitter 0.9 -seed %d"};

  PetscFunctionBegin;
  for (size_t o = 0; o < PETSC_STATIC_ARRAY_LENGTH(options); o++)
    for (int cells = o ? 3 : 20; cells < (o ? 7 : 30); cells++) {
      char        text[128];
      PetscReal   sign = 0;
      MpmCritical c;

      (void)snprintf(text, sizeof text, options[o], cells, cells);
      PetscCall(FindLimit(text, PETSC_FALSE, &c));
      for (int a = 0; a < 2 && !isnan(c.beta[a]); a++) {
        CHECK(c.beta[a] > -3.14159 && c.beta[a] <= PETSC_PI, "%s: beta %.17g", text, c.beta[a]);
        if (sign == 0 && fabs(c.beta[a] - PETSC_PI) > 1e-9) sign = c.beta[a];
      }
      CHECK(sign >= 0, "%s: beta %g, %g", text, c.beta[0], c.beta[1]);
      if (o == 0) CHECK_NEAR(c.beta[0], PETSC_PI, 1e-12 + 0.2 * (cells % 2 == 0));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const layouts[] = {"-ppc 2", "-ppc 3 -offset 0.2"};
  PetscMPIInt              size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  (void)argc;
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(OracleCritical(argv[3], 11, CheckRow));
  for (int n = 0; n < 12; n++) PetscCall(CheckHat(n));
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++)
      for (PetscInt b = 0; MpmBases[b]; b++)
        for (PetscInt l = 0; l < 2; l++) /* each scheme on one of them every day, and at night, on two ranks, on both */
          if (size > 1 || (f + t + b) % 2 == l)
            PetscCall(CheckScheme(MpmFormulations[f], MpmTransfers[t], MpmBases[b], layouts[l]));
  /* Bai and Schroeder 2022, as docs/theory.md quotes them */
  PetscCall(CheckNumber("-formulation usl -transfer apic -basis quadratic -ppc 1", 1, 2e-6));
  /* the theory of the two kinds of wall, to the digits given there */
  PetscCall(CheckNumber("-formulation usf -ppc 1 -cells 16 -boundary fixed,free", 2.0097, 2e-5));
  PetscCall(CheckNumber("-formulation usf -ppc 1 -cells 16 -boundary fixed_reaction-free", 1.9366, 2e-5));
  /* between walls and on a random layout of jitter 0 the limit is close to that of all phases */
  PetscCall(CheckNumber("-formulation usl -ppc 2 -cells 32 -boundary fixed,free", 1 / sqrt(1.75), 2e-3));
  for (PetscReal xi = 0.3; xi > 1e-6; xi /= 7) PetscCall(CheckIsolated(xi));
  PetscCall(CheckPartlyFilled());
  PetscCall(CheckDrift());
  PetscCall(CheckPhases());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
