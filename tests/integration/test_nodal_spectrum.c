/*
   Eigenvalues of the nodes' own operator are those of the particles', multiplicities included; its vectors are lifted to
   vectors of the particles, from the left and from the right; and the tasks that use it say the same without it. Where the
   leftmost eigenvalues are said to decide, all that grow are real and below -1, and the leftmost ones are found.
*/
#include "check.h"
#include "analysis/ensemble.h"
#include "analysis/lone.h"
#include "base/hash.h"
#include "linalg/eigen.h"
#include "operator/nodal.h"
#include <mpmstab/critical.h>
#include <slepcsys.h>

#define CLOSE 1e-3 /* eigenvalues so close to a kept number are counted and not compared: it may be defective */
#define PAIR 1e-4  /* those that are so close to each other are not compared */

static PetscBool IsKept(const MpmReduced *r, const MpmEigen *e, PetscInt j)
{
  for (PetscInt k = 0; k < r->nkept; k++)
    if (hypot(e->re[j] - r->number[k], e->im[j]) < CLOSE) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscReal Distance(const MpmEigen *a, PetscInt i, const MpmEigen *b, PetscInt j)
{
  return hypot(a->re[i] - b->re[j], a->im[i] - b->im[j]);
}

/* The farthest that an eigenvalue of one list, but for kept numbers and pairs, is from all of another. */
static PetscReal Farthest(const MpmReduced *r, const MpmEigen *a, const MpmEigen *b, PetscInt *compared)
{
  PetscReal farthest = 0;

  *compared = 0;
  for (PetscInt i = 0; i < a->n; i++) {
    PetscReal nearest = INFINITY;
    PetscBool pair    = PETSC_FALSE;

    for (PetscInt j = 0; j < a->n && !pair; j++)
      pair = j != i && Distance(a, i, a, j) < PAIR ? PETSC_TRUE : PETSC_FALSE;
    if (pair || IsKept(r, a, i)) continue;
    for (PetscInt j = 0; j < b->n; j++) nearest = PetscMin(nearest, Distance(a, i, b, j));
    farthest = PetscMax(farthest, nearest);
    (*compared)++;
  }
  return farthest;
}

static PetscInt CountKept(const MpmReduced *r, const MpmEigen *e)
{
  PetscInt n = 0;

  for (PetscInt j = 0; j < e->n; j++) n += IsKept(r, e, j);
  return n;
}

/* compared: is increased by the number of eigenvalues that were compared. */
static PetscErrorCode CheckAllOf(const char options[], PetscInt *compared)
{
  MpmScene    *scene;
  MpmOperator *op;
  MpmReduced  *nodal;
  MpmEigen    *small, *all;
  PetscInt     n;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmNodalMatrixOf(op, &nodal));
  CHECK(nodal, "%s: no operator of the nodes", options);
  if (nodal) {
    CHECK(nodal->mismatch <= 1e-12, "%s: A and C + B Z differ by %.3g", options, nodal->mismatch);
    PetscCall(MpmEigenSolveReduced(op->balanced, nodal, NULL, MPM_EIGEN_DENSE, NULL, &small));
    PetscCall(MpmEigenSolve(op->balanced, NULL, MPM_EIGEN_DENSE, NULL, &all));
    CHECK(small->complete && all->complete, "%s: %d and %d of %d found", options, (int)small->n, (int)all->n,
          (int)op->order);
    CHECK_NEAR(Farthest(nodal, small, all, &n), 0, 1e-12 * PetscMax(1, all->norm));
    *compared += n;
    CHECK_NEAR(Farthest(nodal, all, small, &n), 0, 1e-12 * PetscMax(1, all->norm));
    CHECK(CountKept(nodal, small) == CountKept(nodal, all), "%s: %d and %d eigenvalues that particles keep", options,
          (int)CountKept(nodal, small), (int)CountKept(nodal, all));
    for (PetscInt j = 0; j < small->n; j++)
      CHECK(small->residual[j] <= 1e-11, "%s: residual %.3g of %.9g %+.9gi", options, small->residual[j], small->re[j],
            small->im[j]);
    PetscCall(MpmEigenDestroy(&small));
    PetscCall(MpmEigenDestroy(&all));
  }
  PetscCall(MpmReducedDestroy(&nodal));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Every formulation with every transfer; bases, boundaries and layouts take turns. Then particles of two materials. */
static PetscErrorCode CheckAll(void)
{
  static const char *const layouts[] = {
      "-cells 7 -ppc 3 -jitter 0.9 -courant 0.7", "-cells 7 -ppc 2 -jitter 0.4 -courant 0.6 -boundary fixed",
      "-dim 2 -cells 3 -ppc 2,1 -jitter 0.8 -courant 0.6 -boundary symmetry,fixed", "-cells 9 -ppc 2 -courant 0.8",
      "-dim 2 -cells 3 -ppc 1,2 -jitter 0.5 -courant 0.5"};
  PetscInt which = 0, compared = 0, bases = 0;

  PetscFunctionBegin;
  while (MpmBases[bases]) bases++;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++, which++) {
      const PetscInt b = which % bases;
      char           options[512];

      if (MpmTransfers[t]->affine && MpmFormulations[f]->affine == MPM_NONE) continue;
      if (MpmFormulationHas(MpmFormulations[f], MPM_IMPLICIT)) continue; /* no sum of products of nodes */
      PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -transfer %s -basis %s %s",
                              MpmFormulations[f]->name, MpmTransfers[t]->name, MpmBases[b]->name,
                              layouts[which / 2 % PETSC_STATIC_ARRAY_LENGTH(layouts)]));
      PetscCall(CheckAllOf(options, &compared));
    }
  PetscCall(CheckAllOf("-formulation usl -cells 8 -ppc 2 -jitter 0.5 -courant 0.4 -material two -density_ratio 50 "
                       "-stiffness_ratio 3 -boundary fixed",
                       &compared));
  CHECK(compared > 500, "%d eigenvalues compared", (int)compared);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One of n words. The same on all ranks. */
