/*
   A stepper behind two pipes: a program, or the process in which a shared library runs. A message is a line of JSON, followed by raw doubles where the protocol says so:

     > {"do":"describe"}                        < {"protocol":1, ...}   the base state
     > {"do":"set","NAME":VALUE}                < {}
     > {"do":"step","steps":N}   the state      < {}                    the state
     > {"do":"quit"}

   Instead an answer may be an "error", in the words of the code, or a "failure", a sentence of the process of a library.
*/
#include "base/child.h"
#include "probe/plugin_host.h"
#include "probe/stepper.h"
#include <mpmstab/errors.h>
#include <string.h>
#include <unistd.h>

#define WROTE 900 /* bytes of standard error in a message */

/* Takes over the child's failure, with what it has last written to standard error. */
static PetscErrorCode TakeFailure(MpmStepper *s)
{
  const MpmChild *child   = s->context;
  const char     *failure = MpmChildFailure(child), *errors = MpmChildErrors(child);
  char            wrote[WROTE];
  size_t          length = strlen(errors);

  PetscFunctionBegin;
  if (!failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  while (length > 0 && errors[length - 1] == '\n') length--; /* a message is one line */
  if (length >= sizeof wrote) errors += length - sizeof wrote + 1;
  (void)snprintf(wrote, sizeof wrote, "%.*s", (int)PetscMin(length, sizeof wrote - 1), errors);
  for (char *c = wrote; *c; c++)
    if (*c == '\n') *c = '|';
  PetscCall(MpmStepperFail(s, "%s %s%s%s", s->whose, failure, wrote[0] ? "; it wrote: " : "", wrote));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sends a command with a state or without, and takes the line of the answer. */
static PetscErrorCode Ask(MpmStepper *s, const json_t *command, const PetscReal *state, size_t n, const char **answer)
{
  char *line = json_dumps(command, JSON_COMPACT | JSON_REAL_PRECISION(17));

  PetscFunctionBegin;
  PetscCheck(line, PETSC_COMM_SELF, PETSC_ERR_MEM, "a line of JSON");
  PetscCall(MpmChildTalk(s->context, line, state, n * sizeof *state, answer));
  free(line);
  PetscCall(TakeFailure(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of an answer that is not the description: an object, which may say what is wrong. */
static PetscErrorCode CheckAnswer(MpmStepper *s, const char what[], const char answer[])
{
  json_t     *object  = json_loads(answer, 0, NULL);
  const char *error   = json_string_value(json_object_get(object, "error")),
             *failure = json_string_value(json_object_get(object, "failure"));

  PetscFunctionBegin;
  if (failure)
    PetscCall(MpmStepperFail(s, "%s", failure));
  else if (error)
    PetscCall(MpmStepperFail(s, "%s: the program says: %.400s", what, error));
  else if (!json_is_object(object))
    PetscCall(MpmStepperFail(s, "%s: its answer is not a line of JSON: %.80s", what, answer));
  json_decref(object);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Set(MpmStepper *s, const char name[], PetscReal value)
{
  json_t     *command = json_pack("{s:s, s:f}", "do", "set", name, value);
  const char *answer;
  char        what[128];

  PetscFunctionBegin;
  PetscCall(Ask(s, command, NULL, 0, &answer));
  json_decref(command);
  PetscCall(PetscSNPrintf(what, sizeof what, "set %s to %.17g", name, (double)value));
  if (answer) PetscCall(CheckAnswer(s, what, answer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Step(MpmStepper *s, PetscInt steps, PetscInt64 particles, PetscReal state[])
{
  const size_t n       = (size_t)(particles * s->width);
  json_t      *command = json_pack("{s:s, s:i}", "do", "step", "steps", (int)steps);
  const char  *answer;

  PetscFunctionBegin;
  if (particles != s->described) (void)json_object_set_new(command, "particles", json_integer(particles));
  PetscCall(Ask(s, command, state, n, &answer));
  json_decref(command);
  if (answer) PetscCall(CheckAnswer(s, "step", answer));
  if (!s->failure[0]) PetscCall(MpmChildTake(s->context, n * sizeof *state, state));
  PetscCall(TakeFailure(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode End(MpmStepper *s)
{
  MpmChild *child = s->context;

  PetscFunctionBegin;
  PetscCall(MpmChildEnd(&child, "{\"do\":\"quit\"}"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Asks a child that has been started to describe itself. */
static PetscErrorCode Begin(const char option[], const char value[], const char whose[], MpmChild *child,
                            MpmStepper **stepper)
{
  json_t     *describe = json_pack("{s:s}", "do", "describe");
  const char *answer   = NULL;
  MpmStepper *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(stepper));
  s          = *stepper;
  s->context = child;
  s->whose   = whose;
  s->set     = Set;
  s->step    = Step;
  s->end     = End;
  PetscCall(PetscSNPrintf(s->where, sizeof s->where, "%s %s", option, value));
  PetscCall(TakeFailure(s));
  if (!s->failure[0]) PetscCall(Ask(s, describe, NULL, 0, &answer));
  json_decref(describe);
  if (answer) PetscCall(MpmStepperDescribe(s, answer));
  if (!s->failure[0]) {
    PetscCall(PetscMalloc1(s->particles * s->width, &s->base));
    PetscCall(MpmChildTake(s->context, (size_t)(s->particles * s->width) * sizeof *s->base, s->base));
    PetscCall(TakeFailure(s));
  }
  PetscCall(MpmStepperBegin(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperStartProgram(const char command[], PetscReal timeout, MpmStepper **stepper)
{
  MpmChild *child;

  PetscFunctionBegin;
  PetscCall(MpmChildStartCommand(command, timeout, &child));
  PetscCall(Begin("program", command, "the program", child, stepper));
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
  PetscCall(Begin("plugin", path, "the library", child, stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}
