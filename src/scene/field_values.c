/* The values of fields in a scene: which of them a record shows, and as which text. */
#include "scene/fields.h"
#include "base/text.h"
#include <stdlib.h>
#include <string.h>

static const MpmField *FindField(const char name[])
{
  for (const MpmField *f = MpmOptions; f->name; f++)
    if (!strcmp(f->name, name)) return f;
  for (const MpmField *f = MpmDerived; f->name; f++)
    if (!strcmp(f->name, name)) return f;
  return NULL;
}

/* Takes the value of direction a. */
static PetscErrorCode TakeOne(const MpmScene *scene, const void *place, PetscInt a, MpmValue *value)
{
  const MpmField *field = value->field;

  PetscFunctionBegin;
  switch (field->value) {
  case MPM_AS_TEXT:
    (void)snprintf(value->text, sizeof value->text, "%s", field->text ? field->text(scene) : (const char *)place);
    break;
  case MPM_AS_COUNT:
    value->whole[a] = *(const PetscInt *)place;
    break;
  case MPM_AS_LONG:
    value->whole[a] = *(const PetscInt64 *)place;
    break;
  case MPM_AS_REAL:
    value->number[a][0] = *(const PetscReal *)place;
    break;
  case MPM_AS_FRACTION:
    value->fraction[a] = *(const MpmFraction *)place;
    break;
  case MPM_AS_RANGE:
    PetscCall(PetscArraycpy(value->number[a], (const PetscReal *)place, 2));
    break;
  case MPM_AS_SWITCH:
    (void)snprintf(value->text, sizeof value->text, "%s", *(const PetscBool *)place ? "true" : "false");
    break;
  case MPM_AS_WORD:
    (void)snprintf(value->text, sizeof value->text, "%s", MpmFieldWord(field, *(const int *)place));
    break;
  case MPM_AS_COUNTS:
    MpmSceneCountsText(scene, sizeof value->text, value->text);
    break;
  case MPM_AS_ENDS:
  case MPM_NO_VALUE:
    SETERRQ(PETSC_COMM_SELF, PETSC_ERR_PLIB, "field %s has no value", field->name);
  }
  if (field->real) value->number[a][0] = (PetscReal)value->whole[a];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode TakeValue(const MpmField *field, const MpmScene *scene, const MpmRequest *request,
                                MpmValue *value)
{
  const char *owner = field->owner == MPM_OF_SCENE ? (const char *)scene : (const char *)request;

  PetscFunctionBegin;
  *value = (MpmValue){
      .field = field, .kind = field->real ? MPM_AS_REAL : field->value, .n = field->each ? scene->layout.dim : 1};
  if (field->numbers) value->n = field->numbers(scene);
  for (PetscInt a = 0; a < value->n; a++)
    PetscCall(TakeOne(scene, owner + field->at + (size_t)a * field->each, a, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmValueOf(const char name[], const MpmScene *scene, const MpmRequest *request, MpmValue *value)
{
  const MpmField *field = FindField(name);

  PetscFunctionBegin;
  PetscCheck(field, PETSC_COMM_SELF, PETSC_ERR_PLIB, "no field %s", name);
  PetscCall(TakeValue(field, scene, request, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscBool IsShown(const MpmField *field, MpmRecord record, const MpmScene *scene, const MpmRequest *request)
{
  const char *owner = field->owner == MPM_OF_REQUEST ? (const char *)request : (const char *)scene;

  if (!field->place[record] || !owner) return PETSC_FALSE;
  if (field->value == MPM_AS_TEXT && !field->text) return owner[field->at] ? PETSC_TRUE : PETSC_FALSE; /* a file */
  return field->shown ? field->shown(scene, record, field) : PETSC_TRUE;
}

PetscErrorCode MpmValuesIn(MpmRecord record, const MpmScene *scene, const MpmRequest *request, PetscInt *n,
                           MpmValue values[MPM_MAX_VALUES])
{
  const MpmField *at[MPM_MAX_VALUES + 1] = {NULL}, *const tables[] = {MpmOptions, MpmDerived};

  PetscFunctionBegin;
  for (int t = 0; t < 2; t++) {
    for (const MpmField *f = tables[t]; f->name; f++) {
      PetscCheck(f->place[record] <= MPM_MAX_VALUES, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_VALUES");
      if (IsShown(f, record, scene, request)) at[f->place[record]] = f;
    }
  }
  *n = 0;
  for (int place = 1; place <= MPM_MAX_VALUES; place++)
    if (at[place]) PetscCall(TakeValue(at[place], scene, request, &values[(*n)++]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmValueAttributes(const MpmValue *value, PetscInt a, PetscInt *n, MpmAttribute attributes[2])
{
  static const char *const axes[] = {"x", "y", "z"}, *const plane[] = {"xx", "xy", "yy"},
                           *const space[] = {"xx", "xy", "xz", "yy", "yz", "zz"}, *const ends[] = {"_from", "_to"};
  const char *const *parts   = !value->field->numbers ? axes : value->n == 3 ? plane : space;
  const PetscBool    range   = value->kind == MPM_AS_RANGE ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool    numeric = value->kind >= MPM_AS_COUNT && value->kind <= MPM_AS_RANGE ? PETSC_TRUE : PETSC_FALSE;

  *n = range ? 2 : 1;
  for (PetscInt i = 0; i < *n; i++) {
    MpmAttribute *of = &attributes[i];

    *of = (MpmAttribute){.kind   = value->kind == MPM_AS_COUNT ? MPM_AS_COUNT
                                   : numeric                   ? MPM_AS_REAL
                                                               : MPM_AS_TEXT,
                         .number = value->number[a][i],
                         .text   = value->text};
    (void)snprintf(of->name, sizeof of->name, "%s%s%s%s", value->field->name, value->n > 1 ? "_" : "",
                   value->n > 1 ? parts[a] : "", range ? ends[i] : "");
    if (value->kind == MPM_AS_COUNT) of->count = (PetscInt)value->whole[a];
    if (value->kind == MPM_AS_LONG) of->number = (PetscReal)value->whole[a];
    if (value->kind == MPM_AS_FRACTION) of->number = value->fraction[a].value;
  }
}

PetscErrorCode MpmValueOneText(const MpmValue *value, PetscInt a, size_t room, char text[])
{
  const MpmFraction *f = &value->fraction[a];

  PetscFunctionBegin;
  switch (value->kind) {
  case MPM_AS_COUNT:
  case MPM_AS_LONG:
    (void)snprintf(text, room, "%" PetscInt64_FMT, value->whole[a]);
    break;
  case MPM_AS_REAL:
    (void)snprintf(text, room, "%.17g", value->number[a][0]);
    break;
  case MPM_AS_RANGE:
    (void)snprintf(text, room, "%.17g,%.17g", value->number[a][0], value->number[a][1]);
    break;
  case MPM_AS_FRACTION: /* 1/7 is not the nearest double to it: in many steps the two would differ */
    if (f->den)
      (void)snprintf(text, room, "%" PetscInt64_FMT "/%" PetscInt64_FMT, f->num, f->den);
    else
      (void)snprintf(text, room, "%.17g", f->value);
    break;
  default:
    (void)snprintf(text, room, "%s", value->text);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OneHeading(const MpmValue *value, PetscInt a, size_t room, char text[])
{
  PetscFunctionBegin;
  if (value->kind == MPM_AS_REAL)
    (void)snprintf(text, room, "%.6g", value->number[a][0]);
  else if (value->kind == MPM_AS_RANGE)
    (void)snprintf(text, room, "%.6g to %.6g", value->number[a][0], value->number[a][1]);
  else if (value->kind == MPM_AS_FRACTION && !(value->field->exact && value->fraction[a].den > 1))
    (void)snprintf(text, room, "%.6g", value->fraction[a].value);
  else
    PetscCall(MpmValueOneText(value, a, room, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The values of all directions, with commas between them. */
static PetscErrorCode Join(const MpmValue *value,
                           PetscErrorCode (*one)(const MpmValue *value, PetscInt a, size_t room, char text[]),
                           size_t room, char text[])
{
  PetscFunctionBegin;
  text[0] = '\0';
  for (PetscInt a = 0; a < value->n; a++) {
    const size_t used = strlen(text), comma = a > 0;

    if (comma) MpmTextJoin(text, ",", room);
    PetscCall(one(value, a, room - used - comma, text + used + comma));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmValueText(const MpmValue *value, size_t room, char text[])
{
  return Join(value, MpmValueOneText, room, text);
}

PetscErrorCode MpmValueHeading(const MpmValue *value, size_t room, char text[])
{
  return Join(value, OneHeading, room, text);
}

PetscErrorCode MpmValueAgrees(const MpmValue *value, const char text[], PetscBool *agrees)
{
  char mine[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmValueText(value, sizeof mine, mine));
  *agrees = !strcmp(mine, text) ? PETSC_TRUE : PETSC_FALSE;
  if (value->kind == MPM_AS_FRACTION && value->n == 1 && !strchr(text, '/') &&
      strtod(text, NULL) == value->fraction[0].value)
    *agrees = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
