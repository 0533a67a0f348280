/* Takes the particles of a rank through a pass, cloud by cloud. */
#include "march/clouds.h"
#include <stdint.h>

#define LINE 64        /* bytes in a line of the cache: the values of a node are in one line */
#define SECOND_LEVEL 2 /* of the cache: the first one has no room for another cloud */

#define SIDE MPM_SIDE /* particles, or lanes, that are moved at once */
typedef PetscReal Side __attribute__((vector_size(SIDE * sizeof(PetscReal)), aligned(sizeof(PetscReal)), may_alias));
typedef int       Halves __attribute__((vector_size(SIDE * sizeof(PetscReal)), aligned(sizeof(PetscReal)), may_alias));

/* The places of a cloud, before DRIFT or after it, and its weights, by direction and number of the kind in the plan. */
typedef struct {
  MpmCloud  cloud;
  PetscReal weight[MPM_MAX_DIM][MPM_MOST_KINDS][MPM_MOST_NODES * MPM_CLOUD];
} Placed;

/*
   Memory for a cloud while it is in a pass. products: the numbers of a cloud's particles for each product of weights of
   each part; 0 for what has no map. lane: the numbers of some lanes, one after another.
*/
typedef struct {
  Placed placed[2];
  _Alignas(LINE) PetscReal lane[SIDE][MPM_CLOUD], ones[MPM_CLOUD];
  const MpmCloudPlan *plan;
  PetscReal          *products;
  PetscReal          *node[2 * (MPM_MAX_FIELDS + 1)]; /* node 0 of each bundle */
} Work;

/* Finds the nodes and the weights of the cloud, the n particles from begin on. */
static void Place(const MpmMarchArrays *a, PetscInt begin, PetscInt n, PetscInt after, Placed *placed)
{
  const MpmMarch *march = a->march;
  const MpmBasis *basis = march->scheme->basis;
  MpmBlock        block;
  PetscInt        moved[MPM_CLOUD];
  PetscReal       xi[MPM_CLOUD];

  placed->cloud.n = block.n = n;
  for (PetscInt p = 0; p < n; p++) placed->cloud.first[p] = 0;
  for (PetscInt d = 0; d < march->grid->dim; d++) {
    const PetscInt stride = march->grid->axis[d].stride, *cell = a->cell[d] + begin;

    block.xi = a->xi[d] + begin;
    if (march->particles->drift[d].value != 0) {
      MpmMarchPlaces(a, d, n, cell, block.xi, after, moved, xi);
      cell     = moved;
      block.xi = xi;
    }
    block.half_width = march->layout->half_width[d];
    MpmDirectionWalls(&march->layout->grid[d], march->grid->axis[d].first, block.wall);
    basis->first_nodes(n, cell, block.xi, block.first);
    for (PetscInt p = 0; p < n; p++) placed->cloud.first[p] += stride * block.first[p];
    for (PetscInt k = 0; k < a->plan->nkinds; k++)
      basis->weights[a->plan->kind[k]](&block, MPM_CLOUD, placed->weight[d][k]);
  }
}

/* The weights of the kinds of a part. */
static void TakeWeights(const MpmCloudPart *part, PetscInt dim, Placed *placed)
{
  placed->cloud.kinds = part->nkinds;
  for (PetscInt d = 0; d < dim; d++) {
    placed->cloud.weight[d][0] = placed->weight[d][0];
    for (PetscInt k = 0; k < part->nkinds; k++) placed->cloud.weight[d][1 + k] = placed->weight[d][part->kind[k]];
  }
}

/*
   Takes a lane from vectors of width lanes. Numbers are stored in the groups in which they are read next. A read of a
   group that was stored in parts would wait until all of them are in the cache.
*/
static inline void TakeLaneOf(const PetscReal *restrict from, const PetscInt width, PetscInt n, PetscReal *restrict to)
{
  for (PetscInt p = 0; p < n; p += SIDE, from += SIDE * width)
    *(Side *)(to + p) = (Side){from[0], from[width], from[2 * width], from[3 * width]};
}

static void TakeLane(const PetscReal from[], PetscInt width, PetscInt n, PetscReal to[])
{
  if (width == 4) TakeLaneOf(from, 4, n, to);
  if (width == 8) TakeLaneOf(from, 8, n, to);
}

#define SOURCES 4 /* of either kind, that are added up in registers */

/* What lanes get: a times the numbers q of a field, or times vectors of lanes that are put in an order, in halves. */
typedef struct {
  const PetscReal *q;
  Side             a;
  Halves           order;
} Source;

typedef struct {
  int    nfields, ntaken;
  Source field[SOURCES], taken[SOURCES];
} Sources;

