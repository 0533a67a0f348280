/* From a formulation to its text, and from that to YAML; the hash of a scheme. */
#include "base/hash.h"
#include "base/text.h"
#include "scheme/language_compile.h"
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- from a formulation to texts ---- */

static PetscErrorCode Keep(const char text[], MpmWrittenText *kept)
{
  PetscFunctionBegin;
  PetscCall(PetscStrallocpy(text, &kept->text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A factor before an operation or a field: nothing for 1, else with all digits that it has, and a blank after it. */
static PetscErrorCode FactorText(const MpmOp *op, size_t room, char text[])
{
  const PetscReal size  = PetscAbsReal(op->factor);
  const PetscInt  power = op->coefficient;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(text, op->factor < 0 ? "-" : "", room));
  for (int digits = 1; digits <= 17 && size != 1; digits++) {
    char number[32];

    (void)snprintf(number, sizeof number, "%.*g", digits, size);
    if (strtod(number, NULL) != size) continue;
    MpmTextJoin(text, number, room);
    MpmTextJoin(text, " ", room);
    break;
  }
  if (power > 1)
    (void)snprintf(text + strlen(text), room - strlen(text), "k^%" PetscInt_FMT " ", power);
  else if (power)
    MpmTextJoin(text, "k ", room);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The word of an operation and a blank, or nothing. */
static void JoinWord(const MpmFormulation *f, const MpmOp *op, size_t room, char text[])
{
  const MpmRank to   = op->kind == MPM_GRAD ? f->particle_ranks[op->dst] : MPM_VECTOR;
  const char   *word = MpmOperationWord(op->kind, to == MPM_SCALAR, to == MPM_TENSOR);

  MpmTextJoin(text, word, room);
  if (*word) MpmTextJoin(text, " ", room);
}

PetscErrorCode MpmWrittenLineText(const MpmFormulation *f, const MpmOp *op, size_t room, char text[])
{
  const MpmOpTraits  traits = op->kind < MPM_OP_KINDS ? MpmOpTraitsOf(op->kind) : (MpmOpTraits){.dst = MPM_ON_NODES};
  const char *const *to     = traits.dst == MPM_ON_NODES ? f->node_fields : f->particle_fields;
  const char *const *from   = traits.src == MPM_ON_NODES ? f->node_fields : f->particle_fields;
  const char        *word   = MpmStatementWord(op->kind);
  char               factor[64];

  PetscFunctionBegin;
  PetscCall(FactorText(op, sizeof factor, factor));
  if (op->kind == MPM_DRIFT)
    PetscCall(PetscStrncpy(text, word, room));
  else if (op->kind == MPM_IMPOSE)
    PetscCall(PetscSNPrintf(text, room, "%s %s", word, f->node_fields[op->dst]));
  else if (op->kind == MPM_MOVE || op->kind == MPM_MOVE_PROJECTED)
    PetscCall(PetscSNPrintf(text, room, "%s %s%s", word, factor, f->node_fields[op->src]));
  else if (op->kind == MPM_IMPLICIT) {
    PetscCall(PetscSNPrintf(text, room, "%s %s %s%s", word, f->node_fields[op->dst],
                            op->factor == 1 && !op->coefficient ? "1" : "", factor));
    for (size_t n = strlen(text); text[n - 1] == ' '; n--) text[n - 1] = 0;
  } else if (word) /* REACT is of two fields of nodes, a filter of one of particles and one of nodes */
    PetscCall(PetscSNPrintf(text, room, "%s %s %s", word,
                            (op->kind == MPM_REACT ? f->node_fields : f->particle_fields)[op->dst],
                            f->node_fields[op->src]));
  else {
    PetscCall(PetscSNPrintf(text, room, "%s %s %s", to[op->dst], op->accumulates ? "+=" : "=", factor));
    JoinWord(f, op, room, text);
    MpmTextJoin(text, from[op->src], room);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The text of the first of n operations. A field of particles that is set to 0 and added to is one line, p = v + G2P
   a_i.
*/
static PetscErrorCode SetText(const MpmFormulation *f, PetscInt n, const MpmOp ops[], size_t room, char text[],
                              PetscInt *used)
{
  const PetscBool sets = ops->kind == MPM_SCALE && ops->factor == 0 ? PETSC_TRUE : PETSC_FALSE;
  char            factor[64];

  PetscFunctionBegin;
  *used = 1;
  if (!sets || n == 1 || ops[1].kind != MPM_ADD || ops[1].dst != ops->dst) {
    PetscCall(MpmWrittenLineText(f, ops, room, text));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscSNPrintf(text, room, "%s =", f->particle_fields[ops->dst]));
  for (; *used < n; ++*used) {
    const MpmOp *op = &ops[*used];

    if (op->kind >= MPM_OP_KINDS || MpmOpTraitsOf(op->kind).dst != MPM_ON_PARTICLES || op->dst != ops->dst ||
        !op->accumulates)
      break;
    PetscCall(FactorText(op, sizeof factor, factor));
    MpmTextJoin(text, *used > 1 ? " + " : " ", room);
    MpmTextJoin(text, factor, room);
    JoinWord(f, op, room, text);
    MpmTextJoin(text, (op->kind == MPM_ADD ? f->particle_fields : f->node_fields)[op->src], room);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether an operation sets a scratch field. */
static PetscBool Begins(PetscInt n, const MpmOp ops[], PetscInt field)
{
  for (PetscInt o = 0; o < n; o++)
    if (ops[o].kind == MPM_SCALE && ops[o].dst == field) return PETSC_TRUE;
  return PETSC_FALSE;
}

static const char *WaveName(const MpmWave *wave)
{
  return wave == &MpmWaveFirstOrder ? "gas" : wave == &MpmWaveSecondOrder ? "bar" : "momentum";
}

PetscErrorCode MpmWrittenAddFormulation(const MpmFormulation *f, const MpmSchemeNumbers *numbers,
                                        const MpmTransfer *transfer, MpmWritten *w)
{
  MpmOp        room[MPM_MOST_TABLE_LINES];
  PetscInt     n;
  const MpmOp *ops = MpmFormulationLines(f, numbers, transfer, room, &n);
  PetscInt     used;

  PetscFunctionBegin;
  PetscCall(Keep(f->name, &w->name));
  PetscCall(Keep(f->summary, &w->summary));
  PetscCall(Keep(f->reference, &w->reference));
  for (PetscInt field = 0; f->particle_fields[field]; field++) {
    if (f->scratch[field] && !Begins(n, ops, field)) continue;
    PetscCall(Keep(f->particle_fields[field], &w->particles[w->nparticles].name));
    w->particles[w->nparticles++].rank = f->particle_ranks[field];
  }
  for (; f->node_fields[w->nnodes]; w->nnodes++) {
    PetscCall(Keep(f->node_fields[w->nnodes], &w->nodes[w->nnodes].name));
    w->nodes[w->nnodes].rank = f->node_ranks[w->nnodes];
  }
  for (PetscInt o = 0; o < n;) {
    char text[256];

    PetscCheck(w->nstep < MPM_MOST_LINES_OF_STEP, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MOST_LINES_OF_STEP");
    PetscCall(SetText(f, n - o, &ops[o], sizeof text, text, &used));
    PetscCall(Keep(text, &w->step[w->nstep++]));
    o += used;
  }
  for (; w->nenergy < f->nenergy; w->nenergy++) {
    const MpmEnergyTerm *term = &f->energy[w->nenergy];
    const PetscBool      node = term->place == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;

    PetscCall(Keep((node ? f->node_fields : f->particle_fields)[term->field], &w->energy[w->nenergy].field));
    PetscCall(Keep(node ? "difference" : term->stress ? "compliance" : "mass", &w->energy[w->nenergy].kind));
  }
  if (f->wave) PetscCall(Keep(WaveName(f->wave), &w->wave));
  if (f->staggered != MPM_NONE) PetscCall(Keep(f->particle_fields[f->staggered], &w->staggered));
  if (f->affine != MPM_NONE) PetscCall(Keep(f->particle_fields[f->affine], &w->affine));
  if (f->conserved != MPM_NONE) PetscCall(Keep(f->particle_fields[f->conserved], &w->conserved));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenFromFormulation(const MpmFormulation *f, const MpmSchemeNumbers *numbers,
                                         const MpmTransfer *transfer, MpmWritten **written)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(written));
  PetscCall(MpmWrittenAddFormulation(f, numbers, transfer, *written));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- from texts to YAML ---- */

/* In single quotes, in which YAML takes everything but the quote as it stands. */
static void PutQuoted(FILE *out, const char key[], const MpmWrittenText *text)
{
  if (!text->text) return;
  fprintf(out, "  %s: '", key);
  for (const char *at = text->text; *at; at++) fprintf(out, *at == '\'' ? "''" : "%c", *at);
  fprintf(out, "'\n");
}

static void PutPlain(FILE *out, const char key[], const MpmWrittenText *text)
{
  if (text->text) fprintf(out, "  %s: %s\n", key, text->text);
}

static void PutFields(FILE *out, const char key[], PetscInt n, const MpmWrittenField fields[])
{
  fprintf(out, "  %s: {", key);
  for (PetscInt i = 0; i < n; i++)
    fprintf(out, "%s%s: %s", i ? ", " : "", fields[i].name.text, MpmRankNames[fields[i].rank]);
  fprintf(out, "}\n");
}

static void PutNames(FILE *out, const char key[], PetscInt n, const MpmWrittenText names[])
{
  for (PetscInt i = 0; i < n; i++)
    fprintf(out, "%s%s%s%s", i ? "" : "    ", i ? "" : key, i ? ", " : ": [", names[i].text);
  if (n) fprintf(out, "]\n");
}

static void PutTransfer(FILE *out, const MpmWrittenTransfer *t)
{
  fprintf(out, "  transfer:\n    name: %s\n", t->name.text);
  PutNames(out, "particles", t->nparticles, t->particle);
  PutNames(out, "nodes", t->nnodes, t->node);
  fprintf(out, "    filter:\n");
  for (PetscInt i = 0; i < t->nlines; i++) fprintf(out, "      - %s\n", t->lines[i].text);
}

static void PutScheme(FILE *out, const MpmWritten *w)
{
  PutPlain(out, "name", &w->name);
  PutQuoted(out, "summary", &w->summary);
  PutQuoted(out, "reference", &w->reference);
  PutFields(out, "particles", w->nparticles, w->particles);
  PutFields(out, "nodes", w->nnodes, w->nodes);
  for (PetscInt i = 0; i < w->nparameters; i++)
    fprintf(out, "%s%s: %s%s", i ? ", " : "  parameters: {", w->parameters[i].name.text, w->parameters[i].text.text,
            i == w->nparameters - 1 ? "}\n" : "");
  fprintf(out, "  step:\n");
  for (PetscInt i = 0; i < w->nstep; i++) fprintf(out, "    - %s\n", w->step[i].text);
  for (PetscInt i = 0; i < w->nenergy; i++)
    fprintf(out, "%s%s: %s%s", i ? ", " : "  energy: {", w->energy[i].field.text, w->energy[i].kind.text,
            i == w->nenergy - 1 ? "}\n" : "");
  PutPlain(out, "wave", &w->wave);
  PutPlain(out, "staggered", &w->staggered);
  PutPlain(out, "affine", &w->affine);
  PutPlain(out, "conserved", &w->conserved);
}

static void Put(FILE *out, const MpmWritten *w)
{
  fprintf(out, "scheme:\n");
  if (w->nstep) PutScheme(out, w);
  if (w->transfer.name.text) PutTransfer(out, &w->transfer);
}

PetscErrorCode MpmWrittenYaml(const MpmWritten *w, char **yaml)
{
  char  *text = NULL;
  size_t size = 0;
  FILE  *out  = open_memstream(&text, &size);

  PetscFunctionBegin;
  PetscCheck(out, PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for the text of a scheme");
  Put(out, w);
  PetscCheck(!fclose(out), PETSC_COMM_SELF, PETSC_ERR_MEM, "no memory for the text of a scheme");
  PetscCall(PetscStrallocpy(text, yaml));
  free(text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the hash ---- */

static PetscBool IsInWord(char c)
{
  return isalnum((unsigned char)c) || c == '_' || c == '.' ? PETSC_TRUE : PETSC_FALSE;
}

static void Mix(uint64_t *hash, unsigned char c)
{
  *hash = MpmHashMix(*hash + MPM_HASH_INCREMENT + c);
}

/* Adds a text and its end. Of blanks those between two words count, as one. */
static void MixText(uint64_t *hash, const char text[])
{
  char last = 0;

  for (const char *at = text ? text : ""; *at; at++) {
    if (isspace((unsigned char)*at)) continue;
    if (at > text && isspace((unsigned char)at[-1]) && IsInWord(last) && IsInWord(*at)) Mix(hash, ' ');
    Mix(hash, (unsigned char)*at);
    last = *at;
  }
  Mix(hash, 0);
}

static void MixFields(uint64_t *hash, PetscInt n, const MpmWrittenField fields[])
{
  for (PetscInt i = 0; i < n; i++) {
    MixText(hash, fields[i].name.text);
    MixText(hash, MpmRankNames[fields[i].rank]);
  }
  Mix(hash, 1);
}

static void MixTransfer(uint64_t *hash, const MpmWrittenTransfer *t)
{
  for (PetscInt i = 0; i < t->nparticles; i++) MixText(hash, t->particle[i].text);
  Mix(hash, 1);
  for (PetscInt i = 0; i < t->nnodes; i++) MixText(hash, t->node[i].text);
  Mix(hash, 1);
  for (PetscInt i = 0; i < t->nlines; i++) MixText(hash, t->lines[i].text);
}

void MpmWrittenHash(const MpmWritten *w, char text[MPM_HASH_TEXT])
{
  uint64_t hash = 0;

  MixFields(&hash, w->nparticles, w->particles);
  MixFields(&hash, w->nnodes, w->nodes);
  for (PetscInt i = 0; i < w->nparameters; i++) {
    MixText(&hash, w->parameters[i].name.text);
    MixText(&hash, w->parameters[i].text.text);
  }
  Mix(&hash, 1);
  for (PetscInt i = 0; i < w->nstep; i++) MixText(&hash, w->step[i].text);
  Mix(&hash, 1);
  for (PetscInt i = 0; i < w->nenergy; i++) {
    MixText(&hash, w->energy[i].field.text);
    MixText(&hash, w->energy[i].kind.text);
  }
  MixText(&hash, w->wave.text);
  MixText(&hash, w->staggered.text);
  MixText(&hash, w->affine.text);
  MixText(&hash, w->conserved.text);
  if (w->transfer.name.text) MixTransfer(&hash, &w->transfer);
  (void)snprintf(text, MPM_HASH_TEXT, "%016llx", (unsigned long long)hash);
}

PetscErrorCode MpmWrittenParametersText(const MpmWritten *w, char text[MPM_PARAMETERS_TEXT])
{
  PetscReal numbers[MPM_MOST_PARAMETERS];

  PetscFunctionBegin;
  text[0] = 0;
  PetscCall(MpmWrittenNumbers(w, numbers));
  for (PetscInt i = 0; i < w->nparameters; i++)
    (void)snprintf(text + strlen(text), MPM_PARAMETERS_TEXT - strlen(text), "%s%s=%.17g", i ? "," : "",
                   w->parameters[i].name.text, numbers[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
