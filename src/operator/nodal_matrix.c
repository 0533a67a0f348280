/*
   A plan run on the sparse matrices of a layout. It runs twice in the same way: on matrices, whose columns are the nodal
   unknowns, once, for M; and on vectors whenever B is applied.
*/
#include "operator/assemble.h"
#include "operator/nodal.h"
#include "operator/nodal_matrix.h"
#include <math.h>

/*
   map   - the plan's maps, nodes x nodes. Maps that only M needs are NULL once M is made
   value - a vector for each slot; NULL for slots that only M needs
   work  - on particles and on nodes
*/
typedef struct {
  MpmNodalPlan *plan;
  MpmRegisters  sizes;
  MpmStepMaps   maps;
  PetscInt      unknowns; /* of this rank */
  Mat          *map, *slot;
  Vec          *value, work[2];
} Nodal;

/* ---- maps ---- */

/* 1 on the nodes of a wall. */
static PetscErrorCode Selection(const MpmRegisters *r, const MpmOp *op, Mat *map)
{
  const PetscInt wall = op->side ? r->layout->grid[op->axis].nodes - 1 : 0;
  PetscInt       stride;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->nodes, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, map));
  for (PetscInt node = r->node0; node < r->node0 + r->nodes; node++)
    if (MpmNodeAlong(r->layout, node, op->axis, &stride) == wall)
      PetscCall(MatSetValue(*map, node, node, 1, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ProductOf(Nodal *x, const MpmNodalProduct *p, Mat *product)
{
  const MpmOp to_particles = {.kind = p->to_particles, .axis = p->axis_particles, .src = p->src};
  const MpmOp to_nodes     = {.kind = p->to_nodes, .axis = p->axis_nodes, .dst = p->dst};
  Mat         P, W;

  PetscFunctionBegin;
  PetscCall(MpmStepMapsGet(&x->maps, &x->sizes, &to_particles, 0, &W));
  PetscCall(MpmStepMapsGet(&x->maps, &x->sizes, &to_nodes, 0, &P));
  PetscCall(MatMatMult(P, W, MAT_INITIAL_MATRIX, PETSC_DETERMINE, product));
  PetscCall(MatScale(*product, p->factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MapOf(Nodal *x, const MpmNodalMap *map, Mat *sum)
{
  Mat next;

  PetscFunctionBegin;
  if (map->n == 0 && map->op.kind == MPM_WALL)
    PetscCall(Selection(&x->sizes, &map->op, sum));
  else if (map->n == 0) {
    PetscCall(MpmStepMapsGet(&x->maps, &x->sizes, &map->op, 0, sum));
    PetscCall(PetscObjectReference((PetscObject)*sum));
  } else
    PetscCall(ProductOf(x, &map->product[0], sum));
  for (PetscInt i = 1; i < map->n; i++) {
    PetscCall(ProductOf(x, &map->product[i], &next));
    PetscCall(MatAXPY(*sum, 1, next, DIFFERENT_NONZERO_PATTERN));
    PetscCall(MatDestroy(&next));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the plan run on matrices ---- */

static PetscReal FactorOf(const Nodal *x, PetscReal factor, PetscInt power)
{
  return factor * pow(x->sizes.step.courant, (double)power);
}

/* Slot g at the start: its values are unknown g of each node. */
static PetscErrorCode Unknown(const Nodal *x, PetscInt g, Mat *slot)
{
  const MpmRegisters *r      = &x->sizes;
  const PetscInt      images = x->plan->nimages;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->nodes, x->unknowns, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, slot));
  for (PetscInt node = r->node0; node < r->node0 + r->nodes; node++)
    PetscCall(MatSetValue(*slot, node, images * node + g, 1, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(*slot, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*slot, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* dst += factor k^power (map of src); a slot that is NULL is 0. */
static PetscErrorCode RunLine(const Nodal *x, const MpmNodalLine *line)
{
  const PetscReal factor = FactorOf(x, line->factor, line->power);
  const Mat       src    = x->slot[line->src];
  Mat            *dst    = &x->slot[line->dst], image;

  PetscFunctionBegin;
  if (!src) PetscFunctionReturn(PETSC_SUCCESS);
  if (line->map == MPM_NONE)
    PetscCall(MatDuplicate(src, MAT_COPY_VALUES, &image));
  else
    PetscCall(MatMatMult(x->map[line->map], src, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &image));
  if (*dst) {
    PetscCall(MatAXPY(*dst, factor, image, DIFFERENT_NONZERO_PATTERN));
    PetscCall(MatDestroy(&image));
  } else {
    PetscCall(MatScale(image, factor));
    *dst = image;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* M: what the slots of the images hold after the step. */
static PetscErrorCode CreateM(Nodal *x, Mat *M)
{
  const MpmNodalPlan *plan = x->plan;
  Mat                 next[MPM_MAX_IMAGES];

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(plan->nslots, &x->slot));
  for (PetscInt g = 0; g < plan->nimages; g++) PetscCall(Unknown(x, g, &x->slot[g]));
  for (PetscInt l = 0; l < plan->nlines; l++) PetscCall(RunLine(x, &plan->line[l]));
  for (PetscInt g = 0; g < plan->nimages; g++) next[g] = x->slot[plan->next[g]];
  PetscCall(MpmInterleave(x->sizes.comm, plan->nimages, next, x->sizes.nodes, x->unknowns, PETSC_TRUE, M));
  for (PetscInt s = 0; s < plan->nslots; s++) PetscCall(MatDestroy(&x->slot[s]));
  PetscCall(PetscFree(x->slot));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Z: the images of the state. */
static PetscErrorCode CreateZ(Nodal *x, Mat *Z)
{
  const MpmNodalPlan *plan = x->plan;
  MpmRegisters        state;
  Mat                 image[MPM_MAX_IMAGES] = {NULL};

  PetscFunctionBegin;
  PetscCall(MpmRegistersCreate(x->sizes.comm, x->sizes.layout, x->sizes.scheme, &x->sizes.step, &state));
  for (PetscInt g = 0; g < plan->nimages; g++)
    for (PetscInt i = 0; i < plan->image[g].n; i++) {
      const MpmNodalTerm *t  = &plan->image[g].term[i];
      const MpmOp         op = {.kind = t->kind, .axis = t->axis, .dst = t->dst};
      Mat                 P, term;

      PetscCall(MpmStepMapsGet(&x->maps, &x->sizes, &op, 0, &P));
      PetscCall(MatMatMult(P, state.particle[t->src], MAT_INITIAL_MATRIX, PETSC_DETERMINE, &term));
      PetscCall(MatScale(term, t->factor));
      if (image[g]) {
        PetscCall(MatAXPY(image[g], 1, term, DIFFERENT_NONZERO_PATTERN));
        PetscCall(MatDestroy(&term));
      } else
        image[g] = term;
    }
  PetscCall(MpmInterleave(x->sizes.comm, plan->nimages, image, x->sizes.nodes, x->sizes.state, PETSC_FALSE, Z));
  for (PetscInt g = 0; g < plan->nimages; g++) PetscCall(MatDestroy(&image[g]));
  PetscCall(MpmRegistersDestroy(&state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the plan run on vectors ---- */

/* Copies numbers that stand count apart in the rows of one vector to another one, or with back from there. */
static PetscErrorCode Spread(PetscInt count, PetscInt at, PetscBool back, Vec together, Vec alone)
{
  PetscInt   n;
  PetscReal *all, *one;

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(alone, &n));
  PetscCall(VecGetArray(together, &all));
  PetscCall(VecGetArray(alone, &one));
  for (PetscInt i = 0; i < n; i++)
    if (back)
      all[count * i + at] = one[i];
    else
      one[i] = all[count * i + at];
  PetscCall(VecRestoreArray(alone, &one));
  PetscCall(VecRestoreArray(together, &all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A line, or its transpose: src += factor k^power (map transposed of dst). */
static PetscErrorCode ApplyLine(const Nodal *x, const MpmNodalLine *line, PetscBool transpose)
{
  const PetscReal factor = FactorOf(x, line->factor, line->power);
  const Vec       from   = x->value[transpose ? line->dst : line->src];
  const Vec       to     = x->value[transpose ? line->src : line->dst];

  PetscFunctionBegin;
  if (line->map == MPM_NONE) {
    PetscCall(VecAXPY(to, factor, from));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (transpose)
    PetscCall(MatMultTranspose(x->map[line->map], from, x->work[1]));
  else
    PetscCall(MatMult(x->map[line->map], from, x->work[1]));
  PetscCall(VecAXPY(to, factor, x->work[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Clear(const Nodal *x)
{
  PetscFunctionBegin;
  for (PetscInt s = 0; s < x->plan->nslots; s++)
    if (x->value[s]) PetscCall(VecSet(x->value[s], 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* q = B z */
static PetscErrorCode Multiply(Mat B, Vec z, Vec q)
{
  const MpmNodalPlan *plan;
  Nodal              *x;
  Vec                 image;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(B, &x));
  plan = x->plan;
  PetscCall(Clear(x));
  for (PetscInt g = 0; g < plan->nimages; g++) PetscCall(Spread(plan->nimages, g, PETSC_FALSE, z, x->value[g]));
  for (PetscInt l = 0; l < plan->nlines_sent; l++) PetscCall(ApplyLine(x, &plan->line[l], PETSC_FALSE));
  PetscCall(VecDuplicate(x->work[0], &image));
  for (PetscInt r = 0; r < plan->nstate; r++) {
    PetscCall(VecSet(image, 0));
    for (PetscInt i = 0; i < plan->nsent; i++) {
      const MpmOp *op = &plan->sent[i].op;
      Mat          W;

      if (op->dst != r) continue;
      PetscCall(MpmStepMapsGet(&x->maps, &x->sizes, op, 0, &W));
      PetscCall(MatMult(W, x->value[plan->sent[i].slot], x->work[0]));
      PetscCall(VecAXPY(image, FactorOf(x, op->factor, op->coefficient), x->work[0]));
    }
    PetscCall(Spread(plan->nstate, r, PETSC_TRUE, q, image));
  }
  PetscCall(VecDestroy(&image));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* z = B^T q */
static PetscErrorCode MultiplyTranspose(Mat B, Vec q, Vec z)
{
  const MpmNodalPlan *plan;
  Nodal              *x;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(B, &x));
  plan = x->plan;
  PetscCall(Clear(x));
  for (PetscInt i = 0; i < plan->nsent; i++) {
    const MpmOp *op = &plan->sent[i].op;
    Mat          W;

    PetscCall(MpmStepMapsGet(&x->maps, &x->sizes, op, 0, &W));
    PetscCall(Spread(plan->nstate, op->dst, PETSC_FALSE, q, x->work[0]));
    PetscCall(MatMultTranspose(W, x->work[0], x->work[1]));
    PetscCall(VecAXPY(x->value[plan->sent[i].slot], FactorOf(x, op->factor, op->coefficient), x->work[1]));
  }
  for (PetscInt l = plan->nlines_sent - 1; l >= 0; l--) PetscCall(ApplyLine(x, &plan->line[l], PETSC_TRUE));
  for (PetscInt g = 0; g < plan->nimages; g++) PetscCall(Spread(plan->nimages, g, PETSC_TRUE, z, x->value[g]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Mat B)
{
  Nodal *x;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(B, &x));
  for (PetscInt m = 0; m < x->plan->nmaps; m++) PetscCall(MatDestroy(&x->map[m]));
  for (PetscInt s = 0; s < x->plan->nslots; s++) PetscCall(VecDestroy(&x->value[s]));
  PetscCall(VecDestroy(&x->work[0]));
  PetscCall(VecDestroy(&x->work[1]));
  PetscCall(MpmStepMapsDestroy(&x->maps));
  PetscCall(MpmRegistersDestroy(&x->sizes));
  PetscCall(MpmNodalPlanDestroy(&x->plan));
  PetscCall(PetscFree(x->map));
  PetscCall(PetscFree(x->value));
  PetscCall(PetscFree(x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The vectors that B needs. Maps that it does not need go. */
static PetscErrorCode CreateVectors(Nodal *x)
{
  const MpmNodalPlan *plan = x->plan;
  PetscBool          *used;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(plan->nslots, &x->value));
  PetscCall(PetscCalloc1(PetscMax(1, plan->nmaps), &used));
  for (PetscInt side = 0; side < 2; side++) {
    PetscCall(VecCreate(x->sizes.comm, &x->work[side]));
    PetscCall(VecSetSizes(x->work[side], side ? x->sizes.nodes : x->sizes.particles, PETSC_DETERMINE));
    PetscCall(VecSetType(x->work[side], VECSTANDARD));
  }
  for (PetscInt g = 0; g < plan->nimages; g++) PetscCall(VecDuplicate(x->work[1], &x->value[g]));
  for (PetscInt i = 0; i < plan->nsent; i++)
    if (!x->value[plan->sent[i].slot]) PetscCall(VecDuplicate(x->work[1], &x->value[plan->sent[i].slot]));
  for (PetscInt l = 0; l < plan->nlines_sent; l++) {
    const MpmNodalLine *line = &plan->line[l];

    if (!x->value[line->dst]) PetscCall(VecDuplicate(x->work[1], &x->value[line->dst]));
    if (!x->value[line->src]) PetscCall(VecDuplicate(x->work[1], &x->value[line->src]));
    if (line->map != MPM_NONE) used[line->map] = PETSC_TRUE;
  }
  for (PetscInt m = 0; m < plan->nmaps; m++)
    if (!used[m]) PetscCall(MatDestroy(&x->map[m]));
  PetscCall(PetscFree(used));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateB(Nodal *x, Mat *B)
{
  PetscFunctionBegin;
  PetscCall(CreateVectors(x));
  PetscCall(MatCreateShell(x->sizes.comm, x->sizes.state, x->unknowns, PETSC_DETERMINE, PETSC_DETERMINE, x, B));
  PetscCall(MatShellSetOperation(*B, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatShellSetOperation(*B, MATOP_MULT_TRANSPOSE, (void (*)(void))MultiplyTranspose));
  PetscCall(MatShellSetOperation(*B, MATOP_DESTROY, (void (*)(void))Destroy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what a step multiplies by a number ---- */

/* Counts the numbers that C and C' have, of so many particles and nodes. too_many: they have too many different ones. */
static void Count(const MpmNodalPlan *plan, PetscInt64 particles, PetscInt64 nodes, MpmReduced *r, PetscBool *too_many)
{
  *too_many = PETSC_FALSE;
  for (PetscInt i = 0; i < plan->nstate + plan->nimages; i++) {
    const PetscInt  g = i - plan->nstate;
    const PetscReal c = g < 0 ? plan->kept[i] : plan->image[g].c;
    PetscInt        k = 0;

    while (k < r->nkept && r->number[k] != c) k++;
    if (k == MPM_REDUCED_KEPT) {
      *too_many = PETSC_TRUE;
      return;
    }
    if (k == r->nkept) r->number[r->nkept++] = c;
    if (g < 0)
      r->count[k] += (PetscInt)particles;
    else
      r->count_small[k] += (PetscInt)nodes;
  }
}

static PetscErrorCode Diagonal(MPI_Comm comm, PetscInt count, const PetscReal number[], PetscInt n, Vec *diagonal)
{
  PetscReal *d;

  PetscFunctionBegin;
  PetscCall(VecCreate(comm, diagonal));
  PetscCall(VecSetSizes(*diagonal, count * n, PETSC_DETERMINE));
  PetscCall(VecSetType(*diagonal, VECSTANDARD));
  PetscCall(VecGetArrayWrite(*diagonal, &d));
  for (PetscInt i = 0; i < count * n; i++) d[i] = number[i % count];
  PetscCall(VecRestoreArrayWrite(*diagonal, &d));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt64 NodesOf(const MpmLayout *layout)
{
  PetscInt64 nodes = 1;

  for (PetscInt a = 0; a < layout->dim; a++) nodes *= layout->grid[a].nodes;
  return nodes;
}

PetscErrorCode MpmNodalMatrixUnknowns(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                      PetscInt64 *unknowns)
{
  const PetscInt64 nodes = NodesOf(layout);
  MpmReduced       r     = {.nkept = 0};
  MpmNodalPlan    *plan;
  PetscBool        too_many;

  PetscFunctionBegin;
  *unknowns = 0;
  if (MpmStepDrifts(step) || MpmNodalWhyNot(scheme->table) || !MpmNodalHasRoom(scheme->table))
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmNodalPlanCreate(scheme->table, &plan));
  if (plan->nstate * layout->particles <= PETSC_MAX_INT && plan->nimages * nodes <= PETSC_MAX_INT) {
    Count(plan, layout->particles, nodes, &r, &too_many);
    *unknowns = plan->nimages * nodes < plan->nstate * layout->particles && !too_many ? plan->nimages * nodes : 0;
    for (PetscInt k = 0; k < r.nkept; k++)
      if (r.count_small[k] > r.count[k]) *unknowns = 0;
  }
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- all of it ---- */

static PetscErrorCode Balance(Vec unit, MpmReduced *r)
{
  Vec inverse;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(unit, &inverse));
  PetscCall(VecCopy(unit, inverse));
  PetscCall(VecReciprocal(inverse));
  PetscCall(MatDiagonalScale(r->B, unit, NULL));
  PetscCall(MatDiagonalScale(r->Z, NULL, inverse));
  PetscCall(VecDestroy(&inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The same of the unknowns of nodes where masses differ: all images are sums over particles divided by the nodal mass m, and with powers of two next
   to its root they have the size of the particles' balanced numbers. Without it rounding of the heavy nodes' numbers spoils
   the light ones'.
*/
static PetscErrorCode BalanceNodes(const Nodal *x, MpmReduced *r)
{
  const PetscInt   images = x->plan->nimages;
  const PetscReal *mass;
  PetscReal       *d;
  Vec              unit, inverse;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(r->kept_small, &unit));
  PetscCall(VecDuplicate(r->kept_small, &inverse));
  PetscCall(VecGetArrayRead(x->sizes.masses, &mass));
  PetscCall(VecGetArrayWrite(unit, &d));
  for (PetscInt i = 0; i < images * x->sizes.nodes; i++)
    d[i] = mass[i / images] > 0 ? exp2(rint(log2(mass[i / images]) / 2)) : 1;
  PetscCall(VecRestoreArrayWrite(unit, &d));
  PetscCall(VecRestoreArrayRead(x->sizes.masses, &mass));
  PetscCall(VecCopy(unit, inverse));
  PetscCall(VecReciprocal(inverse));
  PetscCall(MatDiagonalScale(r->M, unit, inverse));
  PetscCall(MatDiagonalScale(r->Z, unit, NULL));
  PetscCall(MatDiagonalScale(r->B, NULL, inverse));
  PetscCall(VecDestroy(&unit));
  PetscCall(VecDestroy(&inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalMatrixCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme,
                                    const MpmStep *step, Vec unit, MpmReduced **nodal)
{
  PetscReal   c[MPM_MAX_IMAGES];
  PetscBool   too_many;
  MpmReduced *r;
  Nodal      *x;

  PetscFunctionBegin;
  PetscCall(PetscNew(nodal));
  r = *nodal;
  PetscCall(PetscNew(&x));
  PetscCall(MpmNodalPlanCreate(scheme->table, &x->plan));
  PetscCall(MpmRegistersSizes(comm, layout, scheme, step, &x->sizes));
  x->unknowns = x->plan->nimages * x->sizes.nodes;
  PetscCall(PetscCalloc1(PetscMax(1, x->plan->nmaps), &x->map));
  for (PetscInt m = 0; m < x->plan->nmaps; m++) PetscCall(MapOf(x, &x->plan->map[m], &x->map[m]));
  Count(x->plan, layout->particles, NodesOf(layout), r, &too_many);
  for (PetscInt g = 0; g < x->plan->nimages; g++) c[g] = x->plan->image[g].c;
  PetscCall(Diagonal(comm, x->plan->nstate, x->plan->kept, x->sizes.particles, &r->kept));
  PetscCall(Diagonal(comm, x->plan->nimages, c, x->sizes.nodes, &r->kept_small));
  PetscCall(CreateM(x, &r->M));
  PetscCall(CreateZ(x, &r->Z));
  PetscCall(CreateB(x, &r->B));
  if (unit) PetscCall(Balance(unit, r));
  if (layout->varies[MPM_MASS]) PetscCall(BalanceNodes(x, r));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalMatrixOf(const MpmOperator *op, MpmReduced **nodal)
{
  PetscInt64 unknowns = 0;

  PetscFunctionBegin;
  *nodal = NULL;
  if (op->layout) PetscCall(MpmNodalMatrixUnknowns(op->layout, op->scheme, &op->step, &unknowns));
  if (!unknowns || op->exponent) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(
      MpmNodalMatrixCreate(PetscObjectComm((PetscObject)op->A), op->layout, op->scheme, &op->step, op->unit, nodal));
  PetscCall(MpmReducedCheck(op->balanced, *nodal));
  if (!((*nodal)->mismatch <= MPM_REDUCED_AGREES)) PetscCall(MpmReducedDestroy(nodal));
  PetscFunctionReturn(PETSC_SUCCESS);
}
