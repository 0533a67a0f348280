/* The values of fields in a scene: which of them a record shows, and as which text. */
#include "scene/fields.h"
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

static PetscErrorCode TakeValue(const MpmField *field, const MpmScene *scene, const MpmRequest *request,
                                MpmValue *value)
{
  const char *owner = field->owner == MPM_OF_SCENE ? (const char *)scene : (const char *)request;
  const void *place = owner + field->at;

  PetscFunctionBegin;
  *value = (MpmValue){.field = field, .kind = field->value};
  switch (field->value) {
  case MPM_AS_TEXT:
    PetscCall(PetscStrncpy(value->text, field->text(scene), sizeof value->text));
    break;
  case MPM_AS_COUNT:
    value->whole = *(const PetscInt *)place;
    break;
  case MPM_AS_LONG:
    value->whole = *(const PetscInt64 *)place;
    break;
  case MPM_AS_REAL:
    value->number[0] = *(const PetscReal *)place;
    break;
  case MPM_AS_FRACTION:
    value->fraction = *(const MpmFraction *)place;
    break;
  case MPM_AS_RANGE:
    PetscCall(PetscArraycpy(value->number, (const PetscReal *)place, 2));
    break;
  case MPM_AS_SWITCH:
    PetscCall(PetscStrncpy(value->text, *(const PetscBool *)place ? "true" : "false", sizeof value->text));
    break;
  case MPM_AS_COUNTS:
    PetscCall(MpmSceneCountsText(scene, sizeof value->text, value->text));
    break;
  case MPM_NO_VALUE:
    SETERRQ(PETSC_COMM_SELF, PETSC_ERR_PLIB, "field %s has no value", field->name);
  }
  if (field->real) {
    value->kind      = MPM_AS_REAL;
    value->number[0] = (PetscReal)value->whole;
  }
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
  if (!field->place[record] || (field->owner == MPM_OF_REQUEST && !request)) return PETSC_FALSE;
  return field->shown ? field->shown(scene, record) : PETSC_TRUE;
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

PetscErrorCode MpmValueText(const MpmValue *value, size_t room, char text[])
{
  const MpmFraction *f = &value->fraction;

  PetscFunctionBegin;
  switch (value->kind) {
  case MPM_AS_COUNT:
  case MPM_AS_LONG:
    (void)snprintf(text, room, "%" PetscInt64_FMT, value->whole);
    break;
  case MPM_AS_REAL:
    (void)snprintf(text, room, "%.17g", value->number[0]);
    break;
  case MPM_AS_RANGE:
    (void)snprintf(text, room, "%.17g,%.17g", value->number[0], value->number[1]);
    break;
  case MPM_AS_FRACTION: /* 1/7 is not the nearest double to it: in many steps the two would differ */
    if (f->den)
      (void)snprintf(text, room, "%" PetscInt64_FMT "/%" PetscInt64_FMT, f->num, f->den);
    else
      (void)snprintf(text, room, "%.17g", f->value);
    break;
  default:
    PetscCall(PetscStrncpy(text, value->text, room));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmValueHeading(const MpmValue *value, size_t room, char text[])
{
  PetscFunctionBegin;
  if (value->kind == MPM_AS_REAL)
    (void)snprintf(text, room, "%.6g", value->number[0]);
  else if (value->kind == MPM_AS_RANGE)
    (void)snprintf(text, room, "%.6g to %.6g", value->number[0], value->number[1]);
  else if (value->kind == MPM_AS_FRACTION && !(value->field->exact && value->fraction.den > 1))
    (void)snprintf(text, room, "%.6g", value->fraction.value);
  else
    PetscCall(MpmValueText(value, room, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmValueAgrees(const MpmValue *value, const char text[], PetscBool *agrees)
{
  char mine[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmValueText(value, sizeof mine, mine));
  *agrees = !strcmp(mine, text) ? PETSC_TRUE : PETSC_FALSE;
  if (value->kind == MPM_AS_FRACTION && !strchr(text, '/') && strtod(text, NULL) == value->fraction.value)
    *agrees = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