/* Sets SIDE lanes that are beside one another as a group, in which they are read next. Vectors have width lanes. */
static inline __attribute__((always_inline)) void GiveOf(const int nfields, const int ntaken, const Sources *s,
                                                         PetscInt width, PetscInt n, PetscReal *to)
{
  const PetscReal *q[2 * SOURCES];
  Side             a[2 * SOURCES];
  Halves           order[SOURCES];

  for (int i = 0; i < nfields; i++) {
    q[i] = s->field[i].q;
    a[i] = s->field[i].a;
  }
  for (int i = 0; i < ntaken; i++) {
    q[SOURCES + i] = s->taken[i].q;
    a[SOURCES + i] = s->taken[i].a;
    order[i]       = s->taken[i].order;
  }
  for (PetscInt p = 0; p < n; p++) {
    Side sum = {0};

    for (int i = 0; i < nfields; i++) sum += a[i] * q[i][p];
    for (int i = 0; i < ntaken; i++)
      sum += a[SOURCES + i] * (Side)__builtin_shuffle(*(const Halves *)(q[SOURCES + i] + width * p), order[i]);
    *(Side *)(to + width * p) = sum;
  }
}

/* One loop for each number of fields and of vectors. */
#define DEFINE(nfields, ntaken)                                                                                        \
  static void Give##nfields##ntaken(const Sources *s, PetscInt width, PetscInt n, PetscReal *to)                       \
  {                                                                                                                    \
    GiveOf(nfields, ntaken, s, width, n, to);                                                                          \
  }
#define FOR_EACH(OF) OF(0) OF(1) OF(2) OF(3) OF(4)
#define DEFINE_ALL(n) DEFINE(n, 0) DEFINE(n, 1) DEFINE(n, 2) DEFINE(n, 3) DEFINE(n, 4)
#define NAME_ALL(n) {Give##n##0, Give##n##1, Give##n##2, Give##n##3, Give##n##4},
FOR_EACH(DEFINE_ALL)
static void (*const give[1 + SOURCES][1 + SOURCES])(const Sources *, PetscInt, PetscInt,
                                                    PetscReal *) = {FOR_EACH(NAME_ALL)};

/* What the nodes of particle p give to it, or with spreads get from it: q times the weights of a map along two axes. */
static PetscReal Cross(const MpmMarchArrays *a, const MpmCloudCross *c, const Placed *placed, PetscInt p,
                       PetscInt width, PetscReal *restrict node, PetscBool spreads, PetscReal q)
{
  const PetscInt nodes = a->march->scheme->basis->nodes, dim = a->march->grid->dim, *stride = placed->cloud.stride;
  PetscReal      sum = 0;

  for (PetscInt z = 0; z < (dim > 2 ? nodes : 1); z++)
    for (PetscInt y = 0; y < nodes; y++) {
      const PetscReal across = placed->weight[1][c->kind[1]][y * MPM_CLOUD + p] *
                               (dim > 2 ? placed->weight[2][c->kind[2]][z * MPM_CLOUD + p] : 1);
      PetscReal *line = node + width * (placed->cloud.first[p] + y * stride[1] + z * (dim > 2 ? stride[2] : 0));

      for (PetscInt x = 0; x < nodes; x++) {
        const PetscReal weight = placed->weight[0][c->kind[0]][x * MPM_CLOUD + p] * across;

        sum += weight * line[width * x + c->lane];
        if (spreads) line[width * x + c->lane] += weight * q;
      }
    }
  return sum;
}

/* Maps along two axes are few, so they go from node to node. */
static void RunCrosses(const MpmMarchArrays *a, const MpmCloudPart *part, PetscInt begin, PetscBool spreads,
                       const Placed *placed, Work *w)
{
  const PetscInt width = w->plan->bundle[part->bundle].width;

  for (const MpmCloudCross *c = w->plan->cross + part->first_cross; c < w->plan->cross + part->end_cross; c++) {
    const PetscReal *weight = c->weight ? a->weight[c->weight] + begin : w->ones;
    PetscReal       *q      = MpmMarchRegister(a, c->particle, begin);

    for (PetscInt p = 0; p < placed->cloud.n; p++) {
      const PetscReal factor = c->a * weight[p];

      if (spreads)
        (void)Cross(a, c, placed, p, width, w->node[part->bundle], PETSC_TRUE, factor * q[p]);
      else
        q[p] += factor * Cross(a, c, placed, p, width, w->node[part->bundle], PETSC_FALSE, 0);
    }
  }
}

/* q += a weight from, or without weight q += a from */
static void AddWeighed(PetscInt n, PetscReal a, const PetscReal *restrict weight, const PetscReal *restrict from,
                       PetscReal *restrict q)
{
  if (weight)
    for (PetscInt p = 0; p < n; p++) q[p] += a * weight[p] * from[p];
  else
    for (PetscInt p = 0; p < n; p++) q[p] += a * from[p];
}

