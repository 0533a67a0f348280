/*
   Passes by rows: finds the rows of a rank's particles, compiles a pass for rows, and takes the particles through it.

   Maps that follow one another in the same direction, to nodes or to particles, become one step of a plan. Within it
   they are sorted by line and weights. The order of such maps matters to rounding alone.
*/
#include "march/rows.h"
#include "march/finite.h"
#include "scheme/lines.h"
#include "scheme/maps.h"

/* ---- rows: they stay as they are until particles migrate ---- */

#define WHOLE 4 /* particles that a row may have more, so that it ends with its cell */

/* The number of particles from begin on that are on one line along x. */
static PetscInt OnLine(const MpmMarchArrays *a, PetscInt begin)
{
  PetscInt n = 1;

  for (; begin + n < a->march->particles->count; n++)
    for (PetscInt d = 1; d < a->march->layout->dim; d++)
      if (a->cell[d][begin + n] != a->cell[d][begin] || a->xi[d][begin + n] != a->xi[d][begin]) return n;
  return n;
}

/* The number of particles of a row from begin on: about `share` in whole cells, for which a line of nodes has room. */
static PetscInt Length(const MpmMarchArrays *a, PetscInt begin, PetscInt line, PetscInt share)
{
  const PetscInt most = PetscMin(line, MPM_BLOCK), *cell = a->cell[0] + begin;
  PetscInt       n = 1;

  for (; n < most && cell[n] >= cell[0] && cell[n] - cell[0] < MPM_BLOCK; n++)
    if (n >= share && cell[n] != cell[n - 1]) return n;
  return n;
}

/* Whether n particles from begin on rest at the same places along x as those from of on, but for whole cells. */
static PetscBool IsAlike(const MpmMarchArrays *a, PetscInt of, PetscInt begin, PetscInt n, PetscBool altered)
{
  const PetscInt  *cell = a->cell[0] + begin, *of_cell = a->cell[0] + of;
  const PetscReal *xi = a->xi[0] + begin, *of_xi = a->xi[0] + of;
  PetscInt         differ = altered && cell[0] != of_cell[0];

  for (PetscInt p = 0; p < n; p++) differ |= (cell[p] - cell[0] != of_cell[p] - of_cell[0]) | (xi[p] != of_xi[p]);
  return differ ? PETSC_FALSE : PETSC_TRUE;
}

/*
   The number of rows, which are stored unless row is NULL. The rows of a line are as long as one another, if whole
   cells permit, so that more of them are alike. Where each particle moves by itself no two rows stay alike.
*/
static PetscInt Visit(const MpmMarchArrays *a, PetscBool altered, MpmRow row[])
{
  PetscInt rows = 0, of = 0, before = 0, line = 0, share = 0;

  for (PetscInt begin = 0, n; begin < a->march->particles->count; begin += n, line -= n, rows++) {
    if (!line) {
      line  = OnLine(a, begin);
      share = (line - 1) / ((line - 1) / (MPM_BLOCK - WHOLE) + 1) + 1;
    }
    n = Length(a, begin, line, share);
    if (row)
      row[rows] =
          (MpmRow){.begin = begin,
                   .alike = n == before && !a->march->particles->own ? IsAlike(a, of, begin, n, altered) : PETSC_FALSE};
    of     = begin;
    before = n;
  }
  if (row) row[rows].begin = a->march->particles->count;
  return rows;
}

