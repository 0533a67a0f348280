/*
   A scheme as text among the settings: in a block of the scene, or in a file of its own. Its parameters are keys of the
   scene and options, which are known only when the scheme has been read.
*/
#include "base/suggest.h"
#include "base/yaml.h"
#include "scene/settings.h"
#include "scene/settings_place.h"
#include <mpmstab/fraction.h>
#include <math.h>
#include <string.h>

static const char in_scene[] = "(written in the scene)", map[] = "map_";

PetscErrorCode MpmSettingsKeepScheme(MpmSettings *settings, yaml_document_t *document, const yaml_node_t *node,
                                     int line)
{
  const PetscInt option = MpmOptionIndex("scheme");

  PetscFunctionBegin;
  MpmCheckInput(settings->source[option] == MPM_FROM_DEFAULT,
                "%s:%d: key 'scheme' is given a second time; allowed: once", settings->scene, line);
  PetscCall(MpmSettingsSet(settings, option, in_scene, MPM_FROM_SCENE, line));
  PetscCall(MpmWrittenFromYaml(settings->scene, document, node, &settings->inside));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
  const char *path;

  PetscFunctionBegin;
  settings->scheme = NULL;
  if (!MpmSettingsGiven(settings, "scheme")) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsPath(settings, "scheme", &path));
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

PetscErrorCode MpmSettingsKeepParameter(MpmSettings *settings, const char name[], const char text[], MpmOrigin source,
                                        int line)
{
  MpmSettingsParameter *said = settings->parameter;
  const PetscInt        n    = settings->nparameters;

  PetscFunctionBegin;
  while (said < settings->parameter + n && strcmp(said->name, name)) said++;
  if (said == settings->parameter + n) {
    MpmCheckInput(n < MPM_MOST_SAID, "%s:%d: key '%s': more keys that are no options than the %d that fit",
                  settings->scene, line, name, MPM_MOST_SAID);
    PetscCall(PetscStrallocpy(name, &said->name));
    settings->nparameters++;
  } else
    MpmCheckInput(source != MPM_FROM_SCENE, "%s:%d: key '%s' is given a second time; allowed: once", settings->scene,
                  line, name);
  PetscCall(PetscFree(said->text));
  PetscCall(PetscStrallocpy(text, &said->text));
  said->source = source;
  said->line   = line;
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmSettingsParameter *MpmSettingsParameterSaid(const MpmSettings *settings, const char before[],
                                                     const char name[])
{
  const size_t length = strlen(before);

  for (PetscInt i = 0; i < settings->nparameters; i++) {
    const MpmSettingsParameter *said = &settings->parameter[i];

    if (!strncmp(said->name, before, length) && !strcmp(said->name + length, name)) return said;
  }
  return NULL;
}

PetscErrorCode MpmSettingsRefuseParameter(const MpmSettings *settings, const MpmSettingsParameter *said,
                                          const char why[])
{
  char place[MPM_PLACE_TEXT] = "";

  PetscFunctionBegin;
  if (said->source == MPM_FROM_SCENE)
    MpmRefuse("%s:%d: %s: %.200s: %s", settings->scene, said->line, said->name, said->text, why);
  if (said->source == MPM_FROM_OUTSIDE) PetscCall(MpmSettingsPlace(said->name, said->text, place));
  MpmRefuse("-%s %.200s%s: %s", said->name, said->text, place, why);
}

static PetscBool IsParameter(const MpmWritten *scheme, const char name[])
{
  const char *after = strncmp(name, map, strlen(map)) ? name : name + strlen(map);

  return scheme && (MpmWrittenFindParameter(scheme, name) != MPM_NONE ||
                    MpmWrittenFindParameter(scheme, after) != MPM_NONE)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* Keeps what PETSc's options say of an option of this name. */
static PetscErrorCode KeepOption(MpmSettings *settings, const char before[], const char name[])
{
  char        key[64], place[MPM_PLACE_TEXT];
  const char *text;
  PetscBool   given;

  PetscFunctionBegin;
  (void)snprintf(key, sizeof key, "-%s%s", before, name);
  PetscCall(PetscOptionsFindPair(NULL, NULL, key, &text, &given));
  if (!given) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSettingsPlace(key + 1, text, place));
  PetscCall(MpmSettingsKeepParameter(settings, key + 1, text ? text : "",
                                     place[0] ? MPM_FROM_OUTSIDE : MPM_FROM_COMMAND_LINE, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
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
    const char                 *name = scheme->parameters[i].name.text;
    const MpmSettingsParameter *said;
    MpmFraction                 number;

    if (settings->has_options) PetscCall(KeepOption(settings, "", name));
    if (settings->has_options) PetscCall(KeepOption(settings, map, name));
    said = MpmSettingsParameterSaid(settings, "", name);
    if (!said) continue;
    if (!MpmFractionParse(said->text, &number) || !isfinite(number.value))
      PetscCall(MpmSettingsRefuseParameter(settings, said, "allowed: a finite number or a fraction such as 1/3"));
    scheme->parameters[i].set   = PETSC_TRUE;
    scheme->parameters[i].value = number.value;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadScheme(MpmSettings *settings)
{
  PetscFunctionBegin;
  PetscCall(Load(settings));
  if (settings->scheme) PetscCall(SetParameters(settings));
  for (PetscInt i = 0; i < settings->nparameters; i++) {
    const MpmSettingsParameter *said = &settings->parameter[i];

    if (!IsParameter(settings->inside, said->name) && !IsParameter(settings->scheme, said->name))
      PetscCall(MpmSettingsRefuseKey(settings, said->name, said->line));
  }
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
