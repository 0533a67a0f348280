/* A stepper in a shared library: the functions of <mpmstab/plugin.h>. */
#include "operator/stepper.h"
#include <mpmstab/errors.h>
#include <dlfcn.h>
#include <signal.h>
#include <string.h>
#include <unistd.h>

typedef struct {
  void *library;
  const char *(*describe)(const double **state);
  int (*set)(const char name[], double value);
  int (*step)(int steps, int64_t particles, double state[]);
  const char *(*error)(void);
} Plugin;

/* What a library that crashes would say, and whether one of its functions is running. */
static char                  last_words[PETSC_MAX_PATH_LEN + 64];
static volatile sig_atomic_t inside;

/* A crash in the library is not one of mpmstab: it is said whose it is, and the process ends as for other bad input. */
static void Crash(int number)
{
  if (inside) {
    const ssize_t told = write(STDERR_FILENO, last_words, strlen(last_words));

    _exit(told > 0 ? 2 : 1);
  }
  (void)signal(number, SIG_DFL);
  (void)raise(number);
}

static PetscErrorCode CatchCrashes(const char where[])
{
  static const int numbers[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

  PetscFunctionBegin;
  PetscCall(
      PetscSNPrintf(last_words, sizeof last_words, "mpmstab: %s: it has crashed in one of its functions\n", where));
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) (void)signal(numbers[i], Crash);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char *Said(const Plugin *p)
{
  const char *said = p->error ? p->error() : NULL;

  return said ? said : "it does not say why";
}

static PetscErrorCode Set(MpmStepper *s, const char name[], PetscReal value)
{
  const Plugin *p = s->context;
  int           failed;

  PetscFunctionBegin;
  inside = 1;
  failed = p->set(name, value);
  inside = 0;
  if (failed) PetscCall(MpmStepperFail(s, "set %s to %.17g: %.400s", name, (double)value, Said(p)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Step(MpmStepper *s, PetscInt steps, PetscInt64 particles, PetscReal state[])
{
  const Plugin *p = s->context;
  int           failed;

  PetscFunctionBegin;
  inside = 1;
  failed = p->step((int)steps, particles, state);
  inside = 0;
  if (failed) PetscCall(MpmStepperFail(s, "step: %.400s", Said(p)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode End(MpmStepper *s)
{
  Plugin *p = s->context;

  PetscFunctionBegin;
  if (p->library) (void)dlclose(p->library);
  PetscCall(PetscFree(s->context));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* C has no conversion between pointers to objects and to functions; POSIX has this one. */
static PetscErrorCode Find(MpmStepper *s, const char name[], void *function)
{
  const Plugin *p = s->context;

  PetscFunctionBegin;
  *(void **)function = dlsym(p->library, name);
  if (!*(void **)function) PetscCall(MpmStepperFail(s, "it has no function %s (see <mpmstab/plugin.h>)", name));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Open(MpmStepper *s, const char path[])
{
  Plugin *p = s->context;
  char    here[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(here, sizeof here, "%s%s", strchr(path, '/') ? "" : "./", path));
  p->library = dlopen(here, RTLD_NOW | RTLD_LOCAL);
  if (!p->library) {
    PetscCall(MpmStepperFail(s, "cannot be loaded: %.400s; allowed: a shared library", dlerror()));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Find(s, "mpmstab_describe", &p->describe));
  PetscCall(Find(s, "mpmstab_set", &p->set));
  PetscCall(Find(s, "mpmstab_step", &p->step));
  *(void **)&p->error = dlsym(p->library, "mpmstab_error");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepperStartPlugin(const char path[], MpmStepper **stepper)
{
  MpmStepper   *s;
  Plugin       *p;
  const double *state = NULL;
  const char   *line;

  PetscFunctionBegin;
  PetscCall(PetscNew(stepper));
  PetscCall(PetscNew(&p));
  s          = *stepper;
  s->context = p;
  s->set     = Set;
  s->step    = Step;
  s->end     = End;
  PetscCall(PetscSNPrintf(s->where, sizeof s->where, "plugin %s", path));
  PetscCall(Open(s, path));
  if (!s->failure[0]) {
    PetscCall(CatchCrashes(s->where));
    inside = 1;
    line   = p->describe(&state);
    inside = 0;
    if (line)
      PetscCall(MpmStepperDescribe(s, line));
    else
      PetscCall(MpmStepperFail(s, "describe: %.400s", Said(p)));
    if (!s->failure[0] && !state) PetscCall(MpmStepperFail(s, "describe gives no base state"));
  }
  if (!s->failure[0]) {
    PetscCall(PetscMalloc1(s->particles * s->width, &s->base));
    PetscCall(PetscArraycpy(s->base, state, s->particles * s->width));
  }
  PetscCall(MpmStepperBegin(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}
