/* Prints how small perturbations of a run have grown, and adds it to the run's JSON object. */
#include "report/report.h"
#include "report/results.h"
#include <math.h>

/* Growth per step of perturbation i. */
static PetscReal Growth(const MpmTangents *t, PetscInt i)
{
  return exp(t->log_growth[i] / t->steps);
}

void MpmTangentsPrint(const MpmTangents *t)
{
  if (!t || !t->steps) return;
  MpmPrint("\ntangent: small perturbations beside %" PetscInt64_FMT " steps, in x / h, v / c and F / F0\n", t->steps);
  MpmPrint("  growth per step, each orthogonal to those before it:");
  for (PetscInt i = 0; i < t->exponents; i++) MpmPrint(" %.6g", Growth(t, i));
  MpmPrint("\n");
  if (t->nwindows)
    MpmPrint("  most that any can grow: %.4g times in %" PetscInt_FMT " steps up to step %" PetscInt64_FMT
             ", which is %.3g times 1 + c t / h\n",
             t->largest.norm, t->largest.steps, t->largest.step, t->excess);
  if (t->warned)
    MpmPrint("  warnings: %" PetscInt_FMT ", the first at step %" PetscInt64_FMT ", the last at step %" PetscInt64_FMT
             "\n",
             t->warned, t->first, t->last);
  else if (t->nwindows)
    MpmPrint("  warnings: none (of growth above %g times 1 + c t / h)\n", t->warn_above);
  if (isfinite(t->room))
    MpmPrint("  least distance of a particle to a place where the weights have no %s: %.3g cells\n",
             t->space.sizes.scheme->basis->hat ? "slope, which perturbations must not reach" : "curvature", t->room);
  MpmPrint("  memory: %.3g MB for the tangents of a window\n", 1e-6 * t->bytes);
}

void MpmTangentsJson(const MpmTangents *t, json_t *object)
{
  json_t *tangent = json_object(), *growth = json_array(), *windows = json_array();

  json_object_set_new(object, "tangent", tangent);
  MpmJsonSetCount(tangent, "steps", t->steps);
  MpmJsonSetCount(tangent, "window", t->window);
  for (PetscInt i = 0; i < t->exponents && t->steps; i++) json_array_append_new(growth, json_real(Growth(t, i)));
  json_object_set_new(tangent, "growth", growth);
  for (PetscInt w = 0; w < t->nwindows; w++) {
    json_t *window = json_object();

    MpmJsonSetCount(window, "step", t->at[w].step);
    MpmJsonSetCount(window, "steps", t->at[w].steps);
    MpmJsonSet(window, "growth", t->at[w].norm);
    MpmJsonSet(window, "waves", t->at[w].waves);
    json_array_append_new(windows, window);
  }
  json_object_set_new(tangent, "windows", windows);
  MpmJsonSetCount(tangent, "warnings", t->warned);
  if (t->warned) MpmJsonSetCount(tangent, "warned_at_step", t->first);
  MpmJsonSet(tangent, "least_distance", t->room);
  MpmJsonSet(tangent, "bytes", t->bytes);
}
