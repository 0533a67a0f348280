/*
   The plain march: it takes the operations of a table one after another, each for all particles or all nodes, in any
   number of directions. What other marches do faster must come to the same numbers.

   A step begins with the operations that read what nodes hold, and ends with those that send particles to nodes for the
   next step (MpmHeadLength). So the nodes hold the same after a step as in the fast march.
*/
#include "march/implicit_solve.h"
#include "march/passes.h"

/* The arrays of particles and nodes while a march is at work. sum: what is summed. */
typedef struct {
  MpmMarch      *march;
  MpmMarchArrays at;
  PetscInt64     step; /* of the places */
  PetscReal     *sum;
  PetscBool      went; /* particles have moved in the middle of a step, and not migrated since */
  const MpmParity (*parity)[MPM_MAX_DIM];
} Plain;

/* The nodes and weights of a block of particles: first[p] of a local array, and weights along each direction. */
typedef struct {
  PetscInt  first[MPM_BLOCK];
  PetscReal weight[MPM_MAX_DIM][MPM_MOST_NODES * MPM_BLOCK];
} Placed;

static PetscErrorCode Begin(Plain *m)
{
  const MpmTable *table   = m->march->scheme->table;
  const PetscInt  scratch = (table->nparticles - MpmTableHeld(table)) * m->march->particles->count;

  PetscFunctionBegin;
  m->at = (MpmMarchArrays){.march = m->march, .all = PETSC_TRUE};
  PetscCall(MpmMarchGetArrays(m->march, m->step, &m->at));
  PetscCall(PetscMalloc2(scratch, &m->at.scratch, MpmGridSize(m->march->grid), &m->sum));
  m->sum += m->march->grid->origin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode End(Plain *m)
{
  PetscFunctionBegin;
  m->sum -= m->march->grid->origin;
  PetscCall(PetscFree2(m->at.scratch, m->sum));
  PetscCall(MpmMarchRestoreArrays(m->march, &m->at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- particles and nodes ---- */

/*
   The weights of a map are products over the directions: those of its kind along its axis, and of P2G along the others.
*/
static void Place(const Plain *m, MpmOpKind kind, PetscInt axis, PetscInt begin, PetscInt n, Placed *placed)
{
  const MpmMarch *march = m->march;
  const MpmBasis *basis = march->scheme->basis;

  for (PetscInt p = 0; p < n; p++) placed->first[p] = 0;
  for (PetscInt d = 0; d < march->grid->dim; d++) {
    PetscInt  cell[MPM_BLOCK], wall[2];
    PetscReal xi[MPM_BLOCK];
    MpmBlock  block;

    MpmMarchPlaces(&m->at, d, n, m->at.cell[d] + begin, m->at.xi[d] + begin, 0, cell, xi);
    MpmDirectionWalls(&march->layout->grid[d], march->grid->axis[d].first, wall);
    MpmBlockPlace(basis, n, cell, xi, march->layout->half_width[d], wall, &block);
    basis->weights[MpmKindAlong(kind, axis, d)](&block, MPM_BLOCK, placed->weight[d]);
    for (PetscInt p = 0; p < n; p++) placed->first[p] += march->grid->axis[d].stride * block.first[p];
  }
}

/* Adds q times the weights of particle p to its nodes, or without nodes to add to returns the sum of theirs. */
static PetscReal Visit(const MpmMarch *march, const Placed *placed, PetscInt p, PetscReal q, PetscReal *to,
                       const PetscReal *from)
{
  const PetscInt     dim = march->grid->dim, nodes = march->scheme->basis->nodes;
  const MpmGridAxis *axis = march->grid->axis;
  PetscReal          sum  = 0;

  for (PetscInt z = 0; z < (dim > 2 ? nodes : 1); z++)
    for (PetscInt y = 0; y < (dim > 1 ? nodes : 1); y++)
      for (PetscInt x = 0; x < nodes; x++) {
        const PetscInt at     = placed->first[p] + x + y * axis[1].stride + z * axis[2].stride;
        PetscReal      weight = placed->weight[0][x * MPM_BLOCK + p];

        if (dim > 1) weight *= placed->weight[1][y * MPM_BLOCK + p];
        if (dim > 2) weight *= placed->weight[2][z * MPM_BLOCK + p];
        if (to)
          to[at] += q * weight;
        else
          sum += weight * from[at];
      }
  return sum;
}

/*
   What particles give to nodes, a times register q, or without it ones; by: what multiplies it, where particles differ.
*/
static PetscErrorCode Spread(Plain *m, MpmOpKind kind, PetscInt axis, PetscReal a, const PetscReal *q, PetscReal *to)
{
  const PetscReal *by    = m->at.weight[MpmLayoutWeight(m->march->layout, kind, 0)];
  const PetscInt   count = m->march->particles->count;
  Placed           placed;

  PetscFunctionBegin;
  PetscCall(MpmGridZero(m->march->grid, to));
  for (PetscInt begin = 0; begin < count; begin += MPM_BLOCK) {
    const PetscInt n = PetscMin(MPM_BLOCK, count - begin);

    Place(m, kind, axis, begin, n, &placed);
    for (PetscInt p = 0; p < n; p++)
      (void)Visit(m->march, &placed, p, a * (by ? by[begin + p] : 1) * (q ? q[begin + p] : 1), to, NULL);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Gather(Plain *m, const MpmOp *op)
{
  const PetscReal *by    = m->at.weight[MpmLayoutWeight(m->march->layout, op->kind, op->side)];
  const PetscInt   count = m->march->particles->count;
  PetscReal       *q     = MpmMarchRegister(&m->at, op->dst, 0);
  Placed           placed;

  for (PetscInt begin = 0; begin < count; begin += MPM_BLOCK) {
    const PetscInt n = PetscMin(MPM_BLOCK, count - begin);

    Place(m, op->kind, op->axis, begin, n, &placed);
    for (PetscInt p = 0; p < n; p++)
      q[begin + p] += op->factor * (by ? by[begin + p] : 1) * Visit(m->march, &placed, p, 0, NULL, m->at.node[op->src]);
  }
}

/* The masses of the nodes, with the particles where they are. */
static PetscErrorCode SumMasses(Plain *m)
{
  PetscFunctionBegin;
  PetscCall(Spread(m, MPM_P2G, 0, 1, NULL, m->at.sum[MPM_MASSES]));
  PetscCall(MpmNodesSum(m->march, 0, NULL, NULL, PETSC_TRUE, m->at.sum[MPM_MASSES]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SumToNodes(Plain *m, const MpmOp *op)
{
  const MpmParity *parity = m->parity[op->dst];
  PetscReal       *dst    = m->at.node[op->dst] - m->march->grid->origin;
  const PetscReal *sum    = m->sum - m->march->grid->origin;

  PetscFunctionBegin;
  PetscCall(Spread(m, op->kind, op->axis, op->factor, MpmMarchRegister(&m->at, op->src, 0), m->sum));
  PetscCall(MpmNodesSum(m->march, 1, &m->sum, &parity, PETSC_FALSE, m->at.sum[MPM_MASSES]));
  for (PetscInt i = 0; i < MpmGridSize(m->march->grid); i++) dst[i] = sum[i] + (op->accumulates ? dst[i] : 0);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- particles alone, and nodes alone ---- */

static void RunOnParticles(Plain *m, const MpmOp *op)
{
  const PetscInt count = m->march->particles->count;

  for (PetscInt begin = 0; begin < count; begin += MPM_BLOCK)
    MpmMarchOnParticles(&m->at, op, begin, PetscMin(MPM_BLOCK, count - begin), PETSC_FALSE);
}

static PetscErrorCode RunOnNodes(Plain *m, const MpmOp *op)
{
  const PetscInt halo = MpmOpTraitsOf(op->kind).halo; /* ghosts are the owners' then */

  PetscFunctionBegin;
  if (op->kind != MPM_IMPLICIT) {
    PetscCall(MpmNodesRun(&m->at, op, halo ? m->march->grid->ghost : 0, m->step, m->at.node));
    if (halo) PetscCall(MpmNodesRefresh(m->march, m->parity[op->dst], m->at.node[op->dst]));
  } else if (op->axis == 0) {
    PetscCall(End(m)); /* a solve takes particles through operations of its own */
    PetscCall(MpmImplicitSolveApply(m->march, m->step, op));
    PetscCall(Begin(m));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- a step ---- */

/* Particles have moved, and may go to other ranks. */
static PetscErrorCode Moved(Plain *m)
{
  PetscFunctionBegin;
  PetscCall(End(m));
  m->step = m->march->particles->step;
  m->went = PETSC_FALSE;
  PetscCall(MpmMarchMoved(m->march, PETSC_FALSE));
  PetscCall(Begin(m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Nodes have other masses then. In the middle of a step scratch fields are still needed, so that particles migrate
   later.
*/
static PetscErrorCode Move(Plain *m, const MpmOp *op)
{
  PetscFunctionBegin;
  if (op->kind == MPM_ADVANCE)
    RunOnParticles(m, op);
  else if (!MpmMarchDrifts(m->march))
    PetscFunctionReturn(PETSC_SUCCESS);
  m->went = op->factor < 1 ? PETSC_TRUE : PETSC_FALSE;
  if (!m->went) {
    ++m->march->particles->step;
    PetscCall(Moved(m));
  }
  if (!m->march->failure[0]) PetscCall(SumMasses(m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RunOps(Plain *m, const MpmTable *table, PetscInt first, PetscInt end)
{
  PetscFunctionBegin;
  for (PetscInt o = first; o < end && !m->march->failure[0]; o++) {
    MpmOp             op     = table->ops[o];
    const MpmOpTraits traits = MpmOpTraitsOf(op.kind);

    op.factor = MpmOpValue(&table->ops[o], m->march->courant);
    if (m->went && op.kind == MPM_SCALE && op.dst >= MpmTableHeld(table)) PetscCall(Moved(m)); /* scratch begins */
    if (m->march->failure[0]) break;
    if (traits.dst == MPM_NOWHERE)
      PetscCall(Move(m, &op));
    else if (traits.dst == traits.src && traits.dst == MPM_ON_NODES)
      PetscCall(RunOnNodes(m, &op));
    else if (traits.dst == traits.src)
      RunOnParticles(m, &op);
    else if (traits.dst == MPM_ON_NODES)
      PetscCall(SumToNodes(m, &op));
    else
      Gather(m, &op);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Start(MpmMarch *march)
{
  const MpmTable *table = march->scheme->table;
  Plain           m     = {.march = march, .step = march->particles->step, .parity = table->parity};

  PetscFunctionBegin;
  PetscCall(Begin(&m));
  PetscCall(SumMasses(&m));
  PetscCall(RunOps(&m, table, 0, MpmHeadLength(table, table->nops, table->ops)));
  PetscCall(End(&m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Step(MpmMarch *march)
{
  const MpmTable *table = march->scheme->table;
  Plain           m     = {.march = march, .step = march->particles->step, .parity = table->parity};

  PetscFunctionBegin;
  PetscCall(Begin(&m));
  PetscCall(RunOps(&m, table, MpmHeadLength(table, table->nops, table->ops), table->nops));
  PetscCall(RunOps(&m, table, 0, MpmHeadLength(table, table->nops, table->ops)));
  PetscCall(End(&m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Stiffness(MpmMarch *march, PetscInt64 step, PetscInt i)
{
  const MpmTable *k = march->scheme->table->stiff[i];
  Plain           m = {.march = march, .step = step, .parity = k->parity};

  PetscFunctionBegin;
  PetscCall(Begin(&m));
  PetscCall(RunOps(&m, k, 0, k->nops));
  PetscCall(End(&m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, PetscInt64 step, Vec inverse_mass, Vec node)
{
  const MpmParity *parity = MpmTableParity(march->scheme->table, field);
  Plain            m      = {.march = march, .step = step};
  PetscReal       *sum, *mass;

  PetscFunctionBegin;
  PetscCall(Begin(&m));
  PetscCall(MpmGridGetArray(march->grid, node, &sum));
  mass = m.at.sum[MPM_MASSES];
  if (inverse_mass) {
    PetscCall(MpmGridGetArray(march->grid, inverse_mass, &mass));
    PetscCall(Spread(&m, MPM_P2G, 0, 1, NULL, mass));
  }
  PetscCall(Spread(&m, MPM_P2G, 0, 1, m.at.particle[field], sum));
  PetscCall(MpmNodesSum(march, 1, &sum, &parity, inverse_mass ? PETSC_TRUE : PETSC_FALSE, mass));
  if (inverse_mass) PetscCall(MpmGridRestoreArray(march->grid, inverse_mass, &mass));
  PetscCall(MpmGridRestoreArray(march->grid, node, &sum));
  PetscCall(End(&m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmMarchEngine MpmPlainMarch = {.start = Start, .step = Step, .stiffness = Stiffness};
