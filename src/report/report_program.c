/* A code that was probed: how, its certificates, what it was measured or compared to be, and its limits. */
#include "report/report_program.h"
#include <math.h>
#include <string.h>

void MpmReportCertificates(json_t *result, const MpmCertificates *of)
{
  json_t *certificates = MpmResultIn(result, "certificates");

  (void)MpmResultList(result, "scales");
  MpmPrint("\ncertificates\n");
  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++) {
    json_t *its;

    if (isnan(of->value[c])) continue;
    its = MpmResultIn(certificates, MpmCertificateNames[c]);
    MpmResultSay(its, "  %-12s%-9.2g{value!} %-9s %s\n", MpmCertificateNames[c], (double)of->value[c],
                 MpmCertificateFails(of, c) ? "FAILS" : "holds", MpmCertificateTexts[c]);
    MpmResultKeep(its, "%g{bound} %d{holds?}", of->bound[c], !MpmCertificateFails(of, c));
    if (MpmCertificateFails(of, c)) MpmPrint("  %-12s%s\n", "", MpmCertificateFaults[c]);
    if (MpmCertificateFails(of, c)) MpmResultKeep(its, "%s{cure}", MpmCertificateCure(of, c));
  }
  if (MpmCertificatesCure(of))
    MpmResultSay(result, "  what can be done: %s{what_can_be_done}\n", MpmCertificatesCure(of));
  for (MpmCertificate c = MpmCertificatesFault(of); c < MPM_CERTIFICATES; c++)
    if (MpmCertificateFails(of, c) && strcmp(MpmCertificateCure(of, c), MpmCertificatesCure(of)))
      MpmPrint("  for %s to hold: %s\n", MpmCertificateNames[c], MpmCertificateCure(of, c));
  if (of->nfields) MpmPrint("  relative to the fields' scales:");
  for (PetscInt f = 0; f < of->nfields; f++) {
    const MpmFieldScale *field = &of->field[f];
    json_t              *scale = MpmResultNext(result, "scales");

    MpmResultSay(scale, "%s %s{field} %.6g{scale} (%s)", f ? "," : "", field->name, (double)field->scale,
                 strcmp(field->from, "cell_width") ? field->from : "the width of a cell");
    MpmResultKeep(scale, "%s{from}", field->from);
  }
  if (of->nfields) MpmPrint("\n");
}

/* ---- the code ---- */

static void PrintMatrixFree(const MpmProgram *p)
{
  const MpmStepper *s     = p->stepper;
  const char       *since = s->place == MPM_NONE && !s->cell ? ", since particles do not say where they are"
                            : p->colours.everywhere          ? ", since a step reaches the whole domain"
                                                             : "";

  if (p->shell)
    MpmPrint(
        "probing: matrix_free%s; a product with the operator is two calls, and those eigenvalues of largest magnitude "
        "that converge are found",
        since);
  else
    MpmPrint("probing: matrix_free%s; the %" PetscInt_FMT " columns are probed one by one", since, p->columns);
}

void MpmReportProgram(const MpmProgram *p)
{
  const MpmStepper *s   = p->stepper;
  const PetscBool   map = strcmp(p->request->task, "map") ? PETSC_FALSE : PETSC_TRUE; /* goes over many values */

  MpmReportFile(p->request, s->name);
  MpmPrint("%" PetscInt64_FMT " particles with %" PetscInt_FMT " numbers each, in %" PetscInt_FMT
           " direction%s, cells of %.6g; ",
           s->particles, s->width, s->dim, s->dim == 1 ? "" : "s", (double)s->cell_width);
  for (PetscInt i = 0; i < s->nparameters; i++)
    MpmPrint("%s = %.6g%s", s->parameters[i].name, (double)(map ? s->parameters[i].value : s->parameters[i].now),
             i + 1 < s->nparameters ? ", " : "\n");
  if (!s->nparameters) MpmPrint("it names no parameters\n");
  if (p->kind == MPM_PROBE_BLOCH) {
    MpmPrint("probing: bloch, since the %s cells are alike; the unknowns of one cell are %" PetscInt_FMT,
             MpmCountsText(s->dim, p->lattice.cells, MPM_VECTOR_ROOM), p->columns);
  } else if (p->kind == MPM_PROBE_MATRIX_FREE) {
    PrintMatrixFree(p);
  } else {
    MpmPrint("probing: coloured%s%s; a step reaches %s cells, so that unknowns have %" PetscInt_FMT " colours",
             p->why[0] ? ", since " : "", p->why, MpmCountsText(s->dim, p->colours.reach, MPM_VECTOR_ROOM), p->columns);
  }
  if (s->changes)
    MpmPrint("\n  steps of the code change with their number, and repeat after %" PetscInt_FMT
             ", which are probed together",
             s->steps);
  if (p->columns)
    MpmPrint("\n  cost: %" PetscInt_FMT " calls of %" PetscInt_FMT
             " step%s (forward and backward, with two sizes), and about 60 for "
             "certificates\n",
             4 * p->columns, p->probe.steps, p->probe.steps == 1 ? "" : "s");
  else
    MpmPrint("\n  cost: two calls of %" PetscInt_FMT " step%s for each product, and about 70 for certificates\n",
             p->probe.steps, p->probe.steps == 1 ? "" : "s");
  MpmPrint("  sizes of perturbations: %.3g and %.3g of each field's scale; the code computes in %s precision\n",
           (double)p->probe.size, (double)p->probe.other, p->probe.single ? "single" : "double");
}

