/*
   The plan of the nodal operator: a table run on symbols. A particle register is c q plus terms, a node register a slot
   of the plan.
*/
#include "operator/nodal.h"
#include <mpmstab/errors.h>

/* A term of a particle register: factor k^power W y, y in a slot. op is W. */
typedef MpmNodalSent Term;

/* A sum over particles that is being read into a slot: images by c of their registers, and products by slot. */
typedef struct {
  PetscInt  slot, power;
  PetscReal c;
} Reading;

/*
   c, root, terms, nterms - of each particle register, up to the present operation: c times the state register root as it
                       was, and the terms. A scratch register has the root of what it is set to.
   slot              - the slot of each node register
   captured          - captured[s]: terms of particles refer to slot s as it is, so it must not change
   readings          - what the present row of sums reads, each with the image that it is so far
   room              - of the plan's lines, maps and slots
*/
typedef struct {
  const MpmTable *table;
  MpmNodalPlan   *plan;
  PetscReal       c[MPM_MAX_FIELDS];
  PetscInt        root[MPM_MAX_FIELDS], nterms[MPM_MAX_FIELDS], slot[MPM_MAX_FIELDS], first_line, nreadings;
  Term           *terms[MPM_MAX_FIELDS];
  PetscBool      *captured;
  Reading         reading[MPM_MAX_FIELDS];
  MpmNodalImage   image[MPM_MAX_FIELDS];
  PetscInt        line_room, map_room, slot_room;
} Builder;

