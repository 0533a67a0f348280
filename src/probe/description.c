/* What a code says of itself in protocol 1. */
#include "probe/stepper.h"
#include <math.h>
#include <string.h>

#define PROTOCOL 1

static void Whole(MpmStepper *s, const json_t *object, const char key[], json_int_t least, json_int_t most,
                  PetscInt64 *value)
{
  const json_t    *number = json_object_get(object, key);
  const json_int_t given  = json_integer_value(number);

  *value = PetscMax(least, 0);
  if (!number || !json_is_integer(number) || given < least || given > most)
    MpmStepperFail(s, "its description has %s %s; needed: a whole number from %lld to %lld", number ? "a wrong" : "no",
                   key, (long long)least, (long long)most);
  else
    *value = given;
}

static void Name(MpmStepper *s, const json_t *object, const char of[], char name[MPM_STEPPER_NAME])
{
  const char *given = json_string_value(json_object_get(object, "name"));

  if (!given || !given[0] || strlen(given) >= MPM_STEPPER_NAME)
    MpmStepperFail(s, "its description has no name of %s; needed: 1 to %d characters", of, MPM_STEPPER_NAME - 1);
  else
    (void)snprintf(name, MPM_STEPPER_NAME, "%s", given);
}

static void Fields(MpmStepper *s, const json_t *fields)
{
  if (!json_is_array(fields) || json_array_size(fields) == 0 || json_array_size(fields) > MPM_STEPPER_FIELDS) {
    MpmStepperFail(s, "its description has no fields; needed: 1 to %d of them", MPM_STEPPER_FIELDS);
    return;
  }
  for (size_t f = 0; f < json_array_size(fields); f++) {
    const json_t    *of = json_array_get(fields, f), *scale = json_object_get(of, "scale");
    MpmStepperField *field = &s->fields[s->nfields];
    PetscInt64       size;

    Name(s, of, "a field", field->name);
    Whole(s, of, "size", 1, MPM_STEPPER_WIDTH, &size);
    if (s->failure[0]) return;
    field->size  = (PetscInt)size;
    field->first = s->width;
    field->scale = json_number_value(scale);
    if (scale && !(field->scale > 0 && isfinite(field->scale)))
      MpmStepperFail(s, "field %s: its scale is no number above 0", field->name);
    if (json_is_true(json_object_get(of, "place"))) {
      if (s->place != MPM_NONE) MpmStepperFail(s, "two fields are the place; allowed: one");
      if (field->size != s->dim)
        MpmStepperFail(s, "field %s is the place and has size %" PetscInt_FMT "; needed: dim, which is %" PetscInt_FMT,
                       field->name, field->size, s->dim);
      s->place = s->nfields;
    }
    s->width += field->size;
    s->nfields++;
  }
  if (s->width > MPM_STEPPER_WIDTH)
    MpmStepperFail(s, "a particle has %" PetscInt_FMT " numbers; allowed: up to %d", s->width, MPM_STEPPER_WIDTH);
}

static void Parameters(MpmStepper *s, json_t *parameters)
{
  const char *name;
  json_t     *value;

  json_object_foreach(parameters, name, value)
  {
    if (s->nparameters == MPM_STEPPER_PARAMETERS || strlen(name) >= MPM_STEPPER_NAME || !json_is_number(value)) {
      MpmStepperFail(s, "parameter %.60s is no number, or there are more than %d", name, MPM_STEPPER_PARAMETERS);
      return;
    }
    (void)snprintf(s->parameters[s->nparameters].name, MPM_STEPPER_NAME, "%s", name);
    s->parameters[s->nparameters].value = s->parameters[s->nparameters].now = json_number_value(value);
    s->nparameters++;
  }
}

static void Grid(MpmStepper *s, const json_t *description)
{
  const json_t *width = json_object_get(description, "cell_width"), *periods = json_object_get(description, "periodic");

  s->cell_width = json_number_value(width);
  if (!(s->cell_width > 0) || !isfinite(s->cell_width))
    MpmStepperFail(s, "its description has no cell_width; needed: a number above 0");
  if (periods && !json_is_null(periods) && (!json_is_array(periods) || json_array_size(periods) != (size_t)s->dim))
    MpmStepperFail(s, "its description has a wrong periodic; needed: for each direction a period or null");
  for (PetscInt a = 0; a < s->dim && json_is_array(periods) && !s->failure[0]; a++) {
    const json_t *period = json_array_get(periods, (size_t)a);

    if (!period || json_is_null(period)) continue;
    s->period[a] = json_number_value(period);
    if (!(s->period[a] > 0) || !isfinite(s->period[a]))
      MpmStepperFail(s, "its description has a period that is no number above 0");
  }
}

/* The cells of the particles: a list of whole numbers, dim of them for each particle, or a list of such lists. */
static PetscErrorCode Cells(MpmStepper *s, const json_t *cells)
{
  const size_t dim = (size_t)s->dim, n = (size_t)s->particles;

  PetscFunctionBegin;
  if (!cells || s->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (!json_is_array(cells) || (json_array_size(cells) != n && json_array_size(cells) != n * dim)) {
    MpmStepperFail(s, "its description has a wrong cell; needed: dim whole numbers for each particle");
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMalloc1(n * dim, &s->cell));
  for (size_t i = 0; i < n * dim; i++) {
    const json_t *one = json_array_size(cells) == n * dim ? json_array_get(cells, i) : json_array_get(cells, i / dim);

    if (json_is_array(one)) one = json_array_get(one, i % dim);
    if (!json_is_integer(one)) MpmStepperFail(s, "its description has a cell that is no whole number");
    s->cell[i] = (PetscInt)json_integer_value(one);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperDescribe(MpmStepper *s, const json_t *description)
{
  PetscInt64 dim, steps = 1, batch = 1, protocol;

  PetscFunctionBegin;
  s->place = MPM_NONE;
  Whole(s, description, "protocol", PROTOCOL, PROTOCOL, &protocol);
  Name(s, description, "the code", s->name);
  Whole(s, description, "dim", 1, MPM_MAX_DIM, &dim);
  Whole(s, description, "particles", 1, 1000000000, &s->particles);
  if (json_object_get(description, "steps")) Whole(s, description, "steps", 1, 1000000, &steps);
  if (json_object_get(description, "batch")) Whole(s, description, "batch", 1, 1000000, &batch);
  s->dim       = (PetscInt)dim;
  s->described = s->particles;
  s->steps     = (PetscInt)steps;
  s->batch     = (PetscInt)batch;
  s->any_count = json_is_true(json_object_get(description, "any_count")) ? PETSC_TRUE : PETSC_FALSE;
  s->resets    = json_is_true(json_object_get(description, "reset")) ? PETSC_TRUE : PETSC_FALSE;
  Grid(s, description);
  Fields(s, json_object_get(description, "fields"));
  Parameters(s, json_object_get(description, "parameters"));
  PetscCall(Cells(s, json_object_get(description, "cell")));
  PetscFunctionReturn(PETSC_SUCCESS);
}
