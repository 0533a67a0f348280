/* How a code is perturbed: sizes, precision, responses. */
#include "probe/probe.h"
#include "base/hash.h"
#include <mpmstab/errors.h>
#include <mpmstab_scales.h>
#include <float.h>
#include <math.h>

#define SIZES 5
#define LATEST 16        /* steps, within which a code is noticed whose steps change with their number */
#define CHANGES 1e-3     /* a smaller difference of steps comes of noise */
#define NEAR 1e-6        /* a place within this of a cell width is the same */
#define NEAR_SINGLE 3e-5 /* of states that are floats */
#define SMALL 1e-3       /* up to this size, in scales, a response should not depend on the size of its perturbation */
#define SMALL_SINGLE 0.01
#define SCALES_SIZE 7.62939453125e-06 /* of perturbations that find scales: 2^-17, and 2^-5 of floats */
#define SCALES_SIZE_SINGLE 0.03125

/*
   The sizes that are tried, in scales. The best is between rounding, which is the precision over the size, and
   curvature, which is its square. In single precision they are large: most steps are quadratic about rest, and a
   central difference cancels that.
*/
static const PetscReal sizes[2][SIZES] = {{1e-2, 1e-3, 1e-4, 1e-5, 1e-6}, {0.3, 0.1, 0.03, 0.01, 0.003}};

/* ---- the base state ---- */

/* The direction of a number of the particle's place, or MPM_NONE. */
static PetscInt PlaceAxis(const MpmStepper *s, PetscInt number)
{
  const PetscInt axis = s->place == MPM_NONE ? -1 : number - s->fields[s->place].first;

  return axis >= 0 && axis < s->dim ? axis : MPM_NONE;
}

/* Takes whole periods out of the difference of two places. */
static PetscReal Unwrap(const MpmStepper *s, PetscInt axis, PetscReal difference)
{
  return axis == MPM_NONE || s->period[axis] == 0 ? difference : remainder(difference, s->period[axis]);
}

/* Whether all places have moved by the same whole number of cells; shift is that number. */
static PetscBool HasShifted(const MpmStepper *s, PetscReal near, const PetscReal state[], PetscInt shift[])
{
  for (PetscInt a = 0; a < s->dim; a++) {
    const PetscInt at = s->fields[s->place].first + a;

    shift[a] = (PetscInt)lround(Unwrap(s, a, state[at] - s->base[at]) / s->cell_width);
    for (PetscInt64 i = 0; i < s->particles; i++) {
      const PetscReal moved = state[i * s->width + at] - s->base[i * s->width + at] - shift[a] * s->cell_width;

      if (PetscAbsReal(Unwrap(s, a, moved)) > near * s->cell_width) return PETSC_FALSE;
    }
  }
  return PETSC_TRUE;
}

/* The state asked about has no simple numbers, as a state at rest has. */
static PetscErrorCode AnswersFloats(MpmProbe *p, PetscReal state[])
{
  const MpmStepper *s = p->stepper;
  const PetscInt64  n = s->particles * s->width;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < n; i++)
    state[i] = s->base[i] + sizes[0][3] * p->scale[i % s->width] * (MpmHash(1, i) - 0.5);
  PetscCall(MpmStepperStep(p->stepper, p->steps, s->particles, state));
  p->single = PETSC_TRUE;
  for (PetscInt64 i = 0; i < n; i++)
    if (state[i] != (PetscReal)(float)state[i]) p->single = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscBool MpmProbeIsApart(const MpmProbe *p, PetscInt number)
{
  return p->apart ? p->apart[number] : PETSC_FALSE;
}

PetscReal MpmProbeDifference(const MpmProbe *p, PetscInt64 i, const PetscReal one[], const PetscReal other[])
{
  const PetscInt number = (PetscInt)(i % p->stepper->width);

  return Unwrap(p->stepper, PlaceAxis(p->stepper, number), one[i] - other[i]) / p->scale[number];
}

