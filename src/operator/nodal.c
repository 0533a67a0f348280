/*
   The plan of the nodal operator: the program of a table, cut at its node registers. A particle register is c q plus
   terms, a node register a slot of the plan.
*/
#include "linalg/lapack_names.h"
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
   c, root, terms, nterms - of each particle register, up to the present operation: c times the state register root as
                       it was, and the terms. A scratch register has the root of what it is set to.
   slot              - the slot of each node register
   captured          - captured[s]: terms of particles refer to slot s as it is, so it must not change
   readings          - what the present row of sums reads, each with the image that it is so far
   room              - of the plan's maps and slots
   why_not, full     - why there is no plan; full: it has too many images
*/
typedef struct {
  const MpmTable *table;
  MpmNodalPlan   *plan;
  PetscReal       c[MPM_MAX_FIELDS];
  PetscInt        root[MPM_MAX_FIELDS], nterms[MPM_MAX_FIELDS], slot[MPM_MAX_FIELDS], nreadings;
  Term           *terms[MPM_MAX_FIELDS];
  PetscBool      *captured, full;
  const char     *why_not;
  Reading         reading[MPM_MAX_FIELDS];
  MpmNodalImage   image[MPM_MAX_FIELDS];
  PetscInt        map_room, slot_room;
} Builder;

