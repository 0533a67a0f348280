/*
   Passes of the march: blocks of particles go through a pass's operations while they are in the first-level
   cache.

   Particles are in the order of their places, so nodes come into reach and leave it in order too: they are
   zeroed just ahead of the blocks and divided by their mass just behind, and a joined pass follows as soon as
   the nodes that a block sees are complete, while its particles are in the second-level cache. Only the
   blocks at the ends of a rank's part, which see nodes that other ranks share, wait for the halo sum.
*/
#include <mpmstab/march_nodes.h>

#define BLOCK 128 /* particles: larger blocks are slower here, though they would fit the cache */

/* What the passes of a group share. */
typedef struct {
  const MpmMarch *march;
  PetscInt       *cell;
  PetscReal      *xi, *particle[MPM_MAX_FIELDS], *weight[MPM_PROPERTIES];
  PetscReal      *node[MPM_MAX_FIELDS], *spare[MPM_MAX_FIELDS], *mass;
} Arrays;

/*
   One pass on its way, its arrays resolved so that the block loop follows pointers only. Particles [first,
   next) have been through it, nodes [lo, hi) are complete.
*/
typedef struct {
  const MpmPass *pass;
  const Arrays  *arrays;
  PetscBool      moving, sample;
  PetscInt       whole[2]; /* drift before and after DRIFT */
  PetscReal      part[2];
  PetscReal     *node[MPM_MAX_FIELDS], *sum[MPM_MAX_FIELDS], *squares;
  PetscInt       first, next, lo, hi, zeroed[2]; /* nodes [zeroed[0], zeroed[1]) are ready to be summed to */
} Stage;

