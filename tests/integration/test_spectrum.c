/*
   Spectra: they are compared with the oracle's growth and radii, with the symbol as a set, the three ways of solving
   with one another, and the null space with its dimension. Verdicts that cannot be known must be undecided.
*/
#include "oracle.h"
#include "spectra.h"
#include "symbols.h"
#include "scene/layout.h"

/* Checks that each amplification factor of the symbol is an eigenvalue too, so that the sets are the same. */
static PetscErrorCode CheckSets(const char row[], const MpmSpectrum *s)
{
  PetscReal *factors, farthest = 0;

  PetscFunctionBegin;
  PetscCall(MpmSymbolGatherFactors(PETSC_COMM_WORLD, s->symbol, s->op->exponent, &factors));
  for (PetscInt i = 0; i < s->symbol->size * s->symbol->all; i++) {
    PetscReal nearest = PETSC_MAX_REAL;

    for (PetscInt j = 0; j < s->eigen->n; j++)
      nearest = PetscMin(nearest, hypot(factors[2 * i] - s->eigen->re[j], factors[2 * i + 1] - s->eigen->im[j]));
    farthest = PetscMax(farthest, nearest);
  }
  PetscCall(PetscFree(factors));
  CHECK(s->symbol_mismatch <= 1e-6 && farthest <= 1e-6, "%s: sets differ by %.3g and %.3g", row, s->symbol_mismatch,
        farthest);
  CHECK(s->symbol->size * s->symbol->all == s->eigen->n, "%s: %d factors, %d eigenvalues", row,
        (int)(s->symbol->size * s->symbol->all), (int)s->eigen->n);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckGrowth(const char row[], const char options[], PetscReal oracle)
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(SpectrumOf(options, &scene, &s));
  CHECK(s->eigen->complete, "%s: %d eigenvalues of %d", row, (int)s->eigen->n, (int)s->op->order);
  CHECK(fabs(s->growth - oracle) <= 1e-5, "%s: %.9g", row, s->growth);
  CHECK(s->finding.verdict == (oracle > 1 + 1e-6 ? MPM_UNSTABLE : MPM_STABLE), "%s: %s", row,
        MpmVerdictNames[s->finding.verdict]);
  CHECK(s->max_residual <= 1e-12, "%s: residual %.3g", row, s->max_residual);
  PetscCall(CheckSets(row, s));
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRadius(const char row[], const char options[], PetscReal oracle)
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(SpectrumOf(options, &scene, &s));
  CHECK(!s->symbol && s->eigen->complete, "%s: %d eigenvalues of %d", row, (int)s->eigen->n, (int)s->op->order);
  CHECK(fabs(s->radius - oracle) <= 1e-7, "%s: %.9g", row, s->radius);
  CHECK(s->finding.verdict == (oracle > 1 + 1e-6 ? MPM_UNSTABLE : MPM_STABLE), "%s: %s", row,
        MpmVerdictNames[s->finding.verdict]);
  if (oracle > 1 + 1e-6) CHECK(s->condition >= 1 && s->condition < 100, "%s: condition %g", row, s->condition);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* docs/theory.md, section 3: 16 cells, particles at rest around the middle. */
static PetscErrorCode CheckNullSpace(const char formulation[], int ppc, PetscInt dimension)
{
  char         options[128];
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -cells 16 -ppc %d", formulation, ppc));
  PetscCall(SpectrumOf(options, &scene, &s));
  CHECK(s->nullity == 2 * dimension, "%s: %d unseen", options, (int)s->nullity);
  CHECK(s->at_one >= s->nullity + 2, "%s: %d eigenvalues at 1", options, (int)s->at_one); /* two constants */
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks the solvers for large orders on an order at which all eigenvalues are known. */
static PetscErrorCode CheckMethods(const char options[], MpmEigenMethod method)
{
  MpmScene    *scene;
  MpmSpectrum *s;
  MpmEigen    *few;
  PetscReal    condition = 0;

  PetscFunctionBegin;
  PetscCall(SpectrumOf(options, &scene, &s));
  PetscCall(MpmEigenSolve(s->op->A, NULL, method, s->target, &few));
  CHECK(few->converged && few->n >= 1 && !few->complete, "%s: %s, %d listed", options, few->solver, (int)few->n);
  for (PetscInt j = 0; j < few->n; j++) {
    PetscReal nearest = PETSC_MAX_REAL;

    for (PetscInt i = 0; i < s->eigen->n; i++)
      nearest = PetscMin(nearest, hypot(few->re[j] - s->eigen->re[i], few->im[j] - s->eigen->im[i]));
    CHECK(few->residual[j] <= 1e-7, "%s: residual %.3g", options, few->residual[j]);
    CHECK(nearest <= 1e-6, "%s: %.12g + %.12gi is %.3g off", options, few->re[j], few->im[j], nearest);
  }
  CHECK_NEAR(hypot(few->re[0], few->im[0]), s->radius, 1e-8);
  if (!s->symbol) {
    PetscCall(MpmEigenCondition(few, 0, &condition));
    CHECK_NEAR(condition, s->condition, 1e-4 * s->condition);
  }
  PetscCall(MpmEigenDestroy(&few));
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks that the eigenvalue near a target is the symbol's. The option may change how it is sought. */
static PetscErrorCode CheckFactors(const char options[], const char option[])
{
  MpmScene    *scene;
  MpmOperator *op;
  MpmSymbol   *symbol;
  MpmEigen    *few;
  PetscReal    target[2], found;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, scene->layout.grid[0].cells, PETSC_TRUE, &symbol));
  PetscCall(MpmSymbolTarget(PETSC_COMM_WORLD, symbol, op->exponent, target));
  for (int part = 0; part < 2; part++) target[part] *= 1 + 1e-10;
  PetscCall(PetscOptionsInsertString(NULL, option));
  PetscCall(MpmEigenSolve(op->A, NULL, MPM_EIGEN_TARGET, target, &few));
  PetscCall(PetscOptionsClear(NULL));
  CHECK(few->converged && few->n >= 1 && strstr(few->solver, "(LU: mumps)"), "%s %s: %s", options, option, few->solver);
  found = few->n ? hypot(few->re[0] - target[0], fabs(few->im[0]) - fabs(target[1])) : NAN;
  CHECK(found <= 1e-9, "%s %s: found %.3g away", options, option, found);
  for (PetscInt j = 0; j < few->n; j++)
    CHECK(few->residual[j] <= 1e-9, "%s %s: residual %.3g", options, option, few->residual[j]);
  PetscCall(MpmEigenDestroy(&few));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Above the order of dense solves a jittered layout has no symbol to compare with; the march must grow at the same
   rate.
*/
static PetscErrorCode CheckLargest(void)
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(CheckScene("-cells 1100 -courant 0.5 -jitter 0.4 -nodal false", &scene));
  PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &s));
  CHECK(s->eigen->largest && !s->eigen->complete && s->finding.verdict == MPM_UNSTABLE, "%s: %s", s->eigen->solver,
        MpmVerdictNames[s->finding.verdict]);
  CHECK(fabs(log(s->run->growth.per_step) / log(s->growth) - 1) <= 0.02, "measured %.9g, spectrum %.9g",
        s->run->growth.per_step, s->growth);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A solver that may not converge, or is asked for something else, must leave the verdict open. */
