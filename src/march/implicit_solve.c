/* Solves (M + a M K) y = M f on the grid of the march. */
#include "march/implicit_solve.h"
#include "march/stencils.h"
#include "scheme/maps.h"
#include <mpmstab/errors.h>

#define RELATIVE 1e-12
#define ABSOLUTE 1e-300 /* an unstable or decaying run is rescaled: no residual is small by itself */
#define MOST_ITERATIONS 10000

/* ---- vectors and node registers ---- */

PetscErrorCode MpmImplicitCopy(const MpmMarch *march, PetscInt first, PetscBool back, Vec vector)
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

PetscErrorCode MpmImplicitSpread(const MpmMarch *march, PetscInt first, Vec vector)
{
  const MpmGrid *grid = march->grid;
  PetscReal     *node[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(MpmImplicitCopy(march, first, PETSC_FALSE, vector));
  for (PetscInt c = 0; c < grid->dim; c++) PetscCall(MpmGridGetArray(grid, march->node[first + c], &node[c]));
  PetscCall(MpmGridSum(grid, grid->dim, node));
  for (PetscInt c = 0; c < grid->dim; c++) {
    MpmGridImages(grid, march->layout->grid, march->scheme->table->parity[first + c], PETSC_FALSE, node[c]);
    PetscCall(MpmGridRestoreArray(grid, march->node[first + c], &node[c]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmImplicitWeigh(const MpmMarch *march, Vec add, PetscBool whole, Vec vector)
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

PetscErrorCode MpmImplicitPass(MpmImplicitSolve *s, Vec x, Vec y)
{
  PetscInt i = 0;

  PetscFunctionBegin;
  PetscCall(MpmImplicitSpread(s->march, s->k->solved, x));
  while (s->march->implicit[i] != s) i++;
  PetscCall(s->march->engine->stiffness(s->march, s->step, i));
  PetscCall(MpmImplicitCopy(s->march, s->k->image, PETSC_TRUE, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = (M + a M K) x: one pass over the particles. */
static PetscErrorCode Multiply(Mat matrix, Vec x, Vec y)
{
  MpmImplicitSolve *s;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &s));
  PetscCall(MpmImplicitPass(s, x, y));
  PetscCall(VecScale(y, s->a));
  PetscCall(MpmImplicitWeigh(s->march, x, PETSC_TRUE, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the preconditioner's matrix ---- */

/* The block of two nodes of a particle, times a number. */
static void Block(const MpmImplicitSolve *s, PetscReal times, const PetscReal to[], const PetscReal from[],
                  PetscReal block[])
{
  const PetscInt dim = s->march->layout->dim;

  for (PetscInt c = 0; c < dim; c++)
    for (PetscInt a = 0; a < dim; a++) {
      PetscReal sum = 0;

      for (PetscInt b = 0; b < dim; b++)
        for (PetscInt d = 0; d < dim; d++) sum += s->term[c][b][a][d] * to[c * dim + b] * from[a * dim + d];
      block[c * dim + a] = times * sum;
    }
}

/* Adds all particles' parts of a M K. */
static PetscErrorCode AddParticles(MpmImplicitSolve *s)
{
  const PetscInt  dim = s->march->layout->dim, origin = s->march->grid->origin;
  const MpmSlopes slopes = {.layout = s->march->layout,
                            .basis  = s->march->scheme->basis,
                            .grid   = s->march->grid,
                            .kind   = s->slope,
                            .parity = s->k->parity + s->k->solved};
  const PetscInt  most   = MpmSlopesMost(&slopes);
  PetscInt       *node;
  PetscReal      *shape, *slope;
  MpmMarchArrays  arrays = {.march = s->march};

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(most, &node, most, &shape, most * dim * dim, &slope));
  PetscCall(MpmMarchGetArrays(s->march, s->step, &arrays));
  for (PetscInt p = 0; p < s->march->particles->count; p++) {
    const PetscReal *volume = arrays.weight[MPM_VOLUME], *stiffness = s->snes ? NULL : arrays.weight[MPM_STIFFNESS];
    const PetscReal  times = s->a * (volume ? volume[p] : 1) * (stiffness ? stiffness[p] : 1);
    PetscReal        block[MPM_MAX_DIM * MPM_MAX_DIM], at[MPM_MAX_DIM];
    PetscInt         in[MPM_MAX_DIM], n;

    for (PetscInt a = 0; a < dim; a++)
      MpmMarchPlaces(&arrays, a, 1, &arrays.cell[a][p], &arrays.xi[a][p], 0, &in[a], &at[a]);
    n = MpmSlopesAt(&slopes, PETSC_FALSE, in, at, node, shape, slope);
    for (PetscInt i = 0; i < n; i++) node[i] += origin;
    if (s->snes) MpmImplicitTerm(s, p);
    for (PetscInt i = 0; i < n; i++)
      for (PetscInt j = 0; j < n; j++) {
        if (!s->whole && node[i] != node[j]) continue;
        Block(s, times, slope + i * dim * dim, slope + j * dim * dim, block);
        PetscCall(MatSetValuesBlockedLocal(s->blocks, 1, &node[i], 1, &node[j], block, ADD_VALUES));
      }
  }
  PetscCall(MpmMarchRestoreArrays(s->march, &arrays));
  PetscCall(PetscFree3(node, shape, slope));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmImplicitAssemble(MpmImplicitSolve *s)
{
  Vec masses;

  PetscFunctionBegin;
  PetscCall(MatZeroEntries(s->blocks));
  PetscCall(AddParticles(s));
  PetscCall(MatAssemblyBegin(s->blocks, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(s->blocks, MAT_FINAL_ASSEMBLY));
  PetscCall(VecDuplicate(s->right, &masses));
  PetscCall(VecSet(masses, 1));
  PetscCall(MpmImplicitWeigh(s->march, NULL, PETSC_TRUE, masses));
  PetscCall(MatDiagonalSet(s->blocks, masses, ADD_VALUES));
  PetscCall(VecDestroy(&masses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- set-up ---- */

/* The terms of K: a gather to scratch, and each sum of that scratch. */
static void FindTerms(MpmImplicitSolve *s)
{
  const MpmTable *k = s->k;

  for (const MpmOp *grad = k->ops; grad < k->ops + k->nops; grad++) {
    const MpmOpTraits to = MpmOpTraitsOf(grad->kind);

    if (to.src != MPM_ON_NODES || to.dst != MPM_ON_PARTICLES) continue;
    s->slope = grad->kind;
    for (const MpmOp *div = grad + 1; div < k->ops + k->nops; div++) {
      const MpmOpTraits from = MpmOpTraitsOf(div->kind);

      if (from.src == MPM_ON_PARTICLES && from.dst == MPM_ON_NODES && div->src == grad->dst)
        s->term[div->dst - k->image][div->axis][grad->src - k->solved][grad->axis] += div->factor * grad->factor;
    }
  }
}

static PetscErrorCode CreateBlocks(MpmImplicitSolve *s, PetscInt own)
{
  const PetscInt         dim = s->march->layout->dim, reach = MpmMapReach(s->march->scheme->basis);
  PetscInt               width = 1, all;
  ISLocalToGlobalMapping nodes, map;
  const PetscInt        *index;
  PetscInt               n;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim && s->whole; a++) width *= 2 * reach - 1;
  all   = MpmLayoutNodes(s->march->layout);
  width = PetscMin(width, all);
  PetscCall(MatCreate(PetscObjectComm((PetscObject)s->march->grid->da), &s->blocks));
  PetscCall(MatSetSizes(s->blocks, dim * own, dim * own, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetBlockSize(s->blocks, dim));
  PetscCall(MatSetType(s->blocks, s->whole ? MATAIJ : MATBAIJ));
  PetscCall(MatXAIJSetPreallocation(s->blocks, dim, NULL, NULL, NULL, NULL));
  PetscCall(MatSeqAIJSetPreallocation(s->blocks, dim * width, NULL));
  PetscCall(MatMPIAIJSetPreallocation(s->blocks, dim * width, NULL, s->whole ? dim * width : 0, NULL));
  PetscCall(MatSeqBAIJSetPreallocation(s->blocks, dim, width, NULL));
  PetscCall(MatMPIBAIJSetPreallocation(s->blocks, dim, width, NULL, 0, NULL));
  PetscCall(MatSetOption(s->blocks, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  PetscCall(DMGetLocalToGlobalMapping(s->march->grid->da, &nodes));
  PetscCall(ISLocalToGlobalMappingGetSize(nodes, &n));
  PetscCall(ISLocalToGlobalMappingGetIndices(nodes, &index));
  PetscCall(
      ISLocalToGlobalMappingCreate(PetscObjectComm((PetscObject)s->blocks), dim, n, index, PETSC_COPY_VALUES, &map));
  PetscCall(ISLocalToGlobalMappingRestoreIndices(nodes, &index));
  PetscCall(MatSetLocalToGlobalMapping(s->blocks, map, map));
  PetscCall(ISLocalToGlobalMappingDestroy(&map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* K is symmetric, about a prestress and at finite deformation too: forces have a potential (implicit_newton.c). */
static PetscErrorCode CreateSolver(MpmImplicitSolve *s)
{
  PetscBool blocks;
  PC        pc;

  PetscFunctionBegin;
  if (MpmTableIsFinite(s->k))
    PetscCall(MpmImplicitCreateNewton(s));
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
  if (!MpmTableIsFinite(k)) FindTerms(s);
  PetscCall(MpmScheduleCompile(k, march->scheme->basis, march->layout, 1, PETSC_FALSE, PETSC_TRUE, &s->schedule));
  PetscCheck(s->schedule.npasses == 1, PETSC_COMM_SELF, PETSC_ERR_PLIB, "a product with K takes one pass");
  PetscCall(CreateSolver(s));
  PetscCall(CreateBlocks(s, own));
  PetscCall(MatCreateShell(PetscObjectComm((PetscObject)march->grid->da), dim * own, dim * own, PETSC_DETERMINE,
                           PETSC_DETERMINE, s, &s->shell));
  PetscCall(MatCreateVecs(s->blocks, &s->solution, &s->right));
  if (s->snes)
    PetscCall(MpmImplicitSetNewton(s));
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
    PetscCall(MpmImplicitDestroyNewton(*solve)); /* it has the KSP */
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

static MpmImplicitSolve *SolveOf(const MpmMarch *march, const MpmNodeOp *op)
{
  PetscInt i = 0;

  while (march->implicit[i]->k->solved != op->dst) i++;
  return march->implicit[i];
}

PetscErrorCode MpmImplicitSolveApply(MpmMarch *march, PetscInt64 step, const MpmNodeOp *op)
{
  MpmImplicitSolve *s     = SolveOf(march, op);
  const PetscReal   begin = MPI_Wtime();
  const PetscBool   moved =
      s->step < 0 || (s->step != step && MpmParticlesMove(march->particles)) ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool    anew = moved || s->a != op->a ? PETSC_TRUE : PETSC_FALSE;
  KSPConvergedReason reason;
  PetscInt           iterations;

  PetscFunctionBegin;
  s->step = step;
  if (s->snes) {
    PetscCall(MpmImplicitNewton(s));
    s->seconds += MPI_Wtime() - begin;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  s->a = op->a;
  if (anew) PetscCall(MpmImplicitAssemble(s));
  PetscCall(MpmImplicitCopy(march, s->k->solved, PETSC_TRUE, s->right));
  PetscCall(MpmImplicitWeigh(march, NULL, PETSC_FALSE, s->right));
  PetscCall(KSPSolve(s->ksp, s->right, s->solution));
  PetscCall(KSPGetConvergedReason(s->ksp, &reason));
  PetscCall(KSPGetIterationNumber(s->ksp, &iterations));
  PetscCall(MpmImplicitSpread(march, s->k->solved, s->solution));
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
