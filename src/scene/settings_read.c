/* Readers for each kind of value. A value is checked once, here, and refused with what is allowed. */
#include "scene/settings.h"
#include "base/suggest.h"
#include "base/text.h"
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#define WHY 2048       /* bytes of why a value cannot be */
#define MOST_SHOWN 200 /* characters of a value in a message, which is to have room for what is allowed */

PetscInt MpmSettingsIndex(const MpmSettings *settings, const char name[])
{
  PetscInt i = MpmOptionIndex(name);

  for (PetscInt n = 0; n < settings->n && i == MPM_NOT_AN_OPTION; n++)
    if (!strcmp(settings->name[n], name)) i = MPM_MAX_OPTIONS + n;
  return i;
}

PetscBool MpmSettingsGiven(const MpmSettings *settings, const char name[])
{
  return MpmSettingsText(settings, name) ? PETSC_TRUE : PETSC_FALSE;
}

MpmOrigin MpmSettingsSource(const MpmSettings *settings, const char name[])
{
  const PetscInt i = MpmSettingsIndex(settings, name);

  return i == MPM_NOT_AN_OPTION ? MPM_FROM_DEFAULT : settings->source[i];
}

const char *MpmSettingsText(const MpmSettings *settings, const char name[])
{
  const PetscInt i = MpmSettingsIndex(settings, name);

  return i == MPM_NOT_AN_OPTION ? NULL : settings->text[i];
}

