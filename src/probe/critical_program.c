/*
   The largest stable time step of a code. Where its operator is a polynomial of the time step, it is probed at a few
   steps, and those that are tried cost no calls; else an operator is built for each. Where the code takes any number of
   particles, a free block and a lone particle are cut from the lattice: their limits are often below the interior's.
*/
#include "probe/critical_program.h"
#include "analysis/search.h"
#include "probe/dt_polynomial.h"
#include "probe/program_growth.h"
#include "analysis/waves.h"
#include "linalg/dense.h"
#include <mpmstab/errors.h>
#include <math.h>

#define BLOCK 6 /* cells of the free block in each direction, or fewer so that its operator is dense */
#define APART 4 /* cells that are empty around a period, so that the block does not feel itself across them */
#define BELOW 4 /* steps below a limit that are tried too, equally spaced; BELOW_PART: of a part */
#define BELOW_PART 2
#define CLOSE 1e-6    /* relative width of the bracket of a limit */
#define BESIDE 1e-3   /* relative: the modes are looked at so far above a limit */
#define FARTHEST 1024 /* times the given step, or one over it, to which the search goes: far beyond, rounding grows */
#define FARTHEST_PART 16 /* times the interior's limit: a part that is stable there limits nothing */
#define MOST_SITES 64    /* of a cell, at which a lone particle is looked at */
#define MOST_COLUMNS                                                                                                   \
  150           /* of a part, where each of some 40 steps that are tried takes twice as many calls: a minute at 5 ms */
#define NODES 3 /* steps at which an operator is probed, of most codes */
#define FARTHER 3    /* times the middle of these: a limit beyond, or below one over it, is sought from itself anew */
#define MOST_MOVES 6 /* of the middle */
#define WAVES 16     /* phases at which a limit of all waves is sought first */
#define ITSELF 2e-6  /* relative: so far below a limit all waves are looked at */

const char *const MpmProgramLimitNames[] = {"interior", "block", "lone_particle", "state"};

/*S
   Search - whose growth is asked for. part: a free block or a lone particle, which has a base state of its own; NULL:
   the program itself.

   place      - its operator at all time steps, where known says so: at rest one polynomial, in motion one for each of n
                places of the period
   wave       - phases of the waves whose growth is looked at; all: the largest of all waves is sought
   given      - numbers of a particle that nothing reads in the interior
   unit       - what the progress line counts, with the number so far
S*/
typedef struct {
  MpmProgram         *program, part;
  MpmStepper          cut;
  PetscBool           is_part, known, all, *given;
  MpmDtPolynomial    *place;
  PetscInt            n;
  PetscReal           wave[WAVES][MPM_MAX_DIM];
  PetscInt            waves;
  MpmCriticalProgram *critical;
  char                unit[64];
} Search;

/* ---- growth at a time step ---- */

