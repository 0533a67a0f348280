/*
   Compiles a pass for rows. Maps that follow one another in the same direction, to nodes or to particles, become one
   step. Within it they are sorted by line and weights. The order of such maps matters to rounding alone.
*/
#include "march/finite.h"
#include "march/rows.h"
#include "scheme/lines.h"

/* What the maps of a step are sorted by, the most important first: the line, which is across x, and the kind of weights along x. */
typedef struct {
  PetscInt         node;
  MpmOpKind        z, y, along;
  PetscReal        a;
  const MpmPassOp *op;
} Entry;

typedef struct {
  const MpmBasis *basis;
  MpmRowPlan     *plan;
  PetscInt        n, nsamples;
  PetscBool       to_nodes;
  Entry           entry[2 * MPM_MAX_PASS_OPS];
  PetscInt        sample[MPM_MAX_PASS_OPS];
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

static void AddStep(MpmRowPlan *plan, MpmRowStep step)
{
  plan->step[plan->nsteps++] = step;
}

/* The number of a kind of weights in a plan. */
static PetscInt KindOf(MpmRowPlan *plan, MpmOpKind kind)
{
  for (PetscInt k = 0; k < plan->nkinds; k++)
    if (plan->kind[k] == kind) return k;
  plan->kind[plan->nkinds] = kind;
  return plan->nkinds++;
}

static MpmRowMap MapOf(MpmRowPlan *plan, const Entry *entry)
{
  const PetscBool masses = entry->node == MPM_MASSES ? PETSC_TRUE : PETSC_FALSE;

  return (MpmRowMap){.weights  = KindOf(plan, entry->along),
                     .a        = masses ? 1 : entry->a,
                     .particle = masses ? MPM_NONE : entry->op->particle,
                     .weight   = entry->op->weight};
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

/* Makes a step of the maps of a group, and then of its samples. */
static void Close(Group *g)
{
  MpmRowPlan    *plan  = g->plan;
  const PetscInt begin = plan->nlines;

  for (PetscInt i = 0; i < g->n; i++) {
    const Entry *e    = &g->entry[i];
    PetscInt     last = plan->nmaps;

    if (i == 0 || !SameLine(e, &g->entry[i - 1]))
      plan->line[plan->nlines++] = (MpmRowLine){.node = e->node, .across = AcrossOf(plan, e), .begin = plan->nmaps};
    plan->map[plan->nmaps++]         = MapOf(plan, e);
    plan->line[plan->nlines - 1].end = plan->nmaps;
    while (last > plan->line[plan->nlines - 1].begin &&
           plan->map[last - 1].weights == plan->map[plan->nmaps - 1].weights)
      plan->map[--last].shared++;
  }
  if (g->n)
    AddStep(plan,
            (MpmRowStep){.kind = g->to_nodes ? MPM_ROW_SPREAD : MPM_ROW_GATHER, .begin = begin, .end = plan->nlines});
  for (PetscInt s = 0; s < g->nsamples; s++)
    AddStep(plan, (MpmRowStep){.kind = MPM_ROW_SAMPLE, .particle = g->sample[s]});
  g->n = g->nsamples = 0;
}

/* Where the moment is the same at all places, the weights of P2G_AFFINE are those of DIV_MLS times the moment. */
static void AddMap(Group *g, const MpmPassOp *op)
{
  const PetscReal moment = op->map == MPM_P2G_AFFINE ? g->basis->moment : 0;
  const MpmOpKind map    = moment > 0 ? MPM_DIV_MLS : op->map;
  Entry           entry  = {.node  = op->node,
                            .z     = MpmLineKind(g->basis, MpmKindAlong(map, op->axis, 2)),
                            .y     = MpmLineKind(g->basis, MpmKindAlong(map, op->axis, 1)),
                            .along = MpmLineKind(g->basis, MpmKindAlong(map, op->axis, 0)),
                            .a     = moment > 0 ? moment * op->a : op->a,
                            .op    = op};

  if (g->to_nodes != op->to_nodes) Close(g);
  g->to_nodes = op->to_nodes;
  Insert(g, entry);
  if (op->kind != MPM_PASS_MASS) return;
  entry.node = MPM_MASSES;
  Insert(g, entry);
}

/* Whether a group has changed, or will sample, one of n particle fields. */
static PetscBool Uses(const Group *g, PetscInt first, PetscInt n)
{
  for (PetscInt i = 0; i < g->n; i++)
    if (g->entry[i].op->particle >= first && g->entry[i].op->particle < first + n) return PETSC_TRUE;
  for (PetscInt s = 0; s < g->nsamples; s++)
    if (g->sample[s] >= first && g->sample[s] < first + n) return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Adds an operation of finite deformation. If the group uses none of its fields, it may come before the group. */
static void AddFinite(Group *g, const MpmPassOp *op, PetscInt dim)
{
  const MpmFiniteWidth width = MpmFiniteWidthOf(op->map, dim, dim * dim);

  if (op->map == MPM_ADVANCE || Uses(g, op->particle, width.to) || Uses(g, op->other, width.from)) Close(g);
  AddStep(g->plan,
          (MpmRowStep){
              .kind = MPM_ROW_FINITE, .finite = op->map, .particle = op->particle, .other = op->other, .a = op->a});
}

void MpmRowPlanCompile(const MpmPass *pass, const MpmBasis *basis, PetscInt dim, MpmRowPlan *plan)
{
  Group group = {.basis = basis, .plan = plan};

  *plan = (MpmRowPlan){.nkinds = 1, .kind = {MPM_P2G}};
  for (const MpmPassOp *op = pass->op; op < pass->op + pass->nops; op++) {
    if (op->kind == MPM_PASS_MAP || op->kind == MPM_PASS_MASS)
      AddMap(&group, op);
    else if (op->kind == MPM_PASS_SAMPLE)
      group.sample[group.nsamples++] = op->particle;
    else if (op->kind == MPM_PASS_DRIFT) {
      Close(&group);
      AddStep(plan, (MpmRowStep){.kind = MPM_ROW_DRIFT});
    } else if (op->kind == MPM_PASS_FINITE)
      AddFinite(&group, op, dim);
    else {
      const PetscBool adds = op->kind == MPM_PASS_ADD ? PETSC_TRUE : PETSC_FALSE;

      /* if the group uses neither field, the operation may come before it */
      if (Uses(&group, op->particle, 1) || (adds && Uses(&group, op->other, 1))) Close(&group);
      AddStep(plan, (MpmRowStep){.kind     = adds ? MPM_ROW_ADD : MPM_ROW_SCALE,
                                 .particle = op->particle,
                                 .other    = op->other,
                                 .a        = op->a});
    }
  }
  Close(&group);
}
