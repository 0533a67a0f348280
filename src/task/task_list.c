/*
   The task list: mpmstab list [formulation [NAME]|basis|transfer [NAME
   [NUMBER]]|boundary|layout|options|versions|scope|codes]; and what is installed beside the program, made from its
   lists of tasks and options.
*/
#include "base/suggest.h"
#include "report/report.h"
#include "scene/fields.h"
#include "scheme/language.h"
#include "task/task.h"
#include <jansson.h>
#include <math.h>
#include <slepcsys.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static void PrintWords(const MpmField *o)
{
  for (PetscInt i = 0; MpmFieldWord(o, i); i++) MpmPrint("%s%s", i ? " " : "", MpmFieldWord(o, i));
}

static void PrintBash(void)
{
  MpmPrint("# bash completion for mpmstab; made by 'mpmstab list completion-bash'\n"
           "_mpmstab() {\n"
           "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD-1]} task=${COMP_WORDS[1]} options\n"
           "  COMPREPLY=()\n"
           "  if [ \"$COMP_CWORD\" -eq 1 ]; then COMPREPLY=($(compgen -W '");
  for (const MpmTask *task = MpmTasks; task->name; task++) MpmPrint("%s ", task->name);
  MpmPrint("help version' -- \"$cur\")); return; fi\n"
           "  case $prev in\n");
  for (const MpmField *o = MpmOptions; o->name; o++) {
    if (o->kind == MPM_PATH) MpmPrint("    -%s) COMPREPLY=($(compgen -f -- \"$cur\")); return ;;\n", o->name);
    if (!MpmFieldWord(o, 0)) continue;
    MpmPrint("    -%s) COMPREPLY=($(compgen -W '", o->name);
    PrintWords(o);
    MpmPrint("' -- \"$cur\")); return ;;\n");
  }
  MpmPrint("  esac\n"
           "  case $task in\n");
  for (const MpmTask *task = MpmTasks; task->name; task++) {
    MpmPrint("    %s) options='", task->name);
    for (const MpmField *o = MpmOptions; o->name; o++)
      if (!task->words && MpmFieldIsOf(o, task->name)) MpmPrint("-%s ", o->name);
    MpmPrint("' ;;\n");
  }
  MpmPrint("  esac\n"
           "  case $cur in\n"
           "    -*) COMPREPLY=($(compgen -W \"$options\" -- \"$cur\")) ;;\n"
           "    *) COMPREPLY=($(compgen -f -X '!*.y*ml' -- \"$cur\") $(compgen -d -- \"$cur\")) ;;\n"
           "  esac\n"
           "}\n"
           "complete -o filenames -F _mpmstab mpmstab\n");
}

static void PrintZsh(void)
{
  MpmPrint("#compdef mpmstab\n# made by 'mpmstab list completion-zsh'\n_arguments \\\n  '1:task:(");
  for (const MpmTask *task = MpmTasks; task->name; task++) MpmPrint("%s ", task->name);
  MpmPrint("help version)' \\\n");
  for (const MpmField *o = MpmOptions; o->name; o++) {
    MpmPrint("  '-%s[", o->name);
    for (const char *c = o->help; *c; c++) /* in a pair of single quotes, inside brackets of _arguments */
      MpmPrint(*c == '\'' ? "'\\''" : strchr("[]:", *c) ? "\\%c" : "%c", *c);
    MpmPrint("]");
    if (o->kind == MPM_PATH) MpmPrint(":file:_files");
    if (MpmFieldWord(o, 0)) {
      MpmPrint(":word:(");
      PrintWords(o);
      MpmPrint(")");
    } else if (o->kind != MPM_PATH && o->kind != MPM_SWITCH)
      MpmPrint(":value: ");
    MpmPrint("' \\\n");
  }
  MpmPrint("  '*:scene:_files -g \"*.y(a|)ml\"'\n");
}

/* ---- the man page. Source of the macros: man(7) ---- */

/* Text as roff takes it: a backslash begins an escape, a dash is a minus, and a dot or a quote begins a request. */
static void Put(const char text[])
{
  if (text[0] == '.' || text[0] == '\'') MpmPrint("\\&");
  for (const char *c = text; *c; c++) {
    if (*c == '\\')
      MpmPrint("\\e");
    else if (*c == '-')
      MpmPrint("\\-");
    else
      MpmPrint("%c", *c);
  }
}

