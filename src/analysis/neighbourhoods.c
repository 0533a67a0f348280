/* Asks each neighbourhood's own search, and takes the worst of what they find. */
#include "analysis/critical_parts.h"
#include "analysis/lone.h"
#include "analysis/neighbourhoods.h"
#include "base/text.h"
#include <math.h>

#define SHORT 8   /* so many times fewer moves has the search of a table */
#define FEW 4     /* layouts that it moves */
#define EVEN 4    /* cells of a large box in three dimensions: waves of two cells fit into it */
#define MANY 16   /* particles a cell of the random layouts of a table */
#define SAME 1e-6 /* relative difference of limits that come of searches, which may be a little off */

PetscBool MpmNeighbourhoodsWanted(const MpmRequest *request)
{
  for (int kind = 0; kind < MPM_NEIGHBOURHOODS; kind++)
    if (kind != MPM_IN_BULK && request->neighbourhood[kind]) return PETSC_TRUE;
  return PETSC_FALSE;
}

MpmNeighbourhood MpmNeighbourhoodOfCritical(const MpmCritical *critical)
{
  MpmNeighbourhood one = MpmNeighbourhoodOf(MPM_IN_BULK);

  one.courant = critical->courant;
  one.growth  = critical->asked.growth;
  one.verdict = critical->asked.verdict;
  one.wave    = critical->wave;
  one.windows = critical->windows;
  if (isnan(one.courant)) one.why_not = "said above";
  if (isfinite(critical->unstable_at))
    for (PetscInt a = 0; a < MPM_MAX_DIM; a++) one.beta[a] = critical->beta[a];
  one.evaluations = critical->evaluations;
  one.seconds     = critical->seconds;
  return one;
}

MpmNeighbourhood MpmNeighbourhoodOfFinding(const MpmFinding *finding)
{
  MpmNeighbourhood one = MpmNeighbourhoodOf(MPM_IN_BULK);

  one.growth  = finding->growth;
  one.verdict = finding->verdict;
  return one;
}

/* Growth within the tolerance is stable. NaN is undecided. */
static MpmVerdict VerdictOf(PetscReal growth, PetscReal tolerance)
{
  if (isnan(growth)) return MPM_UNDECIDED;
  return growth > 1 + tolerance ? MPM_UNSTABLE : MPM_STABLE;
}

/* Why the neighbourhoods of a scene have no answer: those are of a lattice whose particles are alike. */
static const char *WhyNot(const MpmScene *scene)
{
  const MpmLayout *layout = &scene->layout;

  if (layout->counts.n > 1 || layout->cluster[1] - layout->cluster[0] < 1)
    return "the search is for particles at equal distances, not for counts and cluster";
  if (layout->material.kind != MPM_MATERIAL_UNIFORM) return "the search is for one material";
  if (MpmSpaceIsPrestressed(&scene->scheme.space)) return "a particle with nothing around it holds no prestress";
  return NULL;
}