static PetscErrorCode NewSlot(Builder *b, PetscInt *slot)
{
  PetscFunctionBegin;
  PetscCheck(b->plan->nslots < b->slot_room, PETSC_COMM_SELF, PETSC_ERR_PLIB, "too many slots");
  *slot = b->plan->nslots++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode NewMap(Builder *b, PetscInt *map)
{
  MpmNodalPlan *plan = b->plan;

  PetscFunctionBegin;
  if (plan->nmaps == b->map_room) {
    b->map_room = PetscMax(16, 2 * b->map_room);
    PetscCall(PetscRealloc(sizeof(*plan->map) * (size_t)b->map_room, &plan->map));
  }
  *map            = plan->nmaps++;
  plan->map[*map] = (MpmNodalMap){.n = 0};
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddLine(Builder *b, MpmNodalLine line)
{
  MpmNodalPlan *plan = b->plan;

  PetscFunctionBegin;
  if (plan->nlines == b->line_room) {
    b->line_room = PetscMax(64, 2 * b->line_room);
    PetscCall(PetscRealloc(sizeof(*plan->line) * (size_t)b->line_room, &plan->line));
  }
  plan->line[plan->nlines++] = line;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool SameParity(const MpmTable *t, PetscInt a, PetscInt b)
{
  for (PetscInt axis = 0; axis < t->dim; axis++)
    if (t->parity[a][axis] != t->parity[b][axis]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* ---- maps ---- */

static PetscBool SameProduct(const MpmTable *t, const MpmNodalProduct *a, const MpmNodalProduct *b)
{
  return a->to_particles == b->to_particles && a->to_nodes == b->to_nodes && a->axis_particles == b->axis_particles &&
                 a->axis_nodes == b->axis_nodes && SameParity(t, a->src, b->src) && SameParity(t, a->dst, b->dst)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

static PetscBool SameMap(const MpmTable *t, const MpmNodalMap *a, const MpmNodalMap *b)
{
  if (a->n != b->n) return PETSC_FALSE;
  if (a->n == 0)
    return a->op.kind == b->op.kind && a->op.axis == b->op.axis && a->op.side == b->op.side &&
                   SameParity(t, a->op.src, b->op.src)
               ? PETSC_TRUE
               : PETSC_FALSE;
  for (PetscInt i = 0; i < a->n; i++)
    if (a->product[i].factor != b->product[i].factor || !SameProduct(t, &a->product[i], &b->product[i]))
      return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The last map becomes an earlier one that is the same. */
static PetscErrorCode Share(Builder *b, PetscInt *map)
{
  MpmNodalPlan *plan = b->plan;
  MpmNodalMap  *last = &plan->map[plan->nmaps - 1];

  PetscFunctionBegin;
  *map = plan->nmaps - 1;
  for (PetscInt m = 0; m < plan->nmaps - 1; m++) {
    if (!SameMap(b->table, &plan->map[m], last)) continue;
    PetscCall(PetscFree(last->product));
    plan->nmaps--;
    *map = m;
    break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* slot dst += factor k^power (product of slot src). Products of the present row of sums share a line where they can. */
static PetscErrorCode AddProduct(Builder *b, PetscInt dst, PetscInt src, PetscInt power, MpmNodalProduct product)
{
  MpmNodalPlan *plan = b->plan;
  MpmNodalMap  *m;
  PetscInt      map = MPM_NONE;

  PetscFunctionBegin;
  for (PetscInt l = b->first_line; l < plan->nlines && map == MPM_NONE; l++) {
    const MpmNodalLine *line = &plan->line[l];

    if (line->dst == dst && line->src == src && line->power == power && line->map != MPM_NONE) map = line->map;
  }
  if (map == MPM_NONE) {
    PetscCall(NewMap(b, &map));
    PetscCall(AddLine(b, (MpmNodalLine){.dst = dst, .src = src, .map = map, .power = power, .factor = 1}));
  }
  m = &plan->map[map];
  for (PetscInt i = 0; i < m->n; i++) {
    if (!SameProduct(b->table, &m->product[i], &product)) continue;
    m->product[i].factor += product.factor;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (m->n == m->room) {
    m->room = PetscMax(4, 2 * m->room);
    PetscCall(PetscRealloc(sizeof(*m->product) * (size_t)m->room, &m->product));
  }
  m->product[m->n++] = product;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the terms of a particle register give to the nodes through a map: products, added to a slot. */
static PetscErrorCode AddTerms(Builder *b, PetscInt slot, PetscInt particle, const MpmNodalTerm *to, PetscInt power)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < b->nterms[particle]; i++) {
    const Term     *term    = &b->terms[particle][i];
    MpmNodalProduct product = {.to_particles   = term->op.kind,
                               .axis_particles = term->op.axis,
                               .src            = term->op.src,
                               .to_nodes       = to->kind,
                               .axis_nodes     = to->axis,
                               .dst            = to->dst,
                               .factor         = to->factor * term->op.factor};

    PetscCall(AddProduct(b, slot, term->slot, power + term->op.coefficient, product));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The maps of the present row of sums are complete. Each is divided by its first factor, which the line keeps, and
   shared. A map may not be taken away while a later one stays, so the last ones are looked at first.
*/
static PetscErrorCode EndMaps(Builder *b)
{
  MpmNodalPlan *plan  = b->plan;
  PetscInt      first = plan->nmaps, n;
  MpmNodalMap  *fresh;

  PetscFunctionBegin;
  for (PetscInt l = b->first_line; l < plan->nlines; l++)
    if (plan->line[l].map != MPM_NONE) first = PetscMin(first, plan->line[l].map);
  n = plan->nmaps - first;
  PetscCall(PetscMalloc1(n, &fresh));
  PetscCall(PetscArraycpy(fresh, plan->map + first, n));
  plan->nmaps = first;
  for (PetscInt l = b->first_line; l < plan->nlines; l++) {
    MpmNodalLine *line = &plan->line[l];
    MpmNodalMap  *m;
    PetscInt      map;

    if (line->map == MPM_NONE) continue;
    m            = &fresh[line->map - first];
    line->factor = m->product[0].factor != 0 ? m->product[0].factor : 1;
    for (PetscInt i = 0; i < m->n; i++) m->product[i].factor /= line->factor;
    PetscCall(NewMap(b, &map));
    plan->map[map] = *m;
    PetscCall(Share(b, &line->map));
  }
  PetscCall(PetscFree(fresh));
  b->first_line = plan->nlines;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- images ---- */

/* Adds a term to what is read into a slot. The registers of an image have one c at the end of the step. */
static PetscErrorCode Read(Builder *b, PetscInt slot, PetscInt power, const MpmNodalTerm *term)
{
  const PetscReal c = b->plan->kept[term->src];
  PetscInt        r = 0;

  PetscFunctionBegin;
  while (r < b->nreadings && !(b->reading[r].slot == slot && b->reading[r].power == power && b->reading[r].c == c)) r++;
  if (r == b->nreadings) {
    PetscCheck(r < MPM_MAX_FIELDS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_FIELDS");
    b->reading[b->nreadings++] = (Reading){.slot = slot, .power = power, .c = c};
    b->image[r]                = (MpmNodalImage){.c = c};
  }
  PetscCheck(b->image[r].n < MPM_MAX_FIELDS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_FIELDS");
  b->image[r].term[b->image[r].n++] = *term;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool SameImage(const MpmTable *t, const MpmNodalImage *a, const MpmNodalImage *b)
{
  if (a->n != b->n) return PETSC_FALSE;
  for (PetscInt i = 0; i < a->n; i++) {
    const MpmNodalTerm *x = &a->term[i], *y = &b->term[i];

    if (x->kind != y->kind || x->axis != y->axis || x->src != y->src || x->factor != y->factor ||
        !SameParity(t, x->dst, y->dst))
      return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/* The number of an image, which is new if none of the plan is the same. */
static PetscErrorCode ImageOf(Builder *b, const MpmNodalImage *image, PetscInt *g)
{
  MpmNodalPlan *plan = b->plan;

  PetscFunctionBegin;
  for (*g = 0; *g < plan->nimages; (*g)++)
    if (SameImage(b->table, &plan->image[*g], image)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(plan->nimages < MPM_MAX_IMAGES, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: its nodal operator has more than %d images", MPM_MAX_IMAGES);
  plan->image[plan->nimages++] = *image;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A row of sums over particles has ended: its images are complete. Multiples of an image are the same image. */
static PetscErrorCode EndSums(Builder *b)
{
  PetscFunctionBegin;
  if (b->first_line < b->plan->nlines) PetscCall(EndMaps(b));
  for (PetscInt r = 0; r < b->nreadings; r++) {
    MpmNodalImage  *image = &b->image[r];
    const PetscReal first = image->term[0].factor;
    PetscInt        g;

    for (PetscInt i = 0; i < image->n; i++) image->term[i].factor /= first;
    PetscCall(ImageOf(b, image, &g));
    PetscCall(AddLine(
        b, (MpmNodalLine){
               .dst = b->reading[r].slot, .src = g, .map = MPM_NONE, .power = b->reading[r].power, .factor = first}));
  }
  b->nreadings  = 0;
  b->first_line = b->plan->nlines;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- operations ---- */

static PetscErrorCode ToNodes(Builder *b, const MpmOp *op)
{
  MpmNodalTerm term = {
      .kind = op->kind, .axis = op->axis, .src = b->root[op->src], .dst = op->dst, .factor = op->factor};

  PetscFunctionBegin;
  if (!op->accumulates) PetscCall(NewSlot(b, &b->slot[op->dst]));
  PetscCall(AddTerms(b, b->slot[op->dst], op->src, &term, op->coefficient));
  term.factor *= b->c[op->src];
  if (term.factor != 0) PetscCall(Read(b, b->slot[op->dst], op->coefficient, &term));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddTerm(Builder *b, PetscInt particle, Term term)
{
  PetscInt *n = &b->nterms[particle];

  PetscFunctionBegin;
  PetscCall(PetscRealloc(sizeof(Term) * (size_t)(*n + 1), &b->terms[particle]));
  b->terms[particle][(*n)++] = term;
  b->captured[term.slot]     = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A scratch register takes a multiple of another register: of its root, and of its terms. */
static PetscErrorCode AddRegister(Builder *b, const MpmOp *op)
{
  PetscFunctionBegin;
  b->c[op->dst] += op->factor * b->c[op->src];
  b->root[op->dst] = b->root[op->src];
  for (PetscInt i = 0; i < b->nterms[op->src]; i++) {
    Term term = b->terms[op->src][i];

    term.op.factor *= op->factor;
    term.op.dst = op->dst;
    PetscCall(AddTerm(b, op->dst, term));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Scale(Builder *b, const MpmOp *op)
{
  PetscFunctionBegin;
  PetscCheck(op->coefficient == 0 || op->factor == 0, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "the table: particles' values times the Courant number");
  b->c[op->dst] *= op->factor;
  if (op->factor == 0) b->nterms[op->dst] = 0;
  for (PetscInt i = 0; i < b->nterms[op->dst]; i++) b->terms[op->dst][i].op.factor *= op->factor;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The register moves to a new slot, with its values where keep. */
static PetscErrorCode Renew(Builder *b, PetscInt reg, PetscBool keep)
{
  const PetscInt old = b->slot[reg];

  PetscFunctionBegin;
  PetscCall(NewSlot(b, &b->slot[reg]));
  if (keep) PetscCall(AddLine(b, (MpmNodalLine){.dst = b->slot[reg], .src = old, .map = MPM_NONE, .factor = 1}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* An operation between nodes. At a wall the old value is taken off before the new one is put in its place. */
static PetscErrorCode BetweenNodes(Builder *b, const MpmOp *op)
{
  const PetscInt  src = b->slot[op->src], old = b->slot[op->dst];
  const PetscBool wall = op->kind == MPM_WALL ? PETSC_TRUE : PETSC_FALSE;
  PetscInt        map  = MPM_NONE;

  PetscFunctionBegin;
  if (op->kind != MPM_COPY) {
    PetscCall(NewMap(b, &map));
    b->plan->map[map].op = *op;
    PetscCall(Share(b, &map));
  }
  if (wall || !op->accumulates || b->captured[old])
    PetscCall(Renew(b, op->dst, wall || op->accumulates ? PETSC_TRUE : PETSC_FALSE));
  if (wall) PetscCall(AddLine(b, (MpmNodalLine){.dst = b->slot[op->dst], .src = old, .map = map, .factor = -1}));
  if (op->factor != 0)
    PetscCall(AddLine(
        b, (MpmNodalLine){
               .dst = b->slot[op->dst], .src = src, .map = map, .power = op->coefficient, .factor = op->factor}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Apply(Builder *b, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  PetscFunctionBegin;
  if (traits.dst == MPM_NOWHERE) PetscFunctionReturn(PETSC_SUCCESS);
  if (traits.dst == MPM_ON_NODES && traits.src == MPM_ON_PARTICLES) {
    PetscCall(ToNodes(b, op));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(EndSums(b));
  if (traits.dst == MPM_ON_NODES)
    PetscCall(BetweenNodes(b, op));
  else if (traits.src == MPM_ON_NODES)
    PetscCall(AddTerm(b, op->dst, (Term){.op = *op, .slot = b->slot[op->src]}));
  else if (op->kind == MPM_ADD)
    PetscCall(AddRegister(b, op));
  else
    PetscCall(Scale(b, op));
  b->first_line = b->plan->nlines;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the registers of the state have been sent. */
static PetscErrorCode Sent(const Builder *b)
{
  MpmNodalPlan *plan = b->plan;

  PetscFunctionBegin;
  plan->nlines_sent = plan->nlines;
  for (PetscInt r = 0; r < plan->nstate; r++) plan->nsent += b->nterms[r];
  PetscCall(PetscMalloc1(plan->nsent, &plan->sent));
  plan->nsent = 0;
  for (PetscInt r = 0; r < plan->nstate; r++)
    for (PetscInt i = 0; i < b->nterms[r]; i++) plan->sent[plan->nsent++] = b->terms[r][i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* z' = c z + sum of (P W) y. Its lines need slots of their own. */
static PetscErrorCode Next(Builder *b)
{
  MpmNodalPlan *plan = b->plan;

  PetscFunctionBegin;
  for (PetscInt g = 0; g < plan->nimages; g++) {
    const MpmNodalImage *image = &plan->image[g];

    PetscCall(NewSlot(b, &plan->next[g]));
    for (PetscInt i = 0; i < image->n; i++)
      PetscCall(AddTerms(b, plan->next[g], image->term[i].src, &image->term[i], 0));
    if (b->first_line < plan->nlines) PetscCall(EndMaps(b));
    if (image->c != 0)
      PetscCall(AddLine(b, (MpmNodalLine){.dst = plan->next[g], .src = g, .map = MPM_NONE, .factor = image->c}));
    b->first_line = plan->nlines;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- powers of the Courant number ---- */

static PetscErrorCode Powers(MpmNodalPlan *plan)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1(plan->nslots * plan->nimages, &plan->powers));
  for (PetscInt g = 0; g < plan->nimages; g++) plan->powers[g * plan->nimages + g] = 1;
  for (PetscInt l = 0; l < plan->nlines; l++) {
    const MpmNodalLine *line = &plan->line[l];

    for (PetscInt g = 0; g < plan->nimages; g++)
      plan->powers[line->dst * plan->nimages + g] |= plan->powers[line->src * plan->nimages + g] << line->power;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The degree in k^stride with the weights set, or MPM_NONE where it is no polynomial in that. */
static PetscInt DegreeWith(const MpmNodalPlan *plan, PetscInt stride)
{
  PetscInt degree = 0;

  for (PetscInt g = 0; g < plan->nimages; g++)
    for (PetscInt h = 0; h < plan->nimages; h++) {
      const PetscInt64 powers = plan->powers[plan->next[g] * plan->nimages + h];

      for (PetscInt j = 0; j < 62; j++) {
        const PetscInt power = j + plan->weight[g] - plan->weight[h];

        if (!(powers >> j & 1)) continue;
        if (power < 0 || power % stride) return MPM_NONE;
        degree = PetscMax(degree, power / stride);
      }
    }
  return degree;
}

/* Finds weights 0 and 1 with which only even powers occur. */
static void Weigh(MpmNodalPlan *plan)
{
  PetscInt best = MPM_NONE;

  for (PetscInt bits = 0; bits < 1 << plan->nimages; bits++) {
    PetscInt degree;

    for (PetscInt g = 0; g < plan->nimages; g++) plan->weight[g] = bits >> g & 1;
    degree = DegreeWith(plan, 2);
    if (degree == MPM_NONE || (best != MPM_NONE && degree >= plan->degree)) continue;
    best         = bits;
    plan->degree = degree;
  }
  plan->stride = best == MPM_NONE ? 1 : 2;
  for (PetscInt g = 0; g < plan->nimages; g++) plan->weight[g] = best == MPM_NONE ? 0 : best >> g & 1;
  if (best == MPM_NONE) plan->degree = DegreeWith(plan, 1);
}

/* ---- the plan ---- */

/* The number c of each register after a whole step. */
static void Keep(const MpmTable *table, MpmNodalPlan *plan)
{
  for (PetscInt r = 0; r < table->nparticles; r++) plan->kept[r] = r < table->nstate ? 1 : 0;
  for (PetscInt o = 0; o < table->nops; o++)
    if (table->ops[o].kind == MPM_SCALE) plan->kept[table->ops[o].dst] *= table->ops[o].factor;
}

/* Follows what scratch registers stand for. PETSC_FALSE: for no single register of the state. */
static PetscBool FollowRoot(const MpmTable *table, const MpmOp *op, PetscInt root[])
{
  if (op->kind == MPM_SCALE && op->dst >= table->nstate && op->factor == 0) root[op->dst] = op->dst;
  if (op->kind != MPM_ADD) return PETSC_TRUE;
  if (op->dst < table->nstate || op->coefficient || root[op->dst] != op->dst) return PETSC_FALSE;
  root[op->dst] = root[op->src];
  return PETSC_TRUE;
}

const char *MpmNodalWhyNot(const MpmTable *table)
{
  PetscInt root[MPM_MAX_FIELDS];

  for (PetscInt r = 0; r < table->nparticles; r++) root[r] = r;
  for (PetscInt o = 0; o < table->nops; o++) {
    if (!FollowRoot(table, &table->ops[o], root)) return "particles take what other fields of theirs hold";
    if (table->ops[o].kind == MPM_SCALE && table->ops[o].coefficient)
      return "particles' values are multiplied by the Courant number";
  }
  return NULL;
}

/* There is at most one image for each sum of other registers and each power of the Courant number in it. */
PetscBool MpmNodalHasRoom(const MpmTable *table)
{
  PetscInt images = 0, root[MPM_MAX_FIELDS];
  MpmOp    first[MPM_MAX_IMAGES + 1];

  for (PetscInt r = 0; r < table->nparticles; r++) root[r] = r;
  for (PetscInt o = 0; o < table->nops && images <= MPM_MAX_IMAGES; o++) {
    const MpmOp      *op     = &table->ops[o];
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
    PetscInt          same   = 0;

    (void)FollowRoot(table, op, root);
    if (traits.dst != MPM_ON_NODES || traits.src != MPM_ON_PARTICLES) continue;
    if (op->accumulates && op->coefficient == op[-1].coefficient) continue;
    while (same < images && (first[same].kind != op->kind || first[same].axis != op->axis ||
                             first[same].src != root[op->src] || first[same].coefficient != op->coefficient))
      same++;
    if (same < images) continue;
    first[images]       = *op;
    first[images++].src = root[op->src];
  }
  return images <= MPM_MAX_IMAGES ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmNodalPlanCreate(const MpmTable *table, MpmNodalPlan **out)
{
  MpmNodalPlan *plan;
  Builder       b = {.table = table, .slot_room = table->nops + table->nnodes + 2 * MPM_MAX_IMAGES};

  PetscFunctionBegin;
  MpmCheckInput(!MpmNodalWhyNot(table), "%s: the nodes alone do not say what a step does: %s; allowed: without that",
                table->where, MpmNodalWhyNot(table));
  PetscCall(PetscNew(out));
  b.plan = plan = *out;
  plan->dim     = table->dim;
  plan->nstate  = table->nstate;
  PetscCall(PetscCalloc1(b.slot_room, &b.captured));
  Keep(table, plan);
  plan->nslots = MPM_MAX_IMAGES; /* the images' own come first */
  for (PetscInt r = 0; r < table->nparticles; r++) {
    b.c[r]    = r < table->nstate ? 1 : 0;
    b.root[r] = r;
  }
  for (PetscInt n = 0; n < table->nnodes; n++) PetscCall(NewSlot(&b, &b.slot[n]));
  for (PetscInt o = 0; o < table->nops; o++) PetscCall(Apply(&b, &table->ops[o]));
  PetscCall(EndSums(&b));
  PetscCall(Sent(&b));
  PetscCall(Next(&b));
  PetscCall(Powers(plan));
  Weigh(plan);
  for (PetscInt r = 0; r < table->nparticles; r++) PetscCall(PetscFree(b.terms[r]));
  PetscCall(PetscFree(b.captured));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalPlanDestroy(MpmNodalPlan **plan)
{
  PetscFunctionBegin;
  if (!*plan) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt m = 0; m < (*plan)->nmaps; m++) PetscCall(PetscFree((*plan)->map[m].product));
  PetscCall(PetscFree((*plan)->map));
  PetscCall(PetscFree((*plan)->line));
  PetscCall(PetscFree((*plan)->powers));
  PetscCall(PetscFree((*plan)->sent));
  PetscCall(PetscFree(*plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}