PetscErrorCode MpmRowsFind(MpmMarch *march)
{
  const PetscBool altered = MpmBasisIsAltered(march->scheme->basis);
  MpmMarchArrays  arrays  = {.march = march};

  PetscFunctionBegin;
  if (march->clouds) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &arrays));
  march->nrows = Visit(&arrays, altered, NULL);
  PetscCall(PetscFree(march->row));
  PetscCall(PetscMalloc1(march->nrows + 1, &march->row));
  (void)Visit(&arrays, altered, march->row);
  PetscCall(MpmMarchRestoreArrays(march, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- a pass compiled for rows ---- */

/*
   What the maps of a step are sorted by, the most important first: the line, which is across x, and the kind of weights
   along x.
*/
typedef struct {
  PetscInt     node;
  MpmOpKind    z, y, along;
  PetscReal    a;
  const MpmOp *op;
} Entry;

typedef struct {
  const MpmBasis  *basis;
  const MpmLayout *layout;
  MpmRowPlan      *plan;
  PetscInt         n;
  PetscBool        spreads;
  Entry            entry[2 * MPM_MAX_PASS_OPS];
} Group;

static PetscBool SameLine(const Entry *a, const Entry *b)
{
  return a->node == b->node && a->z == b->z && a->y == b->y ? PETSC_TRUE : PETSC_FALSE;
}

static PetscBool Precedes(const Entry *a, const Entry *b)
{
  if (a->node != b->node) return a->node < b->node ? PETSC_TRUE : PETSC_FALSE;
  if (a->z != b->z) return a->z < b->z ? PETSC_TRUE : PETSC_FALSE;
  if (a->y != b->y) return a->y < b->y ? PETSC_TRUE : PETSC_FALSE;
  return a->along < b->along ? PETSC_TRUE : PETSC_FALSE;
}

/* Adds an entry behind those that do not come after it. */
static void Insert(Group *g, Entry entry)
{
  PetscInt i = g->n++;

  for (; i > 0 && Precedes(&entry, &g->entry[i - 1]); i--) g->entry[i] = g->entry[i - 1];
  g->entry[i] = entry;
}

/* The number of a kind of weights in a plan. */
static PetscInt KindOf(MpmRowPlan *plan, MpmOpKind kind)
{
  for (PetscInt k = 0; k < plan->nkinds; k++)
    if (plan->kind[k] == kind) return k;
  plan->kind[plan->nkinds] = kind;
  return plan->nkinds++;
}

/* The particle register of a map. */
static PetscInt ParticleOf(const MpmOp *op)
{
  return MpmOpIsSum(op) ? op->src : op->dst;
}

static MpmRowMap MapOf(const Group *g, const Entry *entry)
{
  const PetscBool masses = entry->node == MPM_MASSES ? PETSC_TRUE : PETSC_FALSE;

  return (MpmRowMap){.weights  = KindOf(g->plan, entry->along),
                     .a        = masses ? 1 : entry->a,
                     .particle = masses ? MPM_NONE : ParticleOf(entry->op),
                     .weight   = MpmLayoutWeight(g->layout, entry->op->kind, entry->op->side)};
}

/* The number of the weights that a line has across it. */
static PetscInt AcrossOf(MpmRowPlan *plan, const Entry *e)
{
  const PetscInt y = KindOf(plan, e->y), z = KindOf(plan, e->z);

  for (PetscInt n = 0; n < plan->nacross; n++)
    if (plan->across[n].y == y && plan->across[n].z == z) return n;
  plan->across[plan->nacross] = (MpmRowAcross){.y = y, .z = z};
  return plan->nacross++;
}

/* Makes a step of the maps of a group. */
static void Close(Group *g)
{
  MpmRowPlan    *plan  = g->plan;
  const PetscInt begin = plan->nlines;

  for (PetscInt i = 0; i < g->n; i++) {
    const Entry *e    = &g->entry[i];
    PetscInt     last = plan->nmaps;

    if (i == 0 || !SameLine(e, &g->entry[i - 1]))
      plan->line[plan->nlines++] = (MpmRowLine){.node = e->node, .across = AcrossOf(plan, e), .begin = plan->nmaps};
    plan->map[plan->nmaps++]         = MapOf(g, e);
    plan->line[plan->nlines - 1].end = plan->nmaps;
    while (last > plan->line[plan->nlines - 1].begin &&
           plan->map[last - 1].weights == plan->map[plan->nmaps - 1].weights)
      plan->map[--last].shared++;
  }
  if (g->n) plan->step[plan->nsteps++] = (MpmRowStep){.begin = begin, .end = plan->nlines, .spreads = g->spreads};
  g->n = 0;
}

/* Where the moment is the same at all places, the weights of P2G_AFFINE are those of DIV_MLS times the moment. */
static void AddMap(Group *g, const MpmOp *op, PetscBool with_mass)
{
  const PetscReal moment = op->kind == MPM_P2G_AFFINE ? g->basis->moment : 0;
  const MpmOpKind map    = moment > 0 ? MPM_DIV_MLS : op->kind;
  Entry           entry  = {.node  = MpmOpIsSum(op) ? op->dst : op->src,
                            .z     = MpmLineKind(g->basis, MpmKindAlong(map, op->axis, 2)),
                            .y     = MpmLineKind(g->basis, MpmKindAlong(map, op->axis, 1)),
                            .along = MpmLineKind(g->basis, MpmKindAlong(map, op->axis, 0)),
                            .a     = moment > 0 ? moment * op->factor : op->factor,
                            .op    = op};

  if (g->spreads != MpmOpIsSum(op)) Close(g);
  g->spreads = MpmOpIsSum(op);
  Insert(g, entry);
  if (!with_mass) return;
  entry.node = MPM_MASSES;
  Insert(g, entry);
}

/* Whether a group uses one of n particle fields. */
static PetscBool Uses(const Group *g, PetscInt first, PetscInt n)
{
  for (PetscInt i = 0; i < g->n; i++) {
    const PetscInt particle = ParticleOf(g->entry[i].op);

    if (particle >= first && particle < first + n) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* Whether an operation on particles alone may come before the maps of a group: these use none of its fields. */
static PetscBool MayPrecede(const Group *g, const MpmOp *op)
{
  const PetscInt       dim   = g->layout->dim;
  const MpmFiniteWidth width = MpmFiniteWidthOf(op->kind, dim, dim * dim);

  if (MpmOpTraitsOf(op->kind).dst == MPM_NOWHERE) return PETSC_FALSE;
  if (op->kind == MPM_SCALE || op->kind == MPM_ADD)
    return Uses(g, op->dst, 1) || (op->kind == MPM_ADD && Uses(g, op->src, 1)) ? PETSC_FALSE : PETSC_TRUE;
  return Uses(g, op->dst, width.to) || Uses(g, op->src, width.from) ? PETSC_FALSE : PETSC_TRUE;
}

void MpmRowPlanCompile(const MpmPass *pass, const MpmBasis *basis, const MpmLayout *layout, MpmRowPlan *plan)
{
  Group group = {.basis = basis, .layout = layout, .plan = plan};

  *plan = (MpmRowPlan){.nkinds = 1, .kind = {MPM_P2G}};
  for (PetscInt o = 0; o < pass->nops; o++) {
    const MpmOp *op = &pass->op[o];

    if (MpmOpIsSum(op) || MpmOpIsGather(op)) {
      AddMap(&group, op, o == pass->mass ? PETSC_TRUE : PETSC_FALSE);
      continue;
    }
    if (!MayPrecede(&group, op)) Close(&group);
    plan->step[plan->nsteps++] = (MpmRowStep){.op = *op};
  }
  Close(&group);
}

/* ---- a pass taken row by row ---- */

#define MARGIN                                                                                                         \
  (MPM_MAX_REACH + 1) /* nodes of a line before the cell of the row's first particle, and after that of its last */
#define LINE (MPM_BLOCK + 2 * MARGIN)

/*
   The places of a row, before DRIFT or after it. The block is relative to the cell of the row's first particle
   and the whole cells of drift.

   begin, n - the particles that the block is of
   lo, hi   - the nodes of the line that have weights
   rows     - the number of rows of nodes; node[0] of a row is at offset[r] of a local array
   alike    - the runs of the row are alike: runs
   along    - along[kind]: the weights along x, of a run or of all particles
   weight   - weight[n]: of the rows, with the kinds across[n] of the plan along y and z
*/
typedef struct {
  MpmBlock  block;
  MpmRuns   runs;
  PetscInt  begin, n, lo, hi, rows, offset[MPM_MOST_ROWS];
  PetscBool alike;
  PetscReal along[MPM_MOST_KINDS][MPM_MOST_NODES * MPM_BLOCK];
  PetscReal xi[MPM_BLOCK], weight[MPM_MOST_ACROSS][MPM_MOST_ROWS];
} Placed;

/* Memory for a row while it is in a pass. */
typedef struct {
  Placed    placed[2];
  PetscReal line[MPM_MOST_LINES][LINE], weighed[MPM_BLOCK], ones[MPM_BLOCK];
} Work;

/* Finds the places of a row along x. */
static void PlaceAlong(const MpmMarchArrays *a, const MpmRow *row, PetscInt after, Placed *placed)
{
  const MpmMarch *march = a->march;
  const PetscInt  begin = row->begin, n = row[1].begin - begin;
  const PetscInt  origin = a->cell[0][begin] + a->whole[after][0];
  PetscInt        cell[MPM_BLOCK], moved[MPM_BLOCK], wall[2];

  if (row->alike) {
    placed->begin = begin;
    return;
  }
  moved[0] = 0; /* a row is never empty, but the compiler cannot know it */
  for (PetscInt p = 0; p < n; p++) cell[p] = a->cell[0][begin + p] - origin;
  MpmMarchPlaces(a, 0, n, cell, a->xi[0] + begin, after, moved, placed->xi);
  MpmDirectionWalls(&march->layout->grid[0], march->grid->axis[0].first + origin, wall);
  MpmBlockPlace(march->scheme->basis, n, moved, placed->xi, march->layout->half_width[0], wall, &placed->block);
  placed->alike = MpmRunsFind(march->scheme->basis, &placed->block, &placed->runs);
  for (PetscInt k = 0; k < a->plan->nkinds; k++)
    if (placed->alike)
      MpmRunsWeights(march->scheme->basis, a->plan->kind[k], &placed->block, &placed->runs, placed->along[k]);
    else
      march->scheme->basis->weights[a->plan->kind[k]](&placed->block, MPM_BLOCK, placed->along[k]);
  placed->begin = begin;
  placed->n     = n;
  placed->lo = placed->hi = placed->block.first[0];
  for (PetscInt p = 1; p < n; p++) {
    placed->lo = PetscMin(placed->lo, placed->block.first[p]);
    placed->hi = PetscMax(placed->hi, placed->block.first[p]);
  }
  placed->hi += march->scheme->basis->nodes;
}

/* Finds the rows of nodes that a row of particles has weights at, and these weights. */
static void PlaceAcross(const MpmMarchArrays *a, PetscInt begin, PetscInt after, Placed *placed)
{
  const MpmBasis *basis = a->march->scheme->basis;
  const MpmGrid  *grid  = a->march->grid;
  const PetscInt  dim = grid->dim, ny = dim > 1 ? basis->nodes : 1, nz = dim > 2 ? basis->nodes : 1;
  PetscInt        first[MPM_MAX_DIM] = {0};
  PetscReal       weight[MPM_MAX_DIM][MPM_MOST_KINDS][MPM_MOST_NODES];

  weight[1][0][0] = weight[2][0][0] = 1; /* of a direction that is not there */
  for (PetscInt d = 1; d < dim; d++) {
    const PetscInt zero = 0;
    PetscInt       cell, wall[2];
    PetscReal      xi;
    MpmBlock       block;

    MpmMarchPlaces(a, d, 1, &a->cell[d][begin], &a->xi[d][begin], after, &cell, &xi);
    MpmDirectionWalls(&a->march->layout->grid[d], grid->axis[d].first + cell, wall);
    MpmBlockPlace(basis, 1, &zero, &xi, a->march->layout->half_width[d], wall, &block);
    for (PetscInt k = 0; k < a->plan->nkinds; k++) basis->weights[a->plan->kind[k]](&block, 1, weight[d][k]);
    first[d] = cell + block.first[0];
  }
  placed->rows = ny * nz;
  for (PetscInt z = 0, r = 0; z < nz; z++)
    for (PetscInt y = 0; y < ny; y++, r++) {
      placed->offset[r] = a->cell[0][begin] + a->whole[after][0] + (first[1] + y) * grid->axis[1].stride +
                          (first[2] + z) * grid->axis[2].stride;
      for (PetscInt k = 0; k < a->plan->nacross; k++)
        placed->weight[k][r] = weight[1][a->plan->across[k].y][y] * weight[2][a->plan->across[k].z][z];
    }
}

static void Place(const MpmMarchArrays *a, const MpmRow *row, PetscInt after, Work *w)
{
  PlaceAlong(a, row, after, &w->placed[after]);
  PlaceAcross(a, row->begin, after, &w->placed[after]);
}

/* Runs a map along x, from a line to particles or back. */
static void RunMap(const MpmMarchArrays *a, const MpmRowMap *map, PetscBool to_nodes, const Placed *placed,
                   PetscReal factor, PetscReal q[], PetscReal line[])
{
  const PetscInt   nodes  = a->march->scheme->basis->nodes;
  const PetscReal *weight = placed->along[map->weights];

  if (placed->alike && to_nodes)
    MpmRunsSpread(&placed->block, &placed->runs, nodes, weight, factor, q, line);
  else if (placed->alike)
    MpmRunsGather(&placed->block, &placed->runs, nodes, weight, 1, &factor, &q, line);
  else if (to_nodes)
    MpmWeightsSpread(&placed->block, nodes, MPM_BLOCK, weight, factor, q, line);
  else
    MpmWeightsGather(&placed->block, nodes, MPM_BLOCK, weight, factor, q, line);
}

/*
   The maps that share weights and a line with m, from m on, as far as one loop does them all: runs that are alike, and
   no weight of a particle's own. Returns how many they are.
*/
static PetscInt GatherAlike(const MpmMarchArrays *a, const MpmRowMap *m, const Placed *placed, const PetscReal line[])
{
  PetscReal factor[MPM_MOST_TARGETS], *q[MPM_MOST_TARGETS];
  PetscInt  n = 0;

  for (; placed->alike && n <= m->shared && n < MPM_MOST_TARGETS && !m[n].weight; n++) {
    factor[n] = m[n].a;
    q[n]      = MpmMarchRegister(a, m[n].particle, placed->begin);
  }
  if (n)
    MpmRunsGather(&placed->block, &placed->runs, a->march->scheme->basis->nodes, placed->along[m->weights], n, factor,
                  q, line);
  return n;
}

/* Maps that share weights differ in their particle fields and factors. */
static void GatherShared(const MpmMarchArrays *a, const MpmRowMap *m, const Placed *placed, Work *w, PetscReal line[])
{
  const MpmRowMap *last = m + m->shared;

  if (m == last && !m->weight) {
    RunMap(a, m, PETSC_FALSE, placed, m->a, MpmMarchRegister(a, m->particle, placed->begin), line);
    return;
  }
  for (PetscInt p = 0; p < placed->n; p++) w->weighed[p] = 0;
  RunMap(a, m, PETSC_FALSE, placed, 1, w->weighed, line);
  for (; m <= last; m++) {
    const PetscReal *restrict weight = m->weight ? a->weight[m->weight] + placed->begin : w->ones;
    const PetscReal *restrict from   = w->weighed;
    PetscReal *restrict q            = MpmMarchRegister(a, m->particle, placed->begin);

    for (PetscInt p = 0; p < placed->n; p++) q[p] += m->a * weight[p] * from[p];
  }
}

/* The nodes [lo, hi) of a line to particles. */
static void RunGather(const MpmMarchArrays *a, const MpmRowStep *step, const Placed *placed, Work *w)
{
  PetscReal *line = w->line[0] + MARGIN;

  for (const MpmRowLine *l = a->plan->line + step->begin; l < a->plan->line + step->end; l++) {
    if (a->march->grid->dim == 1)
      line = a->node[l->node] + placed->offset[0];
    else
      MpmLinesGather(placed->rows, placed->offset, placed->weight[l->across], placed->hi - placed->lo,
                     a->node[l->node] + placed->lo, line + placed->lo);
    for (const MpmRowMap *m = a->plan->map + l->begin, *end = a->plan->map + l->end; m < end;) {
      const PetscInt n = GatherAlike(a, m, placed, line);

      if (!n) GatherShared(a, m, placed, w, line);
      m += n ? n : m->shared + 1;
    }
  }
}

/* Adds what the particles of a row give to a line. */
static void FillLine(const MpmMarchArrays *a, const MpmRowLine *l, const Placed *placed, Work *w, PetscReal *line)
{
  for (const MpmRowMap *m = a->plan->map + l->begin; m < a->plan->map + l->end; m++) {
    PetscReal       *q      = m->particle == MPM_NONE ? w->ones : MpmMarchRegister(a, m->particle, placed->begin);
    const PetscReal *weight = m->weight ? a->weight[m->weight] + placed->begin : NULL;

    if (weight) {
      for (PetscInt p = 0; p < placed->n; p++) w->weighed[p] = weight[p] * q[p];
      q = w->weighed;
    }
    RunMap(a, m, PETSC_TRUE, placed, m->a, q, line);
  }
}

/* Lines of one node field go to its rows together. */
static void RunSpread(const MpmMarchArrays *a, const MpmRowStep *step, const Placed *placed, Work *w)
{
  const PetscInt lo = placed->lo, n = placed->hi - lo;
  PetscReal      weight[MPM_MOST_LINES][MPM_MOST_ROWS];

  for (PetscInt first = step->begin, lines; first < step->end; first += lines) {
    const MpmRowLine *l = a->plan->line + first;
    PetscReal        *line[MPM_MOST_LINES];

    if (a->march->grid->dim == 1) {
      FillLine(a, l, placed, w, a->sum[l->node] + placed->offset[0]);
      lines = 1;
      continue;
    }
    for (lines = 0; lines < MPM_MOST_LINES && first + lines < step->end && l[lines].node == l->node; lines++) {
      line[lines] = w->line[lines] + MARGIN + lo;
      for (PetscInt i = 0; i < n; i++) line[lines][i] = 0;
      FillLine(a, &l[lines], placed, w, w->line[lines] + MARGIN);
      for (PetscInt r = 0; r < placed->rows; r++) weight[lines][r] = placed->weight[l[lines].across][r];
    }
    MpmLinesSpread(placed->rows, placed->offset, lines, (const PetscReal(*)[MPM_MOST_ROWS])weight,
                   (const PetscReal *const *)line, n, a->sum[l->node] + lo);
  }
}

/* Asks for the place of the first particle of the row that follows: rows read little of these arrays, far apart. */
static void PrefetchPlace(const MpmMarchArrays *a, PetscInt begin)
{
  for (PetscInt d = 0; d < a->march->grid->dim; d++) {
    __builtin_prefetch(&a->cell[d][begin]);
    __builtin_prefetch(&a->xi[d][begin]);
  }
}

static void RunRow(const MpmMarchArrays *a, const MpmRow *row, Work *w)
{
  const PetscInt begin = row->begin, n = row[1].begin - begin;
  const Placed  *placed = &w->placed[0];

  PrefetchPlace(a, row[1].begin);
  Place(a, row, 0, w);
  for (const MpmRowStep *step = a->plan->step; step < a->plan->step + a->plan->nsteps; step++) {
    if (step->begin < step->end) {
      (step->spreads ? RunSpread : RunGather)(a, step, placed, w);
      continue;
    }
    MpmMarchOnParticles(a, &step->op, begin, n, placed != w->placed ? PETSC_TRUE : PETSC_FALSE);
    if (MpmOpTraitsOf(step->op.kind).dst == MPM_NOWHERE) {
      Place(a, row, 1, w);
      placed = &w->placed[1];
    }
  }
}

void MpmRowsRun(const MpmMarchArrays *arrays)
{
  const MpmMarch *march = arrays->march;
  Work            work;

  for (PetscInt p = 0; p < MPM_BLOCK; p++) work.ones[p] = 1;
  for (PetscInt r = 0; r < march->nrows; r++) RunRow(arrays, &march->row[r], &work);
}
