/* How small perturbations of a run have grown. */
#include "report/report.h"
#include "report/results.h"
#include <math.h>

static void Windows(json_t *result, const MpmTangents *t)
{
  (void)MpmResultList(result, "windows");
  for (PetscInt w = 0; w < t->nwindows; w++)
    MpmResultKeep(MpmResultNext(result, "windows"),
                  "%" PetscInt64_FMT "{step} %" PetscInt_FMT "{steps} %g{growth} %g{waves}", t->at[w].step,
                  t->at[w].steps, t->at[w].norm, t->at[w].waves);
}

void MpmTangentsReport(json_t *run, const MpmTangents *t)
{
  json_t *result;

  if (!t) return;
  result = MpmResultIn(run, "tangent");
  MpmResultKeep(result, "%" PetscInt64_FMT "{steps} %" PetscInt_FMT "{window} %g{bytes} %g{least_distance}", t->steps,
                t->window, t->bytes, t->room);
  MpmResultKeep(result, "%" PetscInt_FMT "{warnings}", t->warned);
  (void)MpmResultList(result, "growth");
  Windows(result, t);
  if (!t->steps) return;
  MpmPrint("\ntangent: small perturbations beside %" PetscInt64_FMT " steps, in x / h, v / c and F / F0\n", t->steps);
  MpmPrint("  growth per step, each orthogonal to those before it:");
  for (PetscInt i = 0; i < t->exponents; i++) {
    const PetscReal growth = exp(t->log_growth[i] / t->steps);

    MpmPrint(" %.6g", growth);
    (void)json_array_append_new(MpmResultList(result, "growth"), json_real(growth));
  }
  MpmPrint("\n");
  if (t->nwindows)
    MpmPrint("  most that any can grow: %.4g times in %" PetscInt_FMT " steps up to step %" PetscInt64_FMT
             ", which is %.3g times 1 + c t / h\n",
             t->largest.norm, t->largest.steps, t->largest.step, t->excess);
  if (t->warned)
    MpmResultSay(result,
                 "  warnings: %" PetscInt_FMT ", the first at step %" PetscInt64_FMT
                 "{warned_at_step}, the last at step %" PetscInt64_FMT "\n",
                 t->warned, t->first, t->last);
  else if (t->nwindows)
    MpmPrint("  warnings: none (of growth above %g times 1 + c t / h)\n", t->warn_above);
  if (isfinite(t->room))
    MpmPrint("  least distance of a particle to a place where the weights have no %s: %.3g cells\n",
             t->space.sizes.scheme->basis->hat ? "slope, which perturbations must not reach" : "curvature", t->room);
  MpmPrint("  memory: %.3g MB for the tangents of a window\n", 1e-6 * t->bytes);
}