static void PutOption(const MpmField *o)
{
  MpmPrint(".TP\n\\fB\\-%s\\fR", o->name);
  if (o->kind != MPM_SWITCH) MpmPrint(" \\fIvalue\\fR");
  if (o->fallback) {
    MpmPrint(" (default ");
    Put(o->fallback);
    MpmPrint(")");
  }
  MpmPrint("\n");
  Put(o->help);
  if (o->tasks) MpmPrint(". Tasks: %s", o->tasks);
  MpmPrint(".\n");
  if (!MpmFieldWord(o, 0)) return;
  MpmPrint("Words:");
  for (PetscInt i = 0; MpmFieldWord(o, i); i++) {
    MpmPrint(i ? ", " : " ");
    Put(MpmFieldWord(o, i));
  }
  MpmPrint(".\n");
}

static void PrintManual(void)
{
  MpmPrint(
      ".TH MPMSTAB 1 \"\" \"mpmstab %s\" \"User commands\"\n"
      ".SH NAME\nmpmstab \\- stability and accuracy of the material point method\n"
      ".SH SYNOPSIS\n[\\fBmpirun \\-n\\fR \\fIranks\\fR] \\fBmpmstab\\fR \\fItask\\fR [\\fIscene.yaml\\fR] "
      "[\\fB\\-option\\fR \\fIvalue\\fR]...\n"
      ".SH DESCRIPTION\nmpmstab answers whether a scheme of the material point method is stable, for which time "
      "step, how accurate it is, and why.\nA scene is a file of options, one \\fIkey: value\\fR a line; options of "
      "the command line take the place of its own.\n"
      ".SH TASKS\n",
      MPMSTAB_VERSION);
  for (const MpmTask *task = MpmTasks; task->name; task++) {
    MpmPrint(".TP\n\\fB%s\\fR\n", task->name);
    Put(task->summary);
    MpmPrint(".\nExample: \\fBmpmstab ");
    Put(task->example);
    MpmPrint("\\fR\n");
  }
  MpmPrint(".SH OPTIONS\n");
  for (const MpmField *o = MpmOptions; o->name; o++) PutOption(o);
  MpmPrint(".SH EXIT STATUS\n"
           "0: done. 1: an error that is not the user's. 2: bad input; one line says which option or file, and what is "
           "allowed. 3: done, but something came out that the scene does not expect. 143: a signal ended the work.\n"
           ".SH MPI\nAs root, Open MPI's mpirun wants OMPI_ALLOW_RUN_AS_ROOT=1 and OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 in "
           "the environment; with more ranks than cores it wants \\-\\-oversubscribe.\n");
}

/*
   A JSON schema of scenes, made from the fields, for editors that complete and check YAML: keys, what their values may
   be, and what they mean.
*/

/* A number within the bounds of an option. */
static json_t *Number(const MpmField *o, const char type[])
{
  json_t *number = json_pack("{s:s}", "type", type);

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
    return json_pack("{s:s}", "type", "boolean");
  case MPM_WORD:
    return Word(o);
  case MPM_RANGE:
  case MPM_SPAN:
    return json_pack("{s:[o,{s:s}]}", "anyOf", Several(Fraction(o), 2, 2), "type", "string");
  default:
    return json_pack("{s:s}", "type", "string");
  }
}