static PetscErrorCode CheckUndecided(const char options[], const char solver[])
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  check_request.measure = PETSC_FALSE;
  check_request.nodal   = PETSC_FALSE; /* the nodes' operator is small enough for all eigenvalues */
  PetscCall(PetscOptionsInsertString(NULL, solver));
  PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &s));
  PetscCall(PetscOptionsClear(NULL));
  for (PetscInt j = 0; j < s->eigen->n; j++)
    CHECK(s->eigen->residual[j] <= 1e-7, "%s: lists a residual of %.3g", options, s->eigen->residual[j]);
  CHECK(!s->eigen->largest && s->finding.verdict == MPM_UNDECIDED, "%s: %s", options,
        MpmVerdictNames[s->finding.verdict]);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void CheckVerdict(PetscReal growth, PetscReal uncertainty, PetscReal defective_error, MpmVerdict verdict,
                         const char what[])
{
  const MpmFinding finding = {
      .growth = growth, .tolerance = 1e-6, .uncertainty = uncertainty, .defective_error = defective_error};

  CHECK(MpmVerdictOf(&finding) == verdict, "%s: %s", what, MpmVerdictNames[MpmVerdictOf(&finding)]);
}

static void CheckVerdicts(void)
{
  CheckVerdict(1, 0, 1e-8, MPM_STABLE, "1");
  CheckVerdict(1 + 2e-8, 0, 1e-8, MPM_STABLE, "a defective pair");
  CheckVerdict(1 + 1e-5, 1e-9, 1e-8, MPM_UNSTABLE, "1 + 1e-5");
  CheckVerdict(1 + 1e-5, 1e-4, 1e-8, MPM_UNDECIDED, "1 + 1e-5, known to 1e-4");
  CheckVerdict(1, 0, 1e-3, MPM_UNDECIDED, "1, blurred");
  CheckVerdict(NAN, 0, 1e-8, MPM_UNDECIDED, "nothing");
  CheckVerdict(INFINITY, NAN, NAN, MPM_UNSTABLE, "infinity");
}