PetscReal MpmProbeDistance(const MpmProbe *p, const PetscReal one[], const PetscReal other[])
{
  const MpmStepper *s       = p->stepper;
  PetscReal         largest = 0;

  for (PetscInt64 i = 0; i < s->particles * s->width; i++) {
    if (!MpmProbeIsApart(p, (PetscInt)(i % s->width)))
      largest = PetscMax(largest, PetscAbsReal(MpmProbeDifference(p, i, one, other)));
  }
  return largest;
}

PetscReal MpmProbeMoved(const MpmProbe *p, PetscInt64 *at)
{
  const MpmStepper *s    = p->stepper;
  PetscReal         most = 0;

  *at = MPM_NONE;

  for (PetscInt64 i = 0; i < s->particles * s->width; i++) {
    const PetscInt  number = (PetscInt)(i % s->width), axis = PlaceAxis(s, number);
    const PetscReal ahead = axis == MPM_NONE ? 0 : p->shift[axis] * s->cell_width;
    const PetscReal moved = PetscAbsReal(Unwrap(s, axis, p->rest[i] - s->base[i] - ahead)) / p->scale[number];

    if (moved <= most || MpmProbeIsApart(p, number)) continue;
    most = moved;
    *at  = i;
  }
  return most;
}

/*
   Steps the base until particles have the same places in cells again. A state that does not come to that within the
   longest period is taken as it is after one application.
*/
static PetscErrorCode FindPeriod(MpmProbe *p, PetscInt longest)
{
  MpmStepper      *s = p->stepper;
  const PetscInt64 n = s->particles * s->width;

  PetscFunctionBegin;
  p->steps = s->steps;
  PetscCall(PetscArraycpy(p->rest, s->base, n));
  for (PetscInt steps = s->steps; steps <= PetscMax(longest, s->steps) && !s->failure[0]; steps += s->steps) {
    PetscCall(MpmStepperStep(s, s->steps, s->particles, p->rest));
    if (s->place == MPM_NONE) break;
    if (!HasShifted(s, p->near, p->rest, p->shift)) continue;
    p->steps = steps;
    break;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- responses ---- */

static PetscReal Rounded(const MpmProbe *p, PetscReal number)
{
  return p->single ? (PetscReal)(float)number : number;
}

/* Sets the states above and below the base, and what the code's arithmetic makes of the amounts. */
static PetscErrorCode Perturb(const MpmProbe *p, PetscBool forward, MpmPerturbation *d, PetscReal above[],
                              PetscReal below[])
{
  const MpmStepper *s   = p->stepper;
  const PetscInt64  all = s->particles * s->width;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(above, s->base, all));
  if (!forward) PetscCall(PetscArraycpy(below, s->base, all));
  for (PetscInt64 i = 0; i < d->n; i++) {
    const PetscInt64 j     = d->unknown ? d->unknown[i] : i;
    const PetscReal  scale = p->scale[j % s->width], at = s->base[j], less = Rounded(p, at - d->amount[i] * scale);

    above[j] = Rounded(p, at + d->amount[i] * scale);
    if (!forward) below[j] = less;
    d->amount[i] = (forward ? above[j] - at : (above[j] - less) / 2) / scale;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeRespondAll(MpmProbe *p, PetscBool forward, PetscInt m, MpmPerturbation each[])
{
  MpmStepper      *s     = p->stepper;
  const PetscInt64 all   = s->particles * s->width;
  const PetscInt   sides = forward ? 1 : 2;
  PetscReal       *states;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(sides * m * all, &states));
  for (PetscInt k = 0; k < m; k++)
    PetscCall(Perturb(p, forward, &each[k], states + sides * k * all, states + (sides * k + 1) * all));
  PetscCall(MpmStepperStepAll(s, p->steps, s->particles, sides * m, states));
  for (PetscInt k = 0; k < m; k++) {
    const PetscReal *above = states + sides * k * all, *below = forward ? p->rest : above + all;

    for (PetscInt64 i = 0; i < all; i++) {
      const PetscInt number = (PetscInt)(i % s->width);

      each[k].response[i] = Unwrap(s, PlaceAxis(s, number), above[i] - below[i]) / p->scale[number] / sides;
    }
  }
  PetscCall(PetscFree(states));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeRespond(MpmProbe *p, PetscBool forward, PetscInt64 n, PetscInt64 unknown[], PetscReal amount[],
                               PetscReal response[])
{
  MpmPerturbation one = {.n = n, .unknown = unknown, .amount = amount, .response = response};

  PetscFunctionBegin;
  PetscCall(MpmProbeRespondAll(p, forward, 1, &one));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeRandom(MpmProbe *p, PetscInt64 seed, PetscReal size, const PetscBool part[], PetscReal amount[],
                              PetscReal response[])
{
  const PetscInt   w = p->stepper->width;
  const PetscInt64 n = p->stepper->particles * w;
  PetscInt64      *unknown, m = 0;
  PetscReal       *by;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &unknown, n, &by));
  for (PetscInt64 i = 0; i < n; i++) {
    if (amount) amount[i] = 0;
    if (MpmProbeIsApart(p, (PetscInt)(i % w)) || (part && !part[i % w])) continue;
    unknown[m] = i;
    by[m++]    = size * (2 * MpmHash(seed, i) - 1);
  }
  PetscCall(MpmProbeRespond(p, PETSC_FALSE, m, unknown, by, response));
  for (PetscInt64 i = 0; i < m && amount; i++) amount[unknown[i]] = by[i] / size;
  for (PetscInt64 i = 0; i < n; i++) response[i] = MpmProbeIsApart(p, (PetscInt)(i % w)) ? 0 : response[i] / size;
  PetscCall(PetscFree2(unknown, by));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All unknowns are perturbed, also those that are later set apart. */
PetscErrorCode MpmProbeRespondFirst(MpmProbe *p, PetscReal response[])
{
  const PetscBool *apart = p->apart;

  PetscFunctionBegin;
  p->apart = NULL;
  PetscCall(MpmProbeRandom(p, 11, p->least, NULL, NULL, response));
  p->apart = apart;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- scales: those that are not declared are found by <mpmstab_scales.h> ---- */

static void BeginScales(const MpmStepper *s, PetscBool single, mpmstab_scales *scales)
{
  *scales =
      (mpmstab_scales){.place = s->place, .cell = s->cell_width, .size = single ? SCALES_SIZE_SINGLE : SCALES_SIZE};
  for (PetscInt f = 0; f < s->nfields; f++) {
    const MpmStepperField *field = &s->fields[f];
    PetscReal              value = 0;

    for (PetscInt64 i = 0; i < s->particles; i++)
      for (PetscInt c = 0; c < field->size; c++)
        value = PetscMax(value, PetscAbsReal(s->base[i * s->width + field->first + c]));
    mpmstab_scales_add_(scales, value, field->scale, single ? FLT_EPSILON : DBL_EPSILON);
  }
}

static void TakeScales(MpmProbe *p, const mpmstab_scales *scales)
{
  MpmStepper *s = p->stepper;

  for (PetscInt f = 0; f < s->nfields; f++)
    for (PetscInt c = 0; c < s->fields[f].size; c++) p->scale[s->fields[f].first + c] = scales->scale[f];
}

/* How much each field changes when one is perturbed at random. */
static PetscErrorCode MeasureField(MpmProbe *p, PetscInt f, PetscReal size, PetscReal change[])
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

static PetscErrorCode SearchScales(MpmProbe *p, mpmstab_scales *scales)
{
  MpmStepper *s = p->stepper;
  PetscReal  *state, change[MPM_STEPPER_FIELDS];
  PetscInt    f;

  PetscFunctionBegin;
  BeginScales(s, PETSC_FALSE, scales);
  TakeScales(p, scales);
  p->steps = s->steps;
  PetscCall(PetscMalloc1(s->particles * s->width, &state));
  PetscCall(AnswersFloats(p, state));
  PetscCall(PetscFree(state));
  BeginScales(s, p->single, scales);
  while (!s->failure[0] && (f = mpmstab_scales_next_(scales)) >= 0) {
    TakeScales(p, scales);
    PetscCall(MeasureField(p, f, scales->size, change));
    if (!s->failure[0]) mpmstab_scales_take_(scales, f, change);
  }
  if (s->failure[0]) mpmstab_scales_fail_(scales); /* it may have no answer to what it was asked, and yet have others */
  s->failure[0] = '\0';
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Once for a stepper. */
static PetscErrorCode FindScales(MpmProbe *p)
{
  MpmStepper    *s   = p->stepper;
  PetscBool      all = PETSC_TRUE;
  mpmstab_scales scales;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(s->width, &p->scale));
  BeginScales(s, PETSC_FALSE, &scales);
  for (PetscInt f = 0; f < s->nfields; f++)
    if (!scales.given[f]) all = PETSC_FALSE;
  if (!all) {
    if (MpmRankOf(PETSC_COMM_WORLD) == 0) PetscCall(SearchScales(p, &scales));
    PetscCallMPI(MPI_Bcast(scales.scale, MPMSTAB_SCALES_MOST, MPIU_REAL, 0, PETSC_COMM_WORLD));
    PetscCallMPI(MPI_Bcast(&scales.unsettled, 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
    s->searched  = PETSC_TRUE;
    s->unsettled = scales.unsettled;
  }
  TakeScales(p, &scales);
  for (PetscInt f = 0; f < s->nfields; f++) {
    if (!scales.given[f]) s->fields[f].found = PETSC_TRUE;
    s->fields[f].scale = scales.scale[f];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- how to perturb ---- */

PetscErrorCode MpmProbeCreate(MpmStepper *s, MpmProbe *p)
{
  PetscFunctionBegin;
  *p = (MpmProbe){.stepper = s, .near = NEAR_SINGLE};
  for (PetscInt64 i = 0; i < s->particles * s->width; i++)
    if (s->base[i] != (PetscReal)(float)s->base[i]) p->near = NEAR;
  PetscCall(FindScales(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   How much the responses of one size differ from those of the next, to a random perturbation of the places alone, or of
   everything else. Apart from each other they show the curvature of columns, which have one unknown; together they have
   products of places and other fields. Of the sizes that are small bends is the largest difference
   over the largest response: a step that has a derivative gives about the same for all.
*/
static PetscErrorCode Compare(MpmProbe *p, PetscBool places, int first, PetscReal differ[], PetscReal *bends,
                              PetscInt64 *bends_at)
{
  const PetscInt64 n    = p->stepper->particles * p->stepper->width;
  const PetscReal *size = sizes[p->single], small = p->single ? SMALL_SINGLE : SMALL;
  PetscReal       *response[SIZES];
  PetscBool       *part;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(p->stepper->width, &part));
  for (PetscInt c = 0; c < p->stepper->width; c++)
    part[c] = (PlaceAxis(p->stepper, c) != MPM_NONE) == places ? PETSC_TRUE : PETSC_FALSE;
  for (int k = SIZES - 1; k >= first; k--) { /* a large one may throw a switch that stays on */
    PetscCall(PetscMalloc1(n, &response[k]));
    PetscCall(MpmProbeRandom(p, 2, size[k], part, NULL, response[k]));
  }
  PetscCall(PetscFree(part));
  for (int k = first; k + 1 < SIZES; k++) {
    PetscReal  most = 0, peak = 0;
    PetscInt64 at = MPM_NONE;

    for (PetscInt64 i = 0; i < n; i++) {
      const PetscReal difference = PetscAbsReal(response[k][i] - response[k + 1][i]);

      if (difference > most) at = i;
      most = PetscMax(most, difference);
      peak = PetscMax(peak, PetscAbsReal(response[k][i]));
    }
    differ[k] = PetscMax(differ[k], most);
    if (!(size[k] <= small && most > *bends * peak)) continue;
    *bends    = most / peak;
    *bends_at = at;
  }
  for (int k = first; k < SIZES; k++) PetscCall(PetscFree(response[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CompareParts(MpmProbe *p, int first, PetscReal differ[], PetscReal *bends, PetscInt64 *at)
{
  const MpmStepper *s = p->stepper;

  PetscFunctionBegin;
  *bends = 0;
  *at    = MPM_NONE;
  PetscCall(PetscArrayzero(differ, SIZES - 1));
  PetscCall(Compare(p, PETSC_FALSE, first, differ, bends, at));
  if (s->place != MPM_NONE && !MpmProbeIsApart(p, s->fields[s->place].first))
    PetscCall(Compare(p, PETSC_TRUE, first, differ, bends, at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeBends(MpmProbe *p, PetscReal *bends, PetscInt64 *at)
{
  PetscReal differ[SIZES - 1];
  int       first = 0;

  PetscFunctionBegin;
  while (sizes[p->single][first] > (p->single ? SMALL_SINGLE : SMALL)) first++;
  PetscCall(CompareParts(p, first, differ, bends, at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the two sizes next to one another of which the responses to a random perturbation differ least. */
static PetscErrorCode ChooseSizes(MpmProbe *p)
{
  PetscReal  differ[SIZES - 1], bends;
  PetscInt64 at;
  PetscInt   best = 0;

  PetscFunctionBegin;
  PetscCall(CompareParts(p, 0, differ, &bends, &at));
  for (int k = 0; k < SIZES - 1; k++)
    if (differ[k] < differ[best]) best = k;
  p->noise = differ[SIZES - 2];
  for (int k = 1; k < SIZES - 1; k++) /* of noise it is as the size is smaller */
    if (differ[k] * sizes[p->single][k] < differ[k - 1] * sizes[p->single][k - 1] / 2) p->noise = 0;
  p->size  = sizes[p->single][best];
  p->other = sizes[p->single][best + 1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- requests of several steps ---- */

/*
   Steps a state by requests of some steps each, until LATEST steps are done or it has changed much. first: the state
   after the first request.
*/
static PetscErrorCode StepOften(MpmProbe *p, PetscInt each, const PetscReal state[], PetscReal first[], PetscReal now[],
                                PetscInt *requests)
{
  MpmStepper      *s = p->stepper;
  const PetscInt64 n = s->particles * s->width;
  PetscReal       *before;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &before));
  PetscCall(PetscArraycpy(now, state, n));
  for (*requests = 0; *requests < 2 || *requests * each < LATEST; (*requests)++) {
    const PetscReal most = 4 * MpmProbeDistance(p, first, state) + sizes[p->single][0];

    if (*requests > 1 && (MpmProbeDistance(p, now, before) > most || MpmProbeDistance(p, now, state) > 1)) break;
    PetscCall(PetscArraycpy(before, now, n));
    PetscCall(MpmStepperStep(s, each, s->particles, now));
    if (!*requests) PetscCall(PetscArraycpy(first, now, n));
  }
  PetscCall(PetscFree(before));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   differs: by how much requests of some steps each differ from one request for all those steps, and the first of them
   from the same one later, over the size of the perturbation that the state has. Of a code that counts its steps these
   begin at other numbers, unless each request has whole periods.
*/
static PetscErrorCode Compose(MpmProbe *p, PetscInt each, PetscReal *differs)
{
  MpmStepper      *s = p->stepper;
  const PetscInt64 n = s->particles * s->width;
  PetscReal       *state, *first, *now, *other;
  PetscInt         requests = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc4(n, &state, n, &first, n, &now, n, &other));
  for (PetscInt64 i = 0; i < n; i++)
    state[i] = Rounded(p, s->base[i] + p->least * p->scale[i % s->width] * (2 * MpmHash(5, i) - 1));
  PetscCall(StepOften(p, each, state, first, now, &requests));
  PetscCall(PetscArraycpy(other, state, n));
  PetscCall(MpmStepperStep(s, each, s->particles, other));
  *differs = MpmProbeDistance(p, other, first) / p->least;
  PetscCall(PetscArraycpy(other, state, n));
  PetscCall(MpmStepperStep(s, each * requests, s->particles, other));
  *differs = PetscMax(*differs, MpmProbeDistance(p, other, now) / p->least);
  if (s->failure[0]) *differs = NAN; /* it may have no answer to so many steps, and yet have others */
  s->failure[0] = '\0';
  PetscCall(PetscFree4(state, first, now, other));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Looks for the number of steps after which steps repeat, if they are not alike, also when they are asked for again: a
   switch that has been thrown in between changes them once. All ranks then begin with a whole period, whatever each of
   them has asked before.
*/
static PetscErrorCode FindSteps(MpmProbe *p, PetscReal state[])
{
  MpmStepper *s = p->stepper;
  PetscReal   differs;

  PetscFunctionBegin;
  PetscCall(Compose(p, s->steps, &p->composed));
  for (PetscInt each = 1; each < LATEST && s->steps == 1 && p->composed > CHANGES; each++) {
    PetscCall(Compose(p, each, &differs));
    if (!(differs <= CHANGES * p->composed)) continue;
    if (each == 1) break;
    s->steps    = each;
    s->changes  = PETSC_TRUE;
    p->composed = differs;
  }
  PetscCallMPI(MPI_Bcast(&s->steps, 1, MPIU_INT, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(&p->composed, 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
  if (s->done % s->steps) {
    PetscCall(PetscArraycpy(state, s->base, s->particles * s->width));
    PetscCall(MpmStepperStep(s, s->steps - (PetscInt)(s->done % s->steps), s->particles, state));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the first rank has found is what all ranks take: a code with noise may answer each of them something else. */
static PetscErrorCode Share(MpmProbe *p)
{
  const MpmStepper *s                      = p->stepper;
  PetscReal         real[]                 = {p->size, p->other};
  PetscInt          whole[MPM_MAX_DIM + 2] = {p->steps, p->single};

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(whole + 2, p->shift, MPM_MAX_DIM));
  PetscCallMPI(MPI_Bcast(whole, MPM_MAX_DIM + 2, MPIU_INT, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(real, 2, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(p->rest, (PetscMPIInt)(s->particles * s->width), MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscCall(PetscArraycpy(p->shift, whole + 2, MPM_MAX_DIM));
  p->steps  = whole[0];
  p->single = (PetscBool)whole[1];
  p->size   = real[0];
  p->other  = real[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmProbeSizesOf(MpmProbe *p, const MpmProbe *other)
{
  p->single = other->single;
  p->size   = other->size;
  p->other  = other->other;
}

PetscErrorCode MpmProbeBegin(MpmProbe *p, PetscInt longest)
{
  MpmStepper      *s     = p->stepper;
  const PetscInt64 n     = s->particles * s->width;
  const PetscInt   steps = s->steps;
  PetscReal       *state;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &p->rest));
  PetscCall(PetscMalloc1(n, &state));
  p->steps = s->steps;
  if (p->size == 0) {
    PetscCall(AnswersFloats(p, state));
    p->least = sizes[p->single][SIZES - 1];
    PetscCall(PetscMalloc1(n, &p->first));
    PetscCall(MpmProbeRespondFirst(p, p->first));
    PetscCall(FindSteps(p, state));
  }
  PetscCall(FindPeriod(p, longest));
  PetscCall(PetscArraycpy(p->rest, s->base, n));
  PetscCall(MpmStepperStep(s, p->steps, s->particles, p->rest));
  PetscCall(MpmStepperAgree(s));
  if (s->place == MPM_NONE || !HasShifted(s, p->near, p->rest, p->shift))
    PetscCall(PetscArrayzero(p->shift, MPM_MAX_DIM));
  if (p->size == 0) {
    if (p->steps != steps) PetscCall(MpmProbeRespondFirst(p, p->first));
    PetscCall(ChooseSizes(p));
  }
  PetscCall(PetscFree(state));
  PetscCall(MpmStepperAgree(s));
  PetscCall(Share(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeDestroy(MpmProbe *p)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(p->scale));
  PetscCall(PetscFree(p->rest));
  PetscCall(PetscFree(p->first));
  PetscFunctionReturn(PETSC_SUCCESS);
}
