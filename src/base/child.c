/*
   A child process with three pipes. All reading and writing waits in one place, Wait, so that a child that writes while
   it should read, or that floods standard error, cannot block both sides.
*/
#define _GNU_SOURCE /* pipe2, ppoll, prctl */
#include "base/child.h"
#include <mpmstab/errors.h>
#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#define ERRORS_ROOM 2048       /* bytes of standard error that are kept */
#define LONGEST_LINE 268435456 /* bytes of an answer's line */
#define PIECE 65536            /* bytes read at once */
#define LAST_WAIT 1.0          /* seconds in which a child may end by itself */
#define KILLED 5.0             /* seconds in which it must be gone when it is killed */
#define MOST_FILES 65536       /* that a process has open */

/* Signals that a watcher notes, and those that this process may handle and a watcher does not. */
static const int noted[]   = {SIGCHLD, SIGTERM, SIGINT, SIGHUP, SIGQUIT, SIGUSR1, SIGUSR2, SIGXCPU};
static const int crashes[] = {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL};
#define NUMBER(a) ((int)(sizeof(a) / sizeof *(a)))

static volatile sig_atomic_t asked; /* of a watcher: the signal that asks it to end */

struct MpmChild_ {
  pid_t     pid;          /* of its watcher */
  int       life;         /* open while the child shall live */
  int       in, out, err; /* our ends of its standard input, output and error; -1: closed */
  PetscReal timeout, until;
  char      failure[MPM_FAILURE_TEXT], errors[ERRORS_ROOM + 1], *line;
  char     *got; /* bytes that have come and were not taken yet: from begin to end */
  size_t    begin, end, room;
};

const char *MpmChildFailure(const MpmChild *child)
{
  return child->failure;
}

const char *MpmChildErrors(const MpmChild *child)
{
  return child->errors;
}

/* Notes the first failure. */
#define Fail(c, ...) (void)((c)->failure[0] || snprintf((c)->failure, sizeof(c)->failure, __VA_ARGS__))

/* A time in seconds as poll wants it. */
static int Milliseconds(PetscReal seconds)
{
  return (int)(PetscMin(seconds, 1e6) * 1000) + 1;
}

/* ---- the command ---- */

/*
   Splits a command into words in place; words ends with NULL. Returns their number, or -1 for an open quotation mark.
*/
static int Split(char *text, int room, char *words[])
{
  char *to = text, quote = '\0';
  int   n = 0;

  while (*text) {
    while (isspace((unsigned char)*text)) text++;
    if (!*text || n + 1 == room) break;
    words[n++] = to;
    for (; *text && (quote || !isspace((unsigned char)*text)); text++) {
      if (quote ? *text == quote : *text == '"' || *text == '\'')
        quote = quote ? '\0' : *text;
      else {
        if (*text == '\\' && quote != '\'' && text[1]) text++;
        *to++ = *text;
      }
    }
    if (quote) return -1;
    if (*text) text++;
    *to++ = '\0';
  }
  words[n] = NULL;
  return n;
}

/* ---- start ---- */

