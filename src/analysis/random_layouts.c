/* Random layouts in a small periodic box: growth, limits, and layouts that are made worse step by step. */
#include "analysis/cluster.h"
#include "analysis/lone.h"
#include "analysis/neighbourhood.h"
#include "analysis/search.h"
#include "base/farm.h"
#include "base/textfile.h"
#include "scene/layout.h"
#include <math.h>

#define LEAST 1e-6     /* Courant number below which no limit is sought */
#define PRECISION 1e-7 /* relative, of a limit */
#define TAKES 0.1      /* share of the moves that take a particle away */
#define HALVINGS 10

PetscInt MpmRankOfQuantile(PetscInt quantile, PetscInt n)
{
  static const PetscInt percent[MPM_QUANTILES] = {5, 50, 95};

  return (percent[quantile] * n + 99) / 100;
}

typedef struct {
  const MpmCriticalCase  *of;
  const MpmNodalPlan     *plan;
  const MpmRandomLayouts *asked;
  MpmNeighbourhood       *found;
  PetscReal               courant, *growth; /* growth of each layout at this Courant number */
  PetscInt                evaluations;
} Search;

/* One layout in its box, and its particles. */
typedef struct {
  Search    *search;
  MpmLayout  layout;
  MpmCluster cluster;
  PetscBool  failed; /* LAPACK did not converge at some Courant number */
} Boxed;

