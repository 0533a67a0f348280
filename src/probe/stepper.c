/*
   A stepper behind two pipes: a program, or the process in which a shared library runs. A message is a line of JSON,
   followed by raw doubles where the protocol says so:

     > {"do":"describe"}                        < {"protocol":1, ...}   the base state
     > {"do":"set","NAME":VALUE}                < {}
     > {"do":"step","steps":N}   the state      < {}                    the state      with "reset":true if it can, and
                                                                                       "states":M with M states at a
                                                                                       time
     > {"do":"scene","particles":N, ...}        < {}                    the base state, of N places, volumes and masses
     > {"do":"quit"}

   Instead an answer may be an "error", in the words of the code, or a "failure", a sentence of the process of a
   library.
*/
#include "probe/stepper.h"
#include "base/child.h"
#include "base/text.h"
#include "probe/plugin_host.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#define PROTOCOL 1
#define WROTE 900 /* bytes of standard error in a message */

/* Notes a failure, unless there is one already. */
#define Fail(s, ...) (void)((s)->failure[0] || snprintf((s)->failure, sizeof(s)->failure, __VA_ARGS__))

/* The message is that of the first rank which has failed, so that it is said once. */
PetscErrorCode MpmStepperAgree(MpmStepper *s)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);
  PetscMPIInt       first;

  PetscFunctionBegin;
  first = s->failure[0] ? MpmRankOf(PETSC_COMM_WORLD) : size;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MIN, PETSC_COMM_WORLD));
  if (first == size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Bcast(s->failure, sizeof s->failure, MPI_CHAR, first, PETSC_COMM_WORLD));
  MpmRefuse("%s: %s", s->where, s->failure);
}

/* ---- the talk ---- */

/* Takes over the child's failure, with what it has last written to standard error. */
static void TakeFailure(MpmStepper *s)
{
  const MpmChild *child   = s->child;
  const char     *failure = MpmChildFailure(child), *errors = MpmChildErrors(child);
  char            wrote[WROTE];
  size_t          length = strlen(errors);

  if (!failure[0]) return;
  while (length > 0 && errors[length - 1] == '\n') length--; /* a message is one line */
  if (length >= sizeof wrote) errors += length - sizeof wrote + 1;
  (void)snprintf(wrote, sizeof wrote, "%.*s", (int)PetscMin(length, sizeof wrote - 1), errors);
  for (char *c = wrote; *c; c++)
    if (*c == '\n') *c = '|';
  Fail(s, "%s %s%s%s", s->whose, failure, wrote[0] ? "; it wrote: " : "", wrote);
}

