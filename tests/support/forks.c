/*
   mpmstab for tests: without words it waits, with its libraries loaded, and runs each command that it reads in a fork of
   itself. A fork is what main.c is, from its first line to its end. To load some hundred libraries takes longer than all
   else that a short command does. tests/support/forks.py asks.

   A request is a line of standard input, which is JSON: folder, out, err (paths), words, and environment, the variables
   that are not as here (null: none). The answer is two lines on standard output: the id of the process, and then its
   status as wait4 gives it and processor time in milliseconds.
*/
#define _DEFAULT_SOURCE /* wait4 */
#include <errno.h>
#include <fcntl.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

int MpmMain(int argc, char **argv); /* main of src/main.c, which is compiled anew with this name */

static const char *TextOf(const json_t *request, const char name[])
{
  return json_string_value(json_object_get(request, name));
}

static int Redirect(int file, const char path[], int flags)
{
  int opened = open(path, flags, 0666);

  if (opened < 0 || dup2(opened, file) < 0) return 0;
  return opened == file || !close(opened);
}

/* The fork: its files, its folder and its words are those of the request. */
static int Run(char program[], const json_t *request)
{
  const json_t *words = json_object_get(request, "words");
  const int     count = (int)json_array_size(words);
  char        **argv  = calloc((size_t)count + 2, sizeof *argv);
  const char   *name;
  json_t       *value;

  if (!argv || !Redirect(0, "/dev/null", O_RDONLY) ||
      !Redirect(1, TextOf(request, "out"), O_WRONLY | O_CREAT | O_TRUNC) ||
      !Redirect(2, TextOf(request, "err"), O_WRONLY | O_CREAT | O_TRUNC) || chdir(TextOf(request, "folder"))) {
    perror("forks.c: a request that cannot be");
    return 127;
  }
  json_object_foreach(json_object_get(request, "environment"), name, value)
  {
    if (json_is_null(value) ? unsetenv(name) : setenv(name, json_string_value(value), 1)) return 127;
  }
  argv[0] = program;
  for (int i = 0; i < count; i++) argv[i + 1] = strdup(json_string_value(json_array_get(words, (size_t)i)));
  return MpmMain(count + 1, argv);
}

static int Tell(long number, const struct rusage *used)
{
  char line[64];
  long time =
      1000 * (used->ru_utime.tv_sec + used->ru_stime.tv_sec) + (used->ru_utime.tv_usec + used->ru_stime.tv_usec) / 1000;
  int length = snprintf(line, sizeof line, "%ld %ld\n", number, time);

  return write(1, line, (size_t)length) == length;
}

int main(int argc, char **argv)
{
  char   *line = NULL;
  size_t  room = 0;
  int     from = fcntl(0, F_DUPFD_CLOEXEC, 10), status;
  FILE   *file = from < 0 ? NULL : fdopen(from, "r");
  json_t *request;
  pid_t   child;

  struct rusage used = {0};

  if (argc > 1) return MpmMain(argc, argv); /* a fork starts its own program to ask a plugin */
  while (file && getline(&line, &room, file) > 0) {
    request = json_loads(line, 0, NULL);
    child   = request ? fork() : -1;
    if (!child) {
      (void)close(from);
      exit(Run(argv[0], request));
    }
    if (child < 0 || !Tell(child, &used)) return 1;
    while (wait4(child, &status, 0, &used) < 0)
      if (errno != EINTR) return 1;
    if (!Tell(status, &used)) return 1;
    json_decref(request);
  }
  return 0;
}
