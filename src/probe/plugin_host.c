/* Loads a shared library, and answers the messages of protocol 1 with its functions. */
#include "probe/plugin_host.h"
#include <dlfcn.h>
#include <fcntl.h>
#include <jansson.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define SAID 400 /* bytes of what a library says that stand in a failure */
#define BATCH 64 /* states that may come in one request, and are stepped one after another */

/* dim, particles, width: as described, or of the scene since; room: of state. */
typedef struct {
  void *library;
  const char *(*describe)(const double **state);
  int (*set)(const char name[], double value);
  int (*step)(int steps, int64_t particles, double state[]);
  int (*scene)(const char message[], int64_t particles, const double period[], const double given[], double state[]);
  void (*reset)(void);
  const char *(*error)(void);
  FILE   *in, *out;
  size_t  dim, particles, width, room;
  double *state;
} Host;

/* Answers with a failure. */
static void Fail(Host *h, const char format[], ...) __attribute__((format(printf, 2, 3)));
static void Fail(Host *h, const char format[], ...)
{
  char    text[2048];
  json_t *answer, *words;
  va_list arguments;

  va_start(arguments, format);
  (void)vsnprintf(text, sizeof text, format, arguments);
  va_end(arguments);
  words = json_string(text);
  if (!words) { /* no UTF-8 */
    for (char *c = text; *c; c++)
      if (*c & 0x80) *c = '?';
    words = json_string(text);
  }
  answer = json_pack("{s:o}", "failure", words);
  (void)json_dumpf(answer, h->out, JSON_COMPACT);
  (void)fputc('\n', h->out);
  json_decref(answer);
}

static const char *Said(const Host *h)
{
  const char *said = h->error ? h->error() : NULL;

  return said ? said : "it does not say why";
}

/* C has no conversion between pointers to objects and to functions; POSIX has this one. Returns whether it is there. */
static int Find(Host *h, const char name[], void *function)
{
  *(void **)function = dlsym(h->library, name);
  if (!*(void **)function) Fail(h, "it has no function %s (see <mpmstab/plugin.h>)", name);
  return *(void **)function != NULL;
}

static int Open(Host *h, const char path[])
{
  char *here = malloc(strlen(path) + 3);

  if (!here) return 0;
  (void)sprintf(here, "%s%s", strchr(path, '/') ? "" : "./", path);
  h->library = dlopen(here, RTLD_NOW | RTLD_LOCAL);
  free(here);
  if (!h->library) {
    Fail(h, "cannot be loaded: %.*s; allowed: a shared library", SAID, dlerror());
    return 0;
  }
  *(void **)&h->error = dlsym(h->library, "mpmstab_error");
  return Find(h, "mpmstab_describe", &h->describe) && Find(h, "mpmstab_set", &h->set) &&
         Find(h, "mpmstab_step", &h->step);
}

/*
   Takes the size of the state from the description, 0 when that is wrong, which its reader says; and writes it as one
   line, with the states that may come in one request. What is no JSON goes as it is: its reader says so.
*/
static void WriteDescription(Host *h, const char text[], json_t *description)
{
  const json_t *field;
  size_t        f;

  h->particles = (size_t)json_integer_value(json_object_get(description, "particles"));
  h->dim       = (size_t)json_integer_value(json_object_get(description, "dim"));
  h->width     = 0;
  json_array_foreach (json_object_get(description, "fields"), f, field) {
    h->width += (size_t)json_integer_value(json_object_get(field, "size"));
  }
  if (!json_is_object(description)) {
    for (const char *c = text; *c; c++) (void)fputc(*c == '\n' || *c == '\r' ? ' ' : *c, h->out);
  } else {
    if (!json_object_get(description, "batch")) (void)json_object_set_new(description, "batch", json_integer(BATCH));
    (void)json_dumpf(description, h->out, JSON_COMPACT | JSON_REAL_PRECISION(17));
  }
  (void)fputc('\n', h->out);
}

static void Describe(Host *h, const char path[])
{
  const double *state = NULL;
  const char   *text;
  json_t       *description;

  if (!h->library && !Open(h, path)) return;
  text        = h->describe(&state);
  description = text ? json_loads(text, 0, NULL) : NULL;
  if (!text)
    Fail(h, "describe: %.*s", SAID, Said(h));
  else if (!state && !json_is_true(json_object_get(description, "scenes")))
    Fail(h, "describe gives no base state");
  else {
    WriteDescription(h, text, description);
    (void)fflush(h->out); /* what it says of a state may not be so */
    if (state) (void)fwrite(state, sizeof *state, h->particles * h->width, h->out);
  }
  json_decref(description);
}

