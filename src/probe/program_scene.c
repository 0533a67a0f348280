/* Keys of a scene as a text in YAML; and the message 'scene' of protocol 1. */
#include "probe/program_scene.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "scene/settings.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

#define CELLS                                                                                                          \
  10 /* wide enough for cubic splines, and for a free block of 6 cells that does not feel itself around the period */
#define WHOLE 1e-9 /* relative: a period is so many cells */

PetscBool MpmKeysSay(const char text[], const char *const keys[])
{
  for (const char *at = text; at; at = strchr(at, ',') ? strchr(at, ',') + 1 : NULL)
    for (int i = 0; keys[i]; i++)
      if (!strncmp(at, keys[i], strlen(keys[i])) && at[strlen(keys[i])] == '=') return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmKeysAdd(const char option[], const char text[], MpmText *yaml)
{
  PetscBool fits = text[0] ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  for (const char *at = text; *at && fits;) {
    const char *equals = strchr(at, '='), *end = equals ? equals + strcspn(equals, ",") : at;

    while (*end && strchr(end, '=') && strcspn(end + 1, ",") < (size_t)(strchr(end, '=') - end))
      end += 1 + strcspn(end + 1, ",");
    if (*end && !strchr(end, '=')) end += strlen(end);
    fits = equals && equals > at && end > equals + 1 ? PETSC_TRUE : PETSC_FALSE;
    if (fits) PetscCall(MpmTextAdd(yaml, "%.*s: %.*s\n", (int)(equals - at), at, (int)(end - equals - 1), equals + 1));
    at = *end ? end + 1 : end;
  }
  MpmCheckInput(fits, "-%s %.200s: allowed: keys of a scene, as cells=8,ppc=2 or formulation=usl,courant=0.5", option,
                text);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- a scene for a code ---- */

/* The scene of the keys, with the dimension and the width of a cell of the code, and its periods where it has any. */
static PetscErrorCode Make(const char keys[], const MpmStepper *s, MpmScene **scene)
{
  MpmText yaml = {NULL, 0};

  PetscFunctionBegin;
  if (keys[0]) PetscCall(MpmKeysAdd("program_scene", keys, &yaml));
  MpmCheckInput(
      !MpmKeysSay(keys, (const char *const[]){"dim", "cell_width", "length", NULL}),
      "-program_scene %.200s: the dimension and the width of a cell are those of the code; allowed: other keys of "
      "a scene, as cells and ppc",
      keys);
  PetscCall(MpmTextAdd(&yaml, "dim: %" PetscInt_FMT "\ncell_width: %.17g\n", s->dim, (double)s->cell_width));
  for (PetscInt a = 0; a < s->dim && !MpmKeysSay(keys, (const char *const[]){"cells", NULL}); a++)
    PetscCall(MpmTextAdd(&yaml, "%s%ld",
                         a ? "," : "cells: ", s->period[a] > 0 ? lround(s->period[a] / s->cell_width) : CELLS));
  PetscCall(MpmSceneFromNamedText("-program_scene", yaml.text, scene));
  MpmTextFree(&yaml);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The period of the scene in a direction, which is the code's where the code has said its periods. */
static PetscErrorCode TakePeriods(const char keys[], const MpmLayout *layout, MpmStepper *s)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < s->dim; a++) {
    const PetscReal width = layout->grid[a].cells * s->cell_width;

    if (!s->has_periods) s->period[a] = layout->grid[a].ends[0] == MPM_PERIODIC ? width : 0;
    MpmCheckInput(s->period[a] == 0 || PetscAbsReal(width - s->period[a]) <= WHOLE * width,
                  "-program_scene %.200s: %" PetscInt_FMT " cells in direction %" PetscInt_FMT
                  " are not the period of the code; allowed: %g cells, or fill for a part of them",
                  keys, layout->grid[a].cells, a, (double)(s->period[a] / s->cell_width));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Place, volume and mass of each particle, in the units of the code. */
static PetscErrorCode Particles(const MpmScene *scene, PetscReal cell_width, PetscReal given[])
{
  const MpmLayout *layout = &scene->layout;
  const PetscInt   dim    = layout->dim;
  const PetscReal  unit   = pow(cell_width, (PetscReal)dim) / MpmLayoutPpc(layout);

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < layout->particles; i++) {
    PetscReal *of = given + i * (dim + 2);

    MpmLayoutRest(layout, i, of);
    for (PetscInt a = 0; a < dim; a++) of[a] *= cell_width;
    of[dim]     = unit * MpmMaterialProperty(layout, MPM_VOLUME, i);
    of[dim + 1] = unit * MpmMaterialProperty(layout, MPM_MASS, i) * (scene->density > 0 ? scene->density : 1);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The material, where keys name one; else it is the code's. */
static json_t *Material(const char keys[], const MpmScene *scene)
{
  static const char *const of[] = {"wave_speed", "sound_speed", "young", "bulk", "density", "poisson", NULL};

  if (!MpmKeysSay(keys, of)) return NULL;
  return json_pack("{s:f, s:f, s:f}", "density", scene->density > 0 ? (double)scene->density : 1., "wave_speed",
                   (double)scene->wave_speed, "poisson", (double)scene->scheme.space.poisson);
}

PetscErrorCode MpmProgramTakeScene(const char keys[], MpmStepper *s)
{
  MpmScene  *scene;
  PetscReal *given;

  PetscFunctionBegin;
  MpmCheckInput(s->scenes,
                "-program_scene %.200s: the code takes no scenes; allowed: with a code that describes itself with "
                "\"scenes\": true",
                keys);
  PetscCall(Make(keys, s, &scene));
  PetscCall(TakePeriods(keys, &scene->layout, s));
  PetscCall(PetscMalloc1(scene->layout.particles * (s->dim + 2), &given));
  PetscCall(Particles(scene, s->cell_width, given));
  PetscCall(MpmStepperTakeScene(s, scene->layout.particles, given, Material(keys, scene)));
  PetscCall(PetscFree(given));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
