/*
   The largest stable time step of a code. An operator is built for each step that is tried. Where the code takes any number
   of particles, a free block and a lone particle are cut from the lattice: their limits are often below the interior's.
*/
#include "analysis/critical_program.h"
#include "analysis/program_growth.h"
#include "analysis/worst_phase.h"
#include "base/progress.h"
#include "linalg/dense.h"
#include <mpmstab/errors.h>
#include <math.h>

#define BLOCK 6       /* cells of the free block in each direction */
#define CLOSE 1e-6    /* relative: the search ends */
#define FARTHEST 1e6  /* times the given step, or one over it, to which the search goes */
#define BELOW 4       /* steps below a limit that are tried too, equally spaced */
#define BESIDE 1e-3   /* relative: the modes are looked at so far above a limit */
#define MOST_SITES 64 /* of a cell, at which a lone particle is looked at */

const char *const MpmProgramLimitNames[] = {"interior", "block", "lone_particle", "state"};

/*S
   Search - whose growth is asked for. part: a free block or a lone particle, which has a base state of its own; NULL: the
   program itself.
S*/
typedef struct {
  MpmProgram         *program, part;
  MpmStepper          cut;
  PetscBool           is_part;
  MpmCriticalProgram *critical;
  MpmProgress        *progress;
} Search;

/* ---- growth at a time step ---- */

