/* Compiles a pass for clouds: sorts the node fields into bundles, and the maps by bundle, product and lane. */
#include "march/clouds.h"

/* A node field that is summed or read, and a bit for each number of a kind of weights that some map of it has. */
typedef struct {
  PetscInt  node;
  PetscBool sums;
  unsigned  kinds;
} Field;

/*
   A term of a scratch field: a times a state field, or times the number in lane of the vector from of a cloud's memory.
*/
typedef struct {
  PetscInt  field, particle, from, lane;
  PetscReal a;
} Term;

/* What scratch fields are made of, where a pass takes them from nodes and gives them to nodes. */
typedef struct {
  PetscInt n, nstate;
  Term     term[2 * MPM_MAX_PASS_OPS];
} Scratch;

/* The bundle of a node field that is summed or read, and its lane there. */
static PetscInt Find(const MpmCloudPlan *plan, PetscInt node, PetscBool sums, PetscInt *lane)
{
  PetscInt b = 0;

  for (; b < plan->nbundles; b++) {
    const MpmCloudBundle *bundle = &plan->bundle[b];

    if (bundle->sums != sums) continue;
    for (*lane = 0; *lane < bundle->n; ++*lane)
      if (bundle->node[*lane] == node) return b;
  }
  return b;
}

/* The number of a kind among those of a part, where phi_ip is 0. */
static PetscInt KindOf(MpmCloudPart *part, PetscInt number)
{
  if (number == 0) return 0;
  for (PetscInt k = 0; k < part->nkinds; k++)
    if (part->kind[k] == number) return k + 1;
  part->kind[part->nkinds++] = number;
  return part->nkinds;
}

static PetscBool Precedes(const MpmCloudMap *a, const MpmCloudMap *b)
{
  return a->product < b->product || (a->product == b->product && a->lane < b->lane) ? PETSC_TRUE : PETSC_FALSE;
}

/* Adds a map to the part of its bundle, behind those that do not come after it. */
static void Insert(MpmCloudPlan *plan, MpmCloudPart *part, MpmCloudMap map)
{
  PetscInt i = part->end++;

  for (; i > part->begin && Precedes(&map, &plan->map[i - 1]); i--) plan->map[i] = plan->map[i - 1];
  plan->map[i] = map;
  plan->nmaps++;
}

/* The numbers of the kinds of a map's weights along the directions. Returns along how many of them it acts. */
static PetscInt KindsOf(const MpmRowPlan *rows, const MpmRowLine *l, const MpmRowMap *m, PetscInt kind[])
{
  kind[0] = m->weights;
  kind[1] = rows->across[l->across].y;
  kind[2] = rows->across[l->across].z;
  return (kind[0] > 0) + (kind[1] > 0) + (kind[2] > 0);
}

/* Finds the node fields of a plan, and the kinds of each. Those with most kinds come first, and equal ones together. */
static PetscInt FieldsOf(const MpmRowPlan *rows, Field field[])
{
  PetscInt n = 0;

  for (const MpmRowStep *step = rows->step; step < rows->step + rows->nsteps; step++)
    for (const MpmRowLine *l = rows->line + step->begin; l < rows->line + step->end; l++) {
      const PetscBool sums = step->spreads;
      PetscInt        f    = 0;

      while (f < n && (field[f].node != l->node || field[f].sums != sums)) f++;
      if (f == n) field[n++] = (Field){.node = l->node, .sums = sums};
      for (const MpmRowMap *m = rows->map + l->begin; m < rows->map + l->end; m++) {
        PetscInt kind[MPM_MAX_DIM];

        if (KindsOf(rows, l, m, kind) < 2) field[f].kinds |= (1U << (kind[0] + kind[1] + kind[2])) & ~1U;
      }
    }
  for (PetscInt f = 1; f < n; f++) {
    const Field moved = field[f];
    PetscInt    i     = f;

    for (; i > 0 && field[i - 1].kinds < moved.kinds; i--) field[i] = field[i - 1];
    field[i] = moved;
  }
  return n;
}

/*
   Sorts the node fields that are summed, or those that are read, into bundles. A map of a bundle works on all kinds of
   its fields. So fields of the same kinds come together, and with others only if all of them fit.
*/
static void FillBundles(const Field field[], PetscInt nfields, PetscBool sums, MpmCloudPlan *plan)
{
  const PetscInt  most   = MpmBundleWidth(MPM_BUNDLE);
  MpmCloudBundle *bundle = NULL;
  unsigned        kinds  = 0; /* of the field before */

  for (PetscInt f = 0; f < nfields; f++) {
    PetscInt alike = 0;

    if (field[f].sums != sums) continue;
    for (PetscInt i = f; i < nfields; i++) alike += field[i].sums == sums && field[i].kinds == field[f].kinds;
    if (!bundle || bundle->n == most || (field[f].kinds != kinds && bundle->n + alike > most)) {
      bundle  = &plan->bundle[plan->nbundles++];
      *bundle = (MpmCloudBundle){.sums = sums};
    }
    bundle->node[bundle->n++] = field[f].node;
    kinds                     = field[f].kinds;
  }
}

