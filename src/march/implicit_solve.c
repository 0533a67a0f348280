/*
   Solves (M + a M K) y = M f on the grid of the march.

   Newton's method for the nodes of an implicit step at finite deformation. With v_i the velocity before the step, M the
   nodal masses and a_i its increment, the system is

     R(a_i) = M (a_i - k f(w)) = 0,    w = k (v_i + theta a_i),    f = - DIV T + the body force

   T = P((I + theta L) F) F^T, L = GRAD w, is the stress at the part theta of the step, brought back to its start
   (scheme/deform.c). For theta > 0 R is the gradient of the potential (a_i, a_i) / 2 + sum_p V_p psi((I + theta L) F) /
   theta^2, so that its matrix is symmetric; where the material softens it may be indefinite. Conjugate gradients stop
   at the first direction that shows it, and the line search goes along the direction that they have by then.

   Source: Gast, Schroeder, Stomakhin, Jiang and Teran 2015, optimization integrator; Stomakhin et al. 2013, section 4
*/
#include "march/implicit_solve.h"
#include "scheme/deform.h"
#include <mpmstab/errors.h>
#include <float.h>

#define RELATIVE 1e-12
#define ABSOLUTE 1e-300 /* an unstable or decaying run is rescaled: no residual is small by itself */
#define MOST_ITERATIONS 10000
#define ROUNDING 8       /* of the force of a stress of 1 on all nodes, in DBL_EPSILON */
#define LEAST_STEP 1e-14 /* an increment that changes no more has converged as far as it can */
#define MOST_NEWTON 50
#define INVERTED 1e100 /* the residual where a particle has no volume: the line search goes back */

/* ---- vectors and node registers ---- */

