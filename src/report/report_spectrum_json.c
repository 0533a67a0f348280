/* Writes the result of the task spectrum as a JSON object. */
#include "report/report_certificates.h"
#include "report/results.h"
#include <math.h>

static json_t *Operator(const MpmSpectrum *s)
{
  json_t *object = json_object();

  MpmJsonSetCount(object, "unknowns", s->op->order);
  if (!isnan(s->op->nonzeros)) MpmJsonSetCount(object, "nonzeros", (json_int_t)s->op->nonzeros);
  MpmJsonSetCount(object, "period_steps", s->op->period);
  if (s->scene) MpmJsonSet(object, "assemble_s", s->op->assemble_s);
  MpmJsonSet(object, "solve_s", s->eigen->solve_s);
  MpmJsonSetText(object, "solver", s->eigen->solver);
  if (s->eigen->small) {
    MpmJsonSetCount(object, "nodal_unknowns", s->eigen->small->order);
    MpmJsonSet(object, "nodal_mismatch", s->nodal->mismatch);
  }
  json_object_set_new(object, "converged", json_boolean(s->eigen->converged));
  MpmJsonSetCount(object, "listed", s->eigen->n);
  MpmJsonSet(object, "spectral_radius", s->radius);
  MpmJsonSet(object, "growth", s->growth);
  MpmJsonSet(object, "max_residual", s->max_residual);
  MpmJsonSet(object, "step_mismatch", s->step_mismatch);
  MpmJsonSet(object, "symbol_mismatch", s->symbol_mismatch);
  MpmJsonSet(object, "condition", s->condition);
  if (s->at_one != MPM_UNCOUNTED) MpmJsonSetCount(object, "at_one", s->at_one);
  if (s->nullity != MPM_UNCOUNTED) MpmJsonSetCount(object, "unseen", s->nullity);
  MpmJsonSet(object, "memory_bytes", s->memory);
  return object;
}

/* The first listed eigenvalues with their modes. */
static json_t *Modes(const MpmSpectrum *s)
{
  const MpmModes *modes = &s->leading;
  json_t         *list  = json_array();

  for (PetscInt j = 0; j < modes->n; j++) {
    const PetscReal *beta = &modes->beta[modes->dim * j];
    json_t          *mode = json_object();

    MpmJsonSet(mode, "re", scalbn(s->eigen->re[j], (int)s->op->exponent));
    MpmJsonSet(mode, "im", scalbn(s->eigen->im[j], (int)s->op->exponent));
    json_object_set_new(mode, "beta", MpmJsonNumbers(modes->dim && !isnan(beta[0]) ? modes->dim : 0, beta));
    MpmJsonSet(mode, "p_share", modes->p_share[j]);
    MpmJsonSet(mode, "null_share", modes->null_share[j]);
    json_array_append_new(list, mode);
  }
  return list;
}

/* What was found of the bulk. */
static void SetBulk(json_t *object, const MpmSpectrum *s)
{
  if (s->scene)
    json_object_set_new(object, "predicted",
                        MpmJsonPredicted(&s->predictions, &s->comparison, s->symbol ? s->symbol->growth : NAN));
  json_object_set_new(object, "spectrum", Operator(s));
  if (s->symbol) json_object_set_new(object, "symbol", MpmJsonSymbol(s->symbol));
  if (s->run && s->run->growth.measured) {
    MpmJsonSetCount(object, "run.steps", s->run->steps);
    MpmJsonSet(object, "run.growth_measured", s->run->growth.per_step);
    MpmJsonSetText(object, "run.growth_kind", MpmGrowthKindNames[s->run->growth.kind]);
  }
  if (s->certificates) json_object_set_new(object, "certificates", MpmJsonCertificates(s->certificates));
  if (s->certificates) json_object_set_new(object, "scales", MpmJsonScales(s->certificates));
  if (s->leading.n) json_object_set_new(object, "modes", Modes(s));
  MpmTransientJson(s, object);
}

PetscErrorCode MpmSpectrumWriteJson(const MpmScene *scene, const MpmRequest *request, const MpmSpectrum *s,
                                    const MpmNeighbourhoods *all, PetscReal wall_s, json_t *more)
{
  json_t *object, *spectrum;

  PetscFunctionBegin;
  PetscCall(scene ? MpmJsonScene(scene, "spectrum", all ? wall_s : s->wall_s, &object)
                  : MpmJsonFile(request, s->wall_s, &object));
  MpmJsonSetFinding(object, all ? &all->finding : &s->finding);
  if (s) SetBulk(object, s);
  if (all) {
    if (!s) json_object_set_new(object, "spectrum", json_object());
    spectrum = json_object_get(object, "spectrum");
    MpmNeighbourhoodsJson(scene, all, PETSC_FALSE, spectrum);
  }
  if (more) json_object_update(object, more);
  PetscCall(MpmJsonWrite(request->json, object));
  PetscFunctionReturn(PETSC_SUCCESS);
}