/* Adds to what a lane of a spread gets of what the particles have taken. */
static void GiveTaken(MpmCloudPlan *plan, MpmCloudPart *part, const MpmCloudMap *map, const Term *t)
{
  const MpmCloudTerm key = {
      .product = map->product, .side = map->lane / MPM_SIDE, .from = t->from, .swap = (map->lane ^ t->lane) % MPM_SIDE};
  PetscInt i = part->first_term, at;

  for (; i < part->end_term; i++) {
    const MpmCloudTerm *one = &plan->term[i];

    if (one->product == key.product && one->side == key.side && one->from == key.from && one->swap == key.swap) break;
  }
  if (i == part->end_term) {
    for (at = i; at > part->first_term; at--) {
      const MpmCloudTerm *before = &plan->term[at - 1];

      if (before->product < key.product || (before->product == key.product && before->side <= key.side)) break;
      plan->term[at] = *before;
    }
    plan->term[i = at] = key;
    part->end_term     = ++plan->nterms;
  }
  plan->term[i].a[map->lane % MPM_SIDE] += map->a * t->a;
}

/* Adds a map of a composed plan: from nodes as a term of a scratch field, and to nodes each term of the field. */
static void Compose(MpmCloudPlan *plan, MpmCloudPart *part, const MpmCloudMap *map, Scratch *scratch)
{
  const MpmCloudBundle *bundle = &plan->bundle[part->bundle];

  if (!bundle->sums)
    scratch->term[scratch->n++] =
        (Term){.field = map->particle,
               .from  = part->products + bundle->width * MPM_CLOUD * map->product + MPM_SIDE * (map->lane / MPM_SIDE),
               .lane  = map->lane % MPM_SIDE,
               .a     = map->a};
  for (const Term *t = scratch->term; t < scratch->term + scratch->n && bundle->sums; t++) {
    MpmCloudMap of = *map;

    if (t->field != map->particle) continue;
    of.particle = t->particle;
    of.a *= t->a;
    if (t->from != MPM_NONE)
      GiveTaken(plan, part, map, t);
    else
      Insert(plan, part, of);
  }
}

/* Adds a map along at most one axis to a part, if its kind is of the part's share. */
static void AddMap(MpmCloudPlan *plan, MpmCloudPart *part, const PetscInt number[], PetscInt share, PetscInt dim,
                   PetscInt lane, const MpmRowMap *m, Scratch *scratch)
{
  const PetscInt axis = number[2] ? 2 : number[1] ? 1 : 0;
  MpmCloudMap    map  = {.lane = lane, .particle = m->particle, .a = m->a, .weight = m->weight};
  PetscInt       kind;

  if (PetscMax(number[axis] - 1, 0) / MPM_BUNDLE_KINDS != share) return;
  kind        = KindOf(part, number[axis]);
  map.product = kind ? MPM_PRODUCTS(dim, kind - 1) + axis : 0;
  if (plan->composed && m->particle >= scratch->nstate)
    Compose(plan, part, &map, scratch);
  else
    Insert(plan, part, map);
}

/*
   Makes a part of a step, of one bundle and the share of the kinds that one map can have. Every kind has products of
   its own, in all directions.
*/
static void AddPart(const MpmRowPlan *rows, const MpmRowStep *step, PetscInt bundle, PetscInt share,
                    const MpmBasis *basis, PetscInt dim, Scratch *scratch, MpmCloudPlan *plan)
{
  const PetscBool spreads = step->spreads;
  const PetscInt  terms = scratch->n, width = plan->bundle[bundle].width;
  MpmCloudPart   *part = &plan->part[plan->nparts];

  *part = (MpmCloudPart){.bundle      = bundle,
                         .begin       = plan->nmaps,
                         .end         = plan->nmaps,
                         .first_cross = plan->ncrosses,
                         .first_term  = plan->nterms,
                         .end_term    = plan->nterms,
                         .products    = plan->products};
  for (const MpmRowLine *l = rows->line + step->begin; l < rows->line + step->end; l++) {
    PetscInt lane = 0;

    if (Find(plan, l->node, spreads, &lane) != bundle) continue;
    for (const MpmRowMap *m = rows->map + l->begin; m < rows->map + l->end; m++) {
      MpmCloudCross cross = {.lane = lane, .particle = m->particle, .a = m->a, .weight = m->weight};

      if (KindsOf(rows, l, m, cross.kind) < 2)
        AddMap(plan, part, cross.kind, share, dim, lane, m, scratch);
      else if (share == 0)
        plan->cross[plan->ncrosses++] = cross;
    }
  }
  part->end_cross = plan->ncrosses;
  if (part->end > part->begin || part->end_term > part->first_term || scratch->n > terms) {
    part->run = MpmBundleMapFind(plan->bundle[bundle].sums, dim, basis->nodes, part->nkinds, width);
    plan->products += width * MPM_CLOUD * MPM_PRODUCTS(dim, part->nkinds);
  }
  if (part->run || part->end_cross > part->first_cross) plan->nparts++;
}

