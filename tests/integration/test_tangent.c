/*
   The tangent of a nonlinear step. The step that it is made of is compared with the march's, and the tangent with central
   differences of this step, its transpose with itself, and its matrix with its products. Its eigenvalues about a uniform
   state are compared with those of an independent program, and what a run says of its tangents with their matrices.
*/
#include "analysis/run.h"
#include "analysis/spectrum.h"
#include "base/hash.h"
#include "check.h"
#include "operator/tangent.h"
#include "oracle.h"
#include "singular.h"
#include <slepcsys.h>

#define FEWER 3    /* on several ranks one case in so many is tried for each rank */
#define SMALL 2e-4 /* of perturbations; two sizes and Richardson's extrapolation leave an error of their fourth power */

static PetscErrorCode HasTurn(PetscInt i, PetscBool *turn)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  *turn = i % (size > 1 ? FEWER * size : 1) == 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A vector of numbers in [-size, size), the same on any number of ranks. */
static PetscErrorCode Fill(PetscInt64 seed, PetscReal size, PetscReal mean, Vec v)
{
  PetscInt   begin, end;
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(v, &begin, &end));
  PetscCall(VecGetArray(v, &x));
  for (PetscInt i = begin; i < end; i++) x[i - begin] = mean + size * (2 * MpmHash(seed, i) - 1);
  PetscCall(VecRestoreArray(v, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A state with jittered places, and F about the identity. */
static PetscErrorCode FillState(const MpmScene *scene, const MpmTangentSpace *space, MpmTangentState *state)
{
  const MpmTable *t = scene->scheme.table;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < space->sizes.particles; p++) {
    PetscInt  cell[MPM_MAX_DIM];
    PetscReal xi[MPM_MAX_DIM];

    MpmLayoutPlaceAt(&scene->layout, scene->step.drift, space->sizes.begin + p, 0, cell, xi);
    for (PetscInt a = 0; a < t->dim; a++) {
      state->places.cell[a][p] = cell[a];
      state->places.xi[a][p]   = xi[a];
    }
  }
  for (PetscInt f = 0; f < t->nstate; f++) {
    const PetscInt  c        = f - t->stretch;
    const PetscBool diagonal = c >= 0 && c < t->dim * t->dim && c % (t->dim + 1) == 0 ? PETSC_TRUE : PETSC_FALSE;

    PetscReal middle = diagonal ? 1.1 : 0;

    if (c >= t->dim * t->dim && c < MpmTableStretches(t))
      (void)MpmMaterialInternal(&t->material, t->dim, c - t->dim * t->dim, &middle);
    PetscCall(Fill(100 + f, 0.1, middle, state->field[f]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* other = state + a d */
static PetscErrorCode Shift(const MpmTangentSpace *space, const MpmTangentState *state, PetscReal a, Vec d,
                            MpmTangentState *other)
{
  const PetscInt   dim = space->sizes.layout->dim, n = space->nstate;
  const PetscReal *x;

  PetscFunctionBegin;
  PetscCall(VecGetArrayRead(d, &x));
  for (PetscInt p = 0; p < space->sizes.particles; p++)
    for (PetscInt c = 0; c < dim; c++) {
      const PetscReal place = state->places.xi[c][p] + a * x[n * p + c];

      other->places.cell[c][p] = state->places.cell[c][p] + (PetscInt)floor(place);
      other->places.xi[c][p]   = place - floor(place);
    }
  for (PetscInt f = dim; f < n; f++) {
    PetscReal *q;

    PetscCall(VecCopy(state->field[f - dim], other->field[f - dim]));
    PetscCall(VecGetArray(other->field[f - dim], &q));
    for (PetscInt p = 0; p < space->sizes.particles; p++) q[p] += a * x[n * p + f];
    PetscCall(VecRestoreArray(other->field[f - dim], &q));
  }
  PetscCall(VecRestoreArrayRead(d, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y += weight (step(state + a d) - where the places were) */
static PetscErrorCode AddStep(MpmTangentSpace *space, PetscReal courant, const MpmTangentState *state, PetscReal a,
                              Vec d, PetscReal weight, Vec y)
{
  const PetscInt   dim = space->sizes.layout->dim, n = space->nstate;
  MpmTangentState  other;
  Vec              after[MPM_MAX_STATE];
  PetscReal       *sum;
  const PetscReal *x;
  Mat              tangent;

  PetscFunctionBegin;
  PetscCall(MpmTangentStateCreate(space, &other));
  PetscCall(Shift(space, state, a, d, &other));
  for (PetscInt f = 0; f < n; f++) PetscCall(VecDuplicate(state->field[0], &after[f]));
  PetscCall(MpmTangentOf(space, courant, &other, &tangent, after));
  PetscCall(VecGetArray(y, &sum));
  PetscCall(VecGetArrayRead(d, &x));
  for (PetscInt f = 0; f < n; f++) {
    const PetscReal *q;

    PetscCall(VecGetArrayRead(after[f], &q));
    for (PetscInt p = 0; p < space->sizes.particles; p++)
      sum[n * p + f] += weight * (q[p] + (f < dim ? a * x[n * p + f] : 0));
    PetscCall(VecRestoreArrayRead(after[f], &q));
    PetscCall(VecDestroy(&after[f]));
  }
  PetscCall(VecRestoreArrayRead(d, &x));
  PetscCall(VecRestoreArray(y, &sum));
  PetscCall(MatDestroy(&tangent));
  PetscCall(MpmTangentStateDestroy(space, &other));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckTangent(const char options[])
{
  static const PetscReal part[] = {1, 0.5, 0.25}, weight[] = {1. / 45, -20. / 45, 64. / 45};
  MpmScene              *scene;
  MpmTangentSpace        space;
  MpmTangentState        state;
  Mat                    tangent, matrix;
  Vec                    d, y, z;
  PetscReal              norm, error, left, right;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmTangentSpaceCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &space));
  PetscCall(MpmTangentStateCreate(&space, &state));
  PetscCall(FillState(scene, &space, &state));
  PetscCall(MpmTangentOf(&space, scene->step.courant, &state, &tangent, NULL));
  PetscCall(MatCreateVecs(tangent, &d, &y));
  PetscCall(VecDuplicate(y, &z));
  PetscCall(Fill(7, 1, 0, d));
  PetscCall(MatMult(tangent, d, y));
  PetscCall(VecNorm(y, NORM_INFINITY, &norm));
  PetscCall(VecSet(z, 0));
  for (int i = 0; i < 3; i++)
    for (int sign = -1; sign <= 1; sign += 2)
      PetscCall(AddStep(&space, scene->step.courant, &state, sign * part[i] * SMALL, d,
                        sign * weight[i] / (2 * part[i] * SMALL), z));
  PetscCall(VecAXPY(z, -1, y));
  PetscCall(VecNorm(z, NORM_INFINITY, &error));
  CHECK(error <= 1e-10 * norm, "%s: the tangent is off by %.3g of %.3g", options, error, norm);
  PetscCall(MpmTangentAssemble(tangent, &matrix));
  PetscCall(MatMult(matrix, d, z));
  PetscCall(VecAXPY(z, -1, y));
  PetscCall(VecNorm(z, NORM_INFINITY, &error));
  CHECK(error <= 1e-13 * norm, "%s: the matrix is off by %.3g of %.3g", options, error, norm);
  PetscCall(Fill(8, 1, 0, z));
  PetscCall(VecDot(z, y, &left));
  PetscCall(MatMultTranspose(tangent, z, y));
  PetscCall(VecDot(d, y, &right));
  CHECK(fabs(left - right) <= 1e-12 * (norm * PetscMax(1, fabs(left))), "%s: y . A x = %.17g, A^T y . x = %.17g",
        options, left, right);
  PetscCall(MatDestroy(&matrix));
  PetscCall(MatDestroy(&tangent));
  PetscCall(VecDestroy(&d));
  PetscCall(VecDestroy(&y));
  PetscCall(VecDestroy(&z));
  PetscCall(MpmTangentStateDestroy(&space, &state));
  PetscCall(MpmTangentSpaceDestroy(&space));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The product of the tangents of the next steps of a march, as a matrix; and by how much their steps differ from its. */
static PetscErrorCode ProductOf(MpmMarch *march, PetscInt steps, PetscReal *mismatch, Mat *product)
{
  MpmTangentSpace space;

  PetscFunctionBegin;
  PetscCall(MpmTangentSpaceCreate(PETSC_COMM_WORLD, march->layout, march->scheme, &space));
  *mismatch = 0;
  for (PetscInt i = 0; i < steps; i++) {
    PetscReal one;
    Mat       tangent, A, both;

    PetscCall(MpmTangentMismatch(&space, march, &tangent, &one));
    *mismatch = PetscMax(*mismatch, one);
    PetscCall(MpmTangentAssemble(tangent, &A));
    PetscCall(MatDestroy(&tangent));
    if (i) {
      PetscCall(MatMatMult(A, *product, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &both));
      PetscCall(MatDestroy(product));
      PetscCall(MatDestroy(&A));
      A = both;
    }
    *product = A;
  }
  PetscCall(MpmTangentSpaceDestroy(&space));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The step of the tangent and that of the march, where particles fill a shape, or a body force depends on place and time. */
static PetscErrorCode CheckMarch(const char options[])
{
  MpmScene       *scene;
  MpmMarch       *march;
  MpmTangentSpace space;
  PetscReal       mismatch = NAN;
  PetscInt        n;
  Mat             tangent;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(MpmTangentSpaceCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &space));
  for (int step = 0; step < 3; step++) {
    PetscCall(MpmTangentMismatch(&space, march, &tangent, &mismatch));
    PetscCall(MatGetSize(tangent, &n, NULL));
    CHECK(n == space.nstate * scene->layout.particles, "%s: order %d", options, (int)n);
    CHECK(mismatch <= 1e-13, "%s: the tangent's step and the march's differ by %.3g", options, mismatch);
    PetscCall(MatDestroy(&tangent));
  }
  PetscCall(MpmTangentSpaceDestroy(&space));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A row of the independent program: growth about a uniform state, which may move through the grid. */
static PetscErrorCode CheckRow(const char row[], const char options[], PetscReal growth)
{
  static PetscInt taken;
  char            finite[640];
  MpmScene       *scene;
  MpmMarch       *march;
  MpmSpectrum    *s;
  Mat             product;
  PetscInt        period;
  PetscReal       mismatch;
  PetscBool       turn = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(HasTurn(taken++, &turn));
  if (!turn) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscSNPrintf(finite, sizeof finite, "-kinematics finite -initial random -amplitude 1e-300 %s", options));
  PetscCall(CheckScene(finite, &scene));
  PetscCall(MpmStepPeriod(&scene->step, &period));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(ProductOf(march, period, &mismatch, &product));
  CHECK(mismatch <= 1e-13, "%s: the tangent's step and the march's differ by %.3g", row, mismatch);
  PetscCall(MpmSpectrumOfMatrix("the product", product, period, NULL, &check_request, 0, &s));
  CHECK(fabs(PetscMax(1, s->growth) - growth) <= 1e-6, "%s: %.10g", row, s->growth);
  PetscCall(MpmSpectrumDestroy(&s));
  PetscCall(MatDestroy(&product));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The dense matrix of a parallel one, by columns, on every rank. */
static PetscErrorCode Gather(Mat A, PetscInt n, PetscReal dense[])
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(dense, n * n));
  PetscCall(MatGetOwnershipRange(A, &begin, &end));
  for (PetscInt i = begin; i < end; i++) {
    PetscInt           count;
    const PetscInt    *column;
    const PetscScalar *value;

    PetscCall(MatGetRow(A, i, &count, &column, &value));
    for (PetscInt c = 0; c < count; c++) dense[n * column[c] + i] = value[c];
    PetscCall(MatRestoreRow(A, i, &count, &column, &value));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, dense, (PetscMPIInt)(n * n), MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* log abs(det A) by LAPACK. A is overwritten. */
static PetscErrorCode LogDeterminant(PetscInt n, PetscReal a[], PetscReal *log_det)
{
  PetscBLASInt order = (PetscBLASInt)n, info, *pivot;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &pivot));
  PetscCallBLAS("LAPACKgetrf", LAPACKgetrf_(&order, &order, a, &order, pivot, &info));
  CHECK(info == 0, "dgetrf: %d", (int)info);
  *log_det = 0;
  for (PetscInt i = 0; i < n; i++) *log_det += log(fabs(a[n * i + i]));
  PetscCall(PetscFree(pivot));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A run with its tangent. The sum of all exponents is the logarithm of the determinant of the product, and the norm of a
   window is its largest singular value. With stretch 1 the scaled state is the state.
*/
static PetscErrorCode CheckRun(const char options[])
{
  MpmScene *scene;
  MpmMarch *march;
  MpmRun   *run;
  Mat       product;
  PetscInt  n;
  PetscReal mismatch, *dense, *copy, ends[2], log_det = NAN, sum = 0;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmRunCreate(scene, &check_request, NULL, 0, &run));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(ProductOf(march, (PetscInt)check_request.steps, &mismatch, &product));
  CHECK(mismatch <= 1e-13, "%s: the tangent's step and the march's differ by %.3g", options, mismatch);
  PetscCall(MatGetSize(product, &n, NULL));
  PetscCall(PetscMalloc2(n * n, &dense, n * n, &copy));
  PetscCall(Gather(product, n, dense));
  PetscCall(PetscArraycpy(copy, dense, n * n));
  PetscCall(LogDeterminant(n, copy, &log_det));
  PetscCall(DenseSingular(n, dense, ends));
  for (PetscInt i = 0; i < run->tangents->exponents; i++) sum += run->tangents->log_growth[i];
  CHECK(run->tangents->exponents == n, "%s: %d of %d", options, (int)run->tangents->exponents, (int)n);
  CHECK(fabs(sum - log_det) <= 1e-9 * n, "%s: exponents %.12g, determinant %.12g", options, sum, log_det);
  CHECK(run->tangents->nwindows == 1, "%s: %d windows", options, (int)run->tangents->nwindows); /* one of all steps */
  CHECK_NEAR(run->tangents->at[0].norm, ends[1], 1e-5 * ends[1]);
  PetscCall(PetscFree2(dense, copy));
  PetscCall(MatDestroy(&product));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckTangents(void)
{
  static const char *const spaces[]  = {"-cells 7 -ppc 2", "-dim 2 -cells 5,4 -ppc 2", "-dim 3 -cells 3,4,3 -ppc 1"};
  static const PetscInt    every[]   = {1, 5, 10};
  static const char *const schemes[] = {"usl", "usf", "musl", "usavg", "verlet", "rk -rk_on nodes -move_share 0.8"};
  static const char *const kinds[]   = {"-basis quadratic",
                                        "-basis cubic -transfer pic",
                                        "-basis quadratic -transfer apic -gradient mls -boundary fixed",
                                        "-basis gimp -transfer blend",
                                        "-basis linear -transfer tpic",
                                        "-basis cubic -transfer xpic -gradient mls",
                                        "-basis gimp -transfer aflip -gradient mls"};
  const PetscInt           nkinds    = PETSC_STATIC_ARRAY_LENGTH(kinds);
  PetscInt                 taken     = 0;
  char                     options[512];

  PetscFunctionBegin;
  for (PetscInt d = 0; d < 3; d++)
    for (PetscInt i = d; i < 6 * nkinds; i += every[d]) { /* 6 and 7 have no divisor in common */
      PetscBool turn = PETSC_FALSE;

      PetscCall(HasTurn(taken++, &turn));
      if (!turn) continue;
      PetscCall(
          PetscSNPrintf(options, sizeof options,
                        "-kinematics finite -material neo -lame_ratio 0.7 %s -formulation %s %s -jitter 0.2 -seed 3",
                        spaces[d], schemes[i % 6], kinds[i % nkinds]));
      PetscCall(CheckTangent(options));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Stages that move particles, with the weights of new places in each. */
static PetscErrorCode CheckStages(void)
{
  static const char *const kinds[] = {
      "-cells 9 -ppc 2 -basis quadratic", "-cells 9 -ppc 2 -basis cubic -rk kg5 -boundary fixed,free",
      "-dim 2 -cells 6,5 -ppc 2 -basis quadratic -gradient mls -rk rk3 -boundary fixed,periodic",
      "-dim 3 -cells 5,4,4 -ppc 1 -basis cubic -material svk"};
  char options[512];

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(kinds); i++) {
    PetscCall(
        PetscSNPrintf(options, sizeof options,
                      "-kinematics finite -material neo -lame_ratio 0.7 -formulation rk -rk_places stages -jitter 0.2 "
                      "-seed 3 %s",
                      kinds[i]));
    PetscCall(CheckTangent(options));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The implicit step, whose tangent is that of the solution of a nonlinear system. */
static PetscErrorCode CheckImplicit(void)
{
  static const char *const kinds[] = {
      "-cells 7 -ppc 2 -courant 3 -basis quadratic",
      "-cells 7 -ppc 2 -courant 2 -theta 1 -basis cubic -transfer fmpm -boundary fixed,free",
      "-dim 2 -cells 5,4 -ppc 2 -courant 1.5 -basis quadratic -transfer apic -gradient mls -boundary fixed,periodic",
      "-dim 2 -cells 5,4 -ppc 2 -courant 1.5 -basis cubic -transfer blend -theta 0.7 -material svk",
      "-dim 3 -cells 3,4,3 -ppc 1 -courant 1 -basis gimp -transfer pic"};
  char options[512];

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(kinds); i++) {
    PetscCall(PetscSNPrintf(
        options, sizeof options,
        "-kinematics finite -material neo -lame_ratio 0.7 -formulation implicit -jitter 0.2 -seed 3 %s", kinds[i]));
    PetscCall(CheckTangent(options));
  }
  PetscCall(CheckRun(
      "-kinematics finite -material neo -formulation implicit -basis quadratic -dim 2 -cells 6,4 -ppc 1 -jitter 0.3 "
      "-transfer blend -boundary fixed,periodic -gravity 0.1,-0.2 -mode 1,0 -amplitude 0.2 -steps 4 -courant 2 "
      "-tangent mode -window 4 -exponents 192"));
  PetscCall(CheckMarch(
      "-kinematics finite -material neo -formulation implicit -basis cubic -initial manufactured -cells 16 -ppc 4 "
      "-amplitude 0.05 -courant 1.5"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Bodies at rest, that move, and that rub: the tangent is that of the branch that the velocity of each node is on. */
static PetscErrorCode CheckColliders(void)
{
  static const char *const cells[][2] = {
      {"7", "7"}, {"5,4", "6,4"}, {"5,4", "6,4"}, {"3,4,3", "6,4,3"}}; /* a march wants more cells for three ranks */
  static const char *const kinds[] = {
      "-ppc 2 -formulation usl -basis quadratic -colliders "
      "{\"shape\":plane,\"point\":0.3,\"normal\":1,\"contact\":separating}",
      "-dim 2 -ppc 2 -formulation musl -basis quadratic -transfer apic -boundary fixed -colliders "
      "[{\"shape\":plane,\"point\":[0,0.4],\"normal\":[0.3,1],\"contact\":separating,\"friction\":0.4,\"velocity\":[0."
      "1,0.5]},"
      "{\"shape\":sphere,\"center\":[0.6,0.7],\"radius\":0.35,\"contact\":slip,\"friction\":0.3}]",
      "-dim 2 -ppc 2 -formulation usf -basis cubic -transfer blend -colliders "
      "[{\"shape\":box,\"center\":[0.5,0.5],\"size\":[0.5,0.6],\"contact\":sticky,\"velocity\":[-0.2,0.1]},"
      "{\"shape\":plane,\"point\":[0,0.3],\"normal\":[0,1],\"contact\":slip}]",
      "-dim 3 -ppc 1 -formulation rk -basis quadratic -colliders "
      "[{\"shape\":box,\"center\":[0.5,0.5,0.2],\"size\":[0.9,0.8,0.7],\"contact\":slip,\"friction\":0.5},"
      "{\"shape\":sphere,\"center\":[0.6,0.7,0.6],\"radius\":0.45,\"contact\":separating,\"velocity\":[0,0,-0.3]}]"};
  char options[1024];

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(kinds); i++) {
    PetscCall(PetscSNPrintf(options, sizeof options,
                            "-kinematics finite -material neo -lame_ratio 0.7 -jitter 0.2 -seed 3 -cells %s %s",
                            cells[i][0], kinds[i]));
    PetscCall(CheckTangent(options));
    PetscCall(PetscSNPrintf(
        options, sizeof options,
        "-kinematics finite -material neo -lame_ratio 0.7 -jitter 0.2 -seed 3 -initial random -amplitude 0.05 "
        "-courant 0.2 -cells %s %s",
        cells[i][1], kinds[i]));
    PetscCall(CheckMarch(options));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Materials that flow, and a viscous stress: where all particles do, and where none does. */
static PetscErrorCode CheckPlastic(void)
{
  static const char *const kinds[] = {
      "-material mises -hardening 0.02 -formulation usl -basis quadratic -cells 7",
      "-material mises -saturation 0.1 -formulation musl -basis cubic -transfer pic -dim 2 -cells 5,4",
      "-material mises -yield 10 -formulation usl -basis cubic -dim 2 -cells 5,4",
      "-material snow -hardening 3 -formulation usf -basis quadratic -transfer apic -gradient mls -dim 2 -cells 5,4",
      "-material sand -formulation musl -basis cubic -dim 2 -cells 5,4",
      "-material snow -hardening 3 -formulation usavg -basis quadratic -dim 3 -cells 3,4,3 -ppc 1"};
  char options[512];

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(kinds); i++) {
    PetscCall(
        PetscSNPrintf(options, sizeof options, "-kinematics finite -lame_ratio 0.7 -jitter 0.2 -seed 3 %s", kinds[i]));
    PetscCall(CheckTangent(options));
  }
  for (int flows = 0; flows < 2; flows++) {
    PetscCall(
        PetscSNPrintf(options, sizeof options,
                      "-kinematics finite -jitter 0.2 -seed 3 -material herschel_bulkley -shear_viscosity 3 -yield %g "
                      "-consistency 0.2 -flow_index 1.5 -formulation %s -basis cubic -dim 2 -cells 5,4",
                      flows ? 1e-4 : 100., flows ? "usl" : "musl"));
    PetscCall(CheckTangent(options));
  }
  PetscCall(
      CheckMarch("-kinematics finite -material mises -lame_ratio 1 -yield 0.01 -formulation usl -basis cubic -dim 2 "
                 "-cells 12 -shape discs -initial collision -amplitude 0.1 -courant 0.2"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscBool turn;

  PetscFunctionBegin;
  PetscCheck(argc > 1, PETSC_COMM_WORLD, PETSC_ERR_USER, "tangent FILE");
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(CheckTangents());
  PetscCall(CheckStages());
  PetscCall(CheckImplicit());
  PetscCall(CheckColliders());
  PetscCall(CheckPlastic());
  PetscCall(
      CheckTangent("-kinematics finite -material neo -lame_ratio 0.7 -formulation rk -rk kg5 -basis quadratic -dim 2 "
                   "-cells 5,4 -jitter 0.2 -boundary fixed,periodic"));
  PetscCall(HasTurn(1, &turn));
  if (turn)
    PetscCall(CheckTangent(
        "-kinematics finite -material neo -lame_ratio 0.7 -formulation musl -basis quadratic -transfer fmpm -dim 2 "
        "-cells 5,4 -jitter 0.2 -boundary fixed,periodic -viscosity 0.2 -shear_viscosity 0.1 -grid_damping 0.3"));
  PetscCall(OracleGrowthNonlinear(argv[1], 43, CheckRow));
  PetscCall(
      CheckRun("-kinematics finite -material neo -formulation usl -basis cubic -offset 0.3 -cells 6 -mode 1 -amplitude "
               "0.2 -steps 5 -tangent random -window 5 -exponents 36"));
  PetscCall(CheckRun(
      "-kinematics finite -material neo -formulation musl -basis quadratic -dim 2 -cells 6,4 -ppc 1 -jitter 0.3 "
      "-transfer blend -boundary fixed,periodic -gravity 0.1,-0.2 -mode 1,0 -amplitude 0.2 -steps 4 "
      "-tangent mode -window 4 -exponents 192"));
  PetscCall(CheckMarch(
      "-kinematics finite -material neo -formulation usl -basis cubic -dim 2 -cells 12 -shape discs -initial "
      "collision -amplitude 0.1 -courant 0.2"));
  PetscCall(CheckMarch(
      "-kinematics finite -material neo -formulation musl -basis cubic -initial manufactured -cells 16 -ppc 4 "
      "-amplitude 0.05 -courant 0.4"));
  /* particles go round in one direction, and there are walls in the other */
  PetscCall(CheckMarch(
      "-kinematics finite -material neo -formulation usl -basis quadratic -dim 2 -cells 4,6 -ppc 2 -jitter 0.3 "
      "-boundary periodic,symmetry -drift 0.9,0 -initial random -amplitude 0.01 -courant 0.3"));
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
