/* Growth at a fixed Mach number: what was searched and found, and the same as CSV. */
#include "base/textfile.h"
#include "report/report.h"
#include "report/results.h"
#include <math.h>

/* The time step beside a Courant number, in physical units. */
static void PrintTimeStep(const MpmScene *s, PetscReal courant)
{
  if (MpmSceneIsPhysical(s)) MpmPrint(", dt %.6g", MpmSceneTimeStep(s, courant));
}

/* A point: its Courant number, its drift in the first direction that moves, and its growth. */
static void PrintPoint(const MpmScene *s, const MpmMach *mach, const MpmMachPoint *p)
{
  MpmFraction drift[MPM_MAX_DIM];
  PetscInt    a = 0;

  MpmMachDrift(mach, &p->part, drift);
  while (!drift[a].num) a++;
  MpmPrint("k = %.6g (drift %" PetscInt64_FMT "/%" PetscInt64_FMT, p->courant, drift[a].num, drift[a].den);
  PrintTimeStep(s, p->courant);
  MpmPrint("): ");
  if (p->verdict == MPM_UNDECIDED)
    MpmPrint("undecided\n");
  else
    MpmPrint("growth - 1 = %.3g per step, %.3g per time h/c\n", p->growth - 1, expm1(log(p->growth) / p->courant));
}

static void Found(json_t *result, const MpmScene *s, const MpmRequest *request, const MpmCriticalMach *c)
{
  const MpmMach *mach = &request->mach;

  if (c->stable == c->n)
    MpmPrint("none of them grows beyond 1 + %.6g\n", request->tolerance);
  else if (!c->stable)
    MpmPrint("the smallest of them is not stable:\n");
  else {
    MpmPrint("largest Courant number up to which none of them grows: %.6g", c->points[c->stable - 1].courant);
    PrintTimeStep(s, c->points[c->stable - 1].courant);
    MpmPrint("\n");
  }
  if (c->stable < c->n) {
    const MpmMachPoint *first = &c->points[c->stable], *fastest = &c->points[c->worst];

    MpmPrint("  first      ");
    PrintPoint(s, mach, first);
    MpmPrint("  fastest    ");
    PrintPoint(s, mach, fastest);
    MpmPrint("             of those %s\n",
             c->rest > 0 && c->rest < c->to ? "up to the limit of particles at rest" : "that were searched");
    MpmPrint("  in all     %" PetscInt_FMT " of %" PetscInt_FMT " grow, %" PetscInt_FMT " are undecided\n", c->unstable,
             c->n, c->undecided);
    MpmResultKeep(result, "%g{unstable_at} %g{growth_at_unstable} %g{fastest_at} %g{fastest_growth}", first->courant,
                  first->growth, fastest->courant, fastest->growth);
  }
  MpmPrint("  Growth of moving particles is not monotone. Between these Courant numbers nothing was computed.\n");
}

/* What JSON alone has. */
static void Keep(json_t *result, const MpmScene *s, const MpmMach *mach, const MpmCriticalMach *c)
{
  PetscReal numbers[MPM_MAX_DIM];

  for (PetscInt a = 0; a < s->layout.dim; a++) numbers[a] = (PetscReal)mach->times[a] * mach->unit.value;
  MpmResultNumbers(result, "mach", s->layout.dim, numbers);
  if (c->stable) MpmResultKeep(result, "%g{critical_courant}", c->points[c->stable - 1].courant);
  if (c->stable && MpmSceneIsPhysical(s))
    MpmResultKeep(result, "%g{critical_dt}", MpmSceneTimeStep(s, c->points[c->stable - 1].courant));
  MpmResultKeep(result, "%" PetscInt_FMT "{unstable} %" PetscInt_FMT "{undecided} %g{rest_courant} %g{seconds}",
                c->unstable, c->undecided, c->rest, c->seconds);
}

PetscErrorCode MpmCriticalMachReport(const MpmScene *s, const MpmRequest *request, const MpmCriticalMach *c,
                                     PetscReal wall_s)
{
  json_t *result, *critical;

  PetscFunctionBegin;
  PetscCall(MpmResultOfScene(s, request, &result));
  if (!MpmSceneHasStep(s)) (void)json_object_del(result, "drift"); /* that of the default Courant number */
  critical = MpmResultIn(result, "critical");
  Keep(critical, s, &request->mach, c);
  MpmResultSay(critical,
               "\nat a fixed velocity the drift is M k: %" PetscInt_FMT
               "{searched} Courant numbers from %.6g{searched_from} to %.6g{searched_to} were searched\n",
               c->n, c->points[0].courant, c->points[c->n - 1].courant);
  MpmPrint("  M k is each fraction with a denominator up to %d, and those near %" PetscInt_FMT " equal steps of k\n",
           MPM_CRITICAL_MACH_ALL, c->steps);
  Found(critical, s, request, c);
  if (c->rest > 0 && isfinite(c->rest)) {
    MpmPrint("  at rest    the limit is %.6g", c->rest);
    PrintTimeStep(s, c->rest);
    MpmPrint("\n");
  }
  if (MpmSceneHasStep(s)) {
    MpmPrint("\nat Courant number %.6g", s->step.courant);
    PrintTimeStep(s, s->step.courant);
    MpmPrint(": growth %.9g per step\n", c->asked.growth);
    MpmReportQuiet(critical, &c->theorem);
    PetscCall(MpmReportFinding(result, s, request, &c->asked, NAN));
  }
  MpmPrint("time: %.3g s\n", c->seconds);
  PetscCall(MpmResultEnd(request, wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalMachWriteCsv(const MpmScene *s, const MpmRequest *request, const MpmCriticalMach *c)
{
  const PetscInt dim = s->layout.dim;
  MpmTextFile    csv;

  PetscFunctionBegin;
  PetscCall(MpmTextFileOpen(request->csv, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "courant");
    for (PetscInt a = 0; a < dim; a++) fprintf(csv.stream, dim == 1 ? ",drift" : ",drift_%c", "xyz"[a]);
    fprintf(csv.stream, ",growth");
    for (PetscInt a = 0; a < dim; a++) fprintf(csv.stream, dim == 1 ? ",beta" : ",beta_%c", "xyz"[a]);
    fprintf(csv.stream, ",verdict\n");
    for (PetscInt i = 0; i < c->n; i++) {
      const MpmMachPoint *p = &c->points[i];
      MpmFraction         drift[MPM_MAX_DIM];

      MpmMachDrift(&request->mach, &p->part, drift);
      fprintf(csv.stream, "%.17g", p->courant);
      for (PetscInt a = 0; a < dim; a++) MpmTextFileCell(&csv, drift[a].value);
      MpmTextFileCell(&csv, p->growth);
      for (PetscInt a = 0; a < dim; a++) MpmTextFileCell(&csv, p->beta[a]);
      fprintf(csv.stream, ",%s\n", MpmVerdictNames[p->verdict]);
    }
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}
