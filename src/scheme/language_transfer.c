/*
   A transfer as text: its filter as lines, which become operations on registers of its own. Each component of a
   filtered field goes through them by itself, so there are no vectors here, and no DIV, GRAD or LAP.

   q is the particle field that is filtered, and g its P2G on the nodes. Other fields are named under particles and
   nodes.
*/
#include "scheme/language_compile.h"
#include <mpmstab/errors.h>
#include <mpmstab/table.h>

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
  static char               q[] = "q", g[] = "g";

  *filter              = *written;
  filter->nparticles   = 1 + t->nparticles;
  filter->nnodes       = 1 + t->nnodes;
  filter->nstep        = t->nlines;
  filter->particles[0] = (MpmWrittenField){{q, line}, MPM_SCALAR};
  filter->nodes[0]     = (MpmWrittenField){{g, line}, MPM_SCALAR};
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
  if (line->op != MPM_LINE_SETS && line->op != MPM_IMPOSE)
    MpmRefuseLine(w, text, "this stands in the step; allowed in a filter: lines that set a field, and IMPOSE");
  if ((line->op == MPM_IMPOSE || line->place == MPM_ON_NODES) && line->field == 0)
    MpmRefuseLine(w, text, "g belongs to the step, which reads it later; allowed: to set a field of 'nodes'");
  if (line->op == MPM_LINE_SETS && other && line->adds)
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
