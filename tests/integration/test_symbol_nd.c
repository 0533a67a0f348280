/*
   The symbol in two and three dimensions is compared with the oracle, with the closed forms at random phases of random
   schemes, with the symbol of one dimension at waves along an axis, and with itself without symmetries.
*/
#include "oracle.h"
#include "symbols.h"
#include "waves.h"
#include "base/hash.h"
#include "symbol/bloch_growth.h"
#include "symbol/predict.h"
#include <mpmstab/verdict.h>

/* A number of 0 .. n - 1 that is the same on all ranks. */
static PetscInt Choice(int row, int column, PetscInt n)
{
  return (PetscInt)(n * MpmHash(row + 1000, column));
}

/* The distance of a number from the nearest amplification factor, or from the nearest abs of one. */
static PetscReal Distance(const Wave *w, double complex value, PetscBool of_abs)
{
  PetscReal nearest = INFINITY;

  for (PetscInt i = 0; i < w->eigen.n; i++)
    nearest = fmin(nearest, of_abs ? fabs(cabs(w->eigen.value[i]) - creal(value)) : cabs(w->eigen.value[i] - value));
  return nearest;
}

/* ---- closed forms ---- */

/* The options of scene n of many: any scheme, layout, material and dimension, at rest. */
static PetscErrorCode Random(int n, size_t room, char options[])
{
  static const char *const formulations[] = {"gas1", "gas2", "elastic", "usl", "usf", "musl", "usavg"};
  static const char *const transfers[]    = {
         "flip", "pic", "blend", "xpic -xpic_order 3", "nullspace", "fmpm -xpic_order 3", "apic", "tpic"};
  static const char *const bases[]    = {"linear", "quadratic", "cubic", "gimp"};
  static const char *const poissons[] = {"0", "0.3", "0.49", "0.5"};
  const PetscInt           dim = 1 + Choice(n, 0, 3), formulation = Choice(n, 1, 7);
  const PetscInt           transfer = Choice(n, 2, formulation < 3 ? 6 : 8);
  char                     ppc[32] = "", offset[64] = "", part[32];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++) {
    PetscCall(
        PetscSNPrintf(part, sizeof part, "%s%d", a ? "," : "", 1 + (int)Choice(n, 10 + (int)a, dim == 3 ? 2 : 3)));
    PetscCall(PetscStrlcat(ppc, part, sizeof ppc));
    PetscCall(PetscSNPrintf(part, sizeof part, "%s%.3f", a ? "," : "",
                            n % 3 && transfer < 7 ? 0.001 * (double)Choice(n, 20 + (int)a, 1000)
                            : n % 2               ? 0.5
                                                  : 0));
    PetscCall(PetscStrlcat(offset, part, sizeof offset));
  }
  PetscCall(PetscSNPrintf(options, room,
                          "-dim %d -formulation %s -transfer %s -basis %s -gradient %s -ppc %s -offset %s "
                          "-courant %.4f%s%s%s",
                          (int)dim, formulations[formulation], transfers[transfer], bases[Choice(n, 3, 4)],
                          formulation != 2 && Choice(n, 4, 2) ? "mls" : "basis", ppc, offset,
                          0.05 + 2.5 * MpmHash(n, 5), dim > 1 && formulation > 2 ? " -poisson " : "",
                          dim > 1 && formulation > 2 ? poissons[Choice(n, 6, 4)] : "",
                          formulation < 3 && transfer > 0 && Choice(n, 7, 2) ? " -pic_filter before" : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the one of count numbers that is nearest to a number out of them; returns its distance. */
static PetscReal TakeNearest(double complex number, PetscInt *count, double complex from[])
{
  PetscInt  nearest = 0;
  PetscReal distance;

  for (PetscInt i = 1; i < *count; i++)
    if (cabs(from[i] - number) < cabs(from[nearest] - number)) nearest = i;
  distance      = cabs(from[nearest] - number);
  from[nearest] = from[--*count];
  return distance;
}

/*
   The amplification factors of the nodal operator and of the null space of P2G are those of the full matrix. Rounding
   splits what is defective at a number of the null space.
*/
static PetscErrorCode CheckNodal(int n, PetscInt *checked)
{
  const PetscReal beta[MPM_MAX_DIM] = {0.7 + 0.01 * n, -1.9 + 0.03 * n, 2.6};
  char            options[256];
  double complex  value[MPM_MAX_IMAGES];
  PetscInt        count;
  PetscBool       ok;
  Wave            w;

  PetscFunctionBegin;
  PetscCall(Random(n, sizeof options, options));
  PetscCall(WaveCreate(options, &w));
  if (w.bloch.nodal) {
    const MpmBlochNodal *nodal = w.bloch.nodal;

    ++*checked;
    PetscCall(MpmBlochNodalFactors(w.bloch.nodal, &w.bloch, w.scene->step.courant, beta, value, &ok));
    PetscCall(FactorsAt(&w, w.scene->step.courant, beta, PETSC_FALSE));
    count = w.bloch.size;
    CHECK(ok && count == nodal->plan->nimages + nodal->all, "%s: %d factors", options, (int)count);
    for (PetscInt i = 0; i < nodal->plan->nimages; i++) {
      const PetscBool apart    = cabs(value[i] - 1) > 1e-3 && cabs(value[i] - nodal->factor) > 1e-3;
      const PetscReal distance = TakeNearest(value[i], &count, w.eigen.value);

      CHECK(distance <= (apart ? 1e-11 : 1e-4), "%s: %g %+gi is %.3g off", options, creal(value[i]), cimag(value[i]),
            distance);
    }
    for (PetscInt i = 0; i < nodal->all; i++) {
      const PetscReal distance = TakeNearest(i < nodal->rest ? 1 : nodal->factor, &count, w.eigen.value);

      CHECK(distance <= 1e-4, "%s: a factor of the null space is %.3g off", options, distance);
    }
  }
  PetscCall(WaveDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   With aflip the numbers of the null space are not counted. Growth by the nodal operator is that by the full matrix. Where
   nothing grows, rounding splits the factors of the null space.
*/
static PetscErrorCode CheckUncounted(int n)
{
  static const char *const formulations[]    = {"usl", "usf", "musl", "usavg"};
  static const char *const bases[]           = {"linear", "quadratic", "cubic", "gimp"};
  static const char *const ratios[]          = {"1", "0.9", "0.3"};
  const PetscReal          beta[MPM_MAX_DIM] = {0.7 + 0.01 * n, -1.9 + 0.03 * n, 2.6};
  char                     options[256];
  PetscReal                growth, largest = 0, without_null;
  PetscBool                ok = PETSC_FALSE;
  Wave                     w;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options,
                          "-dim %d -formulation %s -transfer aflip -aflip_ratio %s -basis %s -gradient %s -ppc %s "
                          "-courant %.4f",
                          2 + n % 2, formulations[Choice(n, 1, 4)], ratios[Choice(n, 2, 3)], bases[Choice(n, 3, 4)],
                          Choice(n, 4, 2) ? "mls" : "basis", n % 2 ? "2,2,2" : "2,3", 0.05 + 2.5 * MpmHash(n, 5)));
  PetscCall(WaveCreate(options, &w));
  CHECK(w.bloch.nodal, "%s: no nodal operator", options);
  PetscCall(MpmBlochNodalGrowths(w.bloch.nodal, &w.bloch, w.scene->step.courant, beta, &growth, &without_null, &ok));
  PetscCall(FactorsAt(&w, w.scene->step.courant, beta, PETSC_FALSE));
  for (PetscInt i = 0; i < w.bloch.size; i++) largest = PetscMax(largest, cabs(w.eigen.value[i]));
  CHECK(ok && isnan(without_null), "%s: numbers of a null space that was not counted", options);
  CHECK(fabs(growth - largest) <= (growth > 1.001 ? 1e-10 : 1e-4), "%s: growth %.15g, but %.15g", options, growth,
        largest);
  PetscCall(WaveDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Each problem of the closed form has its amplification factors among those of the symbol. Of a double factor rounding
   makes two, 1e-8 apart.
*/
static PetscErrorCode CheckProblems(int n)
{
  char           options[512];
  Wave           w;
  MpmPredictor   p;
  MpmCellSymbols cell[MPM_MAX_DIM];
  PetscReal      beta[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(Random(n, sizeof options, options));
  PetscCall(WaveCreate(options, &w));
  PetscCall(MpmPredictorCreate(&w.scene->layout, &w.scene->scheme, PETSC_FALSE, NULL, &p));
  CHECK(!p.why_not_corrected, "%s: %s", options, p.why_not_corrected);
  for (int a = 0; a < MPM_MAX_DIM; a++) beta[a] = 2 * PETSC_PI * MpmHash(n, 30 + a);
  PetscCall(FactorsAt(&w, w.scene->step.courant, beta, PETSC_FALSE));
  for (PetscInt i = 0, problems = MpmPredictorSymbols(&p, beta, cell); i < problems; i++) {
    const PetscReal size = w.scene->scheme.formulation->corrected(&cell[i], w.scene->step.courant);

    CHECK(Distance(&w, size, PETSC_TRUE) <= (fabs(size - 1) < 1e-6 ? SPLIT : 1e-10 * fmax(1, size)),
          "%s: problem %d of %d has %.14g, off by %g", options, (int)i, (int)problems, size,
          Distance(&w, size, PETSC_TRUE));
  }
  PetscCall(MpmPredictorDestroy(&p));
  PetscCall(WaveDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The growth without the null space of P2G, and the largest growth of all, are those of the closed form. */
static PetscErrorCode CheckLargest(int n)
{
  char           options[512];
  MpmScene      *scene;
  MpmSymbol     *symbol;
  MpmPredictor   predictor;
  MpmPredictions predictions;
  MpmComparison  comparison;

  PetscFunctionBegin;
  PetscCall(Random(n, sizeof options - 16, options));
  PetscCall(PetscStrlcat(options, " -cells 4", sizeof options));
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, 4, PETSC_FALSE, &symbol));
  PetscCall(MpmPredict(scene, &predictions));
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, PETSC_FALSE, NULL, &predictor));
  PetscCall(MpmPredictCompare(PETSC_COMM_WORLD, &predictor, symbol, &comparison));
  CHECK(comparison.corrected <= SPLIT * symbol->growth, "%s: off by %.3g at beta %g %g %g", options,
        comparison.corrected, comparison.corrected_beta[0], comparison.corrected_beta[1], comparison.corrected_beta[2]);
  CHECK(fabs(PetscMax(1, predictions.corrected) - PetscMax(1, symbol->growth)) <= SPLIT * symbol->growth,
        "%s: %.12g and %.12g", options, predictions.corrected, symbol->growth);
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rounding makes 1e-5 of a triple factor at 1 (m.m is 0, m is not). That is no contradiction of the closed form. */
static PetscErrorCode CheckTriple(const char options[])
{
  MpmComparison comparison;
  PetscReal     growth = NAN;

  PetscFunctionBegin;
  PetscCall(CompareClosedForm(options, 4, &comparison, &growth));
  CHECK(comparison.corrected > 1e-7 && comparison.corrected < 1e-4, "%s: off by %g", options, comparison.corrected);
  CHECK(!MpmPredictDisagrees(&comparison, growth), "%s: disputed", options);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With one particle a cell the velocity of an eigenvector is the nodes' times a number: the polarisation. */
static PetscErrorCode CheckPolarisation(const char options[], const PetscReal beta[])
{
  Wave           w;
  MpmPredictor   p;
  MpmCellSymbols cell[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(WaveCreate(options, &w));
  PetscCall(MpmPredictorCreate(&w.scene->layout, &w.scene->scheme, PETSC_FALSE, NULL, &p));
  PetscCall(FactorsAt(&w, w.scene->step.courant, beta, PETSC_TRUE));
  for (PetscInt i = 0, problems = MpmPredictorSymbols(&p, beta, cell); i < problems; i++) {
    const PetscReal size = w.scene->scheme.formulation->corrected(&cell[i], w.scene->step.courant);
    double complex  vector[MPM_MAX_DIM], overlap = 0;
    PetscReal       norm = 0;
    PetscInt        at   = 0;

    for (PetscInt j = 1; j < w.eigen.n; j++)
      if (fabs(cabs(w.eigen.value[j]) - size) < fabs(cabs(w.eigen.value[at]) - size)) at = j;
    MpmPredictorPolarisation(&p, beta, i, vector);
    for (PetscInt a = 0; a < w.scene->layout.dim; a++) {
      const double complex velocity = w.eigen.right[w.eigen.n * at + a];

      norm = hypot(norm, cabs(velocity));
      overlap += conj(vector[a]) * velocity;
    }
    CHECK(norm > 0.01 && fabs(cabs(overlap) / norm - 1) < 1e-10, "%s: problem %d, %.12g of %.12g", options, (int)i,
          cabs(overlap), norm);
  }
  PetscCall(MpmPredictorDestroy(&p));
  PetscCall(WaveDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least limit of the closed form over phases of a grid: numbers that are known. */
static PetscErrorCode CheckLimit(const char options[], PetscInt phases, PetscReal known)
{
  MpmScene      *scene;
  MpmPredictor   p;
  MpmCellSymbols cell[MPM_MAX_DIM];
  PetscReal      least = INFINITY;
  PetscInt       all   = 1;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, PETSC_FALSE, NULL, &p));
  for (PetscInt a = 0; a < scene->layout.dim; a++) all *= phases;
  for (PetscInt m = 1; m < all; m++) {
    PetscReal beta[MPM_MAX_DIM];
    PetscInt  rest = m, n;

    for (PetscInt a = 0; a < scene->layout.dim; a++, rest /= phases) beta[a] = MpmSymbolPhase(rest % phases, phases);
    n = MpmPredictorSymbols(&p, beta, cell);
    for (PetscInt i = 0; i < n; i++) least = fmin(least, scene->scheme.formulation->limit(&cell[i]));
  }
  CHECK(fabs(least - known) < 1e-9, "%s: %.12g, not %.12g", options, least, known);
  PetscCall(MpmPredictorDestroy(&p));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckLimits(void)
{
  char options[256];

  PetscFunctionBegin;
  for (int dim = 1; dim <= 3; dim++) {
    for (int n = 0; n < 3 && (dim > 1 || n == 0); n++) {
      PetscCall(PetscSNPrintf(options, sizeof options, "-dim %d -formulation usl%s", dim,
                              dim == 1 ? ""
                              : n == 0 ? " -poisson 0"
                              : n == 1 ? " -poisson 0.3"
                                       : " -poisson 0.49"));
      PetscCall(CheckLimit(options, 8, 2 / sqrt(7)));
    }
    PetscCall(PetscSNPrintf(options, sizeof options, "-dim %d -formulation usl -ppc 1 -offset 0", dim));
    PetscCall(CheckLimit(options, 8, 1 / sqrt(dim)));
    PetscCall(PetscSNPrintf(options, sizeof options,
                            "-dim %d -formulation usl -ppc 1 -transfer apic -gradient mls -basis quadratic", dim));
    PetscCall(CheckLimit(options, 8, 1));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- waves along an axis ---- */

/*
   The amplification factors of one dimension, at Courant number k for P waves and k sqrt(mu) for S waves, are among
   those of a wave along an axis. turns: the periods of the drift along the axis in that of all drifts.
*/
static PetscErrorCode CheckAxis(const char scheme[], const char line[], const char space[], int turns, int axis,
                                PetscReal shear)
{
  char      options[512];
  Wave      one, many;
  PetscReal beta[MPM_MAX_DIM] = {0};

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "%s %s", scheme, line));
  PetscCall(WaveCreate(options, &one));
  PetscCall(PetscSNPrintf(options, sizeof options, "%s %s", scheme, space));
  PetscCall(WaveCreate(options, &many));
  CHECK(many.bloch.period == turns * one.bloch.period, "%s: period %d", options, (int)many.bloch.period);
  for (int m = 1; m < 8; m++) {
    beta[axis] = 0.8 * m - 2.9;
    PetscCall(FactorsAt(&many, many.scene->step.courant, beta, PETSC_FALSE));
    for (int wave = 0; wave < (shear > 0 ? 2 : 1); wave++) {
      PetscCall(FactorsAt(&one, many.scene->step.courant * (wave ? shear : 1), &beta[axis], PETSC_FALSE));
      for (PetscInt i = 0; i < one.eigen.n; i++) {
        const double complex factor = cpow(one.eigen.value[i], turns);

        CHECK(Distance(&many, factor, PETSC_FALSE) <= (cabs(factor - 1) < 1e-6 ? 1e-6 : 1e-9),
              "%s: wave %d at %g: %.12g %.12g off by %g", options, wave, beta[axis], creal(factor), cimag(factor),
              Distance(&many, factor, PETSC_FALSE));
      }
    }
  }
  PetscCall(WaveDestroy(&one));
  PetscCall(WaveDestroy(&many));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- symmetries ---- */

/* Growth and amplification factors of every phase are those of the phase itself, not only of its class. */
static PetscErrorCode CheckClasses(const char options[], PetscInt cells, PetscInt classes)
{
  Wave       w;
  MpmSymbol *symbol, *alone;
  PetscReal *factors, *growth, beta[MPM_MAX_DIM];
  PetscBool  conjugate;

  PetscFunctionBegin;
  PetscCall(WaveCreate(options, &w));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, w.scene, cells, PETSC_TRUE, &symbol));
  PetscCall(CheckSymbol(PETSC_COMM_SELF, w.scene, cells, PETSC_FALSE, &alone));
  CHECK(symbol->classes == classes, "%s: %d classes, not %d", options, (int)symbol->classes, (int)classes);
  CHECK(symbol->growth == alone->growth && symbol->beta_at_max[1] == alone->beta_at_max[1], "%s: %.17g and %.17g",
        options, symbol->growth, alone->growth);
  PetscCall(MpmSymbolGatherFactors(PETSC_COMM_WORLD, symbol, 0, &factors));
  PetscCall(MpmSymbolGather(PETSC_COMM_SELF, alone, alone->per_phase, &growth));
  for (PetscInt m = 0; m < symbol->all; m++) {
    PetscReal largest = 0;

    MpmSymbolBeta(symbol, m, beta);
    PetscCall(FactorsAt(&w, w.scene->step.courant, beta, PETSC_FALSE));
    for (PetscInt i = 0; i < w.eigen.n; i++) {
      const PetscReal     *factor = factors + 2 * (symbol->size * m + i);
      const double complex value  = CMPLX(factor[0], factor[1]);

      largest = fmax(largest, cabs(w.eigen.value[i]));
      CHECK(Distance(&w, value, PETSC_FALSE) <= (cabs(value - 1) < 1e-4 ? 1e-5 : 1e-9), "%s: phase %d off by %g",
            options, (int)m, Distance(&w, value, PETSC_FALSE));
    }
    CHECK_NEAR(pow(largest, 1.0 / symbol->period), growth[MpmSymbolClass(symbol, m, &conjugate)], SPLIT);
  }
  PetscCall(PetscFree(factors));
  PetscCall(PetscFree(growth));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSymbolDestroy(&alone));
  PetscCall(WaveDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckSymmetries(void)
{
  PetscFunctionBegin;
  /* the wedge 0 <= beta_2 <= beta_1 <= pi; exchange and negation; reflection of one direction; negation alone */
  PetscCall(CheckClasses("-dim 2 -formulation usl -poisson 0.3 -courant 1.1", 6, 10));
  PetscCall(CheckClasses("-dim 2 -formulation usl -poisson 0.3 -courant 1.1 -offset 0.3", 6, 13));
  PetscCall(CheckClasses("-dim 2 -formulation musl -courant 0.5 -drift 1/4,0", 6, 16));
  PetscCall(CheckClasses("-dim 2 -formulation musl -courant 0.5 -drift 1/4,1/4", 5, 9));
  PetscCall(CheckClasses("-dim 2 -formulation gas2 -courant 0.5 -ppc 1,2 -offset 0,0.2", 6, 20));
  PetscCall(CheckClasses("-dim 2 -formulation usl -transfer apic -courant 0.9 -ppc 1 -offset 0.5,0.2", 6, 16));
  PetscCall(CheckClasses("-dim 3 -formulation usl -courant 0.9 -ppc 1 -poisson 0.2", 4, 10));
  PetscCall(CheckClasses("-dim 3 -formulation elastic -courant 0.9 -ppc 1 -offset 0.5,0.1,0.5", 4, 18));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- mirror images ---- */

/* Two scenes have the same growth. */
static PetscErrorCode CheckSame(const char a[], const char b[])
{
  const char *const options[2] = {a, b};
  PetscReal         growth[2];

  PetscFunctionBegin;
  for (int i = 0; i < 2; i++) {
    MpmScene  *scene;
    MpmSymbol *symbol;

    PetscCall(CheckScene(options[i], &scene));
    PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, 6, PETSC_FALSE, &symbol));
    growth[i] = symbol->growth;
    PetscCall(MpmSymbolDestroy(&symbol));
    PetscCall(MpmSceneDestroy(&scene));
  }
  CHECK(growth[0] > 1.001 && fabs(growth[0] - growth[1]) < 1e-10, "%s: %.14g, but %s: %.14g", a, growth[0], b,
        growth[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscInt        checked           = 0;
  const PetscReal beta[MPM_MAX_DIM] = {0.7, 1.9, 2.6}, shear = sqrt((1 - 2 * 0.3) / (2 * (1 - 0.3)));

  PetscFunctionBegin;
  (void)argc;
  PetscCall(OracleGrowthNd(argv[1], 183, CheckSymbolRow));
  PetscCall(
      CheckSymbolRow("gas with particles that nodes do not see", "-dim 2 -formulation gas2 -courant 0.9 -cells 8", 1));
  for (int n = 0; n < 100; n++) PetscCall(CheckNodal(n, &checked));
  CHECK(checked >= 40, "%d nodal operators", (int)checked);
  for (int n = 0; n < 40; n++) PetscCall(CheckUncounted(n));
  for (int n = 0; n < 300; n++) PetscCall(CheckProblems(n));
  for (int n = 0; n < 60; n++) PetscCall(CheckLargest(n));
  PetscCall(CheckTriple("-dim 2 -formulation gas1 -ppc 1 -offset 0 -courant 0.1085"));
  PetscCall(CheckPolarisation("-dim 2 -formulation usl -ppc 1 -poisson 0.3 -courant 0.4", beta));
  PetscCall(
      CheckPolarisation("-dim 3 -formulation usl -ppc 1 -poisson 0.1 -courant 0.9 -basis quadratic -offset 0.1", beta));
  PetscCall(CheckLimits());
  PetscCall(
      CheckAxis("-formulation musl -courant 0.7", "-drift 1/8", "-dim 2 -poisson 0.3 -drift 1/8,1/4", 1, 0, shear));
  PetscCall(CheckAxis("-formulation usl -transfer apic -basis quadratic -gradient mls -courant 0.9", "-drift 1/3",
                      "-dim 2 -poisson 0.3 -drift 1/2,1/3 -ppc 1,2", 2, 1, shear));
  PetscCall(CheckAxis("-formulation usl -basis gimp -courant 1.1", "-offset 0.3 -ppc 1",
                      "-dim 3 -poisson 0.3 -offset 0.1,0.7,0.3 -ppc 2,1,1", 1, 2, shear));
  PetscCall(CheckAxis("-formulation gas2 -courant 0.6 -basis quadratic", "-drift 1/4", "-dim 2 -drift 1/4,0", 1, 0, 0));
  PetscCall(CheckAxis("-formulation elastic -transfer pic -courant 0.6", "-ppc 1", "-dim 3 -ppc 1,2,1", 1, 0, 0));
  PetscCall(CheckSymmetries());
  PetscCall(CheckSame("-dim 2 -formulation musl -courant 0.5 -drift 1/8,1/3 -ppc 1,2",
                      "-dim 2 -formulation musl -courant 0.5 -drift 1/3,1/8 -ppc 2,1"));
  PetscCall(CheckSame("-dim 2 -formulation gas2 -courant 0.5 -drift 1/8,1/4 -basis quadratic -ppc 1 -offset 0.2,0.5",
                      "-dim 2 -formulation gas2 -courant 0.5 -drift -1/8,1/4 -basis quadratic -ppc 1 -offset 0.8,0.5"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