static PetscErrorCode GetArrays(const MpmMarch *march, Arrays *a)
{
  PetscFunctionBegin;
  a->march = march;
  PetscCall(MpmParticlesGet(march->particles, MpmFieldCell, &a->cell));
  PetscCall(MpmParticlesGet(march->particles, MpmFieldXi, &a->xi));
  for (PetscInt f = 0; march->scene->table->fields[f]; f++)
    PetscCall(MpmParticlesGet(march->particles, march->scene->table->fields[f], &a->particle[f]));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (march->scene->table->varies[w])
      PetscCall(MpmParticlesGet(march->particles, MpmPropertyNames[w], &a->weight[w]));
  for (PetscInt f = 0; f < march->nnodes; f++) {
    PetscCall(MpmGridGetArray(march->grid, march->node[f], &a->node[f]));
    if (march->spare[f]) PetscCall(MpmGridGetArray(march->grid, march->spare[f], &a->spare[f]));
  }
  PetscCall(MpmGridGetArray(march->grid, march->inverse_mass, &a->mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void SwapVec(Vec *a, Vec *b)
{
  const Vec kept = *a;

  *a = *b;
  *b = kept;
}

/* Fields that were summed into their spare array change places with it; last is the group's last stage. */
static PetscErrorCode RestoreArrays(MpmMarch *march, Arrays *a, const Stage *last)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < march->nnodes; f++) {
    const PetscBool swap = last->node[f] != a->node[f] ? PETSC_TRUE : PETSC_FALSE;

    PetscCall(MpmGridRestoreArray(march->grid, march->node[f], &a->node[f]));
    if (march->spare[f]) PetscCall(MpmGridRestoreArray(march->grid, march->spare[f], &a->spare[f]));
    if (swap) SwapVec(&march->node[f], &march->spare[f]);
  }
  PetscCall(MpmGridRestoreArray(march->grid, march->inverse_mass, &a->mass));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (march->scene->table->varies[w])
      PetscCall(MpmParticlesRestore(march->particles, MpmPropertyNames[w], &a->weight[w]));
  for (PetscInt f = 0; march->scene->table->fields[f]; f++)
    PetscCall(MpmParticlesRestore(march->particles, march->scene->table->fields[f], &a->particle[f]));
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi, &a->xi));
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell, &a->cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A stage reads what the stages before it in the group have summed; the first one (before NULL) what was there. */
static PetscErrorCode BeginStage(const Arrays *a, const Stage *before, const MpmPass *pass, PetscInt64 step, Stage *s)
{
  const MpmMarch *march = a->march;

  PetscFunctionBegin;
  s->pass   = pass;
  s->arrays = a;
  s->moving = MpmSceneDrifts(march->scene);
  if (s->moving) {
    PetscCall(MpmParticlesWhere(march->particles, step, &s->whole[0], &s->part[0]));
    PetscCall(MpmParticlesWhere(march->particles, step + 1, &s->whole[1], &s->part[1]));
  }
  for (PetscInt f = 0; f < march->nnodes; f++)
    s->node[f] = !before ? a->node[f] : before->sum[f] ? before->sum[f] : before->node[f];
  for (PetscInt i = 0; i < pass->nsums; i++) {
    const PetscInt f = pass->sum[i];

    s->sum[f] = a->spare[f] ? a->spare[f] : s->node[f];
  }
  s->zeroed[0] = s->zeroed[1] = -march->grid->ghost;
  s->lo = s->hi = PetscMin(march->grid->ghost, march->grid->nodes);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A map whose particles differ: what they give, or get, times their weight. */
static void RunWeighted(const Stage *s, const MpmPassOp *op, PetscInt n, const PetscInt cell[], const PetscReal xi[],
                        PetscReal weight[], PetscReal q[])
{
  const PetscReal width = s->arrays->march->scene->width;
  PetscReal       weighed[BLOCK];

  for (PetscInt p = 0; p < n; p++) weighed[p] = op->to_nodes ? weight[p] * q[p] : 0;
  op->kernel(n, cell, xi, width, op->a, weighed, (op->to_nodes ? s->sum : s->node)[op->node]);
  if (op->kind == MPM_PASS_MASS) op->kernel(n, cell, xi, width, 1, weight, s->arrays->mass);
  for (PetscInt p = 0; p < n && !op->to_nodes; p++) q[p] += weight[p] * weighed[p];
}

/* Scratch fields live for a block: what a pass leaves in them no other reads. */
static void RunBlock(const Stage *s, PetscInt begin, PetscInt n)
{
  const Arrays    *a     = s->arrays;
  const PetscReal  width = a->march->scene->width;
  PetscInt         cell_now[BLOCK];
  PetscReal        xi_now[BLOCK], scratch[MPM_MAX_FIELDS][BLOCK];
  const PetscInt  *cell = a->cell + begin;
  const PetscReal *xi   = a->xi + begin;

  if (s->moving) {
    MpmPlaceBlock(n, a->cell + begin, a->xi + begin, s->whole[0], s->part[0], cell_now, xi_now);
    cell = cell_now;
    xi   = xi_now;
  }
  for (const MpmPassOp *op = s->pass->op; op < s->pass->op + s->pass->nops; op++) {
    PetscReal *q = a->particle[op->particle] ? a->particle[op->particle] + begin : scratch[op->particle];

    if (op->weight)
      RunWeighted(s, op, n, cell, xi, a->weight[op->weight] + begin, q);
    else if (op->kind == MPM_PASS_MAP)
      op->kernel(n, cell, xi, width, op->a, q, (op->to_nodes ? s->sum : s->node)[op->node]);
    else if (op->kind == MPM_PASS_MASS)
      op->mass_kernel(n, cell, xi, width, q, s->sum[op->node], s->arrays->mass);
    else if (op->kind == MPM_PASS_SCALE)
      MpmScale(n, op->a, q);
    else if (op->kind == MPM_PASS_DRIFT)
      MpmPlaceBlock(n, a->cell + begin, a->xi + begin, s->whole[1], s->part[1], cell_now, xi_now);
    else if (s->sample)
      s->squares[op->particle] += MpmSumSquares(n, q);
  }
}

static PetscErrorCode ZeroTo(Stage *s, PetscInt end)
{
  const PetscInt n = end - s->zeroed[1];

  PetscFunctionBegin;
  if (n <= 0) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt i = 0; i < s->pass->nsums; i++) PetscCall(PetscArrayzero(s->sum[s->pass->sum[i]] + s->zeroed[1], n));
  if (s->pass->sums_mass) PetscCall(PetscArrayzero(s->arrays->mass + s->zeroed[1], n));
  s->zeroed[1] = end;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* g_i = sum / mass, 0 where there is no mass. */
static void Complete(const Stage *s, PetscInt lo, PetscInt hi)
{
  if (s->pass->sums_mass)
    for (PetscInt i = lo; i < hi; i++) s->arrays->mass[i] = s->arrays->mass[i] > 0 ? 1 / s->arrays->mass[i] : 0;
  for (PetscInt f = 0; f < s->pass->nsums; f++) {
    PetscReal *sum = s->sum[s->pass->sum[f]];

    for (PetscInt i = lo; i < hi; i++) sum[i] *= s->arrays->mass[i];
  }
}

/* Nodes that particle p may see in this pass: from the least, to and with the largest. */
static PetscInt LeastNode(const Stage *s, PetscInt p)
{
  return s->arrays->cell[p] + PetscMin(s->whole[0], s->whole[1]) - s->arrays->march->scene->basis->reach_left;
}

static PetscInt LargestNode(const Stage *s, PetscInt p)
{
  const PetscInt carry = s->moving ? 1 : 0; /* the part of a cell on */

  return s->arrays->cell[p] + PetscMax(s->whole[0], s->whole[1]) + carry + s->arrays->march->scene->basis->reach_right;
}

/* The next block, and the nodes it leaves behind. */
static PetscErrorCode Advance(Stage *s)
{
  const MpmGrid *grid = s->arrays->march->grid;
  const PetscInt n = PetscMin(BLOCK, s->arrays->march->particles->count - s->next), last = s->next + n - 1;
  const PetscInt left = PetscMin(LeastNode(s, last), grid->nodes - grid->ghost);

  PetscFunctionBegin;
  PetscCall(ZeroTo(s, PetscMin(LargestNode(s, last) + 1, grid->nodes + grid->ghost)));
  RunBlock(s, s->next, n);
  Complete(s, s->hi, left);
  s->hi = PetscMax(s->hi, left);
  s->next += n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Lets a joined stage follow the one before it as far as that has completed nodes. It stays inside [lo, hi) of the one
   before, which neither reads those nodes again nor divides by their masses, so it may overwrite both.
*/
static PetscErrorCode Follow(const Stage *before, Stage *s)
{
  const PetscInt count = s->arrays->march->particles->count;

  PetscFunctionBegin;
  while (s->next < count) {
    const PetscInt last = PetscMin(s->next + BLOCK, count) - 1;

    if (LargestNode(s, last) >= before->hi) break;
    if (LeastNode(s, s->next) < before->lo) { /* sees shared nodes: comes after the halo sum */
      s->first = s->next = last + 1;
      s->lo = s->hi = PetscMax(s->hi, LargestNode(s, last) + 1);
      continue;
    }
    if (s->next == s->first) s->zeroed[0] = s->zeroed[1] = LeastNode(s, s->next);
    PetscCall(Advance(s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The blocks that could not follow early, then the shared nodes: sum over ranks, complete, spread to ghosts. */
static PetscErrorCode FinishStage(Stage *s)
{
  const MpmGrid *grid  = s->arrays->march->grid;
  const PetscInt count = s->arrays->march->particles->count, hi = s->hi;
  PetscInt       end;
  PetscReal     *sums[MPM_MAX_FIELDS + 1];

  PetscFunctionBegin;
  PetscCall(ZeroTo(s, grid->nodes + grid->ghost));
  end          = s->zeroed[0];
  s->zeroed[1] = -grid->ghost;
  PetscCall(ZeroTo(s, end));
  for (PetscInt begin = 0; begin < s->first; begin += BLOCK) RunBlock(s, begin, PetscMin(BLOCK, s->first - begin));
  for (; s->next < count; s->next += BLOCK) RunBlock(s, s->next, PetscMin(BLOCK, count - s->next));
  PetscCall(PetscLogEventBegin(s->arrays->march->sum_event, 0, 0, 0, 0));
  for (PetscInt f = 0; f < s->pass->nsums; f++) sums[f] = s->sum[s->pass->sum[f]];
  sums[s->pass->nsums] = s->arrays->mass;
  MpmMarchFold(s->arrays->march, s->pass, s->sum, s->arrays->mass);
  PetscCall(MpmGridSum(grid, s->pass->nsums + (s->pass->sums_mass ? 1 : 0), sums));
  Complete(s, 0, PetscMin(s->lo, grid->nodes));
  Complete(s, PetscMin(hi, grid->nodes), grid->nodes);
  PetscCall(MpmGridSpread(grid, s->pass->nsums, sums));
  MpmMarchReflect(s->arrays->march, s->pass, s->sum);
  PetscCall(PetscLogEventEnd(s->arrays->march->sum_event, 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchRunPasses(MpmMarch *march, PetscInt n, const MpmPass passes[], PetscBool sample)
{
  const PetscInt count                     = march->particles->count;
  PetscInt64     step                      = march->particles->step;
  Arrays         arrays                    = {0};
  Stage          stage[MPM_MAX_JOINED + 1] = {0};
  MpmPlaces      places;

  PetscFunctionBegin;
  PetscCall(GetArrays(march, &arrays));
  for (PetscInt g = 0; g < n; g++) {
    stage[g].sample  = sample;
    stage[g].squares = march->squares;
    PetscCall(BeginStage(&arrays, g ? &stage[g - 1] : NULL, &passes[g], step, &stage[g]));
    if (passes[g].drifts) step++;
  }
  PetscCall(PetscLogEventBegin(march->pass_event, 0, 0, 0, 0));
  while (stage[0].next < count) {
    PetscCall(Advance(&stage[0]));
    for (PetscInt g = 1; g < n; g++) PetscCall(Follow(&stage[g - 1], &stage[g]));
  }
  for (PetscInt g = 0; g < n; g++) PetscCall(FinishStage(&stage[g]));
  PetscCall(PetscLogEventEnd(march->pass_event, 0, 0, 0, 0));
  march->particles->step = step;
  for (PetscInt f = 0; f < march->nnodes; f++)
    if (stage[n - 1].sum[f]) stage[n - 1].node[f] = stage[n - 1].sum[f];
  places = (MpmPlaces){arrays.cell, arrays.xi, arrays.weight[MPM_MASS]};
  PetscCall(MpmMarchNodeOps(march, stage[n - 1].pass, stage[n - 1].node, arrays.mass, &places));
  PetscCall(RestoreArrays(march, &arrays, &stage[n - 1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
