/* Starting and probing a code, and how far its operator can be trusted. */
#include "probe/program.h"
#include "linalg/singular.h"
#include "probe/program_scene.h"
#include <mpmstab/operator.h>
#include <mpmstab/errors.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LONGEST 128 /* steps in which particles may come to the same places in other cells */
#define NOISE 1e-8  /* an entry of the operator below this is none */
#define NOISE_SINGLE 1e-5
#define ALL_EIGENVALUES 1024 /* of an operator of a lattice up to this order */
#define FOR_CERTIFICATES 70  /* calls, about */
#define SO_FAR 200           /* products, even, for a first idea of growth */

/* Adds a number to a field of all particles. */
static PetscErrorCode ChangeBase(MpmStepper *s, const char name[], PetscReal number)
{
  PetscInt f = 0;

  PetscFunctionBegin;
  while (f < s->nfields && strcmp(s->fields[f].name, name)) f++;
  MpmCheckInput(f < s->nfields, "-program_base %s=%g: the code has no such field; allowed: a field of its description",
                name, (double)number);
  for (PetscInt64 i = 0; i < s->particles; i++)
    for (PetscInt c = 0; c < s->fields[f].size; c++) s->base[i * s->width + s->fields[f].first + c] += number;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Goes through NAME=VALUE,NAME=VALUE... */
static PetscErrorCode Set(MpmStepper *s, const char option[], const char said[],
                          PetscErrorCode (*set)(MpmStepper *, const char[], PetscReal))
{
  char text[PETSC_MAX_PATH_LEN], *next = text;

  PetscFunctionBegin;
  (void)snprintf(text, sizeof text, "%s", said);
  while (next && *next) {
    char     *one = next, *value, *end = NULL;
    PetscReal number;

    next = strchr(one, ',');
    if (next) *next++ = '\0';
    value = strchr(one, '=');
    if (value) *value++ = '\0';
    number = value ? strtod(value, &end) : 0;
    MpmCheckInput(value && end != value && !*end && isfinite(number),
                  "-%s %s: '%s' has no number; allowed: NAME=VALUE, several with commas", option, said, one);
    PetscCall(set(s, one, number));
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
  if (request->program_scene[0] || !p->stepper->described)
    PetscCall(MpmProgramTakeScene(request->program_scene, p->stepper));
  if (request->program_period) p->stepper->steps = request->program_period;
  PetscCall(Set(p->stepper, "program_set", request->program_set, MpmStepperSet));
  PetscCall(Set(p->stepper, "program_base", request->program_base, ChangeBase));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether cells fill the period in each direction, so that the operator of all particles is known from one of them. */
static PetscBool Wraps(const MpmProgram *p)
{
  for (PetscInt a = 0; a < p->stepper->dim; a++)
    if (!p->lattice.wraps[a]) return PETSC_FALSE;
  return PETSC_TRUE;
}

/* A symbol is of cells that are alike, a spectrum of all particles; a limit is found by what costs least. */
static PetscErrorCode Choose(MpmProgram *p)
{
  const MpmStepper  *s    = p->stepper;
  const MpmProbeKind wish = p->request->probe;
  const PetscBool    any  = wish == MPM_PROBE_ANY ? PETSC_TRUE : PETSC_FALSE,
                  edges   = strcmp(p->request->task, "spectrum") ? PETSC_FALSE : PETSC_TRUE;

  PetscFunctionBegin;
  PetscCall(MpmProbeLatticeOf(&p->probe, &p->lattice, sizeof p->why, p->why));
  p->kind = MPM_PROBE_COLOURED;
  if (!p->whole && !p->why[0] && (!edges || Wraps(p)) && (any || wish == MPM_PROBE_BLOCH)) p->kind = MPM_PROBE_BLOCH;
  if (wish == MPM_PROBE_MATRIX_FREE || (any && s->place == MPM_NONE && !s->cell)) p->kind = MPM_PROBE_MATRIX_FREE;
  MpmCheckInput(p->kind == MPM_PROBE_BLOCH || p->whole ||
                    (wish != MPM_PROBE_BLOCH && strcmp(p->request->task, "symbol")),
                "%s: its cells are not alike (%s), so that it has no symbol; allowed: spectrum, which takes any layout",
                p->stepper->where, p->why[0] ? p->why : "the particles have an edge");
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
  PetscCall(MpmBlocksFree(&p->blocks));
  p->cells.fields = 0;
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

PetscErrorCode MpmProgramRebase(MpmProgram *p, PetscReal size)
{
  MpmProbe sizes = p->probe;

  PetscFunctionBegin;
  if (size > 0) sizes.size = sizes.other = size;
  PetscCall(MpmProbeDestroy(&p->probe));
  PetscCall(MpmProbeCreate(p->stepper, &p->probe));
  MpmProbeSizesOf(&p->probe, &sizes);
  PetscCall(MpmProbeBegin(&p->probe, 1));
  p->probe.composed = sizes.composed;
  p->probe.noise    = sizes.noise;
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

PetscReal MpmProgramNoise(const MpmProgram *p)
{
  return p->probe.single ? NOISE_SINGLE : NOISE;
}

PetscErrorCode MpmProgramProbe(MpmProgram *p, PetscReal size, MpmProbed *probed, PetscReal *reach)
{
  PetscFunctionBegin;
  *probed = (MpmProbed){.A = NULL};
  *reach  = NAN;
  if (p->kind == MPM_PROBE_BLOCH) {
    PetscCall(MpmProbeBlocks(&p->probe, &p->lattice, MpmProbeLatticeMiddle(&p->lattice), size, &probed->blocks, reach));
  } else if (p->shell) {
    PetscCall(MpmProbeShell(&p->probe, size, &probed->A));
  } else if (p->kind == MPM_PROBE_MATRIX_FREE) {
    PetscCall(MpmProbeMatrix(&p->probe, size, NULL, &probed->A));
  } else {
    PetscCall(MpmProbeMatrix(&p->probe, size, &p->colours, &probed->A));
    *reach = p->colours.leaks;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds what is set apart, which the first operator tells. */
static PetscErrorCode FindUnread(MpmProgram *p, const MpmProbed *all)
{
  const PetscInt w = p->stepper->width;
  PetscReal      size;

  PetscFunctionBegin;
  if (p->unread.apart) PetscFunctionReturn(PETSC_SUCCESS);
  if (p->shell) {
    p->unread = (MpmUnread){.width = w, .n = w};
    PetscCall(PetscCalloc1(w, &p->unread.apart));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmUnreadFind(all, w, MpmProgramNoise(p), &p->unread));
  size = (PetscReal)p->lattice.sites * p->unread.n;
  MpmCheckInput(all->A || (size <= MPM_BLOCKS_SIZE && size * size * all->blocks.n <= MPM_BLOCKS_NUMBERS),
                "%s: a cell has %.0f unknowns; allowed: up to %d", p->stepper->where, (double)size, MPM_BLOCKS_SIZE);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A shell is kept as it is. */
static PetscErrorCode Keep(const MpmProgram *p, MpmProbed *all, MpmProbed *kept)
{
  PetscFunctionBegin;
  if (!p->shell) {
    PetscCall(MpmProbedReduce(all, &p->unread, kept));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *kept = *all;
  *all  = (MpmProbed){.A = NULL};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramCertify(MpmProgram *p, const MpmProbed *all, const MpmProbed *one, MpmProbed *other,
                                 PetscReal *reach)
{
  MpmProbed second;

  PetscFunctionBegin;
  PetscCall(MpmCertifyStep(&p->probe, p->tolerance, p->unread.apart, &p->certificates));
  p->probe.apart = p->unread.apart; /* their columns are not looked at any more */
  PetscCall(MpmProgramProbe(p, p->probe.other, &second, reach));
  p->probe.apart = NULL;
  PetscCall(Keep(p, &second, other));
  PetscCall(MpmCertifyOperator(&p->probe, &p->lattice, all, one, other, p->unread.apart, &p->certificates));
  PetscCall(MpmProbedFree(&second));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The progress line has the growth so far, about, from the power method. */
static PetscErrorCode SaySoFar(MpmProgram *p, Mat A)
{
  PetscReal norm, growth = 0;
  Vec       x[2];

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(A, &x[0], &x[1]));
  PetscCall(MpmSingularStart(52, x[0]));
  for (int k = 0; k < SO_FAR; k++) {
    PetscCall(MatMult(A, x[k % 2], x[1 - k % 2]));
    PetscCall(VecNormalize(x[1 - k % 2], &norm));
    if (2 * k >= SO_FAR) growth += log(norm) / (SO_FAR / 2);
  }
  (void)snprintf(p->unit, sizeof p->unit, "growth about %.5g so far; calls",
                 (double)exp(growth / (PetscReal)p->probe.steps));
  for (int k = 0; k < 2; k++) PetscCall(VecDestroy(&x[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramOperator(MpmProgram *p, MpmProbed *one, MpmProbed *other)
{
  const PetscInt64 calls = p->shell ? 0 : 4 * (PetscInt64)p->columns + FOR_CERTIFICATES;
  MpmProbed        all;
  PetscReal        reach[2];

  PetscFunctionBegin;
  (void)snprintf(p->unit, sizeof p->unit, "calls");
  if (other && calls) PetscCall(MpmStepperExpect(p->stepper, p->unit, calls));
  PetscCall(MpmProgramProbe(p, p->probe.size, &all, &reach[0]));
  PetscCall(FindUnread(p, &all));
  PetscCall(Keep(p, &all, one));
  if (other) {
    if (one->A && !p->shell) PetscCall(SaySoFar(p, one->A));
    PetscCall(MpmProgramCertify(p, p->shell ? NULL : &all, one, other, &reach[1]));
    PetscCall(MpmCertifyRepeat(&p->probe, p->unread.apart, &p->certificates));
    p->certificates.value[MPM_CERTIFY_REACH] = p->kind == MPM_PROBE_BLOCH ? PetscMax(reach[0], reach[1]) : reach[1];
    if (calls) PetscCall(MpmStepperForgetExpected(p->stepper));
  }
  PetscCall(MpmProbedFree(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Cells that only look alike: all particles are probed. */
static PetscErrorCode ProbeAll(MpmProgram *p, Mat *one, Mat *other)
{
  PetscFunctionBegin;
  PetscCall(MpmProgramForget(p));
  p->whole = PETSC_TRUE;
  PetscCall(MpmProgramPrepare(p));
  PetscCall(MpmProgramMatrix(p, one, other));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The reach does not matter: what goes around a period belongs to the operator. */
static PetscErrorCode Circulant(MpmProgram *p, MpmProbed probed[2], Mat *one, Mat *other)
{
  PetscFunctionBegin;
  PetscCall(MpmBlocksFree(&p->blocks));
  p->blocks = probed[0].blocks;
  if (other && MpmCertificateFails(&p->certificates, MPM_CERTIFY_COLUMNS)) {
    PetscCall(MpmBlocksFree(&probed[1].blocks));
    PetscCall(ProbeAll(p, one, other));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmProbeBlocksMatrix(&p->probe, &p->lattice, &p->blocks, one));
  if (other) {
    p->certificates.value[MPM_CERTIFY_REACH] = NAN;
    PetscCall(MpmProbeBlocksMatrix(&p->probe, &p->lattice, &probed[1].blocks, other));
    PetscCall(MpmBlocksFree(&probed[1].blocks));
  }
  if (p->stepper->particles * p->unread.n <= ALL_EIGENVALUES) PetscFunctionReturn(PETSC_SUCCESS);
  p->cells = (MpmBlochCells){.fields = p->unread.n, .of = &p->lattice, .at = MpmProbeLatticeAt};
  PetscCall(PetscArraycpy(p->cells.cells, p->lattice.cells, MPM_MAX_DIM));
  PetscCall(MpmBlocksSource(&p->blocks, p->stepper->name, &p->cells.source));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmProgramMatrix(MpmProgram *p, Mat *one, Mat *other)
{
  MpmProbed probed[2];

  PetscFunctionBegin;
  PetscCall(MpmProgramOperator(p, &probed[0], other ? &probed[1] : NULL));
  if (p->kind == MPM_PROBE_BLOCH) {
    PetscCall(Circulant(p, probed, one, other));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  *one = probed[0].A;
  if (other) *other = probed[1].A;
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmBlochCells *MpmProgramLattice(const MpmProgram *p)
{
  return p->cells.fields ? &p->cells : NULL;
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
