/*
   The largest stable Courant number of an assembled operator, for what has no symbol: walls, random layouts, missing
   particles, materials that vary.

   Under drift the operator is a polynomial in the Courant number k, so a matrix at one k takes products of small dense
   matrices instead of an assembly, and its eigenvalues can be followed as k grows (see follow.h).
*/
#include "analysis/critical_parts.h"
#include "analysis/follow.h"
#include "analysis/lone.h"
#include "analysis/modes.h"
#include "march/march_private.h"
#include "scene/layout.h"
#include "linalg/dense.h"
#include "linalg/eigen.h"
#include "linalg/matrix_polynomial.h"
#include "operator/nodal.h"
#include "operator/polynomial.h"
#include <mpmstab/symbol.h>
#include "base/progress.h"
#include <math.h>

#define FROM 1e-2
#define RATIO 1.5        /* of Courant numbers, one over the other, at rest */
#define DRIFT_WIDTH 0.02 /* largest step under drift where eigenvalues could not be followed */
#define PRECISION 1e-7
#define NEAR_LIMIT 1e-4 /* relative distance below the limit within which doubt does not matter */
#define ALL_MANY                                                                                                       \
  1000 /* unknowns beyond which the leftmost eigenvalue alone is sought where it decides: in a tenth of the time */
#define SPARSE_MANY 5e7   /* numbers of a sparse matrix: some 4 GiB for the few that are held at once */
#define MODE_ORDER 40000  /* largest order of which a mode is found by products */
#define APART 16          /* times so far beyond the limit growth is looked at next */
#define MOST_ORDER 100    /* unknowns: with more of them following takes minutes */
#define MOST_WORK 4e11    /* multiplications in all */
#define OF_EIGENVALUES 25 /* times the cube of the order: what all eigenvalues take */
#define SMALL 20          /* added to the order: small matrices cost more than their multiplications */
#define FEWEST 2000       /* places: where fewer can be afforded, following is not begun */
#define BEYOND 0.01       /* relative distance above the limit at which growth is compared with that of rounding */

typedef struct {
  const MpmCriticalCase *of;
  MpmProgress            progress;
  PetscBool              nodal; /* the nodes' own operator has the eigenvalues */
  PetscBool  leftmost;          /* too many for all of them: the leftmost, which decides, is found by a Krylov space */
  PetscReal  rounding;          /* growth per step that rounding may make of a defective pair */
  PetscInt64 evaluations;
} Probe;

