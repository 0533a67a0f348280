/* Starting and probing a code, and how far its operator can be trusted. */
#include "probe/program.h"
#include "probe/columns.h"
#include <mpmstab/operator.h>
#include <mpmstab/errors.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST 128 /* steps in which particles may come to the same places in other cells */
#define NOISE 1e-8  /* an entry of the operator below this is none */
#define NOISE_SINGLE 1e-5

/* Sets the parameters NAME=VALUE,NAME=VALUE... */
static PetscErrorCode SetParameters(MpmProgram *p)
{
  char text[PETSC_MAX_PATH_LEN], *next = text;

  PetscFunctionBegin;
  (void)snprintf(text, sizeof text, "%s", p->request->program_set);
  while (next && *next) {
    char     *one = next, *value, *end = NULL;
    PetscReal number;

    next = strchr(one, ',');
    if (next) *next++ = '\0';
    value = strchr(one, '=');
    if (value) *value++ = '\0';
    number = value ? strtod(value, &end) : 0;
    MpmCheckInput(value && end != value && !*end && isfinite(number),
                  "-program_set %s: '%s' has no number; allowed: NAME=VALUE, several with commas",
                  p->request->program_set, one);
    PetscCall(MpmStepperSet(p->stepper, one, number));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramOpen(const MpmRequest *request, MpmProgram *p)
{
  PetscFunctionBegin;
  *p = (MpmProgram){.request = request};
  if (request->program[0])
    PetscCall(MpmStepperStartProgram(request->program, request->program_timeout, &p->stepper));
  else
    PetscCall(MpmStepperStartPlugin(request->plugin, request->program_timeout, &p->stepper));
  if (request->program_period) p->stepper->steps = request->program_period;
  PetscCall(SetParameters(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A symbol is of cells that are alike, a spectrum of all particles; a limit is found by what costs least. */
static PetscErrorCode Choose(MpmProgram *p)
{
  const MpmStepper  *s    = p->stepper;
  const MpmProbeKind wish = p->request->probe;
  const PetscBool    one  = strcmp(p->request->task, "spectrum") && !p->whole ? PETSC_TRUE : PETSC_FALSE;
  const PetscBool    any  = wish == MPM_PROBE_ANY ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  PetscCall(MpmProbeLatticeOf(&p->probe, &p->lattice, sizeof p->why, p->why));
  p->kind = MPM_PROBE_COLOURED;
  if (one && !p->why[0] && (any || wish == MPM_PROBE_BLOCH)) p->kind = MPM_PROBE_BLOCH;
  if (wish == MPM_PROBE_MATRIX_FREE || (any && s->place == MPM_NONE && !s->cell)) p->kind = MPM_PROBE_MATRIX_FREE;
  MpmCheckInput(p->kind == MPM_PROBE_BLOCH || p->whole ||
                    (wish != MPM_PROBE_BLOCH && strcmp(p->request->task, "symbol")),
                "%s: its cells are not alike (%s), so that it has no symbol; allowed: spectrum, which takes any layout",
                p->stepper->where, p->why);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A small operator has all its columns, and so all its eigenvalues. A solver that is asked for takes products alone. */
static PetscErrorCode ChooseShell(MpmProgram *p)
{
  const PetscInt64 order = p->stepper->particles * p->stepper->width;
  PetscBool        asked;

  PetscFunctionBegin;
  PetscCall(PetscOptionsHasName(NULL, NULL, "-eps_type", &asked));
  p->shell   = asked || order > MPM_MATRIX_ORDER ? PETSC_TRUE : PETSC_FALSE;
  p->columns = p->shell ? 0 : (PetscInt)order;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramPrepare(MpmProgram *p)
{
  PetscFunctionBegin;
  PetscCall(MpmProbeCreate(p->stepper, &p->probe));
  if (p->alike) MpmProbeSizesOf(&p->probe, p->alike);
  PetscCall(Choose(p));
  PetscCall(MpmProbeBegin(&p->probe, p->why[0] ? 1 : LONGEST));
  p->tolerance = p->probe.single ? PetscMax(p->request->tolerance, MPM_TOLERANCE_SINGLE) : p->request->tolerance;
  if (p->kind == MPM_PROBE_BLOCH) {
    p->columns = p->lattice.sites * p->stepper->width;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (p->kind == MPM_PROBE_COLOURED) PetscCall(MpmProbeReach(&p->probe, &p->colours));
  if (p->kind == MPM_PROBE_COLOURED && p->request->probe == MPM_PROBE_ANY && p->colours.everywhere)
    p->kind = MPM_PROBE_MATRIX_FREE;
  p->columns = p->colours.colours;
  if (p->kind == MPM_PROBE_MATRIX_FREE) PetscCall(ChooseShell(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramForget(MpmProgram *p)
{
  PetscFunctionBegin;
  PetscCall(MpmUnreadDestroy(&p->unread));
  PetscCall(MpmProbeLatticeDestroy(&p->lattice));
  PetscCall(MpmProbeDestroy(&p->probe));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramClose(MpmProgram *p)
{
  PetscFunctionBegin;
  PetscCall(MpmProgramForget(p));
  PetscCall(MpmStepperDestroy(&p->stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramAdvance(MpmProgram *p, PetscInt steps)
{
  MpmStepper *s = p->stepper;

  PetscFunctionBegin;
  if (steps > 0) PetscCall(MpmStepperStep(s, steps, s->particles, s->base));
  PetscCall(MpmStepperBegin(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- operators ---- */

static PetscReal Noise(const MpmProgram *p)
{
  return p->probe.single ? NOISE_SINGLE : NOISE;
}

/* Probes blocks with a size of perturbations, and leaves out what is set apart, which the first ones tell. */
static PetscErrorCode Blocks(MpmProgram *p, PetscReal size, MpmBlocks *all, MpmBlocks *kept, PetscReal *farthest)
{
  PetscFunctionBegin;
  PetscCall(MpmProbeBlocks(&p->probe, &p->lattice, MpmProbeLatticeMiddle(&p->lattice), size, all, farthest));
  if (!p->unread.apart) PetscCall(MpmUnreadOfBlocks(all, p->stepper->width, Noise(p), &p->unread));
  size = (PetscReal)p->lattice.sites * p->unread.n;
  MpmCheckInput(size <= MPM_BLOCKS_SIZE && size * size * all->n <= MPM_BLOCKS_NUMBERS,
                "%s: a cell has %.0f unknowns; allowed: up to %d", p->stepper->where, (double)size, MPM_BLOCKS_SIZE);
  PetscCall(MpmUnreadReduceBlocks(&p->unread, all, kept));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramBlocks(MpmProgram *p, MpmBlocks *one, MpmBlocks *other)
{
  MpmBlocks all[2];
  PetscReal farthest[2];

  PetscFunctionBegin;
  PetscCall(Blocks(p, p->probe.size, &all[0], one, &farthest[0]));
  if (other) {
    PetscCall(MpmCertifyStep(&p->probe, p->tolerance, p->unread.apart, &p->certificates));
    PetscCall(Blocks(p, p->probe.other, &all[1], other, &farthest[1]));
    PetscCall(MpmCertifyBlocks(&p->probe, &p->lattice, &all[0], one, other, p->unread.apart, &p->certificates));
    PetscCall(MpmCertifyRepeat(&p->probe, p->unread.apart, &p->certificates));
    p->certificates.value[MPM_CERTIFY_REACH] = PetscMax(farthest[0], farthest[1]);
    PetscCall(MpmBlocksFree(&all[1]));
  }
  PetscCall(MpmBlocksFree(&all[0]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* No certificate looks at columns; two sizes are compared by their products. */
static PetscErrorCode Shell(MpmProgram *p, Mat *one, Mat *other)
{
  MpmCertificates *c = &p->certificates;

  PetscFunctionBegin;
  p->unread = (MpmUnread){.width = p->stepper->width, .n = p->stepper->width};
  PetscCall(PetscCalloc1(p->unread.width, &p->unread.apart));
  PetscCall(MpmProbeShell(&p->probe, p->probe.size, one));
  if (!other) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmCertifyStep(&p->probe, p->tolerance, p->unread.apart, c));
  PetscCall(MpmProbeShell(&p->probe, p->probe.other, other));
  PetscCall(MpmProbeShellDistance(*one, *other, &c->value[MPM_CERTIFY_SIZES]));
  PetscCall(MpmCertifyRepeat(&p->probe, p->unread.apart, c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Matrix(MpmProgram *p, PetscReal size, Mat *A)
{
  PetscFunctionBegin;
  if (p->kind == MPM_PROBE_MATRIX_FREE)
    PetscCall(MpmProbeColumns(&p->probe, size, A));
  else
    PetscCall(MpmProbeMatrix(&p->probe, size, &p->colours, A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramMatrix(MpmProgram *p, Mat *one, Mat *other)
{
  Mat A, B;

  PetscFunctionBegin;
  if (p->shell) {
    PetscCall(Shell(p, one, other));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(Matrix(p, p->probe.size, &A));
  PetscCall(MpmUnreadOfMatrix(A, p->stepper->width, Noise(p), &p->unread));
  PetscCall(MpmUnreadReduce(&p->unread, A, one));
  if (other) {
    PetscCall(MpmCertifyStep(&p->probe, p->tolerance, p->unread.apart, &p->certificates));
    PetscCall(Matrix(p, p->probe.other, &B));
    PetscCall(MpmUnreadReduce(&p->unread, B, other));
    PetscCall(MpmCertifyMatrix(&p->probe, &p->colours, A, *one, *other, p->unread.apart, &p->certificates));
    PetscCall(MpmCertifyRepeat(&p->probe, p->unread.apart, &p->certificates));
    if (p->kind == MPM_PROBE_MATRIX_FREE) p->certificates.value[MPM_CERTIFY_REACH] = NAN; /* nothing is too far away */
    PetscCall(MatDestroy(&B));
  }
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- verdict ---- */

PetscErrorCode MpmProgramJudge(const MpmProgram *p, PetscReal other, PetscReal condition, MpmFinding *f)
{
  const PetscInt period = p->probe.steps;

  PetscFunctionBegin;
  f->growth = PetscMax(f->growth, MpmGrowthPerStep(p->unread.factor, 0, period));
  PetscCall(MpmCertificatesJudge(&p->certificates, &other, condition, period, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}
