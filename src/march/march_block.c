/*
   Takes one block of particles through the operations of a pass, while it is in the first-level cache.

   In a uniform layout, moving or not, all cells are alike. The particles of any block then lie in their cells as those
   of the first block do. So their places are found once a pass, and not read from memory.
*/
#include "march/finite.h"
#include "march/march_stage.h"

#define LINE 8 /* doubles in a line of the cache */

PetscInt MpmMarchBlockSize(const MpmParticles *particles)
{
  return particles->per_cell ? MPM_BLOCK - MPM_BLOCK % particles->per_cell : MPM_BLOCK;
}

static PetscInt CellOf(const MpmMarchArrays *a, PetscInt p)
{
  const PetscInt per_cell = a->march->particles->per_cell;

  return per_cell ? a->cell[p % per_cell] + p / per_cell : a->cell[p];
}

PetscInt MpmStageLeastNode(const MpmStage *s, PetscInt p)
{
  return CellOf(s->arrays, p) + PetscMin(s->whole[0], s->whole[1]) - s->arrays->march->scheme->basis->reach_left;
}

PetscInt MpmStageLargestNode(const MpmStage *s, PetscInt p)
{
  const PetscInt carry = s->moving ? 1 : 0; /* for the part of a cell in the drift */

  return CellOf(s->arrays, p) + PetscMax(s->whole[0], s->whole[1]) + carry +
         s->arrays->march->scheme->basis->reach_right;
}

/* Finds the places of n particles from begin on, before DRIFT or after it. */
static void Place(const MpmStage *s, PetscInt begin, PetscInt n, PetscBool after, MpmPlaced *placed)
{
  const MpmMarch  *march = s->arrays->march;
  const PetscInt  *cell  = s->arrays->cell + begin;
  const PetscReal *xi    = s->arrays->xi + begin;
  PetscInt         moved[MPM_BLOCK], wall[2];

  MpmDirectionWalls(&march->layout->grid[0], march->grid->axis[0].first, wall);
  if (s->moving) {
    MpmPlaceBlock(n, cell, xi, s->whole[after], s->part[after], moved, placed->xi);
    cell = moved;
    xi   = placed->xi;
  }
  MpmBlockPlace(march->scheme->basis, n, cell, xi, march->layout->half_width[0], wall, &placed->block);
}

void MpmStagePlace(MpmStage *s)
{
  const PetscInt n = PetscMin(s->arrays->block, s->arrays->march->particles->count);

  if (!s->arrays->march->particles->per_cell) return;
  Place(s, 0, n, PETSC_FALSE, &s->placed[0]);
  if (s->pass->drifts) Place(s, 0, n, PETSC_TRUE, &s->placed[1]);
}

/*
   The places of a block. Where cells are alike they are those of the first block, and shift is the number of nodes
   between the two. Elsewhere, for the last block if it is shorter, and with bases whose functions differ near walls,
   they are found anew.
*/
static const MpmBlock *Placed(const MpmStage *s, PetscInt begin, PetscInt n, PetscBool after, MpmPlaced *room,
                              PetscInt *shift)
{
  const PetscInt per_cell = s->arrays->march->particles->per_cell;

  if (per_cell && n == s->placed[0].block.n && !MpmBasisIsAltered(s->arrays->march->scheme->basis)) {
    *shift = begin / per_cell;
    return &s->placed[after].block;
  }
  *shift = 0;
  Place(s, begin, n, after, room);
  return &room->block;
}

/* Runs a map whose particles differ: what they give, or get, is multiplied by their weight. */
static void RunWeighted(const MpmPassOp *op, const MpmBlock *block, PetscReal weight[], PetscReal q[], PetscReal node[],
                        PetscReal mass[])
{
  PetscReal weighed[MPM_BLOCK];

  for (PetscInt p = 0; p < block->n; p++) weighed[p] = op->to_nodes ? weight[p] * q[p] : 0;
  op->kernel(block, op->a, weighed, node);
  if (op->kind == MPM_PASS_MASS) op->kernel(block, 1, weight, mass);
  for (PetscInt p = 0; p < block->n && !op->to_nodes; p++) q[p] += weight[p] * weighed[p];
}

