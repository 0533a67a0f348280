/*
   From a prepared program to a verdict: its operator is probed with both sizes of perturbations. Then what its mode and
   a switch show.
*/
#include "probe/program_growth.h"
#include "analysis/waves.h"
#include "base/hash.h"
#include "linalg/dense.h"
#include <math.h>
#include <stdlib.h>

#define NEARLY_ALL 0.9
#define FEW 0.1     /* the part of the particles */
#define BESIDE 1e-2 /* in scales: how far a field is changed; certificates perturb by up to a tenth of it */
#define BESIDE_SINGLE 0.1
#define SIDE 1e-3       /* of that: how far the sides of few switches are away, so that stresses there do not matter */
#define MOST_ORDER 2048 /* of an operator whose sides are looked at */
#define PERTURBATIONS 4
#define STUDENT 3.182  /* of three degrees of freedom, for 95% */
#define REQUESTS 100   /* of a run, if growth allows so many steps in each */
#define MOST 100       /* by which perturbations may grow in a request */
#define EXPONENTIAL 50 /* a factor in half a run that linear growth, which makes 2, cannot make */

/* ---- carriers ---- */

typedef struct {
  PetscReal  share;
  PetscInt64 particle;
} Share;

static int ByShare(const void *one, const void *other)
{
  const Share *p = one, *q = other;

  if (p->share != q->share) return p->share > q->share ? -1 : 1;
  return p->particle < q->particle ? -1 : p->particle > q->particle;
}