/* Counts an evaluation and gives the step of a Courant number. */
static PetscErrorCode Begin(Probe *p, PetscReal courant, MpmStep *step)
{
  char note[128];

  PetscFunctionBegin;
  p->evaluations++;
  *step         = p->of->step;
  step->courant = courant;
  PetscCall(PetscSNPrintf(note, sizeof note, "%s at Courant number %.6g",
                          p->leftmost ? "leftmost eigenvalue" : "all eigenvalues", courant));
  PetscCall(MpmProgressNote(&p->progress, note));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Assemble(Probe *p, PetscReal courant, MpmOperator **op)
{
  MpmStep step;

  PetscFunctionBegin;
  PetscCall(Begin(p, courant, &step));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, p->of->layout, p->of->scheme, &step, op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By the leftmost eigenvalue; NaN: it was not found. */
static PetscErrorCode LeftmostGrowth(Probe *p, PetscReal courant, PetscReal *growth)
{
  PetscReal   least = INFINITY, norm;
  MpmReduced *nodal;
  MpmEigen   *eigen;
  MpmStep     step;

  PetscFunctionBegin;
  PetscCall(Begin(p, courant, &step));
  PetscCall(MpmNodalMatrixCreate(PETSC_COMM_WORLD, p->of->layout, p->of->scheme, &step, NULL, &nodal));
  PetscCall(MpmEigenSolve(nodal->M, NULL, MPM_EIGEN_LEFTMOST, NULL, &eigen));
  for (PetscInt i = 0; i < eigen->n; i++) least = PetscMin(least, eigen->re[i]);
  *growth = eigen->leftmost ? PetscMax(1, -least) : NAN;
  PetscCall(MatNorm(nodal->M, NORM_INFINITY, &norm));
  p->rounding = MpmDefectiveErrorOf(MpmOperatorErrorOf(norm, 0, 0), 0, 1);
  PetscCall(MpmEigenDestroy(&eigen));
  PetscCall(MpmReducedDestroy(&nodal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* By the nodes' own operator, where that may be, and else by the particles'. */
static PetscErrorCode Growth(void *context, PetscReal courant, PetscReal *growth)
{
  Probe       *p        = (Probe *)context;
  MpmOperator *op       = NULL;
  MpmReduced  *nodal    = NULL;
  PetscInt     exponent = 0, period = 1;
  PetscReal    value[2], norm;
  MpmStep      step;

  PetscFunctionBegin;
  if (p->leftmost) {
    PetscCall(LeftmostGrowth(p, courant, growth));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (p->nodal) {
    PetscCall(Begin(p, courant, &step));
    PetscCall(MpmNodalMatrixCreate(PETSC_COMM_WORLD, p->of->layout, p->of->scheme, &step, NULL, &nodal));
    PetscCall(MpmReducedLargest(nodal, value));
  } else {
    PetscCall(Assemble(p, courant, &op));
    PetscCall(MpmDenseLargest(op->balanced, value));
    exponent = op->exponent;
    period   = op->period;
  }
  PetscCheck(!isnan(value[0]), PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK dgeev did not converge");
  PetscCall(MatNorm(nodal ? nodal->M : op->balanced, NORM_INFINITY, &norm));
  p->rounding = MpmDefectiveErrorOf(MpmOperatorErrorOf(norm, 0, 0), exponent, period);
  *growth     = MpmGrowthPerStep(hypot(value[0], value[1]), exponent, period);
  PetscCall(MpmReducedDestroy(&nodal));
  PetscCall(MpmOperatorDestroy(&op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the nodes' own operator may take the place of the particles', which are compared at one Courant number. */
static PetscErrorCode TryNodal(Probe *p, PetscReal courant)
{
  MpmOperator *op;
  MpmReduced  *nodal;

  PetscFunctionBegin;
  PetscCall(Assemble(p, courant, &op));
  PetscCall(MpmNodalMatrixOf(op, &nodal));
  p->nodal = nodal ? PETSC_TRUE : PETSC_FALSE;
  p->evaluations--; /* no eigenvalues were taken */
  PetscCall(MpmReducedDestroy(&nodal));
  PetscCall(MpmOperatorDestroy(&op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the fastest particle of the first mode, and keeps all velocities if they are asked for. */
static PetscErrorCode Velocities(const MpmLayout *l, const MpmOperator *op, const MpmEigen *eigen, MpmCritical *c)
{
  PetscReal *v = c->each ? c->each + 2 * l->particles : NULL, *own = NULL;

  PetscFunctionBegin;
  if (!v) PetscCall(PetscMalloc1(l->dim * l->particles, &own));
  PetscCall(MpmModesVelocities(op, eigen, v ? v : own, &c->mode_at.id));
  if (c->mode_at.id != MPM_NONE) MpmLayoutRest(l, c->mode_at.id, c->mode_at.place);
  PetscCall(PetscFree(own));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds the mode that grows first, its phases beta, its type and its share in the null space of P2G. The first rank
   computes phases and type and sends them to all.
*/
static PetscErrorCode LimitingMode(Probe *p, MpmCritical *c)
{
  MpmOperator *op;
  MpmReduced  *nodal = NULL;
  MpmEigen    *eigen;
  MpmModes     modes;
  PetscReal    found[MPM_MAX_DIM + 1];

  PetscFunctionBegin;
  PetscCall(Assemble(p, c->unstable_at, &op));
  if (p->leftmost)
    PetscCall(MpmNodalMatrixCreate(PETSC_COMM_WORLD, p->of->layout, p->of->scheme, &op->step, op->unit, &nodal));
  else if (p->nodal)
    PetscCall(MpmNodalMatrixOf(op, &nodal));
  if (nodal)
    PetscCall(MpmEigenSolveReduced(op->balanced, nodal, NULL, p->leftmost ? MPM_EIGEN_LEFTMOST : MPM_EIGEN_DENSE, NULL,
                                   &eigen));
  else
    PetscCall(MpmEigenSolve(op->balanced, NULL, MPM_EIGEN_DENSE, NULL, &eigen));
  PetscCall(MpmModesCreate(op, eigen, PetscMin(eigen->n, 1), &modes));
  for (PetscInt a = 0; a <= MPM_MAX_DIM; a++) found[a] = NAN;
  if (modes.n) { /* the solver may find no vector even if it finds the growth */
    PetscCall(PetscArraycpy(found, modes.beta, modes.dim));
    found[MPM_MAX_DIM] = modes.p_share[0];
    c->null_share      = modes.null_share[0];
  }
  if (p->of->layout->given) PetscCall(Velocities(p->of->layout, op, eigen, c));
  PetscCallMPI(MPI_Bcast(found, MPM_MAX_DIM + 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscCall(PetscArraycpy(c->beta, found, modes.dim));
  if (!isnan(found[MPM_MAX_DIM])) c->wave = MpmCriticalWaveOf(found[MPM_MAX_DIM], found[MPM_MAX_DIM]);
  PetscCall(MpmModesDestroy(&modes));
  PetscCall(MpmEigenDestroy(&eigen));
  PetscCall(MpmReducedDestroy(&nodal));
  PetscCall(MpmOperatorDestroy(&op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- under drift ---- */

typedef struct {
  MpmPolynomial polynomial;
  PetscReal    *matrix, *re, *im;
} Factors;

static PetscErrorCode FactorsAt(void *context, PetscReal courant, double complex value[])
{
  Factors       *f = (Factors *)context;
  const PetscInt n = f->polynomial.order;
  PetscInt       exponent;
  int            failed;

  PetscFunctionBegin;
  PetscCall(MpmPolynomialMatrix(&f->polynomial, courant, f->matrix, &exponent));
  for (PetscInt i = 0; i < n * n; i++) {
    if (isfinite(f->matrix[i])) continue;
    for (PetscInt j = 0; j < n; j++) value[j] = INFINITY;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmDenseEigen(n, f->matrix, f->re, f->im, NULL, &failed));
  PetscCheck(!failed, PETSC_COMM_SELF, PETSC_ERR_LIB, "LAPACK dgeev did not converge");
  for (PetscInt i = 0; i < n; i++) value[i] = CMPLX(scalbn(f->re[i], (int)exponent), scalbn(f->im[i], (int)exponent));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What came of following to a Courant number. done: it got there or found growth, which is in the bracket
   (MpmFollowLine).
*/
typedef struct {
  PetscReal  to, bracket[2], doubtful;
  PetscInt64 evaluations;
  PetscBool  done;
} Way;

/* On one rank, with so many places to look at. */
static PetscErrorCode FollowFactors(const MpmCriticalCase *of, PetscInt64 allowed, Way *way)
{
  Factors   factors;
  MpmFollow follow;
  PetscInt  n;
  PetscReal from;

  PetscFunctionBegin;
  PetscCall(MpmPolynomialCreate(of->layout, of->scheme, &of->step, &factors.polynomial));
  n    = factors.polynomial.order;
  from = PetscMin(MPM_CRITICAL_FROM * PetscMin(factors.polynomial.scale, 1), way->to / 2);
  PetscCall(PetscMalloc3(n * n, &factors.matrix, n, &factors.re, n, &factors.im));
  PetscCall(MpmFollowCreate(n, factors.polynomial.period, of->tolerance, FactorsAt, &factors, &follow));
  follow.allowed = allowed;
  PetscCall(MpmFollowFirst(&follow, from, from, way->to, way->bracket));
  way->done        = isfinite(way->bracket[1]) || way->bracket[0] >= way->to ? PETSC_TRUE : PETSC_FALSE;
  way->doubtful    = follow.doubtful;
  way->evaluations = follow.evaluations;
  PetscCall(MpmFollowDestroy(&follow));
  PetscCall(PetscFree3(factors.matrix, factors.re, factors.im));
  PetscCall(MpmPolynomialDestroy(&factors.polynomial));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The result is not used where no growth was found up to the scene's own Courant number although there is growth there.
*/
static PetscErrorCode Follow(Probe *p, PetscReal to, PetscBool grows, MpmCritical *c)
{
  const MpmCriticalCase *of = p->of;
  const PetscReal        n = (PetscReal)(of->scheme->table->nstate * of->layout->particles), size = n + SMALL;
  Way                    way = {.to = to};
  PetscInt               period;
  PetscReal              allowed;

  PetscFunctionBegin;
  PetscCall(MpmProgressNote(&p->progress, "eigenvalues followed over Courant numbers"));
  PetscCall(MpmStepPeriod(&of->step, &period));
  allowed = MOST_WORK / (size * size * size * (period + OF_EIGENVALUES));
  if (n > MOST_ORDER || allowed < FEWEST) PetscFunctionReturn(PETSC_SUCCESS);
  if (MpmTableHas(of->scheme->table, MPM_IMPLICIT)) PetscFunctionReturn(PETSC_SUCCESS); /* it is no polynomial in k */
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) PetscCall(FollowFactors(of, (PetscInt64)allowed, &way));
  PetscCallMPI(MPI_Bcast(&way, sizeof way, MPI_BYTE, 0, PETSC_COMM_WORLD));
  p->evaluations += way.evaluations;
  if (!way.done || (grows && isinf(way.bracket[1]))) PetscFunctionReturn(PETSC_SUCCESS);
  c->followed    = PETSC_TRUE;
  c->stable_at   = way.bracket[0];
  c->unstable_at = way.bracket[1];
  c->doubtful    = way.doubtful < c->stable_at * (1 - NEAR_LIMIT) ? way.doubtful : INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- at rest ---- */

/* The nodal operator at a Courant number on the unknowns k^weight z, where it is linear in k^stride. */
static PetscErrorCode Weighted(const Probe *p, const MpmNodalPlan *plan, PetscReal courant, Mat *weighted)
{
  MpmStep     step = p->of->step;
  MpmReduced *nodal;
  PetscReal  *power;
  PetscInt    first, end;
  Vec         left, right;

  PetscFunctionBegin;
  step.courant = courant;
  PetscCall(MpmNodalMatrixCreate(PETSC_COMM_WORLD, p->of->layout, p->of->scheme, &step, NULL, &nodal));
  PetscCall(VecDuplicate(nodal->kept_small, &left));
  PetscCall(VecDuplicate(left, &right));
  PetscCall(VecGetOwnershipRange(left, &first, &end));
  PetscCall(VecGetArrayWrite(left, &power));
  for (PetscInt i = first; i < end; i++) power[i - first] = pow(courant, plan->weight[i % plan->nimages]);
  PetscCall(VecRestoreArrayWrite(left, &power));
  PetscCall(VecCopy(left, right));
  PetscCall(VecReciprocal(right));
  *weighted = nodal->M;
  PetscCall(PetscObjectReference((PetscObject)nodal->M));
  PetscCall(MatDiagonalScale(*weighted, left, right));
  PetscCall(VecDestroy(&left));
  PetscCall(VecDestroy(&right));
  PetscCall(MpmReducedDestroy(&nodal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least x at which C_0 + x C_1 has the eigenvalue -1. */
static PetscErrorCode LeastDense(Mat C0, Mat C1, PetscReal *x)
{
  double complex *at[2];
  PetscInt        n;

  PetscFunctionBegin;
  PetscCall(MatGetSize(C0, &n, NULL));
  PetscCall(PetscMalloc2((size_t)n * n, &at[0], (size_t)n * n, &at[1]));
  for (int j = 0; j < 2; j++) {
    PetscReal *real = (PetscReal *)at[j];

    PetscCall(MpmDenseCopy(j ? C1 : C0, real));
    for (PetscInt i = n * n - 1; i >= 0; i--) at[j][i] = real[i];
  }
  for (PetscInt i = 0; i < n; i++) at[0][i * (n + 1)] += 1;
  PetscCall(MpmPolynomialSingular(n, 1, at, x));
  PetscCall(PetscFree2(at[0], at[1]));
  PetscCallMPI(MPI_Bcast(x, 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How many numbers the nodal operator has at most: each node has all nodes that share a particle with it. */
static PetscReal Numbers(const Probe *p, const MpmNodalPlan *plan)
{
  const MpmLayout *l    = p->of->layout;
  PetscReal        near = 1;

  for (PetscInt a = 0; a < l->dim; a++) near *= 2 * p->of->scheme->basis->nodes - 1;
  return (PetscReal)plan->nimages * plan->nimages * (PetscReal)MpmLayoutNodes(l) * near;
}

/*
   The limit, where growth has real eigenvalues below -1 alone and the nodal operator is linear in k^stride; else NaN.
   The nodes may have more unknowns than the particles.
*/
static PetscErrorCode LinearLimit(const Probe *p, PetscReal *limit)
{
  MpmNodalPlan *plan;
  const char   *why;
  Mat           C0, C1;
  PetscBool     dense;

  PetscFunctionBegin;
  *limit = NAN;
  PetscCall(MpmNodalPlanCreate(p->of->scheme->table, &why, &plan));
  dense = plan && plan->nimages * MpmLayoutNodes(p->of->layout) <= MPM_DENSE_MANY ? PETSC_TRUE : PETSC_FALSE;
  if (plan && plan->degree == 1 && (dense || Numbers(p, plan) <= SPARSE_MANY)) {
    PetscCall(Weighted(p, plan, 1, &C0));
    PetscCall(Weighted(p, plan, 2, &C1));
    PetscCall(MatAXPY(C1, -1, C0, DIFFERENT_NONZERO_PATTERN));
    PetscCall(MatScale(C1, 1 / (exp2(plan->stride) - 1)));
    PetscCall(MatAXPY(C0, -1, C1, DIFFERENT_NONZERO_PATTERN));
    PetscCall(dense ? LeastDense(C0, C1, limit) : MpmPencilLeastKrylov(C0, C1, limit));
    *limit = pow(*limit, 1.0 / plan->stride);
    PetscCall(MatDestroy(&C0));
    PetscCall(MatDestroy(&C1));
  }
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the limit of the pencil if growth beside it says the same. */
static PetscErrorCode ByPencil(Probe *p, MpmCritical *c)
{
  PetscReal limit, growth;

  PetscFunctionBegin;
  PetscCall(LinearLimit(p, &limit));
  if (!(limit <= MPM_CRITICAL_TO)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Growth(p, limit * (1 - PRECISION), &growth));
  if (growth > 1 + p->of->tolerance) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscReal apart = PRECISION; !c->pencil && apart < BEYOND; apart *= APART) {
    c->unstable_at = limit * (1 + apart);
    PetscCall(Growth(p, c->unstable_at, &growth));
    c->pencil = growth > 1 + p->of->tolerance ? PETSC_TRUE : PETSC_FALSE;
  }
  c->stable_at = limit * (1 - PRECISION);
  c->courant   = limit;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes growth at the scene's own Courant number first. If there is growth, the limit is below it. */
static PetscErrorCode Search(Probe *p, PetscReal courant, MpmCritical *c)
{
  const PetscBool drifts = MpmStepDrifts(&p->of->step);
  MpmFinding     *asked  = &c->asked;
  MpmSearchSteps  steps  = {
        .from = FROM, .to = MPM_CRITICAL_TO, .ratio = RATIO, .width = drifts ? DRIFT_WIDTH : MPM_CRITICAL_TO};
  PetscReal bracket[2] = {0, INFINITY};
  PetscBool grows;

  PetscFunctionBegin;
  PetscCall(Growth(p, courant, &asked->growth));
  asked->uncertainty     = p->rounding;
  asked->defective_error = p->rounding;
  asked->verdict         = MpmVerdictOf(asked);
  PetscCall(PetscStrncpy(asked->evidence, "all eigenvalues", sizeof asked->evidence));
  grows = asked->growth <= 1 + p->of->tolerance ? PETSC_FALSE : PETSC_TRUE;
  if (drifts) PetscCall(Follow(p, grows ? courant : MPM_CRITICAL_TO, grows, c));
  if (c->followed) PetscFunctionReturn(PETSC_SUCCESS);
  if (!drifts && !MpmLeftmostDecides(p->of->layout, p->of->scheme, &p->of->step)) {
    PetscCall(MpmSearchScan(Growth, p, p->of->tolerance, courant, PRECISION, c));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!drifts) PetscCall(ByPencil(p, c));
  if (c->pencil) PetscFunctionReturn(PETSC_SUCCESS);
  if (grows) {
    steps.to   = courant;
    steps.from = PetscMin(FROM, courant / 2);
  }
  PetscCall(MpmSearchFirst(Growth, p, p->of->tolerance, &steps, PRECISION, bracket));
  c->stable_at   = bracket[0];
  c->unstable_at = bracket[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Where rounding makes more growth than the tolerance, and growth above the limit is not larger than that, the limit is
   not known.
*/
static PetscErrorCode CheckRounding(Probe *p, MpmCritical *c)
{
  PetscReal growth;

  PetscFunctionBegin;
  PetscCall(Growth(p, c->unstable_at * (1 + BEYOND), &growth));
  if (p->rounding <= p->of->tolerance || growth > 1 + p->rounding) PetscFunctionReturn(PETSC_SUCCESS);
  c->rounding = p->rounding;
  c->courant  = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* With damping or viscosity only courant auto takes bounds: it needs their parts apart. */
static const char *WhyNoBound(const MpmCriticalCase *of)
{
  if (MpmSpaceIsDamped(&of->scheme->space)) return "of a layout none is found here with damping or viscosity";
  return MpmStepBoundWhyNot(of->layout, of->scheme, &of->step);
}

/*
   The bounds of the layout, with a march that refuses a grid that no run could have. It is on one rank for few
   unknowns.
*/
static PetscErrorCode FindBounds(const MpmCriticalCase *of, MpmCritical *c)
{
  const PetscMPIInt n = (PetscMPIInt)of->layout->particles;
  MpmMarch         *march;

  PetscFunctionBegin;
  PetscCall(MpmMarchCreateRandom(c->too_large ? PETSC_COMM_WORLD : PETSC_COMM_SELF, of->layout, of->scheme, &of->step,
                                 1, &march));
  c->bounds =
      (MpmStepBounds){.kinds = MPM_BOUNDS, .sweeps = of->sweeps, .chance = of->chance, .seed = of->layout->seed};
  c->bounded = of->chance > 0 ? PETSC_TRUE : PETSC_FALSE;
  if (c->bounded) c->bounds.why_not = WhyNoBound(of);
  if (of->each) {
    PetscCall(PetscCalloc1((2 + of->layout->dim) * n, &c->each));
    c->bounds.lone_at.value     = c->each;
    c->bounds.particle_at.value = c->each + n;
  }
  if (c->bounded && !c->bounds.why_not) PetscCall(MpmStepBoundsFind(march, &c->bounds));
  if (of->each && c->too_large)
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, c->each, 2 * n, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD));
  for (PetscInt i = 0; of->each && i < (2 + of->layout->dim) * n; i++)
    c->each[i] = i < 2 * n && !c->bounds.why_not ? c->bounds.factor / sqrt(c->each[i]) : NAN;
  PetscCall(MpmMarchDestroy(&march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The limit of a layout with too many unknowns for all eigenvalues, where the leftmost decides. Nothing changes where a
   solver does not converge.
*/
static PetscErrorCode SearchLarge(Probe *p, PetscReal courant, MpmCritical *c)
{
  PetscReal growth = 1;

  PetscFunctionBegin;
  if (!MpmLeftmostDecides(p->of->layout, p->of->scheme, &p->of->step)) PetscFunctionReturn(PETSC_SUCCESS);
  p->leftmost = PETSC_TRUE;
  PetscCall(ByPencil(p, c));
  if (c->pencil && courant > c->courant) PetscCall(Growth(p, courant, &growth));
  if (!c->pencil || isnan(growth)) {
    p->leftmost = c->pencil = PETSC_FALSE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  c->leftmost              = PETSC_TRUE;
  c->too_large             = PETSC_FALSE;
  c->asked.growth          = growth;
  c->asked.uncertainty     = p->rounding;
  c->asked.defective_error = p->rounding;
  c->asked.verdict         = MpmVerdictOf(&c->asked);
  PetscCall(PetscStrncpy(c->asked.evidence,
                         "the leftmost eigenvalue; at rest this scheme grows by real ones below -1 alone",
                         sizeof c->asked.evidence));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a bound says of the case's own Courant number where no eigenvalue is known. */
static PetscErrorCode JudgeByBound(const MpmCriticalCase *of, MpmCritical *c)
{
  PetscFunctionBegin;
  c->courant = NAN;
  PetscCall(PetscStrncpy(c->asked.evidence, "no eigenvalues", sizeof c->asked.evidence));
  if (!c->bounds.why_not && of->step.courant <= PetscMax(c->bounds.lone, c->bounds.particle))
    PetscCall(MpmFindingDecide(&c->asked, "a bound by particles says that nothing grows here"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalAssembled(const MpmCriticalCase *of, const MpmCriticalStart *start, MpmCritical *c)
{
  const PetscInt64 order = of->scheme->table->nstate * of->layout->particles;
  PetscInt64       nodal = 0, unknowns;
  Probe            probe = {.of = of};
  char             size[MPM_SIZE_TEXT];

  PetscFunctionBegin;
  (void)start; /* there is no other place to begin */
  if (!of->all_particles) PetscCall(MpmNodalMatrixUnknowns(of->layout, of->scheme, &of->step, &nodal));
  unknowns = nodal ? nodal : order;
  MpmLayoutSizeText(of->layout, sizeof size, size);
  c->assembled = PETSC_TRUE;
  c->too_large = unknowns > MPM_DENSE_MANY ? PETSC_TRUE : PETSC_FALSE;
  MpmCheckInput(!c->too_large || (of->chance > 0 && !WhyNoBound(of)),
                "%s (%s): the limit is sought among all eigenvalues of %" PetscInt64_FMT
                " unknowns; allowed: at most %d, so fewer cells",
                size, MpmSymbolWhyNot(of->layout), unknowns, MPM_DENSE_MANY);
  c->order = (PetscInt)PetscMin(order, PETSC_MAX_INT);
  PetscCall(FindBounds(of, c));
  PetscCall(MpmProgressBegin("", &probe.progress));
  if (unknowns > ALL_MANY && !of->all_particles) PetscCall(SearchLarge(&probe, of->step.courant, c));
  if (c->too_large && !c->leftmost) {
    PetscCall(MpmProgressEnd(&probe.progress));
    PetscCall(JudgeByBound(of, c));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (nodal && !c->leftmost) PetscCall(TryNodal(&probe, of->step.courant));
  c->nodal = probe.nodal || c->leftmost ? (PetscInt)nodal : 0;
  if (!c->leftmost) PetscCall(Search(&probe, of->step.courant, c));
  if (!c->pencil) c->courant = INFINITY;
  if (isfinite(c->unstable_at)) {
    if (!c->windows.looked && !c->pencil) PetscCall(MpmSearchThreshold(Growth, &probe, of->tolerance, 0, c));
    if (!c->leftmost || order <= MODE_ORDER) PetscCall(LimitingMode(&probe, c));
    if (!c->pencil) c->courant = c->threshold || MpmStepDrifts(&of->step) ? c->stable_at : 0;
    PetscCall(CheckRounding(&probe, c));
  }
  PetscCall(MpmProgressEnd(&probe.progress));
  c->evaluations = probe.evaluations;
  PetscFunctionReturn(PETSC_SUCCESS);
}
