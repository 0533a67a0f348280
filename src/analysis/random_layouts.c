/*
   The nodal operator of a random layout. A product of maps, P W, is made particle by particle:

     (P W)_ij = sum_p P_ip W_jp / m_i

   In units in which a node's value is multiplied by the root of its mass it is P_ip W_jp / sqrt(m_i m_j), which has
   entries of order 1 however little mass a node has. Nodes without mass are left out.
*/
#include "analysis/lone.h"
#include "analysis/random_layouts.h"
#include "analysis/search.h"
#include "base/farm.h"
#include "base/textfile.h"
#include "linalg/dense.h"
#include "operator/nodal.h"
#include "program/maps.h"
#include "scene/layout.h"
#include <math.h>

#define LEAST 1e-6     /* Courant number below which no limit is sought */
#define PRECISION 1e-7 /* relative, of a limit */
#define TAKES 0.1      /* share of the moves that take a particle away */
#define HALVINGS 10
#define MOST_WEIGHTS (MPM_MAX_REACH * MPM_MAX_REACH * MPM_MAX_REACH)

PetscInt MpmRankOfQuantile(PetscInt quantile, PetscInt n)
{
  static const PetscInt percent[MPM_QUANTILES] = {5, 50, 95};

  return (percent[quantile] * n + 99) / 100;
}

typedef struct {
  const MpmCriticalCase *of;
  const MpmNodalPlan    *plan;
  MpmRandomLayouts      *asked;
  PetscReal              courant, *growth; /* growth of each layout at this Courant number */
  PetscInt               evaluations;
} Search;

