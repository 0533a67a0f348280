/* How a code is perturbed: sizes, precision, responses. */
#include "probe/probe.h"
#include "base/hash.h"
#include <mpmstab/errors.h>
#include <math.h>

#define SIZES 5
#define NEAR 1e-6        /* a place within this of a cell width is the same */
#define NEAR_SINGLE 3e-5 /* of states that are floats */
#define SMALL 1e-3       /* up to this size, in scales, a response should not depend on the size of its perturbation */
#define SMALL_SINGLE 0.01

/*
   The sizes that are tried, in scales. The best is between rounding, which is the precision over the size, and curvature,
   which is its square. In single precision they are large: most steps are quadratic about rest, and a central difference
   cancels that.
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
PetscErrorCode MpmProbeAnswersFloats(MpmProbe *p, PetscReal state[])
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

static PetscBool IsApart(const MpmProbe *p, PetscInt number)
{
  return p->apart ? p->apart[number] : PETSC_FALSE;
}

PetscReal MpmProbeDistance(const MpmProbe *p, const PetscReal one[], const PetscReal other[])
{
  const MpmStepper *s       = p->stepper;
  PetscReal         largest = 0;

  for (PetscInt64 i = 0; i < s->particles * s->width; i++) {
    const PetscInt number = (PetscInt)(i % s->width);

    if (IsApart(p, number)) continue;
    largest = PetscMax(largest, PetscAbsReal(Unwrap(s, PlaceAxis(s, number), one[i] - other[i])) / p->scale[number]);
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

    if (moved <= most || IsApart(p, number)) continue;
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

PetscErrorCode MpmProbeRespond(MpmProbe *p, PetscBool forward, PetscInt64 n, const PetscInt64 unknown[],
                               PetscReal amount[], PetscReal response[])
{
  MpmStepper      *s   = p->stepper;
  const PetscInt64 all = s->particles * s->width;
  PetscReal       *below;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(all, &below));
  PetscCall(PetscArraycpy(response, s->base, all));
  PetscCall(PetscArraycpy(below, s->base, all));
  for (PetscInt64 i = 0; i < n; i++) {
    const PetscReal scale = p->scale[unknown[i] % s->width], at = s->base[unknown[i]];

    response[unknown[i]] = Rounded(p, at + amount[i] * scale);
    below[unknown[i]]    = Rounded(p, at - amount[i] * scale);
    amount[i] = (forward ? response[unknown[i]] - at : (response[unknown[i]] - below[unknown[i]]) / 2) / scale;
  }
  PetscCall(MpmStepperStep(s, p->steps, s->particles, response));
  if (forward)
    PetscCall(PetscArraycpy(below, p->rest, all));
  else
    PetscCall(MpmStepperStep(s, p->steps, s->particles, below));
  for (PetscInt64 i = 0; i < all; i++) {
    const PetscInt  number     = (PetscInt)(i % s->width);
    const PetscReal difference = Unwrap(s, PlaceAxis(s, number), response[i] - below[i]);

    response[i] = difference / p->scale[number] / (forward ? 1 : 2);
  }
  PetscCall(PetscFree(below));
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
    if (IsApart(p, (PetscInt)(i % w)) || (part && !part[i % w])) continue;
    unknown[m] = i;
    by[m++]    = size * (2 * MpmHash(seed, i) - 1);
  }
  PetscCall(MpmProbeRespond(p, PETSC_FALSE, m, unknown, by, response));
  for (PetscInt64 i = 0; i < m && amount; i++) amount[unknown[i]] = by[i] / size;
  for (PetscInt64 i = 0; i < n; i++) response[i] = IsApart(p, (PetscInt)(i % w)) ? 0 : response[i] / size;
  PetscCall(PetscFree2(unknown, by));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- how to perturb ---- */

PetscErrorCode MpmProbeCreate(MpmStepper *s, MpmProbe *p)
{
  PetscFunctionBegin;
  *p = (MpmProbe){.stepper = s, .near = NEAR_SINGLE};
  for (PetscInt64 i = 0; i < s->particles * s->width; i++)
    if (s->base[i] != (PetscReal)(float)s->base[i]) p->near = NEAR;
  PetscCall(MpmProbeScales(p));
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
  for (int k = first; k < SIZES; k++) {
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
  if (s->place != MPM_NONE && !IsApart(p, s->fields[s->place].first))
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
  p->size  = sizes[p->single][best];
  p->other = sizes[p->single][best + 1];
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
  MpmStepper      *s = p->stepper;
  const PetscInt64 n = s->particles * s->width;
  PetscReal       *again;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &p->rest));
  PetscCall(PetscMalloc1(n, &again));
  PetscCall(FindPeriod(p, longest));
  PetscCall(PetscArraycpy(p->rest, s->base, n));
  PetscCall(MpmStepperStep(s, p->steps, s->particles, p->rest));
  PetscCall(MpmStepperAgree(s));
  if (s->place == MPM_NONE || !HasShifted(s, p->near, p->rest, p->shift))
    PetscCall(PetscArrayzero(p->shift, MPM_MAX_DIM));
  if (p->size == 0) {
    PetscCall(MpmProbeAnswersFloats(p, again));
    PetscCall(ChooseSizes(p));
  }
  PetscCall(PetscFree(again));
  PetscCall(MpmStepperAgree(s));
  PetscCall(Share(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProbeDestroy(MpmProbe *p)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(p->scale));
  PetscCall(PetscFree(p->rest));
  PetscFunctionReturn(PETSC_SUCCESS);
}
