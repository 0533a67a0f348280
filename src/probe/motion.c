/* A code in uniform motion. */
#include "probe/motion.h"
#include "linalg/small_eigen.h"
#include "probe/program_growth.h"
#include <mpmstab/errors.h>
#include <math.h>

#define LONG 0.02 /* the phase of a long wave */

/* ---- the drift ---- */

/* The Courant number of the fastest long wave along a direction. */
static PetscErrorCode FindCourant(MpmProgram *p, PetscInt axis, PetscReal *courant)
{
  const MpmProbeKind kind              = p->kind;
  PetscReal          beta[MPM_MAX_DIM] = {0};
  MpmProbed          probed;
  MpmSource          source;
  MpmSmallEigen      eigen;
  PetscInt           exponent;

  PetscFunctionBegin;
  MpmCheckInput(
      !p->why[0],
      "-mach: the speed of its long waves is known of cells that are alike, and they are not (%s); allowed: -drift",
      p->why);
  p->kind = MPM_PROBE_BLOCH;
  PetscCall(MpmProgramOperator(p, &probed, NULL));
  p->kind = kind;
  PetscCall(MpmBlocksSource(&probed.blocks, p->stepper->name, &source));
  PetscCall(MpmSmallEigenCreate(source.size, &eigen));
  beta[axis] = LONG;
  PetscCall(MpmSourceMatrix(&source, beta, eigen.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&eigen, PETSC_FALSE));
  *courant = 0;
  for (PetscInt i = 0; i < eigen.n; i++)
    if (cabs(eigen.value[i]) > 0.5) *courant = PetscMax(*courant, fabs(carg(eigen.value[i])) / LONG);
  PetscCallMPI(MPI_Bcast(courant, 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscCall(MpmSmallEigenDestroy(&eigen));
  PetscCall(MpmProbedFree(&probed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMotionBegin(MpmProgram *p, MpmMotion *m)
{
  const MpmRequest *r     = p->request;
  const char       *name  = r->program_mach ? "mach" : "drift";
  PetscInt64        steps = 1, moved;

  PetscFunctionBegin;
  *m = (MpmMotion){.courant = NAN};
  MpmCheckInput(p->stepper->place != MPM_NONE,
                "-%s: the code does not say where its particles are, so that they cannot be set; allowed: a field with "
                "\"place\": true",
                name);
  MpmCheckInput(p->probe.steps == 1 && MpmProbeMoved(&p->probe, &moved) <= MPM_AT_REST,
                "-%s: the particles that the code describes move by themselves, or its steps change; allowed: with "
                "particles at rest",
                name);
  for (PetscInt a = 0; a < p->stepper->dim; a++) {
    MpmFraction *d = &m->drift[a];

    *d = r->program_drift[a];
    if (r->program_mach && d->value != 0) {
      PetscCall(FindCourant(p, a, &m->courant));
      *d = MpmFractionNearest(d->value * m->courant, MPM_MOTION_LONGEST / 2);
    }
    steps = d->den ? steps / MpmCommonDivisor(steps, d->den) * d->den : MPM_MOTION_LONGEST + 1;
    MpmCheckInput(
        steps <= MPM_MOTION_LONGEST,
        "-%s: particles come to the same places in cells after more than %d steps; allowed: fractions such as 1/8",
        name, MPM_MOTION_LONGEST);
  }
  m->n = (PetscInt)steps;
  PetscCall(PetscMalloc1(p->stepper->particles * p->stepper->width, &m->start));
  PetscCall(PetscArraycpy(m->start, p->stepper->base, p->stepper->particles * p->stepper->width));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the steps ---- */

PetscErrorCode MpmMotionReturn(MpmProgram *p, const MpmMotion *m)
{
  PetscFunctionBegin;
  PetscCall(PetscArraycpy(p->stepper->base, m->start, p->stepper->particles * p->stepper->width));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In cells less whole ones; the cells stay those of the start. */
PetscErrorCode MpmMotionGoTo(MpmProgram *p, const MpmMotion *m, PetscInt n)
{
  MpmStepper *s = p->stepper;

  PetscFunctionBegin;
  PetscCall(MpmMotionReturn(p, m));
  for (PetscInt a = 0; a < s->dim; a++) {
    PetscInt64 whole;
    PetscReal  part;

    MpmFractionMultiple(&m->drift[a], n, &whole, &part);
    for (PetscInt64 i = 0; i < s->particles; i++) {
      PetscReal *x = &s->base[i * s->width + s->fields[s->place].first + a];

      *x += part * s->cell_width;
      if (s->period[a] > 0 && *x >= s->period[a]) *x -= s->period[a];
    }
  }
  PetscCall(MpmProgramRebase(p, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmMotionJoin(const MpmUnread *one, MpmUnread *all)
{
  all->n = 0;
  for (PetscInt c = 0; c < all->width; c++) {
    if (!one->apart[c]) all->apart[c] = PETSC_FALSE;
    all->n += !all->apart[c];
  }
  all->factor = PetscMax(all->factor, one->factor);
}

/* Takes of each certificate what is farther beyond its bound. */
static void Worse(const MpmCertificates *one, MpmCertificates *all)
{
  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++)
    if (!isnan(one->value[c]) && !(one->value[c] <= all->value[c])) {
      all->value[c] = one->value[c];
      all->most[c]  = one->most[c];
    }
}

PetscErrorCode MpmMotionFind(MpmProgram *p, MpmMotion *m)
{
  MpmStepper     *s        = p->stepper;
  PetscReal       farthest = NAN, reach;
  MpmCertificates all;
  MpmUnread       unread;
  MpmProbed       kept;

  PetscFunctionBegin;
  PetscCall(MpmUnreadDestroy(&p->unread)); /* of the start alone */
  PetscCall(MpmStepperExpect(s, "calls", m->n * (4 * (PetscInt64)p->columns + 40)));
  for (PetscInt k = 0; k < m->n; k++) {
    PetscCall(MpmMotionGoTo(p, m, k));
    PetscCall(MpmProgramProbe(p, p->probe.size, &m->probed[0][k], &reach));
    farthest = fmax(farthest, reach);
    PetscCall(MpmUnreadFind(&m->probed[0][k], s->width, MpmProgramNoise(p), k ? &unread : &p->unread));
    if (!k) continue;
    MpmMotionJoin(&unread, &p->unread);
    PetscCall(MpmUnreadDestroy(&unread));
  }
  for (PetscInt k = 0; k < m->n; k++) {
    PetscCall(MpmMotionGoTo(p, m, k));
    PetscCall(MpmProbedReduce(&m->probed[0][k], &p->unread, &kept));
    PetscCall(MpmProgramCertify(p, &m->probed[0][k], &kept, &m->probed[1][k], &reach));
    PetscCall(MpmProbedFree(&m->probed[0][k]));
    m->probed[0][k]                          = kept;
    farthest                                 = fmax(farthest, reach);
    p->certificates.value[MPM_CERTIFY_REACH] = farthest;
    if (!k) all = p->certificates;
    Worse(&p->certificates, &all);
    for (int size = 0; size < 2; size++) m->blocks[size][k] = m->probed[size][k].blocks;
  }
  p->certificates = all;
  p->probe.steps  = m->n;
  PetscCall(MpmMotionReturn(p, m));
  PetscCall(MpmStepperForgetExpected(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what is made of them ---- */

PetscErrorCode MpmMotionSource(const MpmMotion *m, PetscBool other, const char name[], MpmBlocksSteps *steps,
                               MpmSource *source)
{
  PetscFunctionBegin;
  *steps = (MpmBlocksSteps){.n = m->n, .step = m->blocks[other]};
  PetscCall(MpmBlocksSourceOfSteps(steps, name, source));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Forget(MpmMotion *m)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < m->n; k++)
    for (int size = 0; size < 2; size++) PetscCall(MpmProbedFree(&m->probed[size][k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMotionJudgeWaves(MpmProgram *p, MpmMotion *m, const PetscInt phases[], PetscReal beta[],
                                   MpmFinding *f)
{
  MpmBlocksSteps steps[2];
  MpmSource      source[2];

  PetscFunctionBegin;
  PetscCall(MpmMotionFind(p, m));
  for (int size = 0; size < 2; size++)
    PetscCall(MpmMotionSource(m, (PetscBool)size, p->stepper->name, &steps[size], &source[size]));
  PetscCall(MpmProgramJudgeSources(p, source, phases, beta, f));
  PetscCall(Forget(m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMotionMatrix(MpmProgram *p, const MpmMotion *m, PetscBool other, Mat *product)
{
  Mat step, next;

  PetscFunctionBegin;
  *product = NULL;
  for (PetscInt k = 0; k < m->n; k++) {
    step = m->probed[other][k].A;
    if (step)
      PetscCall(PetscObjectReference((PetscObject)step));
    else /* what goes around a period belongs to the operator */
      PetscCall(MpmProbeBlocksMatrix(&p->probe, &p->lattice, &m->blocks[other][k], &step));
    if (!m->probed[other][k].A) p->certificates.value[MPM_CERTIFY_REACH] = NAN;
    next = step;
    if (*product) {
      PetscCall(MatMatMult(step, *product, MAT_INITIAL_MATRIX, PETSC_DEFAULT, &next));
      PetscCall(MatDestroy(&step));
      PetscCall(MatDestroy(product));
    }
    *product = next;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMotionDestroy(MpmMotion *m)
{
  PetscFunctionBegin;
  PetscCall(Forget(m));
  PetscCall(PetscFree(m->start));
  m->n = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
