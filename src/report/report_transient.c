/* Prints norm(A^n) and the pseudospectrum in the table of the task spectrum, and adds them to its JSON object. */
#include "report/report.h"
#include "report/results.h"
#include <math.h>

#define GROWS 0.1 /* a larger fitted power counts as growth */

static void PrintPowers(const MpmSpectrum *s)
{
  const MpmTransient *t      = s->transient;
  const PetscReal     growth = s->finding.growth, tolerance = s->finding.tolerance;

  MpmPrint("transient: norm(A^n) for n up to %" PetscInt_FMT ", norm: %s\n", t->steps[t->n - 1],
           MpmOperatorNorm(s->op));
  if (isnan(t->largest))
    MpmPrint("  largest beyond the range of doubles, at n = %" PetscInt_FMT, t->at_step);
  else
    MpmPrint("  largest of the %" PetscInt_FMT " n looked at%s %.6g, at n = %" PetscInt_FMT, t->n - t->missing,
             t->missing ? " and known" : "", t->largest, t->at_step);
  if (fabs(growth - 1) > tolerance && isfinite(t->excess))
    MpmPrint("; of norm(A^n) / growth^n %.6g, at n = %" PetscInt_FMT, t->excess, t->excess_at);
  MpmPrint("\n");
  if (t->missing) MpmPrint("  not converged: %" PetscInt_FMT " of %" PetscInt_FMT " norms\n", t->missing, t->n);
  if (t->missing || s->finding.verdict == MPM_UNDECIDED || !isfinite(t->power) || !isfinite(growth)) return;
  if (fabs(growth - 1) > tolerance)
    MpmPrint("  late norms go like growth^n%s", t->power > GROWS ? " times a power of n" : "");
  else if (t->power > GROWS)
    MpmPrint("  growth is 1, but norms grow like a power of n: a defective eigenvalue, or nearly one");
  else
    MpmPrint("  growth is 1, and norms do not go on growing up to n = %" PetscInt_FMT, t->steps[t->n - 1]);
  MpmPrint(" (fitted: n^%.2f)\n", fabs(t->power) < 0.005 ? 0 : t->power);
}

/*
   Prints the Kreiss constant. Under drift it is that of the operator of a period, and does not cover the steps between.
*/
static void PrintKreiss(const MpmSpectrum *s)
{
  const MpmPseudospectrum *p     = s->pseudospectrum;
  const PetscBool          moves = s->op->period > 1 ? PETSC_TRUE : PETSC_FALSE;
  const char              *of = moves ? " of the operator of a period" : "", *when = moves ? " of whole periods" : "";

  if (isinf(p->kreiss))
    MpmPrint("Kreiss constant%s: infinite, an eigenvalue is outside the unit circle\n", of);
  else if (isnan(creal(p->kreiss_at)))
    MpmPrint("Kreiss constant%s: 1 as far as was looked; then no norm(A^n)%s is beyond e N = %.4g\n", of, when,
             M_E * p->order);
  else {
    MpmPrint("Kreiss constant%s: at least %.6g, at z = %.6g + %.6gi;\n", of, p->kreiss, creal(p->kreiss_at),
             cimag(p->kreiss_at));
    if (p->edge_power > GROWS)
      MpmPrint(
          "  it still grows there, like distance^-%.2f, at %g from the unit circle: an eigenvalue on it is defective, "
          "or\n  several are nearer to one another; norm(A^n)%s reaches that for some n\n",
          p->edge_power, MPM_KREISS_NEAREST, when);
    else
      MpmPrint("  norm(A^n)%s reaches that for some n, and if it is K, none is beyond e N K = %.4g\n", when,
               M_E * p->order * p->kreiss);
  }
}

void MpmTransientPrint(const MpmSpectrum *s)
{
  if (s->transient) PrintPowers(s);
  if (s->pseudospectrum) PrintKreiss(s);
  if ((s->request->powers && !s->transient) || (s->request->pseudospectrum && !s->pseudospectrum))
    MpmPrint("transient: none, the operator's numbers leave the range of doubles\n");
}

/* JSON has no number that is not finite, so null stands for it. */
static json_t *NumberOrNull(PetscReal value)
{
  return isfinite(value) ? json_real(value) : json_null();
}

static json_t *Powers(const MpmTransient *t)
{
  json_t *object = json_object(), *steps = json_array();

  for (PetscInt i = 0; i < t->n; i++) json_array_append_new(steps, json_integer(t->steps[i]));
  json_object_set_new(object, "steps", steps);
  json_object_set_new(object, "norm", MpmJsonNumbers(t->n, t->norm));
  json_object_set_new(object, "largest", NumberOrNull(t->largest));
  MpmJsonSetCount(object, "at_step", t->at_step);
  MpmJsonSet(object, "seconds", t->seconds);
  return object;
}

static json_t *Pseudospectrum(const MpmPseudospectrum *p)
{
  const PetscReal z[2]   = {creal(p->kreiss_at), cimag(p->kreiss_at)};
  json_t         *object = json_object();

  MpmJsonSetCount(object, "points", p->points);
  json_object_set_new(object, "kreiss", NumberOrNull(p->kreiss));
  json_object_set_new(object, "kreiss_at", isfinite(p->kreiss) && !isnan(z[0]) ? MpmJsonNumbers(2, z) : json_null());
  MpmJsonSet(object, "seconds", p->seconds);
  return object;
}

void MpmTransientJson(const MpmSpectrum *s, json_t *object)
{
  if (s->transient) json_object_set_new(object, "transient", Powers(s->transient));
  if (s->pseudospectrum) json_object_set_new(object, "pseudospectrum", Pseudospectrum(s->pseudospectrum));
}
