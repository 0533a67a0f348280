/* From a written scheme to a formulation: parameters, lines, and what the text says of energy and waves. */
#include "scheme/language_compile.h"
#include <mpmstab/errors.h>
#include <string.h>

#define Refuse(w, where, ...) MpmRefuseLine(w, where, __VA_ARGS__)

/* ---- parameters ---- */

typedef struct {
  const MpmWritten *written;
  PetscReal        *numbers;
  int               state[MPM_MOST_PARAMETERS]; /* 0: not known, 1: being read, 2: known */
} Constants;

PetscInt MpmWrittenFindParameter(const MpmWritten *w, const char name[])
{
  for (PetscInt i = 0; i < w->nparameters; i++)
    if (!strcmp(w->parameters[i].name.text, name)) return i;
  return MPM_NONE;
}

/* The value of a parameter, which its text may give by others. */
static PetscErrorCode LookUp(void *context, const MpmWrittenText *text, const char name[], PetscReal *value)
{
  Constants        *c = context;
  const MpmWritten *w = c->written;
  const PetscInt    i = MpmWrittenFindParameter(w, name);

  PetscFunctionBegin;
  if (i == MPM_NONE && !strcmp(name, "k")) Refuse(w, text, "a parameter is a number; allowed: k in lines of the step");
  if (i == MPM_NONE) Refuse(w, text, "there is no parameter %s; allowed: numbers and other parameters", name);
  if (c->state[i] == 1)
    Refuse(w, text, "the parameter %s is defined by itself, in a cycle; allowed: parameters that end in numbers", name);
  if (w->parameters[i].set)
    c->numbers[i] = w->parameters[i].value;
  else if (c->state[i] == 0) {
    c->state[i] = 1;
    PetscCall(MpmNumberRead(w, &w->parameters[i].text, LookUp, c, &c->numbers[i]));
  }
  c->state[i] = 2;
  *value      = c->numbers[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenNumbers(const MpmWritten *w, PetscReal numbers[])
{
  Constants c = {.written = w, .numbers = numbers};
  PetscReal value;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < w->nparameters; i++)
    PetscCall(LookUp(&c, &w->parameters[i].text, w->parameters[i].name.text, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what the text says besides ---- */

static PetscErrorCode FieldOf(const MpmWritten *w, const MpmWrittenText *text, MpmPlace *place, PetscInt *field)
{
  PetscFunctionBegin;
  *place = MpmWrittenFindField(w, text->text, field);
  if (*place == MPM_NOWHERE) Refuse(w, text, "there is no such field; allowed: a field of 'particles' or 'nodes'");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* staggered, affine and conserved name a field of particles. */
static PetscErrorCode ParticleField(const MpmWritten *w, const MpmWrittenText *text, PetscInt *field)
{
  MpmPlace place;

  PetscFunctionBegin;
  *field = MPM_NONE;
  if (!text->text) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(FieldOf(w, text, &place, field));
  if (place != MPM_ON_PARTICLES) Refuse(w, text, "is a field of nodes; allowed: one of particles");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Energy(MpmCompiler *c)
{
  const MpmWritten *w = c->written;
  MpmEnergyTerm    *terms;

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(w->nenergy, &terms));
  c->f->energy  = terms;
  c->f->nenergy = w->nenergy;
  for (PetscInt t = 0; t < w->nenergy; t++) {
    const MpmWrittenText *kind = &w->energy[t].kind;
    const PetscBool       node = !strcmp(kind->text, "difference") ? PETSC_TRUE : PETSC_FALSE;

    PetscCall(FieldOf(w, &w->energy[t].field, &terms[t].place, &terms[t].field));
    terms[t].stress = !strcmp(kind->text, "compliance") ? PETSC_TRUE : PETSC_FALSE;
    if (!terms[t].stress && !node && strcmp(kind->text, "mass"))
      Refuse(w, kind, "allowed in energy: mass, compliance (of a stress) or difference (of a field of nodes)");
    if ((terms[t].place == MPM_ON_NODES) != node)
      Refuse(w, kind, "%s is a field of %s; allowed: %s", w->energy[t].field.text, node ? "particles" : "nodes",
             node ? "mass or compliance" : "difference");
    if (terms[t].place == MPM_ON_PARTICLES &&
        (c->f->particle_ranks[terms[t].field] == MPM_TENSOR) != (terms[t].stress == PETSC_TRUE))
      Refuse(w, kind, "%s is %s; allowed: %s", w->energy[t].field.text, terms[t].stress ? "no stress" : "a stress",
             terms[t].stress ? "mass" : "compliance");
    if (node) c->node_read[terms[t].field] = PETSC_TRUE;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A field of particles is scratch where a line sets it and lines up to the next pass over the particles read it: what
   goes to nodes ends the pass for all that begins or comes from nodes after it.
*/
static void FindScratch(MpmCompiler *c)
{
  PetscBool set[MPM_MAX_FIELDS] = {PETSC_FALSE}, sums = PETSC_FALSE;

  for (PetscInt p = 0; p < c->written->nparticles; p++)
    c->f->scratch[p] = p != c->f->staggered && p != c->f->affine && p != c->f->conserved ? PETSC_TRUE : PETSC_FALSE;
  for (PetscInt t = 0; t < c->f->nenergy; t++)
    if (c->f->energy[t].place == MPM_ON_PARTICLES) c->f->scratch[c->f->energy[t].field] = PETSC_FALSE;
  for (PetscInt o = 0; o < c->nops; o++) {
    const MpmOp      *op     = &c->ops[o];
    const MpmOpTraits traits = op->kind < MPM_OP_KINDS ? MpmOpTraitsOf(op->kind) : (MpmOpTraits){.dst = MPM_NOWHERE};
    const PetscBool   sends  = traits.src == MPM_ON_PARTICLES && traits.dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;

    if (op->kind >= MPM_OP_KINDS || !sends) {
      if (sums || op->kind >= MPM_OP_KINDS || traits.dst != MPM_ON_PARTICLES) PetscArrayzero(set, MPM_MAX_FIELDS);
      sums = PETSC_FALSE;
    } else
      sums = PETSC_TRUE;
    if (op->kind >= MPM_OP_KINDS) {
      if (op->kind != MPM_IMPOSE && op->kind != MPM_REACT && op->dst != MPM_NONE) c->f->scratch[op->dst] = PETSC_FALSE;
      continue;
    }
    if (traits.src == MPM_ON_PARTICLES && traits.dst != MPM_NOWHERE && op->kind != MPM_SCALE && !set[op->src])
      c->f->scratch[op->src] = PETSC_FALSE;
    if (traits.dst != MPM_ON_PARTICLES) continue;
    if (op->kind == MPM_SCALE && op->factor == 0)
      set[op->dst] = PETSC_TRUE;
    else if (!set[op->dst])
      c->f->scratch[op->dst] = PETSC_FALSE;
  }
}

/* The continuous problems, and the ranks of their two fields. MpmWrittenFromYaml has put the vector first. */
static PetscErrorCode Wave(MpmCompiler *c)
{
  static const struct {
    const char    *name, *fields;
    const MpmWave *wave;
    MpmRank        rank[2];
  } waves[] = {{"gas", "a vector and a scalar", &MpmWaveFirstOrder, {MPM_VECTOR, MPM_SCALAR}},
               {"bar", "two scalars, displacement and w", &MpmWaveSecondOrder, {MPM_SCALAR, MPM_SCALAR}},
               {"momentum", "a vector and a stress", &MpmWaveMomentum, {MPM_VECTOR, MPM_TENSOR}}};

  const MpmWritten *w      = c->written;
  PetscInt          fields = 0;

  PetscFunctionBegin;
  if (!w->wave.text) PetscFunctionReturn(PETSC_SUCCESS);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(waves); i++) {
    if (strcmp(w->wave.text, waves[i].name)) continue;
    for (PetscInt f = 0; f < w->nparticles; f++) fields += !c->f->scratch[f];
    if (fields != 2 || c->f->scratch[0] || c->f->scratch[1] || w->particles[0].rank != waves[i].rank[0] ||
        w->particles[1].rank != waves[i].rank[1])
      Refuse(w, &w->wave, "its exact solutions are of %s; allowed: with two such fields of particles", waves[i].fields);
    c->f->wave = waves[i].wave;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  Refuse(w, &w->wave, "allowed as wave: gas, bar or momentum");
}

/*
   Without a stress at an end nothing acts there: schemes with DIV or LAP have free ends. Particles may differ where
   each force is a divergence and each gradient gives a stress.
*/
static void FindAbilities(MpmCompiler *c)
{
  PetscBool stresses = MpmFormulationHas(c->f, MPM_DIV);

  for (PetscInt o = 0; o < c->nops; o++) {
    const MpmOp *op = &c->ops[o];

    if ((op->kind == MPM_GRAD && c->f->particle_ranks[op->dst] != MPM_TENSOR) || op->kind == MPM_LAP)
      stresses = PETSC_FALSE;
  }
  c->f->materials = stresses;
  c->f->free_ends = MpmFormulationHas(c->f, MPM_DIV) || MpmFormulationHas(c->f, MPM_LAP) ? PETSC_TRUE : PETSC_FALSE;
}

/* LAP reads the mirror images of nodes beyond walls, which are those of a field that is 0 on the wall. */
static PetscErrorCode CheckLaps(const MpmCompiler *c)
{
  PetscFunctionBegin;
  for (PetscInt n = 0; n < c->nnodes; n++)
    if (c->lap[n] && (c->imposed[n] || c->reacts[n] || c->f->like[n]))
      Refuse(c->written, c->lap[n], "LAP reads %s before it has its values at walls; allowed: after IMPOSE %s",
             c->f->node_fields[n], c->f->node_fields[n]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A field that is not imposed has the mirror images of one of its group that is. */
static void FindLike(MpmCompiler *c)
{
  for (PetscInt n = 0; n < c->nnodes; n++)
    for (PetscInt other = 0; other < c->nnodes && !c->imposed[n] && !c->reacts[n] && !c->f->like[n]; other++)
      if (c->group[other] == c->group[n] && (c->imposed[other] || c->reacts[other])) c->f->like[n] = 1 + other;
}

/* ---- what all lines together must do ---- */

/* Whether a name is a word of a text. A digit before it ends a number, as in 2theta. */
static PetscBool Names(const char text[], const char name[])
{
  static const char inside[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz_";
  const size_t      length   = strlen(name);

  for (const char *at = strstr(text, name); at; at = strstr(at + 1, name))
    if ((at == text || !strchr(inside, at[-1])) && (!at[length] || !strchr("0123456789", at[length])) &&
        (!at[length] || !strchr(inside, at[length])))
      return PETSC_TRUE;
  return PETSC_FALSE;
}

/* Whether a line, or the text of another parameter, has the name of a parameter. */
static PetscBool IsUsed(const MpmWritten *w, const char name[])
{
  for (PetscInt i = 0; i < w->nstep; i++)
    if (Names(w->step[i].text, name)) return PETSC_TRUE;
  for (PetscInt i = 0; i < w->nparameters; i++)
    if (Names(w->parameters[i].text.text, name)) return PETSC_TRUE;
  for (PetscInt i = 0; i < w->transfer.nlines; i++)
    if (Names(w->transfer.lines[i].text, name)) return PETSC_TRUE;
  return PETSC_FALSE;
}

static PetscErrorCode CheckUse(const MpmCompiler *c)
{
  const MpmWritten    *w     = c->written;
  const MpmWrittenText whole = {.text = w->name.text, .line = w->line};

  PetscFunctionBegin;
  for (PetscInt n = 0; n < w->nnodes; n++) {
    if (!c->written_to[n]) Refuse(w, &w->nodes[n].name, "no line sets this field of nodes; allowed: without it");
    if (!c->node_read[n]) Refuse(w, &w->nodes[n].name, "nothing reads this field of nodes; allowed: without it");
  }
  for (PetscInt p = 0; p < w->nparticles; p++)
    if (!c->particle_read[p])
      Refuse(w, &w->particles[p].name,
             "nothing reads this field of particles; allowed: without it, or with a line that does");
  for (PetscInt i = 0; i < w->nparameters; i++)
    if (!IsUsed(w, w->parameters[i].name.text))
      Refuse(w, &w->parameters[i].name, "nothing reads this parameter; allowed: without it");
  if (!c->has_mass) Refuse(w, &whole, "no line has P2G, so that nodes have no masses; allowed: a step with P2G");
  if (!c->drifts) Refuse(w, &whole, "its step has no DRIFT; allowed: DRIFT as the last line");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool SameOps(const MpmFormulation *a, const MpmFormulation *b)
{
  MpmOp        room[MPM_MOST_TABLE_LINES];
  PetscInt     n;
  const MpmOp *ops = MpmFormulationLines(a, NULL, NULL, room, &n);

  if (n != b->nops) return PETSC_FALSE;
  for (PetscInt o = 0; o < n; o++) {
    const MpmOp *x = &ops[o], *y = &b->ops[o];

    if (x->kind != y->kind || x->dst != y->dst || x->src != y->src || x->accumulates != y->accumulates ||
        x->coefficient != y->coefficient || x->factor != y->factor)
      return PETSC_FALSE;
  }
  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++)
    if (a->particle_ranks[n] != b->particle_ranks[n] || a->node_ranks[n] != b->node_ranks[n]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/*
   A name is taken by a formulation of the program, unless the scheme is the same as that. A formulation of the program
   that a transfer as text is for has no line.
*/
static PetscErrorCode CheckName(const MpmCompiler *c)
{
  const MpmFormulation *other = MpmFormulationFind(c->f->name);

  PetscFunctionBegin;
  if (other && c->written->name.line && !SameOps(other, c->f))
    Refuse(c->written, &c->written->name, "this name is taken by a formulation of the program; allowed: another name");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the formulation ---- */

PetscErrorCode MpmCompilerBegin(MpmCompiler *c)
{
  const MpmWritten *w = c->written;

  PetscFunctionBegin;
  c->f->name      = w->name.text;
  c->f->summary   = w->summary.text ? w->summary.text : "a scheme as text";
  c->f->reference = w->reference.text ? w->reference.text : "";
  c->f->written   = w;
  for (PetscInt i = 0; i < w->nparticles; i++) {
    c->f->particle_fields[i] = w->particles[i].name.text;
    c->f->particle_ranks[i]  = w->particles[i].rank;
  }
  for (PetscInt i = 0; i < w->nnodes; i++) {
    c->f->node_fields[i] = w->nodes[i].name.text;
    c->f->node_ranks[i]  = w->nodes[i].rank;
  }
  c->nnodes = w->nnodes;
  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) {
    c->holds[n] = MPM_NONE;
    c->group[n] = n;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Compile(MpmCompiler *c, const PetscReal numbers[])
{
  const MpmWritten *w = c->written;

  PetscFunctionBegin;
  PetscCall(MpmCompilerBegin(c));
  for (PetscInt i = 0; i < w->nstep; i++) {
    MpmWrittenLine line;

    c->text = &w->step[i];
    PetscCall(MpmLineRead(w, numbers, c->text, &line));
    PetscCall(MpmCompileLine(c, &line));
  }
  c->f->nops = c->nops;
  c->f->ops  = c->ops;
  PetscCall(Energy(c));
  PetscCall(ParticleField(w, &w->staggered, &c->f->staggered));
  PetscCall(ParticleField(w, &w->affine, &c->f->affine));
  PetscCall(ParticleField(w, &w->conserved, &c->f->conserved));
  FindScratch(c);
  PetscCall(Wave(c));
  if (c->f->affine != MPM_NONE && c->f->particle_ranks[c->f->affine] != MPM_VECTOR)
    Refuse(w, &w->affine, "is no vector; allowed: a vector of particles, whose affine part apic gives");
  FindAbilities(c);
  FindLike(c);
  PetscCall(CheckLaps(c));
  PetscCall(CheckUse(c));
  PetscCall(CheckName(c));
  if (!w->transfer.name.text) PetscFunctionReturn(PETSC_SUCCESS);
  if (!MpmFormulationHas(c->f, MPM_FILTER) && !MpmFormulationHas(c->f, MPM_FILTER_BEFORE) &&
      !MpmFormulationHas(c->f, MPM_FILTER_AFTER))
    Refuse(w, &w->transfer.name, "the step has no FILTER, whose place a transfer takes; allowed: a step with FILTER");
  PetscCall(MpmWrittenCompileTransfer(w, numbers, &c->f->transfer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenCompile(const MpmWritten *written, PetscInt nset, const PetscInt parameter[],
                                 const PetscReal value[], MpmFormulation **formulation)
{
  MpmCompiler   *c;
  MpmWritten     with = *written;
  PetscReal      numbers[MPM_MOST_PARAMETERS];
  PetscErrorCode ierr;

  PetscFunctionBegin;
  *formulation = NULL;
  for (PetscInt i = 0; i < nset; i++) {
    with.parameters[parameter[i]].set   = PETSC_TRUE;
    with.parameters[parameter[i]].value = value[i];
  }
  PetscCall(MpmWrittenNumbers(&with, numbers));
  PetscCall(PetscNew(&c));
  PetscCall(PetscNew(&c->f));
  c->written = written;
  ierr       = Compile(c, numbers);
  c->f->ops  = c->ops;
  if (ierr)
    PetscCall(MpmWrittenFormulationDestroy(&c->f));
  else
    *formulation = c->f;
  PetscCall(PetscFree(c));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenFormulationDestroy(MpmFormulation **formulation)
{
  PetscFunctionBegin;
  if (*formulation) {
    PetscCall(MpmWrittenTransferDestroy(&(*formulation)->transfer));
    PetscCall(PetscFree((*formulation)->ops));
    PetscCall(PetscFree((*formulation)->energy));
  }
  PetscCall(PetscFree(*formulation));
  PetscFunctionReturn(PETSC_SUCCESS);
}
