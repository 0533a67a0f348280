/* A code that was probed, and its certificates. */
#include "report/report_program.h"
#include <math.h>

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
  const MpmStepper *s = p->stepper;

  MpmReportFile(p->request, s->name);
  MpmPrint("%" PetscInt64_FMT " particles with %" PetscInt_FMT " numbers each, in %" PetscInt_FMT
           " direction%s, cells of %.6g; ",
           s->particles, s->width, s->dim, s->dim == 1 ? "" : "s", (double)s->cell_width);
  for (PetscInt i = 0; i < s->nparameters; i++)
    MpmPrint("%s = %.6g%s", s->parameters[i].name, (double)s->parameters[i].value,
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
  MpmResultSay(in,
               "  measured    %.7g{growth}    from %.7g{low} to %.7g{high} (95%% or more), over %" PetscInt_FMT
               "{steps} steps of %" PetscInt_FMT "{perturbations} random perturbations\n",
               r->growth, r->low, r->high, r->steps, r->perturbations);
  MpmResultSay(
      in,
      "in the second half they have changed by a factor of %.3g{factor}; growth that is linear in time makes it 2\n",
      r->factor);
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