static void RunGather(const MpmMarchArrays *a, const MpmCloudPart *part, PetscInt begin, const Placed *placed, Work *w)
{
  const MpmCloudPlan *plan  = w->plan;
  const PetscInt      width = plan->bundle[part->bundle].width, n = placed->cloud.n;
  PetscReal          *taken = w->products + part->products;

  part->run(&placed->cloud, w->node[part->bundle], taken);
  for (const MpmCloudMap *m = plan->map + part->begin; m < plan->map + part->end; m++) {
    if (m == plan->map + part->begin || m->product != m[-1].product || m->lane != m[-1].lane)
      TakeLane(taken + width * MPM_CLOUD * m->product + m->lane, width, n, w->lane[0]);
    AddWeighed(n, m->a, m->weight ? a->weight[m->weight] + begin : NULL, w->lane[0],
               MpmMarchRegister(a, m->particle, begin));
  }
}

static const PetscReal *FieldOf(const MpmMarchArrays *a, const MpmCloudMap *m, PetscInt begin, const Work *w)
{
  return m->particle == MPM_NONE ? w->ones : MpmMarchRegister(a, m->particle, begin);
}

/*
   Adds a source of the lane of map m: the field that it gives, or if particles have weights the sum of all that the
   lane gets. Returns the first map that has not been done.
*/
static const MpmCloudMap *AddField(const MpmMarchArrays *a, const MpmCloudMap *m, const MpmCloudMap *end,
                                   PetscInt begin, PetscInt n, Work *w, Source *from)
{
  const MpmCloudMap *first = m;
  const PetscInt     l     = m->lane % SIDE;
  PetscReal         *lane  = w->lane[l];

  from->a    = (Side){0};
  from->a[l] = m->weight ? 1 : m->a;
  from->q    = m->weight ? lane : FieldOf(a, m, begin, w);
  if (!m->weight) return m + 1;
  for (PetscInt p = 0; p < n; p++) lane[p] = 0;
  for (; m < end && m->product == first->product && m->lane == first->lane; m++)
    AddWeighed(n, m->a, m->weight ? a->weight[m->weight] + begin : NULL, FieldOf(a, m, begin, w), lane);
  return m;
}

static void AddTaken(const MpmCloudTerm *t, const Work *w, Source *from)
{
  from->q = w->products + t->from;
  for (int l = 0; l < SIDE; l++) {
    from->a[l]             = t->a[l];
    from->order[2 * l]     = 2 * (l ^ t->swap);
    from->order[2 * l + 1] = 2 * (l ^ t->swap) + 1;
  }
}

static void RunSpread(const MpmMarchArrays *a, const MpmCloudPart *part, PetscInt begin, const Placed *placed, Work *w)
{
  const MpmCloudPlan *plan = w->plan;
  const MpmCloudMap  *m = plan->map + part->begin, *end = plan->map + part->end;
  const MpmCloudTerm *t = plan->term + part->first_term, *last = plan->term + part->end_term;
  const PetscInt      width = plan->bundle[part->bundle].width, n = placed->cloud.n;
  PetscReal          *given = w->products + part->products, *before = NULL;

  while (m < end || t < last) {
    const PetscBool fields =
        t == last || (m < end && (m->product < t->product || (m->product == t->product && m->lane / SIDE <= t->side)))
            ? PETSC_TRUE
            : PETSC_FALSE;
    const PetscInt   product = fields ? m->product : t->product, side = fields ? m->lane / SIDE : t->side;
    PetscReal *const to = given + width * MPM_CLOUD * product + SIDE * side;
    Sources          from;

    from.nfields = from.ntaken = 0;
    if (to == before) /* there are more than one loop adds up */
      AddTaken(&(MpmCloudTerm){.from = (PetscInt)(to - w->products), .a = {1, 1, 1, 1}}, w, &from.taken[from.ntaken++]);
    before = to;
    while (from.nfields < SOURCES && m < end && m->product == product && m->lane / SIDE == side)
      m = AddField(a, m, end, begin, n, w, &from.field[from.nfields++]);
    while (from.ntaken < SOURCES && t < last && t->product == product && t->side == side)
      AddTaken(t++, w, &from.taken[from.ntaken++]);
    give[from.nfields][from.ntaken](&from, width, n, to);
  }
  part->run(&placed->cloud, w->node[part->bundle], given);
}

/* Asks for the state of n particles before it is read: a cloud is too short for the processor to foresee what comes. */
static void Prefetch(const MpmMarchArrays *a, PetscInt begin, PetscInt n)
{
  for (PetscInt p = begin; p < begin + n; p += LINE / (PetscInt)sizeof(PetscReal)) {
    for (PetscInt f = 0; f < a->march->scheme->table->nstate; f++)
      __builtin_prefetch(a->particle[f] + p, 1, SECOND_LEVEL);
    for (PetscInt d = 0; d < a->march->grid->dim; d++) {
      __builtin_prefetch(a->xi[d] + p, 0, SECOND_LEVEL);
      __builtin_prefetch(a->cell[d] + p, 0, SECOND_LEVEL);
    }
  }
}

