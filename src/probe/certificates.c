/* Certificates of a code that is probed: what its answers to known questions should be. */
#include "probe/certificates.h"
#include "base/hash.h"
#include <float.h>
#include <math.h>

#define SWITCHES 0.02 /* of smooth steps the response depends on its size by up to 2e-3 (a thousandfold curvature) */
/*
   Of what should vanish with the size of perturbations. Smooth steps were measured to have up to 3e-7, of floats 3e-4.
   A clamp on one particle of 32 that has a thousandth of its strength shows 1e-4, and made growth of 3e-5 per step that
   was not there.
*/
#define KINKS 1e-5
#define KINKS_SINGLE 1e-3
#define ROUNDINGS 4       /* that one number of a response, of two sizes, has */
#define SMALL 1e-3        /* the size at which switches are looked for */
#define SMALL_SINGLE 0.01 /* larger, above rounding */
#define SPREAD 10         /* times the tolerance: of two sizes, since growth itself is compared too */
#define SPREAD_SINGLE 100
#define MOVES_BY 1e-3       /* the share of a mode's growth by which the base state may move */
#define NOISES 10           /* times noise, what certificates make of it */
#define LASTS 10            /* times what noise makes of a response, its change is none */
#define ANOTHER 0.01        /* a code whose answers change by more may be another one than it was */
#define AT_REST_SINGLE 1e-5 /* of floats */

const char *const MpmCertificateNames[] = {"repeat",      "two steps", "two sizes", "additivity", "one side",
                                           "equilibrium", "reach",     "columns",   "scales"};

const char *const MpmCertificateTexts[] = {"the first perturbation again after all others",
                                           "steps in one request against one step each",
                                           "probed with two sizes: norm of the difference",
                                           "a sum of perturbations against the sum of responses",
                                           "forward against backward at the base state",
                                           "the base state after a step",
                                           "what is felt farther away than should be",
                                           "everything perturbed at once against the columns",
                                           "scales of fields, looked for once more: change in powers of 2"};

const char *const MpmCertificateFaults[] = {"the code does not repeat itself",
                                            "several steps in one request are not one step each",
                                            "two sizes of perturbations give two operators",
                                            "the step has switches (responses do not add up)",
                                            "the base state is on a switch",
                                            "the base state moves, so that the operator is that of one step",
                                            "the block of cells is too small for the reach of a step",
                                            "the columns are not those of the whole state",
                                            "the scale of a field was not found (it can be declared)"};

static const char *const cures[] = {
    "answers differ from one time to the next: sum in a fixed order, and begin a solver anew in each step; or measure "
    "growth "
    "by a run (spectrum -program_run 1000)",
    "the code keeps something besides its state: add it to the fields, or let it be forgotten before each request "
    "(reset)",
    "the step is strongly curved: give scales that are smaller",
    "the step has switches near the base state (limiters, cut-offs, yield, small numbers that are set to 0): switch "
    "them off, or measure growth by a run (spectrum -program_run 1000)",
    "the base state is on a switch (contact, cut-off, yield, viscosity in compression only): switch it off, or "
    "describe a state "
    "beside it, such as one that is stretched by 1e-3",
    "the base state moves: describe one at rest, or one that repeats itself in other cells; or measure growth by a run "
    "(spectrum -program_run 1000)",
    "a step reaches farther: describe more cells (for quadratic splines with 2 particles a cell 7 each way)",
    "particles feel what is far away, or the step has switches: probe all columns (-probe matrix_free)",
    "declare the scale of each field: about the speed of waves for a velocity, the stiffness for a stress"};

/* Whether noise in the answers explains a value. */
static PetscBool IsNoise(const MpmCertificates *c, MpmCertificate which)
{
  return c->value[which] <= NOISES * c->noise ? PETSC_TRUE : PETSC_FALSE;
}