/* Adds the squares of a vector's numbers to the shares of their particles, of which each has n numbers. */
static PetscErrorCode AddSquares(Vec x, PetscInt n, PetscReal squares[])
{
  const PetscScalar *value;
  PetscInt           first, last;

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(x, &first, &last));
  PetscCall(VecGetArrayRead(x, &value));
  for (PetscInt i = first; i < last; i++) squares[i / n] += PetscSqr(value[i - first]);
  PetscCall(VecRestoreArrayRead(x, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCarriersFind(const MpmProgram *p, const MpmSpectrum *s, MpmCarriers *c)
{
  const PetscInt64 particles = p->stepper->particles;
  PetscReal       *squares, all = 0, sum = 0;
  Share           *shares;
  Vec              x[2];

  PetscFunctionBegin;
  *c = (MpmCarriers){.n = 0, .all = particles, .dim = p->stepper->place == MPM_NONE ? 0 : p->stepper->dim};
  if (!s->eigen->n) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc1(particles, &squares));
  PetscCall(PetscMalloc1(particles, &shares));
  for (int part = 0; part < 2; part++) PetscCall(MatCreateVecs(s->op->A, &x[part], NULL));
  PetscCall(MpmEigenVector(s->eigen, 0, x[0], x[1]));
  for (int part = 0; part < 2; part++) {
    if (s->op->unit) PetscCall(VecPointwiseDivide(x[part], x[part], s->op->unit));
    PetscCall(AddSquares(x[part], p->unread.n, squares));
    PetscCall(VecDestroy(&x[part]));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, squares, (PetscMPIInt)particles, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD));
  for (PetscInt64 i = 0; i < particles; i++) {
    shares[i] = (Share){.share = squares[i], .particle = i};
    all += squares[i];
  }
  qsort(shares, (size_t)particles, sizeof *shares, ByShare);
  c->n = (PetscInt)PetscMin(MPM_CARRIERS, particles);
  for (PetscInt i = 0; i < c->n; i++) {
    c->particle[i] = shares[i].particle;
    c->share[i]    = shares[i].share / all;
    if (c->dim) PetscCall(PetscArraycpy(c->place[i], MpmStepperPlace(p->stepper, c->particle[i]), c->dim));
  }
  while (c->most < particles && sum < NEARLY_ALL * all) sum += shares[c->most++].share;
  PetscCall(PetscFree(squares));
  PetscCall(PetscFree(shares));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- verdicts ---- */

/*
   Without all eigenvalues those of a shell or a lattice near the spectrum's first mode are found on the space of that
   mode.
*/
static PetscErrorCode SolveOther(const MpmProgram *p, const MpmSpectrum *s, Mat B, MpmEigen **eigen)
{
  const PetscReal target[2] = {0, 0};
  Vec             x[2];

  PetscFunctionBegin;
  if (!p->shell && !MpmProgramLattice(p)) {
    PetscCall(MpmEigenSolve(B, NULL, s->eigen->complete ? MPM_EIGEN_DENSE : MPM_EIGEN_LARGEST, target, eigen));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (int part = 0; part < 2; part++) PetscCall(MatCreateVecs(B, &x[part], NULL));
  if (s->eigen->n) PetscCall(MpmEigenVector(s->eigen, 0, x[0], x[1]));
  PetscCall(MpmEigenRitz(B, s->eigen->n ? 2 : 0, x, eigen));
  for (int part = 0; part < 2; part++) PetscCall(VecDestroy(&x[part]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramJudgeSpectrum(const MpmProgram *p, Mat B, MpmSpectrum *s)
{
  PetscReal growth;
  MpmEigen *eigen;

  PetscFunctionBegin;
  PetscCall(SolveOther(p, s, B, &eigen));
  growth = eigen->n ? MpmGrowthPerStep(hypot(eigen->re[0], eigen->im[0]), 0, p->probe.steps) : NAN;
  PetscCall(MpmEigenDestroy(&eigen));
  PetscCall(MpmProgramJudge(p, growth, isnan(s->condition) ? 1 : s->condition, &s->finding));
  if (s->finding.verdict == MPM_STABLE && !s->eigen->complete && !s->symbol)
    PetscCall(MpmFindingDispute(&s->finding, "only all eigenvalues could show that none is larger"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramJudgeParticles(MpmProgram *p, PetscReal started, MpmFinding *f, MpmCarriers *carriers)
{
  MpmSpectrum *spectrum;
  Mat          A, B;

  PetscFunctionBegin;
  PetscCall(MpmProgramMatrix(p, &A, &B));
  PetscCall(
      MpmSpectrumOfMatrix(p->stepper->name, A, p->probe.steps, MpmProgramLattice(p), p->request, started, &spectrum));
  PetscCall(MpmProgramJudgeSpectrum(p, B, spectrum));
  *f = spectrum->finding;
  PetscCall(MpmCarriersFind(p, spectrum, carriers));
  PetscCall(MpmSpectrumDestroy(&spectrum));
  PetscCall(MatDestroy(&A));
  PetscCall(MatDestroy(&B));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramJudgeSources(const MpmProgram *p, const MpmSource source[2], const PetscInt phases[],
                                      PetscReal beta[], MpmFinding *f)
{
  MpmSourceGrowth at, other;

  PetscFunctionBegin;
  PetscCall(MpmWorstPhase(PETSC_COMM_WORLD, &source[0], phases, beta, &at));
  PetscCall(MpmSourceGrowthAt(&source[1], beta, &other));
  *f = (MpmFinding){.growth = at.growth, .tolerance = p->tolerance};
  (void)snprintf(f->evidence, sizeof f->evidence, "%s", "the symbol of the interior, sought over all waves");
  PetscCall(MpmProgramJudge(p, other.growth, at.condition, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramJudgeWaves(MpmProgram *p, const PetscInt phases[], PetscReal beta[], MpmFinding *f)
{
  MpmProbed probed[2];
  MpmSource source[2];

  PetscFunctionBegin;
  PetscCall(MpmProgramOperator(p, &probed[0], &probed[1]));
  for (int size = 0; size < 2; size++)
    PetscCall(MpmBlocksSource(&probed[size].blocks, p->stepper->name, &source[size]));
  PetscCall(MpmProgramJudgeSources(p, source, phases, beta, f));
  for (int size = 0; size < 2; size++) PetscCall(MpmProbedFree(&probed[size]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LargestOfMatrix(Mat A, PetscReal value[2])
{
  const PetscReal target[2] = {0, 0};
  PetscInt        order;
  MpmEigen       *eigen;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &order, NULL));
  if (order <= MPM_DENSE_MANY) {
    PetscCall(MpmDenseLargest(A, value));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmEigenSolve(A, NULL, MpmEigenChoose(order, PETSC_FALSE), target, &eigen));
  value[0] = eigen->n ? eigen->re[0] : NAN;
  value[1] = eigen->n ? eigen->im[0] : NAN;
  PetscCall(MpmEigenDestroy(&eigen));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramGrowth(MpmProgram *p, PetscReal *growth)
{
  PetscInt        phases[MPM_MAX_DIM];
  PetscReal       beta[MPM_MAX_DIM], value[2];
  MpmProbed       probed;
  MpmSource       source;
  MpmSourceGrowth at;

  PetscFunctionBegin;
  PetscCall(MpmProgramOperator(p, &probed, NULL));
  if (probed.A) {
    PetscCall(LargestOfMatrix(probed.A, value));
    *growth = MpmGrowthPerStep(hypot(value[0], value[1]), 0, p->probe.steps);
  } else {
    PetscCall(MpmBlocksSource(&probed.blocks, p->stepper->name, &source));
    PetscCall(MpmRequestPhases(p->request, p->stepper->dim, phases));
    PetscCall(MpmWorstPhase(PETSC_COMM_WORLD, &source, phases, beta, &at));
    *growth = at.growth;
  }
  PetscCall(MpmProbedFree(&probed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- both sides of a switch, and states beside it ---- */

static PetscReal Beside(const MpmProgram *p)
{
  return p->probe.single ? BESIDE_SINGLE : BESIDE;
}

/* Growth, of what is not set apart, at a random state beside the base state, or at its opposite. */
static PetscErrorCode SideOf(MpmProgram *p, const PetscReal base[], PetscReal by, PetscReal *growth)
{
  MpmStepper *s = p->stepper;

  PetscFunctionBegin;
  for (PetscInt64 i = 0; i < s->particles * s->width; i++)
    s->base[i] =
        base[i] + (p->unread.apart[i % s->width] ? 0 : by * p->probe.scale[i % s->width] * (2 * MpmHash(95, i) - 1));
  PetscCall(MpmProgramRebase(p, PetscAbsReal(by) / 100));
  PetscCall(MpmProgramGrowth(p, growth));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A field which, changed at all particles, leaves the switch; one after another is tried. */
static PetscErrorCode TryFields(MpmProgram *p, const PetscReal base[], MpmKinks *k)
{
  MpmStepper *s = p->stepper;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < s->nfields && !k->field; f++)
    for (int sign = 1; sign >= -1 && !k->field && f != s->place; sign -= 2) {
      const MpmStepperField *field = &s->fields[f];
      MpmCertificates        c;

      k->amount = sign * Beside(p) * field->scale;
      for (PetscInt64 i = 0; i < s->particles * s->width; i++) {
        const PetscInt number = (PetscInt)(i % s->width) - field->first;

        s->base[i] = base[i] + (number >= 0 && number < field->size ? k->amount : 0);
      }
      PetscCall(MpmProgramRebase(p, Beside(p) / 1000));
      PetscCall(MpmCertifyStep(&p->probe, p->tolerance, p->unread.apart, &c));
      if (MpmCertificatesFault(&c) != MPM_CERTIFICATES) continue;
      k->field = field->name;
      PetscCall(MpmUnreadDestroy(&p->unread));
      PetscCall(MpmProgramGrowth(p, &k->growth[0]));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmKinksFind(MpmProgram *p, MpmKinks *k)
{
  MpmStepper      *s = p->stepper;
  const PetscInt64 n = s->particles * s->width;
  PetscReal       *base;
  MpmUnread        apart;

  PetscFunctionBegin;
  *k     = (MpmKinks){.particles = p->certificates.kinked, .all = s->particles, .growth = {NAN, NAN}};
  k->few = k->particles <= PetscMax(1, FEW * (PetscReal)s->particles) ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(PetscMalloc1(n, &base));
  PetscCall(PetscArraycpy(base, s->base, n));
  if (!k->few) {
    PetscCall(TryFields(p, base, k));
  } else if (n <= MOST_ORDER) {
    apart     = p->unread;
    p->unread = (MpmUnread){.n = 0};
    PetscCall(MpmProgramForget(p));
    p->whole = PETSC_TRUE;
    PetscCall(MpmProgramPrepare(p));
    p->unread = apart;
    for (int side = 0; side < 2; side++)
      PetscCall(SideOf(p, base, (side ? -1 : 1) * (p->probe.single ? 1 : SIDE) * Beside(p), &k->growth[side]));
    p->whole = PETSC_FALSE;
  }
  PetscCall(PetscArraycpy(s->base, base, n));
  PetscCall(PetscFree(base));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- growth by running: the largest Lyapunov exponent by scaling perturbations back (Benettin et al. 1980) ---- */

/*
   state: the base and the perturbed states; kept: those before a request. log: the logarithms of growth in request i,
   from log[i * PERTURBATIONS] on, after which done[i] steps are over; there is room for so many of the requests.
*/
typedef struct {
  MpmProbe  *probe;
  PetscInt64 n;
  PetscReal *state, *kept, *log;
  PetscInt  *done, requests, room;
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
   Growth is the mean over the second half. Its limits have Student's interval of the perturbations, what the last
   quarter differs by from the one before, since modes that are close to one another part slowly, and what perturbations
   of this size bend.
*/
static void Fit(const Run *r, PetscReal size, MpmProgramRun *run)
{
  PetscReal sum[2][PERTURBATIONS] = {{0}}, late[2] = {0, 0}, mean = 0, square = 0, part[2] = {0, 0}, margin, steps;

  for (PetscInt i = 0; i < r->requests; i++) {
    const int quarter = 4 * (PetscInt64)r->done[i] > 3 * (PetscInt64)run->steps;

    if (2 * (PetscInt64)r->done[i] <= run->steps) continue;
    late[quarter] += r->done[i] - (i ? r->done[i - 1] : 0);
    for (PetscInt k = 0; k < PERTURBATIONS; k++) sum[quarter][k] += r->log[i * PERTURBATIONS + k];
  }
  if (!(late[0] > 0 && late[1] > 0)) return;
  steps = late[0] + late[1];
  for (PetscInt k = 0; k < PERTURBATIONS; k++) {
    for (int q = 0; q < 2; q++) part[q] += sum[q][k] / late[q] / PERTURBATIONS;
    mean += (sum[0][k] + sum[1][k]) / steps / PERTURBATIONS;
  }
  for (PetscInt k = 0; k < PERTURBATIONS; k++)
    square += PetscSqr((sum[0][k] + sum[1][k]) / steps - mean) / (PERTURBATIONS * (PERTURBATIONS - 1));
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
    PetscReal *log_of, most;
    PetscBool  ends;

    if (r->requests == r->room) {
      r->room = 2 * r->room + REQUESTS;
      PetscCall(PetscRealloc(sizeof *r->log * PERTURBATIONS * (size_t)r->room, &r->log));
      PetscCall(PetscRealloc(sizeof *r->done * (size_t)r->room, &r->done));
    }
    log_of = r->log + r->requests * PERTURBATIONS;
    PetscCall(Request(r, each, size, log_of, &most));
    ends = s->failure[0] || !isfinite(most) ? PETSC_TRUE : PETSC_FALSE;
    if ((ends || most > log(MOST)) && each > s->steps) {
      each = PetscMax(1, each / 2 / s->steps) * s->steps;
      PetscCall(PetscArraycpy(r->state, r->kept, (PERTURBATIONS + 1) * r->n));
      s->failure[0] = '\0'; /* fewer steps may have an answer */
      continue;
    }
    run->ended = ends;
    if (ends) break;
    r->done[r->requests++] = run->steps += each;
    for (PetscInt k = 0; k < PERTURBATIONS; k++) Scale(r, k, exp(-log_of[k]));
  }
  Fit(r, size, run);
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
    PetscCall(PetscFree(r.log));
    PetscCall(PetscFree(r.done));
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
