/* The comparison of a code with a scheme of our own. */
#include "report/report_compare.h"
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

static void PrintFields(const MpmCompareProgram *c)
{
  MpmPrint("fields:");
  for (PetscInt f = 0; f < c->own.nfields; f++)
    MpmPrint("%s yours %s = %.6g x ours %s", f ? ";" : "", Partner(c, f)->name,
             (double)c->match->factor[c->own.fields[f].first], c->own.fields[f].name);
  MpmPrint(" (yours in units of their scales; only ratios of these factors mean something)\n");
}

static void PrintDifferences(const MpmCompareProgram *c)
{
  const MpmMatch *m = c->match;

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

void MpmReportCompare(const MpmProgram *p, const MpmCompareProgram *c)
{
  const MpmScene *s = c->scene;

  MpmPrint("\ncompared with ours: %s\n", p->request->compare);
  MpmPrint("%s, %s basis, %s transfer, %s particles in a cell, Courant number %.6g\n", s->scheme.formulation->name,
           s->scheme.basis->name, s->scheme.transfer->name,
           MpmCountsText(s->layout.dim, s->layout.ppc, MPM_VECTOR_ROOM), (double)s->step.courant);
  if (c->match->fits) PrintFields(c);
  PrintDifferences(c);
  MpmPrint("amplification factors of 8 waves: apart by at most %.1e", (double)c->match->factors);
  for (int side = 0; side < 2; side++)
    if (c->match->more[side])
      MpmPrint("; %s has %" PetscInt_FMT " more a cell, of abs up to %.6g", side ? "yours" : "ours",
               c->match->more[side], (double)c->match->most);
  MpmPrint("\ngrowth over all waves: yours %.9g, ours %.9g\n", (double)c->code, (double)c->growth);
  PrintVerdict(c);
  for (PetscInt i = 0; i < c->nsame; i++) MpmPrint("%s %s\n", i ? "  and of" : "it is the step of", c->same_as[i]);
  if (!c->same && !c->nsame) MpmPrint("it is the step of no scheme of ours with these cells and this Courant number\n");
}

static json_t *JsonDifferences(const MpmCompareProgram *c)
{
  json_t *list = json_array();

  for (PetscInt i = 0; i < c->match->n; i++) {
    const MpmDifference *e = &c->match->differences[i];
    json_t              *d = json_array();

    for (PetscInt a = 0; a < c->blocks.dim; a++) json_array_append_new(d, json_integer(e->d[a]));
    json_array_append_new(list, json_pack("{s:o, s:s, s:s, s:f, s:f, s:f}", "d", d, "to", c->own.fields[e->to].name,
                                          "from", c->own.fields[e->from].name, "ours", e->one, "yours", e->other,
                                          "difference", e->differ));
  }
  return list;
}

json_t *MpmJsonCompare(const MpmCompareProgram *c)
{
  json_t *object = json_object(), *fields = json_array(), *same = json_array();

  for (PetscInt i = 0; i < c->nsame; i++) json_array_append_new(same, json_string(c->same_as[i]));
  json_object_set_new(object, "same_as", same);

  json_object_set_new(object, "same", json_boolean(c->same));
  MpmJsonSetText(object, "formulation", c->scene->scheme.formulation->name);
  MpmJsonSetText(object, "transfer", c->scene->scheme.transfer->name);
  MpmJsonSetText(object, "basis", c->scene->scheme.basis->name);
  MpmJsonSet(object, "courant", c->scene->step.courant);
  MpmJsonSet(object, "bound", c->bound);
  MpmJsonSet(object, "growth", c->growth);
  MpmJsonSet(object, "code_growth", c->code);
  MpmJsonSet(object, "factors_difference", c->match->factors);
  if (c->match->fits) {
    MpmJsonSet(object, "difference", c->match->differ);
    for (PetscInt f = 0; f < c->own.nfields; f++)
      json_array_append_new(fields, json_pack("{s:s, s:s, s:f}", "ours", c->own.fields[f].name, "yours",
                                              Partner(c, f)->name, "factor", c->match->factor[c->own.fields[f].first]));
    json_object_set(object, "fields", fields);
    json_object_set_new(object, "differences", JsonDifferences(c));
  } else
    MpmJsonSetText(object, "why_not", c->match->why_not);
  json_decref(fields);
  return object;
}
