/*
   A JSON schema of scenes, made from the fields, for editors that complete and check YAML: keys, what their values may be,
   and what they mean.
*/
#include "scene/fields.h"
#include "task/task.h"
#include <jansson.h>
#include <string.h>

/* A new object of a type. */
static json_t *Type(const char type[])
{
  return json_pack("{s:s}", "type", type);
}

/* A number within the bounds of an option. */
static json_t *Number(const MpmField *o, const char type[])
{
  json_t *number = Type(type);

  if (o->lo > -PETSC_MAX_REAL)
    json_object_set_new(number, o->lo_open ? "exclusiveMinimum" : "minimum", json_real(o->lo));
  if (o->hi < PETSC_MAX_REAL) json_object_set_new(number, "maximum", json_real(o->hi));
  return number;
}

/* A number, or text: a fraction, or 1e-6, which readers of YAML 1.1 take for text. */
static json_t *Fraction(const MpmField *o)
{
  return json_pack("{s:[o,{s:s,s:s}]}", "anyOf", Number(o, "number"), "type", "string", "pattern",
                   "^[-+]?[0-9.]+([eE][-+]?[0-9]+)?(/[0-9]+)?$");
}

static json_t *Word(const MpmField *o)
{
  json_t *words = json_array();

  for (PetscInt i = 0; MpmFieldWord(o, i); i++) json_array_append_new(words, json_string(MpmFieldWord(o, i)));
  return json_pack("{s:o}", "enum", words);
}

static json_t *Several(json_t *item, int least, int most)
{
  return json_pack("{s:s,s:o,s:i,s:i}", "type", "array", "items", item, "minItems", least, "maxItems", most);
}

/* One value of an option, for one direction. */
static json_t *One(const MpmField *o)
{
  switch (o->kind) {
  case MPM_INTEGER:
    return Number(o, "integer");
  case MPM_REAL:
  case MPM_FRACTION:
    return Fraction(o);
  case MPM_SWITCH:
    return Type("boolean");
  case MPM_WORD:
    return Word(o);
  case MPM_RANGE:
  case MPM_SPAN:
    return json_pack("{s:[o,{s:s}]}", "anyOf", Several(Fraction(o), 2, 2), "type", "string");
  default:
    return Type("string");
  }
}

/* A word that may stand in the place of a number. */
static json_t *OrAlso(const MpmField *o, json_t *value)
{
  return o->also ? json_pack("{s:[o,{s:s}]}", "anyOf", value, "const", o->also) : value;
}

/* Lists, ranges, ends and words may be text with commas or an array; so may a value for each direction. */
static json_t *Value(const MpmField *o)
{
  if (o->kind == MPM_BLOCKS) return json_pack("{s:[s,s,s]}", "type", "object", "array", "string");
  if (o->kind == MPM_LIST) return json_pack("{s:[s,s,s]}", "type", "integer", "string", "array");
  if (o->kind == MPM_ENDS || o->kind == MPM_WORDS) return json_pack("{s:[s,s]}", "type", "string", "array");
  if (o->kind == MPM_WORD && !strcmp(o->name, "formulation")) return Word(o);
  if (!o->each) return OrAlso(o, One(o));
  return json_pack("{s:[o,o,{s:s,s:s}]}", "anyOf", One(o), Several(One(o), 1, 2 * MPM_MAX_DIM), "type", "string",
                   "pattern", ",");
}

static json_t *Described(const MpmField *o)
{
  json_t *value = Value(o);

  json_object_set_new(value, "description", json_string(o->help));
  if (o->fallback) json_object_set_new(value, "default", json_string(o->fallback));
  return value;
}

PetscErrorCode MpmPrintSchema(void)
{
  json_t *keys = json_object(), *expect = json_object(), *names = json_array(), *schema;
  char   *text;

  PetscFunctionBegin;
  for (const MpmField *o = MpmOptions; o->name; o++) {
    const char *inside = strncmp(o->name, "expect_", 7) ? NULL : o->name + 7;

    if (o->no_key) continue;
    if (inside)
      json_object_set_new(expect, inside, Described(o));
    else
      json_object_set_new(keys, o->name, Described(o));
    json_array_append_new(names, json_string(o->name));
  }
  json_object_set(expect, "verdict", json_object_get(keys, "expect"));
  json_object_set_new(keys, "expect",
                      json_pack("{s:[O,{s:s,s:o,s:b}]}", "anyOf", json_object_get(keys, "expect"), "type", "object",
                                "properties", expect, "additionalProperties", 0));
  json_object_set_new(keys, "scheme", json_pack("{s:[s,s]}", "type", "string", "object"));
  /* a scheme as text may have parameters, whose names are keys too */
  schema =
      json_pack("{s:s,s:s,s:s,s:s,s:o,s:{s:[s]},s:{s:{s:o}}}", "$schema", "http://json-schema.org/draft-07/schema#",
                "title", "a scene of mpmstab", "description", "keys of a scene file; mpmstab list options", "type",
                "object", "properties", keys, "if", "required", "scheme", "else", "propertyNames", "enum", names);
  PetscCheck(schema, PETSC_COMM_SELF, PETSC_ERR_LIB, "the schema cannot be made");
  text = json_dumps(schema, JSON_INDENT(1) | JSON_SORT_KEYS | JSON_REAL_PRECISION(12));
  PetscCheck(text, PETSC_COMM_SELF, PETSC_ERR_LIB, "the schema cannot be written");
  MpmPrint("%s\n", text);
  free(text);
  json_decref(schema);
  PetscFunctionReturn(PETSC_SUCCESS);
}