/*
   Sends a command with a state or without, and takes the answer, an object of JSON that the caller frees; NULL after a
   failure. what: was asked for, as messages say it; of a description they say nothing of the kind.
*/
static PetscErrorCode Ask(MpmStepper *s, const char what[], json_t *command, const PetscReal *state, size_t n,
                          json_t **answer)
{
  char       *line = json_dumps(command, JSON_COMPACT | JSON_REAL_PRECISION(17));
  const char *said, *error, *failure;

  PetscFunctionBegin;
  *answer = NULL;
  PetscCheck(line, PETSC_COMM_SELF, PETSC_ERR_MEM, "a line of JSON");
  json_decref(command);
  PetscCall(MpmChildTalk(s->child, line, state, n * sizeof *state, &said));
  free(line);
  TakeFailure(s);
  if (!said) PetscFunctionReturn(PETSC_SUCCESS);
  *answer = json_loads(said, 0, NULL);
  failure = json_string_value(json_object_get(*answer, "failure"));
  error   = json_string_value(json_object_get(*answer, "error"));
  if (!json_is_object(*answer))
    Fail(s,
         what ? "%s: its answer is not a line of JSON: %.80s"
              : "%sdoes not describe itself with an object of JSON: %.80s",
         what ? what : "", said);
  else if (failure)
    Fail(s, "%s", failure);
  else if (error)
    Fail(s, "%s%s%.400s", what ? what : "", what ? ": the program says: " : "says: ", error);
  if (!s->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  json_decref(*answer);
  *answer = NULL;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes numbers that follow an answer. */
static PetscErrorCode TakeState(MpmStepper *s, PetscInt64 n, PetscReal state[])
{
  PetscFunctionBegin;
  PetscCall(MpmChildTake(s->child, (size_t)n * sizeof *state, state));
  TakeFailure(s);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- steps ---- */

/* Says which number of a state is not finite. */
static void CheckFinite(MpmStepper *s, const char what[], PetscInt64 particles, PetscInt count, const PetscReal state[])
{
  for (PetscInt64 i = 0; i < particles * s->width * count; i++) {
    const PetscInt number = (PetscInt)(i % s->width);
    PetscInt       f      = 0;

    if (isfinite(state[i])) continue;
    while (f + 1 < s->nfields && s->fields[f + 1].first <= number) f++;
    Fail(s, "%s has a number that is not finite: %s of particle %" PetscInt64_FMT, what, s->fields[f].name,
         i / s->width % particles);
    break;
  }
}

PetscErrorCode MpmStepperBegin(MpmStepper *s)
{
  const PetscInt64 n = s->failure[0] ? 0 : s->particles * s->width;
  PetscInt64       most;

  PetscFunctionBegin;
  if (!s->failure[0]) CheckFinite(s, "the base state", s->particles, 1, s->base);
  PetscCall(MpmStepperAgree(s));
  PetscCallMPI(MPI_Allreduce(&n, &most, 1, MPIU_INT64, MPI_MAX, PETSC_COMM_WORLD));
  if (n != most) Fail(s, "it describes itself in another way on each rank");
  PetscCall(MpmStepperAgree(s));
  if (most > PETSC_MPI_INT_MAX) Fail(s, "its state has more than %d numbers", PETSC_MPI_INT_MAX);
  PetscCall(MpmStepperAgree(s));
  PetscCallMPI(MPI_Bcast(s->base, (PetscMPIInt)most, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the start ---- */

static void Whole(MpmStepper *s, const json_t *object, const char key[], json_int_t least, json_int_t most,
                  PetscInt64 *value)
{
  const json_t    *number = json_object_get(object, key);
  const json_int_t given  = json_integer_value(number);

  *value = PetscMax(least, 0);
  if (!number || !json_is_integer(number) || given < least || given > most)
    Fail(s, "its description has %s %s; needed: a whole number from %lld to %lld", number ? "a wrong" : "no", key,
         (long long)least, (long long)most);
  else
    *value = given;
}

static void TakeName(MpmStepper *s, const json_t *object, const char of[], char name[MPM_STEPPER_NAME])
{
  const char *given = json_string_value(json_object_get(object, "name"));

  if (!given || !given[0] || strlen(given) >= MPM_STEPPER_NAME)
    Fail(s, "its description has no name of %s; needed: 1 to %d characters", of, MPM_STEPPER_NAME - 1);
  else
    (void)snprintf(name, MPM_STEPPER_NAME, "%s", given);
}

static void TakeFields(MpmStepper *s, const json_t *fields)
{
  if (!json_is_array(fields) || json_array_size(fields) == 0 || json_array_size(fields) > MPM_STEPPER_FIELDS) {
    Fail(s, "its description has no fields; needed: 1 to %d of them", MPM_STEPPER_FIELDS);
    return;
  }
  for (size_t f = 0; f < json_array_size(fields); f++) {
    const json_t    *of = json_array_get(fields, f), *scale = json_object_get(of, "scale");
    MpmStepperField *field = &s->fields[s->nfields];
    PetscInt64       size;

    TakeName(s, of, "a field", field->name);
    Whole(s, of, "size", 1, MPM_STEPPER_WIDTH, &size);
    if (s->failure[0]) return;
    field->size  = (PetscInt)size;
    field->first = s->width;
    field->scale = json_number_value(scale);
    if (scale && !(field->scale > 0 && isfinite(field->scale)))
      Fail(s, "field %s: its scale is no number above 0", field->name);
    if (json_is_true(json_object_get(of, "place"))) {
      if (s->place != MPM_NONE) Fail(s, "two fields are the place; allowed: one");
      if (field->size != s->dim)
        Fail(s, "field %s is the place and has size %" PetscInt_FMT "; needed: dim, which is %" PetscInt_FMT,
             field->name, field->size, s->dim);
      s->place = s->nfields;
    }
    s->width += field->size;
    s->nfields++;
  }
  if (s->width > MPM_STEPPER_WIDTH)
    Fail(s, "a particle has %" PetscInt_FMT " numbers; allowed: up to %d", s->width, MPM_STEPPER_WIDTH);
}

static void TakeParameters(MpmStepper *s, json_t *parameters)
{
  const char *name;
  json_t     *value;

  json_object_foreach(parameters, name, value)
  {
    if (s->nparameters == MPM_STEPPER_PARAMETERS || strlen(name) >= MPM_STEPPER_NAME || !json_is_number(value)) {
      Fail(s, "parameter %.60s is no number, or there are more than %d", name, MPM_STEPPER_PARAMETERS);
      return;
    }
    (void)snprintf(s->parameters[s->nparameters].name, MPM_STEPPER_NAME, "%s", name);
    s->parameters[s->nparameters].value = s->parameters[s->nparameters].now = json_number_value(value);
    s->nparameters++;
  }
}

static void TakeGrid(MpmStepper *s, const json_t *description)
{
  const json_t *width = json_object_get(description, "cell_width"), *periods = json_object_get(description, "periodic");

  s->cell_width = json_number_value(width);
  if (!(s->cell_width > 0) || !isfinite(s->cell_width))
    Fail(s, "its description has no cell_width; needed: a number above 0");
  s->has_periods = json_is_array(periods) ? PETSC_TRUE : PETSC_FALSE;
  if (periods && !json_is_null(periods) && (!json_is_array(periods) || json_array_size(periods) != (size_t)s->dim))
    Fail(s, "its description has a wrong periodic; needed: for each direction a period or null");
  for (PetscInt a = 0; a < s->dim && json_is_array(periods) && !s->failure[0]; a++) {
    const json_t *period = json_array_get(periods, (size_t)a);

    if (!period || json_is_null(period)) continue;
    s->period[a] = json_number_value(period);
    if (!(s->period[a] > 0) || !isfinite(s->period[a]))
      Fail(s, "its description has a period that is no number above 0");
  }
}

/* The cells of the particles: a list of whole numbers, dim of them for each particle, or a list of such lists. */
static PetscErrorCode TakeCells(MpmStepper *s, const json_t *cells)
{
  const size_t dim = (size_t)s->dim, n = (size_t)s->particles;

  PetscFunctionBegin;
  if (!cells || s->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (!json_is_array(cells) || (json_array_size(cells) != n && json_array_size(cells) != n * dim)) {
    Fail(s, "its description has a wrong cell; needed: dim whole numbers for each particle");
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMalloc1(n * dim, &s->cell));
  for (size_t i = 0; i < n * dim; i++) {
    const json_t *one = json_array_size(cells) == n * dim ? json_array_get(cells, i) : json_array_get(cells, i / dim);

    if (json_is_array(one)) one = json_array_get(one, i % dim);
    if (!json_is_integer(one)) Fail(s, "its description has a cell that is no whole number");
    s->cell[i] = (PetscInt)json_integer_value(one);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What a code says of itself, without its base state. What is missing or wrong is the failure. */
static PetscErrorCode TakeDescription(MpmStepper *s, const json_t *description)
{
  PetscInt64 dim, steps = 1, batch = 1, protocol;

  PetscFunctionBegin;
  s->place = MPM_NONE;
  Whole(s, description, "protocol", PROTOCOL, PROTOCOL, &protocol);
  TakeName(s, description, "the code", s->name);
  Whole(s, description, "dim", 1, MPM_MAX_DIM, &dim);
  s->scenes = json_is_true(json_object_get(description, "scenes")) ? PETSC_TRUE : PETSC_FALSE;
  if (!s->scenes || json_object_get(description, "particles"))
    Whole(s, description, "particles", 1, 1000000000, &s->particles);
  if (json_object_get(description, "steps")) Whole(s, description, "steps", 1, 1000000, &steps);
  if (json_object_get(description, "batch")) Whole(s, description, "batch", 1, 1000000, &batch);
  s->dim       = (PetscInt)dim;
  s->described = s->particles;
  s->steps     = (PetscInt)steps;
  s->batch     = (PetscInt)batch;
  s->any_count = s->scenes || json_is_true(json_object_get(description, "any_count")) ? PETSC_TRUE : PETSC_FALSE;
  s->resets    = json_is_true(json_object_get(description, "reset")) ? PETSC_TRUE : PETSC_FALSE;
  TakeGrid(s, description);
  TakeFields(s, json_object_get(description, "fields"));
  TakeParameters(s, json_object_get(description, "parameters"));
  PetscCall(TakeCells(s, json_object_get(description, "cell")));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Asks a child that has been started to describe itself. */
static PetscErrorCode Begin(const char option[], const char value[], const char whose[], MpmChild *child,
                            PetscReal timeout, MpmStepper **stepper)
{
  json_t     *answer = NULL;
  MpmStepper *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(stepper));
  s          = *stepper;
  s->child   = child;
  s->whose   = whose;
  s->timeout = timeout;
  (void)snprintf(s->where, sizeof s->where, "%s %s", option, value);
  TakeFailure(s);
  if (!s->failure[0]) PetscCall(Ask(s, NULL, json_pack("{s:s}", "do", "describe"), NULL, 0, &answer));
  if (answer) PetscCall(TakeDescription(s, answer));
  json_decref(answer);
  if (!s->failure[0]) {
    PetscCall(PetscMalloc1(s->particles * s->width, &s->base));
    PetscCall(TakeState(s, s->particles * s->width, s->base));
  }
  PetscCall(MpmStepperBegin(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperStartProgram(const char command[], PetscReal timeout, MpmStepper **stepper)
{
  MpmChild *child;

  PetscFunctionBegin;
  PetscCall(MpmChildStartCommand(command, timeout, &child));
  PetscCall(Begin("program", command, "the program", child, timeout, stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* This program once more, whose main function sees from the words what it shall be. */
PetscErrorCode MpmStepperStartPlugin(const char path[], PetscReal timeout, MpmStepper **stepper)
{
  char      own[PETSC_MAX_PATH_LEN] = "/proc/self/exe", host[] = MPM_PLUGIN_HOST, *library;
  MpmChild *child;
  ssize_t   n;

  PetscFunctionBegin;
  n = readlink("/proc/self/exe", own, sizeof own - 1);
  if (n > 0) own[n] = '\0';
  PetscCall(PetscStrallocpy(path, &library));
  PetscCall(MpmChildStart((char *[]){own, host, library, NULL}, timeout, &child));
  PetscCall(PetscFree(library));
  PetscCall(Begin("plugin", path, "the library", child, timeout, stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperTakeScene(MpmStepper *s, PetscInt64 particles, const PetscReal given[], json_t *material)
{
  json_t *command = json_pack("{s:s, s:I, s:f, s:o}", "do", "scene", "particles", (json_int_t)particles, "cell_width",
                              (double)s->cell_width, "periodic", json_array()),
         *periods = json_object_get(command, "periodic"), *answer;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < s->dim; a++)
    (void)json_array_append_new(periods, s->period[a] > 0 ? json_real(s->period[a]) : json_null());
  if (material) (void)json_object_set_new(command, "material", material);
  s->particles = s->described = particles;
  PetscCall(Ask(s, "scene", command, given, (size_t)(particles * (s->dim + 2)), &answer));
  PetscCall(PetscFree(s->base));
  PetscCall(PetscFree(s->cell));
  PetscCall(PetscMalloc1(particles * s->width, &s->base));
  if (answer) PetscCall(TakeState(s, particles * s->width, s->base));
  json_decref(answer);
  PetscCall(MpmStepperBegin(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- requests ---- */

/* One request; count states. */
static PetscErrorCode Request(MpmStepper *s, PetscInt steps, PetscInt64 particles, PetscInt count, PetscReal states[])
{
  const PetscInt64 n       = particles * s->width * count;
  const PetscReal  begin   = MPI_Wtime();
  json_t          *command = json_pack("{s:s, s:i}", "do", "step", "steps", (int)steps), *answer = NULL;
  PetscReal       *after;

  PetscFunctionBegin;
  if (particles != s->described) (void)json_object_set_new(command, "particles", json_integer(particles));
  if (count > 1) (void)json_object_set_new(command, "states", json_integer(count));
  if (s->resets) (void)json_object_set_new(command, "reset", json_true());
  PetscCall(PetscMalloc1(n, &after));
  PetscCall(Ask(s, "step", command, states, (size_t)n, &answer));
  if (answer) PetscCall(TakeState(s, n, after));
  json_decref(answer);
  s->calls += count;
  s->done += steps * count;
  s->slowest = PetscMax(s->slowest, (MPI_Wtime() - begin) / count);
  if (!s->failure[0]) CheckFinite(s, "the state after a step", particles, count, after);
  if (!s->failure[0]) PetscCall(PetscArraycpy(states, after, n));
  PetscCall(PetscFree(after));
  if (s->expected)
    PetscCall(MpmProgressUpdate(&s->progress, PetscMin(s->calls - s->begun, s->expected - 1), s->expected));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A request stays far below the time that an answer may take. */
PetscErrorCode MpmStepperStepAll(MpmStepper *s, PetscInt steps, PetscInt64 particles, PetscInt count,
                                 PetscReal states[])
{
  PetscFunctionBegin;
  PetscCheck(particles == s->particles || s->any_count, PETSC_COMM_SELF, PETSC_ERR_PLIB, "another number of particles");
  for (PetscInt i = 0, n; i < count && !s->failure[0]; i += n) {
    const PetscReal fit = s->slowest > 0 ? s->timeout / 10 / s->slowest : 1;

    n = PetscMin(count - i, (PetscInt)PetscMax(1, PetscMin(s->batch, fit)));
    PetscCall(Request(s, steps, particles, n, states + i * particles * s->width));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperStep(MpmStepper *s, PetscInt steps, PetscInt64 particles, PetscReal state[])
{
  PetscFunctionBegin;
  PetscCall(MpmStepperStepAll(s, steps, particles, 1, state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperExpect(MpmStepper *s, const char unit[], PetscInt64 calls)
{
  PetscFunctionBegin;
  if (s->nested++) PetscFunctionReturn(PETSC_SUCCESS);
  s->expected = calls;
  s->begun    = s->calls;
  PetscCall(MpmProgressBegin(unit, &s->progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperForgetExpected(MpmStepper *s)
{
  PetscFunctionBegin;
  if (--s->nested) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmProgressEnd(&s->progress));
  s->expected = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

const PetscReal *MpmStepperPlace(const MpmStepper *s, PetscInt64 particle)
{
  return s->place == MPM_NONE ? NULL : s->base + particle * s->width + s->fields[s->place].first;
}

void MpmStepperParameterOf(const MpmStepper *s, const char name[], PetscReal *value, PetscBool *found)
{
  *found = PETSC_FALSE;
  for (PetscInt i = 0; i < s->nparameters; i++) {
    if (strcmp(s->parameters[i].name, name)) continue;
    *found = PETSC_TRUE;
    *value = s->parameters[i].value;
  }
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
  json_t   *answer = NULL;
  char      what[128];
  MpmText   names = {NULL, 0};

  PetscFunctionBegin;
  MpmStepperParameterOf(s, name, &start, &found);
  if (!found) {
    PetscCall(MpmStepperParameterNames(s, &names));
    Fail(s, "it has no parameter %.200s; allowed: %s", name, names.text);
    MpmTextFree(&names);
  }
  (void)snprintf(what, sizeof what, "set %s to %.17g", name, (double)value);
  if (!s->failure[0]) PetscCall(Ask(s, what, json_pack("{s:s, s:f}", "do", "set", name, value), NULL, 0, &answer));
  json_decref(answer);
  PetscCall(MpmStepperAgree(s));
  for (PetscInt i = 0; i < s->nparameters; i++)
    if (!strcmp(s->parameters[i].name, name)) s->parameters[i].now = value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperDestroy(MpmStepper **stepper)
{
  PetscFunctionBegin;
  if (!*stepper) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmChildEnd(&(*stepper)->child, "{\"do\":\"quit\"}"));
  PetscCall(PetscFree((*stepper)->cell));
  PetscCall(PetscFree((*stepper)->base));
  PetscCall(PetscFree(*stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}