PetscBool MpmSettingsOverruled(const MpmSettings *settings, const char key[], const char by[])
{
  return MpmSettingsSource(settings, key) < MpmSettingsSource(settings, by) ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmSettingsRefuse(const MpmSettings *settings, const char name[], const char format[], ...)
{
  const PetscInt    i                     = MpmSettingsIndex(settings, name);
  const char *const dots                  = strlen(settings->text[i]) > MOST_SHOWN ? "..." : "";
  char              place[MPM_PLACE_TEXT] = "", why[WHY];
  va_list           arguments;

  PetscFunctionBegin;
  va_start(arguments, format);
  (void)vsnprintf(why, sizeof why, format, arguments);
  va_end(arguments);
  if (settings->source[i] == MPM_FROM_SCENE)
    MpmRefuse("%s:%d: %s: %.*s%s: %s", settings->scene, settings->line[i], name, MOST_SHOWN, settings->text[i], dots,
              why);
  if (settings->source[i] == MPM_FROM_OUTSIDE) PetscCall(MpmSettingsPlace(name, settings->text[i], place));
  MpmRefuse("-%s %.*s%s%s: %s", name, MOST_SHOWN, settings->text[i], dots, place, why);
}

#define PART 64 /* characters between two commas */

/*
   Takes the part of a text before its next comma; false where it is too long. *rest: what follows the comma, NULL:
   nothing.
*/
static PetscBool NextPart(const char **rest, char part[PART])
{
  const size_t length = strcspn(*rest, ",");
  const char  *end    = *rest + length;

  (void)snprintf(part, PART, "%.*s", (int)length, *rest);
  *rest = *end ? end + 1 : NULL;
  return length < PART ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmSettingsStands(const MpmSettings *settings, const char key[], const char by[])
{
  char      name[PART];
  PetscBool stands = MpmSettingsSource(settings, key) != MPM_FROM_DEFAULT ? PETSC_TRUE : PETSC_FALSE;

  while (by && *by && NextPart(&by, name))
    if (MpmSettingsOverruled(settings, key, name)) stands = PETSC_FALSE;
  return stands;
}

PetscErrorCode MpmSettingsRefuseEach(const MpmSettings *settings, const char options[], const char by[],
                                     MpmOrigin least, const char why[])
{
  char name[PART];

  PetscFunctionBegin;
  while (options && *options && NextPart(&options, name))
    MpmSettingsRefuseIf(by ? MpmSettingsStands(settings, name, by) : MpmSettingsSource(settings, name) >= least,
                        settings, name, "%s", why);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RefuseNumber(const MpmSettings *settings, const MpmField *option, const char what[])
{
  const PetscReal lo = option->lo, hi = option->hi;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(option->lo_open && hi == PETSC_MAX_REAL, settings, option->name,
                      "allowed: %s greater than %.6g%s%s", what, lo, option->also ? ", or " : "",
                      option->also ? option->also : "");
  MpmSettingsRefuseIf(hi == PETSC_MAX_REAL && lo > -PETSC_MAX_REAL, settings, option->name, "allowed: %s from %.6g",
                      what, lo);
  MpmSettingsRefuseIf(hi == PETSC_MAX_REAL, settings, option->name, "allowed: %s", what);
  MpmSettingsRefuseIf(option->kind == MPM_FRACTION && hi < 1, settings, option->name,
                      "allowed: %s from %.6g to below 1", what, lo);
  PetscCall(MpmSettingsRefuse(settings, option->name, "allowed: %s from %.16g to %.16g", what, lo, hi));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool InRange(const MpmField *option, PetscReal value)
{
  if (!isfinite(value) || value > option->hi) return PETSC_FALSE;
  return option->lo_open ? value > option->lo : value >= option->lo;
}

const char *MpmSettingsFarthest(const MpmSettings *settings, PetscInt n, const char *const names[])
{
  const char *farthest = names[0];
  PetscReal   most     = -1;

  for (PetscInt i = 0; i < n; i++) {
    const PetscBool given    = MpmSettingsSource(settings, names[i]) != MPM_FROM_DEFAULT ? PETSC_TRUE : PETSC_FALSE;
    const PetscReal value    = given ? strtod(MpmSettingsText(settings, names[i]), NULL) : 0;
    const PetscReal distance = value == 0 ? -1 : fabs(log(value));

    if (distance > most) {
      most     = distance;
      farthest = names[i];
    }
  }
  return farthest;
}

PetscBool MpmSettingsIsAlso(const MpmSettings *settings, const char name[])
{
  const char *also = MpmOptions[MpmOptionIndex(name)].also, *text = MpmSettingsText(settings, name);

  return also && text && !strcmp(text, also) ? PETSC_TRUE : PETSC_FALSE; /* no text: a rival was given */
}

/* Reads a decimal number. Blanks, hexadecimals, 'inf' and 'nan', which strtod accepts, are none. */
static PetscBool IsReal(const char text[], PetscReal *value)
{
  char *end;

  if (!*text || strspn(text, "0123456789+-.eE") != strlen(text)) return PETSC_FALSE;
  *value = strtod(text, &end);
  return *end || !isfinite(*value) ? PETSC_FALSE : PETSC_TRUE;
}

/* ---- the text of one value ---- */

#define LONGEST 1024     /* characters of a name of a file, or of another text */
#define SEPARATORS ", -" /* between two words: fixed,free or fixed-free */

/* Compared as integers, since 2^53 and 2^53 + 1 are the same double. */
static PetscErrorCode ParseLong(const MpmSettings *settings, const MpmField *option, const char text[], void *place)
{
  PetscInt64 *value = place;
  char       *end;

  PetscFunctionBegin;
  errno  = 0;
  *value = strtoll(text, &end, 10);
  if (!*text || *end || errno || strspn(text, "0123456789+-") != strlen(text) || *value < (PetscInt64)option->lo ||
      *value > (PetscInt64)option->hi)
    PetscCall(RefuseNumber(settings, option, "a whole number"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ParseCount(const MpmSettings *settings, const MpmField *option, const char text[], void *place)
{
  PetscInt64 value;

  PetscFunctionBegin;
  PetscCall(ParseLong(settings, option, text, &value));
  *(PetscInt *)place = (PetscInt)value;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ParseReal(const MpmSettings *settings, const MpmField *option, const char text[], void *place)
{
  const PetscBool fraction = option->kind == MPM_FRACTION ? PETSC_TRUE : PETSC_FALSE;
  PetscReal      *value    = place;
  MpmFraction     exact    = {.value = 0};
  const PetscBool ok       = fraction ? MpmFractionParse(text, &exact) : IsReal(text, value);

  PetscFunctionBegin;
  if (fraction) *value = exact.value;
  if (!ok || !InRange(option, *value))
    PetscCall(RefuseNumber(settings, option, fraction ? "a finite number or fraction" : "a finite number"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ParseFraction(const MpmSettings *settings, const MpmField *option, const char text[], void *place)
{
  MpmFraction *value = place;

  PetscFunctionBegin;
  if (!MpmFractionParse(text, value) || !InRange(option, value->value))
    PetscCall(RefuseNumber(settings, option, "a finite number or a fraction such as 1/8"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ParseRange(const MpmSettings *settings, const MpmField *option, const char text[], void *place)
{
  PetscReal  *range = place;
  char        first[PART];
  const char *rest = text;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(!NextPart(&rest, first) || !rest || !IsReal(first, &range[0]) || !IsReal(rest, &range[1]) ||
                          range[0] > range[1],
                      settings, option->name, "allowed: two finite numbers lo,hi with lo <= hi (in a scene: [lo, hi])");
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindWord(const MpmSettings *settings, const MpmField *option, const char text[], PetscInt *index)
{
  const char    *words[32];
  MpmText        why = {NULL, 0};
  PetscInt       n   = 0;
  PetscErrorCode ierr;

  PetscFunctionBegin;
  for (*index = 0; MpmFieldWord(option, *index); ++*index)
    if (!strcasecmp(MpmFieldWord(option, *index), text)) PetscFunctionReturn(PETSC_SUCCESS);
  for (; MpmFieldWord(option, n); n++) words[n] = MpmFieldWord(option, n);
  PetscCall(MpmTextAdd(&why, "allowed: "));
  PetscCall(MpmSuggestAdd(&why, n > 1 && !MpmWordCalledHere(option->name, text) ? text : NULL, n, words));
  if (MpmWordCalledHere(option->name, text))
    PetscCall(MpmTextAdd(&why, "; here it is %s", MpmWordCalledHere(option->name, text)));
  ierr = MpmSettingsRefuse(settings, option->name, "%s", why.text);
  MpmTextFree(&why);
  PetscCall(ierr);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ParseWord(const MpmSettings *settings, const MpmField *option, const char text[], void *place)
{
  PetscInt index;

  PetscFunctionBegin;
  PetscCall(FindWord(settings, option, text, &index));
  *(int *)place = (int)index;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ParseEnds(const MpmSettings *settings, const MpmField *option, const char text[], void *place)
{
  const size_t ends  = strcspn(text, SEPARATORS);
  const char  *rest  = text + ends + strspn(text + ends, SEPARATORS);
  PetscInt    *index = place;
  char         first[PART];

  PetscFunctionBegin;
  (void)snprintf(first, PetscMin(ends + 1, sizeof first), "%s", text);
  PetscCall(FindWord(settings, option, first, &index[0]));
  PetscCall(FindWord(settings, option, text[ends] ? rest : first, &index[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ParseSwitch(const MpmSettings *settings, const MpmField *option, const char text[], void *place)
{
  static const char *const words[] = {"", "true", "True", "yes", "on", "1", "false", "False", "no", "off", "0"};
  const size_t             yes     = 6; /* of these words */

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(words); i++) {
    if (strcmp(text, words[i])) continue;
    *(PetscBool *)place = i < yes ? PETSC_TRUE : PETSC_FALSE;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSettingsRefuse(settings, option->name, "allowed: true or false"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ParseText(const MpmSettings *settings, const MpmField *option, const char text[], void *place)
{
  const PetscBool file = option->file == MPM_FILE_NONE ? PETSC_FALSE : PETSC_TRUE;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(!*text, settings, option->name, "allowed: %s",
                      file ? "the name of a file" : "a text that is not empty");
  MpmSettingsRefuseIf(strlen(text) >= LONGEST, settings, option->name, "allowed: a shorter %s", file ? "name" : "text");
  (void)snprintf(place, LONGEST, "%s", text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode (*const parse[])(const MpmSettings *, const MpmField *, const char[], void *) = {
    [MPM_AS_TEXT] = ParseText, [MPM_AS_COUNT] = ParseCount,       [MPM_AS_LONG] = ParseLong,
    [MPM_AS_REAL] = ParseReal, [MPM_AS_FRACTION] = ParseFraction, [MPM_AS_RANGE] = ParseRange,
    [MPM_AS_ENDS] = ParseEnds, [MPM_AS_WORD] = ParseWord,         [MPM_AS_SWITCH] = ParseSwitch};

/* ---- values for each direction ---- */

#define MOST_PARTS (2 * MPM_MAX_DIM)

/*
   Cuts the text of an option at its commas into dim groups of so many parts each. One group stands for all directions.
   In one dimension the only group is the whole text, with whatever commas it has. room is memory for the groups.
*/
static PetscErrorCode Cut(const MpmSettings *settings, const MpmField *option, PetscInt dim, PetscInt parts,
                          char room[MPM_MAX_DIM][2 * PART], const char *group[MPM_MAX_DIM])
{
  /* where a word stands in the place of the number, the number is that of the default */
  const char *text =
      MpmSettingsIsAlso(settings, option->name) ? option->fallback : MpmSettingsText(settings, option->name);
  char      part[MOST_PARTS][PART] = {{0}};
  PetscInt  n                      = 0;
  PetscBool fits                   = PETSC_TRUE;

  PetscFunctionBegin;
  group[0] = text;
  if (dim == 1) PetscFunctionReturn(PETSC_SUCCESS);
  while (text && fits) fits = n < MOST_PARTS && NextPart(&text, part[n++]) ? PETSC_TRUE : PETSC_FALSE;
  MpmSettingsRefuseIf(!fits || (n != parts && n != parts * dim), settings, option->name,
                      "allowed: %s for all directions, or %" PetscInt_FMT " with commas between them, for %s",
                      parts == 2 ? "two values" : "one value", parts * dim, dim == 2 ? "x and y" : "x, y and z");
  for (PetscInt a = 0; a < dim; a++) {
    const PetscInt at = n == parts ? 0 : parts * a;

    (void)snprintf(room[a], 2 * PART, parts == 2 ? "%s,%s" : "%s", part[at], part[at + parts - 1]);
    group[a] = room[a];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsRead(const MpmSettings *settings, const char name[], MpmValueKind kind, PetscInt dim,
                               size_t stride, void *values)
{
  const MpmField *option = &MpmOptions[MpmOptionIndex(name)];
  char            room[MPM_MAX_DIM][2 * PART];
  const char     *text[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCheck(parse[kind], PETSC_COMM_SELF, PETSC_ERR_PLIB, "option %s is read by hand", name);
  PetscCall(Cut(settings, option, dim, kind == MPM_AS_RANGE ? 2 : 1, room, text));
  for (PetscInt a = 0; a < dim; a++)
    PetscCall(parse[kind](settings, option, text[a], (char *)values + (size_t)a * stride));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsWord(const MpmSettings *settings, const char name[], PetscInt *index)
{
  return FindWord(settings, &MpmOptions[MpmOptionIndex(name)], MpmSettingsText(settings, name), index);
}

/* A word more than once counts once. */
PetscErrorCode MpmSettingsWords(const MpmSettings *settings, const char name[], PetscInt room, PetscInt *n,
                                PetscInt index[])
{
  const char *text = MpmSettingsText(settings, name);
  char        word[PART];
  PetscInt    found;
  PetscBool   known;

  PetscFunctionBegin;
  for (*n = 0; text;) {
    (void)NextPart(&text, word);
    PetscCall(FindWord(settings, &MpmOptions[MpmOptionIndex(name)], word, &found));
    known = PETSC_FALSE;
    for (PetscInt i = 0; i < *n; i++)
      if (index[i] == found) known = PETSC_TRUE;
    PetscCheck(known || *n < room, PETSC_COMM_SELF, PETSC_ERR_PLIB, "%s has more words than fit", name);
    if (!known) index[(*n)++] = found;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmSettingsParseSpan(const char text[], MpmFraction span[2])
{
  char        first[PART];
  const char *rest = text;

  return NextPart(&rest, first) && rest && MpmFractionParse(first, &span[0]) && MpmFractionParse(rest, &span[1]) &&
                 isfinite(span[0].value) && isfinite(span[1].value) && span[0].value < span[1].value
             ? PETSC_TRUE
             : PETSC_FALSE;
}

PetscErrorCode MpmSettingsSpan(const MpmSettings *settings, const char name[], MpmFraction span[2])
{
  const MpmField *option = &MpmOptions[MpmOptionIndex(name)];
  char            bounds[32];

  PetscFunctionBegin;
  (void)snprintf(bounds, sizeof bounds, 1 - option->hi == PETSC_MACHINE_EPSILON / 2 ? " to below 1" : " to %.6g",
                 (double)option->hi);
  MpmSettingsRefuseIf(
      !MpmSettingsParseSpan(MpmSettingsText(settings, name), span) || !InRange(option, span[0].value) ||
          !InRange(option, span[1].value),
      settings, name, "allowed: two numbers or fractions lo,hi (in a scene: [lo, hi]), lo < hi, %s %.6g%s",
      option->lo_open ? "above" : "from", (double)option->lo, option->hi == PETSC_MAX_REAL ? "" : bounds);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsList(const MpmSettings *settings, const char name[], PetscInt room, PetscInt *n,
                               PetscInt list[])
{
  const MpmField *option = &MpmOptions[MpmOptionIndex(name)];
  char           *end;

  PetscFunctionBegin;
  *n = 0;
  for (const char *text = settings->text[MpmOptionIndex(name)];; text = end + 1) {
    const long value = strtol(text, &end, 10);

    MpmSettingsRefuseIf(*n == room || end == text || strspn(text, "0123456789") != (size_t)(end - text) ||
                            (*end && *end != ',') || !InRange(option, (PetscReal)value),
                        settings, name, "allowed: up to %" PetscInt_FMT " whole numbers from %d to %d, as %s", room,
                        (int)option->lo, (int)option->hi, option->fallback ? option->fallback : "1,4,0,2");
    list[(*n)++] = (PetscInt)value;
    if (!*end) break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReals(const MpmSettings *settings, const char name[], PetscInt room, PetscInt *n,
                                PetscReal list[])
{
  const MpmField *option = &MpmOptions[MpmOptionIndex(name)];
  const char     *text   = MpmSettingsText(settings, name);
  char            part[PART];

  PetscFunctionBegin;
  for (*n = 0; text;)
    if (!NextPart(&text, part) || *n == room || !IsReal(part, &list[*n]) || !InRange(option, list[(*n)++]))
      PetscCall(RefuseNumber(settings, option, "finite numbers"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadFields(const MpmSettings *settings, MpmOwner owner, const PetscInt *dim, void *object)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; MpmOptions[i].name; i++) {
    const MpmField *field = &MpmOptions[i];

    if (field->value == MPM_NO_VALUE || field->by_hand || field->owner != owner || !settings->text[i]) continue;
    if (field->value == MPM_AS_TEXT && !MpmFieldIsOf(field, ((const MpmRequest *)object)->task)) continue;
    PetscCall(MpmSettingsRead(settings, field->name, field->value, field->each ? *dim : 1, field->each,
                              (char *)object + field->at));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
