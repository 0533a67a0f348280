/*
   Transient growth: norms of powers are compared with those of the dense products by LAPACK, at rest and under drift.
   At rest the nodes' operator makes the same norms.
   Growth like n of a defective eigenvalue and norms near a limit are compared with closed forms, and the Kreiss
   constant with its bounds.
*/
#include "singular.h"
#include "linalg/dense.h"
#include "scene/material.h"
#include "analysis/transient.h"
#include "operator/nodal.h"
#include <slepcsys.h>

#define LAST 19

/*
   Computes product = A product in the variables of the energy: A is multiplied from both sides with sqrt(m) and sqrt(V
   / E).
*/
static PetscErrorCode DenseStep(const MpmOperator *op, Mat A, PetscReal factor, PetscReal product[])
{
  const PetscInt  n      = op->order;
  PetscBLASInt    order  = (PetscBLASInt)n;
  const PetscReal none   = 0;
  PetscBool       stress = PETSC_FALSE;
  PetscReal      *a, *old, *w;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n * n, &a, n * n, &old, n, &w));
  PetscCall(MpmDenseCopy(A, a));
  PetscCall(PetscArraycpy(old, product, n * n));
  for (PetscInt row = 0; row < n; row++) {
    const PetscInt64 id = row / op->fields;

    stress = !strcmp(op->scheme->table->fields[row % op->fields], "s") ? PETSC_TRUE : PETSC_FALSE;
    w[row] =
        stress
            ? sqrt(MpmMaterialProperty(op->layout, MPM_VOLUME, id) / MpmMaterialProperty(op->layout, MPM_STIFFNESS, id))
            : sqrt(MpmMaterialProperty(op->layout, MPM_MASS, id));
  }
  for (PetscInt i = 0; i < n * n; i++) a[i] *= factor * w[i % n] / w[i / n];
  PetscCallBLAS("BLASgemm", BLASgemm_("N", "N", &order, &order, &order, (PetscReal[]){1}, a, &order, old, &order, &none,
                                      product, &order));
  PetscCall(PetscFree3(a, old, w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckNorm(const char options[], PetscInt step, PetscReal norm, PetscInt n,
                                const PetscReal product[])
{
  PetscReal *copy, ends[2];

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n * n, &copy));
  PetscCall(PetscArraycpy(copy, product, n * n));
  PetscCall(DenseSingular(n, copy, ends));
  CHECK(fabs(norm / ends[1] - 1) <= 1e-8, "%s: norm(A^%d) = %.12g, LAPACK %.12g", options, (int)step, norm, ends[1]);
  PetscCall(PetscFree(copy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The norms again, by the powers of the nodes' operator where there is one. Scenes that have one are counted. */
static PetscErrorCode CheckNodal(const char options[], const MpmOperator *op, const MpmTransient *t, PetscInt *scenes)
{
  MpmReduced   *nodal;
  MpmTransient *again;

  PetscFunctionBegin;
  PetscCall(MpmNodalMatrixOf(op, &nodal));
  if (!nodal) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmTransientCreate(op, nodal, LAST, NAN, &again));
  for (PetscInt i = 0; i < t->n; i++)
    CHECK(fabs(again->norm[i] / t->norm[i] - 1) <= 1e-12, "%s: norm(A^%d) = %.15g, without the nodes' %.15g", options,
          (int)t->steps[i], again->norm[i], t->norm[i]);
  PetscCall(MpmTransientDestroy(&again));
  PetscCall(MpmReducedDestroy(&nodal));
  (*scenes)++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Applies the steps of the period in turn. Where a period ends, it compares with the period's operator applied at once.
*/
static PetscErrorCode CheckNorms(const char options[], PetscInt *nodal)
{
  MpmScene     *scene;
  MpmOperator  *op;
  MpmTransient *t;
  PetscReal    *product, *periods;
  PetscInt      n, exponent, at = 1;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmTransientCreate(op, NULL, LAST, NAN, &t));
  n = op->order;
  CHECK(t->n == 18 && t->steps[t->n - 1] == LAST && t->missing == 0 && t->norm[0] == 1, "%s: %d norms", options,
        (int)t->n);
  PetscCall(PetscCalloc2(n * n, &product, n * n, &periods));
  for (PetscInt i = 0; i < n; i++) product[i * (n + 1)] = periods[i * (n + 1)] = 1;
  for (PetscInt step = 1; step <= LAST; step++) {
    Mat A;

    PetscCall(MpmOperatorStep(op, (step - 1) % op->period, &A, &exponent));
    PetscCall(DenseStep(op, A, scalbn(1, (int)exponent), product));
    PetscCall(MatDestroy(&A));
    if (step % op->period == 0) PetscCall(DenseStep(op, op->A, scalbn(1, (int)op->exponent), periods));
    if (t->steps[at] != step) continue;
    PetscCall(CheckNorm(options, step, t->norm[at], n, product));
    if (step % op->period == 0) PetscCall(CheckNorm(options, step, t->norm[at], n, periods));
    CHECK_NEAR(t->log_norm[at], log(t->norm[at]), 1e-12 * (1 + fabs(t->log_norm[at])));
    at++;
  }
  PetscCall(PetscFree2(product, periods));
  PetscCall(CheckNodal(options, op, t, nodal));
  PetscCall(MpmTransientDestroy(&t));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A block [1 0; c 1] among states that keep their size has norm(A^n) = (c n + sqrt(c^2 n^2 + 4)) / 2. */
static PetscErrorCode CheckLinear(const char options[], PetscReal c)
{
  const PetscReal    last = 100, norm = (c * last + hypot(c * last, 2)) / 2;
  MpmScene          *scene;
  MpmOperator       *op;
  MpmTransient      *t;
  MpmPseudospectrum *p;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmTransientCreate(op, NULL, (PetscInt)last, 1, &t));
  CHECK(fabs(t->largest / norm - 1) <= 1e-9 && t->at_step == (PetscInt)last && fabs(t->excess / norm - 1) <= 1e-9,
        "%s: %.12g, closed form %.12g", options, t->largest, norm);
  CHECK_NEAR(t->power, 1, 0.01);
  PetscCall(MpmPseudospectrumCreate(op->A, 4, 1e-6, &p));
  CHECK(p->kreiss > 0.1 * c / MPM_KREISS_NEAREST && fabs(p->edge_power - 1) < 1e-3, "%s: %.12g, power %g", options,
        p->kreiss, p->edge_power);
  PetscCall(MpmPseudospectrumDestroy(&p));
  PetscCall(MpmTransientDestroy(&t));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks K <= sup norm(A^n) <= e N K. For bounded powers neither the fitted power nor edge_power may show growth. */
static PetscErrorCode CheckKreiss(const char options[], PetscReal least)
{
  MpmScene          *scene;
  MpmOperator       *op;
  MpmTransient      *t;
  MpmPseudospectrum *p;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmTransientCreate(op, NULL, 300, 1, &t));
  PetscCall(MpmPseudospectrumCreate(op->A, 5, 1e-6, &p));
  CHECK(p->kreiss >= least && p->kreiss <= t->largest * (1 + 1e-9) && t->largest <= M_E * p->order * p->kreiss,
        "%s: Kreiss %.9g, norms up to %.9g", options, p->kreiss, t->largest);
  CHECK(t->missing == 0 && fabs(t->power) <= 0.02 && p->edge_power < 0.1, "%s: norms like n^%.3f, on the edge %.3f",
        options, t->power, p->edge_power);
  PetscCall(MpmPseudospectrumDestroy(&p));
  PetscCall(MpmTransientDestroy(&t));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   gas2 with one particle in the middle of each cell. At beta = pi/2 the projector of the eigenvalue has the norm 1 /
   sqrt(1 - k^2 / 4), and K is close to it. The steps' invariant has the condition (2 + k) / (2 - k); no norm exceeds
   its root, and some come near it.
*/
static PetscErrorCode CheckNearLimit(PetscReal k)
{
  const PetscReal    kreiss = 1 / sqrt(1 - k * k / 4), norm = sqrt((2 + k) / (2 - k));
  char               options[64];
  MpmScene          *scene;
  MpmOperator       *op;
  MpmTransient      *t;
  MpmPseudospectrum *p;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-cells 8 -ppc 1 -courant %.17g", (double)k));
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmTransientCreate(op, NULL, 200, 1, &t));
  PetscCall(MpmPseudospectrumCreate(op->A, 3, 1e-6, &p));
  CHECK(p->kreiss <= kreiss * (1 + 1e-9) && p->kreiss >= 0.999 * kreiss, "%s: Kreiss %.9g, closed form %.9g", options,
        p->kreiss, kreiss);
  CHECK(t->largest <= norm * (1 + 1e-9) && t->largest >= 0.99 * norm, "%s: norms up to %.9g, closed form %.9g", options,
        t->largest, norm);
  PetscCall(MpmPseudospectrumDestroy(&p));
  PetscCall(MpmTransientDestroy(&t));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Beyond the range of doubles the logarithm is still known: gas1 is normal enough for norm(A^n) = constant x growth^n.
*/
static PetscErrorCode CheckOffRange(void)
{
  const PetscReal growth = hypot(1, 200);
  MpmScene       *scene;
  MpmOperator    *op;
  MpmTransient   *t;

  PetscFunctionBegin;
  PetscCall(CheckScene("-formulation gas1 -courant 200 -cells 8", &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmTransientCreate(op, NULL, 200, growth, &t));
  CHECK(isnan(t->norm[t->n - 1]) && isnan(t->largest) && t->at_step == 200 && t->missing == 0, "largest %g at %d",
        t->largest, (int)t->at_step);
  CHECK_NEAR(t->log_norm[t->n - 1] - t->log_norm[t->n - 2], (200 - t->steps[t->n - 2]) * log(growth), 1e-7);
  CHECK(t->excess > 1 && t->excess < 2 && fabs(t->power) < 1e-3, "excess %g, power %g", t->excess, t->power);
  PetscCall(MpmTransientDestroy(&t));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscInt nodal = 0;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(CheckNorms("-cells 12", &nodal));
  PetscCall(CheckNorms("-formulation elastic -cells 12 -courant 1.1 -jitter 0.6 -ppc 1", &nodal));
  PetscCall(CheckNorms("-formulation usl -transfer apic -basis quadratic -cells 8", &nodal));
  PetscCall(CheckNorms("-formulation musl -transfer pic -boundary fixed,free -cells 8", &nodal));
  PetscCall(CheckNorms("-formulation gas1 -cells 8 -courant 3", &nodal));
  PetscCall(CheckNorms("-cells 8 -drift 1/8 -courant 0.1", &nodal));
  PetscCall(CheckNorms("-formulation usf -cells 8 -drift -2/3 -jitter 0.4", &nodal));
  PetscCall(CheckNorms("-formulation musl -cells 8 -drift 1/40", &nodal)); /* the period is longer than the powers */
  PetscCall(
      CheckNorms("-formulation usl -cells 8 -counts 1,3 -material two -density_ratio 50 -stiffness_ratio 7", &nodal));
  PetscCall(CheckNorms("-formulation musl -cells 8 -drift 1/4 -courant 0.1 -material two -density_ratio 50", &nodal));
  PetscCall(CheckNorms("-formulation usf -cells 8 -ppc 1 -fill 3,4", &nodal));                   /* A = 1 */
  PetscCall(CheckNorms("-formulation usl -transfer blend -ppc 3 -cells 8 -jitter 0.7", &nodal)); /* C has 1 and 0.9 */
  CHECK(nodal == 6, "%d scenes with an operator of the nodes", (int)nodal);
  PetscCall(CheckLinear("-cells 16 -courant 0.5", 0.5)); /* beta = pi: c = k sqrt(alpha kappa) = k */
  PetscCall(CheckLinear("-cells 16 -ppc 4 -courant 0.5", 0.5 * sqrt(4 * 0.3125))); /* mean of xi (1 - xi): 11 / 64 */
  PetscCall(CheckLinear("-formulation elastic -cells 16 -courant 0.8", 0.8));
  PetscCall(CheckKreiss("-formulation musl -courant 1.7 -cells 16", 5));
  PetscCall(CheckKreiss("-formulation elastic -courant 1 -boundary fixed -cells 16", 2));
  PetscCall(CheckKreiss("-formulation usl -transfer apic -cells 16", 1.3));
  PetscCall(CheckKreiss("-transfer nullspace -pic_filter before -cells 16", 1.1));
  PetscCall(CheckNearLimit(1.5));
  PetscCall(CheckNearLimit(1.95));
  PetscCall(CheckOffRange());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
