/* The limits of a code that was probed. */
#include "report/report_program.h"
#include <math.h>
#include <string.h>

static const char *const rows[]  = {"interior", "free block", "lone particle", "state"};
static const char *const texts[] = {"cells alike in all directions, without an edge", "with nothing around it",
                                    "a particle with nothing around it", "the particles that the code described"};

static void Limit(json_t *result, const MpmCriticalProgram *c, MpmProgramLimitKind kind)
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
  for (MpmProgramLimitKind kind = 0; kind < MPM_LIMIT_KINDS; kind++) Limit(found, c, kind);
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
