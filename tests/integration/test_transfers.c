/*
   Transfers: which ones are the same at which numbers, the closed form of aflip on hats, and when the filter of a gas or of
   elastic acts. In two and three dimensions A q = march(q) and spectrum = symbol.
*/
#include "base/hash.h"
#include "check.h"
#include "linalg/dense.h"
#include "linalg/small_eigen.h"
#include "stable_limit.h"
#include "symbols.h"
#include <mpmstab/operator.h>
#include <slepcsys.h>

static PetscErrorCode SymbolOf(const char options[], PetscInt phases, MpmScene **scene, MpmSymbol **symbol)
{
  PetscFunctionBegin;
  PetscCall(CheckScene(options, scene));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, *scene, phases, PETSC_FALSE, symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks that two transfers have the same growth at every phase, or that they have not. */
static PetscErrorCode Same(const char scheme[], const char one[], const char other[], PetscBool same)
{
  const char *const transfers[] = {one, other};
  char              options[256];
  MpmScene         *scene;
  MpmSymbol        *symbol[2];
  PetscReal         apart = 0;

  PetscFunctionBegin;
  for (int i = 0; i < 2; i++) {
    PetscCall(PetscSNPrintf(options, sizeof options, "%s -transfer %s", scheme, transfers[i]));
    PetscCall(SymbolOf(options, 6, &scene, &symbol[i]));
    PetscCall(MpmSceneDestroy(&scene));
  }
  for (PetscInt i = 0; i < symbol[0]->count; i++)
    apart = fmax(apart, fabs(symbol[0]->per_phase[i] - symbol[1]->per_phase[i]) / symbol[0]->per_phase[i]);
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &apart, 1, MPIU_REAL, MPIU_MAX, PETSC_COMM_WORLD));
  CHECK(same ? apart < 3e-8 : apart > 1e-4, "%s: %s and %s: %g", scheme, one, other, apart);
  for (int i = 0; i < 2; i++) PetscCall(MpmSymbolDestroy(&symbol[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SameTransfers(void)
{
  static const char *const affine[] = {"-formulation usl -courant 1.7 -basis quadratic -offset 0.3",
                                       "-formulation musl -courant 0.9 -basis cubic -drift 1/3",
                                       "-dim 2 -formulation usf -courant 0.7 -basis gimp -gradient mls -drift 1/3,0"};
  static const char *const any[]    = {
         "-formulation usavg -courant 0.9 -drift 1/3", "-formulation gas2 -courant 0.4 -drift 1/3",
         "-formulation elastic -courant 1.5 -drift 1/4", "-dim 2 -formulation usl -courant 1.6 -basis quadratic"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(affine); i++) {
    PetscCall(Same(affine[i], "aflip", "asflip", PETSC_TRUE));
    PetscCall(Same(affine[i], "aflip -aflip_ratio 0", "apic", PETSC_TRUE));
    PetscCall(Same(affine[i], "aflip", "apic", PETSC_FALSE));
    PetscCall(Same(affine[i], "tpic", "apic", PETSC_FALSE));
  }
  PetscCall(Same("-formulation usl -courant 0.9 -drift 1/3", "tpic", "apic", PETSC_TRUE)); /* hats */
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(any); i++) {
    PetscCall(Same(any[i], "fmpm -xpic_order 1", "pic", PETSC_TRUE));
    PetscCall(Same(any[i], "xpic -xpic_order 1", "pic", PETSC_TRUE));
    PetscCall(Same(any[i], "blend -blend_ratio 0", "pic", PETSC_TRUE));
    PetscCall(Same(any[i], "fmpm -xpic_order 3", "xpic -xpic_order 3", PETSC_FALSE));
  }
  for (int i = 1; i < 3; i++) { /* gas and elastic, drifting */
    PetscCall(Same(any[i], "pic", "pic -pic_filter before", PETSC_FALSE));
    PetscCall(Same(any[i], "xpic -xpic_order 1 -pic_filter before", "pic -pic_filter before", PETSC_TRUE));
  }
  PetscCall(
      Same("-formulation gas1 -courant 1.5 -offset 0.2", "pic", "pic -pic_filter before", PETSC_TRUE)); /* at rest */
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   usl with aflip on hats. Of a mode let v be P2G of the velocity, b that of the affine part and a the increment, n = v + b.
   With y = sin^2(beta/2), alpha = 1 - 4 q y, theta = 4 q y, s = 4 k^2 y and the ratio r a step makes

     v' = r v + (1 - r) alpha n + alpha a,    b' = theta (n + a),    a' = a - s (n + a)
*/
static PetscErrorCode AflipGrowth(PetscReal k, PetscReal r, PetscReal q, PetscReal beta, PetscReal *growth)
{
  const PetscReal y = PetscSqr(sin(beta / 2)), alpha = 1 - 4 * q * y, theta = 4 * q * y, s = 4 * k * k * y;
  const PetscReal columns[9] = {r + (1 - r) * alpha, theta, -s, (1 - r) * alpha, theta, -s, alpha, theta, 1 - s};
  MpmSmallEigen   three;

  PetscFunctionBegin;
  PetscCall(MpmSmallEigenCreate(3, &three));
  for (int i = 0; i < 9; i++) three.matrix[i] = columns[i];
  PetscCall(MpmSmallEigenSolve(&three, PETSC_FALSE));
  *growth = 1; /* stress that no node hears */
  for (int i = 0; i < 3; i++) *growth = fmax(*growth, cabs(three.value[i]));
  PetscCall(MpmSmallEigenDestroy(&three));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AflipOnHats(int n)
{
  const int       ppc = 1 + n % 3;
  const PetscReal k = 0.3 + 1.5 * MpmHash(n, 0), r = n % 2 ? MpmHash(n, 1) : 1,
                  offset = 0.01 * floor(100 * MpmHash(n, 2));
  char       options[256];
  MpmScene  *scene;
  MpmSymbol *symbol;
  PetscReal  q = 0;

  PetscFunctionBegin;
  for (int j = 0; j < ppc; j++) q += (j + offset) / ppc * (1 - (j + offset) / ppc) / ppc;
  PetscCall(PetscSNPrintf(options, sizeof options,
                          "-formulation usl -transfer aflip -aflip_ratio %.17g -ppc %d -offset %.2f -courant %.17g", r,
                          ppc, offset, k));
  PetscCall(SymbolOf(options, 9, &scene, &symbol));
  for (PetscInt i = 0; i < symbol->count; i++) {
    PetscReal beta[MPM_MAX_DIM], growth = NAN;

    MpmSymbolBeta(symbol, MpmSymbolPhaseOfClass(symbol, symbol->first + i), beta);
    PetscCall(AflipGrowth(k, r, q, beta[0], &growth));
    CHECK(fabs(symbol->per_phase[i] - growth) < (growth - 1 < 1e-6 ? 3e-8 : 1e-10) * growth, "%s: %.15g, not %.15g",
          options, symbol->per_phase[i], growth);
  }
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Limit(const char options[], PetscReal courant)
{
  MpmCritical c;

  PetscFunctionBegin;
  PetscCall(FindLimit(options, PETSC_FALSE, &c));
  CHECK(fabs(c.courant - courant) < 6e-5, "%s: %.6g, not %g", options, c.courant, courant);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The march is the operator, whose spectrum on a periodic grid is the symbol's. */
static PetscErrorCode Agrees(const char options[])
{
  MpmScene    *scene;
  MpmSymbol   *symbol;
  MpmOperator *op;
  PetscReal    mismatch, value[2], growth;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmOperatorMismatch(op, &mismatch));
  CHECK(mismatch <= 1e-13 * op->period, "%s: off by %g", options, mismatch);
  if (!MpmSymbolWhyNot(&scene->layout)) {
    PetscCall(MpmDenseLargest(op->A, value));
    growth = MpmGrowthPerStep(hypot(value[0], value[1]), op->exponent, op->period);
    PetscCall(MpmSymbolCreate(
        PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step,
        &(MpmSymbolWish){.phases = {scene->layout.grid[0].cells, scene->layout.grid[1].cells}, .tolerance = 1e-6},
        &symbol));
    CHECK(growth > 1 + 1e-3 && fabs(growth - symbol->growth) < 1e-9 * growth, "%s: %.15g and %.15g", options, growth,
          symbol->growth);
    PetscCall(MpmSymbolDestroy(&symbol));
  }
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AgreesInSpace(void)
{
  static const char *const scenes[] = {
      "-dim 2 -cells 6,3 -ppc 1,2 -formulation usl -transfer aflip -aflip_ratio 0.9 -basis quadratic -gradient mls "
      "-courant 2 "
      "-drift 1/2,0",
      "-dim 2 -cells 6,3 -ppc 1,2 -formulation musl -transfer tpic -basis cubic -courant 2.5",
      "-dim 2 -cells 6,3 -ppc 1,2 -formulation usavg -transfer fmpm -basis quadratic -courant 2 -drift 0,1/2",
      "-dim 2 -cells 6,3 -ppc 1,2 -formulation gas2 -transfer fmpm -courant 2",
      "-dim 2 -cells 6,3 -ppc 1,2 -formulation gas1 -transfer xpic -drift 1/3,0 -courant 0.9",
      "-dim 2 -cells 7,4 -formulation usf -transfer fmpm -xpic_order 3 -basis gimp -boundary "
      "fixed_reaction-symmetry,fixed "
      "-courant 0.3",
      "-dim 2 -cells 6,5 -formulation usl -transfer tpic -basis quadratic -boundary fixed,free-fixed -courant 0.3 "
      "-jitter 0.5 "
      "-material two -density_ratio 3 -stiffness_ratio 7",
      "-cells 12 -formulation musl -transfer tpic -basis cubic -boundary fixed,free -spline_ends open -courant 0.3",
      "-dim 2 -cells 6,4 -formulation elastic -transfer fmpm -boundary fixed-free,periodic -courant 0.3",
      "-dim 3 -cells 6,2,3 -ppc 1 -formulation usl -transfer aflip -gradient mls -basis quadratic -courant 0.3 -jitter "
      "0.5",
      "-dim 3 -cells 6,2,3 -ppc 1 -formulation usavg -transfer fmpm -courant 0.3 -jitter 0.5"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(scenes); i++) PetscCall(Agrees(scenes[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(SameTransfers());
  for (int n = 0; n < 12; n++) PetscCall(AflipOnHats(n));
  /* the numbers of the textbook's pic, and those that filter the old field */
  PetscCall(Limit("-formulation elastic -transfer pic", 1.4784));
  PetscCall(Limit("-formulation elastic -transfer pic -drift 1/8", 0.9161));
  PetscCall(Limit("-formulation elastic -transfer pic -pic_filter before", 1.3256));
  PetscCall(Limit("-formulation elastic -transfer pic -pic_filter before -drift 1/8", 1.0757));
  /* fmpm of order 2 on hats, waves of two cells: usl is stable iff b s <= 2 (1 + f), alpha = 1/4, f = 7/16, b = 7/4, s = 4 k^2 */
  PetscCall(Limit("-formulation usl -transfer fmpm", sqrt(2 * (23 / 16.) / 7)));
  PetscCall(AgreesInSpace());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