PetscBool MpmCertificatesSwitch(const MpmCertificates *c)
{
  return MpmCertificatesFault(c) > MPM_CERTIFY_COMPOSED && MpmCertificateFails(c, MPM_CERTIFY_ONE_SIDED) &&
                 !IsNoise(c, MPM_CERTIFY_ONE_SIDED)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/* Where the code is another one from one time to the next, answers to perturbations are not of one code. */
const char *MpmCertificateCure(const MpmCertificates *c, MpmCertificate which)
{
  if (MpmCertificatesFault(c) <= MPM_CERTIFY_COMPOSED && which <= MPM_CERTIFY_ONE_SIDED)
    which = MpmCertificatesFault(c);
  if (which == MPM_CERTIFY_REPEAT && c->value[which] > ANOTHER) return cures[MPM_CERTIFY_COMPOSED];
  if (which > MPM_CERTIFY_COMPOSED && which <= MPM_CERTIFY_ONE_SIDED && IsNoise(c, which))
    return c->single
               ? "floats have too few digits for this: let the code compute in double precision, or measure growth "
                 "by a run, with perturbations of 3e-3 in four directions (spectrum -program_run 1000)"
               : "the tolerance of a solver, or rounding: give the solver a tolerance of 1e-12, or measure growth by "
                 "a run (spectrum -program_run 1000)";
  return cures[which];
}

/* A fault of the code itself, or noise, explains what else fails; then a switch does. */
const char *MpmCertificatesCure(const MpmCertificates *c)
{
  const MpmCertificate which = MpmCertificatesFault(c);

  if (which == MPM_CERTIFICATES) return NULL;
  if (which > MPM_CERTIFY_COMPOSED && !(which <= MPM_CERTIFY_ONE_SIDED && IsNoise(c, which))) {
    if (MpmCertificateFails(c, MPM_CERTIFY_ONE_SIDED)) return cures[MPM_CERTIFY_ONE_SIDED];
    if (which == MPM_CERTIFY_SIZES && MpmCertificateFails(c, MPM_CERTIFY_ADDITIVITY))
      return cures[MPM_CERTIFY_ADDITIVITY];
  }
  return MpmCertificateCure(c, which);
}

PetscBool MpmCertificatesTaken(const MpmCertificates *c)
{
  for (int i = 0; i < MPM_CERTIFICATES; i++)
    if (!isnan(c->value[i])) return PETSC_TRUE;
  return PETSC_FALSE;
}

MpmCertificate MpmCertificatesFault(const MpmCertificates *c)
{
  MpmCertificate which = 0;

  while (which < MPM_CERTIFICATES && !MpmCertificateFails(c, which)) which++;
  return which;
}

PetscBool MpmCertificateFails(const MpmCertificates *c, MpmCertificate which)
{
  return isnan(c->value[which]) || c->value[which] <= c->bound[which] ? PETSC_FALSE : PETSC_TRUE;
}

void MpmCertificatesBegin(PetscBool single, PetscReal tolerance, MpmCertificates *c)
{
  c->tolerance = tolerance;
  c->single    = single;
  c->noise     = 0;
  c->cells     = 1;
  c->nfields   = 0;
  c->kinked    = 0;
  for (int i = 0; i < MPM_CERTIFICATES; i++) {
    c->value[i] = NAN;
    c->bound[i] = tolerance;
    c->most[i]  = MPM_NONE;
  }
  c->bound[MPM_CERTIFY_ADDITIVITY] = SWITCHES;
  c->bound[MPM_CERTIFY_ONE_SIDED] = c->bound[MPM_CERTIFY_COLUMNS] = single ? KINKS_SINGLE : KINKS;
  c->bound[MPM_CERTIFY_SCALES]                                    = 1;
  c->bound[MPM_CERTIFY_EQUILIBRIUM]                               = single ? AT_REST_SINGLE : MPM_AT_REST;
  c->bound[MPM_CERTIFY_SIZES] = c->bound[MPM_CERTIFY_COMPOSED] = (single ? SPREAD_SINGLE : SPREAD) * tolerance;
}

/* Everything at once is perturbed by little, so that products of two perturbations are small. */
static PetscReal Small(const MpmProbe *p)
{
  return PetscMin(p->size, p->single ? SMALL_SINGLE : SMALL);
}

/* Takes a difference of unknown i if it is the largest so far. */
static void Most(MpmCertificates *c, MpmCertificate which, PetscInt64 i, PetscReal difference)
{
  if (difference <= c->value[which]) return;
  c->value[which] = difference;
  c->most[which]  = i;
}

/* All ranks take the largest value. */
static PetscErrorCode Share(MpmCertificates *c)
{
  PetscReal value[MPM_CERTIFICATES];

  PetscFunctionBegin;
  for (int i = 0; i < MPM_CERTIFICATES; i++) value[i] = isnan(c->value[i]) ? -1 : c->value[i];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, value, MPM_CERTIFICATES, MPIU_REAL, MPI_MAX, PETSC_COMM_WORLD));
  for (int i = 0; i < MPM_CERTIFICATES; i++) c->value[i] = value[i] < 0 ? NAN : value[i];
  PetscCallMPI(MPI_Bcast(c->most, MPM_CERTIFICATES, MPIU_INT64, 0, PETSC_COMM_WORLD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest difference of two responses, and its unknown. */
static PetscReal Difference(const MpmProbe *p, const PetscReal one[], const PetscReal other[], PetscInt64 *at)
{
  const PetscInt width = p->stepper->width;
  PetscReal      most  = 0;

  *at = MPM_NONE;
  for (PetscInt64 i = 0; i < p->stepper->particles * width; i++) {
    if (p->apart[i % width] || !(PetscAbsReal(one[i] - other[i]) > most)) continue;
    most = PetscAbsReal(one[i] - other[i]);
    *at  = i;
  }
  return most;
}

/*
   Steps a perturbed state before and after another one, which is the base state with its particles in the opposite
   order: it is as good a state as the base, and every particle is elsewhere. What the answers differ by is an error of
   the operator. Then the first perturbation of all is asked for once more. If its response has changed by more than
   comes of that, a larger perturbation has switched something on that stays.
*/
PetscErrorCode MpmCertifyRepeat(MpmProbe *p, const PetscBool apart[], MpmCertificates *c)
{
  MpmStepper      *s = p->stepper;
  const PetscInt64 n = s->particles * s->width;
  PetscReal       *one, *other, *amount, *value = &c->value[MPM_CERTIFY_REPEAT], late;
  PetscInt64       at, *most = &c->most[MPM_CERTIFY_REPEAT];

  PetscFunctionBegin;
  PetscCall(PetscMalloc3(n, &one, n, &other, n, &amount));
  p->apart = apart;
  PetscCall(MpmProbeRandom(p, 12, p->size, NULL, amount, one));
  for (PetscInt64 i = 0; i < s->particles; i++)
    PetscCall(PetscArraycpy(other + i * s->width, s->base + (s->particles - 1 - i) * s->width, s->width));
  PetscCall(MpmStepperStep(s, p->steps, s->particles, other));
  PetscCall(MpmProbeRandom(p, 12, p->size, NULL, amount, other));
  *value = Difference(p, one, other, most);
  PetscCall(PetscArraycpy(other, s->base, n));
  PetscCall(MpmStepperStep(s, p->steps, s->particles, other));
  Most(c, MPM_CERTIFY_REPEAT, MPM_NONE, MpmProbeDistance(p, other, p->rest) / p->size);
  PetscCall(MpmProbeRespondFirst(p, other));
  late = Difference(p, p->first, other, &at);
  if (late > LASTS * p->size / p->least * *value) Most(c, MPM_CERTIFY_REPEAT, at, late);
  p->apart = NULL;
  PetscCall(PetscFree3(one, other, amount));
  PetscCall(MpmStepperAgree(s));
  PetscCall(Share(c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The responses to two perturbations and to their sum. */
static PetscErrorCode Additivity(MpmProbe *p, PetscReal size, MpmCertificates *c)
{
  const PetscInt64 n = p->stepper->particles * p->stepper->width;
  PetscReal       *amount[3], *response[3], largest = 0;

  PetscFunctionBegin;
  for (int k = 0; k < 3; k++) PetscCall(PetscMalloc2(n, &amount[k], n, &response[k]));
  for (int k = 0; k < 2; k++) PetscCall(MpmProbeRandom(p, 21 + k, size, NULL, amount[k], response[k]));
  for (PetscInt64 i = 0; i < n; i++) amount[2][i] = size * (amount[0][i] + amount[1][i]);
  PetscCall(MpmProbeRespond(p, PETSC_FALSE, n, NULL, amount[2], response[2]));
  for (PetscInt64 i = 0; i < n; i++) {
    response[2][i] = p->apart[i % p->stepper->width] ? 0 : response[2][i] / size;
    largest        = PetscMax(largest, PetscAbsReal(response[2][i]));
  }
  PetscCall(MpmProbeBends(p, &c->value[MPM_CERTIFY_ADDITIVITY], &c->most[MPM_CERTIFY_ADDITIVITY]));
  for (PetscInt64 i = 0; i < n && largest > 0; i++)
    Most(c, MPM_CERTIFY_ADDITIVITY, i, PetscAbsReal(response[2][i] - response[0][i] - response[1][i]) / largest);
  for (int k = 0; k < 3; k++) PetscCall(PetscFree2(amount[k], response[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What rounding a number of the state may make of a response, in scales, with perturbations of a size. Floats have a
   few digits of a place left when its scale is the width of a cell.
*/
static PetscReal Rounding(const MpmProbe *p, PetscInt64 i, PetscReal size)
{
  const PetscReal epsilon = p->single ? FLT_EPSILON : PETSC_MACHINE_EPSILON;

  return ROUNDINGS * epsilon * PetscAbsReal(p->stepper->base[i]) / p->scale[i % p->stepper->width] / size;
}

/*
   D(s) = (F(q + s r) + F(q - s r) - 2 F(q)) / (2 s) is of the order of s where F is smooth, and does not depend on s
   where F has a kink at q. So 2 D(s / 2) - D(s) shows the kink.
*/
static PetscErrorCode OneSided(MpmProbe *p, PetscReal size, MpmCertificates *c)
{
  const PetscInt64 n = p->stepper->particles * p->stepper->width;
  PetscReal       *amount, *forward, *central, *kink, largest = 0;

  PetscFunctionBegin;
  PetscCall(PetscCalloc4(n, &amount, n, &forward, n, &central, n, &kink));
  for (int half = 0; half < 2; half++) {
    const PetscReal by = half ? size / 2 : size;

    PetscCall(MpmProbeRandom(p, 31, by, NULL, amount, central));
    for (PetscInt64 i = 0; i < n; i++) amount[i] *= by;
    PetscCall(MpmProbeRespond(p, PETSC_TRUE, n, NULL, amount, forward));
    for (PetscInt64 i = 0; i < n; i++) {
      if (p->apart[i % p->stepper->width]) continue;
      kink[i] += (half ? 2 : -1) * (forward[i] / by - central[i]);
      largest = PetscMax(largest, PetscAbsReal(central[i]));
    }
  }
  c->value[MPM_CERTIFY_ONE_SIDED] = 0;
  for (PetscInt64 i = 0, last = -1; i < n && largest > 0; i++) {
    const PetscReal beyond = (PetscAbsReal(kink[i]) - Rounding(p, i, size)) / largest;

    Most(c, MPM_CERTIFY_ONE_SIDED, i, beyond);
    if (beyond <= c->bound[MPM_CERTIFY_ONE_SIDED] || last == i / p->stepper->width) continue;
    last = i / p->stepper->width;
    c->kinked++;
  }
  PetscCall(PetscFree4(amount, forward, central, kink));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The response to a random perturbation of everything, for no size: of two sizes the error, which is of the order of
   their square where the step is smooth, is taken out (Richardson 1911).
*/
static PetscErrorCode RespondToAll(MpmProbe *p, PetscReal amount[], PetscReal response[])
{
  const PetscInt64 n    = p->stepper->particles * p->stepper->width;
  const PetscReal  size = Small(p);
  PetscReal       *half, *of;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &half, n, &of));
  PetscCall(MpmProbeRandom(p, 41, size, NULL, amount, response));
  PetscCall(MpmProbeRandom(p, 41, size / 2, NULL, of, half));
  for (PetscInt64 i = 0; i < n; i++) {
    amount[i]   = (4 * of[i] - amount[i]) / 3;
    response[i] = (4 * half[i] - response[i]) / 3;
  }
  PetscCall(PetscFree2(half, of));
  PetscCall(MpmStepperAgree(p->stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void TakeScales(const MpmStepper *s, MpmCertificates *c)
{
  const char *found = s->unsettled <= c->bound[MPM_CERTIFY_SCALES] ? "found" : "guessed";

  if (s->searched) c->value[MPM_CERTIFY_SCALES] = s->unsettled;
  c->nfields = s->nfields;
  for (PetscInt f = 0; f < s->nfields; f++) {
    const MpmStepperField *field = &s->fields[f];
    const PetscBool        cell  = f == s->place && field->scale == s->cell_width ? PETSC_TRUE : PETSC_FALSE;

    c->field[f].scale = field->scale;
    (void)snprintf(c->field[f].name, sizeof c->field[f].name, "%s", field->name);
    (void)snprintf(c->field[f].from, sizeof c->field[f].from, "%s",
                   field->found ? found
                   : cell       ? "cell_width"
                                : "declared");
  }
}

PetscErrorCode MpmCertifyStep(MpmProbe *p, PetscReal tolerance, const PetscBool apart[], MpmCertificates *c)
{
  const PetscReal size     = Small(p);
  PetscReal       coarsest = 0;

  PetscFunctionBegin;
  MpmCertificatesBegin(p->single, tolerance, c);
  c->noise = p->noise;
  p->apart = apart;
  for (PetscInt64 i = 0; i < p->stepper->particles * p->stepper->width; i++)
    coarsest = PetscMax(coarsest, Rounding(p, i, size));
  c->bound[MPM_CERTIFY_COLUMNS] += coarsest;
  PetscCall(Additivity(p, size, c));
  PetscCall(OneSided(p, size, c));
  c->value[MPM_CERTIFY_COMPOSED]    = p->composed;
  c->value[MPM_CERTIFY_EQUILIBRIUM] = MpmProbeMoved(p, &c->most[MPM_CERTIFY_EQUILIBRIUM]);
  TakeScales(p->stepper, c);
  p->apart = NULL;
  PetscCall(MpmStepperAgree(p->stepper));
  PetscCall(Share(c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCertifyColumns(MpmProbe *p, const MpmProbeLattice *l, const MpmProbed *one, const PetscBool apart[],
                                 PetscReal *differ, PetscInt64 *most)
{
  const PetscInt64 n = p->stepper->particles * p->stepper->width;
  PetscReal       *amount, *response;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &amount, n, &response));
  p->apart = apart;
  PetscCall(RespondToAll(p, amount, response));
  p->apart = NULL;
  PetscCall(MpmProbedCompare(one, p, l, amount, response, apart, differ, most));
  PetscCall(PetscFree2(amount, response));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCertifyOperator(MpmProbe *p, const MpmProbeLattice *l, const MpmProbed *one, const MpmProbed *kept,
                                  const MpmProbed *other, const PetscBool apart[], MpmCertificates *c)
{
  PetscFunctionBegin;
  if (one)
    PetscCall(MpmCertifyColumns(p, l, one, apart, &c->value[MPM_CERTIFY_COLUMNS], &c->most[MPM_CERTIFY_COLUMNS]));
  PetscCall(MpmProbedDistance(kept, other, &c->value[MPM_CERTIFY_SIZES]));
  if (!kept->A) c->cells = p->stepper->particles / l->sites;
  PetscCall(Share(c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the verdict ---- */

/*
   Whether growth is beyond what the fault that a certificate shows can make of an eigenvalue of this condition. What is
   felt too far away may be felt in every cell. A code that is another one in the next step, or later, has other
   eigenvalues.
*/
static PetscBool IsBeyond(const MpmCertificates *c, MpmCertificate which, PetscReal condition, const MpmFinding *f)
{
  const PetscReal value  = c->value[which] * (PetscReal)(which == MPM_CERTIFY_REACH ? c->cells : 1),
                  excess = f->growth - 1;

  if (which == MPM_CERTIFY_COMPOSED || (which == MPM_CERTIFY_REPEAT && value > ANOTHER)) return PETSC_FALSE;
  if (which == MPM_CERTIFY_EQUILIBRIUM) return value < MOVES_BY * excess ? PETSC_TRUE : PETSC_FALSE;
  return excess > f->tolerance + condition * value ? PETSC_TRUE : PETSC_FALSE;
}

PetscErrorCode MpmCertificatesJudge(const MpmCertificates *c, const PetscReal *other, PetscReal condition,
                                    PetscInt period, MpmFinding *f)
{
  PetscReal error = 0;

  PetscFunctionBegin;
  f->tolerance = c->tolerance;
  if (!isnan(c->value[MPM_CERTIFY_SIZES])) error += c->value[MPM_CERTIFY_SIZES];
  if (!isnan(c->value[MPM_CERTIFY_REPEAT])) error += c->value[MPM_CERTIFY_REPEAT];
  if (f->growth > 1 + f->tolerance)
    f->uncertainty =
        PetscMax(f->uncertainty, MpmUncertaintyOf(f->growth, condition * error / pow(f->growth, period), period));
  f->lost    = MpmCertificateFails(c, MPM_CERTIFY_REPEAT) ? "answers that do not repeat themselves"
               : !IsNoise(c, MPM_CERTIFY_SIZES)           ? "switches or curvature of the step"
               : c->single                                ? "the rounding of floats"
                                                          : "the tolerance of a solver, or rounding";
  f->verdict = MpmVerdictOf(f);
  if (other && f->verdict == MPM_UNSTABLE && !(*other - 1 > f->tolerance + f->uncertainty))
    PetscCall(MpmFindingDispute(f, "with the other size of perturbations it does not grow so"));
  if (other && f->verdict == MPM_STABLE && *other - 1 > f->tolerance)
    PetscCall(MpmFindingDispute(f, "with the other size of perturbations it grows"));
  for (MpmCertificate which = 0; which < MPM_CERTIFICATES; which++) {
    if (!MpmCertificateFails(c, which)) continue;
    if (f->verdict == MPM_UNSTABLE && IsBeyond(c, which, condition, f)) continue;
    PetscCall(MpmFindingDispute(f, MpmCertificateFaults[which]));
    if (which == MPM_CERTIFY_REPEAT) break; /* nothing else is of one code then */
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
