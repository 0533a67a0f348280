/* A scene as names and texts. */
#include "scene/scene_keys.h"
#include "scene/material.h"

typedef struct {
  PetscInt     n;
  MpmSceneKey *fact;
} List;

static PetscErrorCode Word(List *list, const char name[], const char text[])
{
  PetscFunctionBegin;
  PetscCheck(list->n < MPM_MAX_SCENE_KEYS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MAX_SCENE_KEYS");
  list->fact[list->n].name = name;
  PetscCall(PetscStrncpy(list->fact[list->n].text, text, sizeof list->fact[list->n].text));
  list->n++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Number(List *list, const char name[], PetscReal value)
{
  char text[64];

  PetscFunctionBegin;
  snprintf(text, sizeof text, "%.17g", value);
  PetscCall(Word(list, name, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Range(List *list, const char name[], const PetscReal range[2])
{
  char text[64];

  PetscFunctionBegin;
  snprintf(text, sizeof text, "%.17g,%.17g", range[0], range[1]);
  PetscCall(Word(list, name, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 1/7 is not the nearest double to it: they drift apart. */
static PetscErrorCode Fraction(List *list, const char name[], const MpmFraction *f)
{
  char text[64];

  PetscFunctionBegin;
  if (f->den)
    snprintf(text, sizeof text, "%" PetscInt64_FMT "/%" PetscInt64_FMT, f->num, f->den);
  else
    snprintf(text, sizeof text, "%.17g", f->value);
  PetscCall(Word(list, name, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Layout(List *list, const MpmScene *s)
{
  char counts[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(Number(list, "cells", (PetscReal)s->layout.grid.cells));
  PetscCall(MpmSceneCountsText(s, sizeof counts, counts));
  PetscCall(Word(list, "counts", counts));
  PetscCall(Fraction(list, "offset", &s->layout.offset));
  PetscCall(Number(list, "jitter", s->layout.jitter));
  if (s->layout.jitter != 0 || s->initial == MPM_INITIAL_RANDOM)
    PetscCall(Number(list, "seed", (PetscReal)s->layout.seed));
  PetscCall(Range(list, "cluster", s->layout.cluster));
  PetscCall(Number(list, "first", (PetscReal)s->layout.first));
  PetscCall(Number(list, "particles", (PetscReal)s->layout.particles));
  PetscCall(Word(list, "material", MpmMaterialNames[s->layout.material.kind]));
  PetscCall(Number(list, "density_ratio", s->layout.material.density));
  PetscCall(Number(list, "stiffness_ratio", s->layout.material.stiffness));
  if (s->layout.material.kind == MPM_MATERIAL_TWO) PetscCall(Range(list, "inclusion", s->layout.material.inclusion));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSceneKeys(const MpmScene *s, PetscInt *n, MpmSceneKey facts[MPM_MAX_SCENE_KEYS])
{
  List list = {0, facts};

  PetscFunctionBegin;
  PetscCall(Word(&list, "formulation", s->scheme.formulation->name));
  PetscCall(Word(&list, "basis", s->scheme.basis->name));
  PetscCall(Word(&list, "transfer", s->scheme.transfer->name));
  if (s->scheme.transfer->option)
    PetscCall(Number(&list, s->scheme.transfer->option, s->scheme.transfer->number(&s->scheme.numbers)));
  PetscCall(Word(&list, "boundary", s->boundary));
  PetscCall(Layout(&list, s));
  PetscCall(Number(&list, "length", s->length));
  PetscCall(Number(&list, "wave_speed", s->wave_speed));
  PetscCall(Number(&list, "courant", s->step.courant));
  PetscCall(Fraction(&list, "drift", &s->step.drift));
  PetscCall(Word(&list, "initial", MpmInitialNames[s->initial]));
  PetscCall(Number(&list, "mode", (PetscReal)s->mode));
  PetscCall(Number(&list, "amplitude", s->amplitude));
  PetscCall(Word(&list, "stagger", s->stagger ? "true" : "false"));
  *n = list.n;
  PetscFunctionReturn(PETSC_SUCCESS);
}
