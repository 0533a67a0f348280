/*
   Runs passes: blocks of particles go through the operations of a pass while they are in the first-level cache.

   Particles are in the order of their places. So nodes come into reach in order, and leave it in order. They are set to
   0 just ahead of the blocks and divided by their mass just behind. A joined pass follows as soon as the nodes of a
   block are complete, while its particles are in the second-level cache. Only the blocks at the ends of a rank's part
   wait for the halo sum, because other ranks share their nodes. The first pass of a group takes these blocks before all
   others, so that their sums are under way while the others are run.
*/
#include "march/implicit_solve.h"
#include "march/march_stage.h"
#include "march/rows.h"

static PetscErrorCode GetArrays(const MpmMarch *march, const MpmNodeVectors *nodes, MpmMarchArrays *a)
{
  PetscFunctionBegin;
  a->march = march;
  a->nodes = nodes;
  a->block = MpmMarchBlockSize(march->particles);
  PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[0], &a->cell));
  PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[0], &a->xi));
  if (march->particles->own) PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &a->id));
  for (PetscInt f = 0; march->scheme->table->fields[f]; f++)
    PetscCall(MpmParticlesGet(march->particles, march->scheme->table->fields[f], &a->particle[f]));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (march->layout->varies[w]) PetscCall(MpmParticlesGet(march->particles, MpmPropertyNames[w], &a->weight[w]));
  for (PetscInt f = 0; f < nodes->n; f++) {
    PetscCall(MpmGridGetArray(march->grid, nodes->node[f], &a->node[f]));
    if (nodes->spare[f]) PetscCall(MpmGridGetArray(march->grid, nodes->spare[f], &a->spare[f]));
  }
  PetscCall(MpmGridGetArray(march->grid, nodes->inverse_mass, &a->mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void SwapVec(Vec *a, Vec *b)
{
  const Vec kept = *a;

  *a = *b;
  *b = kept;
}

/* Fields that were summed to their spare array change places with it. last is the group's last stage. */
static PetscErrorCode RestoreArrays(MpmMarchArrays *a, const MpmStage *last)
{
  const MpmMarch       *march = a->march;
  const MpmNodeVectors *nodes = a->nodes;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < nodes->n; f++) {
    const PetscBool swap = last->after[f] != a->node[f] ? PETSC_TRUE : PETSC_FALSE;

    PetscCall(MpmGridRestoreArray(march->grid, nodes->node[f], &a->node[f]));
    if (nodes->spare[f]) PetscCall(MpmGridRestoreArray(march->grid, nodes->spare[f], &a->spare[f]));
    if (swap) SwapVec(&nodes->node[f], &nodes->spare[f]);
  }
  PetscCall(MpmGridRestoreArray(march->grid, nodes->inverse_mass, &a->mass));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (march->layout->varies[w]) PetscCall(MpmParticlesRestore(march->particles, MpmPropertyNames[w], &a->weight[w]));
  for (PetscInt f = 0; march->scheme->table->fields[f]; f++)
    PetscCall(MpmParticlesRestore(march->particles, march->scheme->table->fields[f], &a->particle[f]));
  if (march->particles->own) PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &a->id));
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[0], &a->xi));
  PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[0], &a->cell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A stage reads the sums of the stages before it in the group, and else the node fields as they were. The first stage
   has none before it (NULL).