/* In the program, between fork and exec: only calls that are safe there. It ends when its watcher does. */
static void Become(char *const words[], const int pipes[3][2], int report)
{
  sigset_t none;
  int      error;

  (void)setpgid(0, 0);
  (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
  (void)signal(SIGPIPE, SIG_DFL);
  for (int i = 0; i < NUMBER(noted); i++) (void)signal(noted[i], SIG_DFL);
  (void)sigemptyset(&none);
  (void)sigprocmask(SIG_SETMASK, &none, NULL);
  if (dup2(pipes[0][0], 0) < 0 || dup2(pipes[1][1], 1) < 0 || dup2(pipes[2][1], 2) < 0) _exit(127);
  (void)execvp(words[0], words);
  error = errno;
  _exit(write(report, &error, sizeof error) == (ssize_t)sizeof error ? 127 : 126);
}

static void CloseBoth(const int pipe[2])
{
  for (int i = 0; i < 2; i++)
    if (pipe[i] >= 0) (void)close(pipe[i]);
}

static void Note(int number)
{
  if (number != SIGCHLD) asked = number; /* each of them ends ppoll */
}

/*
   Kills the program's group, and then all that has become the watcher's because its parent has ended, until none is
   left.
*/
static void KillAll(pid_t program)
{
  char children[64], text[4096];

  (void)snprintf(children, sizeof children, "/proc/self/task/%d/children", (int)getpid());
  (void)kill(-program, SIGKILL);
  do {
    const int     file = open(children, O_RDONLY);
    const ssize_t n    = file < 0 ? 0 : read(file, text, sizeof text - 1);
    char         *at = text, *end = text;

    if (file >= 0) (void)close(file);
    text[n > 0 ? n : 0] = '\0';
    for (long pid = strtol(at, &end, 10); end > at; pid = strtol(at = end, &end, 10)) (void)kill((pid_t)pid, SIGKILL);
  } while (waitpid(-1, NULL, 0) > 0);
}

/* Ends the watcher by a signal, so that its parent sees which one it was. */
static void EndBy(int number)
{
  sigset_t none;

  (void)setrlimit(RLIMIT_CORE, &(struct rlimit){0, 0}); /* the program has left one, if it was to */
  (void)signal(number, SIG_DFL);
  (void)sigemptyset(&none);
  (void)sigprocmask(SIG_SETMASK, &none, NULL);
  (void)raise(number);
}

/*
   The watcher: a process between this one and the program. It waits for the end of the program, whose status it ends
   with, or until the pipe 'life' closes, which it does when this process ends in whatever way, or until a signal asks
   it to end. In all cases it kills what is left of the program and of all that the program has started, also what has
   left the program's process group. It has a name of its own, so that 'pkill -KILL mpmstab' leaves it time to do so. It
   starts with all signals blocked, and takes them only in ppoll.
*/
static void Watch(char *const words[], const int pipes[3][2], int report, int life)
{
  struct sigaction note = {.sa_handler = Note};
  struct pollfd    end  = {.fd = 0, .events = POLLIN};
  sigset_t         none;
  pid_t            program;
  int              status = 0;

  (void)setpgid(0, 0);
  (void)prctl(PR_SET_CHILD_SUBREAPER, 1);
  (void)prctl(PR_SET_NAME, "program-watcher");
  (void)sigemptyset(&none);
  (void)sigfillset(&note.sa_mask);
  for (int i = 0; i < NUMBER(noted); i++) (void)sigaction(noted[i], &note, NULL);
  for (int i = 0; i < NUMBER(crashes); i++) (void)signal(crashes[i], SIG_DFL);
  program = fork();
  if (program == 0) Become(words, pipes, report);
  if (program < 0) _exit(write(report, &errno, sizeof errno) > 0 ? 127 : 126);
  (void)dup2(life, 0);
  for (int i = (int)PetscMin(sysconf(_SC_OPEN_MAX), MOST_FILES) - 1; i > 0; i--) (void)close(i);
  while (!end.revents && !asked && waitpid(program, &status, WNOHANG) == 0) (void)ppoll(&end, 1, NULL, &none);
  KillAll(program);
  if (asked) EndBy(asked);
  if (WIFSIGNALED(status)) EndBy(WTERMSIG(status));
  _exit(WEXITSTATUS(status));
}

/* Whether the program runs: the pipe report closes when exec succeeds; else it brings errno. */
static void TakeReport(MpmChild *c, int report)
{
  struct pollfd started = {.fd = report, .events = POLLIN};
  int           error   = 0;

  if (poll(&started, 1, Milliseconds(c->timeout)) == 0)
    Fail(c, "has not started within %g s (program_timeout)", c->timeout);
  else if (read(report, &error, sizeof error) == (ssize_t)sizeof error)
    Fail(c, "cannot be started: %s; allowed: a program that can be run from this folder", strerror(error));
}

static void Launch(MpmChild *c, char *const words[])
{
  sigset_t all, before;
  int      pipes[3][2] = {{-1, -1}, {-1, -1}, {-1, -1}}, report[2] = {-1, -1}, life[2] = {-1, -1}, error = 0;

  for (int i = 0; i < 3 && !error; i++) error = pipe2(pipes[i], O_CLOEXEC) ? errno : 0;
  if (!error && (pipe2(report, O_CLOEXEC) || pipe2(life, O_CLOEXEC))) error = errno;
  if (!error) {
    fflush(NULL);
    (void)sigfillset(&all);
    (void)sigprocmask(SIG_SETMASK, &all, &before);
    (void)setenv("MPMSTAB_ASKS", "1", 1); /* an adapter may keep standard output free from its first line on */
    c->pid = fork();
    if (c->pid == 0) Watch(words, (const int(*)[2])pipes, report[1], life[0]);
    if (c->pid < 0) error = errno;
    (void)sigprocmask(SIG_SETMASK, &before, NULL);
  }
  if (error) {
    for (int i = 0; i < 3; i++) CloseBoth(pipes[i]);
    CloseBoth(report);
    CloseBoth(life);
    Fail(c, "cannot be started: %s", strerror(error));
    return;
  }
  c->life = life[1];
  c->in   = pipes[0][1];
  c->out  = pipes[1][0];
  c->err  = pipes[2][0];
  (void)close(life[0]);
  (void)close(report[1]);
  (void)close(pipes[0][0]);
  (void)close(pipes[1][1]);
  (void)close(pipes[2][1]);
  (void)fcntl(c->in, F_SETFL, O_NONBLOCK);
  (void)fcntl(c->out, F_SETFL, O_NONBLOCK);
  (void)fcntl(c->err, F_SETFL, O_NONBLOCK);
  TakeReport(c, report[0]);
  (void)close(report[0]);
}

PetscErrorCode MpmChildStart(char *const words[], PetscReal timeout, MpmChild **child)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(child));
  **child = (MpmChild){.pid = -1, .life = -1, .in = -1, .out = -1, .err = -1, .timeout = timeout};
  (void)signal(SIGPIPE, SIG_IGN); /* a child that has ended is told by write */
  Launch(*child, words);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmChildStartCommand(const char command[], PetscReal timeout, MpmChild **child)
{
  const int room = (int)strlen(command) + 2;
  char     *text, **words;
  int       n;

  PetscFunctionBegin;
  PetscCall(PetscStrallocpy(command, &text));
  PetscCall(PetscMalloc1(room, &words));
  n = Split(text, room, words);
  MpmCheckInput(n != 0, "program: it names no command");
  MpmCheckInput(n > 0, "program %s: a quotation mark is open; allowed: a command and its words", command);
  PetscCall(MpmChildStart(words, timeout, child));
  PetscCall(PetscFree(words));
  PetscCall(PetscFree(text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- talk ---- */

static void Close(int *file)
{
  if (*file >= 0) (void)close(*file);
  *file = -1;
}

/*
   Keeps the end of what comes on standard error. Takes no more at once than a pipe holds: a child may write without
   end.
*/
static void ReadErrors(MpmChild *c)
{
  char    piece[4096];
  ssize_t n;

  for (int pieces = 0; c->err >= 0 && pieces < PIECE / (int)sizeof piece; pieces++) {
    const size_t have = strlen(c->errors);
    size_t       beyond, old;

    n = read(c->err, piece, sizeof piece);
    if (n < 0) return;
    if (n == 0) Close(&c->err);
    for (ssize_t i = 0; i < n; i++)
      if (!piece[i]) piece[i] = '?';
    beyond = have + (size_t)n > ERRORS_ROOM ? have + (size_t)n - ERRORS_ROOM : 0;
    old    = PetscMin(beyond, have);
    memmove(c->errors, c->errors + old, have - old);
    memcpy(c->errors + have - old, piece + beyond - old, (size_t)n - (beyond - old));
    c->errors[have + (size_t)n - beyond] = '\0';
  }
}

/* Waits for the watcher's end, up to a time. */
static pid_t Ended(const MpmChild *c, PetscReal until, int *status)
{
  pid_t done;

  while ((done = waitpid(c->pid, status, WNOHANG)) == 0 && MPI_Wtime() < until) (void)poll(NULL, 0, 5);
  return done;
}

/* How the child has ended, after a pipe to it or from it has. A child that only closed the pipe is ended. */
static void FailByEnd(MpmChild *c, const char pipe[])
{
  int         status = 0;
  const pid_t done   = Ended(c, MPI_Wtime() + LAST_WAIT, &status);

  ReadErrors(c);
  if (done == c->pid) c->pid = -1;
  if (done <= 0)
    Fail(c, "has closed its standard %s", pipe);
  else if (WIFSIGNALED(status))
    Fail(c, "was ended by signal %d (%s)", WTERMSIG(status), strsignal(WTERMSIG(status)));
  else
    Fail(c, "has ended with status %d", WEXITSTATUS(status));
}

static PetscErrorCode ReadOutput(MpmChild *c)
{
  ssize_t n;

  PetscFunctionBegin;
  if (c->begin == c->end) c->begin = c->end = 0;
  if (c->room - c->end < PIECE) {
    c->room = 2 * c->room + PIECE;
    PetscCall(PetscRealloc(c->room, &c->got));
  }
  n = read(c->out, c->got + c->end, c->room - c->end);
  if (n > 0) c->end += (size_t)n;
  if (n == 0) FailByEnd(c, "output");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Waits until the child can read (when writes) or has said something. */
static PetscErrorCode Wait(MpmChild *c, PetscBool writes, PetscBool *ready)
{
  struct pollfd   files[3] = {{.fd = c->out, .events = POLLIN},
                              {.fd = c->err, .events = POLLIN},
                              {.fd = writes ? c->in : -1, .events = POLLOUT}};
  const PetscReal left     = c->until - MPI_Wtime();

  PetscFunctionBegin;
  if (left <= 0 || poll(files, 3, Milliseconds(left)) == 0) {
    if (c->until <= MPI_Wtime()) Fail(c, "has not answered within %g s (program_timeout)", c->timeout);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (files[1].revents) ReadErrors(c);
  if (files[0].revents) PetscCall(ReadOutput(c));
  if (ready) *ready = files[2].revents ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Send(MpmChild *c, const void *bytes, size_t size)
{
  const char *from = bytes;

  PetscFunctionBegin;
  while (size > 0 && !c->failure[0]) {
    const size_t room  = PetscMin(size, PIECE);
    PetscBool    ready = PETSC_FALSE;
    ssize_t      n;

    PetscCall(Wait(c, PETSC_TRUE, &ready));
    if (!ready || c->failure[0]) continue;
    n = write(c->in, from, room);
    if (n > 0) {
      from += n;
      size -= (size_t)n;
    } else if (errno != EAGAIN && errno != EINTR)
      FailByEnd(c, "input");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads to the end of a line, and keeps the line for the caller. */
static PetscErrorCode ReadLine(MpmChild *c)
{
  size_t seen = 0;

  PetscFunctionBegin;
  while (!c->failure[0]) {
    char *end = c->end > c->begin + seen ? memchr(c->got + c->begin + seen, '\n', c->end - c->begin - seen) : NULL;

    if (end) {
      *end = '\0';
      PetscCall(PetscFree(c->line));
      PetscCall(PetscStrallocpy(c->got + c->begin, &c->line));
      c->begin = (size_t)(end - c->got) + 1;
      break;
    }
    seen = c->end - c->begin;
    if (seen > LONGEST_LINE)
      Fail(c, "answers with a line of more than %d bytes", LONGEST_LINE);
    else
      PetscCall(Wait(c, PETSC_FALSE, NULL));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A message is sent as a whole: a child that wakes at the first piece of it would only wait for the next one. */
static PetscErrorCode SendMessage(MpmChild *c, const char line[], const void *bytes, size_t size)
{
  const size_t length = strlen(line) + 1;
  char        *message;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(length + size, &message));
  PetscCall(PetscMemcpy(message, line, length - 1));
  message[length - 1] = '\n';
  PetscCall(PetscMemcpy(message + length, bytes, size));
  PetscCall(Send(c, message, length + size));
  PetscCall(PetscFree(message));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmChildTalk(MpmChild *c, const char line[], const void *bytes, size_t size, const char **answer)
{
  PetscFunctionBegin;
  *answer  = NULL;
  c->until = MPI_Wtime() + c->timeout;
  if (!c->failure[0] && c->end > c->begin)
    Fail(c, "has written to its standard output unasked: %.40s", c->got + c->begin);
  PetscCall(SendMessage(c, line, bytes, size));
  PetscCall(ReadLine(c));
  if (!c->failure[0]) *answer = c->line;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmChildTake(MpmChild *c, size_t size, void *bytes)
{
  PetscFunctionBegin;
  while (!c->failure[0] && c->end - c->begin < size) {
    const size_t have = c->end - c->begin;

    PetscCall(Wait(c, PETSC_FALSE, NULL));
    if (c->failure[0] && c->end - c->begin < size) {
      const size_t said = strlen(c->failure);

      (void)snprintf(c->failure + said, sizeof c->failure - said, "; of %zu bytes of its answer %zu came", size, have);
    }
  }
  if (c->failure[0]) {
    (void)memset(bytes, 0, size);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMemcpy(bytes, c->got + c->begin, size));
  c->begin += size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- end ---- */

PetscErrorCode MpmChildEnd(MpmChild **child, const char line[])
{
  MpmChild       *c     = *child;
  const PetscReal until = MPI_Wtime() + LAST_WAIT;

  PetscFunctionBegin;
  if (!c) PetscFunctionReturn(PETSC_SUCCESS);
  if (!c->failure[0]) {
    c->until = until;
    PetscCall(SendMessage(c, line, NULL, 0));
  }
  Close(&c->in);
  if (c->pid > 0 && (c->failure[0] || Ended(c, until, NULL) == 0)) {
    Close(&c->life); /* the watcher kills all that is left */
    (void)Ended(c, MPI_Wtime() + KILLED, NULL);
  }
  Close(&c->life);
  Close(&c->out);
  Close(&c->err);
  PetscCall(PetscFree(c->line));
  PetscCall(PetscFree(c->got));
  PetscCall(PetscFree(*child));
  PetscFunctionReturn(PETSC_SUCCESS);
}
