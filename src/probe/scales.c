/* Scales of a code's fields: those that it has not declared are found by <mpmstab_scales.h>. */
#include "probe/probe.h"
#include "base/hash.h"
#include <mpmstab/errors.h>
#include <mpmstab_scales.h>
#include <float.h>

#define SIZE 7.62939453125e-06 /* of perturbations, in scales: 2^-17, and 2^-5 of floats */
#define SIZE_SINGLE 0.03125

static void Begin(const MpmStepper *s, PetscBool single, mpmstab_scales *scales)
{
  *scales = (mpmstab_scales){.place = s->place, .cell = s->cell_width, .size = single ? SIZE_SINGLE : SIZE};
  for (PetscInt f = 0; f < s->nfields; f++) {
    const MpmStepperField *field = &s->fields[f];
    PetscReal              value = 0;

    for (PetscInt64 i = 0; i < s->particles; i++)
      for (PetscInt c = 0; c < field->size; c++)
        value = PetscMax(value, PetscAbsReal(s->base[i * s->width + field->first + c]));
    mpmstab_scales_add_(scales, value, field->scale, single ? FLT_EPSILON : DBL_EPSILON);
  }
}

static void Take(MpmProbe *p, const mpmstab_scales *scales)
{
  MpmStepper *s = p->stepper;

  for (PetscInt f = 0; f < s->nfields; f++)
    for (PetscInt c = 0; c < s->fields[f].size; c++) p->scale[s->fields[f].first + c] = scales->scale[f];
}

/* How much each field changes when one is perturbed at random. */
static PetscErrorCode Measure(MpmProbe *p, PetscInt f, PetscReal size, PetscReal change[])
{
  const MpmStepper *s = p->stepper;
  const PetscInt    m = s->fields[f].size;
  const PetscInt64  n = s->particles * m;
  PetscInt64       *unknown;
  PetscReal        *amount, *response;

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &unknown, n, &amount, s->particles * s->width, &response));
  for (PetscInt64 i = 0; i < n; i++) {
    unknown[i] = i / m * s->width + s->fields[f].first + i % m;
    amount[i]  = size * (2 * MpmHash(81, i) - 1);
  }
  PetscCall(MpmProbeRespond(p, PETSC_FALSE, n, unknown, amount, response));
  for (PetscInt g = 0; g < s->nfields; g++) {
    change[g] = 0;
    for (PetscInt64 i = 0; i < s->particles; i++)
      for (PetscInt c = s->fields[g].first; c < s->fields[g].first + s->fields[g].size; c++)
        change[g] = PetscMax(change[g], PetscAbsReal(response[i * s->width + c]) * p->scale[c]);
  }
  PetscCall(PetscFree3(unknown, amount, response));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Search(MpmProbe *p, mpmstab_scales *scales)
{
  MpmStepper *s = p->stepper;
  PetscReal  *state, change[MPM_STEPPER_FIELDS];
  PetscInt    f;

  PetscFunctionBegin;
  Begin(s, PETSC_FALSE, scales);
  Take(p, scales);
  p->steps = s->steps;
  PetscCall(PetscMalloc1(s->particles * s->width, &state));
  PetscCall(MpmProbeAnswersFloats(p, state));
  PetscCall(PetscFree(state));
  Begin(s, p->single, scales);
  while (!s->failure[0] && (f = mpmstab_scales_next_(scales)) >= 0) {
    Take(p, scales);
    PetscCall(Measure(p, f, scales->size, change));
    if (!s->failure[0]) mpmstab_scales_take_(scales, f, change);
  }
  if (s->failure[0]) mpmstab_scales_fail_(scales); /* it may have no answer to what it was asked, and yet have others */
  s->failure[0] = '\0';
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeScales(MpmProbe *p)
{
  MpmStepper    *s   = p->stepper;
  PetscBool      all = PETSC_TRUE;
  mpmstab_scales scales;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(s->width, &p->scale));
  Begin(s, PETSC_FALSE, &scales);
  for (PetscInt f = 0; f < s->nfields; f++)
    if (!scales.given[f]) all = PETSC_FALSE;
  if (!all) {
    if (MpmRankOf(PETSC_COMM_WORLD) == 0) PetscCall(Search(p, &scales));
    PetscCallMPI(MPI_Bcast(scales.scale, MPMSTAB_SCALES_MOST, MPIU_REAL, 0, PETSC_COMM_WORLD));
    PetscCallMPI(MPI_Bcast(&scales.unsettled, 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
    s->searched  = PETSC_TRUE;
    s->unsettled = scales.unsettled;
  }
  Take(p, &scales);
  for (PetscInt f = 0; f < s->nfields; f++) {
    if (!scales.given[f]) s->fields[f].found = PETSC_TRUE;
    s->fields[f].scale = scales.scale[f];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