static PetscReal *FieldOf(const MpmMarchArrays *a, PetscInt field, PetscInt begin)
{
  const PetscInt nstate = a->march->scheme->table->nstate;

  return field < nstate ? a->particle[field] + begin : a->march->scratch + (field - nstate) * MPM_BLOCK;
}

/* Runs an operation of finite deformation. */
static void RunFinite(const MpmStage *s, const MpmPassOp *op, PetscInt begin, PetscInt n, PetscBool after)
{
  const MpmMarchArrays *a     = s->arrays;
  const MpmFiniteWidth  width = MpmFiniteWidthOf(op->kind, 1);
  MpmFiniteBlock        block = {.begin = begin,
                                 .n     = n,
                                 .step  = s->step + after,
                                 .a     = op->a,
                                 .cell  = {a->cell + begin},
                                 .xi    = {a->xi + begin},
                                 .id    = a->id + begin};

  for (PetscInt c = 0; c < width.to; c++) block.to[c] = FieldOf(a, op->particle + c, begin);
  for (PetscInt c = 0; c < width.from; c++) block.from[c] = FieldOf(a, op->other + c, begin);
  if (a->weight[MPM_STIFFNESS]) block.stiffness = a->weight[MPM_STIFFNESS] + begin;
  MpmFiniteRun(a->march, op->kind, &block);
}

/* Fetches n numbers of an array from place on into the cache. */
static void Prefetch(const PetscReal array[], PetscInt place, PetscInt n)
{
  for (PetscInt i = 0; i < n; i += LINE) __builtin_prefetch(array + place + i);
}

/*
   Scratch fields live for one block: no operation of another pass reads what a pass leaves in them. While an operation
   works on a block, it prefetches the arrays of the next one.
*/
void MpmStageRunBlock(const MpmStage *s, PetscInt begin, PetscInt n)
{
  const MpmMarchArrays *a    = s->arrays;
  const PetscBool       more = begin + 2 * n <= a->march->particles->count ? PETSC_TRUE : PETSC_FALSE;
  const MpmBlock       *block;
  const PetscInt        nstate = a->march->scheme->table->nstate;
  PetscInt              shift;
  PetscBool             after = PETSC_FALSE;
  MpmPlaced             room;

  block = Placed(s, begin, n, PETSC_FALSE, &room, &shift);
  for (const MpmPassOp *op = s->pass->op; op < s->pass->op + s->pass->nops; op++) {
    const PetscBool own  = op->particle < nstate ? PETSC_TRUE : PETSC_FALSE;
    PetscReal      *q    = FieldOf(a, op->particle, begin);
    PetscReal      *node = (op->to_nodes ? s->sum : s->node)[op->node] + shift;

    if (more && own) Prefetch(q, n, n);
    if (more && (op->kind == MPM_PASS_MAP || op->kind == MPM_PASS_MASS))
      Prefetch(node, block->first[n - 1], block->first[n - 1] - block->first[0]);
    if (op->weight)
      RunWeighted(op, block, a->weight[op->weight] + begin, q, node, a->mass + shift);
    else if (op->kind == MPM_PASS_MAP)
      op->kernel(block, op->a, q, node);
    else if (op->kind == MPM_PASS_MASS)
      op->mass_kernel(block, q, node, a->mass + shift);
    else if (op->kind == MPM_PASS_SCALE)
      MpmScale(n, op->a, q);
    else if (op->kind == MPM_PASS_ADD)
      MpmNodeAdd(0, n, op->a, FieldOf(a, op->other, begin), q);
    else if (op->kind == MPM_PASS_STRESS || op->kind == MPM_PASS_LOAD || op->kind == MPM_PASS_STRETCH)
      RunFinite(s, op, begin, n, after);
    else if (op->kind == MPM_PASS_ADVANCE) {
      RunFinite(s, op, begin, n, after);
      after = PETSC_TRUE;
      block = Placed(s, begin, n, PETSC_TRUE, &room, &shift);
    } else if (op->kind == MPM_PASS_DRIFT)
      block = Placed(s, begin, n, PETSC_TRUE, &room, &shift);
    else if (s->sample)
      s->squares[op->particle] += MpmSumSquares(n, q);
  }
}