/* A period whose product leaves the range of doubles is still solved, and its growth is the symbol's. */
static PetscErrorCode CheckLongPeriod(void)
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(SpectrumOf("-formulation gas1 -cells 8 -ppc 1 -courant 1e5 -drift 1/40", &scene, &s));
  CHECK(s->op->exponent > 200 && s->symbol->exponent > 200, "exponents %d, %d", (int)s->op->exponent,
        (int)s->symbol->exponent);
  CHECK(fabs(s->growth / s->symbol->growth - 1) <= 1e-9, "spectrum %.12g, symbol %.12g", s->growth, s->symbol->growth);
  CHECK(s->finding.verdict == MPM_UNSTABLE && s->finding.uncertainty <= 1e-6 * s->growth, "%s, known to %g",
        MpmVerdictNames[s->finding.verdict], s->finding.uncertainty);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Compares the condition number of a simple eigenvalue from the block of its phase with that from left vectors of the
   whole operator.
*/
static PetscErrorCode CheckCondition(void)
{
  MpmScene    *scene;
  MpmSpectrum *s;
  PetscReal    condition;

  PetscFunctionBegin;
  PetscCall(SpectrumOf("-cells 16 -courant 0.2 -drift 1/18", &scene, &s)); /* at beta = pi, which has no other sign */
  PetscCall(MpmEigenCondition(s->eigen, 0, &condition));
  CHECK_NEAR(s->symbol->condition, condition, 1e-6 * condition);
  CHECK(condition > 1.3 && condition < 1.4 && s->finding.uncertainty > 1e-17, "condition %g, known to %g", condition,
        s->finding.uncertainty);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Numbers that leave the range of doubles must be no error of the program. */
static PetscErrorCode CheckOffRange(const char options[])
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &s));
  CHECK(s->eigen->failed && s->finding.verdict == MPM_UNSTABLE, "%s: %s", options, MpmVerdictNames[s->finding.verdict]);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A period in which modes grow by more than doubles resolve, and decay again: its product has growth 1, but the march
   shows that this is wrong.
*/
static PetscErrorCode CheckHidden(const char options[])
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(SpectrumOf(options, &scene, &s));
  CHECK(!(s->step_mismatch <= 1e-6) && s->finding.verdict == MPM_UNDECIDED, "%s: mismatch %.3g: %s", options,
        s->step_mismatch, MpmVerdictNames[s->finding.verdict]);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  PetscCall(SlepcInitializeNoArguments());
  CheckVerdicts();
  PetscCall(OracleGrowth(argv[1], "", 24, CheckGrowth));
  PetscCall(OracleRadius(argv[2], 5, CheckRadius));
  PetscCall(CheckNullSpace("gas2", 1, 1));
  PetscCall(CheckNullSpace("gas2", 2, 16));
  PetscCall(CheckNullSpace("gas1", 4, 48));
  PetscCall(CheckNullSpace("elastic", 2, 16));
  PetscCall(CheckMethods("-cells 40 -courant 2.05", MPM_EIGEN_TARGET));
  PetscCall(CheckMethods("-formulation gas1 -cells 40", MPM_EIGEN_TARGET));
  PetscCall(CheckMethods("-cells 40 -courant 0.2 -drift 1/8", MPM_EIGEN_TARGET));
  PetscCall(CheckMethods("-cells 40 -courant 0.5 -jitter 0.4", MPM_EIGEN_LARGEST));
  PetscCall(CheckFactors("-cells 1500", ""));
  PetscCall(CheckFactors("-cells 1500", "-eps_two_sided")); /* solves with A^T */
  PetscCall(CheckFactors("-cells 700 -formulation musl -drift 1/8", ""));
  PetscCall(CheckHidden("-formulation elastic -cells 8 -ppc 1 -courant 1.2 -drift 1/300"));
  PetscCall(CheckHidden("-formulation elastic -cells 16 -ppc 1 -courant 1.2 -drift 1/1000"));
  PetscCall(CheckLongPeriod());
  PetscCall(CheckLargest());
  PetscCall(CheckCondition());
  PetscCall(CheckOffRange("-courant 1e200"));
  PetscCall(CheckOffRange("-cells 1100 -courant 1e200 -jitter 0.5"));
  PetscCall(CheckUndecided("-cells 32 -jitter 1", "-eps_type krylovschur -eps_nev 2 -st_type sinvert -eps_target 0.5"));
  PetscCall(CheckUndecided("-cells 1100 -jitter 1", "-eps_smallest_real"));
  PetscCall(CheckUndecided("-cells 1100 -jitter 1", "-eps_tol 1e-2"));
  PetscCall(CheckUndecided("-cells 1100 -courant 1e-8", "-eps_nev 1")); /* beside the 1 of the null space */
  PetscCall(CheckUndecided("-cells 40 -jitter 0.4",
                           "-eps_type krylovschur -eps_nev 2 -eps_ncv 4 -eps_max_it 1 -eps_tol 1e-15"));
  PetscCall(CheckUndecided("-cells 40 -courant 0.5",
                           "-eps_type krylovschur -eps_nev 2 -eps_ncv 4 -eps_max_it 1 -eps_tol 1e-15"));
  PetscCall(CheckUndecided("-cells 40 -jitter 0.4 -formulation elastic",
                           "-eps_type krylovschur -eps_nev 2 -eps_ncv 20 -eps_smallest_magnitude"));
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