/* Layout i. given: that of a layout with particles anywhere, else NULL; destroyed with MpmGivenDestroy. */
static PetscErrorCode BoxOf(const Search *s, PetscInt i, MpmLayout *to)
{
  MpmLayout l = *s->of->layout;

  PetscFunctionBegin;
  l.seed  = s->asked->seed + i;
  l.sites = 1;
  if (l.jitter == 0) l.jitter = 1;
  for (PetscInt a = 0; a < l.dim; a++) {
    const PetscInt cells = s->found->cells;

    l.grid[a]  = (MpmDirection){.cells = cells, .nodes = cells, .ends = {MPM_PERIODIC, MPM_PERIODIC}};
    l.first[a] = 0;
    l.row[a]   = (PetscInt64)cells * l.ppc[a];
    l.sites *= l.row[a];
  }
  l.particles = l.sites;
  if (s->asked->scatter && i % 2) {
    l.jitter = 0;
    PetscCall(MpmGivenCreateRandom(&l));
    PetscCall(MpmGivenScatter(&l));
  }
  *to = l;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsThere(const Boxed *b, PetscInt64 site)
{
  return !b->layout.given && MpmLayoutIsVoid(&b->layout, site, b->search->asked->voids) ? PETSC_FALSE : PETSC_TRUE;
}

/* Takes the particles where they are. */
static void Take(Boxed *b)
{
  MpmCluster    *c   = &b->cluster;
  const PetscInt dim = b->layout.dim;

  c->n = 0;
  for (PetscInt64 site = 0; site < b->layout.sites; site++) {
    if (!IsThere(b, site)) continue;
    MpmLayoutPlace(&b->layout, site, c->cell + dim * c->n, c->xi + dim * c->n);
    c->n++;
  }
}

static PetscErrorCode BoxedCreate(Search *search, PetscInt i, Boxed *b)
{
  PetscFunctionBegin;
  *b = (Boxed){.search = search, .cluster = {.of = search->of, .plan = search->plan}};
  PetscCall(BoxOf(search, i, &b->layout));
  for (PetscInt a = 0; a < b->layout.dim; a++) {
    b->cluster.nodes[a] = b->layout.grid[a].nodes;
    b->cluster.wraps[a] = PETSC_TRUE;
  }
  PetscCall(MpmClusterCreate((PetscInt)b->layout.sites, &b->cluster));
  Take(b);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode BoxedDestroy(Boxed *b)
{
  PetscFunctionBegin;
  b->search->evaluations += b->cluster.count;
  PetscCall(MpmClusterDestroy(&b->cluster));
  PetscCall(MpmGivenDestroy(&b->layout.given));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* NaN where LAPACK did not converge. */
static PetscErrorCode Growth(void *context, PetscReal courant, PetscReal *growth)
{
  Boxed    *b = (Boxed *)context;
  PetscReal rounding;

  PetscFunctionBegin;
  PetscCall(MpmClusterGrowth(&b->cluster, courant, growth, &rounding));
  if (isnan(*growth)) b->failed = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GrowthOf(void *context, PetscInt i)
{
  Search *s = (Search *)context;
  Boxed   b;

  PetscFunctionBegin;
  PetscCall(BoxedCreate(s, i, &b));
  PetscCall(Growth(&b, s->courant, &s->growth[i]));
  PetscCall(BoxedDestroy(&b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GrowthOfAll(Search *s, PetscReal courant)
{
  PetscFunctionBegin;
  s->courant = courant;
  PetscCall(PetscArrayzero(s->growth, s->asked->n));
  PetscCall(MpmFarm("layout", s->asked->n, GrowthOf, s));
  PetscCall(MpmFarmSumReals(s->asked->n, s->growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest growth of all layouts at a Courant number. */
static PetscErrorCode LargestGrowth(void *context, PetscReal courant, PetscReal *growth)
{
  Search *s = (Search *)context;

  PetscFunctionBegin;
  PetscCall(GrowthOfAll(s, courant));
  *growth = 0;
  for (PetscInt i = 0; i < s->asked->n; i++)
    if (!(s->growth[i] <= *growth)) *growth = s->growth[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least limit of layouts that may grow and cease to grow. */
static PetscErrorCode ScanForLimit(Search *s)
{
  MpmCritical critical = {.threshold = PETSC_TRUE};

  PetscFunctionBegin;
  PetscCall(MpmSearchScan(LargestGrowth, s, s->of->tolerance, s->of->step.courant, PRECISION, &critical));
  s->found->windows = critical.windows;
  s->found->fades   = critical.threshold ? PETSC_FALSE : PETSC_TRUE;
  s->found->courant = isinf(critical.unstable_at) ? INFINITY : critical.threshold ? critical.stable_at : 0;
  if (isinf(critical.unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GrowthOfAll(s, critical.unstable_at));
  for (PetscInt i = s->asked->n - 1; i >= 0; i--)
    if (!(s->growth[i] <= 1 + s->of->tolerance)) s->found->worst_seed = s->asked->seed + i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the limit of each layout, where growth has real eigenvalues below -1 alone ---- */

/* The limit by growth, where it is below a Courant number; else infinite. */
static PetscErrorCode SoughtLimit(Boxed *b, PetscReal to, PetscReal *limit)
{
  const MpmSearchSteps steps = {.from = to, .to = to, .least = LEAST};
  PetscReal            bracket[2];

  PetscFunctionBegin;
  b->failed = PETSC_FALSE;
  PetscCall(MpmSearchFirst(Growth, b, b->search->of->tolerance, &steps, PRECISION, bracket));
  *limit = b->failed ? NAN : isinf(bracket[1]) ? INFINITY : PetscMax(bracket[0], LEAST);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The limit; one that is not below a Courant number need not be known. */
static PetscErrorCode LimitOfBox(Boxed *b, PetscReal to, PetscReal *limit)
{
  PetscFunctionBegin;
  PetscCall(b->search->plan->degree == 1 ? MpmClusterCrossing(&b->cluster, limit)
                                         : SoughtLimit(b, PetscMin(to, MPM_CRITICAL_TO), limit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gives the layout the places of the particles that are there, so that they can be moved and taken away. */
static PetscErrorCode Loosen(Boxed *b)
{
  MpmLayout *l     = &b->layout;
  MpmGiven  *given = NULL;
  PetscInt   cell[MPM_MAX_DIM];
  PetscReal  xi[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(PetscNew(&given));
  for (PetscInt a = 0; a < l->dim; a++) PetscCall(PetscMalloc1(l->sites, &given->column[a]));
  for (PetscInt64 site = 0; site < l->sites; site++) {
    if (!IsThere(b, site)) continue;
    MpmLayoutPlace(l, site, cell, xi);
    for (PetscInt a = 0; a < l->dim; a++)
      given->column[a][given->particles] = (cell[a] + l->grid[a].cells) % l->grid[a].cells + xi[a];
    given->particles++;
  }
  PetscCall(MpmGivenDestroy(&l->given));
  l->given  = given;
  l->jitter = 0;
  l->sites = l->particles = given->particles;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A change of a layout: particle p is moved, or taken away; before: where it was. */
typedef struct {
  PetscInt64 p;
  PetscBool  takes;
  PetscReal  before[MPM_MAX_DIM];
} Move;

/* Makes move m. Moves become shorter, from half a cell to 2^-HALVINGS of that. */
static void MakeMove(MpmLayout *l, PetscInt m, PetscInt moves, Move *move)
{
  const PetscInt64 seed = MpmLayoutSeed(l, MPM_MAX_DIM), first = (PetscInt64)m * (MPM_MAX_DIM + 2);
  const PetscReal  reach = exp2(-HALVINGS * m / (PetscReal)moves);

  move->p     = (PetscInt64)(MpmHash(seed, first) * (PetscReal)l->sites);
  move->takes = MpmHash(seed, first + 1) < TAKES ? PETSC_TRUE : PETSC_FALSE;
  for (PetscInt a = 0; a < l->dim; a++) {
    const PetscReal cells = l->grid[a].cells, by = reach * (MpmHash(seed, first + 2 + a) - 0.5);
    PetscReal      *x = l->given->column[a];

    move->before[a] = x[move->p];
    x[move->p]      = move->takes ? x[l->sites - 1] : fmod(x[move->p] + by + cells, cells);
  }
  if (move->takes) l->sites--;
}

static void TakeBack(MpmLayout *l, const Move *move)
{
  if (move->takes) l->sites++;
  for (PetscInt a = 0; a < l->dim; a++) l->given->column[a][move->p] = move->before[a];
}

/* Moves one particle after another, or takes it away, and keeps what makes the limit smaller. */
static PetscErrorCode Worsen(Boxed *b, PetscReal *limit)
{
  PetscFunctionBegin;
  PetscCall(Loosen(b));
  for (PetscInt m = 0; m < b->search->asked->moves && b->layout.sites > 1; m++) {
    Move      move;
    PetscReal other;

    MakeMove(&b->layout, m, b->search->asked->moves, &move);
    Take(b);
    PetscCall(LimitOfBox(b, *limit, &other));
    if (other < *limit * (1 - PRECISION)) /* rounding must not choose the way */
      *limit = other;
    else
      TakeBack(&b->layout, &move);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Writes the places of the worst layout, in cells. All ranks make them again. */
static PetscErrorCode Write(Search *s)
{
  const PetscInt before = s->evaluations;
  MpmTextFile    csv;
  PetscReal      limit;
  Boxed          b;

  PetscFunctionBegin;
  PetscCall(BoxedCreate(s, (PetscInt)(s->found->worst_seed - s->asked->seed), &b));
  PetscCall(LimitOfBox(&b, MPM_CRITICAL_TO, &limit));
  PetscCall(Worsen(&b, &limit));
  PetscCall(MpmTextFileOpen(s->asked->write, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "%.*s\n", (int)(2 * b.layout.dim - 1), "x,y,z");
    for (PetscInt64 p = 0; p < b.layout.sites; p++)
      for (PetscInt a = 0; a < b.layout.dim; a++)
        fprintf(csv.stream, "%.17g%s", b.layout.given->column[a][p], a < b.layout.dim - 1 ? "," : "\n");
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscCall(BoxedDestroy(&b));
  s->evaluations = before;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LimitOf(void *context, PetscInt i)
{
  Search *s = (Search *)context;
  Boxed   b;

  PetscFunctionBegin;
  PetscCall(BoxedCreate(s, i, &b));
  PetscCall(LimitOfBox(&b, MPM_CRITICAL_TO, &s->growth[i]));
  if (s->asked->moves) PetscCall(Worsen(&b, &s->growth[i]));
  PetscCall(BoxedDestroy(&b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least limit and the quantiles of all. Where one is not known none of these is. */
static PetscErrorCode FindLimits(Search *s)
{
  const MpmRandomLayouts *asked = s->asked;
  MpmNeighbourhood       *found = s->found;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(s->growth, asked->n));
  PetscCall(MpmFarm("layout", asked->n, LimitOf, s));
  PetscCall(MpmFarmSumReals(asked->n, s->growth));
  found->courant = INFINITY;
  for (PetscInt i = 0; i < asked->n; i++) {
    if (isnan(s->growth[i])) {
      found->courant = NAN;
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    if (!(s->growth[i] < found->courant)) continue;
    found->courant    = s->growth[i];
    found->worst_seed = asked->seed + i;
  }
  if (asked->write && *asked->write && isfinite(found->courant)) PetscCall(Write(s));
  PetscCall(PetscSortReal(asked->n, s->growth));
  for (PetscInt q = 0; q < MPM_QUANTILES && asked->scatter; q++)
    found->quantile[q] = s->growth[MpmRankOfQuantile(q, asked->n) - 1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindLimit(Search *s)
{
  const MpmCriticalCase *of = s->of;

  PetscFunctionBegin;
  if (MpmLeftmostDecides(of->layout, of->scheme, &of->step) ||
      (s->asked->scatter && MpmGrowthStays(of->layout, of->scheme, &of->step)))
    PetscCall(FindLimits(s));
  else
    PetscCall(ScanForLimit(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth at the case's own Courant number. */
static PetscErrorCode FindGrowth(Search *s)
{
  const MpmRandomLayouts *asked = s->asked;
  MpmNeighbourhood       *found = s->found;

  PetscFunctionBegin;
  PetscCall(GrowthOfAll(s, s->of->step.courant));
  for (PetscInt i = 0; i < asked->n; i++) {
    if (isnan(s->growth[i])) found->undecided++;
    if (s->growth[i] > 1 + s->of->tolerance) found->unstable++;
    if (s->growth[i] <= found->growth) continue;
    found->growth     = s->growth[i];
    found->worst_seed = asked->seed + i;
  }
  if (found->undecided) found->growth = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRandomLayoutsFind(const MpmCriticalCase *of, const MpmRandomLayouts *asked, MpmNeighbourhood *found)
{
  static const PetscInt box[MPM_MAX_DIM] = {24, 6, 3};
  Search                s                = {.of = of, .asked = asked, .found = found};
  MpmNodalPlan         *plan;

  PetscFunctionBegin;
  PetscCall(MpmNodalPlanCreate(of->scheme->table, NULL, &plan));
  s.plan            = plan;
  *found            = MpmNeighbourhoodOf(found->kind);
  found->growth     = 0;
  found->layouts    = asked->n;
  found->cells      = asked->cells ? asked->cells : box[of->layout->dim - 1];
  found->worst_seed = asked->seed;
  PetscCall(PetscMalloc1(asked->n, &s.growth));
  PetscCall(FindGrowth(&s));
  if (asked->limits) PetscCall(FindLimit(&s));
  PetscCall(MpmFarmSumInts(1, &s.evaluations));
  found->evaluations = s.evaluations;
  PetscCall(PetscFree(s.growth));
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}