/* A scene's lattice and scheme without walls, and at rest. Its table is destroyed with MpmTableDestroy. */
static PetscErrorCode Unbound(const MpmScene *scene, MpmLayout *layout, MpmScheme *scheme, MpmStep *step)
{
  PetscFunctionBegin;
  *layout = scene->layout;
  *scheme = scene->scheme;
  *step   = scene->step;
  if (MpmBasisIsAltered(scheme->basis)) scheme->basis = MpmBasisFind(scheme->basis->name);
  for (PetscInt a = 0; a < layout->dim; a++) {
    MpmDirection *grid = &layout->grid[a];

    for (int e = 0; e < 2; e++) grid->ends[e] = scheme->space.ends[a][e] = MPM_PERIODIC;
    grid->nodes      = grid->cells;
    layout->first[a] = 0;
    layout->row[a]   = (PetscInt64)grid->cells * layout->ppc[a];
  }
  layout->particles = layout->sites;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) step->drift[a] = (MpmFraction){.den = 1};
  PetscCall(MpmTableCreate(scheme->formulation, scheme->transfer, &scheme->numbers, &scheme->space, &scheme->table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether the nodal operator of a scheme is a product of maps. A solve on the grid is none. */
static PetscBool HasOperator(const MpmCriticalCase *of, MpmNeighbourhood *one)
{
  if (!MpmTableSolves(of->scheme->table)) return PETSC_TRUE;
  one->why_not = MpmTableHas(of->scheme->table, MPM_IMPLICIT)
                     ? "the search is for steps without a linear system"
                     : "the search is for transfers without a solve on the grid";
  return PETSC_FALSE;
}

static PetscErrorCode Patch(const MpmCriticalCase *of, MpmNeighbourhood *one)
{
  PetscFunctionBegin;
  if (!HasOperator(of, one)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmPatchFind(of, one->kind, one));
  if (isnan(one->courant)) one->why_not = "the search could not tell";
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Alone(const MpmCriticalCase *of, MpmNeighbourhood *one)
{
  PetscFunctionBegin;
  PetscCall(MpmLoneFind(of->layout, of->scheme, of->step.courant, one));
  if (!one->closed) PetscCall(Patch(of, one));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AtRandom(const MpmCriticalCase *of, const MpmRequest *request, PetscBool limits,
                               MpmNeighbourhood *one)
{
  static const PetscInt  moves[MPM_MAX_DIM] = {200, 100, 30};
  const PetscBool        disordered         = one->kind == MPM_DISORDERED ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool        worst              = one->kind == MPM_AT_WORST ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool        stays              = MpmGrowthStays(of->layout, of->scheme, &of->step);
  const PetscBool        large              = of->layout->dim == 3 && disordered && stays ? PETSC_TRUE : PETSC_FALSE;
  const MpmRandomLayouts layouts            = {.n       = worst && request->table ? FEW : request->layouts,
                                               .cells   = large ? EVEN : 0,
                                               .seed    = of->layout->seed,
                                               .voids   = disordered ? 0 : request->voids,
                                               .scatter = disordered || worst ? PETSC_TRUE : PETSC_FALSE,
                                               .moves   = worst ? moves[of->layout->dim - 1] / (request->table ? SHORT : 1) : 0,
                                               .write   = worst ? request->write_layout : NULL,
                                               .limits  = limits};

  PetscFunctionBegin;
  if (!HasOperator(of, one)) PetscFunctionReturn(PETSC_SUCCESS);
  if (worst && !stays) {
    one->why_not =
        "the search needs that layouts stay unstable beyond their limits, which is not proved of this scheme";
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmRandomLayoutsFind(of, &layouts, one));
  if (limits && isnan(one->courant)) one->why_not = "LAPACK did not converge";
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Search(const MpmCriticalCase *of, const MpmRequest *request, PetscBool limits,
                             MpmNeighbourhood *one)
{
  PetscFunctionBegin;
  switch (one->kind) {
  case MPM_AT_EDGE:
  case MPM_AT_CORNER:
    PetscCall(Patch(of, one));
    break;
  case MPM_ALONE:
    PetscCall(Alone(of, one));
    break;
  default:
    PetscCall(AtRandom(of, request, limits, one));
    break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Where a theorem says that nothing grows on any layout, at any Courant number, there is nothing to search. */
static PetscErrorCode HasNoLimit(const MpmCriticalCase *of, MpmNeighbourhood *one, PetscBool *none)
{
  PetscReal quiet = 0;

  PetscFunctionBegin;
  if (MpmTableHas(of->scheme->table, MPM_IMPLICIT)) PetscCall(MpmCriticalQuiet(of, &quiet));
  *none = isinf(quiet) ? PETSC_TRUE : PETSC_FALSE;
  if (!*none) PetscFunctionReturn(PETSC_SUCCESS);
  one->courant = INFINITY;
  one->growth  = 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Find(const MpmScene *scene, const MpmRequest *request, PetscBool limits, MpmNeighbourhood *one)
{
  const PetscReal begin = MPI_Wtime();
  MpmLayout       layout;
  MpmScheme       scheme;
  MpmCriticalCase of   = {.layout = &layout, .scheme = &scheme, .tolerance = request->tolerance};
  PetscBool       none = PETSC_FALSE;

  PetscFunctionBegin;
  one->why_not = WhyNot(scene);
  if (one->why_not) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Unbound(scene, &layout, &scheme, &of.step));
  PetscCall(HasNoLimit(&of, one, &none));
  if (!none) PetscCall(Search(&of, request, limits, one));
  PetscCall(MpmTableDestroy(&scheme.table));
  one->verdict = VerdictOf(one->growth, request->tolerance);
  if (one->unstable) one->verdict = MPM_UNSTABLE;
  one->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Up to which Courant number no layout grows; 0: that is not known. */
static PetscErrorCode Bound(const MpmScene *scene, PetscReal *bound)
{
  PetscFunctionBegin;
  *bound = MpmCriticalBound(&scene->layout, &scene->scheme);
  if (*bound == 0 && !WhyNot(scene)) PetscCall(MpmCriticalLoneBound(&scene->layout, &scene->scheme, bound));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least limit. One that is undecided could be less, unless it is 0 or a bound that holds for every layout. */
static void TakeLeast(MpmNeighbourhoods *all)
{
  PetscBool open = PETSC_FALSE;

  all->least = MPM_NONE;
  for (PetscInt i = 0; i < all->n; i++) {
    if (isnan(all->of[i].courant))
      open = PETSC_TRUE;
    else if (all->least == MPM_NONE || all->of[i].courant < all->of[all->least].courant * (1 - SAME))
      all->least = i;
  }
  all->courant = all->least == MPM_NONE ? NAN : all->of[all->least].courant;
  if (open && all->courant > all->bound * (1 + SAME)) all->courant = NAN;
}

/* The largest growth, and the worst verdict. */
static PetscErrorCode TakeFastest(PetscReal tolerance, MpmNeighbourhoods *all)
{
  MpmFinding *f                             = &all->finding;
  PetscInt    of_verdict[MPM_UNDECIDED + 1] = {0};

  PetscFunctionBegin;
  all->fastest = MPM_NONE;
  *f           = (MpmFinding){.growth = NAN, .tolerance = tolerance};
  PetscCall(PetscStrncpy(f->evidence, "the worst of these neighbourhoods:", sizeof f->evidence));
  for (PetscInt i = 0; i < all->n; i++) {
    const MpmNeighbourhood *one = &all->of[i];

    of_verdict[one->verdict]++;
    if (!isnan(one->growth) && (all->fastest == MPM_NONE || one->growth > f->growth)) {
      all->fastest = i;
      f->growth    = one->growth;
    }
    MpmTextJoin(f->evidence, i ? ", " : " ", sizeof f->evidence);
    MpmTextJoin(f->evidence, MpmNeighbourhoodNames[one->kind], sizeof f->evidence);
  }
  f->verdict = of_verdict[MPM_UNSTABLE] ? MPM_UNSTABLE : of_verdict[MPM_UNDECIDED] ? MPM_UNDECIDED : MPM_STABLE;
  if (f->verdict == MPM_UNDECIDED) f->uncertainty = f->defective_error = INFINITY;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmNeighbourhoodsHaveWindows(const MpmNeighbourhoods *all)
{
  for (PetscInt i = 0; i < all->n; i++)
    if (all->of[i].windows.n) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* ---- a table of steps ---- */

/*
   Whether a row of a table is not sought, since that takes long: in three dimensions, where layouts grow in windows,
   with rk, whose growth does not begin at -1, and random layouts of many particles a cell.
*/
static PetscBool LeavesOut(const MpmScene *scene, MpmNeighbourhoodKind kind)
{
  const MpmLayout *l     = &scene->layout;
  const PetscBool  quiet = scene->scheme.formulation->quiet ? PETSC_TRUE : PETSC_FALSE;

  if (kind == MPM_IN_BULK || kind == MPM_ALONE) return PETSC_FALSE;
  if (l->dim > 2 || (l->dim == 2 && quiet)) return PETSC_TRUE;
  if (kind == MPM_AT_EDGE) return quiet;
  if (l->ppc[0] * (l->dim == 2 ? l->ppc[1] : 1) > MANY) return PETSC_TRUE;
  return kind == MPM_DISORDERED && !MpmGrowthStays(l, &scene->scheme, &scene->step) ? PETSC_TRUE : PETSC_FALSE;
}

static PetscErrorCode Row(const MpmScene *scene, const MpmRequest *request, MpmNeighbourhoodKind kind,
                          const MpmNeighbourhoods *all, MpmNeighbourhood *row)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; all && i < all->n; i++) {
    if (all->of[i].kind != kind) continue;
    *row = all->of[i];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *row = MpmNeighbourhoodOf(kind);
  if (!LeavesOut(scene, kind)) PetscCall(Find(scene, request, PETSC_TRUE, row));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Chooses the step that is recommended. */
static void Advise(MpmStepTable *t)
{
  t->least = t->never = MPM_NONE;
  for (PetscInt i = 0; i < MPM_TABLE_ROWS - 1; i++) {
    if (t->limit[i] != 0) continue;
    if (t->row[i].approached)
      t->falls = PETSC_TRUE;
    else if (t->never == MPM_NONE)
      t->never = i;
  }
  for (PetscInt i = 0; i < MPM_TABLE_ROWS; i++) {
    if (!(t->limit[i] > 0) || isinf(t->limit[i]) || (t->falls && t->row[i].kind == MPM_AT_WORST)) continue;
    if (t->least == MPM_NONE || t->limit[i] < t->limit[t->least]) t->least = i;
  }
  t->advised = t->bound > 0 ? t->bound : t->least == MPM_NONE ? INFINITY : t->limit[t->least];
  if (t->never != MPM_NONE) t->advised = NAN;
}

PetscErrorCode MpmStepTableFind(const MpmScene *scene, const MpmRequest *request, const MpmNeighbourhood *bulk,
                                const MpmNeighbourhoods *all, MpmStepTable *table)
{
  static const MpmNeighbourhoodKind kinds[MPM_TABLE_ROWS] = {MPM_IN_BULK, MPM_DISORDERED, MPM_AT_EDGE, MPM_ALONE,
                                                             MPM_AT_WORST};
  const PetscInt                    worst                 = MPM_TABLE_ROWS - 1;
  const PetscReal                   begin                 = MPI_Wtime();

  PetscFunctionBegin;
  *table = (MpmStepTable){.of = worst};
  PetscCall(Bound(scene, &table->bound));
  for (PetscInt i = 0; i < MPM_TABLE_ROWS; i++) {
    MpmNeighbourhood *row = &table->row[i];

    *row = *bulk;
    if (i) PetscCall(Row(scene, request, kinds[i], all, row));
    table->left_out[i] = isnan(row->courant) && !row->why_not && LeavesOut(scene, kinds[i]) ? PETSC_TRUE : PETSC_FALSE;
    table->limit[i]    = isnan(row->quantile[0]) ? row->courant : row->quantile[0];
  }
  for (PetscInt i = 0; i < worst; i++) /* other rows are layouts, too */
    if (table->row[i].courant < table->limit[worst]) {
      table->limit[worst] = table->row[i].courant;
      table->of           = i;
    }
  Advise(table);
  table->moving = NAN;
  if (isfinite(table->advised)) {
    const MpmCriticalCase of          = MpmCriticalCaseOf(scene, request->tolerance);
    PetscInt64            evaluations = 0;
    PetscReal             growth[2];

    PetscCall(MpmCriticalMoving(&of, table->advised, growth, &evaluations));
    table->moving = fmax(growth[0], growth[1]);
  }
  table->seconds = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNeighbourhoodsFind(const MpmScene *scene, const MpmRequest *request, const MpmNeighbourhood *bulk,
                                     PetscBool limits, MpmNeighbourhoods *all)
{
  PetscFunctionBegin;
  *all = (MpmNeighbourhoods){.n = 0};
  PetscCall(Bound(scene, &all->bound));
  for (int kind = 0; kind < MPM_NEIGHBOURHOODS; kind++) {
    MpmNeighbourhood *one = &all->of[all->n];

    if (!request->neighbourhood[kind]) continue;
    *one = kind == MPM_IN_BULK ? *bulk : MpmNeighbourhoodOf((MpmNeighbourhoodKind)kind);
    if (kind != MPM_IN_BULK) PetscCall(Find(scene, request, limits, one));
    all->n++;
  }
  TakeLeast(all);
  PetscCall(TakeFastest(request->tolerance, all));
  PetscFunctionReturn(PETSC_SUCCESS);
}
