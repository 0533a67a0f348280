/* A code in uniform motion. */
#include "probe/motion.h"
#include "linalg/small_eigen.h"
#include <mpmstab/errors.h>
#include <math.h>

#define LONG 0.02 /* the phase of a long wave */

/* ---- the drift ---- */

/* The Courant number of the fastest long wave along a direction. */
static PetscErrorCode FindCourant(MpmProgram *p, PetscInt axis, PetscReal *courant)
{
  PetscReal     beta[MPM_MAX_DIM] = {0};
  MpmBlocks     blocks;
  MpmSource     source;
  MpmSmallEigen eigen;
  PetscInt      exponent;

  PetscFunctionBegin;
  PetscCall(MpmProgramBlocks(p, &blocks, NULL));
  PetscCall(MpmBlocksSource(&blocks, p->stepper->name, &source));
  PetscCall(MpmSmallEigenCreate(source.size, &eigen));
  beta[axis] = LONG;
  PetscCall(MpmSourceMatrix(&source, beta, eigen.matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(&eigen, PETSC_FALSE));
  *courant = 0;
  for (PetscInt i = 0; i < eigen.n; i++)
    if (cabs(eigen.value[i]) > 0.5) *courant = PetscMax(*courant, fabs(carg(eigen.value[i])) / LONG);
  PetscCallMPI(MPI_Bcast(courant, 1, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscCall(MpmSmallEigenDestroy(&eigen));
  PetscCall(MpmBlocksFree(&blocks));
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
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the steps ---- */

/* Sets the particles to their places after n steps, in cells less whole ones; the cells stay those of the start. */
static PetscErrorCode GoTo(MpmProgram *p, const MpmMotion *m, const PetscReal start[], PetscInt n)
{
  MpmStepper *s = p->stepper;

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(s->base, start, s->particles * s->width));
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

/* Numbers that nothing reads at any place stay set apart. */
static void Join(const MpmUnread *one, MpmUnread *all)
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

/* The blocks of a place with one size of perturbations; all unknowns are kept until it is known which are set apart. */
static PetscErrorCode Step(MpmProgram *p, PetscReal size, MpmBlocks *blocks, PetscReal *farthest)
{
  PetscReal far;

  PetscFunctionBegin;
  PetscCall(MpmProbeBlocks(&p->probe, &p->lattice, MpmProbeLatticeMiddle(&p->lattice), size, blocks, &far));
  *farthest = PetscMax(*farthest, far);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Reduce(const MpmUnread *unread, MpmBlocks *blocks)
{
  MpmBlocks all = *blocks;

  PetscFunctionBegin;
  PetscCall(MpmUnreadReduceBlocks(unread, &all, blocks));
  PetscCall(MpmBlocksFree(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The certificates of a place, given what is set apart. */
static PetscErrorCode Certify(MpmProgram *p, MpmMotion *m, PetscInt n, MpmCertificates *all, PetscReal *farthest)
{
  MpmCertificates *c = &p->certificates;
  MpmBlocks        kept[2];

  PetscFunctionBegin;
  PetscCall(Step(p, p->probe.other, &m->other[n], farthest));
  PetscCall(MpmCertifyStep(&p->probe, p->tolerance, p->unread.apart, c));
  PetscCall(MpmUnreadReduceBlocks(&p->unread, &m->one[n], &kept[0]));
  PetscCall(MpmUnreadReduceBlocks(&p->unread, &m->other[n], &kept[1]));
  PetscCall(MpmCertifyBlocks(&p->probe, &p->lattice, &m->one[n], &kept[0], &kept[1], p->unread.apart, c));
  for (int k = 0; k < 2; k++) PetscCall(MpmBlocksFree(&kept[k]));
  c->value[MPM_CERTIFY_REACH] = *farthest;
  if (!n) *all = *c;
  Worse(c, all);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMotionFind(MpmProgram *p, MpmMotion *m)
{
  MpmStepper      *s = p->stepper;
  const PetscInt64 n = s->particles * s->width;
  PetscReal       *start, farthest = 0;
  MpmCertificates  all;
  MpmUnread        unread;

  PetscFunctionBegin;
  PetscCall(MpmUnreadDestroy(&p->unread)); /* of the start alone */
  PetscCall(MpmStepperExpect(s, "calls", m->n * (4 * (PetscInt64)p->columns + 40)));
  PetscCall(PetscMalloc1(n, &start));
  PetscCall(PetscArraycpy(start, s->base, n));
  for (PetscInt k = 0; k < m->n; k++) {
    PetscCall(GoTo(p, m, start, k));
    PetscCall(Step(p, p->probe.size, &m->one[k], &farthest));
    PetscCall(MpmUnreadOfBlocks(&m->one[k], s->width, MpmProgramNoise(p), k ? &unread : &p->unread));
    if (!k) continue;
    Join(&unread, &p->unread);
    PetscCall(MpmUnreadDestroy(&unread));
  }
  for (PetscInt k = 0; k < m->n; k++) {
    PetscCall(GoTo(p, m, start, k));
    PetscCall(Certify(p, m, k, &all, &farthest));
    PetscCall(Reduce(&p->unread, &m->one[k]));
    PetscCall(Reduce(&p->unread, &m->other[k]));
  }
  p->certificates = all;
  p->probe.steps  = m->n;
  PetscCall(PetscArraycpy(s->base, start, n));
  PetscCall(PetscFree(start));
  PetscCall(MpmStepperForgetExpected(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMotionSource(const MpmMotion *m, PetscBool other, const char name[], MpmBlocksSteps *steps,
                               MpmSource *source)
{
  PetscFunctionBegin;
  *steps = (MpmBlocksSteps){.n = m->n, .step = other ? m->other : m->one};
  PetscCall(MpmBlocksSourceOfSteps(steps, name, source));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMotionDestroy(MpmMotion *m)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < m->n; k++) {
    PetscCall(MpmBlocksFree(&m->one[k]));
    PetscCall(MpmBlocksFree(&m->other[k]));
  }
  m->n = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}