/* The largest growth of all waves, or of those that are known to matter. */
static PetscErrorCode GrowthOfWaves(Search *s, const MpmSource *source, PetscReal *growth)
{
  static const PetscInt phases[] = {32, 16, 8};
  PetscInt              each[MPM_MAX_DIM];
  MpmSourceGrowth       at;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < source->dim; a++) each[a] = phases[source->dim - 1];
  *growth = 0;
  if (s->all) {
    PetscCall(MpmWorstPhase(PETSC_COMM_WORLD, source, each, s->critical->beta, &at));
    *growth = at.growth;
  } else
    for (PetscInt i = 0; i < s->waves; i++) {
      PetscCall(MpmSourceGrowthAt(source, s->wave[i], &at));
      *growth = PetscMax(*growth, at.growth);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of the product of the steps of a period, without a call. */
static PetscErrorCode GrowthKnown(Search *s, PetscReal dt, PetscReal *growth)
{
  MpmProbed     *probed;
  MpmBlocks     *blocks;
  MpmBlocksSteps steps = {.n = s->n};
  MpmSource      source;
  PetscReal      value[2];

  PetscFunctionBegin;
  if (s->place[0].at[0].A) {
    PetscCall(MpmDtPolynomialLargest(&s->place[0], dt, value));
    *growth = MpmGrowthPerStep(hypot(value[0], value[1]), 0, s->program->stepper->steps);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscMalloc2(s->n, &probed, s->n, &blocks));
  for (PetscInt k = 0; k < s->n; k++) {
    PetscCall(MpmDtPolynomialAt(&s->place[k], dt, &probed[k]));
    blocks[k] = probed[k].blocks;
  }
  steps.step = blocks;
  PetscCall(MpmBlocksSourceOfSteps(&steps, s->program->stepper->name, &source));
  PetscCall(GrowthOfWaves(s, &source, growth));
  for (PetscInt k = 0; k < s->n; k++) PetscCall(MpmProbedFree(&probed[k]));
  PetscCall(PetscFree2(probed, blocks));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At a time step: from the polynomial, or from an operator that is probed. */
static PetscErrorCode Growth(void *context, PetscReal dt, PetscReal *growth)
{
  Search     *s = context;
  MpmProgram *p = s->is_part ? &s->part : s->program;

  PetscFunctionBegin;
  if (s->known) {
    PetscCall(GrowthKnown(s, dt, growth));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmStepperSet(p->stepper, s->critical->name, dt));
  PetscCall(MpmProgramPrepare(p));
  PetscCall(MpmProgramGrowth(p, growth));
  PetscCall(MpmProgramForget(p));
  s->critical->probes++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The limit, from a start on by doubling or halving. So many equally spaced steps below it are tried too, since growth
   may begin and end there.
*/
static PetscErrorCode Limit(Search *s, PetscReal start, PetscInt below, PetscReal *limit)
{
  const PetscReal tolerance = s->program->tolerance;
  const PetscBool beside    = s->is_part && start == s->critical->limit[MPM_LIMIT_INTERIOR] ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal farthest  = beside ? FARTHEST_PART : FARTHEST;
  MpmSearchSteps  steps     = {
           .from = start, .to = start * farthest, .ratio = 2, .width = INFINITY, .least = start / farthest};
  PetscReal bracket[2];

  PetscFunctionBegin;
  PetscCall(MpmSearchFirst(Growth, s, tolerance, &steps, CLOSE, bracket));
  *limit = isinf(bracket[1]) ? INFINITY : bracket[0];
  if (below == 0 || !(*limit > 0) || isinf(*limit)) PetscFunctionReturn(PETSC_SUCCESS);
  steps.from = steps.width = *limit / (PetscReal)(below + 1);
  steps.to                 = *limit * (PetscReal)below / (PetscReal)(below + 1);
  steps.ratio              = INFINITY;
  PetscCall(MpmSearchFirst(Growth, s, tolerance, &steps, CLOSE, bracket));
  if (isfinite(bracket[1])) *limit = bracket[0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The limit of all waves. It is sought for a few of them; where another one grows at it or below, that one is taken,
   too, and the limit is sought again.
*/
static PetscErrorCode LimitOfWaves(Search *s, PetscReal start, PetscInt below, PetscReal *limit)
{
  const PetscInt dim  = s->program->stepper->dim;
  PetscBool      more = PETSC_TRUE;

  PetscFunctionBegin;
  s->waves = 1 << dim;
  for (PetscInt i = 0; i < s->waves; i++)
    for (PetscInt a = 0; a < dim; a++) s->wave[i][a] = i >> a & 1 ? PETSC_PI : 0;
  while (more) {
    more   = PETSC_FALSE;
    s->all = s->waves == WAVES ? PETSC_TRUE : PETSC_FALSE;
    PetscCall(Limit(s, start, s->all ? below : 0, limit));
    if (s->all || !(*limit > 0) || !isfinite(*limit)) break;
    s->all = PETSC_TRUE;
    for (PetscInt i = below + 1; i > 0 && !more; i--) {
      PetscReal growth;

      PetscCall(Growth(s, *limit * (i > below ? 1 - ITSELF : (PetscReal)i / (PetscReal)(below + 1)), &growth));
      more = growth > 1 + s->program->tolerance ? PETSC_TRUE : PETSC_FALSE;
    }
    if (more) PetscCall(PetscArraycpy(s->wave[s->waves++], s->critical->beta, MPM_MAX_DIM));
  }
  s->all = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Forget(Search *s)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < s->n; k++) PetscCall(MpmDtPolynomialDestroy(&s->place[k]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Polynomials around a time step, one for each place; what nothing reads at any of them is set apart. */
static PetscErrorCode FindPolynomials(Search *s, PetscReal centre, PetscBool *fits)
{
  MpmProgram *p   = s->is_part ? &s->part : s->program;
  MpmUnread  *all = &s->place[0].unread;

  PetscFunctionBegin;
  PetscCall(Forget(s));
  *fits = PETSC_TRUE;
  for (PetscInt k = 0; k < s->n && *fits; k++) {
    s->place[k] = (MpmDtPolynomial){.name   = s->critical->name,
                                    .given  = s->is_part ? s->given : NULL,
                                    .motion = s->is_part ? NULL : s->critical->motion,
                                    .step   = k};
    PetscCall(MpmDtPolynomialFind(p, centre, &s->place[k], fits));
    s->critical->probes += s->place[k].n;
    if (k && *fits) MpmMotionJoin(&s->place[k].unread, all);
  }
  for (PetscInt k = 1; k < s->n && *fits; k++) {
    PetscCall(PetscArraycpy(s->place[k].unread.apart, all->apart, all->width));
    s->place[k].unread.n = all->n;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   By the polynomial, which is probed around a time step that is near the limit, and must hold at the limit and at half
   of it. found: whether it does. In motion a limit of 0 is one: growth of ringing gets smaller with the time step, and
   does not vanish.
*/
static PetscErrorCode FindKnown(Search *s, PetscReal start, PetscInt below, PetscReal *limit, PetscBool *found)
{
  PetscReal centre = start;

  PetscFunctionBegin;
  *found = PETSC_FALSE;
  for (int move = 0; move < MOST_MOVES; move++) {
    PetscBool fits;

    PetscCall(FindPolynomials(s, centre, &fits));
    if (!fits) break;
    s->known = PETSC_TRUE;
    PetscCall(s->place[0].at[0].A ? Limit(s, start, below, limit) : LimitOfWaves(s, start, below, limit));
    s->known = PETSC_FALSE;
    if (!(*limit > 0) || !isfinite(*limit)) {
      *found = s->critical->motion ? PETSC_TRUE : PETSC_FALSE;
      break;
    }
    if (*limit <= FARTHER * centre && *limit >= centre / FARTHER) {
      *found = PETSC_TRUE;
      for (PetscInt k = 0; k < s->n; k++)
        for (int half = 1; half <= 2 && *found; half++)
          PetscCall(MpmDtPolynomialHolds(&s->place[k], *limit / half, found));
      break;
    }
    centre = *limit;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A large part is not sought by operators, nor by polynomials where the interior has none. */
static PetscErrorCode FindLimit(Search *s, PetscReal start, PetscInt below, PetscReal *limit)
{
  const PetscInt columns = s->is_part ? (PetscInt)s->cut.particles * s->cut.width : 0;
  PetscBool      found = PETSC_FALSE, large = columns > MOST_COLUMNS ? PETSC_TRUE : PETSC_FALSE;

  PetscFunctionBegin;
  if (!large || s->given) PetscCall(FindKnown(s, start, below, limit, &found));
  MpmCheckInput(
      found || !s->critical->motion,
      "-drift: the step of the code is no polynomial of %s, so that a limit would need a probe of all places at "
      "each time step; allowed: symbol -drift, at one time step",
      s->critical->name);
  if (found) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Forget(s));
  *limit = NAN;
  if (large)
    s->critical->apart = columns;
  else
    PetscCall(Limit(s, start, below, limit));
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
  if (c->motion)
    PetscCall(MpmMotionJudgeWaves(p, c->motion, phases, c->beta, f));
  else if (p->kind == MPM_PROBE_BLOCH)
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

/* The same by the polynomial of the search. */
static PetscErrorCode LookAboveKnown(Search *s, PetscReal started, PetscReal limit)
{
  MpmCriticalProgram *c     = s->critical;
  MpmProgram         *p     = s->is_part ? &s->part : s->program;
  const MpmProbe     *alike = p->alike;
  MpmSpectrum        *spectrum;
  MpmProbed           above;

  PetscFunctionBegin;
  if (!(limit > 0) || !isfinite(limit)) PetscFunctionReturn(PETSC_SUCCESS);
  p->alike = NULL;
  if (!s->place[0].n) {
    PetscCall(LookAbove(p, started, limit, c));
  } else {
    PetscCall(MpmStepperSet(p->stepper, c->name, limit * (1 + BESIDE)));
    PetscCall(MpmProgramPrepare(p));
    PetscCall(MpmCertifyStep(&p->probe, p->tolerance, s->place[0].unread.apart, &p->certificates));
    PetscCall(MpmCertifyRepeat(&p->probe, s->place[0].unread.apart, &p->certificates));
    if (!c->why) c->why = Fault(p);
    PetscCall(MpmDtPolynomialAt(&s->place[0], limit * (1 + BESIDE), &above));
    PetscCall(MpmSpectrumOfMatrix(p->stepper->name, above.A, p->probe.steps, NULL, p->request, started, &spectrum));
    p->unread = s->place[0].unread;
    PetscCall(MpmCarriersFind(p, spectrum, &c->carriers));
    p->unread = (MpmUnread){.n = 0};
    PetscCall(MpmSpectrumDestroy(&spectrum));
    PetscCall(MpmProbedFree(&above));
    PetscCall(MpmProgramForget(p));
  }
  p->alike = alike;
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

/* The progress line has the least limit so far. */
static void Say(Search *s)
{
  const PetscInt least = Least(s->critical);

  if (least != MPM_NONE && isfinite(s->critical->limit[least]))
    (void)snprintf(s->unit, sizeof s->unit, "%s up to %.6g so far; calls", s->critical->name,
                   (double)s->critical->limit[least]);
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
  s->program->stepper->calls    = s->cut.calls;
  s->program->stepper->done     = s->cut.done;
  s->program->stepper->slowest  = s->cut.slowest;
  s->program->stepper->progress = s->cut.progress;
  PetscCall(PetscFree(s->cut.base));
  s->is_part = PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The least limit of a lone particle. A site that is stable at the limit of those before it has no lower one. */
static PetscErrorCode LimitOfLone(Search *s, PetscReal started, PetscReal start, PetscReal *limit)
{
  PetscFunctionBegin;
  *limit = NAN;
  for (PetscInt site = 0; site < PetscMin(s->program->lattice.sites, MOST_SITES); site++) {
    PetscReal growth = INFINITY;

    PetscCall(Cut(s, site));
    if (site > 0 && *limit > 0 && isfinite(*limit)) PetscCall(Growth(s, *limit, &growth));
    if (!(growth <= 1 + s->program->tolerance)) {
      PetscReal found;

      PetscCall(FindLimit(s, start, BELOW_PART, &found));
      if (!(found >= *limit)) s->critical->site = site;
      if (found < s->critical->limit[MPM_LIMIT_INTERIOR] && !(found >= *limit))
        PetscCall(LookAboveKnown(s, started, found));
      *limit = site > 0 ? PetscMin(*limit, found) : found;
    }
    PetscCall(Mend(s));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The lattice is looked at again, since the search has forgotten it. */
static PetscErrorCode Parts(Search *s, PetscReal started, PetscReal start)
{
  MpmCriticalProgram *c = s->critical;
  MpmProgram         *p = s->program;

  PetscFunctionBegin;
  PetscCall(MpmStepperSet(p->stepper, c->name, c->given));
  PetscCall(MpmProgramPrepare(p));
  PetscCall(LimitOfLone(s, started, start, &c->limit[MPM_LIMIT_LONE]));
  Say(s);
  if (c->block) {
    PetscCall(Cut(s, MPM_NONE));
    PetscCall(FindLimit(s, start, BELOW_PART, &c->limit[MPM_LIMIT_BLOCK]));
    if (Least(c) == MPM_LIMIT_BLOCK) PetscCall(LookAboveKnown(s, started, c->limit[MPM_LIMIT_BLOCK]));
    PetscCall(Mend(s));
  }
  PetscCall(MpmProgramForget(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Looks at the mode of the interior, or of the state. Then the given step is judged. */
static PetscErrorCode Finish(Search *s, PetscReal started, PetscReal limit)
{
  MpmCriticalProgram *c     = s->critical;
  MpmProgram         *p     = s->program;
  const PetscInt      least = Least(c);
  PetscReal           beta[MPM_MAX_DIM];
  MpmCarriers         carriers = c->carriers;

  PetscFunctionBegin;
  if (isnan(c->limit[MPM_LIMIT_STATE]))
    PetscCall(LookAbove(p, started, limit, c));
  else
    PetscCall(LookAboveKnown(s, started, limit));
  PetscCall(PetscArraycpy(beta, c->beta, MPM_MAX_DIM));
  if (!isnan(c->limit[MPM_LIMIT_STATE])) carriers = c->carriers;
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
      if (l->cells[a] < block + (l->wraps[a] ? APART : 0)) fits = PETSC_FALSE;
    }
    if (fits && unknowns <= MPM_DENSE_MANY) return block;
  }
  return 0;
}

/* The calls that the search is going to take, about, of a code that is a polynomial; and that two judgements take. */
static PetscInt64 Expected(const MpmProgram *p, const MpmCriticalProgram *c)
{
  PetscInt64 calls = 2 * NODES * (PetscInt64)p->columns + 8 * (PetscInt64)p->columns + 250, block = p->lattice.sites;

  if (c->motion) return c->motion->n * (2 * NODES * (PetscInt64)p->columns + 7 * 40) + calls;
  if (!c->parts) return calls;
  for (PetscInt a = 0; a < p->stepper->dim; a++) block *= c->block;
  calls += 2 * NODES * block * p->stepper->width + 150;
  return calls + p->lattice.sites * (2 * (NODES + 1) * (PetscInt64)p->stepper->width + 80);
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
  if (p->request->program_drift[0].den) {
    MpmCheckInput(
        p->kind == MPM_PROBE_BLOCH,
        "-drift: its cells are not alike (%s), so that it has no waves; allowed: spectrum -drift, at one time step",
        p->why);
    PetscCall(PetscNew(&c->motion));
    PetscCall(MpmMotionBegin(p, c->motion));
  }
  c->parts = p->kind == MPM_PROBE_BLOCH && stepper->any_count && !c->motion && p->request->probe == MPM_PROBE_ANY
                 ? PETSC_TRUE
                 : PETSC_FALSE;
  if (c->parts) c->block = BlockOf(p);
  c->expected = Expected(p, c);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalProgramFind(MpmProgram *p, PetscReal started, MpmCriticalProgram *c)
{
  const PetscBool bloch = p->kind == MPM_PROBE_BLOCH ? PETSC_TRUE : PETSC_FALSE;
  MpmProbe        sizes = p->probe;
  Search          s     = {.program = p, .critical = c, .all = PETSC_TRUE, .unit = "calls"};
  PetscReal      *limit = &c->limit[bloch ? MPM_LIMIT_INTERIOR : MPM_LIMIT_STATE];
  const PetscInt  w     = p->stepper->width;

  PetscFunctionBegin;
  PetscCall(MpmStepperExpect(p->stepper, s.unit, c->expected));
  PetscCall(MpmProgramForget(p));
  p->alike = &sizes;
  s.n      = c->motion ? c->motion->n : 1;
  PetscCall(PetscCalloc1(s.n, &s.place));
  PetscCall(FindLimit(&s, c->given, BELOW, limit));
  if (s.place[0].n) PetscCall(PetscMalloc1(w, &s.given));
  if (s.given) PetscCall(PetscArraycpy(s.given, s.place[0].unread.apart, w));
  Say(&s);
  if (c->parts) PetscCall(Parts(&s, started, isfinite(*limit) && *limit > 0 ? *limit : c->given));
  p->alike = NULL;
  PetscCall(Finish(&s, started, *limit));
  PetscCall(Forget(&s));
  PetscCall(PetscFree(s.place));
  PetscCall(PetscFree(s.given));
  PetscCall(MpmStepperForgetExpected(p->stepper));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCriticalProgramDestroy(MpmCriticalProgram *c)
{
  PetscFunctionBegin;
  if (c->motion) PetscCall(MpmMotionDestroy(c->motion));
  PetscCall(PetscFree(c->motion));
  PetscFunctionReturn(PETSC_SUCCESS);
}