static void RunCloud(const MpmMarchArrays *a, PetscInt begin, PetscInt n, Work *w)
{
  Placed *placed = &w->placed[0];

  Prefetch(a, begin + n, PetscMin(MPM_CLOUD, a->march->particles->count - begin - n));
  Place(a, begin, n, 0, placed);
  for (PetscInt s = 0; s < a->plan->nsteps; s++) {
    const MpmRowStep *step = &a->plan->step[s];

    for (const MpmCloudPart *part = w->plan->part + w->plan->first[s]; part < w->plan->part + w->plan->first[s + 1];
         part++) {
      TakeWeights(part, a->march->grid->dim, placed);
      if (part->run) (step->spreads ? RunSpread : RunGather)(a, part, begin, placed, w);
      RunCrosses(a, part, begin, step->spreads, placed, w);
    }
    if (w->plan->composed || step->begin < step->end) continue;
    MpmMarchOnParticles(a, &step->op, begin, n, placed != w->placed ? PETSC_TRUE : PETSC_FALSE);
    if (MpmOpTraitsOf(step->op.kind).dst == MPM_NOWHERE) {
      placed = &w->placed[1];
      Place(a, begin, n, 1, placed);
    }
  }
}

/* Copies the fields of a bundle that is read into it, or the sums of the others out of it. */
static inline void CopyWidth(const MpmMarchArrays *a, const MpmCloudBundle *bundle, const PetscInt width,
                             PetscInt nodes, PetscReal *restrict values)
{
  PetscReal *field[MPM_BUNDLE] = {NULL};

  for (PetscInt l = 0; l < width; l++)
    field[l] = (bundle->sums ? a->sum : a->node)[bundle->node[PetscMin(l, bundle->n - 1)]] - a->march->grid->origin;
  if (bundle->sums) {
    for (PetscInt i = 0; i < nodes; i++)
      for (PetscInt l = 0; l < bundle->n; l++) field[l][i] = values[width * i + l];
    return;
  }
  for (PetscInt i = 0; i < nodes; i++)
    for (PetscInt l = 0; l < width; l++) values[width * i + l] = field[l][i];
}

static void Copy(const MpmMarchArrays *a, const MpmCloudBundle *bundle, PetscInt nodes, PetscReal *restrict values)
{
  if (bundle->width == 4) CopyWidth(a, bundle, 4, nodes, values);
  if (bundle->width == 8) CopyWidth(a, bundle, 8, nodes, values);
}

PetscInt MpmCloudsSize(const MpmGrid *grid, const MpmCloudPlan *plan)
{
  return plan->width * MpmGridSize(grid) + plan->products + LINE / sizeof(PetscReal);
}

PetscErrorCode MpmCloudsRun(const MpmMarchArrays *a, const MpmCloudPlan *plan, PetscReal bundles[])
{
  const MpmGrid *grid  = a->march->grid;
  const PetscInt count = a->march->particles->count, nodes = MpmGridSize(grid);
  PetscReal     *first = bundles + (LINE - (uintptr_t)bundles % LINE) / sizeof(PetscReal);
  Work           work  = {.plan = plan, .products = first + plan->width * nodes};

  PetscFunctionBegin;
  for (PetscInt i = 0; i < 2; i++) {
    work.placed[i].cloud.dim   = grid->dim;
    work.placed[i].cloud.nodes = a->march->scheme->basis->nodes;
    for (PetscInt d = 0; d < grid->dim; d++) work.placed[i].cloud.stride[d] = grid->axis[d].stride;
  }
  for (PetscInt p = 0; p < MPM_CLOUD; p++) work.ones[p] = 1;
  PetscCall(PetscArrayzero(work.products, plan->products));
  for (PetscInt b = 0; b < plan->nbundles; b++) {
    const MpmCloudBundle *bundle = &plan->bundle[b];
    PetscReal            *values = first + bundle->begin * nodes;

    work.node[b] = values + bundle->width * grid->origin;
    if (bundle->sums)
      PetscCall(PetscArrayzero(values, bundle->width * nodes));
    else
      Copy(a, bundle, nodes, values);
  }
  for (PetscInt begin = 0; begin < count; begin += MPM_CLOUD)
    RunCloud(a, begin, PetscMin(MPM_CLOUD, count - begin), &work);
  for (PetscInt b = 0; b < plan->nbundles; b++)
    if (plan->bundle[b].sums) Copy(a, &plan->bundle[b], nodes, first + plan->bundle[b].begin * nodes);
  PetscFunctionReturn(PETSC_SUCCESS);
}
