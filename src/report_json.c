/* The result as one JSON object. Keys are a contract; a key that is absent was not computed. */
#include <mpmstab/errors.h>
#include <mpmstab/output.h>
#include <mpmstab/run.h>
#include <jansson.h>
#include <math.h>

/* JSON has no infinity and no NaN: what is out of range is absent. */
static void SetReal(json_t *object, const char key[], PetscReal value)
{
  if (isfinite(value)) json_object_set_new(object, key, json_real(value));
}

/* null: the formula does not cover the scene. */
static void SetPrediction(json_t *object, const char key[], PetscReal growth)
{
  if (isnan(growth))
    json_object_set_new(object, key, json_null());
  else
    SetReal(object, key, growth);
}

static json_t *Scene(const MpmRun *run)
{
  const MpmScene *s = run->scene;

  return json_pack("{s:s, s:s, s:s, s:s, s:s, s:i, s:i, s:i, s:I, s:f, s:f, s:i, s:f}", "version", MPMSTAB_VERSION,
                   "task", "run", "formulation", s->formulation->name, "basis", s->basis->name, "transfer", s->transfer,
                   "dim", (int)s->dim, "cells", (int)s->cells, "ppc", (int)s->ppc, "particles",
                   (json_int_t)s->particles, "courant", s->courant, "drift", s->drift.value, "ranks", (int)run->ranks,
                   "wall_s", run->wall_s);
}

static json_t *Predicted(const MpmRun *run)
{
  json_t *predicted = json_object();

  SetPrediction(predicted, "published", run->predictions.published);
  SetPrediction(predicted, "corrected", run->predictions.corrected);
  if (run->scene->initial == MPM_INITIAL_MODE)
    SetPrediction(predicted, "corrected_mode", run->predictions.corrected_mode);
  return predicted;
}

static json_t *Errors(const MpmRun *run)
{
  json_t *errors = json_object();

  for (PetscInt f = 0; run->scene->formulation->particle_fields[f]; f++) {
    json_t *error = json_object();

    SetReal(error, "l1", run->error[f].l1);
    SetReal(error, "l2", run->error[f].l2);
    SetReal(error, "linf", run->error[f].linf);
    json_object_set_new(errors, run->scene->formulation->particle_fields[f], error);
  }
  return errors;
}

static json_t *Run(const MpmRun *run)
{
  json_t         *object = json_object(), *energy = json_object();
  const PetscReal work = (PetscReal)run->steps * (PetscReal)run->scene->particles;

  json_object_set_new(object, "steps", json_integer(run->steps));
  SetReal(object, "time", run->steps * run->scene->dt);
  SetReal(object, "loop_s", run->loop_s);
  SetReal(object, "ns_per_particle_step", 1e9 * run->loop_s / work);
  if (run->has_errors) json_object_set_new(object, "error", Errors(run));
  if (run->growth.measured) {
    SetReal(object, "growth_measured", run->growth.per_step);
    json_object_set_new(object, "growth_kind", json_string(MpmGrowthKindNames[run->growth.kind]));
  }
  SetReal(energy, "initial", run->energy_initial);
  SetReal(energy, "final", run->energy_final);
  json_object_set_new(object, "energy", energy);
  if (run->blew_up_at_step != MPM_NEVER)
    json_object_set_new(object, "blew_up_at_step", json_integer(run->blew_up_at_step));
  return object;
}

PetscErrorCode MpmRunWriteJson(const MpmRun *run)
{
  MpmTextFile file;

  PetscFunctionBegin;
  PetscCall(MpmTextFileOpen(run->scene->json, &file));
  if (file.stream) {
    json_t *object = Scene(run);

    PetscCheck(object, PETSC_COMM_SELF, PETSC_ERR_LIB, "jansson could not build the result");
    json_object_set_new(object, "verdict", json_string(MpmVerdictNames[run->verdict]));
    if (run->growth.measured) SetReal(object, "growth", run->growth.per_step);
    json_object_set_new(object, "predicted", Predicted(run));
    json_object_set_new(object, "run", Run(run));
    if (json_dumpf(object, file.stream, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) || fputc('\n', file.stream) == EOF)
      PetscCall(PetscInfo(NULL, "writing %s failed; closing it says why\n", run->scene->json));
    json_decref(object);
  }
  PetscCall(MpmTextFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}
