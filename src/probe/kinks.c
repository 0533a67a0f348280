/* Both sides of a switch, and states beside it. */
#include "probe/kinks.h"
#include "base/hash.h"
#include "probe/program_growth.h"
#include <math.h>

#define FEW 0.1     /* the part of the particles */
#define BESIDE 1e-2 /* in scales: how far a field is changed; certificates perturb by up to a tenth of it */
#define BESIDE_SINGLE 0.1
#define SIDE 1e-3       /* of that: how far the sides of few switches are away, so that stresses there do not matter */
#define MOST_ORDER 2048 /* of an operator whose sides are looked at */

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