/* One layout in its box: its particles, the nodal masses, and its nodal operator as a polynomial. */
typedef struct {
  const Search    *search;
  MpmLayout        layout;
  PetscInt         nodes, n;
  PetscReal       *mass;
  double complex **coefficient;
  PetscReal       *matrix, *re, *im;
  PetscInt        *evaluations;
  PetscBool        failed; /* LAPACK did not converge at some Courant number */
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
    const PetscInt cells = s->asked->box;

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

/* The nodes of a site's particle, and its weights there of a kind of map along an axis. Returns how many there are. */
static PetscInt Weights(const Boxed *b, PetscInt64 site, MpmOpKind kind, PetscInt axis, PetscInt node[],
                        PetscReal weight[])
{
  static const MpmParity even[MPM_MAX_DIM] = {MPM_EVEN, MPM_EVEN, MPM_EVEN};
  const MpmLayout       *l                 = &b->layout;
  const MpmSlab          slab              = {.layout = l, .scheme = b->search->of->scheme};
  PetscInt               cell[MPM_MAX_DIM];
  PetscReal              xi[MPM_MAX_DIM], row[MPM_MAX_DIM][MPM_MAX_REACH];

  MpmLayoutPlace(l, site, cell, xi);
  for (PetscInt a = 0; a < l->dim; a++)
    MpmMapRow(slab.scheme->basis, a == axis ? kind : MPM_G2P, xi[a], l->half_width[a], MpmNoWalls, row[a]);
  return MpmNodeWeights(&slab, row, even, PETSC_FALSE, cell, node, weight);
}

static PetscBool IsThere(const Boxed *b, PetscInt64 site)
{
  return !b->layout.given && MpmLayoutIsVoid(&b->layout, site, b->search->asked->voids) ? PETSC_FALSE : PETSC_TRUE;
}

static PetscErrorCode Masses(Boxed *b)
{
  PetscInt  node[MOST_WEIGHTS];
  PetscReal phi[MOST_WEIGHTS];

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(b->mass, b->nodes));
  for (PetscInt64 site = 0; site < b->layout.sites; site++) {
    const PetscInt n = IsThere(b, site) ? Weights(b, site, MPM_P2G, 0, node, phi) : 0;

    for (PetscInt i = 0; i < n; i++) b->mass[node[i]] += phi[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void AddProduct(const Boxed *b, const MpmOp *P, const MpmOp *W, double complex map[])
{
  PetscInt  from[MOST_WEIGHTS], to[MOST_WEIGHTS];
  PetscReal w[MOST_WEIGHTS], p[MOST_WEIGHTS];

  for (PetscInt64 site = 0; site < b->layout.sites; site++) {
    PetscInt n;

    if (!IsThere(b, site)) continue;
    n = Weights(b, site, W->kind, W->axis, from, w);
    (void)Weights(b, site, P->kind, P->axis, to, p);
    for (PetscInt j = 0; j < n; j++)
      for (PetscInt i = 0; i < n; i++) {
        const PetscReal mass = b->mass[to[i]] * b->mass[from[j]];

        if (mass > 0) map[from[j] * b->nodes + to[i]] += p[i] * w[j] / sqrt(mass);
      }
  }
}

/* The second difference along an axis, between nodes with mass. */
static void AddStencil(const Boxed *b, const MpmOp *op, double complex map[])
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscInt    cells  = b->layout.grid[0].cells;
  PetscInt          stride = 1;

  for (PetscInt a = 0; a < op->axis; a++) stride *= cells;
  for (PetscInt i = 0; i < b->nodes; i++)
    for (PetscInt d = -1; d <= 1; d++) {
      const PetscInt along = i / stride % cells, other = i + stride * ((along + d + cells) % cells - along);

      if (b->mass[i] > 0 && b->mass[other] > 0)
        map[other * b->nodes + i] += traits.stencil[d + 1] * sqrt(b->mass[i] / b->mass[other]);
    }
}

static PetscErrorCode MapOf(void *context, const MpmNodalMap *map, double complex matrix[])
{
  const Boxed *b = context;

  PetscFunctionBegin;
  if (map->product)
    AddProduct(b, &map->to_nodes, &map->to_particles, matrix);
  else
    AddStencil(b, &map->to_nodes, matrix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the operator of the particles where they are. */
static PetscErrorCode Assemble(Boxed *b)
{
  PetscFunctionBegin;
  PetscCall(Masses(b));
  PetscCall(MpmNodalRun(b->search->plan, b->nodes, MapOf, b, b->coefficient));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode BoxedCreate(Search *search, PetscInt i, Boxed *b)
{
  const MpmNodalPlan *plan = search->plan;

  PetscFunctionBegin;
  *b = (Boxed){.search = search, .evaluations = &search->evaluations};
  PetscCall(BoxOf(search, i, &b->layout));
  b->nodes = (PetscInt)MpmLayoutNodes(&b->layout);
  b->n     = plan->nimages * b->nodes;
  PetscCall(PetscCalloc1(b->nodes, &b->mass));
  PetscCall(PetscMalloc4(b->n * b->n, &b->matrix, b->n, &b->re, b->n, &b->im, plan->degree + 1, &b->coefficient));
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscMalloc1(b->n * b->n, &b->coefficient[j]));
  PetscCall(Assemble(b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode BoxedDestroy(Boxed *b)
{
  PetscFunctionBegin;
  for (PetscInt j = 0; j <= b->search->plan->degree; j++) PetscCall(PetscFree(b->coefficient[j]));
  PetscCall(PetscFree4(b->matrix, b->re, b->im, b->coefficient));
  PetscCall(PetscFree(b->mass));
  PetscCall(MpmGivenDestroy(&b->layout.given));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* NaN where LAPACK did not converge. */
static PetscErrorCode Growth(void *context, PetscReal courant, PetscReal *growth)
{
  Boxed              *b    = (Boxed *)context;
  const MpmNodalPlan *plan = b->search->plan;
  int                 failed;

  PetscFunctionBegin;
  ++*b->evaluations;
  for (PetscInt i = 0; i < b->n * b->n; i++) {
    PetscReal sum = 0;

    for (PetscInt j = plan->degree; j >= 0; j--) sum = sum * pow(courant, plan->stride) + creal(b->coefficient[j][i]);
    b->matrix[i] = sum;
  }
  PetscCall(MpmDenseEigen(b->n, b->matrix, b->re, b->im, NULL, &failed));
  *growth = failed ? NAN : 0;
  if (failed) b->failed = PETSC_TRUE;
  for (PetscInt i = 0; i < b->n && !failed; i++) *growth = PetscMax(*growth, hypot(b->re[i], b->im[i]));
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
  s->asked->windows = critical.windows;
  s->asked->fades   = critical.threshold ? PETSC_FALSE : PETSC_TRUE;
  s->asked->courant = isinf(critical.unstable_at) ? INFINITY : critical.threshold ? critical.stable_at : 0;
  if (isinf(critical.unstable_at)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(GrowthOfAll(s, critical.unstable_at));
  for (PetscInt i = s->asked->n - 1; i >= 0; i--)
    if (!(s->growth[i] <= 1 + s->of->tolerance)) s->asked->worst = s->asked->seed + i;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the limit of each layout, where growth has real eigenvalues below -1 alone ---- */

/* The limit of an operator C_0 + x C_1, x = k^stride. NaN where LAPACK failed. */
static PetscErrorCode LinearLimit(Boxed *b, PetscReal *limit)
{
  const PetscInt n = b->n;
  PetscReal     *at_rest, x;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n * n, &at_rest));
  for (PetscInt i = 0; i < n * n; i++) {
    at_rest[i]   = creal(b->coefficient[0][i]);
    b->matrix[i] = creal(b->coefficient[1][i]);
  }
  ++*b->evaluations;
  PetscCall(MpmPencilLeast(n, at_rest, b->matrix, &x));
  PetscCall(PetscFree(at_rest));
  *limit = pow(x, 1.0 / b->search->plan->stride);
  if (*limit > MPM_CRITICAL_TO) *limit = INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same by growth, where it is below a Courant number; else infinite. */
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
  PetscCall(b->search->plan->degree == 1 ? LinearLimit(b, limit)
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
    PetscCall(Assemble(b));
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
  PetscCall(BoxedCreate(s, (PetscInt)(s->asked->worst - s->asked->seed), &b));
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
  MpmRandomLayouts *asked = s->asked;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(s->growth, asked->n));
  PetscCall(MpmFarm("layout", asked->n, LimitOf, s));
  PetscCall(MpmFarmSumReals(asked->n, s->growth));
  asked->courant = INFINITY;
  for (PetscInt i = 0; i < asked->n; i++) {
    if (isnan(s->growth[i])) {
      asked->courant = NAN;
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    if (!(s->growth[i] < asked->courant)) continue;
    asked->courant = s->growth[i];
    asked->worst   = asked->seed + i;
  }
  if (asked->write && *asked->write && isfinite(asked->courant)) PetscCall(Write(s));
  PetscCall(PetscSortReal(asked->n, s->growth));
  for (PetscInt q = 0; q < MPM_QUANTILES && asked->scatter; q++)
    asked->quantile[q] = s->growth[MpmRankOfQuantile(q, asked->n) - 1];
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
  MpmRandomLayouts *asked = s->asked;

  PetscFunctionBegin;
  PetscCall(GrowthOfAll(s, s->of->step.courant));
  for (PetscInt i = 0; i < asked->n; i++) {
    if (isnan(s->growth[i])) asked->undecided++;
    if (s->growth[i] > 1 + s->of->tolerance) asked->unstable++;
    if (s->growth[i] <= asked->growth) continue;
    asked->growth = s->growth[i];
    asked->worst  = asked->seed + i;
  }
  if (asked->undecided) asked->growth = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRandomLayoutsFind(const MpmCriticalCase *of, MpmRandomLayouts *asked)
{
  static const PetscInt box[MPM_MAX_DIM] = {24, 6, 3};
  Search                s                = {.of = of, .asked = asked};
  MpmNodalPlan         *plan;

  PetscFunctionBegin;
  PetscCall(MpmNodalPlanCreate(of->scheme->table, NULL, &plan));
  s.plan          = plan;
  asked->growth   = 0;
  asked->box      = asked->cells ? asked->cells : box[of->layout->dim - 1];
  asked->courant  = NAN;
  asked->worst    = asked->seed;
  asked->unstable = asked->undecided = 0;
  for (PetscInt q = 0; q < MPM_QUANTILES; q++) asked->quantile[q] = NAN;
  PetscCall(PetscMalloc1(asked->n, &s.growth));
  PetscCall(FindGrowth(&s));
  if (asked->limits) PetscCall(FindLimit(&s));
  PetscCall(MpmFarmSumInts(1, &s.evaluations));
  asked->evaluations = s.evaluations;
  PetscCall(PetscFree(s.growth));
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}
