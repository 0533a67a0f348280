/*
   The largest stable time step of a code. An operator is built for each step that is tried. Where the code takes any number
   of particles, a free block and a lone particle are cut from the lattice: their limits are often below the interior's.
*/
#include "probe/critical_program.h"
#include "analysis/onset.h"
#include "probe/program_growth.h"
#include "analysis/worst_phase.h"
#include "base/progress.h"
#include "linalg/dense.h"
#include <mpmstab/errors.h>
#include <math.h>

#define BLOCK 6 /* cells of the free block in each direction, or fewer so that its operator is dense */
#define BELOW 4 /* steps below a limit that are tried too, equally spaced; BELOW_PART: of a part */
#define BELOW_PART 2
#define BESIDE 1e-3  /* relative: the modes are looked at so far above a limit */
#define FARTHEST 1e3 /* times the given step, or one over it, to which the search goes: far beyond, rounding grows */
#define FARTHEST_PART 16 /* times the interior's limit: a part that is stable there limits nothing */
#define MOST_SITES 64    /* of a cell, at which a lone particle is looked at */
#define TRIED 10         /* steps that a search takes, about, before it looks at BELOW others */

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
  PetscInt            expected; /* time steps to try, as it is said while they are */
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

/* Growth - 1 at a time step. */
static PetscErrorCode Excess(void *context, PetscReal dt, PetscReal *excess)
{
  Search     *s = context;
  MpmProgram *p = s->is_part ? &s->part : s->program;
  PetscReal   growth;

  PetscFunctionBegin;
  PetscCall(MpmStepperSet(p->stepper, s->critical->name, dt));
  PetscCall(MpmProgramPrepare(p));
  if (p->kind == MPM_PROBE_BLOCH)
    PetscCall(GrowthOfBlocks(p, s->critical->beta, &growth));
  else
    PetscCall(GrowthOfMatrix(p, &growth));
  *excess = growth - 1;
  PetscCall(MpmProgramForget(p));
  s->critical->probes++;
  PetscCall(MpmProgressUpdate(s->progress, s->critical->probes, PetscMax(s->expected, s->critical->probes + 1)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindLimit(Search *s, PetscReal start, PetscInt below, PetscReal *limit)
{
  const PetscBool beside = s->is_part && start == s->critical->limit[MPM_LIMIT_INTERIOR] ? PETSC_TRUE : PETSC_FALSE;
  const MpmOnset  onset  = {.excess    = Excess,
                            .context   = s,
                            .start     = start,
                            .farthest  = beside ? FARTHEST_PART : FARTHEST,
                            .tolerance = s->program->tolerance,
                            .below     = below};

  PetscFunctionBegin;
  PetscCall(MpmOnsetFind(&onset, limit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- parts of the lattice ---- */

/* Cuts particles out of the base state: those of a block in the middle, or the one of a site. */
static PetscErrorCode Cut(Search *s, PetscInt site)
{
  const MpmProgram      *p  = s->program;
  const MpmProbeLattice *l  = &p->lattice;
  const MpmStepper      *of = p->stepper;
  const PetscInt         w = of->width, middle = MpmProbeLatticeMiddle(l), block = s->critical->block;

  PetscFunctionBegin;
  s->cut           = *of;
  s->cut.cell      = NULL;
  s->cut.particles = 0;
  PetscCall(PetscMalloc1(of->particles * w, &s->cut.base));
  for (PetscInt64 i = 0; i < of->particles; i++) {
    PetscInt  cell = l->cell_of[i];
    PetscBool in   = site == MPM_NONE || (cell == middle && l->site_of[i] == site) ? PETSC_TRUE : PETSC_FALSE;

    for (PetscInt a = 0; a < of->dim; a++) {
      const PetscInt at = cell % l->cells[a] - l->cells[a] / 2 + block / 2;

      if (at < 0 || at >= block) in = PETSC_FALSE;
      cell /= l->cells[a];
    }
    if (in) PetscCall(PetscArraycpy(s->cut.base + s->cut.particles++ * w, of->base + i * w, w));
  }
  s->part    = (MpmProgram){.request = p->request, .stepper = &s->cut, .whole = PETSC_TRUE, .alike = &p->probe};
  s->is_part = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Mend(Search *s)
{
  PetscFunctionBegin;
  s->program->stepper->calls = s->cut.calls;
  PetscCall(PetscFree(s->cut.base));
  s->is_part = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least limit of a lone particle. A site that is stable at the limit of those before it has no lower one. */
static PetscErrorCode LimitOfLone(Search *s, PetscReal start, PetscReal *limit)
{
  PetscFunctionBegin;
  *limit = NAN;
  for (PetscInt site = 0; site < PetscMin(s->program->lattice.sites, MOST_SITES); site++) {
    PetscReal excess = INFINITY;

    PetscCall(Cut(s, site));
    if (site > 0 && *limit > 0 && isfinite(*limit)) PetscCall(Excess(s, *limit, &excess));
    if (!(excess <= s->program->tolerance)) {
      PetscReal found;

      PetscCall(FindLimit(s, start, BELOW_PART, &found));
      if (!(found >= *limit)) s->critical->site = site;
      *limit = site > 0 ? PetscMin(*limit, found) : found;
    }
    PetscCall(Mend(s));
  }
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
  if (c->block) {
    PetscCall(Cut(s, MPM_NONE));
    PetscCall(FindLimit(s, start, BELOW_PART, &c->limit[MPM_LIMIT_BLOCK]));
    PetscCall(Mend(s));
  }
  PetscCall(LimitOfLone(s, start, &c->limit[MPM_LIMIT_LONE]));
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

/* What is wrong by the first certificate that fails, or NULL. */
static const char *Fault(const MpmProgram *p)
{
  const MpmCertificate which = MpmCertificatesFault(&p->certificates);

  return which == MPM_CERTIFICATES ? NULL : MpmCertificateFaults[which];
}

/* Just above a limit its mode is looked at, and the certificates must hold there, too. */
static PetscErrorCode LookAbove(MpmProgram *p, PetscReal started, PetscReal limit, MpmCriticalProgram *c)
{
  MpmFinding above;

  PetscFunctionBegin;
  if (!(limit > 0) || !isfinite(limit)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(JudgeAt(p, started, limit * (1 + BESIDE), c, &above));
  if (!c->why) c->why = Fault(p);
  PetscCall(MpmProgramForget(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The kind with the least limit, MPM_NONE if none was found. */
static PetscInt Least(const MpmCriticalProgram *c)
{
  PetscInt least = MPM_NONE;

  for (PetscInt i = 0; i < MPM_LIMIT_KINDS; i++)
    if (!isnan(c->limit[i]) && (least == MPM_NONE || c->limit[i] < c->limit[least])) least = i;
  return least;
}

/* Looks at the limits' modes: the interior's wave, and the particles of what limits most. Then the given step is judged. */
static PetscErrorCode Finish(Search *s, PetscReal started, PetscReal limit)
{
  MpmCriticalProgram *c     = s->critical;
  MpmProgram         *p     = s->program;
  const PetscInt      least = Least(c);
  PetscReal           beta[MPM_MAX_DIM];
  MpmCarriers         carriers;

  PetscFunctionBegin;
  PetscCall(LookAbove(p, started, limit, c));
  PetscCall(PetscArraycpy(beta, c->beta, MPM_MAX_DIM));
  if (least == MPM_LIMIT_BLOCK || least == MPM_LIMIT_LONE) {
    PetscCall(MpmStepperSet(p->stepper, c->name, c->given));
    PetscCall(MpmProgramPrepare(p));
    PetscCall(Cut(s, least == MPM_LIMIT_LONE ? c->site : MPM_NONE));
    s->part.alike = NULL;
    PetscCall(LookAbove(&s->part, started, c->limit[least], c));
    PetscCall(Mend(s));
    PetscCall(MpmProgramForget(p));
  }
  carriers = c->carriers;
  PetscCall(JudgeAt(p, started, c->given, c, &c->finding));
  PetscCall(PetscArraycpy(c->beta, beta, MPM_MAX_DIM));
  c->carriers = carriers;
  if (!c->why) c->why = Fault(p);
  if (!c->why && least != MPM_NONE) c->critical = c->limit[least];
  c->least = least;
  c->calls = p->stepper->calls;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest block whose operator all eigenvalues are computed of, up to BLOCK cells each way; 0 if there is none. */
static PetscInt BlockOf(const MpmProgram *p)
{
  const MpmProbeLattice *l = &p->lattice;

  for (PetscInt block = BLOCK; block > 1; block--) {
    PetscInt  unknowns = l->sites * p->stepper->width;
    PetscBool fits     = PETSC_TRUE;

    for (PetscInt a = 0; a < p->stepper->dim; a++) {
      unknowns *= block;
      if (l->cells[a] < block) fits = PETSC_FALSE;
    }
    if (fits && unknowns <= MPM_DENSE_MANY) return block;
  }
  return 0;
}

/* The calls that the search is going to take, about. */
static PetscInt64 Expected(const MpmProgram *p, const MpmCriticalProgram *c)
{
  PetscInt64 calls = (TRIED + BELOW + 4) * (2 * (PetscInt64)p->columns + 3), block = p->lattice.sites;

  if (p->kind != MPM_PROBE_BLOCH || !p->stepper->any_count) return calls;
  for (PetscInt a = 0; a < p->stepper->dim; a++) block *= c->block;
  calls += (TRIED + BELOW_PART) * (2 * block * p->stepper->width + 5);
  return calls + (TRIED + BELOW_PART + p->lattice.sites) * (2 * (PetscInt64)p->stepper->width + 5);
}

PetscErrorCode MpmCriticalProgramBegin(MpmProgram *p, MpmCriticalProgram *c)
{
  const MpmStepper *stepper = p->stepper;
  MpmText           names   = {NULL, 0};
  PetscErrorCode    ierr;
  PetscBool         found;

  PetscFunctionBegin;
  *c = (MpmCriticalProgram){
      .name = p->request->program_dt[0] ? p->request->program_dt : "dt", .dim = stepper->dim, .critical = NAN};
  for (int i = 0; i < MPM_LIMIT_KINDS; i++) c->limit[i] = NAN;
  MpmStepperParameterOf(stepper, c->name, &c->given, &found);
  if (!found) {
    PetscCall(MpmStepperParameterNames(stepper, &names));
    ierr = MpmRefusal(
        "-program_dt %s: the code has no parameter of this name, and so no time step to search for; allowed: %s",
        c->name, names.text);
    MpmTextFree(&names);
    PetscCall(ierr);
  }
  MpmCheckInput(c->given > 0, "-program_dt %s: it is %g in the code; allowed: a time step above 0", c->name,
                (double)c->given);
  PetscCall(MpmProgramPrepare(p));
  if (p->kind == MPM_PROBE_BLOCH && stepper->any_count) c->block = BlockOf(p);
  c->expected = Expected(p, c);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalProgramFind(MpmProgram *p, PetscReal started, MpmCriticalProgram *c)
{
  const PetscBool bloch = p->kind == MPM_PROBE_BLOCH ? PETSC_TRUE : PETSC_FALSE;
  MpmProbe        sizes = p->probe;
  MpmProgress     progress;
  const PetscInt  limits = bloch && p->stepper->any_count ? MPM_LIMIT_LONE - MPM_LIMIT_INTERIOR + 1 : 1;
  Search          s = {.program = p, .critical = c, .progress = &progress, .expected = (TRIED + BELOW + 5) * limits};
  PetscReal       limit;

  PetscFunctionBegin;
  PetscCall(MpmProgressBegin("time steps tried", &progress));
  PetscCall(MpmProgramForget(p));
  p->alike = &sizes;
  PetscCall(FindLimit(&s, c->given, BELOW, &limit));
  c->limit[bloch ? MPM_LIMIT_INTERIOR : MPM_LIMIT_STATE] = limit;
  if (bloch && p->stepper->any_count) PetscCall(Parts(&s, isfinite(limit) && limit > 0 ? limit : c->given));
  p->alike = NULL;
  PetscCall(MpmProgressEnd(&progress));
  PetscCall(Finish(&s, started, limit));
  PetscFunctionReturn(PETSC_SUCCESS);
}