*/
static PetscErrorCode BeginStage(const MpmMarchArrays *a, const MpmStage *before, const MpmPass *pass, PetscInt64 step,
                                 MpmStage *s)
{
  const MpmMarch *march = a->march;

  PetscFunctionBegin;
  s->pass   = pass;
  s->arrays = a;
  s->step   = step;
  s->moving = MpmMarchDrifts(march);
  if (s->moving) {
    PetscCall(MpmParticlesWhere(march->particles, 0, step, &s->whole[0], &s->part[0]));
    PetscCall(MpmParticlesWhere(march->particles, 0, step + 1, &s->whole[1], &s->part[1]));
  }
  for (PetscInt f = 0; f < a->nodes->n; f++) s->node[f] = before ? before->after[f] : a->node[f];
  for (PetscInt i = 0; i < pass->nsums; i++) {
    const PetscInt f = pass->sum[i];

    s->sum[f] = a->spare[f] ? a->spare[f] : s->node[f];
  }
  for (PetscInt f = 0; f < a->nodes->n; f++) s->after[f] = s->sum[f] ? s->sum[f] : s->node[f];
  s->zeroed[0] = s->zeroed[1] = -march->grid->ghost;
  s->zeroed[2]                = march->grid->axis[0].nodes + march->grid->ghost;
  s->last                     = march->particles->count;
  s->lo = s->hi = PetscMin(march->grid->ghost, march->grid->axis[0].nodes);
  MpmStagePlace(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Zero(const MpmStage *s, PetscInt lo, PetscInt hi)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->pass->nsums; i++) PetscCall(PetscArrayzero(s->sum[s->pass->sum[i]] + lo, hi - lo));
  if (s->pass->sums_mass) PetscCall(PetscArrayzero(s->arrays->mass + lo, hi - lo));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ZeroTo(MpmStage *s, PetscInt end)
{
  const PetscInt hi = PetscMin(end, s->zeroed[2]);

  PetscFunctionBegin;
  if (hi <= s->zeroed[1]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Zero(s, s->zeroed[1], hi));
  s->zeroed[1] = hi;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Divides the sums at nodes [lo, hi) by the masses; they become 0 where there is no mass. */
static void Complete(const MpmStage *s, PetscInt lo, PetscInt hi)
{
  if (s->pass->sums_mass)
    for (PetscInt i = lo; i < hi; i++) s->arrays->mass[i] = s->arrays->mass[i] > 0 ? 1 / s->arrays->mass[i] : 0;
  for (PetscInt f = 0; f < s->pass->nsums; f++) {
    PetscReal *sum = s->sum[s->pass->sum[f]];

    for (PetscInt i = lo; i < hi; i++) sum[i] *= s->arrays->mass[i];
  }
}

/* Takes the next block through the pass, and completes the nodes that no later block reaches. */
static PetscErrorCode Advance(MpmStage *s)
{
  const MpmGrid *grid = s->arrays->march->grid;
  const PetscInt n = PetscMin(s->arrays->block, s->last - s->next), last = s->next + n - 1;
  const PetscInt left = PetscMin(MpmStageLeastNode(s, last), grid->axis[0].nodes - grid->ghost);

  PetscFunctionBegin;
  PetscCall(ZeroTo(s, PetscMin(MpmStageLargestNode(s, last) + 1, grid->axis[0].nodes + grid->ghost)));
  MpmStageRunBlock(s, s->next, n);
  Complete(s, s->hi, left);
  s->hi = PetscMax(s->hi, left);
  s->next += n;
  MpmMarchFollowNodes(s->pass, s->after, s->lo, s->hi, s->done);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Lets a joined stage follow the stage before it, as far as that has completed nodes. It stays inside nodes [lo, hi) of
   the stage before. That stage neither reads these nodes again nor divides by their masses, so this one may overwrite
   both.
*/
static PetscErrorCode Follow(const MpmStage *before, MpmStage *s)
{
  const PetscInt count = s->arrays->march->particles->count;

  PetscFunctionBegin;
  while (s->next < count) {
    const PetscInt last = PetscMin(s->next + s->arrays->block, count) - 1;

    if (MpmStageLargestNode(s, last) >= before->hi) break;
    if (MpmStageLeastNode(s, s->next) < before->lo) { /* has shared nodes: it comes after the halo sum */
      s->first = s->next = last + 1;
      s->lo = s->hi = PetscMax(s->hi, MpmStageLargestNode(s, last) + 1);
      continue;
    }
    if (s->next == s->first) s->zeroed[0] = s->zeroed[1] = MpmStageLeastNode(s, s->next);
    PetscCall(Advance(s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number of arrays that a stage sums to, and these arrays. */
static PetscInt GetSums(const MpmStage *s, PetscReal *sums[])
{
  for (PetscInt f = 0; f < s->pass->nsums; f++) sums[f] = s->sum[s->pass->sum[f]];
  sums[s->pass->nsums] = s->arrays->mass;
  return s->pass->nsums + (s->pass->sums_mass ? 1 : 0);
}

/* Begins to sum the shared nodes over ranks, when all blocks that reach them have been run. */
static PetscErrorCode BeginSum(MpmStage *s)
{
  PetscReal     *sums[MPM_MAX_FIELDS + 1];
  const PetscInt n = GetSums(s, sums);

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(s->arrays->march->sum_event, 0, 0, 0, 0));
  MpmMarchFold(s->arrays->march, s->arrays->nodes->parity, s->pass, s->sum, s->arrays->mass);
  PetscCall(MpmGridSumBegin(s->arrays->march->grid, n, sums));
  PetscCall(PetscLogEventEnd(s->arrays->march->sum_event, 0, 0, 0, 0));
  s->sent = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Ends the sum of the shared nodes, and completes all nodes and ghosts that are not complete. */
static PetscErrorCode EndSum(MpmStage *s)
{
  const MpmGrid *grid = s->arrays->march->grid;
  PetscReal     *sums[MPM_MAX_FIELDS + 1];
  const PetscInt n = GetSums(s, sums);

  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(s->arrays->march->sum_event, 0, 0, 0, 0));
  PetscCall(MpmGridSumEnd(grid, n, sums));
  Complete(s, -grid->ghost, PetscMin(s->lo, grid->axis[0].nodes + grid->ghost));
  Complete(s, s->hi, grid->axis[0].nodes + grid->ghost);
  MpmMarchReflect(s->arrays->march, s->arrays->nodes->parity, s->pass, s->sum);
  PetscCall(PetscLogEventEnd(s->arrays->march->sum_event, 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Runs the blocks at both ends of a rank's part, and sends their sums before the blocks between them are run. So a rank
   waits for a neighbour only if it is almost a step ahead of it. Where the two ends reach the same nodes, nothing is sent
   early.
*/
static PetscErrorCode RunEnds(MpmStage *s)
{
  const MpmGrid *grid  = s->arrays->march->grid;
  const PetscInt count = s->arrays->march->particles->count, block = s->arrays->block;
  const PetscInt edge = grid->axis[0].nodes - grid->ghost;
  PetscInt       left = 0, right = count - count % block, from;

  PetscFunctionBegin;
  while (left < count && MpmStageLeastNode(s, left) < grid->ghost) left += block;
  while (right > left && MpmStageLargestNode(s, right - 1) >= edge) right -= block;
  if (right <= left) PetscFunctionReturn(PETSC_SUCCESS);
  while (s->next < left) PetscCall(Advance(s));
  from = right < count ? PetscMin(MpmStageLeastNode(s, right), edge) : edge;
  if (from < s->zeroed[1]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Zero(s, from, s->zeroed[2]));
  s->zeroed[2] = from;
  s->last      = right;
  for (PetscInt begin = right; begin < count; begin += block)
    MpmStageRunBlock(s, begin, PetscMin(block, count - begin));
  PetscCall(BeginSum(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Runs the blocks that could not follow early. Then sums the shared nodes over ranks, and completes them. */
static PetscErrorCode FinishStage(MpmStage *s)
{
  const MpmGrid *grid = s->arrays->march->grid;
  PetscInt       end;

  PetscFunctionBegin;
  PetscCall(ZeroTo(s, grid->axis[0].nodes + grid->ghost));
  end          = s->zeroed[0];
  s->zeroed[1] = -grid->ghost;
  PetscCall(ZeroTo(s, end));
  for (PetscInt begin = 0; begin < s->first; begin += s->arrays->block)
    MpmStageRunBlock(s, begin, PetscMin(s->arrays->block, s->first - begin));
  for (; s->next < s->last; s->next += s->arrays->block)
    MpmStageRunBlock(s, s->next, PetscMin(s->arrays->block, s->last - s->next));
  if (!s->sent) PetscCall(BeginSum(s));
  PetscCall(EndSum(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RunStages(MpmMarch *march, const MpmNodeVectors *nodes, PetscInt64 *step, PetscInt n,
                                const MpmPass passes[], PetscBool sample)
{
  MpmMarchArrays arrays = {0};
  MpmStage       stage[MPM_MAX_JOINED + 1];
  MpmPlaced      placed[MPM_MAX_JOINED + 1][2];
  MpmPlaces      places;

  PetscFunctionBegin;
  PetscCall(GetArrays(march, nodes, &arrays));
  for (PetscInt g = 0; g < n; g++) {
    PetscCall(PetscMemzero(&stage[g], sizeof stage[g]));
    stage[g].sample  = sample;
    stage[g].squares = march->squares;
    stage[g].placed  = placed[g];
    PetscCall(BeginStage(&arrays, g ? &stage[g - 1] : NULL, &passes[g], *step, &stage[g]));
    if (passes[g].drifts) ++*step;
  }
  PetscCall(PetscLogEventBegin(march->pass_event, 0, 0, 0, 0));
  if (!march->particles->own && passes[0].nsums > 0) PetscCall(RunEnds(&stage[0]));
  while (stage[0].next < stage[0].last && !march->particles->own) { /* those are in no order, and all come at the end */
    PetscCall(Advance(&stage[0]));
    for (PetscInt g = 1; g < n; g++) PetscCall(Follow(&stage[g - 1], &stage[g]));
  }
  for (PetscInt g = 0; g < n; g++) PetscCall(FinishStage(&stage[g]));
  PetscCall(PetscLogEventEnd(march->pass_event, 0, 0, 0, 0));
  for (PetscInt o = 0;; o++) {
    places = (MpmPlaces){{arrays.cell}, {arrays.xi}, arrays.weight[MPM_MASS]};
    PetscCall(MpmMarchNodeOps(march, *step, stage[n - 1].pass, stage[n - 1].after, arrays.mass, &places,
                              stage[n - 1].done, &o));
    PetscCall(RestoreArrays(&arrays, &stage[n - 1]));
    if (o == stage[n - 1].pass->nnode_ops) break;
    PetscCall(MpmImplicitSolveApply(march, *step, &stage[n - 1].pass->node_op[o])); /* it has passes of its own */
    PetscCall(GetArrays(march, nodes, &arrays));
    PetscCall(PetscArraycpy(stage[n - 1].after, arrays.node, nodes->n));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchRunPassesOn(MpmMarch *march, const MpmNodeVectors *nodes, PetscInt64 *step, PetscInt n,
                                   const MpmPass passes[], PetscBool sample)
{
  PetscFunctionBegin;
  if (march->layout->dim == 1)
    PetscCall(RunStages(march, nodes, step, n, passes, sample));
  else
    for (PetscInt p = 0; p < n; p++) PetscCall(MpmMarchRunRows(march, nodes, step, &passes[p], sample));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchRunPasses(MpmMarch *march, PetscInt n, const MpmPass passes[], PetscBool sample)
{
  const MpmNodeVectors nodes = {.n            = march->nnodes,
                                .node         = march->node,
                                .spare        = march->spare,
                                .inverse_mass = march->inverse_mass,
                                .parity       = march->scheme->table->parity};

  PetscFunctionBegin;
  PetscCall(MpmMarchRunPassesOn(march, &nodes, &march->particles->step, n, passes, sample));
  PetscFunctionReturn(PETSC_SUCCESS);
}