/* Names the number of a particle that shows most that a certificate fails, with its place. */
static void PrintMost(const MpmStepper *s, MpmCertificate c, PetscInt64 unknown)
{
  const PetscReal *at;
  PetscInt         f = 0;

  if (unknown == MPM_NONE) return;
  while (f + 1 < s->nfields && s->fields[f + 1].first <= unknown % s->width) f++;
  MpmPrint("%s fails most at %s of particle %" PetscInt64_FMT, MpmCertificateNames[c], s->fields[f].name,
           unknown / s->width);
  at = MpmStepperPlace(s, unknown / s->width);
  if (at) MpmPrint(", which is at %s", MpmVectorText(s->dim, at, 6, MPM_VECTOR_ROOM));
  MpmPrint("\n");
}

/* Names the numbers of particles that are set apart, field by field. */
static void Apart(const MpmProgram *p)
{
  const MpmStepper *s       = p->stepper;
  const char       *between = "";

  if (p->unread.n == s->width) return;
  MpmPrint("set apart, since nothing reads them back (they hold the eigenvalue %.6g): ", (double)p->unread.factor);
  for (PetscInt f = 0; f < s->nfields; f++) {
    PetscInt apart = 0;

    for (PetscInt c = 0; c < s->fields[f].size; c++) apart += p->unread.apart[s->fields[f].first + c];
    if (!apart) continue;
    MpmPrint("%s%s", between, s->fields[f].name);
    if (apart < s->fields[f].size) MpmPrint(" (%" PetscInt_FMT " of %" PetscInt_FMT ")", apart, s->fields[f].size);
    between = ", ";
  }
  MpmPrint("\n");
}

void MpmReportProbed(json_t *result, const MpmProgram *p)
{
  const MpmStepper *s  = p->stepper;
  json_t           *in = MpmResultIn(result, "probing");

  MpmResultKeep(in, "%s{name} %s{probing} %" PetscInt64_FMT "{particles} %" PetscInt_FMT "{numbers}", s->name,
                MpmProbeNames[p->kind], s->particles, s->width);
  MpmResultKeep(in, "%" PetscInt_FMT "{steps} %" PetscInt64_FMT "{calls} %d{single?} %g{size} %g{other_size}",
                p->probe.steps, s->calls, p->probe.single, p->probe.size, p->probe.other);
  MpmReportCertificates(in, &p->certificates);
  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++) {
    const PetscInt64 most = p->certificates.most[c];

    if (MpmCertificateFails(&p->certificates, c)) PrintMost(s, c, most);
    if (!isnan(p->certificates.value[c]) && most != MPM_NONE)
      MpmResultKeep(MpmResultIn(MpmResultIn(in, "certificates"), MpmCertificateNames[c]),
                    "%" PetscInt64_FMT "{particle}", most / s->width);
  }
  Apart(p);
  (void)MpmResultList(in, "set_apart");
  for (PetscInt i = 0; i < s->width && p->unread.apart; i++)
    if (p->unread.apart[i]) (void)json_array_append_new(MpmResultList(in, "set_apart"), json_integer(i));
}

