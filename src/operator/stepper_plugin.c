/* A stepper in a shared library: the functions of <mpmstab/plugin.h>. */
#include "operator/stepper.h"
#include <mpmstab/errors.h>
#include <dlfcn.h>
#include <math.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <unistd.h>

typedef struct {
  void *library;
  const char *(*describe)(const double **state);
  int (*set)(const char name[], double value);
  int (*step)(int steps, int64_t particles, double state[]);
  const char *(*error)(void);
  PetscReal timeout; /* seconds that a function may take */
} Plugin;

/*
   What is said of a library that does not come back from one of its functions, and whether one is running. The texts are made
   before, since a handler of a signal may not make any.
*/
enum { CRASHED, EXITED, LATE, ENDS };
static char                 *last_words[ENDS];
static volatile sig_atomic_t inside;

/* It is said whose end it is, and the process ends as for other bad input. */
static void EndInside(int how)
{
  const ssize_t told = write(STDERR_FILENO, last_words[how], strlen(last_words[how]));

  _exit(told > 0 ? 2 : 1);
}

static void Crash(int number)
{
  if (inside) EndInside(CRASHED);
  (void)signal(number, SIG_DFL);
  (void)raise(number);
}

static void Exit(void)
{
  if (inside) EndInside(EXITED);
}

static void Alarm(int number)
{
  (void)number;
  if (inside) EndInside(LATE);
}

/* Before and after a function of the library runs, which may take so many seconds. */
static void Enter(PetscReal timeout)
{
  struct itimerval limit = {
      .it_value = {.tv_sec = (time_t)timeout, .tv_usec = 1 + (suseconds_t)(fmod(timeout, 1) * 999998)}};

  inside = 1;
  (void)setitimer(ITIMER_REAL, &limit, NULL);
}

static void Leave(void)
{
  (void)setitimer(ITIMER_REAL, &(struct itimerval){{0, 0}, {0, 0}}, NULL);
  inside = 0;
}

static PetscErrorCode CatchEnds(const char where[], PetscReal timeout)
{
  static const int   numbers[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};
  static const char *how[ENDS] = {"it has crashed in one of its functions",
                                  "it has ended the process in one of its functions",
                                  "a function of it has not come back within"};

  PetscFunctionBegin;
  for (int i = 0; i < ENDS; i++) {
    const size_t room      = strlen(where) + strlen(how[i]) + 64;
    char         limit[48] = "";

    PetscCall(PetscFree(last_words[i]));
    PetscCall(PetscMalloc1(room, &last_words[i]));
    if (i == LATE) (void)snprintf(limit, sizeof limit, " %g s (program_timeout)", (double)timeout);
    PetscCall(PetscSNPrintf(last_words[i], room, "mpmstab: %s: %s%s\n", where, how[i], limit));
  }
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) (void)signal(numbers[i], Crash);
  (void)signal(SIGALRM, Alarm);
  PetscCheck(!atexit(Exit) && !at_quick_exit(Exit), PETSC_COMM_SELF, PETSC_ERR_SYS, "atexit");
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
  Enter(p->timeout);
  failed = p->set(name, value);
  Leave();
  if (failed) PetscCall(MpmStepperFail(s, "set %s to %.17g: %.400s", name, (double)value, Said(p)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Step(MpmStepper *s, PetscInt steps, PetscInt64 particles, PetscReal state[])
{
  const Plugin *p = s->context;
  int           failed;

  PetscFunctionBegin;
  Enter(p->timeout);
  failed = p->step((int)steps, particles, state);
  Leave();
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

PetscErrorCode MpmStepperStartPlugin(const char path[], PetscReal timeout, MpmStepper **stepper)
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
  p->timeout = timeout;
  s->set     = Set;
  s->step    = Step;
  s->end     = End;
  PetscCall(PetscSNPrintf(s->where, sizeof s->where, "plugin %s", path));
  PetscCall(Open(s, path));
  if (!s->failure[0]) {
    PetscCall(CatchEnds(s->where, timeout));
    Enter(timeout);
    line = p->describe(&state);
    Leave();
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