static const char *Choice(PetscInt scene, PetscInt column, PetscInt n, const char *const words[])
{
  return words[(PetscInt)(n * MpmHash(scene + 5000, column))];
}
#define CHOICE(scene, column, words) Choice(scene, column, PETSC_STATIC_ARRAY_LENGTH(words), words)

/* A random scene. */
static PetscErrorCode RandomScene(PetscInt n, size_t room, char options[])
{
  static const char *const formulations[] = {"usl", "usf", "musl", "usavg"};
  static const char *const transfers[]    = {"flip", "pic", "blend -blend_ratio 0.3", "xpic -xpic_order 3", "apic"};
  static const char *const bases[] = {"linear", "quadratic", "cubic", "gimp"}, *const gradients[] = {"basis", "mls"};
  static const char *const layouts[] = {
      "-cells 9 -ppc 3 -jitter 0.9",
      "-cells 8 -ppc 2 -jitter 0.5 -boundary fixed,free",
      "-cells 8 -ppc 1 -jitter 0.9",
      "-cells 8 -ppc 2 -jitter 0.7 -material two -density_ratio 50 -stiffness_ratio 3 -boundary fixed",
      "-cells 8 -ppc 3 -jitter 0.7 -fill 0,5 -boundary symmetry,free",
      "-dim 2 -cells 4 -ppc 2,1 -jitter 0.9 -poisson 0.3",
      "-dim 2 -cells 3 -ppc 2 -boundary fixed -poisson 0.5"};

  PetscFunctionBegin;
  PetscCall(
      PetscSNPrintf(options, room, "-formulation %s -transfer %s -basis %s -gradient %s %s -seed %d -courant %.4f",
                    CHOICE(n, 0, formulations), CHOICE(n, 1, transfers), CHOICE(n, 2, bases), CHOICE(n, 3, gradients),
                    layouts[n % PETSC_STATIC_ARRAY_LENGTH(layouts)], (int)n, 0.3 + 2.5 * MpmHash(n, 77)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define SCENES 70

/* No eigenvalue has an abs above 1, but for real ones below -1. */
static PetscErrorCode CheckGrowing(void)
{
  PetscInt growing = 0;

  PetscFunctionBegin;
  for (PetscInt n = 0; n < SCENES; n++) {
    char         options[512];
    PetscBool    turn = PETSC_FALSE;
    MpmScene    *scene;
    MpmOperator *op;
    MpmEigen    *all;

    PetscCall(CheckHasTurn(n, &turn));
    if (!turn) continue;
    PetscCall(RandomScene(n, sizeof options, options));
    PetscCall(CheckScene(options, &scene));
    CHECK(MpmLeftmostDecides(&scene->layout, &scene->scheme, &scene->step), "%s: not decided", options);
    PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
    PetscCall(MpmEigenSolve(op->balanced, NULL, MPM_EIGEN_DENSE, NULL, &all));
    for (PetscInt j = 0; j < all->n; j++) {
      if (hypot(all->re[j], all->im[j]) <= 1 + 1e-5)
        continue; /* a defective pair at 1 splits by 1e-6 where masses differ */
      growing++;
      CHECK(all->re[j] < -1 && fabs(all->im[j]) <= 1e-6 * fabs(all->re[j]), "%s: %.9g %+.9gi grows", options,
            all->re[j], all->im[j]);
    }
    PetscCall(MpmEigenDestroy(&all));
    PetscCall(MpmOperatorDestroy(&op));
    PetscCall(MpmSceneDestroy(&scene));
  }
  CHECK(growing > 20, "%d eigenvalues grow", (int)growing);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The leftmost eigenvalues are those of all, and 1 is listed beside them. Where they do not decide nobody says so. */
static PetscErrorCode CheckLeftmost(const char options[], PetscBool grows)
{
  MpmScene    *scene;
  MpmOperator *op;
  MpmReduced  *nodal;
  MpmEigen    *all, *left;
  PetscReal    least = INFINITY, found = INFINITY;
  PetscBool    has_one = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  CHECK(MpmLeftmostDecides(&scene->layout, &scene->scheme, &scene->step), "%s", options);
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmNodalMatrixOf(op, &nodal));
  PetscCall(MpmEigenSolveReduced(op->balanced, nodal, NULL, MPM_EIGEN_DENSE, NULL, &all));
  PetscCall(MpmEigenSolveReduced(op->balanced, nodal, NULL, MPM_EIGEN_LEFTMOST, NULL, &left));
  CHECK(left->leftmost && !left->largest && all->complete && !all->leftmost, "%s: %d found", options, (int)left->n);
  for (PetscInt j = 0; j < all->n; j++) least = PetscMin(least, all->re[j]);
  for (PetscInt j = 0; j < left->n; j++) {
    found = PetscMin(found, left->re[j]);
    if (left->re[j] == 1 && left->im[j] == 0) has_one = PETSC_TRUE;
  }
  CHECK_NEAR(found, least, 1e-7);
  CHECK(has_one && (found < -1) == grows, "%s: leftmost %.9g", options, found);
  PetscCall(MpmEigenDestroy(&all));
  PetscCall(MpmEigenDestroy(&left));
  PetscCall(MpmReducedDestroy(&nodal));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckUndecided(const char options[])
{
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  CHECK(!MpmLeftmostDecides(&scene->layout, &scene->scheme, &scene->step), "%s: decided", options);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckDecisions(void)
{
  PetscFunctionBegin;
  PetscCall(CheckGrowing());
  PetscCall(CheckLeftmost("-formulation usl -cells 60 -ppc 3 -jitter 0.9 -courant 0.5", PETSC_FALSE));
  PetscCall(
      CheckLeftmost("-formulation musl -transfer apic -dim 2 -cells 6 -ppc 2 -jitter 0.8 -courant 1.9", PETSC_TRUE));
  PetscCall(CheckUndecided("-formulation usl -cells 8 -ppc 2 -drift 1/8"));
  PetscCall(CheckUndecided("-formulation gas2 -cells 8 -ppc 2"));
  PetscCall(CheckUndecided("-formulation usl -transfer aflip -cells 8 -ppc 2"));
  PetscCall(CheckUndecided("-formulation usl -transfer tpic -cells 8 -ppc 2"));
  PetscCall(CheckUndecided("-formulation usl -cells 8 -ppc 2 -fill 0,4"));
  PetscCall(CheckUndecided("-formulation usl -cells 8 -ppc 2 -boundary fixed_reaction,free"));
  PetscCall(CheckUndecided("-formulation usl -cells 8 -ppc 2 -basis quadratic -prestress 0.1"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The leading eigenvalue of a random layout, its condition by lifted vectors, and the number of unknowns a node. */
static PetscErrorCode CheckCondition(const char options[])
{
  MpmScene    *scene;
  MpmOperator *op;
  MpmReduced  *nodal;
  MpmEigen    *small, *all;
  PetscReal    condition[2];

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmNodalMatrixOf(op, &nodal));
  for (MpmEigenMethod method = MPM_EIGEN_DENSE; method <= MPM_EIGEN_LARGEST; method++) {
    PetscReal target[2] = {NAN, NAN};

    PetscCall(MpmEigenSolve(op->balanced, NULL, MPM_EIGEN_DENSE, NULL, &all));
    target[0] = all->re[0] * (1 + 1e-9);
    target[1] = all->im[0] * (1 + 1e-9);
    PetscCall(MpmEigenSolveReduced(op->balanced, nodal, NULL, method, target, &small));
    CHECK(small->n > 0 && small->residual[0] <= 1e-9, "%s: method %d finds none", options, (int)method);
    if (small->n) {
      CHECK_NEAR(hypot(small->re[0], small->im[0]), hypot(all->re[0], all->im[0]), 1e-9 * all->norm);
      PetscCall(MpmEigenCondition(small, 0, &condition[0]));
      PetscCall(MpmEigenCondition(all, 0, &condition[1]));
      CHECK_NEAR(condition[0], condition[1], 1e-6 * condition[1]);
    }
    PetscCall(MpmEigenDestroy(&small));
    PetscCall(MpmEigenDestroy(&all));
  }
  PetscCall(MpmReducedDestroy(&nodal));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* B and its transpose are transposes of each other: y . B x = x . B^T y */
static PetscErrorCode CheckTranspose(const char options[])
{
  MpmScene   *scene;
  MpmReduced *r;
  Vec         x, y, bx, by;
  PetscReal   dot[2];
  PetscRandom random;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmNodalMatrixCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, NULL, &r));
  PetscCall(MatCreateVecs(r->B, &x, &bx));
  PetscCall(VecDuplicate(x, &by));
  PetscCall(VecDuplicate(bx, &y));
  PetscCall(PetscRandomCreate(PETSC_COMM_WORLD, &random));
  PetscCall(VecSetRandom(x, random));
  PetscCall(VecSetRandom(y, random));
  PetscCall(PetscRandomDestroy(&random));
  PetscCall(MatMult(r->B, x, bx));
  PetscCall(MatMultTranspose(r->B, y, by));
  PetscCall(VecDot(y, bx, &dot[0]));
  PetscCall(VecDot(x, by, &dot[1]));
  CHECK(fabs(dot[0]) > 1e-3, "%s: B x is %.3g", options, dot[0]);
  CHECK_NEAR(dot[0], dot[1], 1e-13 * fabs(dot[0]));
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&bx));
  PetscCall(VecDestroy(&by));
  PetscCall(MpmReducedDestroy(&r));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where masses differ M is balanced: no column is large. */
static PetscErrorCode CheckBalance(const char options[])
{
  MpmScene   *scene;
  MpmReduced *r;
  PetscReal   norm;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmNodalMatrixCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, NULL, &r));
  PetscCall(MatNorm(r->M, NORM_1, &norm));
  CHECK(norm < 10, "%s: norm %g", options, norm);
  PetscCall(MpmReducedDestroy(&r));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckUnknowns(const char options[], PetscInt64 expected)
{
  MpmScene  *scene;
  PetscInt64 unknowns;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmNodalMatrixUnknowns(&scene->layout, &scene->scheme, &scene->step, &unknowns));
  CHECK(unknowns == expected, "%s: %d unknowns", options, (int)unknowns);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Limits and growths of tasks, with the nodes' operator and without. */
static PetscErrorCode CheckTasks(void)
{
  MpmScene       *scene;
  MpmCritical     with, without;
  MpmCriticalCase of;
  MpmEnsemble    *e[2];

  PetscFunctionBegin;
  PetscCall(CheckScene("-formulation usl -cells 12 -ppc 3 -jitter 0.9 -boundary fixed-free", &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &with));
  of.all_particles = PETSC_TRUE;
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &without));
  CHECK(with.nodal == 26 && with.order == 72 && without.nodal == 0, "orders %d, %d", (int)with.nodal, (int)with.order);
  CHECK_NEAR(with.courant, without.courant, 2e-7 * without.courant); /* both are bisected to 1e-7 */
  CHECK_NEAR(with.null_share, without.null_share, 1e-4);
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(CheckScene("-formulation usl -cells 8 -ppc 2 -jitter 0.9 -courant 0.85", &scene));
  for (int nodal = 0; nodal < 2; nodal++) {
    check_request.layouts = 6;
    check_request.nodal   = nodal ? PETSC_TRUE : PETSC_FALSE;
    PetscCall(MpmEnsembleCreate(scene, &check_request, &e[nodal]));
  }
  CHECK(e[1]->nodal == 16 && e[0]->nodal == 0, "order %d", (int)e[1]->nodal);
  CHECK(e[0]->unstable > 0, "no layout of the ensemble grows");
  for (PetscInt i = 0; i < 6; i++) {
    CHECK_NEAR(e[1]->growth[i], e[0]->growth[i], 1e-12 * e[0]->growth[i]);
    CHECK(e[1]->verdict[i] == e[0]->verdict[i], "layout %d: another verdict", (int)i);
    CHECK(isfinite(e[1]->uncertainty[i]), "layout %d: uncertainty %g", (int)i, e[1]->uncertainty[i]);
  }
  for (int nodal = 0; nodal < 2; nodal++) PetscCall(MpmEnsembleDestroy(&e[nodal]));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(CheckAll());
  PetscCall(CheckCondition("-formulation usl -cells 10 -ppc 3 -jitter 0.9 -courant 1.3"));
  PetscCall(CheckCondition("-formulation musl -transfer apic -dim 2 -cells 3 -ppc 2 -jitter 0.5 -courant 2.5"));
  PetscCall(CheckTranspose("-formulation usl -cells 8 -ppc 2 -jitter 0.5"));
  PetscCall(CheckTranspose("-formulation musl -transfer apic -dim 2 -cells 3 -ppc 2 -boundary fixed -basis cubic"));
  PetscCall(CheckTranspose("-formulation usavg -transfer xpic -cells 8 -ppc 2 -boundary fixed_reaction-fixed"));
  PetscCall(CheckUnknowns("-formulation usl -cells 8 -ppc 2 -drift 1/8", 0)); /* particles move */
  PetscCall(CheckUnknowns("-formulation usl -cells 8 -ppc 1", 0));            /* as many as of the particles */
  PetscCall(CheckUnknowns("-formulation usl -dim 3 -cells 4 -ppc 2", 6 * 64));
  PetscCall(CheckBalance("-formulation usl -cells 8 -ppc 3 -jitter 0.5 -material two -density_ratio 1e9"));
  PetscCall(CheckTasks());
  PetscCall(CheckDecisions());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
