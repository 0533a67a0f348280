/* norm(A^n) and the pseudospectrum in the report of the task spectrum. */
#include "report/report.h"
#include "report/results.h"
#include <math.h>

#define GROWS 0.1 /* a larger fitted power counts as growth */

static void Powers(json_t *result, const MpmSpectrum *s)
{
  const MpmTransient *t      = s->transient;
  const PetscReal     growth = s->finding.growth, tolerance = s->finding.tolerance;

  for (PetscInt i = 0; i < t->n; i++)
    (void)json_array_append_new(MpmResultList(result, "steps"), json_integer(t->steps[i]));
  MpmResultNumbers(result, "norm", t->n, t->norm);
  MpmResultKeep(result, "%g{largest!} %" PetscInt_FMT "{at_step} %g{seconds}", t->largest, t->at_step, t->seconds);
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
static void Kreiss(json_t *result, const MpmSpectrum *s)
{
  const MpmPseudospectrum *p     = s->pseudospectrum;
  const PetscBool          moves = s->op->period > 1 ? PETSC_TRUE : PETSC_FALSE;
  const char              *of = moves ? " of the operator of a period" : "", *when = moves ? " of whole periods" : "";
  const PetscReal          z[2] = {creal(p->kreiss_at), cimag(p->kreiss_at)};

  MpmResultKeep(result, "%" PetscInt_FMT "{points} %g{kreiss!} %g{kreiss_at!} %g{seconds}", p->points, p->kreiss, NAN,
                p->seconds);
  if (isfinite(p->kreiss) && !isnan(z[0])) MpmResultNumbers(result, "kreiss_at", 2, z);
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

void MpmTransientReport(json_t *result, const MpmSpectrum *s)
{
  if (s->transient) Powers(MpmResultIn(result, "transient"), s);
  if (s->pseudospectrum) Kreiss(MpmResultIn(result, "pseudospectrum"), s);
  if ((s->request->powers && !s->transient) || (s->request->pseudospectrum && !s->pseudospectrum))
    MpmPrint("transient: none, the operator's numbers leave the range of doubles\n");
}