void MpmReportCarriers(json_t *result, const MpmCarriers *c)
{
  (void)MpmResultList(result, "carriers");
  if (!c->n) return;
  MpmPrint("its mode: %" PetscInt64_FMT " of %" PetscInt64_FMT " particles carry 90%% of it;", c->most, c->all);
  for (PetscInt i = 0; i < c->n; i++) {
    json_t *one = MpmResultNext(result, "carriers");

    MpmResultSay(one, "%s particle %" PetscInt64_FMT "{particle}", i ? "," : "", c->particle[i]);
    MpmResultKeep(one, "%g{share}", c->share[i]);
    MpmResultNumbers(one, "place", c->dim, c->place[i]);
    if (c->dim) MpmPrint(" at %s", MpmVectorText(c->dim, c->place[i], 6, MPM_VECTOR_ROOM));
    MpmPrint(" %.3g%%", (double)(100 * c->share[i]));
  }
  MpmPrint("\n");
}

void MpmReportMotion(json_t *result, PetscInt dim, const MpmMotion *m)
{
  PetscReal drift[MPM_MAX_DIM];

  for (PetscInt a = 0; a < dim; a++) drift[a] = m->drift[a].value;
  MpmPrint("particles were set to %" PetscInt_FMT " places along a drift of %s cells a step", m->n,
           MpmVectorText(dim, drift, 6, MPM_VECTOR_ROOM));
  if (!isnan(m->courant))
    MpmResultSay(result, ", from the Courant number %.6g{courant} of the code's long waves", m->courant);
  MpmPrint("\n");
  MpmResultVector(result, "drift", dim, drift);
}

void MpmReportRun(json_t *result, const MpmProgram *p, const MpmProgramRun *r)
{
  const MpmStepper *s  = p->stepper;
  json_t           *in = MpmResultIn(result, "measured");

  MpmReportFile(p->request, s->name);
  MpmPrint("%" PetscInt64_FMT " particles with %" PetscInt_FMT " numbers each\n\ngrowth per step\n", s->particles,
           s->width);
  MpmResultKeep(in, "%" PetscInt64_FMT "{calls}", s->calls);
  if (isnan(r->growth))
    MpmResultSay(in, "  measured    nothing, over %" PetscInt_FMT "{steps} steps, which are too few\n", r->steps);
  else {
    MpmResultSay(in,
                 "  measured    %.7g{growth}    from %.7g{low} to %.7g{high} (95%% or more), over %" PetscInt_FMT
                 "{steps} steps of %" PetscInt_FMT "{perturbations} random perturbations\n",
                 r->growth, r->low, r->high, r->steps, r->perturbations);
    MpmResultSay(
        in,
        "in the second half they have changed by a factor of %.3g{factor}; growth that is linear in time makes it 2\n",
        r->factor);
  }
  if (r->ended) MpmPrint("the code had no answer to more steps\n");
  MpmPrint("\n");
}

void MpmReportKinks(json_t *result, const MpmKinks *k)
{
  json_t *in = MpmResultIn(result, "switch");

  MpmResultSay(in, "the base state is on a switch at %" PetscInt64_FMT "{particles} of %" PetscInt64_FMT " particles",
               k->particles, k->all);
  if (!isnan(k->growth[1]))
    MpmResultSay(in,
                 ": growth is %.7g{one_side} on its one side and %.7g{other_side} on the other; the larger one counts",
                 k->growth[0], k->growth[1]);
  else if (k->field)
    MpmResultSay(
        in, "; a state beside it, -program_base %s{field}=%g{amount}, is on none, and growth is %.7g{beside} there",
        k->field, k->amount, k->growth[0]);
  else
    MpmPrint(", and no field that is changed at all particles leaves it: switch it off (viscosity in compression only, "
             "limiters, "
             "cut-offs, contact)");
  MpmPrint("\n");
}

/* ---- the comparison with a scheme of our own ---- */

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

/* ---- the limits of its time step ---- */

static const char *const rows[]  = {"interior", "free block", "lone particle", "state"};
static const char *const texts[] = {"cells alike in all directions, without an edge", "with nothing around it",
                                    "a particle with nothing around it", "the particles that the code described"};

