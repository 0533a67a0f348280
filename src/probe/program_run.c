/* Growth by running a code: the largest Lyapunov exponent by scaling perturbations back (Benettin et al. 1980). */
#include "probe/program_run.h"
#include "base/hash.h"
#include <mpmstab/errors.h>
#include <math.h>

#define PERTURBATIONS 4
#define STUDENT 3.182  /* of three degrees of freedom, for 95% */
#define REQUESTS 100   /* of a run, if growth allows so many steps in each */
#define MOST 100       /* by which perturbations may grow in a request */
#define EXPONENTIAL 50 /* a factor in half a run that linear growth, which makes 2, cannot make */

/* state: the base and the perturbed states; sum: of the logarithms of growth in the third and the last quarter, of late steps each. */
typedef struct {
  MpmProbe  *probe;
  PetscInt64 n;
  PetscReal *state, *kept, sum[2][PERTURBATIONS];
  PetscInt   late[2];
} Run;

/* The norm of a perturbation in scales. */
static PetscReal Norm(const Run *r, PetscInt k)
{
  const PetscReal *base = r->state, *other = base + (k + 1) * r->n;
  PetscReal        sum = 0;

  for (PetscInt64 i = 0; i < r->n; i++) sum += PetscSqr(MpmProbeDifference(r->probe, i, other, base));
  return sqrt(sum / (PetscReal)r->n);
}

/* Scales a perturbation. */
static void Scale(Run *r, PetscInt k, PetscReal by)
{
  const PetscInt w     = r->probe->stepper->width;
  PetscReal     *other = r->state + (k + 1) * r->n;

  for (PetscInt64 i = 0; i < r->n; i++)
    other[i] = r->state[i] + by * MpmProbeDifference(r->probe, i, other, r->state) * r->probe->scale[i % w];
}

/* Steps all states; growth: the largest logarithm. */
static PetscErrorCode Request(Run *r, PetscInt steps, PetscReal size, PetscReal log_of[], PetscReal *most)
{
  MpmStepper *s = r->probe->stepper;

  PetscFunctionBegin;
  *most = -INFINITY;
  PetscCall(PetscArraycpy(r->kept, r->state, (PERTURBATIONS + 1) * r->n));
  PetscCall(MpmStepperStepAll(s, steps, s->particles, PERTURBATIONS + 1, r->state));
  for (PetscInt k = 0; k < PERTURBATIONS && !s->failure[0]; k++) {
    const PetscReal norm = Norm(r, k);

    log_of[k] = log(norm / size);
    *most     = PetscMax(*most, log_of[k]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Growth is the mean over the second half. Its limits have Student's interval of the perturbations, what the last quarter differs by from
   the one before, since modes that are close to one another part slowly, and what perturbations of this size bend.
*/
static void Fit(const Run *r, PetscReal size, MpmProgramRun *run)
{
  const PetscReal steps = (PetscReal)(r->late[0] + r->late[1]);
  PetscReal       mean = 0, square = 0, part[2] = {0, 0}, margin;

  for (PetscInt k = 0; k < PERTURBATIONS; k++) {
    for (int q = 0; q < 2; q++) part[q] += r->sum[q][k] / (PetscReal)r->late[q] / PERTURBATIONS;
    mean += (r->sum[0][k] + r->sum[1][k]) / steps / PERTURBATIONS;
  }
  for (PetscInt k = 0; k < PERTURBATIONS; k++)
    square += PetscSqr((r->sum[0][k] + r->sum[1][k]) / steps - mean) / (PERTURBATIONS * (PERTURBATIONS - 1));
  margin      = STUDENT * sqrt(square) + PetscAbsReal(part[1] - part[0]) + size;
  run->growth = exp(mean);
  run->low    = exp(mean - margin);
  run->high   = exp(mean + margin);
  run->factor = exp(mean * steps);
}

/* Runs on the first rank. A request in which perturbations grow too much is made again with fewer steps. */
static PetscErrorCode March(Run *r, PetscInt steps, PetscReal size, MpmProgramRun *run)
{
  MpmStepper *s    = r->probe->stepper;
  PetscInt    each = PetscMax(1, steps / REQUESTS / s->steps) * s->steps;

  PetscFunctionBegin;
  while (run->steps < steps && !run->ended) {
    PetscReal log_of[PERTURBATIONS], most;
    PetscBool ends;

    PetscCall(Request(r, each, size, log_of, &most));
    ends = s->failure[0] || !isfinite(most) ? PETSC_TRUE : PETSC_FALSE;
    if ((ends || most > log(MOST)) && each > s->steps) {
      each = PetscMax(1, each / 2 / s->steps) * s->steps;
      PetscCall(PetscArraycpy(r->state, r->kept, (PERTURBATIONS + 1) * r->n));
      continue;
    }
    run->ended = ends;
    if (ends) break;
    run->steps += each;
    for (PetscInt k = 0; k < PERTURBATIONS; k++) {
      if (2 * run->steps > steps) r->sum[4 * run->steps > 3 * steps][k] += log_of[k];
      Scale(r, k, exp(-log_of[k]));
    }
    if (2 * run->steps > steps) r->late[4 * run->steps > 3 * steps] += each;
  }
  if (r->late[0] && r->late[1]) Fit(r, size, run);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramRunFind(MpmProgram *p, PetscInt steps, MpmProgramRun *run, MpmFinding *f)
{
  const MpmStepper *s    = p->stepper;
  const PetscReal   size = p->probe.least;
  Run               r    = {.probe = &p->probe, .n = s->particles * s->width};

  PetscFunctionBegin;
  *run = (MpmProgramRun){.perturbations = PERTURBATIONS, .growth = NAN, .low = NAN, .high = NAN, .factor = NAN};
  PetscCall(MpmStepperExpect(p->stepper, "calls", 2 * REQUESTS * (PERTURBATIONS + 1)));
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) {
    PetscCall(PetscMalloc2((PERTURBATIONS + 1) * r.n, &r.state, (PERTURBATIONS + 1) * r.n, &r.kept));
    for (PetscInt k = 0; k <= PERTURBATIONS; k++)
      for (PetscInt64 i = 0; i < r.n; i++)
        r.state[k * r.n + i] =
            s->base[i] + (k ? size * (2 * MpmHash(100 + k, i) - 1) * p->probe.scale[i % s->width] : 0);
    for (PetscInt k = 0; k < PERTURBATIONS; k++) Scale(&r, k, size / Norm(&r, k));
    PetscCall(March(&r, steps, size, run));
    PetscCall(PetscFree2(r.state, r.kept));
  }
  PetscCall(MpmStepperForgetExpected(p->stepper));
  if (run->steps) p->stepper->failure[0] = '\0'; /* what it has answered counts */
  PetscCall(MpmStepperAgree(p->stepper));
  PetscCallMPI(MPI_Bcast(run, sizeof *run, MPI_BYTE, 0, PETSC_COMM_WORLD));
  *f = (MpmFinding){.growth = run->growth, .tolerance = p->tolerance, .uncertainty = run->high - run->growth};
  (void)snprintf(f->evidence, sizeof f->evidence,
                 "measured, not proved: a run of %" PetscInt_FMT " steps with %d random perturbations", run->steps,
                 PERTURBATIONS);
  f->verdict = run->low > 1 + f->tolerance && run->factor > EXPONENTIAL ? MPM_UNSTABLE : MPM_UNDECIDED;
  PetscFunctionReturn(PETSC_SUCCESS);
}
