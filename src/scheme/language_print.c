/* From formulations and transfers of the program to their texts. */
#include "base/text.h"
#include "scheme/language_compile.h"
#include <mpmstab/errors.h>
#include <mpmstab/table.h>
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

/* The line that says an operation on fields. */
static PetscErrorCode LineText(const MpmFormulation *f, const MpmOp *op, size_t room, char text[])
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
   The text of the first of n operations, and how many it is of. A field of particles that is multiplied and then added
   to is one line, p = v + G2P a_i.
*/
static PetscErrorCode SetText(const MpmFormulation *f, PetscInt n, const MpmOp ops[], size_t room, char text[],
                              PetscInt *used)
{
  const PetscBool sets = ops->kind == MPM_SCALE && n > 1 && ops[1].dst == ops->dst ? PETSC_TRUE : PETSC_FALSE;
  char            factor[64];

  PetscFunctionBegin;
  *used = 1;
  if (!sets || ops->factor != 0 || (ops[1].kind != MPM_ADD && ops[1].kind != MPM_G2P))
    PetscCall(LineText(f, ops, room, text));
  else
    PetscCall(PetscSNPrintf(text, room, "%s =", f->particle_fields[ops->dst]));
  if (!sets || !(ops[1].kind == MPM_G2P ? ops[1].factor > 0 : ops[1].kind == MPM_ADD && ops->factor == 0))
    PetscFunctionReturn(PETSC_SUCCESS);
  for (; *used < n; ++*used) {
    const MpmOp *op = &ops[*used];

    if (op->kind >= MPM_OP_KINDS || MpmOpTraitsOf(op->kind).dst != MPM_ON_PARTICLES || op->dst != ops->dst ||
        !op->accumulates)
      break;
    PetscCall(FactorText(op, sizeof factor, factor));
    MpmTextJoin(text, *used > 1 || ops->factor != 0 ? " + " : " ", room);
    MpmTextJoin(text, factor, room);
    JoinWord(f, op, room, text);
    MpmTextJoin(text, (op->kind == MPM_ADD ? f->particle_fields : f->node_fields)[op->src], room);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The lines of n operations. Those of formulations fit. */
static PetscErrorCode LinesOf(const MpmFormulation *f, PetscInt n, const MpmOp ops[], PetscInt most, PetscInt *nlines,
                              MpmWrittenText lines[])
{
  PetscFunctionBegin;
  for (PetscInt o = 0, used; o < n; o += used) {
    char text[256];

    MpmCheckInput(*nlines < most,
                  "a filter of more than the %" PetscInt_FMT " lines that fit; allowed: fewer terms of xpic", most);
    PetscCall(SetText(f, n - o, &ops[o], sizeof text, text, &used));
    PetscCall(Keep(text, &lines[(*nlines)++]));
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
  PetscCall(LinesOf(f, n, ops, MPM_MOST_LINES_OF_STEP, &w->nstep, w->step));
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

/* ---- from a transfer to texts ---- */

/* The names of registers i > 0 of those that a filter needs besides q and g. */
static PetscErrorCode Names(const char letter[], PetscInt n, const char *fields[], PetscInt *nnames,
                            MpmWrittenText names[])
{
  PetscFunctionBegin;
  for (PetscInt i = 1; i < n; i++) {
    char text[16];

    PetscCall(PetscSNPrintf(text, sizeof text, "%s%" PetscInt_FMT, letter, i));
    PetscCall(Keep(text, &names[*nnames]));
    fields[i] = names[(*nnames)++].text;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A wall of the table, one operation at each end, is IMPOSE in the text. */
static PetscErrorCode FilterText(MpmTable *table, MpmWrittenTransfer *t)
{
  MpmFormulation f = {.particle_fields = {"q"}, .node_fields = {"g"}};
  PetscInt       n = 0;

  PetscFunctionBegin;
  PetscCall(Names("p", table->nparticles, f.particle_fields, &t->nparticles, t->particle));
  PetscCall(Names("g", table->nnodes, f.node_fields, &t->nnodes, t->node));
  for (PetscInt o = 0; o < table->nops; o++) {
    const MpmOp op = table->ops[o];

    if (op.kind != MPM_WALL || !op.side) table->ops[n++] = op.kind == MPM_WALL ? (MpmOp)IMPOSE(op.dst) : op;
  }
  PetscCall(LinesOf(&f, n, table->ops, MPM_MOST_LINES_OF_FILTER, &t->nlines, t->lines));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenFromTransfer(const MpmTransfer *transfer, const MpmSchemeNumbers *numbers,
                                      MpmWritten **written)
{
  MpmTable      *table;
  char           name[64];
  PetscErrorCode ierr;

  PetscFunctionBegin;
  MpmCheckInput(transfer->filter && !transfer->affine && !transfer->sharpen, "transfer %s: %s; allowed: %s",
                transfer->name,
                !transfer->filter  ? "it has no filter to print"
                : transfer->affine ? "its particles have an affine part, of which a filter as text knows nothing"
                                   : "it changes what particles take by GRAD too, which a filter does not",
                "pic, blend, xpic or nullspace");
  PetscCall(PetscNew(written));
  PetscCall(PetscSNPrintf(name, sizeof name, "my-%s", transfer->name));
  PetscCall(Keep(name, &(*written)->transfer.name));
  PetscCall(PetscNew(&table));
  table->dim    = 1;
  table->affine = MPM_NONE;
  table->nstate = table->nparticles = table->nnodes = 1;
  table->transfer                                   = transfer;
  table->ends[0][0] = table->ends[0][1] = MPM_FIXED;
  table->parity[0][0]                   = MPM_NORMAL;
  ierr                                  = transfer->filter(table, numbers, 0, 0);
  if (!ierr) ierr = FilterText(table, &(*written)->transfer);
  PetscCall(MpmTableDestroy(&table));
  if (ierr) PetscCall(MpmWrittenDestroy(written));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}
