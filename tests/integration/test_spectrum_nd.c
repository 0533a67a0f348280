/*
   Spectra in two and three dimensions. The operator does what the march does. Its eigenvalues are the symbol's factors,
   both as sets. Without a matrix it does the same as with one, also transposed. Large operators find the symbol's
   leading modes, or those of largest magnitude; and what did not converge is undecided.
*/
#include "spectra.h"
#include "program/program.h"

static void SetRandom(PetscInt n, PetscReal x[])
{
  for (PetscInt i = 0; i < n; i++) x[i] = (PetscReal)((i * 7919 + 13) % 1009) / 1009 - 0.5;
}

/* The shell's product with a vector, or its transpose's, is the matrix' own. */
static PetscErrorCode CheckProduct(const char options[], Mat A, Mat shell, PetscBool transpose)
{
  Vec        x, y, z;
  PetscReal *values, difference;
  PetscInt   n;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(A, &x, &y));
  PetscCall(VecDuplicate(y, &z));
  PetscCall(VecGetLocalSize(x, &n));
  PetscCall(VecGetArrayWrite(x, &values));
  SetRandom(n, values);
  PetscCall(VecRestoreArrayWrite(x, &values));
  PetscCall(transpose ? MatMultTranspose(A, x, y) : MatMult(A, x, y));
  PetscCall(transpose ? MatMultTranspose(shell, x, z) : MatMult(shell, x, z));
  PetscCall(VecAXPY(y, -1, z));
  PetscCall(VecNorm(y, NORM_INFINITY, &difference));
  CHECK(difference <= 1e-13, "%s: A%s x differs by %.3g", options, transpose ? "^T" : "", difference);
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&z));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With and without a matrix; and the march. */
static PetscErrorCode CheckOperator(const char options[])
{
  MpmScene    *scene;
  MpmOperator *op;
  PetscReal    mismatch, norm, bound;
  Mat          shell;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmOperatorMismatch(op, &mismatch));
  CHECK(op->assembled && mismatch <= (strstr(options, "nullspace") ? 1e-11 : 1e-14) * op->period,
        "%s: %.3g from the march", options, mismatch);
  PetscCall(MpmStepsMatrix(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, 0, op->period, &shell));
  PetscCall(CheckProduct(options, op->A, shell, PETSC_FALSE));
  PetscCall(CheckProduct(options, op->A, shell, PETSC_TRUE));
  PetscCall(MatNorm(op->A, NORM_INFINITY, &norm));
  PetscCall(MatNorm(shell, NORM_INFINITY, &bound));
  CHECK(bound <= norm * (1 + 1e-12) && bound >= norm / 4, "%s: norm %g, bound %g", options, norm, bound);
  PetscCall(MatDestroy(&shell));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckOperators(void)
{
  PetscFunctionBegin;
  PetscCall(CheckOperator("-dim 2 -cells 6,4 -formulation usl -drift 1/3,1/2"));
  PetscCall(CheckOperator("-dim 2 -cells 6,4 -formulation usavg -transfer apic -basis cubic -gradient mls -ppc 1,2"));
  PetscCall(CheckOperator("-dim 2 -cells 5,6 -formulation gas2 -jitter 0.5 -transfer xpic -basis quadratic"));
  PetscCall(CheckOperator("-dim 2 -cells 5,6 -formulation elastic -transfer nullspace -drift 1/2,0 -offset 0"));
  PetscCall(CheckOperator("-dim 2 -cells 4,6 -formulation musl -basis gimp -boundary fixed_reaction-free,symmetry"));
  PetscCall(
      CheckOperator("-dim 2 -cells 4,6 -formulation usf -boundary fixed,periodic -material two -density_ratio 8"));
  PetscCall(CheckOperator("-dim 3 -cells 3,3,6 -ppc 1 -formulation gas1 -basis quadratic -transfer pic"));
  PetscCall(
      CheckOperator("-dim 3 -cells 2,3,6 -ppc 1 -formulation musl -boundary free-fixed_reaction,symmetry,periodic"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Spectrum and symbol are the same set. */
static PetscErrorCode CheckSets(const char options[])
{
  MpmScene    *scene;
  MpmSpectrum *s;
  PetscReal   *factors, farthest = 0;

  PetscFunctionBegin;
  PetscCall(SpectrumOf(options, &scene, &s));
  CHECK(s->eigen->complete && s->symbol && s->eigen->n == s->symbol->size * s->symbol->all, "%s: %d of %d", options,
        (int)s->eigen->n, (int)s->op->order);
  PetscCall(MpmSymbolGatherFactors(PETSC_COMM_WORLD, s->symbol, s->op->exponent, &factors));
  for (PetscInt i = 0; i < s->symbol->size * s->symbol->all; i++) {
    PetscReal nearest = PETSC_MAX_REAL;

    for (PetscInt j = 0; j < s->eigen->n; j++)
      nearest = PetscMin(nearest, hypot(factors[2 * i] - s->eigen->re[j], factors[2 * i + 1] - s->eigen->im[j]));
    farthest = PetscMax(farthest, nearest);
  }
  PetscCall(PetscFree(factors));
  CHECK(s->symbol_mismatch <= 1e-6 && farthest <= 1e-6, "%s: sets differ by %.3g and %.3g", options, s->symbol_mismatch,
        farthest);
  CHECK_NEAR(s->growth, s->symbol->growth, 1e-6);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The leading modes of operators without a matrix. An unstable one grows as the symbol says. numbers: what the maps of a
   step have for each particle.
*/
static PetscErrorCode CheckLarge(const char options[], MpmVerdict verdict, PetscReal numbers)
{
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(SpectrumOf(options, &scene, &s));
  CHECK(!s->op->assembled && s->eigen->n >= 1 && s->max_residual <= 1e-12, "%s: %s", options, s->eigen->solver);
  CHECK(s->symbol_mismatch <= 1e-9 && s->step_mismatch <= 1e-14, "%s: %.3g from the symbol, %.3g from the march",
        options, s->symbol_mismatch, s->step_mismatch);
  CHECK(s->finding.verdict == verdict, "%s: %s", options, MpmVerdictNames[s->finding.verdict]);
  CHECK_NEAR(s->op->nonzeros, numbers * (PetscReal)(s->op->period * scene->layout.particles), 0);
  if (verdict == MPM_UNSTABLE) CHECK_NEAR(s->growth, s->symbol->growth, 1e-10);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A random layout by the nodes' own operator, or by the particles'. */
static PetscErrorCode SpectrumBy(PetscBool nodal, const char options[], MpmScene **scene, MpmSpectrum **s)
{
  PetscFunctionBegin;
  PetscCall(CheckScene(options, scene));
  check_request.measure = PETSC_FALSE;
  check_request.nodal   = nodal;
  PetscCall(MpmSpectrumCreate(*scene, &check_request, 0, s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Krylov-Schur without a matrix. On a uniform layout it finds what the symbol says. On a random one the left vector
   gives the condition number.
*/
static PetscErrorCode CheckKrylov(void)
{
  PetscReal    growth, condition;
  MpmScene    *scene;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(CheckScene("-dim 2 -cells 17,15 -formulation usl -courant 1", &scene));
  check_request.measure = PETSC_FALSE;
  PetscCall(PetscOptionsInsertString(NULL, "-eps_type krylovschur"));
  PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &s));
  PetscCall(PetscOptionsClear(NULL));
  CHECK(s->eigen->largest && strstr(s->eigen->solver, "krylovschur"), "%s", s->eigen->solver);
  CHECK_NEAR(s->growth, s->symbol->growth, 1e-8);
  PetscCall(SpectrumClose(&scene, &s));
  PetscCall(SpectrumBy(PETSC_FALSE, "-dim 2 -cells 17,15 -formulation usl -courant 1 -jitter 0.6", &scene, &s));
  CHECK(s->eigen->largest && s->finding.verdict == MPM_UNSTABLE, "%s: %s", s->eigen->solver, s->finding.evidence);
  CHECK(s->condition >= 1 && s->condition < 100, "condition %g", s->condition);
  growth    = s->growth;
  condition = s->condition;
  PetscCall(SpectrumClose(&scene, &s));
  PetscCall(SpectrumBy(PETSC_TRUE, "-dim 2 -cells 17,15 -formulation usl -courant 1 -jitter 0.6", &scene, &s));
  CHECK(s->eigen->complete && s->eigen->small, "%s: %s", s->eigen->solver, s->finding.evidence);
  CHECK_NEAR(s->growth, growth, 1e-9 * growth);
  CHECK_NEAR(s->condition, condition, 1e-6 * condition);
  PetscCall(SpectrumClose(&scene, &s));
  PetscCall(SpectrumBy(PETSC_FALSE, "-dim 2 -cells 17,15 -formulation usl -courant 0.3 -jitter 0.6", &scene, &s));
  CHECK(s->finding.verdict != MPM_STABLE, "%s: %s", s->eigen->solver, s->finding.evidence); /* it cannot know */
  PetscCall(SpectrumClose(&scene, &s));
  PetscCall(SpectrumBy(PETSC_TRUE, "-dim 2 -cells 17,15 -formulation usl -courant 0.3 -jitter 0.6", &scene, &s));
  CHECK(s->finding.verdict == MPM_STABLE, "%s: %s", s->eigen->solver, s->finding.evidence); /* all eigenvalues do */
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The wave that grows most: its phase and its polarisation are the symbol's. */
static PetscErrorCode CheckModes(const char options[], const PetscReal beta[], PetscReal p_share)
{
  MpmScene    *scene;
  MpmSpectrum *s;
  PetscMPIInt  rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(SpectrumOf(options, &scene, &s));
  CHECK(s->leading.n >= 1 && s->leading.dim == scene->layout.dim, "%s: %d modes", options, (int)s->leading.n);
  for (PetscInt a = 0; a < scene->layout.dim && rank == 0; a++) CHECK_NEAR(s->leading.beta[a], beta[a], 1e-12);
  if (rank == 0) CHECK_NEAR(s->leading.p_share[0], p_share, 1e-9);
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Waves along an axis are P waves or S waves, two for each P wave in three dimensions. */
static PetscErrorCode CheckPolarisation(const char options[])
{
  MpmScene    *scene;
  MpmSpectrum *s;
  MpmModes     modes;
  PetscMPIInt  rank;
  PetscInt     count[2] = {0, 0};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(SpectrumOf(options, &scene, &s));
  PetscCall(MpmModesCreate(s->op, s->eigen, s->eigen->n, &modes));
  for (PetscInt j = 0; j < modes.n && rank == 0; j++) {
    const PetscReal share = modes.p_share[j];

    if (hypot(s->eigen->re[j] - 1, s->eigen->im[j]) < 0.01) continue;
    CHECK(fabs(share - rint(share)) <= 1e-6, "%s: mode %d has the P share %g", options, (int)j + 1, share);
    count[share < 0.5]++;
  }
  CHECK(rank || (count[0] > 0 && count[1] == 2 * count[0]), "%s: %d P waves, %d S waves", options, (int)count[0],
        (int)count[1]);
  PetscCall(MpmModesDestroy(&modes));
  PetscCall(SpectrumClose(&scene, &s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Norms of powers with and without a matrix are about the same on grids that differ little. */
static PetscErrorCode CheckPowers(void)
{
  MpmScene     *scene;
  MpmOperator  *op;
  MpmTransient *with, *without;
  Mat           A;

  PetscFunctionBegin;
  PetscCall(CheckScene("-dim 2 -cells 6,5 -formulation usl -courant 0.6 -drift 1/2,1/2 -basis quadratic", &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmTransientCreate(op, NULL, 8, 1, &with));
  A = op->A;
  PetscCall(MpmStepsMatrix(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, 0, op->period, &op->A));
  op->assembled = PETSC_FALSE;
  PetscCall(MpmTransientCreate(op, NULL, 8, 1, &without));
  PetscCall(MatDestroy(&A));
  for (PetscInt i = 1; i < with->n; i++) CHECK_NEAR(with->norm[i], without->norm[i], 1e-5 * with->norm[i]);
  CHECK(with->largest > 1.01, "norms of 1 show nothing: %g", with->largest);
  PetscCall(MpmTransientDestroy(&with));
  PetscCall(MpmTransientDestroy(&without));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(CheckOperators());
  PetscCall(CheckSets("-dim 2 -cells 4,6 -ppc 2,1 -formulation usl -courant 0.7 -basis quadratic"));
  PetscCall(CheckSets("-dim 2 -cells 4,6 -ppc 2,1 -formulation musl -transfer apic -drift 1/4,1/2"));
  PetscCall(CheckSets("-dim 3 -cells 3,2,6 -ppc 1 -formulation usf -courant 0.6 -poisson 0.5 -transfer pic"));
  PetscCall(CheckSets("-dim 3 -cells 3,2,6 -ppc 1 -formulation gas2 -transfer blend -drift 1/3,0,1/3"));
  /* P2G, G2P, and the gradients' and divergences' derivatives along each axis: 6 and 8 maps, apic's 6 more */
  PetscCall(CheckLarge("-dim 2 -cells 16,14 -formulation usl -courant 0.9", MPM_UNSTABLE, 6 * 4));
  PetscCall(CheckLarge("-dim 2 -cells 16,14 -formulation usl -courant 0.7", MPM_STABLE, 6 * 4));
  PetscCall(CheckLarge("-dim 2 -cells 16,14 -formulation musl -basis quadratic -drift 1/8,1/8", MPM_UNSTABLE, 6 * 16));
  PetscCall(
      CheckLarge("-dim 3 -cells 6,5,8 -ppc 1,2,1 -formulation usavg -transfer apic -courant 3", MPM_UNSTABLE, 14 * 8));
  PetscCall(CheckKrylov());
  PetscCall(CheckModes("-dim 2 -cells 6,5 -formulation usl -courant 0.9", (PetscReal[]){PETSC_PI, 0}, 1));
  PetscCall(CheckModes("-dim 2 -cells 1,8 -ppc 1,2 -formulation usl -courant 0.9", (PetscReal[]){0, PETSC_PI}, 1));
  PetscCall(CheckPolarisation("-dim 3 -cells 1,1,7 -ppc 1,1,2 -formulation usl -courant 0.9"));
  PetscCall(CheckPowers());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
