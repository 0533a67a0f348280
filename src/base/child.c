/*
   A child process with three pipes. All reading and writing waits in one place, Wait, so that a child that writes while
   it should read, or that floods standard error, cannot block both sides.
*/
#define _GNU_SOURCE /* pipe2, prctl */
#include "base/child.h"
#include <mpmstab/errors.h>
#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#define ERRORS_ROOM 2048     /* bytes of standard error that are kept */
#define LONGEST_LINE 4194304 /* bytes of an answer's line */
#define PIECE 65536          /* bytes read at once */
#define LAST_WAIT 1.0        /* seconds in which a child may end by itself */

struct MpmChild_ {
  pid_t     pid;
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

static void Fail(MpmChild *c, const char format[], ...) __attribute__((format(printf, 2, 3)));
static void Fail(MpmChild *c, const char format[], ...)
{
  va_list arguments;

  if (c->failure[0]) return;
  va_start(arguments, format);
  (void)vsnprintf(c->failure, sizeof c->failure, format, arguments);
  va_end(arguments);
}

/* ---- the command ---- */

/* Splits a command into words in place; words ends with NULL. Returns their number, or -1 for an open quotation mark. */
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

/* In the child, between fork and exec: only calls that are safe there. It ends when its parent does. */
static void Become(char *words[], const int pipes[3][2], int report, pid_t parent)
{
  sigset_t none;

  (void)setpgid(0, 0);
  (void)prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);
  (void)sigemptyset(&none);
  (void)sigprocmask(SIG_SETMASK, &none, NULL);
  (void)signal(SIGPIPE, SIG_DFL);
  if (dup2(pipes[0][0], 0) < 0 || dup2(pipes[1][1], 1) < 0 || dup2(pipes[2][1], 2) < 0) _exit(127);
  (void)execvp(words[0], words);
  {
    const int     error = errno;
    const ssize_t told  = write(report, &error, sizeof error);

    _exit(told == (ssize_t)sizeof error ? 127 : 126);
  }
}

static void CloseBoth(const int pipe[2])
{
  for (int i = 0; i < 2; i++)
    if (pipe[i] >= 0) (void)close(pipe[i]);
}

/* Forks. The pipe report closes when exec succeeds; else it brings errno. */
static void Launch(MpmChild *c, char *words[])
{
  int         pipes[3][2] = {{-1, -1}, {-1, -1}, {-1, -1}}, report[2] = {-1, -1}, error = 0;
  const pid_t parent = getpid();

  for (int i = 0; i < 3 && !error; i++) error = pipe2(pipes[i], O_CLOEXEC) ? errno : 0;
  if (!error && pipe2(report, O_CLOEXEC)) error = errno;
  if (!error) {
    fflush(NULL);
    c->pid = fork();
    if (c->pid == 0) Become(words, (const int(*)[2])pipes, report[1], parent);
    if (c->pid < 0) error = errno;
  }
  if (!error) {
    (void)close(report[1]);
    report[1] = -1;
    if (read(report[0], &error, sizeof error) != (ssize_t)sizeof error) error = 0;
  }
  CloseBoth(report);
  if (error) {
    for (int i = 0; i < 3; i++) CloseBoth(pipes[i]);
    Fail(c, "cannot be started: %s; allowed: a program that can be run from this folder", strerror(error));
    return;
  }
  c->in  = pipes[0][1];
  c->out = pipes[1][0];
  c->err = pipes[2][0];
  (void)close(pipes[0][0]);
  (void)close(pipes[1][1]);
  (void)close(pipes[2][1]);
  (void)fcntl(c->in, F_SETFL, O_NONBLOCK);
  (void)fcntl(c->out, F_SETFL, O_NONBLOCK);
  (void)fcntl(c->err, F_SETFL, O_NONBLOCK);
}

PetscErrorCode MpmChildStart(const char command[], PetscReal timeout, MpmChild **child)
{
  const int room = (int)strlen(command) + 2;
  char     *text, **words;
  int       n;

  PetscFunctionBegin;
  PetscCall(PetscNew(child));
  **child = (MpmChild){.pid = -1, .in = -1, .out = -1, .err = -1, .timeout = timeout};
  PetscCall(PetscStrallocpy(command, &text));
  PetscCall(PetscMalloc1(room, &words));
  n = Split(text, room, words);
  MpmCheckInput(n != 0, "program: it names no command");
  MpmCheckInput(n > 0, "program %s: a quotation mark is open; allowed: a command and its words", command);
  (void)signal(SIGPIPE, SIG_IGN); /* a child that has ended is told by write */
  Launch(*child, words);
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

/* Keeps the end of what comes on standard error. */
static void ReadErrors(MpmChild *c)
{
  char    piece[4096];
  ssize_t n;

  while (c->err >= 0 && (n = read(c->err, piece, sizeof piece)) != 0) {
    size_t have = strlen(c->errors), most;

    if (n < 0) return;
    most = have + (size_t)n > ERRORS_ROOM ? have + (size_t)n - ERRORS_ROOM : 0;
    for (ssize_t i = 0; i < n; i++)
      if (!piece[i]) piece[i] = '?';
    if (most >= have) {
      have = 0;
      most = (size_t)n > ERRORS_ROOM ? (size_t)n - ERRORS_ROOM : 0;
      memcpy(c->errors, piece + most, (size_t)n - most);
      c->errors[(size_t)n - most] = '\0';
    } else {
      memmove(c->errors, c->errors + most, have - most);
      memcpy(c->errors + have - most, piece, (size_t)n);
      c->errors[have - most + (size_t)n] = '\0';
    }
  }
  Close(&c->err);
}

/* How the child has ended, after its output has. A child that only closed its output is ended. */
static void FailByEnd(MpmChild *c)
{
  const PetscReal until  = MPI_Wtime() + LAST_WAIT;
  int             status = 0;
  pid_t           done;

  while ((done = waitpid(c->pid, &status, WNOHANG)) == 0 && MPI_Wtime() < until) (void)poll(NULL, 0, 10);
  ReadErrors(c);
  if (done == c->pid) c->pid = -1;
  if (done <= 0)
    Fail(c, "has closed its standard output");
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
  if (n == 0) FailByEnd(c);
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
  if (left <= 0 || poll(files, 3, (int)(left * 1000) + 1) == 0) {
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
      FailByEnd(c);
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

PetscErrorCode MpmChildTalk(MpmChild *c, const char line[], const void *bytes, size_t size, const char **answer)
{
  PetscFunctionBegin;
  *answer  = NULL;
  c->until = MPI_Wtime() + c->timeout;
  if (!c->failure[0] && c->end > c->begin)
    Fail(c, "has written to its standard output unasked: %.40s", c->got + c->begin);
  PetscCall(Send(c, line, strlen(line)));
  PetscCall(Send(c, "\n", 1));
  PetscCall(Send(c, bytes, size));
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
    PetscCall(Send(c, line, strlen(line)));
    PetscCall(Send(c, "\n", 1));
  }
  Close(&c->in);
  if (c->pid > 0) {
    while (!c->failure[0] && waitpid(c->pid, NULL, WNOHANG) == 0 && MPI_Wtime() < until) (void)poll(NULL, 0, 5);
    (void)kill(-c->pid, SIGKILL); /* with what it has started */
    (void)waitpid(c->pid, NULL, 0);
  }
  Close(&c->out);
  Close(&c->err);
  PetscCall(PetscFree(c->line));
  PetscCall(PetscFree(c->got));
  PetscCall(PetscFree(*child));
  PetscFunctionReturn(PETSC_SUCCESS);
}
