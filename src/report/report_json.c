/*
   Writes the result of a run as one JSON object. Its keys are a contract; an absent key means that nothing was
   computed.
*/
#include "report/report.h"
#include "report/results.h"

static json_t *Predicted(const MpmRun *run)
{
  json_t *predicted = json_object();

  MpmJsonSetPrediction(predicted, "published", run->predictions.published);
  MpmJsonSetPrediction(predicted, "corrected", run->predictions.corrected);
  if (run->scene->initial == MPM_INITIAL_MODE)
    MpmJsonSetPrediction(predicted, "corrected_mode", run->predictions.corrected_mode);
  MpmJsonSet(predicted, "eigenmode", run->eigenmode);
  return predicted;
}

static json_t *Errors(const MpmRun *run)
{
  json_t        *errors = json_object();
  const char    *name[MPM_MOST_ERRORS];
  const PetscInt n = MpmSceneErrorFields(run->scene, name);

  for (PetscInt f = 0; f < n; f++) {
    json_t *error = json_object();

    MpmJsonSet(error, "l1", run->error[f].l1);
    MpmJsonSet(error, "l2", run->error[f].l2);
    MpmJsonSet(error, "linf", run->error[f].linf);
    json_object_set_new(errors, name[f], error);
  }
  return errors;
}

/* Makes an object with the first (NULL: left out), last and largest value of a diagnostic for each field. */
static json_t *PerField(const MpmTable *table, const PetscReal first[], const PetscReal last[], const PetscReal most[])
{
  json_t *fields = json_object();

  for (PetscInt f = 0; table->fields[f]; f++) {
    json_t *field = json_object();

    if (first) MpmJsonSet(field, "first", first[f]);
    MpmJsonSet(field, "last", last[f]);
    MpmJsonSet(field, "largest", most[f]);
    json_object_set_new(fields, table->fields[f], field);
  }
  return fields;
}

static void SetTransfer(json_t *object, const MpmRun *run)
{
  const MpmTransferDiagnosticsSample *first = &run->transfer_first, *last = &run->transfer_last,
                                     *most = &run->transfer_most;
  const MpmTable *table                    = run->scene->scheme.table;

  if (run->request->weights) json_object_set_new(object, "weights", json_object());
  if (run->request->weights) MpmJsonSet(object, "weights.c1_min", most->c1_min);
  if (run->request->weights) MpmJsonSet(object, "weights.c1_max", most->c1_max);
  if (run->request->source_term)
    json_object_set_new(object, "source_term", PerField(table, NULL, last->source, most->source));
  if (run->request->ringing)
    json_object_set_new(object, "ringing", PerField(table, first->ringing, last->ringing, most->ringing));
}

/* How the steps of a run were chosen. */
static json_t *Pace(const MpmRun *run)
{
  const MpmPace *pace   = run->pace;
  json_t        *object = json_object();

  MpmJsonSet(object, "limit", pace->limit);
  MpmJsonSetText(object, "limited_by", MpmNeighbourhoodNames[pace->where]);
  MpmJsonSet(object, "safety", run->scene->safety);
  if (MpmPaceHasChosen(pace)) {
    MpmJsonSet(object, "dt_least", MpmSceneTimeStep(run->scene, pace->least));
    MpmJsonSet(object, "dt_largest", MpmSceneTimeStep(run->scene, pace->largest));
  }
  MpmJsonSetCount(object, "changes", pace->changes);
  json_object_set_new(object, "steps", json_object());
  for (MpmPaceReason r = 0; r < MPM_PACE_REASONS; r++)
    MpmJsonSetCount(json_object_get(object, "steps"), MpmPaceReasonNames[r], pace->taken[r]);
  return object;
}

static json_t *Run(const MpmRun *run)
{
  json_t         *object = json_object();
  const PetscReal work   = (PetscReal)(run->steps - run->from) * (PetscReal)run->scene->layout.particles;

  MpmJsonSetCount(object, "steps", run->steps);
  if (run->from) MpmJsonSetCount(object, "restarted_at_step", run->from);
  MpmJsonSet(object, "time", run->time);
  if (run->pace) json_object_set_new(object, "courant_auto", Pace(run));
  MpmJsonSet(object, "loop_s", run->loop_s);
  if (work > 0) MpmJsonSet(object, "ns_per_particle_step", 1e9 * run->loop_s / work);
  MpmJsonSet(object, "bytes_per_particle_step", run->bytes);
  MpmJsonSet(object, "load", run->load);
  if (run->scene->scheme.table->nstiff && run->steps > run->from) {
    MpmJsonSet(object, "iterations_per_step", (PetscReal)run->iterations / (PetscReal)(run->steps - run->from));
    MpmJsonSet(object, "solver_s", run->solve_s);
  }
  if (run->has_errors) json_object_set_new(object, "error", Errors(run));
  if (run->growth.measured) {
    MpmJsonSet(object, "growth_measured", run->growth.per_step);
    MpmJsonSet(object, "growth_error", run->growth.error);
    MpmJsonSetText(object, "growth_kind", MpmGrowthKindNames[run->growth.kind]);
  }
  json_object_set_new(object, "energy", json_object());
  MpmJsonSet(object, "energy.initial", run->energy_initial);
  MpmJsonSet(object, "energy.final", run->energy_final);
  if (run->relaxed) {
    json_object_set_new(object, "relaxed", json_object());
    MpmJsonSetCount(object, "relaxed.steps", run->relaxed);
    MpmJsonSet(object, "relaxed.least_factor", run->least_factor);
  }
  MpmJsonSet(object, "mass_change", run->mass_change);
  MpmJsonSet(object, "momentum_change", run->momentum_change);
  SetTransfer(object, run);
  if (run->tangents) MpmTangentsJson(run->tangents, object);
  if (run->lost) MpmJsonSet(object, "growth_above", run->growth_above);
  if (run->blew_up_at_step != MPM_NEVER) MpmJsonSetCount(object, "blew_up_at_step", run->blew_up_at_step);
  return object;
}

PetscErrorCode MpmRunWriteJson(const MpmRun *run)
{
  json_t *object;

  PetscFunctionBegin;
  PetscCall(MpmJsonScene(run->scene, "run", run->wall_s, &object));
  MpmJsonSetText(object, "verdict", MpmVerdictNames[run->verdict]);
  if (run->growth.measured) MpmJsonSet(object, "growth", run->growth.per_step);
  json_object_set_new(object, "predicted", Predicted(run));
  json_object_set_new(object, "run", Run(run));
  PetscCall(MpmJsonWrite(run->request->json, object));
  PetscFunctionReturn(PETSC_SUCCESS);
}