static void PrintLimit(json_t *result, const MpmCriticalProgram *c, MpmProgramLimitKind kind)
{
  const PetscReal limit     = c->limit[kind];
  char            block[32] = "";

  if (kind == MPM_LIMIT_BLOCK && c->apart)
    MpmPrint(
        "  %-14s %-13s the step is no polynomial of %s, so that each %s that is tried would take up to %" PetscInt_FMT
        " calls; spectrum -program_set %s=... has one\n",
        rows[kind], "not sought", c->name, c->name, 2 * c->apart, c->name);
  if (isnan(limit)) return;
  if (isfinite(limit)) MpmResultPut(MpmResultIn(result, "limits"), MpmProgramLimitNames[kind], json_real(limit));
  if (kind == MPM_LIMIT_BLOCK) (void)snprintf(block, sizeof block, "%" PetscInt_FMT " cells each way, ", c->block);
  if (isinf(limit))
    MpmPrint("  %-14s %-13s %s%s; all steps that were tried, up to 1000 times the code's own, are stable\n", rows[kind],
             "none found", block, texts[kind]);
  else if (limit == 0)
    MpmPrint("  %-14s %-13s %s%s; all steps that were tried are unstable\n", rows[kind], "0", block, texts[kind]);
  else
    MpmPrint("  %-14s %-13.7g %s%s; the code came with %.4g%% of it\n", rows[kind], (double)limit, block, texts[kind],
             (double)(100 * c->given / limit));
}

/* What the limits do not say: the interior alone is optimistic. */
static void PrintMissing(const MpmCriticalProgram *c)
{
  if (!isnan(c->limit[MPM_LIMIT_STATE]))
    MpmPrint(
        "a free block and a lone particle have limits of their own, which may be lower; they are found where cells are "
        "alike and the code takes any number of particles (\"any_count\": true)\n");
  else if (c->motion)
    MpmPrint("particles at an edge, or alone, may have lower limits; they are found at rest, without a drift\n");
  else if (!c->parts)
    MpmPrint("particles at an edge, or alone, may have lower limits; they are found where the code takes any number of "
             "particles (\"any_count\": true), without -probe\n");
}

void MpmReportCriticalPlan(const MpmCriticalProgram *c)
{
  MpmPrint("  the search for the largest stable %s takes about %.2g calls", c->name, (double)c->expected);
  if (c->block) MpmPrint(", most of them for a free block of %" PetscInt_FMT " cells each way", c->block);
  MpmPrint("\n");
}

PetscErrorCode MpmCriticalProgramReport(const MpmProgram *p, const MpmCriticalProgram *c, PetscReal wall_s)
{
  json_t *result, *found;

  PetscFunctionBegin;
  PetscCall(MpmResultOfFile(p->request, NULL, &result));
  found = MpmResultIn(result, "critical");
  MpmReportProbed(result, p);
  if (c->motion) MpmReportMotion(MpmResultIn(result, "motion"), c->dim, c->motion);
  MpmPrint("\nlargest stable %s, in the code's own units\n", c->name);
  (void)MpmResultIn(found, "limits");
  for (MpmProgramLimitKind kind = 0; kind < MPM_LIMIT_KINDS; kind++) PrintLimit(found, c, kind);
  if (!isnan(c->limit[MPM_LIMIT_INTERIOR])) MpmResultVector(found, "limited_by_beta", c->dim, c->beta);
  if (isfinite(c->limit[MPM_LIMIT_INTERIOR]) && c->limit[MPM_LIMIT_INTERIOR] > 0)
    MpmPrint("the wave that limits the interior: beta = %s\n", MpmVectorText(c->dim, c->beta, 6, MPM_VECTOR_ROOM));
  if (c->carriers.n) MpmPrint("what limits: the %s\n", rows[c->least]);
  if (c->carriers.n) MpmReportCarriers(found, &c->carriers);
  PrintMissing(c);
  MpmResultKeep(found, "%g{critical_dt} %g{given_dt} %g{seconds} %" PetscInt64_FMT "{expected_calls}", c->critical,
                c->given, wall_s, c->expected);
  if (c->why)
    MpmResultSay(found, "critical %s: undecided, since %s{undecided}\n", c->name, c->why);
  else if (isfinite(c->critical) && c->critical > 0)
    MpmPrint("critical %s: %.7g; the code came with %.7g, %.4g%% of it\n", c->name, (double)c->critical,
             (double)c->given, (double)(100 * c->given / c->critical));
  MpmResultSay(found,
               "%" PetscInt_FMT "{evaluations} operators were built, with %" PetscInt64_FMT
               " calls on the first rank\n\nat %s = %.7g\n",
               c->probes, c->calls, c->name, (double)c->given);
  PetscCall(MpmReportFinding(result, NULL, NULL, &c->finding, NAN));
  PetscCall(MpmResultEnd(p->request, wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}
