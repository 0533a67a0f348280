/* Reads a scene: a YAML mapping of option names to values, an 'expect' block, and a scheme as text. */
#include "base/suggest.h"
#include "base/text.h"
#include "base/yaml.h"
#include "scene/settings.h"
#include <mpmstab/fraction.h>
#include <math.h>
#include <string.h>

/*
   A scheme as text among the settings: in a block of the scene, or in a file of its own. Its parameters are keys of the
   scene and options, which are known only when the scheme has been read.
*/

static const char map[] = "map_";

/* A file has the scheme itself, or the one key scheme with it. */
static PetscErrorCode UseFile(void *context, yaml_document_t *document, const yaml_node_t *root)
{
  MpmSettings            *settings = context;
  const yaml_node_pair_t *first    = root->data.mapping.pairs.start;
  const char             *file     = MpmSettingsText(settings, "scheme");

  PetscFunctionBegin;
  if (first < root->data.mapping.pairs.top) {
    const yaml_node_t *key = yaml_document_get_node(document, first->key);

    if (key->type == YAML_SCALAR_NODE && !strcmp((const char *)key->data.scalar.value, "scheme")) {
      MpmCheckInput(first + 1 == root->data.mapping.pairs.top,
                    "%s:%d: something follows the scheme; allowed: a file with a scheme alone, or this one as a scene",
                    file, (int)yaml_document_get_node(document, first[1].key)->start_mark.line + 1);
      root = yaml_document_get_node(document, first->value);
    }
  }
  PetscCall(MpmWrittenFromYaml(file, document, root, &settings->outside));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsFormulationNumbers(const MpmSettings *settings, const MpmFormulation *formulation,
                                             PetscBool filters, MpmSchemeNumbers *numbers)
{
  PetscInt on;

  PetscFunctionBegin;
  PetscCall(MpmSettingsReal(settings, "share", &numbers->share));
  PetscCall(MpmSettingsReal(settings, "theta", &numbers->theta));
  numbers->move_share = formulation->move_share;
  if (MpmSettingsGiven(settings, "move_share"))
    PetscCall(MpmSettingsReal(settings, "move_share", &numbers->move_share));
  PetscCall(MpmSettingsSwitch(settings, "rk_relax", &numbers->rk_relax));
  PetscCall(MpmSettingsWord(settings, "rk", &numbers->rk));
  PetscCall(MpmSettingsWord(settings, "rk_on", &on));
  numbers->rk_on = (MpmRkOn)on;
  PetscCall(MpmSettingsWord(settings, "rk_places", &numbers->rk_places));
  MpmSettingsRefuseIf(numbers->rk_on == MPM_RK_PARTICLES && filters, settings, "rk_on",
                      "allowed: only with transfer flip; nodes with others");
  if (numbers->rk_places != MPM_RK_STAGES) PetscFunctionReturn(PETSC_SUCCESS);
  MpmSettingsRefuseIf(numbers->rk_on == MPM_RK_NODES || filters, settings, "rk_places",
                      "stages on nodes are of one grid; allowed: frozen, or stages on particles with transfer flip");
  MpmSettingsRefuseIf(
      numbers->rk_relax, settings, "rk_places",
      "with rk_relax a part of the increments is taken, and places of stages have none; allowed: frozen, or "
      "without rk_relax");
  MpmSettingsRefuseIf(MpmSettingsGiven(settings, "move_share"), settings, "rk_places",
                      "particles move with the velocities of the stages; allowed: frozen, or without move_share");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A scheme says what a formulation says, so that the weaker source of the two gives way. A transfer alone is for the
   formulation that is named, or that of the default.
*/
static PetscErrorCode Choose(MpmSettings *settings)
{
  const PetscInt  formulation = MpmOptionIndex("formulation"), scheme = MpmOptionIndex("scheme");
  const MpmOrigin says = settings->source[formulation], text = settings->source[scheme];
  PetscInt        i;

  MpmSchemeNumbers numbers = {.order = 1};

  PetscFunctionBegin;
  if (!settings->scheme->nstep) {
    PetscCall(MpmSettingsWord(settings, "formulation", &i));
    PetscCall(MpmSettingsFormulationNumbers(settings, MpmFormulations[i], PETSC_TRUE, &numbers));
    numbers.rk_on = MPM_RK_NODES; /* they have a place for the text's filter */
    PetscCall(MpmWrittenAddFormulation(MpmFormulations[i], &numbers, NULL, settings->scheme));
  } else if (settings->scheme->name.line && says != MPM_FROM_DEFAULT) {
    if (says > text) settings->scheme = NULL;
    PetscCall(MpmSettingsDisplace(settings, says > text ? formulation : scheme, says > text ? scheme : formulation,
                                  PetscMax(says, text)));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the scheme that counts; none when a formulation is named instead. */
static PetscErrorCode Load(MpmSettings *settings)
{
  char path[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  settings->scheme = NULL;
  if (!MpmSettingsGiven(settings, "scheme")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsRead(settings, "scheme", MPM_AS_TEXT, 1, 0, path));
  if (settings->inside && MpmSettingsSource(settings, "scheme") == MPM_FROM_SCENE) {
    settings->scheme = settings->inside;
    PetscCall(Choose(settings));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (!settings->outside) PetscCall(MpmYamlReadFile("scheme", path, UseFile, settings));
  settings->scheme = settings->outside;
  PetscCall(Choose(settings));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- parameters ---- */

static PetscBool IsParameter(const MpmWritten *scheme, const char name[])
{
  const char *after = strncmp(name, map, strlen(map)) ? name : name + strlen(map);

  return scheme && (MpmWrittenFindParameter(scheme, name) != MPM_NONE ||
                    MpmWrittenFindParameter(scheme, after) != MPM_NONE)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

PetscBool MpmSettingsIsOfMap(const char name[])
{
  static const char *const names[] = {"axes",   "shape",   "unstable",        "undecided",      "seconds",
                                      "growth", "verdict", "published_limit", "corrected_limit"};

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(names); i++)
    if (!strcmp(name, names[i])) return PETSC_TRUE;
  return strncmp(name, "beta", 4) ? PETSC_FALSE : PETSC_TRUE;
}

/* Options must keep their meaning, so parameters may not have their names. */
static PetscErrorCode CheckNames(const MpmWritten *scheme)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < scheme->nparameters; i++) {
    const MpmWrittenText *name = &scheme->parameters[i].name;

    MpmCheckInput(MpmOptionIndex(name->text) == MPM_NOT_AN_OPTION && !MpmSettingsIsLibrary(name->text) &&
                      strncmp(name->text, map, strlen(map)) && strncmp(name->text, "expect", 6),
                  "%s:%d: parameter %s: that is the name of an option; allowed: another name", scheme->file, name->line,
                  name->text);
    MpmCheckInput(!MpmSettingsIsOfMap(name->text),
                  "%s:%d: parameter %s: that is the name of a result of maps; allowed: another name", scheme->file,
                  name->line, name->text);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SetParameters(MpmSettings *settings)
{
  MpmWritten *scheme = settings->scheme;

  PetscFunctionBegin;
  PetscCall(CheckNames(scheme));
  for (PetscInt i = 0; i < scheme->nparameters; i++) {
    const char *name = scheme->parameters[i].name.text;
    char        span[96];
    MpmFraction number;

    (void)snprintf(span, sizeof span, "%s%s", map, name);
    if (settings->has_options) PetscCall(MpmSettingsReadOption(settings, name, MPM_FROM_DEFAULT));
    if (settings->has_options) PetscCall(MpmSettingsReadOption(settings, span, MPM_FROM_DEFAULT));
    if (!MpmSettingsGiven(settings, name)) continue;
    MpmSettingsRefuseIf(!MpmFractionParse(MpmSettingsText(settings, name), &number) || !isfinite(number.value),
                        settings, name, "allowed: a finite number or a fraction such as 1/3");
    scheme->parameters[i].set   = PETSC_TRUE;
    scheme->parameters[i].value = number.value;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a key of a scene that does not exist, and names one that may be meant. */
static PetscErrorCode RefuseKey(const MpmSettings *settings, const char key[], int line)
{
  const char *near = MpmOptionNear(key);

  PetscFunctionBegin;
  if (MpmOptionCalledHere(key))
    MpmRefuse("%s:%d: unknown key '%s'; it is called '%s' here", settings->scene, line, key, MpmOptionCalledHere(key));
  if (near) MpmRefuse("%s:%d: unknown key '%s'; did you mean '%s'?", settings->scene, line, key, near);
  MpmRefuse("%s:%d: unknown key '%s'; 'mpmstab list options' shows those there are", settings->scene, line, key);
}

PetscErrorCode MpmSettingsReadScheme(MpmSettings *settings)
{
  PetscFunctionBegin;
  PetscCall(Load(settings));
  if (settings->scheme) PetscCall(SetParameters(settings));
  for (PetscInt i = 0; i < settings->n; i++)
    if (!IsParameter(settings->inside, settings->name[i]) && !IsParameter(settings->scheme, settings->name[i]))
      PetscCall(RefuseKey(settings, settings->name[i], settings->line[MPM_MAX_OPTIONS + i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsHasParameter(const char scene[], const char name[], PetscBool *has, size_t room, char near[])
{
  MpmSettings   *settings;
  PetscErrorCode ierr = PETSC_SUCCESS;

  PetscFunctionBegin;
  near[0] = '\0';
  PetscCall(MpmSettingsCreate(&settings));
  if (scene) ierr = MpmSettingsReadScene(settings, scene);
  if (!ierr) ierr = MpmSettingsReadCommandLine(settings);
  if (!ierr) ierr = Load(settings);
  *has = IsParameter(settings->scheme, name);
  for (PetscInt i = 0; settings->scheme && i < settings->scheme->nparameters && !near[0]; i++) {
    const char *const one = settings->scheme->parameters[i].name.text;

    if (MpmSuggest(name, 1, &one)) (void)snprintf(near, room, "%s", one);
  }
  PetscCall(MpmSettingsDestroy(&settings));
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the scene ---- */

static int Line(const yaml_node_t *node)
{
  return (int)node->start_mark.line + 1;
}

/* The text of a scalar. NULL: the node is none, or has a zero byte inside, where a C string would end. */
static const char *Scalar(const yaml_node_t *node)
{
  const char *text = node->type == YAML_SCALAR_NODE ? (const char *)node->data.scalar.value : NULL;

  return text && strlen(text) == node->data.scalar.length ? text : NULL;
}

/* What a key's value may look like, for a message about a key without one. */
static const char *const allowed[] = {[MPM_WORD]     = "one of its words",
                                      [MPM_INTEGER]  = "a whole number",
                                      [MPM_REAL]     = "a number",
                                      [MPM_FRACTION] = "a number or a fraction such as 1/8",
                                      [MPM_SWITCH]   = "true or false",
                                      [MPM_PATH]     = "the name of a file",
                                      [MPM_RANGE]    = "two numbers [lo, hi]",
                                      [MPM_SPAN]     = "two numbers [lo, hi]",
                                      [MPM_ENDS]     = "one of its words",
                                      [MPM_LIST]     = "a list of whole numbers",
                                      [MPM_WORDS]    = "one or more of its words",
                                      [MPM_BLOCKS]   = "a block {key: value}, or several [{...}, {...}]"};

/* Sets what a key of the scene says of an option, or of what may be a parameter, which is known later. */
static PetscErrorCode SetOnce(MpmSettings *settings, const char key[], const char name[], const char text[], int line)
{
  const PetscInt option = MpmOptionIndex(name);

  PetscFunctionBegin;
  MpmCheckInput(MpmSettingsSource(settings, name) == MPM_FROM_DEFAULT,
                "%s:%d: key '%s' is given a second time; allowed: once", settings->scene, line, key);
  MpmCheckInput(option == MPM_NOT_AN_OPTION || (*text && strcmp(text, "~") && strcmp(text, "null")),
                "%s:%d: key '%s' has no value; allowed: %s, or no such line", settings->scene, line, key,
                allowed[MpmOptions[PetscMax(option, 0)].kind]);
  PetscCall(MpmSettingsSet(settings, name, text, MPM_FROM_SCENE, line));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What may be the value of a parameter: a scalar, or the two ends of a span. Others are left out. */
static PetscErrorCode AddParameter(yaml_document_t *document, const yaml_node_t *value, MpmText *text)
{
  const yaml_node_item_t *item = value->data.sequence.items.start;
  const char             *lo = Scalar(value), *hi = NULL;

  PetscFunctionBegin;
  if (value->type == YAML_SEQUENCE_NODE && value->data.sequence.items.top - item == 2) {
    lo = Scalar(yaml_document_get_node(document, item[0]));
    hi = Scalar(yaml_document_get_node(document, item[1]));
    if (!hi) lo = NULL;
  }
  PetscCall(MpmTextAdd(text, "%s%s%s", lo ? lo : "", lo && hi ? "," : "", lo && hi ? hi : ""));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Blocks as the text that the command line has. */
static PetscErrorCode AddFlow(yaml_document_t *document, const yaml_node_t *node, MpmText *text)
{
  const PetscBool list = node->type == YAML_SEQUENCE_NODE ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  MpmCheckInput(text->length < PETSC_MAX_PATH_LEN, "key in line %d: its blocks are too long, or hold themselves",
                Line(node));
  if (node->type == YAML_SCALAR_NODE) {
    PetscCall(MpmTextAdd(text, "%s", Scalar(node) ? Scalar(node) : ""));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmTextAdd(text, list ? "[" : "{")); /* a comma may stand before the closing bracket */
  for (const yaml_node_item_t *i = node->data.sequence.items.start; list && i < node->data.sequence.items.top; i++) {
    PetscCall(AddFlow(document, yaml_document_get_node(document, *i), text));
    PetscCall(MpmTextAdd(text, ", "));
  }
  for (const yaml_node_pair_t *i = node->data.mapping.pairs.start; !list && i < node->data.mapping.pairs.top; i++) {
    PetscCall(AddFlow(document, yaml_document_get_node(document, i->key), text));
    PetscCall(MpmTextAdd(text, ": "));
    PetscCall(AddFlow(document, yaml_document_get_node(document, i->value), text));
    PetscCall(MpmTextAdd(text, ", "));
  }
  PetscCall(MpmTextAdd(text, list ? "]" : "}"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A value as text: that of a scalar, or 'a,b,c' for a sequence where the option takes two values or a list. */
static PetscErrorCode AddValue(const MpmSettings *settings, yaml_document_t *document, PetscInt option,
                               const yaml_node_t *value, MpmText *text)
{
  const MpmOptionKind     kind = MpmOptions[option].kind;
  const char             *key = MpmOptions[option].name, *part = Scalar(value);
  const yaml_node_item_t *item = NULL, *end = NULL;
  const PetscBool         two = kind == MPM_RANGE || kind == MPM_SPAN || kind == MPM_ENDS ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool         many =
      kind == MPM_LIST || kind == MPM_WORDS || MpmOptions[option].each || kind == MPM_ENDS ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  MpmCheckInput(value->type != YAML_MAPPING_NODE, "%s:%d: key '%s' holds a block; allowed: a value", settings->scene,
                Line(value), key);
  if (value->type == YAML_SEQUENCE_NODE) {
    item = value->data.sequence.items.start;
    end  = value->data.sequence.items.top;
    MpmCheckInput(many ? end > item : two && end - item == 2, "%s:%d: key '%s': allowed: one value%s", settings->scene,
                  Line(value), key,
                  many  ? ", or several [a, b, c]"
                  : two ? ", or two [lo, hi]"
                        : "");
  }
  do {
    const yaml_node_t *one = item < end ? yaml_document_get_node(document, *item++) : value;

    part = Scalar(one);
    MpmCheckInput(one->type == YAML_SCALAR_NODE, "%s:%d: key '%s': allowed: numbers or words in a list",
                  settings->scene, Line(value), key);
    MpmCheckInput(part, "%s:%d: key '%s': a zero byte in its value; allowed: text", settings->scene, Line(value), key);
    MpmCheckInput(text->length + strlen(part) + 2 < PETSC_MAX_PATH_LEN, "%s:%d: key '%s': its value is too long",
                  settings->scene, Line(value), key);
    PetscCall(MpmTextAdd(text, "%s%s", text->text ? "," : "", part));
  } while (item < end);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadMapping(MpmSettings *settings, yaml_document_t *document, const yaml_node_t *mapping,
                                  PetscBool inside_expect);

/*
   Reads an 'expect' block. SetOnce refuses a key that is there twice; here a second block, or a verdict beside it, is.
*/
static PetscErrorCode ReadExpect(MpmSettings *settings, yaml_document_t *document, const yaml_node_t *mapping,
                                 const yaml_node_pair_t *pair)
{
  const yaml_node_t *mine = yaml_document_get_node(document, pair->value);

  PetscFunctionBegin;
  for (const yaml_node_pair_t *other = mapping->data.mapping.pairs.start; other < mapping->data.mapping.pairs.top;
       other++) {
    const char *key = Scalar(yaml_document_get_node(document, other->key));

    MpmCheckInput(other == pair || !key || strcmp(key, "expect"),
                  "%s:%d: key 'expect' is given a second time; allowed: once", settings->scene,
                  Line(yaml_document_get_node(document, PetscMax(pair, other)->key)));
  }
  MpmCheckInput(mine->data.mapping.pairs.top > mine->data.mapping.pairs.start,
                "%s:%d: key 'expect' has no value; allowed: a verdict, or a block of expectations", settings->scene,
                Line(mine));
  PetscCall(ReadMapping(settings, document, mine, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keys of the 'expect' block become expect_KEY; 'verdict' is the option expect itself. */
static PetscErrorCode ReadMapping(MpmSettings *settings, yaml_document_t *document, const yaml_node_t *mapping,
                                  PetscBool inside_expect)
{
  const yaml_node_pair_t *end = mapping->data.mapping.pairs.top;

  PetscFunctionBegin;
  for (const yaml_node_pair_t *pair = mapping->data.mapping.pairs.start; pair < end; pair++) {
    const yaml_node_t *node  = yaml_document_get_node(document, pair->key);
    const yaml_node_t *value = yaml_document_get_node(document, pair->value);
    const char        *key   = Scalar(node);
    char               name[128];
    MpmText            text = {NULL, 0};
    PetscInt           option;
    PetscErrorCode     ierr;

    MpmCheckInput(key && strlen(key) < 100, "%s:%d: allowed: lines of the form key: value", settings->scene,
                  Line(node));
    if (!inside_expect && !strcmp(key, "expect") && value->type == YAML_MAPPING_NODE) {
      PetscCall(ReadExpect(settings, document, mapping, pair));
      continue;
    }
    if (!inside_expect && !strcmp(key, "scheme") && value->type == YAML_MAPPING_NODE) {
      PetscCall(SetOnce(settings, key, key, "(written in the scene)", Line(node)));
      PetscCall(MpmWrittenFromYaml(settings->scene, document, value, &settings->inside));
      continue;
    }
    if (inside_expect && !strcmp(key, "verdict"))
      (void)snprintf(name, sizeof name, "%s", "expect");
    else
      (void)snprintf(name, sizeof name, "%s%s", inside_expect ? "expect_" : "", key);
    MpmCheckInput(
        !inside_expect || MpmOptionIndex(name) != MPM_NOT_AN_OPTION,
        "%s:%d: unknown key '%s' in expect; allowed: verdict, kind, growth, spectrum, critical, share, error or energy",
        settings->scene, Line(node), key);
    option = MpmOptionIndex(name);
    if (option == MPM_NOT_AN_OPTION)
      ierr = AddParameter(document, value, &text);
    else if (MpmOptions[option].kind == MPM_BLOCKS)
      ierr = AddFlow(document, value, &text);
    else
      ierr = AddValue(settings, document, option, value, &text);
    if (!ierr) ierr = SetOnce(settings, key, name, text.text, Line(node));
    MpmTextFree(&text);
    PetscCall(ierr);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadRoot(void *context, yaml_document_t *document, const yaml_node_t *root)
{
  MpmSettings *settings = context;

  PetscFunctionBegin;
  PetscCall(ReadMapping(settings, document, root, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadScene(MpmSettings *settings, const char path[])
{
  PetscFunctionBegin;
  (void)snprintf(settings->scene, sizeof settings->scene, "%s", path);
  PetscCall(MpmYamlReadFile("scene", path, ReadRoot, settings));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadText(MpmSettings *settings, const char name[], const char yaml[])
{
  PetscFunctionBegin;
  (void)snprintf(settings->scene, sizeof settings->scene, "%s", name);
  PetscCall(MpmYamlReadText("scene", settings->scene, yaml, ReadRoot, settings));
  PetscFunctionReturn(PETSC_SUCCESS);
}
