/* Results: values that are printed and kept in a tree, which becomes a JSON file. */
#include "report/report.h"
#include "base/errors_private.h"
#include "base/textfile.h"
#include <math.h>
#include <string.h>

#define FORMAT 1024
#define NAME 64

void MpmResultPut(json_t *result, const char name[], json_t *value)
{
  const char *dot = strchr(name, '.');
  char        outer[NAME];

  if (!dot) {
    (void)json_object_set_new(result, name, value);
    return;
  }
  (void)snprintf(outer, sizeof outer, "%.*s", (int)(dot - name), name);
  MpmResultPut(MpmResultIn(result, outer), dot + 1, value);
}

json_t *MpmResultIn(json_t *result, const char name[])
{
  if (!json_object_get(result, name)) (void)json_object_set_new(result, name, json_object());
  return json_object_get(result, name);
}

json_t *MpmResultList(json_t *result, const char name[])
{
  if (!json_object_get(result, name)) (void)json_object_set_new(result, name, json_array());
  return json_object_get(result, name);
}

json_t *MpmResultNext(json_t *result, const char name[])
{
  json_t *list = MpmResultList(result, name);

  (void)json_array_append_new(list, json_object());
  return json_array_get(list, json_array_size(list) - 1);
}

void MpmResultNumbers(json_t *result, const char name[], PetscInt n, const PetscReal values[])
{
  json_t *list = json_array();

  for (PetscInt i = 0; i < n; i++)
    (void)json_array_append_new(list, isfinite(values[i]) ? json_real(values[i]) : json_null());
  MpmResultPut(result, name, list);
}

void MpmResultVector(json_t *result, const char name[], PetscInt n, const PetscReal values[])
{
  if (n == 1)
    MpmResultPut(result, name, json_real(values[0]));
  else
    MpmResultNumbers(result, name, n, values);
}

/* The name behind a value, without its mark, '!' or '?'. Returns the mark, or 0. */
static char NameOf(const char brace[], char name[NAME])
{
  const char *last = strchr(brace, '}') - 1;
  const char  mark = *last == '!' || *last == '?' ? *last : '\0';

  (void)snprintf(name, NAME, "%.*s", (int)(last - brace - (mark ? 1 : 0)), brace + 1);
  return mark;
}

/* Walks through a format and keeps the values that have a name. */
static void Keep(json_t *result, const char format[], va_list arguments)
{
  for (const char *at = strchr(format, '%'); at; at = strchr(at, '%')) {
    const char *kind  = at + 1 + strcspn(at + 1, "%cdefgs");
    const char *text  = *kind == 's' ? va_arg(arguments, const char *) : NULL;
    double      real  = NAN;
    json_int_t  whole = 0;
    json_t     *value;
    char        name[NAME], mark;

    if (*kind == 'd' && kind[-1] == 'l')
      whole = kind[-2] == 'l' ? va_arg(arguments, long long) : va_arg(arguments, long);
    else if (*kind == 'd' || *kind == 'c')
      whole = va_arg(arguments, int);
    else if (*kind != '%' && *kind != 's')
      real = va_arg(arguments, double);
    at = kind + 1;
    if (*at != '{') continue;
    mark  = NameOf(at, name);
    value = text             ? json_string(text)
            : mark == '?'    ? json_boolean(whole)
            : *kind == 'd'   ? json_integer(whole)
            : isfinite(real) ? json_real(real)
            : mark == '!'    ? json_null()
                             : NULL;
    if (value) MpmResultPut(result, name, value);
  }
}

/* Leaves out the names of values. */
static void Strip(const char format[], char plain[FORMAT])
{
  size_t n = 0;

  for (PetscBool in = PETSC_FALSE; *format && n + 1 < FORMAT; format++) {
    if (format[0] == '{') in = PETSC_TRUE;
    if (!in) plain[n++] = *format;
    if (format[0] == '}') in = PETSC_FALSE;
  }
  plain[n] = '\0';
}

void MpmResultKeep(json_t *result, const char format[], ...)
{
  va_list arguments;

  va_start(arguments, format);
  Keep(result, format, arguments);
  va_end(arguments);
}

void MpmResultSay(json_t *result, const char format[], ...)
{
  char    plain[FORMAT];
  va_list arguments;

  Strip(format, plain);
  va_start(arguments, format);
  MpmPrintArguments(plain, arguments);
  va_end(arguments);
  va_start(arguments, format);
  Keep(result, format, arguments);
  va_end(arguments);
}

PetscErrorCode MpmResultEnd(const MpmRequest *request, PetscReal wall_s, json_t **result)
{
  MpmTextFile file;

  PetscFunctionBegin;
  PetscCheck(*result, PETSC_COMM_SELF, PETSC_ERR_LIB, "jansson could not build the result");
  MpmResultKeep(*result, "%g{wall_s}", wall_s);
  if (request->json[0]) {
    PetscCall(MpmTextFileOpen(request->json, &file));
    if (file.stream &&
        (json_dumpf(*result, file.stream, JSON_INDENT(2) | JSON_REAL_PRECISION(17)) || fputc('\n', file.stream) == EOF))
      PetscCall(PetscInfo(NULL, "writing %s failed; closing it says why\n", request->json));
    PetscCall(MpmTextFileClose(&file));
  }
  json_decref(*result);
  *result = NULL;
  MpmPrintRelease();
  PetscFunctionReturn(PETSC_SUCCESS);
}
