/* What all steppers share: the description, agreement between ranks, and checks of what a step gives. */
#include "probe/stepper.h"
#include "base/text.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <stdarg.h>
#include <string.h>

#define PROTOCOL 1

PetscErrorCode MpmStepperFail(MpmStepper *s, const char format[], ...)
{
  va_list arguments;

  PetscFunctionBegin;
  if (s->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  va_start(arguments, format);
  (void)vsnprintf(s->failure, sizeof s->failure, format, arguments);
  va_end(arguments);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The message is that of the first rank which has failed, so that it is said once. */
PetscErrorCode MpmStepperAgree(MpmStepper *s)
{
  PetscMPIInt rank, size, first;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &size));
  first = s->failure[0] ? rank : size;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD));
  if (first == size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Bcast(s->failure, sizeof s->failure, MPI_CHAR, first, PETSC_COMM_WORLD));
  MpmRefuse("%s: %s", s->where, s->failure);
}

/* ---- the description ---- */

static PetscErrorCode Whole(MpmStepper *s, const json_t *object, const char key[], json_int_t least, json_int_t most,
                            PetscInt64 *value)
{
  const json_t    *number = json_object_get(object, key);
  const json_int_t given  = json_integer_value(number);

  PetscFunctionBegin;
  *value = PetscMax(least, 0);
  if (!number || !json_is_integer(number) || given < least || given > most)
    PetscCall(MpmStepperFail(s, "its description has %s %s; needed: a whole number from %lld to %lld",
                             number ? "a wrong" : "no", key, (long long)least, (long long)most));
  else
    *value = given;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Name(MpmStepper *s, const json_t *object, const char of[], char name[MPM_STEPPER_NAME])
{
  const char *given = json_string_value(json_object_get(object, "name"));

  PetscFunctionBegin;
  if (!given || !given[0] || strlen(given) >= MPM_STEPPER_NAME)
    PetscCall(
        MpmStepperFail(s, "its description has no name of %s; needed: 1 to %d characters", of, MPM_STEPPER_NAME - 1));
  else
    PetscCall(PetscStrncpy(name, given, MPM_STEPPER_NAME));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Fields(MpmStepper *s, const json_t *fields)
{
  PetscFunctionBegin;
  if (!json_is_array(fields) || json_array_size(fields) == 0 || json_array_size(fields) > MPM_STEPPER_FIELDS) {
    PetscCall(MpmStepperFail(s, "its description has no fields; needed: 1 to %d of them", MPM_STEPPER_FIELDS));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (size_t f = 0; f < json_array_size(fields); f++) {
    const json_t    *of = json_array_get(fields, f), *scale = json_object_get(of, "scale");
    MpmStepperField *field = &s->fields[s->nfields];
    PetscInt64       size;

    PetscCall(Name(s, of, "a field", field->name));
    PetscCall(Whole(s, of, "size", 1, MPM_STEPPER_WIDTH, &size));
    if (s->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
    field->size  = (PetscInt)size;
    field->first = s->width;
    field->scale = json_number_value(scale);
    if (scale && !(field->scale > 0 && isfinite(field->scale)))
      PetscCall(MpmStepperFail(s, "field %s: its scale is no number above 0", field->name));
    if (json_is_true(json_object_get(of, "place"))) {
      if (s->place != MPM_NONE) PetscCall(MpmStepperFail(s, "two fields are the place; allowed: one"));
      if (field->size != s->dim)
        PetscCall(MpmStepperFail(
            s, "field %s is the place and has size %" PetscInt_FMT "; needed: dim, which is %" PetscInt_FMT,
            field->name, field->size, s->dim));
      s->place = s->nfields;
    }
    s->width += field->size;
    s->nfields++;
  }
  if (s->width > MPM_STEPPER_WIDTH)
    PetscCall(
        MpmStepperFail(s, "a particle has %" PetscInt_FMT " numbers; allowed: up to %d", s->width, MPM_STEPPER_WIDTH));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Parameters(MpmStepper *s, json_t *parameters)
{
  const char *name;
  json_t     *value;

  PetscFunctionBegin;
  json_object_foreach(parameters, name, value)
  {
    if (s->nparameters == MPM_STEPPER_PARAMETERS || strlen(name) >= MPM_STEPPER_NAME || !json_is_number(value)) {
      PetscCall(
          MpmStepperFail(s, "parameter %.60s is no number, or there are more than %d", name, MPM_STEPPER_PARAMETERS));
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    PetscCall(PetscStrncpy(s->parameters[s->nparameters].name, name, MPM_STEPPER_NAME));
    s->parameters[s->nparameters].value = s->parameters[s->nparameters].now = json_number_value(value);
    s->nparameters++;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Grid(MpmStepper *s, const json_t *description)
{
  const json_t *width = json_object_get(description, "cell_width"), *periods = json_object_get(description, "periodic");

  PetscFunctionBegin;
  s->cell_width = json_number_value(width);
  if (!(s->cell_width > 0) || !isfinite(s->cell_width))
    PetscCall(MpmStepperFail(s, "its description has no cell_width; needed: a number above 0"));
  if (periods && !json_is_null(periods) && (!json_is_array(periods) || json_array_size(periods) != (size_t)s->dim))
    PetscCall(MpmStepperFail(s, "its description has a wrong periodic; needed: for each direction a period or null"));
  for (PetscInt a = 0; a < s->dim && json_is_array(periods) && !s->failure[0]; a++) {
    const json_t *period = json_array_get(periods, (size_t)a);

    if (!period || json_is_null(period)) continue;
    s->period[a] = json_number_value(period);
    if (!(s->period[a] > 0) || !isfinite(s->period[a]))
      PetscCall(MpmStepperFail(s, "its description has a period that is no number above 0"));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The cells of the particles: a list of whole numbers, dim of them for each particle, or a list of such lists. */
static PetscErrorCode Cells(MpmStepper *s, const json_t *cells)
{
  const size_t dim = (size_t)s->dim, n = (size_t)s->particles;

  PetscFunctionBegin;
  if (!cells || s->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (!json_is_array(cells) || (json_array_size(cells) != n && json_array_size(cells) != n * dim)) {
    PetscCall(MpmStepperFail(s, "its description has a wrong cell; needed: dim whole numbers for each particle"));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMalloc1(n * dim, &s->cell));
  for (size_t i = 0; i < n * dim; i++) {
    const json_t *one = json_array_size(cells) == n * dim ? json_array_get(cells, i) : json_array_get(cells, i / dim);

    if (json_is_array(one)) one = json_array_get(one, i % dim);
    if (!json_is_integer(one)) PetscCall(MpmStepperFail(s, "its description has a cell that is no whole number"));
    s->cell[i] = (PetscInt)json_integer_value(one);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperDescribe(MpmStepper *s, const char line[])
{
  json_error_t error;
  json_t      *description = json_loads(line, 0, &error);
  const char  *refused     = json_string_value(json_object_get(description, "error")),
             *failure      = json_string_value(json_object_get(description, "failure"));
  PetscInt64 dim, steps = 1, protocol;

  PetscFunctionBegin;
  s->place = MPM_NONE;
  if (!json_is_object(description))
    PetscCall(MpmStepperFail(s, "does not describe itself with an object of JSON: %.80s", line));
  else if (failure)
    PetscCall(MpmStepperFail(s, "%s", failure));
  else if (refused)
    PetscCall(MpmStepperFail(s, "says: %.400s", refused));
  if (!s->failure[0]) {
    PetscCall(Whole(s, description, "protocol", PROTOCOL, PROTOCOL, &protocol));
    PetscCall(Name(s, description, "the code", s->name));
    PetscCall(Whole(s, description, "dim", 1, MPM_MAX_DIM, &dim));
    PetscCall(Whole(s, description, "particles", 1, 1000000000, &s->particles));
    if (json_object_get(description, "steps")) PetscCall(Whole(s, description, "steps", 1, 1000000, &steps));
    s->dim       = (PetscInt)dim;
    s->described = s->particles;
    s->steps     = (PetscInt)steps;
    s->any_count = json_is_true(json_object_get(description, "any_count")) ? PETSC_TRUE : PETSC_FALSE;
    PetscCall(Grid(s, description));
    PetscCall(Fields(s, json_object_get(description, "fields")));
    PetscCall(Parameters(s, json_object_get(description, "parameters")));
    PetscCall(Cells(s, json_object_get(description, "cell")));
  }
  json_decref(description);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- steps ---- */

/* Says which number of a state is not finite. */
static PetscErrorCode CheckFinite(MpmStepper *s, const char what[], PetscInt64 particles, const PetscReal state[])
{
  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < particles * s->width; i++) {
    const PetscInt number = (PetscInt)(i % s->width);
    PetscInt       f      = 0;

    if (isfinite(state[i])) continue;
    while (f + 1 < s->nfields && s->fields[f + 1].first <= number) f++;
    PetscCall(MpmStepperFail(s, "%s has a number that is not finite: %s of particle %" PetscInt64_FMT, what,
                             s->fields[f].name, i / s->width));
    break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperBegin(MpmStepper *s)
{
  const PetscInt64 n = s->failure[0] ? 0 : s->particles * s->width;
  PetscInt64       most;

  PetscFunctionBegin;
  if (!s->failure[0]) PetscCall(CheckFinite(s, "the base state", s->particles, s->base));
  PetscCall(MpmStepperAgree(s));
  PetscCallMPI(MPI_Allreduce(&n, &most, 1, MPIU_INT64, MPI_MAX, PETSC_COMM_WORLD));
  if (n != most) PetscCall(MpmStepperFail(s, "it describes itself in another way on each rank"));
  PetscCall(MpmStepperAgree(s));
  if (most > PETSC_MPI_INT_MAX) PetscCall(MpmStepperFail(s, "its state has more than %d numbers", PETSC_MPI_INT_MAX));
  PetscCall(MpmStepperAgree(s));
  PetscCallMPI(MPI_Bcast(s->base, (PetscMPIInt)most, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperStep(MpmStepper *s, PetscInt steps, PetscInt64 particles, PetscReal state[])
{
  PetscReal *after;

  PetscFunctionBegin;
  if (s->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCheck(particles == s->particles || s->any_count, PETSC_COMM_SELF, PETSC_ERR_PLIB, "another number of particles");
  PetscCall(PetscMalloc1(particles * s->width, &after));
  PetscCall(PetscArraycpy(after, state, particles * s->width));
  PetscCall(s->step(s, steps, particles, after));
  s->calls++;
  if (!s->failure[0]) PetscCall(CheckFinite(s, "the state after a step", particles, after));
  if (!s->failure[0]) PetscCall(PetscArraycpy(state, after, particles * s->width));
  PetscCall(PetscFree(after));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const PetscReal *MpmStepperPlace(const MpmStepper *s, PetscInt64 particle)
{
  return s->place == MPM_NONE ? NULL : s->base + particle * s->width + s->fields[s->place].first;
}

PetscErrorCode MpmStepperParameterOf(const MpmStepper *s, const char name[], PetscReal *value, PetscBool *found)
{
  PetscFunctionBegin;
  *found = PETSC_FALSE;
  for (PetscInt i = 0; i < s->nparameters; i++) {
    if (strcmp(s->parameters[i].name, name)) continue;
    *found = PETSC_TRUE;
    *value = s->parameters[i].value;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperParameterNames(const MpmStepper *s, MpmText *names)
{
  PetscFunctionBegin;
  if (!s->nparameters) PetscCall(MpmTextAdd(names, "none, the code names no parameters"));
  for (PetscInt i = 0; i < s->nparameters; i++)
    PetscCall(MpmTextAdd(names, "%s%s", i ? ", " : "", s->parameters[i].name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperSet(MpmStepper *s, const char name[], PetscReal value)
{
  PetscBool found;
  PetscReal start;
  MpmText   names = {NULL, 0};

  PetscFunctionBegin;
  PetscCall(MpmStepperParameterOf(s, name, &start, &found));
  if (!found) {
    PetscCall(MpmStepperParameterNames(s, &names));
    PetscCall(MpmStepperFail(s, "it has no parameter %.200s; allowed: %s", name, names.text));
    PetscCall(MpmTextFree(&names));
  }
  if (!s->failure[0]) PetscCall(s->set(s, name, value));
  PetscCall(MpmStepperAgree(s));
  for (PetscInt i = 0; i < s->nparameters; i++)
    if (!strcmp(s->parameters[i].name, name)) s->parameters[i].now = value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperDestroy(MpmStepper **stepper)
{
  PetscFunctionBegin;
  if (!*stepper) PetscFunctionReturn(PETSC_SUCCESS);
  if ((*stepper)->end) PetscCall((*stepper)->end(*stepper));
  PetscCall(PetscFree((*stepper)->cell));
  PetscCall(PetscFree((*stepper)->base));
  PetscCall(PetscFree(*stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}
