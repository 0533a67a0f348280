/*
   A transfer as text: its filter as lines, which become operations on registers of its own. Each component of a
   filtered field goes through them by itself, so there are no vectors here, and no DIV, GRAD or LAP.

   q is the particle field that is filtered, and g its P2G on the nodes. Other fields are named under particles and
   nodes.
*/
#include "scheme/language_compile.h"
#include "base/text.h"
#include <mpmstab/errors.h>
#include <mpmstab/table.h>
#include <stdio.h>
#include <string.h>

static char filtered_name[] = "q", nodal_name[] = "g";

/* ---- in a table ---- */

/* Puts the operations in the place of FILTER: register 0 is the particle's and the node's, the others are new. */
static PetscErrorCode Lines(MpmTable *table, const MpmSchemeNumbers *numbers, PetscInt particle, PetscInt node)
{
  const MpmTransfer *t                           = table->transfer;
  PetscInt           particle_of[MPM_MAX_FIELDS] = {particle}, node_of[MPM_MAX_FIELDS] = {node};

  PetscFunctionBegin;
  (void)numbers;
  for (PetscInt p = 1; p < t->nparticles; p++) PetscCall(MpmTableScratch(table, &particle_of[p]));
  for (PetscInt n = 1; n < t->nnodes; n++) PetscCall(MpmTableNode(table, node, &node_of[n]));
  for (PetscInt l = 0; l < t->nlines; l++) {
    MpmOp       op     = t->lines[l];
    MpmOpTraits traits = {.dst = MPM_ON_NODES};

    if (op.kind == MPM_IMPOSE) {
      PetscCall(MpmTableImpose(table, node_of[op.dst]));
      continue;
    }
    traits = MpmOpTraitsOf(op.kind);
    op.dst = (traits.dst == MPM_ON_NODES ? node_of : particle_of)[op.dst];
    op.src = (traits.src == MPM_ON_NODES ? node_of : particle_of)[op.src];
    PetscCall(MpmTableAppend(table, op));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- from text ---- */

/* The text of the filter as a scheme: its fields are numbers, and its lines are the step. */
static void FilterText(const MpmWritten *written, MpmWritten *filter)
{
  const MpmWrittenTransfer *t    = &written->transfer;
  const int                 line = t->name.line;

  *filter              = *written;
  filter->nparticles   = 1 + t->nparticles;
  filter->nnodes       = 1 + t->nnodes;
  filter->nstep        = t->nlines;
  filter->particles[0] = (MpmWrittenField){{filtered_name, line}, MPM_SCALAR};
  filter->nodes[0]     = (MpmWrittenField){{nodal_name, line}, MPM_SCALAR};
  for (PetscInt p = 0; p < t->nparticles; p++) filter->particles[1 + p] = (MpmWrittenField){t->particle[p], MPM_SCALAR};
  for (PetscInt n = 0; n < t->nnodes; n++) filter->nodes[1 + n] = (MpmWrittenField){t->node[n], MPM_SCALAR};
  for (PetscInt l = 0; l < t->nlines; l++) filter->step[l] = t->lines[l];
}

/*
   What a filter may not do. fresh: the particle field other than q that the line before has set, or MPM_NONE. The march
   keeps such a field only until it has gone to the nodes.
*/
static PetscErrorCode CheckLine(const MpmCompiler *c, const MpmWrittenLine *line, PetscInt fresh)
{
  const MpmWritten     *w     = c->written;
  const MpmWrittenText *text  = c->text;
  const PetscBool       other = line->place == MPM_ON_PARTICLES && line->field > 0 ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (line->kind != MPM_LINE_SET && line->kind != MPM_LINE_IMPOSE)
    MpmRefuseLine(w, text, "this stands in the step; allowed in a filter: lines that set a field, and IMPOSE");
  if ((line->kind == MPM_LINE_IMPOSE || line->place == MPM_ON_NODES) && line->field == 0)
    MpmRefuseLine(w, text, "g belongs to the step, which reads it later; allowed: to set a field of 'nodes'");
  if (line->kind == MPM_LINE_SET && other && line->adds)
    MpmRefuseLine(w, text, "allowed for a field of particles other than q: field = ...");
  for (PetscInt t = 0; t < line->nterms; t++) {
    const MpmTerm *term = &line->term[t];

    if (term->kind == MPM_DIV || term->kind == MPM_GRAD || term->kind == MPM_LAP)
      MpmRefuseLine(w, text, "a filter acts on each component by itself; allowed: P2G, G2P and SOLVE");
    if (term->place == MPM_ON_PARTICLES && term->field > 0 && (term->kind != MPM_P2G || term->field != fresh))
      MpmRefuseLine(w, text, "%s lasts until it has gone to the nodes; allowed: P2G %s in the line after '%s = ...'",
                    w->particles[term->field].name.text, w->particles[term->field].name.text,
                    w->particles[term->field].name.text);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckUse(const MpmCompiler *c, PetscBool sets)
{
  const MpmWritten *w = c->written;

  PetscFunctionBegin;
  if (!sets) MpmRefuseLine(w, &w->transfer.name, "no line of its filter sets q; allowed: a filter with 'q = ...'");
  for (PetscInt p = 1; p < w->nparticles; p++)
    if (!c->particle_read[p]) MpmRefuseLine(w, &w->particles[p].name, "nothing reads this field; allowed: without it");
  for (PetscInt n = 1; n < w->nnodes; n++) {
    if (!c->written_to[n]) MpmRefuseLine(w, &w->nodes[n].name, "no line sets this field; allowed: without it");
    if (!c->node_read[n]) MpmRefuseLine(w, &w->nodes[n].name, "nothing reads this field; allowed: without it");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CompileLines(MpmCompiler *c, const PetscReal numbers[])
{
  const MpmWritten *w     = c->written;
  PetscInt          fresh = MPM_NONE;
  PetscBool         sets  = PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MpmCompilerBegin(c));
  c->has_mass = c->written_to[0] = PETSC_TRUE;
  c->holds[0]                    = 0;
  for (PetscInt l = 0; l < w->nstep; l++) {
    MpmWrittenLine line;

    c->text = &w->step[l];
    PetscCall(MpmLineRead(w, numbers, c->text, &line));
    PetscCall(CheckLine(c, &line, fresh));
    fresh = line.place == MPM_ON_PARTICLES && line.field > 0 ? line.field : MPM_NONE;
    if (line.place == MPM_ON_PARTICLES && line.field == 0) sets = PETSC_TRUE;
    PetscCall(MpmCompileLine(c, &line));
  }
  PetscCall(CheckUse(c, sets));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenCompileTransfer(const MpmWritten *written, const PetscReal numbers[], MpmTransfer **transfer)
{
  MpmWritten    *filter;
  MpmCompiler   *c;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  PetscCall(PetscNew(transfer));
  PetscCall(PetscNew(&filter));
  PetscCall(PetscNew(&c));
  PetscCall(PetscNew(&c->f));
  FilterText(written, filter);
  c->written = filter;
  ierr       = CompileLines(c, numbers);
  **transfer = (MpmTransfer){.name       = written->transfer.name.text,
                             .summary    = "a transfer as text",
                             .reference  = "",
                             .filter     = Lines,
                             .nlines     = c->nops,
                             .lines      = c->ops,
                             .nparticles = filter->nparticles,
                             .nnodes     = c->nnodes};
  PetscCall(PetscFree(c->f));
  PetscCall(PetscFree(c));
  PetscCall(PetscFree(filter));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmWrittenTransferDestroy(MpmTransfer **transfer)
{
  PetscFunctionBegin;
  if (*transfer) PetscCall(PetscFree((*transfer)->lines));
  PetscCall(PetscFree(*transfer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- to text ---- */

/* The name of register i > 0 of those that a filter needs besides q and g. */
static PetscErrorCode Name(const char letter[], PetscInt i, MpmWrittenText *name)
{
  char text[16];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(text, sizeof text, "%s%" PetscInt_FMT, letter, i));
  PetscCall(PetscStrallocpy(text, &name->text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode KeepLine(MpmWrittenTransfer *t, const char text[])
{
  PetscFunctionBegin;
  MpmCheckInput(t->nlines < MPM_MOST_LINES_OF_FILTER,
                "a filter of more than the %d lines that fit; allowed: fewer terms of xpic", MPM_MOST_LINES_OF_FILTER);
  PetscCall(PetscStrallocpy(text, &t->lines[t->nlines++].text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What particles keep of a field and what they then take from nodes is one line: q = ratio q + ... G2P g. */
static PetscErrorCode KeepScaled(const MpmFormulation *f, const MpmOp *scale, const MpmOp *more, MpmWrittenTransfer *t)
{
  char text[128], taken[128];

  PetscFunctionBegin;
  PetscCall(MpmWrittenLineText(f, scale, sizeof text, text));
  PetscCall(MpmWrittenLineText(f, more, sizeof taken, taken));
  if (scale->factor == 0)
    (void)snprintf(text, sizeof text, "%s = ", f->particle_fields[scale->dst]);
  else
    MpmTextJoin(text, " + ", sizeof text);
  MpmTextJoin(text, strstr(taken, "+= ") + 3, sizeof text);
  PetscCall(KeepLine(t, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A wall of the table, one operation at each end, is IMPOSE in the text. */
static PetscErrorCode LinesOf(const MpmTable *table, MpmWritten *w)
{
  MpmWrittenTransfer *t = &w->transfer;
  MpmFormulation      f = {.particle_fields = {filtered_name}, .node_fields = {nodal_name}};
  char                text[128];

  PetscFunctionBegin;
  for (PetscInt p = 1; p < table->nparticles; p++) {
    PetscCall(Name("p", p, &t->particle[t->nparticles++]));
    f.particle_fields[p] = t->particle[p - 1].text;
  }
  for (PetscInt n = 1; n < table->nnodes; n++) {
    PetscCall(Name("g", n, &t->node[t->nnodes++]));
    f.node_fields[n] = t->node[n - 1].text;
  }
  for (PetscInt o = 0; o < table->nops; o++) {
    MpmOp           op   = table->ops[o];
    const MpmOp    *next = &table->ops[o + 1];
    const PetscBool joins =
        op.kind == MPM_SCALE && o + 1 < table->nops && next->kind == MPM_G2P && next->dst == op.dst && next->factor > 0
            ? PETSC_TRUE
            : PETSC_FALSE;

    if (joins) {
      PetscCall(KeepScaled(&f, &op, next, t));
      o++;
      continue;
    }
    if (op.kind == MPM_WALL && op.side) continue;
    if (op.kind == MPM_WALL) op = (MpmOp)IMPOSE(op.dst);
    PetscCall(MpmWrittenLineText(&f, &op, sizeof text, text));
    PetscCall(KeepLine(t, text));
  }
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
  PetscCall(PetscStrallocpy(name, &(*written)->transfer.name.text));
  PetscCall(PetscNew(&table));
  table->dim    = 1;
  table->affine = MPM_NONE;
  table->nstate = table->nparticles = table->nnodes = 1;
  table->transfer                                   = transfer;
  table->ends[0][0] = table->ends[0][1] = MPM_FIXED;
  table->parity[0][0]                   = MPM_NORMAL;
  ierr                                  = transfer->filter(table, numbers, 0, 0);
  if (!ierr) ierr = LinesOf(table, *written);
  PetscCall(MpmTableDestroy(&table));
  if (ierr) PetscCall(MpmWrittenDestroy(written));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}