/* Lists, ranges, ends and words may be text with commas or an array; so may a value for each direction. */
static json_t *Value(const MpmField *o)
{
  if (o->kind == MPM_BLOCKS) return json_pack("{s:[s,s,s]}", "type", "object", "array", "string");
  if (o->kind == MPM_LIST) return json_pack("{s:[s,s,s]}", "type", "integer", "string", "array");
  if (o->kind == MPM_ENDS || o->kind == MPM_WORDS) return json_pack("{s:[s,s]}", "type", "string", "array");
  if (o->kind == MPM_WORD && !strcmp(o->name, "formulation")) return Word(o);
  if (o->also) return json_pack("{s:[o,{s:s}]}", "anyOf", One(o), "const", o->also); /* a word in place of a number */
  if (!o->each) return One(o);
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

static PetscErrorCode PrintSchema(void)
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

/* ---- the task ---- */

/* A line of a list whose parts have a name, a summary and a source. */
#define LIST(function, list)                                                                                           \
  static PetscErrorCode function(void)                                                                                 \
  {                                                                                                                    \
    for (PetscInt i = 0; list[i]; i++)                                                                                 \
      MpmPrint("  %-14s %s (%s)\n", list[i]->name, list[i]->summary, list[i]->reference);                              \
    return PETSC_SUCCESS;                                                                                              \
  }
LIST(ListFormulations, MpmFormulations)
LIST(ListBases, MpmBases)
LIST(ListTransfers, MpmTransfers)

/* Refuses a word that is none of a list. */
#define REFUSE_NAME(what, word, list)                                                                                  \
  do {                                                                                                                 \
    const char *names[64];                                                                                             \
    PetscInt    n = 0;                                                                                                 \
    for (; list[n]; n++) names[n] = list[n]->name;                                                                     \
    PetscCall(MpmSuggestRefuse(word, n, names, "list " what " %.200s: allowed: ", word));                              \
  } while (0)

static PetscErrorCode PrintWritten(MpmWritten *written)
{
  char *yaml;

  PetscFunctionBegin;
  PetscCall(MpmWrittenYaml(written, &yaml));
  MpmPrint("%s", yaml);
  PetscCall(PetscFree(yaml));
  PetscCall(MpmWrittenDestroy(&written));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Prints a formulation in the language of schemes, so that the text can be changed and given back. */
static PetscErrorCode ListOneFormulation(const char name[])
{
  const MpmSchemeNumbers numbers = {.order = 1};
  const MpmSpace         space   = {.dim = 1};

  const MpmFormulation *formulation = MpmFormulationFind(name);
  MpmTable             *table;
  MpmWritten           *written;

  PetscFunctionBegin;
  if (!formulation) REFUSE_NAME("formulation", name, MpmFormulations);
  PetscCall(PetscNew(&written));
  PetscCall(MpmWrittenAddFormulation(formulation, NULL, NULL, written));
  PetscCall(PrintWritten(written));
  PetscCall(MpmTableCreate(formulation, MpmTransferFind("flip"), &numbers, &space, &table));
  PetscCall(MpmReportNodal(table, "# in one dimension with flip, "));
  PetscCall(MpmTableDestroy(&table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of a transfer, with the value of the option that it reads, or its default. */
static PetscErrorCode ListOneTransfer(const char name[], const char value[])
{
  const MpmTransfer *transfer = MpmTransferFind(name);
  const char        *text     = value;
  MpmSchemeNumbers   numbers  = {.order = 1};
  MpmWritten        *written;
  char              *end;

  PetscFunctionBegin;
  if (!transfer) REFUSE_NAME("transfer", name, MpmTransfers);
  MpmCheckInput(!value || transfer->option, "list transfer %s %.100s: it has no number; allowed: the name alone", name,
                value);
  if (transfer->option) {
    const MpmField *option = &MpmOptions[MpmOptionIndex(transfer->option)];
    PetscReal       number;

    if (!text) text = option->fallback;
    number = strtod(text, &end);
    MpmCheckInput(end > text && !*end && number >= option->lo && number <= option->hi &&
                      (option->kind != MPM_INTEGER || number == floor(number)),
                  "list transfer %s %.100s: allowed: a value of %s, from %.6g to %.6g", name, text, transfer->option,
                  option->lo, option->hi);
    numbers = (MpmSchemeNumbers){.order = (PetscInt)number, .ratio = number, .affine_ratio = number};
  }
  PetscCall(MpmWrittenFromTransfer(transfer, &numbers, &written));
  PetscCall(PrintWritten(written));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ListBoundaries(void)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; MpmEndNames[i]; i++) MpmPrint("  %-14s %s\n", MpmEndNames[i], MpmEndSummaries[i]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const char layouts[] =
    "  uniform        particles at equal distances, ppc of them (or counts) in a cell, from offset on. jitter "
    "displaces\n"
    "                 each at random, by a hash of its id. fill and cluster leave a part of the grid, or of each "
    "cell,\n"
    "                 empty\n"
    "  random         particles anywhere in the grid. Each place is a hash of the particle's id and of seed\n"
    "  FILE           a CSV file. Its first line names the columns: x, y and z, and those of volume, mass, young,\n"
    "                 poisson and fixed that you have. Each line after it is a particle. Or the HDF5 file of a run\n";

static PetscErrorCode ListColliders(void)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; MpmColliderShapes[i]; i++) {
    const MpmColliderShape *shape = MpmColliderShapes[i];

    MpmPrint("  shape: %-12s %s; keys %s", shape->name, shape->summary, shape->key[0]);
    for (PetscInt k = 1; shape->key[k]; k++) MpmPrint("%s%s", shape->key[k + 1] ? ", " : " and ", shape->key[k]);
    MpmPrint("\n");
  }
  for (PetscInt i = 0; MpmContacts[i]; i++)
    MpmPrint("  contact: %-10s %s%s\n", MpmContacts[i]->name, MpmContacts[i]->summary,
             MpmContacts[i]->rubs     ? "; key friction"
             : MpmContacts[i]->pushes ? "; key stiffness"
                                      : "");
  MpmPrint("  With kinematics finite each collider may have the key velocity, too.\n"
           "  The option bodies takes the same shapes for bodies of particles; theirs may also be file.\n");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ListOptions(void)
{
  PetscFunctionBegin;
  for (const MpmField *o = MpmOptions; o->name; o++)
    MpmPrint("  %-16s %-9s %s\n", o->name, o->fallback ? o->fallback : "", o->help);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Prints the versions of the libraries that a result rests on. The version text of an MPI is cut at its first comma or
   line end.
*/
static PetscErrorCode ListVersions(void)
{
  char     mpi[MPI_MAX_LIBRARY_VERSION_STRING];
  int      length;
  PetscInt major, minor, patch;

  PetscFunctionBegin;
  MpmPrint("  %-14s %s\n", "mpmstab", MPMSTAB_VERSION);
  PetscCall(PetscGetVersionNumber(&major, &minor, &patch, NULL));
  MpmPrint("  %-14s %" PetscInt_FMT ".%" PetscInt_FMT ".%" PetscInt_FMT "\n", "PETSc", major, minor, patch);
  PetscCall(SlepcGetVersionNumber(&major, &minor, &patch, NULL));
  MpmPrint("  %-14s %" PetscInt_FMT ".%" PetscInt_FMT ".%" PetscInt_FMT "\n", "SLEPc", major, minor, patch);
  PetscCallMPI(MPI_Get_library_version(mpi, &length));
  mpi[strcspn(mpi, ",\n")] = 0;
  MpmPrint("  %-14s %s\n", "MPI", mpi);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Each line of an option says what was read in the file that it names, at the commit of its code; what was not read is
   not there. A file is named once for the options that were read in it.
*/
static PetscErrorCode ListCodes(void)
{
  json_t *codes = json_loads(MpmCodesText, 0, NULL), *code, *options, *option;
  size_t  c, o;

  PetscFunctionBegin;
  PetscCheck(codes, PETSC_COMM_SELF, PETSC_ERR_PLIB, "codes.json is not JSON");
  json_array_foreach (codes, c, code) {
    const char *name, *repository, *version, *said, *here, *file, *before = "", *scheme = NULL, *limit = "",
                                                                  *ran = NULL;
    json_t *defaults                                                   = NULL;

    PetscCheck(!json_unpack(code, "{s:s, s:s, s:s, s:o, s?o, s?s, s?s, s?s}", "name", &name, "repository", &repository,
                            "version", &version, "options", &options, "defaults", &defaults, "scheme", &scheme, "limit",
                            &limit, "ran", &ran),
               PETSC_COMM_SELF, PETSC_ERR_PLIB, "codes.json: code %zu", c);
    MpmPrint("  %s: %s, commit %s\n", name, repository, version);
    json_array_foreach (options, o, option) {
      PetscCheck(!json_unpack(option, "[s, s, s]", &said, &here, &file), PETSC_COMM_SELF, PETSC_ERR_PLIB,
                 "codes.json: %s, option %zu", name, o);
      if (strcmp(before, file)) MpmPrint("    %s\n", file);
      before = file;
      MpmPrint("      %-44s %s\n", said, here);
    }
    json_array_foreach (defaults, o, option) {
      PetscCheck(!json_unpack(option, "[s, s, s]", &said, &here, &file), PETSC_COMM_SELF, PETSC_ERR_PLIB,
                 "codes.json: %s, default %zu", name, o);
      MpmPrint("    by default: %-9s %s (%s)\n", said, here, file);
    }
    MpmPrint(ran ? "    run here: %s\n" : "    only read, not run\n", ran);
    if (scheme) MpmPrint("    limit of a lattice %s: mpmstab critical %s\n", limit, scheme);
  }
  json_decref(codes);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What is answered. README has the same. */
static const char scope[] =
    "  exactly        linear steps: growth, limits, waves and modes of lattices and of any layout up to a size\n"
    "                 linear steps about a stretched state, or with colliders that stick or slip; tangents of a run's "
    "states\n"
    "  by marching    runs at finite strain, also of metal, snow, sand, clay and liquids that flow: their energy and "
    "error; growth in a run is measured and not proved\n"
    "                 damping of the grid and viscosity, in steps, limits and runs; colliders of contact penalty and "
    "local damping in runs\n"
    "  not at all     contact of several velocity fields, fracture, heat, graphics processors\n";

/* on_request: 'list' alone leaves it out, since it is longer than all others together; text: the list, or a function. */
static const struct {
  const char *name, *plural, *title, *text;
  PetscErrorCode (*list)(void);
  PetscBool on_request;
} lists[] = {
    {"formulation", "formulations", "formulations", NULL, ListFormulations, PETSC_FALSE},
    {"basis", "bases", "bases", NULL, ListBases, PETSC_FALSE},
    {"transfer", "transfers", "transfers", NULL, ListTransfers, PETSC_FALSE},
    {"boundary", "boundaries", "ends of the domain", NULL, ListBoundaries, PETSC_FALSE},
    {"layout", "layouts", "layouts", layouts, NULL, PETSC_FALSE},
    {"collider", "colliders", "colliders", NULL, ListColliders, PETSC_FALSE},
    {"options", "option", "options, as -option value or as keys of a scene: name, default, meaning", NULL, ListOptions,
     PETSC_FALSE},
    {"versions", "version", "versions", NULL, ListVersions, PETSC_FALSE},
    {"scope", "scopes", "what is answered", scope, NULL, PETSC_FALSE},
    {"codes", "code",
     "public codes: for each option of a code, the options of this program that make the same scheme, and the\n"
     "file that says so. 'by default' has the code's damping, viscosity and time step, with file and line at this\n"
     "commit; a file without a line was searched and has none, or sets the variable that is named. 'limit' is the\n"
     "largest stable c dt / h of what runs by default, in one dimension with two particles a cell at rest, and the\n"
     "command that prints it. Each code says whether it was run here, or only read",
     NULL, ListCodes, PETSC_TRUE}};

/* A list by its name, or by its plural as in 'list formulations'. */
static PetscBool IsCalled(const char word[], size_t i)
{
  return !strcasecmp(word, lists[i].name) || !strcasecmp(word, lists[i].plural) ? PETSC_TRUE : PETSC_FALSE;
}

/* Texts that are installed. They are for other programs, and messages leave them out. */
static PetscErrorCode PrintInstalled(const char word[], PetscBool *found)
{
  PetscFunctionBegin;
  *found = PETSC_TRUE;
  if (!strcmp(word, "schema"))
    PetscCall(PrintSchema());
  else if (!strcmp(word, "man"))
    PrintManual();
  else if (!strcmp(word, "completion-bash") || !strcmp(word, "completion-zsh"))
    (word[11] == 'z' ? PrintZsh : PrintBash)();
  else
    *found = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskList(int argc, char **argv)
{
  const char *names[PETSC_STATIC_ARRAY_LENGTH(lists)];
  PetscBool   found = PETSC_FALSE;

  PetscFunctionBegin;
  if (argc == 1) PetscCall(PrintInstalled(argv[0], &found));
  if (found) PetscFunctionReturn(PETSC_SUCCESS);
  if (argc == 2 && IsCalled(argv[0], 0)) {
    PetscCall(ListOneFormulation(argv[1]));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if ((argc == 2 || argc == 3) && IsCalled(argv[0], 2)) {
    PetscCall(ListOneTransfer(argv[1], argc == 3 ? argv[2] : NULL));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmCheckInput(
      argc <= 1,
      "unexpected word '%s'; allowed: list [formulation|basis|transfer|boundary|layout|options|versions|scope|codes]",
      argv[1]);
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(lists); i++) {
    names[i] = lists[i].name;
    if (argc == 1 && !IsCalled(argv[0], i)) continue;
    if (argc == 0 && lists[i].on_request) continue;
    found = PETSC_TRUE;
    MpmPrint("%s\n", lists[i].title);
    if (lists[i].text)
      MpmPrint("%s", lists[i].text);
    else
      PetscCall(lists[i].list());
  }
  if (argc == 0) MpmPrint("public codes: mpmstab list codes\n");
  if (!found)
    PetscCall(MpmSuggestRefuse(argv[0], PETSC_STATIC_ARRAY_LENGTH(lists), names, "list %s: allowed: ", argv[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