/*
   Whether a pass changes scratch fields alone, by maps that compose with those to nodes: along one axis, and without
   weights of particles. Then each sum over nodes is of state fields and of what is taken from nodes.
*/
static PetscBool Composes(const MpmRowPlan *rows, PetscInt nstate)
{
  PetscInt terms[MPM_MAX_FIELDS] = {0}, all = 0, maps = 0, kind[MPM_MAX_DIM];

  for (const MpmRowStep *step = rows->step; step < rows->step + rows->nsteps; step++) {
    const PetscBool spreads = step->spreads;

    if (step->begin == step->end) {
      const MpmOp   *op   = &step->op;
      const PetscInt more = op->kind == MPM_SCALE ? 0 : op->src < nstate ? 1 : terms[op->src];

      if ((op->kind != MPM_SCALE && op->kind != MPM_ADD) || op->dst < nstate) return PETSC_FALSE;
      terms[op->dst] += more;
      all += more;
    }
    for (const MpmRowLine *l = rows->line + step->begin; l < rows->line + step->end; l++)
      for (const MpmRowMap *m = rows->map + l->begin; m < rows->map + l->end; m++) {
        const PetscBool scratch = m->particle >= nstate ? PETSC_TRUE : PETSC_FALSE;

        if (scratch ? m->weight || KindsOf(rows, l, m, kind) > 1 : !spreads) return PETSC_FALSE;
        if (spreads)
          maps += scratch ? terms[m->particle] : 1;
        else
          all++, terms[m->particle]++;
      }
  }
  return all > 0 && all <= 2 * MPM_MAX_PASS_OPS && maps <= 2 * MPM_MAX_PASS_OPS ? PETSC_TRUE : PETSC_FALSE;
}

/* Scales a scratch field of a composed plan, or adds a multiple of a field to it. */
static void ComposeStep(const MpmOp *op, Scratch *scratch)
{
  const PetscInt n = scratch->n;

  for (PetscInt t = 0; t < n; t++) {
    Term term = scratch->term[t];

    if (op->kind == MPM_SCALE && term.field == op->dst) {
      scratch->term[t].a *= op->factor;
      if (op->factor == 0) scratch->term[t].field = MPM_NONE;
    }
    if (op->kind != MPM_ADD || term.field != op->src) continue;
    term.field = op->dst;
    term.a *= op->factor;
    scratch->term[scratch->n++] = term;
  }
  if (op->kind == MPM_ADD && op->src < scratch->nstate)
    scratch->term[scratch->n++] = (Term){.field = op->dst, .particle = op->src, .from = MPM_NONE, .a = op->factor};
}

void MpmCloudPlanCompile(const MpmRowPlan *rows, const MpmBasis *basis, PetscInt dim, PetscInt nstate,
                         MpmCloudPlan *plan)
{
  Field          field[2 * (MPM_MAX_FIELDS + 1)];
  const PetscInt nfields = FieldsOf(rows, field);
  PetscInt       most    = 0; /* fields in a bundle */
  Scratch        scratch;

  scratch.n      = 0;
  scratch.nstate = nstate;
  *plan          = (MpmCloudPlan){.composed = Composes(rows, nstate)};
  FillBundles(field, nfields, PETSC_FALSE, plan);
  FillBundles(field, nfields, PETSC_TRUE, plan);
  for (PetscInt b = 0; b < plan->nbundles; b++) most = PetscMax(most, plan->bundle[b].n);
  for (PetscInt b = 0; b < plan->nbundles; b++) {
    plan->bundle[b].width = MpmBundleWidth(plan->composed ? most : plan->bundle[b].n);
    plan->bundle[b].begin = plan->width;
    plan->width += plan->bundle[b].width;
  }
  for (PetscInt s = 0; s < rows->nsteps; s++) {
    const MpmRowStep *step = &rows->step[s];

    plan->first[s] = plan->nparts;
    if (plan->composed && step->begin == step->end) ComposeStep(&step->op, &scratch);
    for (PetscInt b = 0; b < plan->nbundles && step->begin < step->end; b++)
      for (PetscInt share = 0; share <= rows->nkinds / MPM_BUNDLE_KINDS; share++)
        AddPart(rows, step, b, share, basis, dim, &scratch, plan);
  }
  plan->first[rows->nsteps] = plan->nparts;
}