/* Copies a vector to the march's node registers from first on, or back. */
static PetscErrorCode Copy(const MpmMarch *march, PetscInt first, PetscBool back, Vec vector)
{
  const PetscInt dim = march->grid->dim;
  PetscReal     *v, *node;

  PetscFunctionBegin;
  PetscCall(VecGetArray(vector, &v));
  for (PetscInt c = 0; c < dim; c++) {
    PetscCall(MpmGridGetArray(march->grid, march->node[first + c], &node));
    PetscCall(MpmGridCopy(march->grid, back, dim, v + c, node));
    PetscCall(MpmGridRestoreArray(march->grid, march->node[first + c], &node));
  }
  PetscCall(VecRestoreArray(vector, &v));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same with their ghosts and the images beyond walls. */
static PetscErrorCode Spread(const MpmMarch *march, PetscInt first, Vec vector)
{
  const MpmGrid *grid = march->grid;
  PetscReal     *node[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(Copy(march, first, PETSC_FALSE, vector));
  for (PetscInt c = 0; c < grid->dim; c++) PetscCall(MpmGridGetArray(grid, march->node[first + c], &node[c]));
  PetscCall(MpmGridSum(grid, grid->dim, node));
  for (PetscInt c = 0; c < grid->dim; c++) {
    MpmGridImages(grid, march->layout->grid, march->scheme->table->parity[first + c], PETSC_FALSE, node[c]);
    PetscCall(MpmGridRestoreArray(grid, march->node[first + c], &node[c]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* vector = M (vector + add), add NULL: 0. With whole, nodes without mass have a mass of 1, else of 0. */
static PetscErrorCode Weigh(const MpmMarch *march, Vec add, PetscBool whole, Vec vector)
{
  const PetscInt   dim = march->grid->dim;
  const MpmGridBox box = MpmGridBoxOf(march->grid, 0);
  PetscReal       *v, *inverse;

  PetscFunctionBegin;
  if (add) PetscCall(VecAXPY(vector, 1, add));
  PetscCall(VecGetArray(vector, &v));
  PetscCall(MpmGridGetArray(march->grid, march->inverse_mass, &inverse));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscReal *m = inverse + MpmGridRow(march->grid, &box, r);

    for (PetscInt i = 0; i < dim * box.hi[0]; i++) {
      if (m[i / dim] > 0)
        v[dim * r * box.hi[0] + i] /= m[i / dim];
      else if (!whole)
        v[dim * r * box.hi[0] + i] = 0;
    }
  }
  PetscCall(MpmGridRestoreArray(march->grid, march->inverse_mass, &inverse));
  PetscCall(VecRestoreArray(vector, &v));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = what the table of the system makes of x: one pass over the particles. */
static PetscErrorCode RunPass(MpmImplicitSolve *s, Vec x, Vec y)
{
  PetscInt i = 0;

  PetscFunctionBegin;
  PetscCall(Spread(s->march, s->k->solved, x));
  while (s->march->implicit[i] != s) i++;
  PetscCall(s->march->engine->stiffness(s->march, s->step, i));
  PetscCall(Copy(s->march, s->k->image, PETSC_TRUE, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = (M + a M K) x: one pass over the particles. */
static PetscErrorCode Multiply(Mat matrix, Vec x, Vec y)
{
  MpmImplicitSolve *s;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &s));
  PetscCall(RunPass(s, x, y));
  PetscCall(VecScale(y, s->a));
  PetscCall(Weigh(s->march, x, PETSC_TRUE, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- Newton's method: the stress of particles ---- */

static void Stiffen(const MpmFiniteBlock *block, PetscInt n, PetscReal *const T[])
{
  for (PetscInt c = 0; c < n && block->stiffness; c++)
    for (PetscInt p = 0; p < block->n; p++) T[c][p] *= block->stiffness[p];
}

/* The tangent of a block of particles: the differential along each component of L. */
static void Linearise(MpmImplicitSolve *s, const MpmFiniteBlock *block)
{
  const PetscInt          dim = s->k->dim, n = dim * dim;
  const PetscReal         one[MPM_BLOCK] = {0}, *unit[MPM_MAX_DIM * MPM_MAX_DIM];
  PetscReal               ones[MPM_BLOCK], *column[MPM_MAX_DIM * MPM_MAX_DIM];
  const PetscReal *const *L = (const PetscReal *const *)block->from, *const *F =
                                                                         (const PetscReal *const *)block->stretch;

  for (PetscInt p = 0; p < block->n; p++) ones[p] = 1;
  for (PetscInt c = 0; c < n; c++) {
    for (PetscInt r = 0; r < n; r++) {
      unit[r]   = r == c ? ones : one;
      column[r] = s->tangent + (n * c + r) * s->room + block->begin;
    }
    MpmStressAheadTangent(&s->k->material, dim, block->n, block->a, L, F, unit, NULL, column);
    Stiffen(block, n, column);
  }
}

static void Product(const MpmImplicitSolve *s, const MpmFiniteBlock *block)
{
  const PetscInt n = s->k->dim * s->k->dim;

  for (PetscInt r = 0; r < n; r++) {
    PetscReal *restrict to = block->to[r];

    for (PetscInt c = 0; c < n; c++) {
      const PetscReal *restrict D = s->tangent + (n * c + r) * s->room + block->begin, *restrict from = block->from[c];

      for (PetscInt p = 0; p < block->n; p++) to[p] = D[p] * from[p] + (c ? to[p] : 0);
    }
  }
}

static void Stress(void *system, const MpmFiniteBlock *block)
{
  MpmImplicitSolve       *s   = system;
  const PetscInt          dim = s->k->dim;
  const PetscReal *const *L   = (const PetscReal *const *)block->from, *const *F =
                                                                         (const PetscReal *const *)block->stretch;

  if (s->does == MPM_AHEAD_PRODUCT) {
    Product(s, block);
    return;
  }
  if (MpmStressAhead(&s->k->material, dim, block->n, block->a, L, F, block->to) < block->n) s->inverted = PETSC_TRUE;
  Stiffen(block, dim * dim, block->to);
  if (s->does == MPM_AHEAD_TANGENT) Linearise(s, block);
}

/* ---- Newton's method: the system ---- */

static PetscErrorCode Pass(MpmImplicitSolve *s, MpmAhead does, Vec x, Vec y)
{
  const MpmSolving solving = {
      .stress = Stress, .system = s, .product = does == MPM_AHEAD_PRODUCT ? PETSC_TRUE : PETSC_FALSE};

  PetscFunctionBegin;
  s->does           = does;
  s->march->solving = &solving;
  PetscCall(RunPass(s, x, y));
  s->march->solving = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* R = M (a - k f(w)) */
static PetscErrorCode Force(MpmImplicitSolve *s, MpmAhead does, Vec a, Vec R)
{
  const PetscReal k = s->march->courant;

  PetscFunctionBegin;
  s->inverted = PETSC_FALSE;
  PetscCall(VecWAXPY(s->middle, s->k->theta, a, s->velocity));
  PetscCall(VecScale(s->middle, k));
  PetscCall(Pass(s, does, s->middle, R));
  PetscCall(VecAYPX(R, -k, a));
  PetscCall(Weigh(s->march, NULL, PETSC_TRUE, R));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &s->inverted, 1, MPIU_BOOL, MPI_LOR, PetscObjectComm((PetscObject)R)));
  if (s->inverted) PetscCall(VecSet(R, INVERTED));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Residual(SNES snes, Vec a, Vec R, void *context)
{
  PetscFunctionBegin;
  (void)snes;
  PetscCall(Force(context, MPM_AHEAD_STRESS, a, R));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Tangent(SNES snes, Vec a, Mat J, Mat blocks, void *context)
{
  MpmImplicitSolve *s     = context;
  const PetscInt    count = s->march->particles->count, n = s->k->dim * s->k->dim;
  const PetscReal   k = s->march->courant;
  PetscInt          iteration;

  PetscFunctionBegin;
  (void)J, (void)blocks;
  if (count > s->room || !s->tangent) {
    s->room = count + MpmParticlesRoom(s->march->particles) + 1;
    PetscCall(PetscFree(s->tangent));
    PetscCall(PetscMalloc1(n * n * s->room, &s->tangent));
  }
  PetscCall(Force(s, MPM_AHEAD_TANGENT, a, s->right));
  PetscCall(SNESGetIterationNumber(snes, &iteration));
  if (iteration) PetscFunctionReturn(PETSC_SUCCESS); /* what the preconditioner is made of serves for all of a step */
  s->a = k * k * s->k->theta * s->march->scheme->space.stiffness;
  PetscCall(MpmImplicitBlocksFill(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = M (x - k df), df the change of f with k theta x */
static PetscErrorCode MultiplyTangent(Mat matrix, Vec x, Vec y)
{
  MpmImplicitSolve *s;
  PetscReal         k;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &s));
  k = s->march->courant;
  PetscCall(VecCopy(x, s->middle));
  PetscCall(VecScale(s->middle, k * s->k->theta));
  PetscCall(Pass(s, MPM_AHEAD_PRODUCT, s->middle, y));
  PetscCall(VecAYPX(y, -k, x));
  PetscCall(Weigh(s->march, NULL, PETSC_TRUE, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- Newton's method: the solver ---- */

static PetscErrorCode CreateNewton(MpmImplicitSolve *s)
{
  PetscFunctionBegin;
  PetscCall(SNESCreate(PetscObjectComm((PetscObject)s->march->grid->da), &s->snes));
  PetscCall(SNESSetOptionsPrefix(s->snes, "implicit_"));
  PetscCall(SNESSetType(s->snes, SNESNEWTONLS));
  PetscCall(SNESSetMaxLinearSolveFailures(s->snes, MOST_NEWTON));
  PetscCall(SNESKSPSetUseEW(s->snes, PETSC_TRUE));
  PetscCall(SNESSetTolerances(s->snes, 0, RELATIVE, LEAST_STEP, MOST_NEWTON, PETSC_MAX_INT));
  PetscCall(SNESGetKSP(s->snes, &s->ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetNewton(MpmImplicitSolve *s)
{
  PetscFunctionBegin;
  PetscCall(VecDuplicate(s->solution, &s->velocity));
  PetscCall(VecDuplicate(s->solution, &s->middle));
  PetscCall(MatShellSetOperation(s->shell, MATOP_MULT, (void (*)(void))MultiplyTangent));
  PetscCall(SNESSetFunction(s->snes, NULL, Residual, s));
  PetscCall(SNESSetJacobian(s->snes, s->shell, s->blocks, Tangent, s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyNewton(MpmImplicitSolve *s)
{
  PetscFunctionBegin;
  PetscCall(SNESDestroy(&s->snes));
  PetscCall(VecDestroy(&s->velocity));
  PetscCall(VecDestroy(&s->middle));
  PetscCall(PetscFree(s->tangent));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The increment from which the system is solved: none or, if particles would lose their volume, that which stops the
   nodes.
*/
static PetscErrorCode Guess(MpmImplicitSolve *s)
{
  PetscFunctionBegin;
  PetscCall(VecSet(s->solution, 0));
  PetscCall(Force(s, MPM_AHEAD_STRESS, s->solution, s->right));
  if (s->inverted) PetscCall(VecAXPY(s->solution, -1 / s->k->theta, s->velocity));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A residual that is no more than rounding errors of the force. */
static PetscErrorCode SetRounding(MpmImplicitSolve *s)
{
  PetscReal relative, step, norm;
  PetscInt  most, evaluations;

  PetscFunctionBegin;
  PetscCall(VecSet(s->right, 1));
  PetscCall(Weigh(s->march, NULL, PETSC_FALSE, s->right));
  PetscCall(VecNorm(s->right, NORM_2, &norm));
  PetscCall(SNESGetTolerances(s->snes, NULL, &relative, &step, &most, &evaluations));
  PetscCall(
      SNESSetTolerances(s->snes, ROUNDING * DBL_EPSILON * s->march->courant * norm, relative, step, most, evaluations));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Newton(MpmImplicitSolve *s)
{
  MpmMarch           *march = s->march;
  SNESConvergedReason reason;
  PetscInt            newton, iterations;

  PetscFunctionBegin;
  PetscCall(Copy(march, s->k->start, PETSC_TRUE, s->velocity));
  PetscCall(SetRounding(s));
  PetscCall(Guess(s));
  PetscCall(SNESSolve(s->snes, NULL, s->solution));
  PetscCall(SNESGetConvergedReason(s->snes, &reason));
  PetscCall(SNESGetIterationNumber(s->snes, &newton));
  PetscCall(SNESGetLinearSolveIterations(s->snes, &iterations));
  PetscCall(Spread(march, s->k->solved, s->solution));
  s->newton += newton;
  s->iterations += iterations;
  if (reason <= 0)
    (void)snprintf(march->failure, sizeof march->failure,
                   "step %" PetscInt64_FMT
                   " from t = %.6g on: the nonlinear system of the implicit step did not converge "
                   "in %" PetscInt_FMT " iterations (%s)",
                   march->step + 1, march->scene ? MpmMarchTime(march, march->step) : (PetscReal)march->step, newton,
                   SNESConvergedReasons[reason]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- set-up ---- */

/* K is symmetric, about a prestress and at finite deformation too: forces have a potential (Newton's method). */
static PetscErrorCode CreateSolver(MpmImplicitSolve *s)
{
  PetscBool blocks;
  PC        pc;

  PetscFunctionBegin;
  if (MpmTableIsFinite(s->k))
    PetscCall(CreateNewton(s));
  else {
    PetscCall(KSPCreate(PetscObjectComm((PetscObject)s->march->grid->da), &s->ksp));
    PetscCall(KSPSetOptionsPrefix(s->ksp, "implicit_"));
  }
  PetscCall(KSPSetType(s->ksp, KSPCG));
  PetscCall(KSPGetPC(s->ksp, &pc));
  PetscCall(PCSetType(pc, PCPBJACOBI));
  PetscCall(KSPSetTolerances(s->ksp, s->snes ? PETSC_CURRENT : RELATIVE, ABSOLUTE, PETSC_CURRENT, MOST_ITERATIONS));
  PetscCall(s->snes ? SNESSetFromOptions(s->snes) : KSPSetFromOptions(s->ksp));
  PetscCall(PetscObjectTypeCompareAny((PetscObject)pc, &blocks, PCPBJACOBI, PCJACOBI, PCNONE, ""));
  s->whole = blocks ? PETSC_FALSE : PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmImplicitSolveCreate(MpmMarch *march, const MpmTable *k, MpmImplicitSolve **solve)
{
  const PetscInt    own = MpmGridNodes(march->grid), dim = march->layout->dim;
  MpmImplicitSolve *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(solve));
  s        = *solve;
  s->march = march;
  s->k     = k;
  s->step  = -1;
  PetscCall(MpmScheduleCompile(k, 1, PETSC_FALSE, PETSC_TRUE, &s->schedule));
  PetscCheck(s->schedule.npasses == 1, PETSC_COMM_SELF, PETSC_ERR_PLIB, "a product with K takes one pass");
  PetscCall(CreateSolver(s));
  PetscCall(MpmImplicitBlocksCreate(s));
  PetscCall(MatCreateShell(PetscObjectComm((PetscObject)march->grid->da), dim * own, dim * own, PETSC_DETERMINE,
                           PETSC_DETERMINE, s, &s->shell));
  PetscCall(MatCreateVecs(s->blocks, &s->solution, &s->right));
  if (s->snes)
    PetscCall(SetNewton(s));
  else {
    PetscCall(MatShellSetOperation(s->shell, MATOP_MULT, (void (*)(void))Multiply));
    PetscCall(KSPSetOperators(s->ksp, s->shell, s->blocks));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmImplicitSolveDestroy(MpmImplicitSolve **solve)
{
  PetscFunctionBegin;
  if (!*solve) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmScheduleDestroy(&(*solve)->schedule));
  PetscCall(MatDestroy(&(*solve)->shell));
  PetscCall(MatDestroy(&(*solve)->blocks));
  PetscCall(VecDestroy(&(*solve)->right));
  PetscCall(VecDestroy(&(*solve)->solution));
  if ((*solve)->snes)
    PetscCall(DestroyNewton(*solve)); /* it has the KSP */
  else
    PetscCall(KSPDestroy(&(*solve)->ksp));
  PetscCall(PetscFree(*solve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- a solve ---- */

void MpmImplicitSolveTotals(const MpmMarch *march, PetscInt64 *iterations, PetscInt64 *newton, PetscReal *seconds)
{
  *iterations = *newton = 0;
  *seconds              = 0;
  for (PetscInt i = 0; i < MPM_MAX_STIFF && march->implicit[i]; i++) {
    *iterations += march->implicit[i]->iterations;
    *newton += march->implicit[i]->newton;
    *seconds += march->implicit[i]->seconds;
  }
}

static MpmImplicitSolve *SolveOf(const MpmMarch *march, const MpmOp *op)
{
  PetscInt i = 0;

  while (march->implicit[i]->k->solved != op->dst) i++;
  return march->implicit[i];
}

PetscErrorCode MpmImplicitSolveApply(MpmMarch *march, PetscInt64 step, const MpmOp *op)
{
  MpmImplicitSolve *s     = SolveOf(march, op);
  const PetscReal   begin = MPI_Wtime();
  const PetscBool   moved =
      s->step < 0 || (s->step != step && MpmParticlesMove(march->particles)) ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool    anew = moved || s->a != op->factor ? PETSC_TRUE : PETSC_FALSE;
  KSPConvergedReason reason;
  PetscInt           iterations;

  PetscFunctionBegin;
  s->step = step;
  if (s->snes) {
    PetscCall(Newton(s));
    s->seconds += MPI_Wtime() - begin;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  s->a = op->factor;
  if (anew) PetscCall(MpmImplicitBlocksFill(s));
  PetscCall(Copy(march, s->k->solved, PETSC_TRUE, s->right));
  PetscCall(Weigh(march, NULL, PETSC_FALSE, s->right));
  PetscCall(KSPSolve(s->ksp, s->right, s->solution));
  PetscCall(KSPGetConvergedReason(s->ksp, &reason));
  PetscCall(KSPGetIterationNumber(s->ksp, &iterations));
  PetscCall(Spread(march, s->k->solved, s->solution));
  s->iterations += iterations;
  s->seconds += MPI_Wtime() - begin;
  if (reason <= 0)
    (void)snprintf(march->failure, sizeof march->failure,
                   "step %" PetscInt64_FMT ": the system of the implicit step did not converge in %" PetscInt_FMT
                   " iterations (%s); allowed: a smaller step, or -implicit_ksp_max_it, -implicit_ksp_rtol and "
                   "-implicit_pc_type",
                   march->step + 1, iterations, KSPConvergedReasons[reason]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
