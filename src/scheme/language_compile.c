/*
   Makes the operations of a formulation from the lines of a written scheme.

   What a line says and no operation does takes fields of nodes that the text does not name: a sum over particles that
   joins other terms, and the old values of a field that LAP or SOLVE reads while the line sets it.
*/
#include "scheme/language_compile.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

#define Refuse(c, ...) MpmRefuseLine((c)->written, (c)->text, __VA_ARGS__)

static const char *NameOf(const MpmCompiler *c, MpmPlace place, PetscInt field)
{
  return place == MPM_ON_NODES ? c->f->node_fields[field] : c->f->particle_fields[field];
}

static MpmRank RankOf(const MpmCompiler *c, MpmPlace place, PetscInt field)
{
  return place == MPM_ON_NODES ? c->f->node_ranks[field] : c->f->particle_ranks[field];
}

/* ---- one operation ---- */

/*
   Fields of nodes that are combined have the same mirror images, so they and all that they are linked to are a group.
*/
static void Link(MpmCompiler *c, PetscInt a, PetscInt b)
{
  const PetscInt from = c->group[a], to = c->group[b];

  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++)
    if (c->group[n] == from) c->group[n] = to;
}

/* Appends an operation and notes what it reads and writes. */
static PetscErrorCode Emit(MpmCompiler *c, MpmOp op)
{
  const MpmOpTraits traits = op.kind < MPM_OP_KINDS ? MpmOpTraitsOf(op.kind) : (MpmOpTraits){.dst = MPM_NOWHERE};
  const PetscBool   itself = traits.dst == traits.src && op.dst == op.src ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (!isfinite(op.factor)) Refuse(c, "a factor is not a finite number");
  if (c->nops == c->room) {
    c->room = PetscMax(32, 2 * c->room);
    PetscCall(PetscRealloc(sizeof(*c->ops) * (size_t)c->room, &c->ops));
  }
  c->ops[c->nops++] = op;
  if (traits.src == MPM_ON_NODES && !itself) c->node_read[op.src] = PETSC_TRUE;
  if (traits.src == MPM_ON_PARTICLES && !itself) c->particle_read[op.src] = PETSC_TRUE;
  if (traits.dst == MPM_ON_NODES && traits.src == MPM_ON_NODES && !itself) Link(c, op.dst, op.src);
  if (traits.dst == MPM_ON_NODES) {
    c->holds[op.dst] = op.kind == MPM_P2G && !op.accumulates && !op.coefficient && op.factor == 1 ? op.src : MPM_NONE;
    c->written_to[op.dst] = PETSC_TRUE;
    c->lost[op.dst]       = PETSC_FALSE;
  }
  if (traits.dst == MPM_ON_NODES && !itself)
    c->at_wall[op.dst] = traits.src == MPM_ON_NODES && op.kind != MPM_SOLVE && c->at_wall[op.src] &&
                                 (!op.accumulates || c->at_wall[op.dst])
                             ? PETSC_TRUE
                             : PETSC_FALSE;
  for (PetscInt n = 0; n < c->nnodes; n++)
    if (traits.dst == MPM_ON_PARTICLES && c->holds[n] == op.dst) c->holds[n] = MPM_NONE;
  if (op.kind == MPM_P2G) c->has_mass = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Appends a term, an operation for each power of k. The first one replaces the field unless adds is set. */
static PetscErrorCode EmitTerm(MpmCompiler *c, PetscInt dst, const MpmTerm *term, PetscBool *adds)
{
  PetscFunctionBegin;
  for (PetscInt power = 0; power <= MPM_MOST_POWER; power++) {
    if (!term->factor.has[power]) continue;
    PetscCall(Emit(c, (MpmOp){.kind        = term->kind,
                              .dst         = dst,
                              .src         = term->field,
                              .accumulates = *adds,
                              .coefficient = power,
                              .factor      = term->factor.of[power]}));
    *adds = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds a field of nodes without a name, of the rank and the mirror images of another. */
static PetscErrorCode Unnamed(MpmCompiler *c, PetscInt like, PetscInt *node)
{
  PetscFunctionBegin;
  if (c->nnodes == MPM_MAX_FIELDS) Refuse(c, "it needs more fields of nodes than the %d that fit", MPM_MAX_FIELDS);
  *node                        = c->nnodes++;
  c->f->node_fields[*node]     = "(unnamed)";
  c->f->node_ranks[*node]      = c->f->node_ranks[like];
  c->f->node_fields[*node + 1] = NULL;
  Link(c, *node, like);
  c->holds[*node] = MPM_NONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static MpmTerm Copy(PetscInt node, const MpmPowers *factor)
{
  const MpmPowers one = {.of = {1}, .has = {PETSC_TRUE}};

  return (MpmTerm){.kind = MPM_COPY, .place = MPM_ON_NODES, .field = node, .factor = factor ? *factor : one};
}

/* ---- ranks and places ---- */

/* The rank of what an operation makes of a field of rank from for a field of rank to; PETSC_FALSE: there is none. */
static PetscBool Fits(const MpmTerm *term, MpmRank to, MpmRank from)
{
  if (term->kind == MPM_DIV)
    return (to == MPM_VECTOR && from != MPM_VECTOR) || (to == MPM_SCALAR && from == MPM_VECTOR) ? PETSC_TRUE
                                                                                                : PETSC_FALSE;
  if (term->kind != MPM_GRAD) return to == from ? PETSC_TRUE : PETSC_FALSE;
  if (term->stress) return to == MPM_TENSOR && from == MPM_VECTOR ? PETSC_TRUE : PETSC_FALSE;
  if (term->dot) return to == MPM_SCALAR && from == MPM_VECTOR ? PETSC_TRUE : PETSC_FALSE;
  return (to == MPM_VECTOR && from == MPM_SCALAR) || (to != MPM_VECTOR && from == MPM_VECTOR) ? PETSC_TRUE
                                                                                              : PETSC_FALSE;
}

static PetscErrorCode CheckTerm(MpmCompiler *c, const MpmWrittenLine *line, const MpmTerm *term)
{
  static const char *const makes[] = {"a scalar of a vector, or a vector of a stress or a scalar",
                                      "a stress or a scalar of a vector, or a vector of a scalar",
                                      "a field of the same rank", "a scalar of a vector", "a stress of a vector"};

  const MpmOpTraits traits = MpmOpTraitsOf(term->kind);
  const char       *word = MpmOperationWord(term->kind, term->dot, term->stress), *blank = *word ? " " : "";
  const char       *dst = NameOf(c, line->place, line->field), *src = NameOf(c, term->place, term->field);
  const MpmRank     to = RankOf(c, line->place, line->field), from = RankOf(c, term->place, term->field);

  PetscFunctionBegin;
  if (traits.dst != line->place)
    Refuse(c, "%s%s%s is of %s, and %s of %s%s", word, blank, src, traits.dst == MPM_ON_NODES ? "nodes" : "particles",
           dst, line->place == MPM_ON_NODES ? "nodes" : "particles",
           *word ? "" : "; allowed: P2G takes particles' fields to nodes, G2P the other way");
  if (!Fits(term, to, from))
    Refuse(c, "%s is a %s and %s a %s; %s%sallowed: %s makes %s", dst, MpmRankNames[to], src, MpmRankNames[from], word,
           *word ? " does not fit; " : "", *word ? word : "a term",
           makes[term->dot                ? 3
                 : term->stress           ? 4
                 : term->kind == MPM_DIV  ? 0
                 : term->kind == MPM_GRAD ? 1
                                          : 2]);
  if (term->place == MPM_ON_NODES && (!c->written_to[term->field] || c->lost[term->field]))
    Refuse(c, "%s is read before the step has set it; allowed: after a line '%s = ...'", src, src);
  if (term->kind == MPM_LAP && !c->at_wall[term->field] && !c->lap[term->field]) c->lap[term->field] = c->text;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- lines that set a field of nodes ---- */

static PetscBool IsSum(const MpmTerm *term)
{
  return term->kind == MPM_P2G || term->kind == MPM_DIV ? PETSC_TRUE : PETSC_FALSE;
}

/* Whether the operations since the field was set are sums over particles, so that one more continues them. */
static PetscBool ContinuesSum(const MpmCompiler *c, PetscInt dst)
{
  for (PetscInt o = c->nops - 1; o >= 0; o--) {
    if (c->ops[o].kind != MPM_P2G && c->ops[o].kind != MPM_DIV) return PETSC_FALSE;
    if (c->ops[o].dst == dst && !c->ops[o].accumulates) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/*
   The first sum of a step also sums the masses, which all sums are divided by. It is a P2G with the factor 1: one of
   the line's, or one to a field without a name, which then stands for the term.
*/
static PetscErrorCode BeginMass(MpmCompiler *c, MpmWrittenLine *line)
{
  PetscInt first = line->nterms, node = MPM_NONE;

  PetscFunctionBegin;
  for (PetscInt t = line->nterms - 1; t >= 0; t--)
    if (line->term[t].kind == MPM_P2G && (first == line->nterms || MpmPowersIsUnit(&line->term[t].factor) ||
                                          !MpmPowersIsUnit(&line->term[first].factor)))
      first = t;
  if (first == line->nterms)
    Refuse(c, "DIV comes before the nodes have masses; allowed: after a line with P2G, whose sum makes them");
  if (MpmPowersIsUnit(&line->term[first].factor)) {
    const MpmTerm mass = line->term[first];

    for (PetscInt t = first; t > 0; t--) line->term[t] = line->term[t - 1];
    line->term[0] = mass;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Unnamed(c, line->field, &node));
  PetscCall(Emit(c, (MpmOp)P2G(node, line->term[first].field)));
  line->term[first] = Copy(node, &line->term[first].factor);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Puts the sums over particles into a field without a name, which then stands for them. */
static PetscErrorCode SumApart(MpmCompiler *c, MpmWrittenLine *line)
{
  PetscBool adds = PETSC_FALSE;
  PetscInt  node = MPM_NONE, n = 0;

  PetscFunctionBegin;
  PetscCall(Unnamed(c, line->field, &node));
  for (PetscInt t = 0; t < line->nterms; t++)
    if (IsSum(&line->term[t]))
      PetscCall(EmitTerm(c, node, &line->term[t], &adds));
    else
      line->term[n++] = line->term[t];
  line->term[n++] = Copy(node, NULL);
  line->nterms    = n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* SOLVE replaces a field and has no factor. Where the line says more, a field without a name has its result. */
static PetscErrorCode SolveApart(MpmCompiler *c, MpmWrittenLine *line, MpmTerm *term)
{
  PetscInt node = MPM_NONE;

  PetscFunctionBegin;
  if (term->kind != MPM_SOLVE) PetscFunctionReturn(PETSC_SUCCESS);
  if (line->nterms == 1 && !line->adds && MpmPowersIsUnit(&term->factor) && term->field != line->field)
    PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Unnamed(c, line->field, &node));
  PetscCall(Emit(c, (MpmOp)SOLVE(node, term->field)));
  *term = Copy(node, &term->factor);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt CountSums(const MpmWrittenLine *line)
{
  PetscInt sums = 0;

  for (PetscInt t = 0; t < line->nterms; t++) sums += IsSum(&line->term[t]);
  return sums;
}

/* The term that is a multiple of the field which the line sets, or MPM_NONE. */
static PetscInt OwnTerm(const MpmWrittenLine *line)
{
  for (PetscInt t = 0; t < line->nterms; t++)
    if (line->term[t].kind == (line->place == MPM_ON_NODES ? MPM_COPY : MPM_ADD) && line->term[t].field == line->field)
      return t;
  return MPM_NONE;
}

/* Writes 'field += terms' with a multiple of the field among them as 'field = (1 + ...) field + ...'. */
static void MakeReplacing(MpmWrittenLine *line)
{
  const PetscInt own = line->adds ? OwnTerm(line) : MPM_NONE;

  if (own == MPM_NONE) return;
  line->term[own].factor.of[0] += 1;
  line->term[own].factor.has[0] = PETSC_TRUE;
  line->adds                    = PETSC_FALSE;
}

/* Keeps the old values of the field where terms read them in a way that its new values would disturb. */
static PetscErrorCode KeepOld(MpmCompiler *c, MpmWrittenLine *line)
{
  const PetscInt own  = OwnTerm(line);
  PetscBool      keep = PETSC_FALSE, adds = PETSC_FALSE;
  PetscInt       node = MPM_NONE, power;
  MpmTerm        old;

  PetscFunctionBegin;
  for (PetscInt t = 0; t < line->nterms; t++)
    if (line->term[t].kind == MPM_LAP && line->term[t].field == line->field) keep = PETSC_TRUE;
  if (own != MPM_NONE && !MpmPowersIsOne(&line->term[own].factor, &power)) keep = PETSC_TRUE;
  if (!keep) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Unnamed(c, line->field, &node));
  old = Copy(line->field, NULL);
  PetscCall(EmitTerm(c, node, &old, &adds));
  for (PetscInt t = 0; t < line->nterms; t++)
    if (line->term[t].place == MPM_ON_NODES && line->term[t].field == line->field) line->term[t].field = node;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetNodes(MpmCompiler *c, MpmWrittenLine *line)
{
  PetscInt  sums, own;
  PetscBool adds;

  PetscFunctionBegin;
  if (line->adds && !c->written_to[line->field])
    Refuse(c, "%s is added to before the step has set it; allowed: after a line '%s = ...'",
           NameOf(c, line->place, line->field), NameOf(c, line->place, line->field));
  MakeReplacing(line);
  if (CountSums(line) && !c->has_mass) PetscCall(BeginMass(c, line));
  sums = CountSums(line);
  if (sums && (line->adds ? sums < line->nterms || !ContinuesSum(c, line->field) : OwnTerm(line) != MPM_NONE))
    PetscCall(SumApart(c, line));
  for (PetscInt t = 0; t < line->nterms; t++) PetscCall(SolveApart(c, line, &line->term[t]));
  PetscCall(KeepOld(c, line));
  adds = line->adds;
  own  = OwnTerm(line);
  if (own != MPM_NONE) {
    if (!MpmPowersIsUnit(&line->term[own].factor)) PetscCall(EmitTerm(c, line->field, &line->term[own], &adds));
    adds = PETSC_TRUE;
  }
  for (int pass = 0; pass < 2; pass++) /* sums over particles come first */
    for (PetscInt t = 0; t < line->nterms; t++)
      if (t != own && IsSum(&line->term[t]) == (pass == 0)) PetscCall(EmitTerm(c, line->field, &line->term[t], &adds));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- lines that set a field of particles ---- */

/* field = (a k^m + b k^n) field + ... is a multiple, and then a multiple of that one added. */
static PetscErrorCode ScaleParticles(MpmCompiler *c, PetscInt field, const MpmPowers *factor)
{
  MpmOp    scale = SCALE(field, 0);
  PetscInt n     = 0;

  PetscFunctionBegin;
  for (PetscInt power = 0; power <= MPM_MOST_POWER; power++) {
    if (!factor->has[power] || (factor->of[power] == 0 && n == 0)) continue;
    if (n++ == 0) {
      scale.factor      = factor->of[power];
      scale.coefficient = power;
      if (scale.factor != 1 || power) PetscCall(Emit(c, scale));
      continue;
    }
    if (n > 2) Refuse(c, "the factor of %s has three powers of k; allowed: two", c->f->particle_fields[field]);
    PetscCall(Emit(c, (MpmOp){.kind        = MPM_ADD,
                              .dst         = field,
                              .src         = field,
                              .accumulates = PETSC_TRUE,
                              .coefficient = power - scale.coefficient,
                              .factor      = factor->of[power] / scale.factor}));
  }
  if (n == 0) PetscCall(Emit(c, scale));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetParticles(MpmCompiler *c, MpmWrittenLine *line)
{
  const MpmPowers none = {{0}, {PETSC_FALSE}};
  PetscInt        own;
  PetscBool       adds = PETSC_TRUE;

  PetscFunctionBegin;
  MakeReplacing(line);
  own = OwnTerm(line);
  if (!line->adds) PetscCall(ScaleParticles(c, line->field, own == MPM_NONE ? &none : &line->term[own].factor));
  for (PetscInt t = 0; t < line->nterms; t++)
    if (t != own) PetscCall(EmitTerm(c, line->field, &line->term[t], &adds));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- statements ---- */

/* With pic_filter after, and with pic_filter before, a filter acts or it does not. */
static PetscInt TimesOf(MpmOpKind filter)
{
  return filter == MPM_FILTER ? 3 : filter == MPM_FILTER_AFTER ? 1 : 2;
}

/*
   Where the nodes do not hold P2G of the field, the filter may put it there. Later lines may not read what was there.
*/
static PetscErrorCode Filter(MpmCompiler *c, const MpmWrittenLine *line)
{
  const char *particle = c->f->particle_fields[line->field], *node = c->f->node_fields[line->other];

  PetscFunctionBegin;
  if (c->f->particle_ranks[line->field] != c->f->node_ranks[line->other])
    Refuse(c, "%s is a %s and %s a %s; allowed: fields of the same rank", particle,
           MpmRankNames[c->f->particle_ranks[line->field]], node, MpmRankNames[c->f->node_ranks[line->other]]);
  if (c->filtered[line->field] & TimesOf(line->op)) Refuse(c, "%s is filtered a second time; allowed: once", particle);
  if (line->op == MPM_FILTER && c->written_to[line->other] && c->holds[line->other] != line->field)
    Refuse(c, "%s is not P2G of %s here; allowed: before it is set, or after '%s = P2G %s' and IMPOSE", node, particle,
           node, particle);
  if (c->written_to[line->other] && c->holds[line->other] != line->field) c->lost[line->other] = PETSC_TRUE;
  c->filtered[line->field] |= TimesOf(line->op);
  c->node_read[line->other] = PETSC_TRUE;
  PetscCall(Emit(c, (MpmOp){.kind = line->op, .dst = line->field, .src = line->other, .factor = 1}));
  for (PetscInt n = 0; n < c->nnodes; n++)
    if (c->holds[n] == line->field) c->holds[n] = MPM_NONE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Impose(MpmCompiler *c, const MpmWrittenLine *line)
{
  PetscFunctionBegin;
  if (!c->written_to[line->field])
    Refuse(c, "%s is imposed before the step has set it", c->f->node_fields[line->field]);
  c->imposed[line->field] = c->at_wall[line->field] = PETSC_TRUE;
  PetscCall(Emit(c, (MpmOp)IMPOSE(line->field)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode React(MpmCompiler *c, const MpmWrittenLine *line)
{
  const char *node = c->f->node_fields[line->field], *imposed = c->f->node_fields[line->other];

  PetscFunctionBegin;
  if (!c->written_to[line->field]) Refuse(c, "%s reacts before the step has set it", node);
  if (!c->imposed[line->other])
    Refuse(c, "%s has not been imposed; allowed: after IMPOSE %s, whose values before the wall it takes", imposed,
           imposed);
  if (c->f->node_ranks[line->field] != c->f->node_ranks[line->other])
    Refuse(c, "%s is a %s and %s a %s; allowed: fields of the same rank", node,
           MpmRankNames[c->f->node_ranks[line->field]], imposed, MpmRankNames[c->f->node_ranks[line->other]]);
  c->node_read[line->other] = PETSC_TRUE;
  c->reacts[line->field]    = PETSC_TRUE;
  c->at_wall[line->field]   = PETSC_FALSE; /* it is the reaction there */
  c->holds[line->field]     = MPM_NONE;
  PetscCall(Emit(c, (MpmOp)REACT(line->field, line->other)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles move with a velocity of the grid. It is not marked as read: without a prestress nothing reads it. */
static PetscErrorCode Move(MpmCompiler *c, const MpmWrittenLine *line)
{
  const char *node = c->f->node_fields[line->field];

  PetscFunctionBegin;
  if (!c->written_to[line->field]) Refuse(c, "particles move with %s before the step has set it", node);
  if (c->f->node_ranks[line->field] != MPM_VECTOR)
    Refuse(c, "%s is a %s; allowed: a vector, a velocity of the grid", node,
           MpmRankNames[c->f->node_ranks[line->field]]);
  PetscCall(Emit(c, (MpmOp){.kind = line->op, .dst = MPM_NONE, .src = line->field, .factor = line->share}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The solution has the values of what it is solved from at walls that IMPOSE has set to 0. */
static PetscErrorCode Implicit(MpmCompiler *c, const MpmWrittenLine *line)
{
  const char *node     = c->f->node_fields[line->field];
  PetscBool   stressed = PETSC_FALSE;
  PetscInt    power    = 0;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < c->written->nparticles; p++)
    if (c->f->particle_ranks[p] == MPM_TENSOR) stressed = PETSC_TRUE;
  if (!c->written_to[line->field]) Refuse(c, "%s is solved for before the step has set it", node);
  if (!stressed || c->f->node_ranks[line->field] != MPM_VECTOR)
    Refuse(c, "%s is a %s; allowed: a vector, in a scheme with a stress", node,
           MpmRankNames[c->f->node_ranks[line->field]]);
  (void)MpmPowersIsOne(&line->term[0].factor, &power);
  c->node_read[line->field] = PETSC_TRUE;
  PetscCall(Emit(c, (MpmOp){.kind        = MPM_IMPLICIT,
                            .dst         = line->field,
                            .src         = line->field,
                            .coefficient = power,
                            .factor      = line->term[0].factor.of[power]}));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCompileLine(MpmCompiler *c, MpmWrittenLine *line)
{
  PetscFunctionBegin;
  if (c->drifts) Refuse(c, "a line comes after DRIFT; allowed: DRIFT as the last line");
  for (PetscInt t = 0; t < line->nterms; t++) PetscCall(CheckTerm(c, line, &line->term[t]));
  if (line->op == MPM_LINE_SETS)
    PetscCall(line->place == MPM_ON_NODES ? SetNodes(c, line) : SetParticles(c, line));
  else if (line->op == MPM_IMPOSE)
    PetscCall(Impose(c, line));
  else if (line->op == MPM_REACT)
    PetscCall(React(c, line));
  else if (line->op == MPM_MOVE || line->op == MPM_MOVE_PROJECTED)
    PetscCall(Move(c, line));
  else if (line->op == MPM_IMPLICIT)
    PetscCall(Implicit(c, line));
  else if (line->op == MPM_DRIFT) {
    c->drifts = PETSC_TRUE;
    PetscCall(Emit(c, (MpmOp)DRIFT));
  } else
    PetscCall(Filter(c, line));
  PetscFunctionReturn(PETSC_SUCCESS);
}