static PetscErrorCode NewSlot(Builder *b, PetscInt *slot)
{
  PetscFunctionBegin;
  PetscCheck(b->plan->nslots < b->slot_room, PETSC_COMM_SELF, PETSC_ERR_PLIB, "too many slots");
  *slot = b->plan->nslots++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddLine(Builder *b, MpmLine line)
{
  PetscFunctionBegin;
  line.accumulates = PETSC_TRUE;
  PetscCall(MpmStepProgramAppend(b->plan->program, line));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- maps ---- */

/* Whether two operations have the same map. It depends on the parity of the node register, too. */
static PetscBool SameMap(const MpmTable *t, const MpmOp *a, const MpmOp *b)
{
  const PetscBool  to_nodes = MpmOpTraitsOf(a->kind).dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;
  const MpmParity *one = t->parity[to_nodes ? a->dst : a->src], *other = t->parity[to_nodes ? b->dst : b->src];

  if (a->kind != b->kind || a->axis != b->axis || a->side != b->side) return PETSC_FALSE;
  for (PetscInt axis = 0; axis < t->dim; axis++)
    if (one[axis] != other[axis]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The number of a map. W is NULL for that of an operation between nodes. */
static PetscErrorCode MapOf(Builder *b, const MpmOp *P, const MpmOp *W, PetscInt *map)
{
  MpmNodalPlan *plan = b->plan;

  PetscFunctionBegin;
  for (*map = 0; *map < plan->nmaps; ++*map) {
    const MpmNodalMap *m = &plan->map[*map];

    if (m->product == (W ? PETSC_TRUE : PETSC_FALSE) && SameMap(b->table, &m->to_nodes, P) &&
        (!W || SameMap(b->table, &m->to_particles, W)))
      PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (plan->nmaps == b->map_room) {
    b->map_room = PetscMax(16, 2 * b->map_room);
    PetscCall(PetscRealloc(sizeof(*plan->map) * (size_t)b->map_room, &plan->map));
  }
  plan->map[plan->nmaps++] = W ? (MpmNodalMap){PETSC_TRUE, *P, *W} : (MpmNodalMap){.to_nodes = *P};
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the terms of a particle register give to the nodes through a map: products, added to a slot. */
static PetscErrorCode AddTerms(Builder *b, PetscInt slot, PetscInt particle, const MpmOp *to, PetscInt power)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < b->nterms[particle]; i++) {
    const Term *term = &b->terms[particle][i];
    MpmLine     line = {
            .dst = slot, .src = term->slot, .power = power + term->op.coefficient, .factor = to->factor * term->op.factor};

    PetscCall(MapOf(b, to, &term->op, &line.key));
    PetscCall(AddLine(b, line));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- images ---- */

/* Adds a term to what is read into a slot. The registers of an image have one c at the end of the step. */
static PetscErrorCode Read(Builder *b, PetscInt slot, PetscInt power, const MpmOp *term)
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
  for (PetscInt i = 0; i < a->n; i++)
    if (a->term[i].src != b->term[i].src || a->term[i].factor != b->term[i].factor ||
        !SameMap(t, &a->term[i], &b->term[i]))
      return PETSC_FALSE;
  return PETSC_TRUE;
}

/* The number of an image, which is new if none of the plan is the same. */
static PetscInt ImageOf(Builder *b, const MpmNodalImage *image)
{
  MpmNodalPlan *plan = b->plan;

  for (PetscInt g = 0; g < plan->nimages; g++)
    if (SameImage(b->table, &plan->image[g], image)) return g;
  b->full = plan->nimages == MPM_MAX_IMAGES ? PETSC_TRUE : PETSC_FALSE;
  if (b->full) return 0;
  plan->image[plan->nimages] = *image;
  return plan->nimages++;
}

/* A row of sums over particles has ended: its images are complete. Multiples of an image are the same image. */
static PetscErrorCode EndSums(Builder *b)
{
  PetscFunctionBegin;
  for (PetscInt r = 0; r < b->nreadings; r++) {
    MpmNodalImage *image = &b->image[r];
    MpmLine        line  = {
                .dst = b->reading[r].slot, .key = MPM_NONE, .power = b->reading[r].power, .factor = image->term[0].factor};

    for (PetscInt i = 0; i < image->n; i++) image->term[i].factor /= line.factor;
    line.src = ImageOf(b, image);
    PetscCall(AddLine(b, line));
  }
  b->nreadings = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- operations ---- */

static PetscErrorCode ToNodes(Builder *b, const MpmOp *op)
{
  MpmOp term = *op;

  PetscFunctionBegin;
  if (!op->accumulates) PetscCall(NewSlot(b, &b->slot[op->dst]));
  PetscCall(AddTerms(b, b->slot[op->dst], op->src, op, op->coefficient));
  term.src = b->root[op->src];
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
static PetscErrorCode AddRegister(Builder *b, const MpmLine *line)
{
  PetscFunctionBegin;
  if (line->dst < b->table->nstate || line->power || b->root[line->dst] != line->dst)
    b->why_not = "particles take what other fields of theirs hold";
  b->c[line->dst] += line->factor * b->c[line->src];
  b->root[line->dst] = b->root[line->src];
  for (PetscInt i = 0; i < b->nterms[line->src]; i++) {
    Term term = b->terms[line->src][i];

    term.op.factor *= line->factor;
    term.op.dst = line->dst;
    PetscCall(AddTerm(b, line->dst, term));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Scale(Builder *b, const MpmLine *line)
{
  const PetscInt r = line->dst;

  if (line->power && !b->why_not) b->why_not = "particles' values are multiplied by the Courant number";
  b->c[r] *= line->factor;
  if (line->factor == 0) b->nterms[r] = 0;
  if (line->factor == 0 && r >= b->table->nstate) b->root[r] = r;
  for (PetscInt i = 0; i < b->nterms[r]; i++) b->terms[r][i].op.factor *= line->factor;
}

/* The register moves to a new slot, with its values where keep. */
static PetscErrorCode Renew(Builder *b, PetscInt reg, PetscBool keep)
{
  const PetscInt old = b->slot[reg];

  PetscFunctionBegin;
  PetscCall(NewSlot(b, &b->slot[reg]));
  if (keep) PetscCall(AddLine(b, (MpmLine){.dst = b->slot[reg], .src = old, .key = MPM_NONE, .factor = 1}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode BetweenNodes(Builder *b, const MpmLine *line)
{
  const PetscInt dst = line->dst - b->table->nparticles, src = b->slot[line->src - b->table->nparticles],
                 old = b->slot[dst];
  PetscInt map       = MPM_NONE;

  PetscFunctionBegin;
  if (line->op) PetscCall(MapOf(b, line->op, NULL, &map));
  if (!line->accumulates || b->captured[old] || src == old) PetscCall(Renew(b, dst, line->accumulates));
  if (line->factor != 0)
    PetscCall(AddLine(
        b, (MpmLine){.dst = b->slot[dst], .src = src, .key = map, .power = line->power, .factor = line->factor}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Apply(Builder *b, const MpmLine *line)
{
  const MpmOp    *op = line->op;
  const PetscBool to = line->dst >= b->table->nparticles, from = line->src >= b->table->nparticles;

  PetscFunctionBegin;
  if (to && !from) {
    PetscCall(ToNodes(b, op));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(EndSums(b));
  if (to)
    PetscCall(BetweenNodes(b, line));
  else if (from)
    PetscCall(AddTerm(b, op->dst, (Term){.op = *op, .at = (PetscInt)(op - b->table->ops), .slot = b->slot[op->src]}));
  else if (line->accumulates)
    PetscCall(AddRegister(b, line));
  else
    Scale(b, line);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the registers of the state have been sent. */
static PetscErrorCode Sent(const Builder *b)
{
  MpmNodalPlan *plan = b->plan;

  PetscFunctionBegin;
  plan->nlines_sent = plan->program->n;
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
    if (image->c != 0)
      PetscCall(AddLine(b, (MpmLine){.dst = plan->next[g], .src = g, .key = MPM_NONE, .factor = image->c}));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- powers of the Courant number ---- */

static PetscErrorCode Powers(MpmNodalPlan *plan)
{
  PetscFunctionBegin;
  PetscCall(PetscCalloc1(plan->nslots * plan->nimages, &plan->powers));
  for (PetscInt g = 0; g < plan->nimages; g++) plan->powers[g * plan->nimages + g] = 1;
  for (PetscInt l = 0; l < plan->program->n; l++) {
    const MpmLine *line = &plan->program->line[l];

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

static PetscErrorCode Build(Builder *b)
{
  const MpmRegisters slots     = {.comm = PETSC_COMM_SELF},
                     registers = {.comm = PETSC_COMM_SELF, .n = {b->table->nparticles, b->table->nnodes}};
  MpmNodalPlan   *plan         = b->plan;
  MpmStepProgram *step;

  PetscFunctionBegin;
  PetscCall(MpmStepProgramCreate(&slots, 1, &plan->program));
  plan->dim    = b->table->dim;
  plan->nstate = b->table->nstate;
  PetscCall(PetscCalloc1(b->slot_room, &b->captured));
  Keep(b->table, plan);
  plan->nslots = MPM_MAX_IMAGES; /* the images' own come first */
  for (PetscInt r = 0; r < b->table->nparticles; r++) {
    b->c[r]    = r < b->table->nstate ? 1 : 0;
    b->root[r] = r;
  }
  for (PetscInt n = 0; n < b->table->nnodes; n++) PetscCall(NewSlot(b, &b->slot[n]));
  PetscCall(MpmStepProgramCreate(&registers, 1, &step));
  PetscCall(MpmStepProgramAppendTable(step, b->table, NULL));
  for (PetscInt l = 0; l < step->n && !b->why_not; l++) PetscCall(Apply(b, &step->line[l]));
  PetscCall(MpmStepProgramDestroy(&step));
  PetscCall(EndSums(b));
  PetscCall(Sent(b));
  PetscCall(Next(b));
  PetscCall(Powers(plan));
  for (PetscInt r = 0; r < b->table->nparticles; r++) PetscCall(PetscFree(b->terms[r]));
  PetscCall(PetscFree(b->captured));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalPlanCreate(const MpmTable *table, const char **why, MpmNodalPlan **plan)
{
  Builder b = {.table = table, .slot_room = table->nops + table->nnodes + 2 * MPM_MAX_IMAGES};

  PetscFunctionBegin;
  if (MpmTableHas(table, MPM_IMPLICIT))
    b.why_not = "a step solves a linear system of them, which is no sum of products";
  if (MpmTableHas(table, MPM_COLLIDE)) b.why_not = "colliders mix the components of the velocity";
  PetscCall(PetscNew(plan));
  b.plan = *plan;
  PetscCall(Build(&b));
  MpmCheckInput(why || !b.why_not, "%s: the nodes alone do not say what a step does: %s; allowed: without that",
                table->where, b.why_not);
  PetscCheck(why || !b.full, PETSC_COMM_SELF, PETSC_ERR_SUP, "the table: its nodal operator has more than %d images",
             MPM_MAX_IMAGES);
  if (why) *why = b.why_not;
  if (b.why_not || b.full)
    PetscCall(MpmNodalPlanDestroy(plan));
  else
    Weigh(*plan);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalPlanDestroy(MpmNodalPlan **plan)
{
  PetscFunctionBegin;
  if (!*plan) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*plan)->map));
  PetscCall(MpmStepProgramDestroy(&(*plan)->program));
  PetscCall(PetscFree((*plan)->powers));
  PetscCall(PetscFree((*plan)->sent));
  PetscCall(PetscFree(*plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   ---- the algebra of plans on small dense matrices ----

   A slot is, for each image and each power of the Courant number, a multiple of the identity plus a matrix. In most
   plans every map meets a multiple of the identity, and no product of matrices is made.
*/

typedef struct {
  PetscReal       multiple;
  double complex *matrix; /* NULL: 0 */
} Block;

typedef struct {
  const MpmNodalPlan *plan;
  PetscInt            nodes, powers; /* the number of powers, 0 and up */
  double complex     *map;           /* of all maps, one after another */
  Block              *block;
} Run;

static Block *BlockOf(const Run *r, PetscInt slot, PetscInt image, PetscInt power)
{
  return &r->block[(slot * r->plan->nimages + image) * r->powers + power];
}

static PetscErrorCode Matrix(const Run *r, Block *b)
{
  PetscFunctionBegin;
  if (!b->matrix) PetscCall(PetscCalloc1(r->nodes * r->nodes, &b->matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Add(PetscInt n, PetscReal factor, const double complex src[], double complex dst[])
{
  for (PetscInt i = 0; i < n; i++) dst[i] += factor * src[i];
}

/* dst += factor (map of src) */
static PetscErrorCode AddBlock(const Run *r, const MpmLine *line, const Block *src, Block *dst)
{
  const PetscInt        square = r->nodes * r->nodes;
  const double complex *map = line->key == MPM_NONE ? NULL : r->map + line->key * square, alpha = line->factor, one = 1;
  PetscBLASInt          n;

  PetscFunctionBegin;
  if (!map) {
    dst->multiple += line->factor * src->multiple;
    if (src->matrix) {
      PetscCall(Matrix(r, dst));
      Add(square, line->factor, src->matrix, dst->matrix);
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (src->multiple == 0 && !src->matrix) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Matrix(r, dst));
  if (src->multiple != 0) Add(square, line->factor * src->multiple, map, dst->matrix);
  if (src->matrix) {
    PetscCall(PetscBLASIntCast(r->nodes, &n));
    MPM_ZGEMM("N", "N", &n, &n, &n, &alpha, map, &n, src->matrix, &n, &one, dst->matrix, &n);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RunLine(void *registers, const MpmLine *line, PetscBool back)
{
  const Run *r = registers;

  PetscFunctionBegin;
  PetscCheck(!back, PETSC_COMM_SELF, PETSC_ERR_SUP, "a program runs backwards on vectors alone");
  for (PetscInt g = 0; g < r->plan->nimages; g++)
    for (PetscInt j = 0; j + line->power < r->powers; j++)
      PetscCall(AddBlock(r, line, BlockOf(r, line->src, g, j), BlockOf(r, line->dst, g, j + line->power)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const MpmAlgebra block_algebra = {.add = RunLine};

/* Block (g, h) of what multiplies k^power in the step goes to the coefficient of k^(power + weight[g] - weight[h]). */
static void Gather(const Run *r, PetscInt g, PetscInt h, PetscInt power, double complex *const coefficient[])
{
  const MpmNodalPlan *plan  = r->plan;
  const Block        *b     = BlockOf(r, plan->next[g], h, power);
  const PetscInt      nodes = r->nodes, n = plan->nimages * nodes;
  double complex     *at;

  if (b->multiple == 0 && !b->matrix) return;
  at = coefficient[(power + plan->weight[g] - plan->weight[h]) / plan->stride] + h * nodes * n + g * nodes;
  for (PetscInt c = 0; c < nodes; c++) {
    at[c * n + c] += b->multiple;
    for (PetscInt i = 0; b->matrix && i < nodes; i++) at[c * n + i] += b->matrix[c * nodes + i];
  }
}

/* One more than the largest power in any slot. */
static PetscInt PowersOf(const MpmNodalPlan *plan)
{
  PetscInt powers = 0;

  for (PetscInt i = 0; i < plan->nslots * plan->nimages; i++)
    while (plan->powers[i] >> powers) powers++;
  return powers;
}

PetscErrorCode MpmNodalRun(const MpmNodalPlan *plan, PetscInt nodes, MpmNodalMapMatrix map, void *context,
                           double complex *const coefficient[])
{
  const PetscInt square = nodes * nodes, all = plan->nimages * plan->nimages * square;
  Run            r = {.plan = plan, .nodes = nodes, .powers = PowersOf(plan)};

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(plan->nmaps * square, &r.map));
  for (PetscInt m = 0; m < plan->nmaps; m++) PetscCall(map(context, &plan->map[m], r.map + m * square));
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscArrayzero(coefficient[j], all));
  PetscCall(PetscCalloc1(plan->nslots * plan->nimages * r.powers, &r.block));
  for (PetscInt g = 0; g < plan->nimages; g++) BlockOf(&r, g, g, 0)->multiple = 1;
  PetscCall(MpmStepProgramRun(plan->program, &block_algebra, &r, PETSC_FALSE));
  for (PetscInt g = 0; g < plan->nimages; g++)
    for (PetscInt h = 0; h < plan->nimages; h++)
      for (PetscInt j = 0; j < r.powers; j++) Gather(&r, g, h, j, coefficient);
  for (PetscInt i = 0; i < plan->nslots * plan->nimages * r.powers; i++) PetscCall(PetscFree(r.block[i].matrix));
  PetscCall(PetscFree(r.block));
  PetscCall(PetscFree(r.map));
  PetscFunctionReturn(PETSC_SUCCESS);
}
