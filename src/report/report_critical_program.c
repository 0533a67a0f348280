/* The limits of a code that was probed: a table for people, and JSON. */
#include "report/report_program.h"
#include <math.h>
#include <string.h>

static const char *const rows[]  = {"interior", "free block", "lone particle", "state"};
static const char *const texts[] = {"cells alike in all directions, without an edge", "with nothing around it",
                                    "a particle with nothing around it", "the particles that the code described"};

static PetscErrorCode PrintLimit(const MpmCriticalProgram *c, MpmProgramLimitKind kind)
{
  const PetscReal limit     = c->limit[kind];
  char            block[32] = "";

  PetscFunctionBegin;
  if (isnan(limit)) PetscFunctionReturn(PETSC_SUCCESS);
  if (kind == MPM_LIMIT_BLOCK)
    PetscCall(PetscSNPrintf(block, sizeof block, "%" PetscInt_FMT " cells each way, ", c->block));
  if (isinf(limit))
    MpmPrint("  %-14s %-13s %s%s; all steps that were tried, up to 1000 times the code's own, are stable\n", rows[kind],
             "none found", block, texts[kind]);
  else if (limit == 0)
    MpmPrint("  %-14s %-13s %s%s; all steps that were tried are unstable\n", rows[kind], "0", block, texts[kind]);
  else
    MpmPrint("  %-14s %-13.7g %s%s; the code came with %.4g%% of it\n", rows[kind], (double)limit, block, texts[kind],
             (double)(100 * c->given / limit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the limits do not say: the interior alone is optimistic. */
static PetscErrorCode PrintMissing(const MpmProgram *p, const MpmCriticalProgram *c)
{
  PetscFunctionBegin;
  if (!isnan(c->limit[MPM_LIMIT_STATE]))
    MpmPrint(
        "a free block and a lone particle have limits of their own, which may be lower; they are found where cells are "
        "alike and the code takes any number of particles (\"any_count\": true)\n");
  else if (!p->stepper->any_count)
    MpmPrint("particles at an edge, or alone, may have lower limits; they are found where the code takes any number of "
             "particles (\"any_count\": true)\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportCriticalPlan(const MpmCriticalProgram *c)
{
  PetscFunctionBegin;
  MpmPrint("  the search for the largest stable %s takes about %.2g calls", c->name, (double)c->expected);
  if (c->block) MpmPrint(", most of them for a free block of %" PetscInt_FMT " cells each way", c->block);
  MpmPrint("\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmReportCriticalProgram(const MpmProgram *p, const MpmCriticalProgram *c)
{
  char beta[96];

  PetscFunctionBegin;
  PetscCall(MpmReportCertificates(&p->certificates));
  PetscCall(MpmReportApart(p));
  MpmPrint("\nlargest stable %s, in the code's own units\n", c->name);
  for (MpmProgramLimitKind kind = 0; kind < MPM_LIMIT_KINDS; kind++) PetscCall(PrintLimit(c, kind));
  if (isfinite(c->limit[MPM_LIMIT_INTERIOR]) && c->limit[MPM_LIMIT_INTERIOR] > 0) {
    PetscCall(MpmReportVector(c->dim, c->beta, 6, sizeof beta, beta));
    MpmPrint("the wave that limits the interior: beta = %s\n", beta);
  }
  if (c->carriers.n) MpmPrint("what limits: the %s\n", rows[c->least]);
  PetscCall(MpmReportCarriers(&c->carriers));
  PetscCall(PrintMissing(p, c));
  if (c->why)
    MpmPrint("critical %s: undecided, since %s\n", c->name, c->why);
  else if (isfinite(c->critical) && c->critical > 0)
    MpmPrint("critical %s: %.7g; the code came with %.7g, %.4g%% of it\n", c->name, (double)c->critical,
             (double)c->given, (double)(100 * c->given / c->critical));
  MpmPrint("%" PetscInt_FMT " operators were built, with %" PetscInt64_FMT " calls on the first rank\n\nat %s = %.7g\n",
           c->probes, c->calls, c->name, (double)c->given);
  PetscCall(MpmReportFinding(&c->finding, NAN));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalProgramWriteJson(const MpmProgram *p, const MpmCriticalProgram *c, PetscMPIInt ranks,
                                           PetscReal wall_s)
{
  json_t *object, *critical = json_object(), *limits = json_object(), *beta = json_array();

  PetscFunctionBegin;
  PetscCall(MpmJsonFile(p->request, ranks, wall_s, &object));
  MpmJsonSetFinding(object, &c->finding);
  MpmJsonSet(critical, "critical_dt", c->critical);
  MpmJsonSet(critical, "given_dt", c->given);
  for (MpmProgramLimitKind kind = 0; kind < MPM_LIMIT_KINDS; kind++)
    MpmJsonSet(limits, MpmProgramLimitNames[kind], c->limit[kind]);
  json_object_set_new(critical, "limits", limits);
  for (PetscInt a = 0; a < c->dim; a++) json_array_append_new(beta, json_real(c->beta[a]));
  if (!isnan(c->limit[MPM_LIMIT_INTERIOR]))
    json_object_set(critical, "limited_by_beta", c->dim == 1 ? json_array_get(beta, 0) : beta);
  json_decref(beta);
  if (c->carriers.n) json_object_set_new(critical, "carriers", MpmJsonCarriers(&c->carriers));
  json_object_set_new(critical, "evaluations", json_integer(c->probes));
  MpmJsonSet(critical, "seconds", wall_s);
  if (c->why) json_object_set_new(critical, "undecided", json_string(c->why));
  json_object_set_new(object, "critical", critical);
  json_object_set_new(object, "probing", MpmJsonProgram(p));
  PetscCall(MpmJsonWrite(p->request->json, object));
  PetscFunctionReturn(PETSC_SUCCESS);
}
