/* The comparison of a code with a scheme of our own. */
#include "report/report_program.h"
#include <math.h>

#define ROWS 12 /* of the table; JSON has all */

/* The field of the other side that goes with a field of ours, and the factor of its first component. */
static const MpmMatchField *Partner(const MpmCompareProgram *c, PetscInt f)
{
  const PetscInt       number = c->match->number[c->own.fields[f].first];
  const MpmMatchField *g      = c->theirs.fields;

  while (number >= g->first + g->size) g++;
  return g;
}

static void Fields(json_t *result, const MpmCompareProgram *c)
{
  MpmPrint("fields:");
  for (PetscInt f = 0; f < c->own.nfields; f++)
    MpmResultSay(MpmResultNext(result, "fields"), "%s yours %s{yours} = %.6g{factor} x ours %s{ours}", f ? ";" : "",
                 Partner(c, f)->name, (double)c->match->factor[c->own.fields[f].first], c->own.fields[f].name);
  MpmPrint(" (yours in units of their scales; only ratios of these factors mean something)\n");
}

static void Differences(json_t *result, const MpmCompareProgram *c)
{
  const MpmMatch *m = c->match;

  for (PetscInt i = 0; i < m->n; i++) {
    const MpmDifference *e    = &m->differences[i];
    json_t              *each = MpmResultNext(result, "differences");

    for (PetscInt a = 0; a < c->blocks.dim; a++)
      (void)json_array_append_new(MpmResultList(each, "d"), json_integer(e->d[a]));
    MpmResultKeep(each, "%s{to} %s{from} %g{ours} %g{yours} %g{difference}", c->own.fields[e->to].name,
                  c->own.fields[e->from].name, e->one, e->other, e->differ);
  }
  if (!m->n) return;
  MpmPrint("  %-10s %-22s %-13s %-13s %s\n", "cell", "gives", "ours", "yours", "difference");
  for (PetscInt i = 0; i < PetscMin(m->n, ROWS); i++) {
    const MpmDifference *e               = &m->differences[i];
    PetscReal            at[MPM_MAX_DIM] = {-e->d[0], -e->d[1], -e->d[2]};
    char                 gives[160];

    (void)snprintf(gives, sizeof gives, "%s to %s", c->own.fields[e->from].name, c->own.fields[e->to].name);
    MpmPrint("  %-10s %-22s %-13.6g %-13.6g %.2g\n", MpmVectorText(c->blocks.dim, at, 3, MPM_VECTOR_ROOM), gives,
             (double)e->one, (double)e->other, (double)e->differ);
  }
  if (m->n > ROWS) MpmPrint("  and %" PetscInt_FMT " more\n", m->n - ROWS);
}

/* The pairs of fields that differ, each once, the most first. */
static void PrintVerdict(const MpmCompareProgram *c)
{
  const MpmMatch *m       = c->match;
  const char     *between = "";

  if (c->same && m->fits) {
    MpmPrint("compare: the same to %.1e\n", (double)m->differ);
    return;
  }
  if (!m->fits) {
    MpmPrint("the numbers of a particle do not go with one another: %s\n", m->why_not);
    if (c->same)
      MpmPrint("compare: amplification factors are the same to %.1e\n", (double)m->factors);
    else
      MpmPrint("compare: differs in amplification factors, by up to %.2g\n", (double)m->factors);
    return;
  }
  MpmPrint("compare: differs in ");
  for (PetscInt i = 0; i < m->n; i++) {
    const MpmDifference *e    = &m->differences[i];
    PetscBool            said = PETSC_FALSE;

    for (PetscInt j = 0; j < i; j++)
      if (m->differences[j].to == e->to && m->differences[j].from == e->from) said = PETSC_TRUE;
    if (said) continue;
    MpmPrint("%s%s from %s (by %.2g)", between, c->own.fields[e->to].name, c->own.fields[e->from].name,
             (double)e->differ);
    between = ", ";
  }
  MpmPrint("\n");
  if (m->factors <= c->bound)
    MpmPrint(
        "its amplification factors are the same, though: it may be that step with its numbers kept in another form\n");
}

void MpmReportCompare(json_t *result, const MpmProgram *p, const MpmCompareProgram *c)
{
  const MpmScene *s = c->scene;
  const MpmMatch *m = c->match;

  MpmResultKeep(result, "%d{same?} %g{bound} %g{growth} %g{code_growth}", c->same, c->bound, c->growth, c->code);
  MpmPrint("\ncompared with ours: %s\n", p->request->compare);
  MpmResultSay(result,
               "%s{formulation}, %s{basis} basis, %s{transfer} transfer, %s particles in a cell, Courant number "
               "%.6g{courant}\n",
               s->scheme.formulation->name, s->scheme.basis->name, s->scheme.transfer->name,
               MpmCountsText(s->layout.dim, s->layout.ppc, MPM_VECTOR_ROOM), (double)s->step.courant);
  if (m->fits) {
    MpmResultKeep(result, "%g{difference}", m->differ);
    (void)MpmResultList(result, "fields");
    (void)MpmResultList(result, "differences");
    Fields(result, c);
  } else
    MpmResultKeep(result, "%s{why_not}", m->why_not);
  Differences(result, c);
  MpmResultSay(result, "amplification factors of 8 waves: apart by at most %.1e{factors_difference}",
               (double)m->factors);
  for (int side = 0; side < 2; side++)
    if (m->more[side])
      MpmPrint("; %s has %" PetscInt_FMT " more a cell, of abs up to %.6g", side ? "yours" : "ours", m->more[side],
               (double)m->most);
  MpmPrint("\ngrowth over all waves: yours %.9g, ours %.9g\n", (double)c->code, (double)c->growth);
  PrintVerdict(c);
  (void)MpmResultList(result, "same_as");
  for (PetscInt i = 0; i < c->nsame; i++) {
    MpmPrint("%s %s\n", i ? "  and of" : "it is the step of", c->same_as[i]);
    (void)json_array_append_new(MpmResultList(result, "same_as"), json_string(c->same_as[i]));
  }
  if (!c->same && !c->nsame) MpmPrint("it is the step of no scheme of ours with these cells and this Courant number\n");
}