static PetscErrorCode GrowthOfBlocks(MpmProgram *p, PetscReal beta[], PetscReal *growth)
{
  static const PetscInt phases[] = {32, 16, 8};
  PetscInt              each[MPM_MAX_DIM];
  MpmBlocks             blocks;
  MpmSource             source;
  MpmSourceGrowth       at;

  PetscFunctionBegin;
  PetscCall(MpmProgramBlocks(p, &blocks, NULL));
  PetscCall(MpmBlocksSource(&blocks, p->stepper->name, &source));
  for (PetscInt a = 0; a < blocks.dim; a++) each[a] = phases[blocks.dim - 1];
  PetscCall(MpmWorstPhase(PETSC_COMM_WORLD, &source, each, beta, &at));
  *growth = at.growth;
  PetscCall(MpmBlocksFree(&blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GrowthOfMatrix(MpmProgram *p, PetscReal *growth)
{
  const PetscReal target[2] = {0, 0};
  PetscReal       value[2];
  PetscInt        order;
  MpmEigen       *eigen;
  Mat             A;

  PetscFunctionBegin;
  PetscCall(MpmProgramMatrix(p, &A, NULL));
  PetscCall(MatGetSize(A, &order, NULL));
  if (order <= MPM_DENSE_MANY) {
    PetscCall(MpmDenseLargest(A, value));
  } else {
    PetscCall(MpmEigenSolve(A, NULL, MpmEigenChoose(order, PETSC_FALSE), target, &eigen));
    value[0] = eigen->n ? eigen->re[0] : NAN;
    value[1] = eigen->n ? eigen->im[0] : NAN;
    PetscCall(MpmEigenDestroy(&eigen));
  }
  *growth = MpmGrowthPerStep(hypot(value[0], value[1]), 0, p->probe.steps);
  PetscCall(MatDestroy(&A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a time step is stable. A growth that is not known is none that is stable. */
static PetscErrorCode IsStable(Search *s, PetscReal dt, PetscBool *stable)
{
  MpmProgram *p = s->is_part ? &s->part : s->program;
  PetscReal   growth;

  PetscFunctionBegin;
  PetscCall(MpmStepperSet(p->stepper, s->critical->name, dt));
  PetscCall(MpmProgramPrepare(p));
  if (p->kind == MPM_PROBE_BLOCH)
    PetscCall(GrowthOfBlocks(p, s->critical->beta, &growth));
  else
    PetscCall(GrowthOfMatrix(p, &growth));
  *stable = growth <= 1 + p->tolerance ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(MpmProgramForget(p));
  PetscCall(MpmProgressUpdate(s->progress, ++s->critical->probes, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the search ---- */

static PetscErrorCode Bisect(Search *s, PetscReal lo, PetscReal hi, PetscReal *limit)
{
  PetscFunctionBegin;
  while (hi - lo > CLOSE * hi) {
    const PetscReal middle = (lo + hi) / 2;
    PetscBool       stable;

    PetscCall(IsStable(s, middle, &stable));
    if (stable)
      lo = middle;
    else
      hi = middle;
  }
  *limit = lo;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds a stable and an unstable step next to one another, a factor of two apart; then what lies below. */
static PetscErrorCode FindLimit(Search *s, PetscReal start, PetscReal *limit)
{
  PetscReal dt = start, below = 0;
  PetscBool stable, first;

  PetscFunctionBegin;
  PetscCall(IsStable(s, dt, &first));
  stable = first;
  while (stable == first && dt < start * FARTHEST && dt > start / FARTHEST) {
    dt *= first ? 2 : 0.5;
    PetscCall(IsStable(s, dt, &stable));
  }
  *limit = first ? INFINITY : 0;
  if (stable == first) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(first ? Bisect(s, dt / 2, dt, limit) : Bisect(s, dt, 2 * dt, limit));
  for (int i = 1; i <= BELOW; i++) {
    const PetscReal tried = *limit * i / (BELOW + 1);

    PetscCall(IsStable(s, tried, &stable));
    if (!stable) {
      PetscCall(Bisect(s, below, tried, limit));
      break;
    }
    below = tried;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- parts of the lattice ---- */

/* Cuts particles out of the base state: those of a block in the middle, or the one of a site. */
static PetscErrorCode Cut(Search *s, PetscInt site)
{
  const MpmProgram      *p  = s->program;
  const MpmProbeLattice *l  = &p->lattice;
  const MpmStepper      *of = p->stepper;
  const PetscInt         w = of->width, middle = MpmProbeLatticeMiddle(&p->probe, l);

  PetscFunctionBegin;
  s->cut           = *of;
  s->cut.cell      = NULL;
  s->cut.particles = 0;
  PetscCall(PetscMalloc1(of->particles * w, &s->cut.base));
  for (PetscInt64 i = 0; i < of->particles; i++) {
    PetscInt  cell = l->cell_of[i];
    PetscBool in   = site == MPM_NONE || (cell == middle && l->site_of[i] == site) ? PETSC_TRUE : PETSC_FALSE;

    for (PetscInt a = 0; a < of->dim; a++) {
      const PetscInt at = cell % l->cells[a] - l->cells[a] / 2;

      if (at < -BLOCK / 2 || at >= BLOCK / 2) in = PETSC_FALSE;
      cell /= l->cells[a];
    }
    if (in) PetscCall(PetscArraycpy(s->cut.base + s->cut.particles++ * w, of->base + i * w, w));
  }
  s->part    = (MpmProgram){.request = p->request, .stepper = &s->cut, .whole = PETSC_TRUE};
  s->is_part = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LimitOfPart(Search *s, PetscInt site, PetscReal start, PetscReal *limit)
{
  PetscReal found;

  PetscFunctionBegin;
  PetscCall(Cut(s, site));
  PetscCall(FindLimit(s, start, &found));
  *limit = isnan(*limit) ? found : PetscMin(*limit, found);
  s->program->stepper->calls += s->cut.calls - s->program->stepper->calls;
  PetscCall(PetscFree(s->cut.base));
  s->is_part = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The lattice is looked at again, since the search has forgotten it. */
static PetscErrorCode Parts(Search *s, PetscReal start)
{
  MpmCriticalProgram *c = s->critical;
  MpmProgram         *p = s->program;

  PetscFunctionBegin;
  PetscCall(MpmStepperSet(p->stepper, c->name, c->given));
  PetscCall(MpmProgramPrepare(p));
  PetscCall(LimitOfPart(s, MPM_NONE, start, &c->limit[MPM_LIMIT_BLOCK]));
  for (PetscInt site = 0; site < PetscMin(p->lattice.sites, MOST_SITES); site++)
    PetscCall(LimitOfPart(s, site, start, &c->limit[MPM_LIMIT_LONE]));
  PetscCall(MpmProgramForget(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what is said of it ---- */

/* Judges a time step, and leaves the program prepared for it. */
static PetscErrorCode JudgeAt(MpmProgram *p, PetscReal started, PetscReal dt, MpmCriticalProgram *c, MpmFinding *f)
{
  PetscInt phases[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(MpmStepperSet(p->stepper, c->name, dt));
  PetscCall(MpmProgramPrepare(p));
  PetscCall(MpmRequestPhases(p->request, p->stepper->dim, phases));
  if (p->kind == MPM_PROBE_BLOCH)
    PetscCall(MpmProgramJudgeWaves(p, phases, c->beta, f));
  else
    PetscCall(MpmProgramJudgeParticles(p, started, f, &c->carriers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The first certificate that fails, or NULL. */
static const char *Fault(const MpmProgram *p)
{
  for (MpmCertificate c = 0; c < MPM_CERTIFICATES; c++)
    if (MpmCertificateFails(&p->certificates, c)) return MpmCertificateFaults[c];
  return NULL;
}

/* Just above the limit its mode is looked at, and the certificates must hold there too. Then the given step is judged. */
static PetscErrorCode Finish(MpmProgram *p, PetscReal started, PetscReal limit, MpmCriticalProgram *c)
{
  PetscReal   beta[MPM_MAX_DIM] = {0};
  MpmCarriers carriers          = {.n = 0};
  MpmFinding  above;

  PetscFunctionBegin;
  if (limit > 0 && isfinite(limit)) {
    PetscCall(JudgeAt(p, started, limit * (1 + BESIDE), c, &above));
    PetscCall(PetscArraycpy(beta, c->beta, MPM_MAX_DIM));
    carriers = c->carriers;
    c->why   = Fault(p);
    PetscCall(MpmProgramForget(p));
  }
  PetscCall(JudgeAt(p, started, c->given, c, &c->finding));
  PetscCall(PetscArraycpy(c->beta, beta, MPM_MAX_DIM));
  c->carriers = carriers;
  if (!c->why) c->why = Fault(p);
  for (int i = 0; i < MPM_LIMIT_KINDS; i++)
    if (!isnan(c->limit[i]) && !(c->limit[i] >= c->critical)) c->critical = c->limit[i];
  if (c->why) c->critical = NAN;
  c->calls = p->stepper->calls;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalProgramFind(MpmProgram *p, PetscReal started, MpmCriticalProgram *c)
{
  MpmStepper *stepper = p->stepper;
  PetscBool   found, bloch;
  MpmProgress progress;
  Search      s = {.program = p, .critical = c, .progress = &progress};
  PetscReal   limit;

  PetscFunctionBegin;
  *c = (MpmCriticalProgram){
      .name = p->request->program_dt[0] ? p->request->program_dt : "dt", .dim = stepper->dim, .critical = NAN};
  for (int i = 0; i < MPM_LIMIT_KINDS; i++) c->limit[i] = NAN;
  PetscCall(MpmStepperParameterOf(stepper, c->name, &c->given, &found));
  MpmCheckInput(
      found && c->given > 0,
      "%s: it has no parameter %s above 0, which would be its time step; allowed: -program_dt NAME with one that "
      "it describes",
      stepper->where, c->name);
  PetscCall(MpmProgressBegin("time steps tried", &progress));
  PetscCall(MpmProgramPrepare(p));
  bloch = p->kind == MPM_PROBE_BLOCH ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(MpmProgramForget(p));
  PetscCall(FindLimit(&s, c->given, &limit));
  c->limit[bloch ? MPM_LIMIT_INTERIOR : MPM_LIMIT_STATE] = limit;
  if (bloch && stepper->any_count) PetscCall(Parts(&s, isfinite(limit) && limit > 0 ? limit : c->given));
  PetscCall(MpmProgressEnd(&progress));
  PetscCall(Finish(p, started, limit, c));
  PetscFunctionReturn(PETSC_SUCCESS);
}