static void Set(Host *h, json_t *message)
{
  const char *name;
  json_t     *value;

  json_object_foreach(message, name, value)
  {
    if (!json_is_number(value)) continue;
    if (h->set(name, json_number_value(value)))
      Fail(h, "set %s to %.17g: %.*s", name, json_number_value(value), SAID, Said(h));
    else
      (void)fputs("{}\n", h->out);
  }
}

/* Makes room for n numbers of states. Returns whether there is memory for them. */
static int Room(Host *h, size_t n)
{
  if (n <= h->room) return 1;
  free(h->state);
  h->state = calloc(n, sizeof *h->state);
  h->room  = h->state ? n : 0;
  return h->state != NULL;
}

/* Returns whether the places, volumes and masses have come and there is memory for them. */
static int Scene(Host *h, const char line[], const json_t *message)
{
  const size_t particles = (size_t)json_integer_value(json_object_get(message, "particles")),
               n         = particles * (h->dim + 2);
  const json_t *periodic = json_object_get(message, "periodic");
  double       *given = calloc(n, sizeof *given), period[3] = {0};
  int           came = given && fread(given, sizeof *given, n, h->in) == n && Room(h, particles * h->width);

  for (size_t a = 0; a < h->dim && a < 3; a++) period[a] = json_number_value(json_array_get(periodic, a));
  h->particles = particles;
  if (came && (h->scene || Find(h, "mpmstab_scene", &h->scene))) {
    if (h->scene(line, (int64_t)particles, period, given, h->state))
      Fail(h, "scene: %.*s", SAID, Said(h));
    else {
      (void)fputs("{}\n", h->out);
      (void)fwrite(h->state, sizeof *h->state, particles * h->width, h->out);
    }
  }
  free(given);
  return came;
}

/* Returns whether the states have come and there is memory for them. */
static int Step(Host *h, const json_t *message)
{
  const json_t *given = json_object_get(message, "particles"), *many = json_object_get(message, "states");
  const size_t  particles = given ? (size_t)json_integer_value(given) : h->particles, one = particles * h->width;
  const size_t  n     = one * (many ? (size_t)json_integer_value(many) : 1);
  const int     steps = (int)json_integer_value(json_object_get(message, "steps"));

  if (!Room(h, n) || fread(h->state, sizeof *h->state, n, h->in) != n) return 0;
  for (size_t at = 0; at < n; at += one) {
    if (json_is_true(json_object_get(message, "reset"))) {
      if (!h->reset && !Find(h, "mpmstab_reset", &h->reset)) return 1;
      h->reset();
    }
    if (!h->step(steps, (int64_t)particles, h->state + at)) continue;
    Fail(h, "step: %.*s", SAID, Said(h));
    return 1;
  }
  (void)fputs("{}\n", h->out);
  (void)fwrite(h->state, sizeof *h->state, n, h->out);
  return 1;
}

/* The pipes get numbers of their own, which nothing that the library starts inherits. */
static int OpenPipes(Host *h)
{
  const int in = fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 3), out = fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, 3);
  const int nothing = open("/dev/null", O_RDONLY);

  if (in < 0 || out < 0 || nothing < 0 || dup2(nothing, STDIN_FILENO) < 0 || dup2(STDERR_FILENO, STDOUT_FILENO) < 0)
    return 0;
  (void)close(nothing);
  h->in  = fdopen(in, "r");
  h->out = fdopen(out, "w");
  return h->in && h->out;
}

int MpmPluginHost(const char path[])
{
  Host   h    = {0};
  char  *line = NULL;
  size_t room = 0;
  int    goes = OpenPipes(&h);

  if (!goes) return 1;
  while (goes && getline(&line, &room, h.in) > 0) {
    json_t     *message = json_loads(line, 0, NULL);
    const char *what    = json_string_value(json_object_get(message, "do"));

    if (what && !strcmp(what, "describe"))
      Describe(&h, path);
    else if (what && !strcmp(what, "set"))
      Set(&h, message);
    else if (what && !strcmp(what, "scene"))
      goes = Scene(&h, line, message);
    else
      goes = what && !strcmp(what, "step") ? Step(&h, message) : 0;
    json_decref(message);
    (void)fflush(h.out);
  }
  if (h.library) (void)dlclose(h.library);
  free(line);
  free(h.state);
  return 0;
}
