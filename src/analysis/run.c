/*
   A run: it makes particles and grid from the scene, marches them, and collects samples, growth and diagnostics. The
   callbacks read and write files.
*/
#include "analysis/run.h"
#include "march/diagnostics.h"
#include "march/adapt.h"
#include "march/implicit_solve.h"
#include "march/march_private.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "base/progress.h"
#include "march/passes.h"
#include <math.h>

#define MOST_SAMPLES 256 /* equally spaced; large growth per step asks for more */

/*
   Rescaling keeps the state within 2^+-100. Between two samples it may grow by 2^380, so it stays below 2^480, and its
   squares fit in a double.
*/
#define RESCALE_AT 100
#define ROOM 380

#define SQUARES_END 1e154 /* beyond it squares are out of range */

#define SMALL 0.01 /* of a cell, of the wave speed, and relative to F0 */

#define LEAST_MASS 0x1p-52 /* of a node, in particles, when the layout is not uniform */

static const MpmRunCallbacks no_callbacks;

typedef struct {
  MpmRun                 *run;
  const MpmRequest       *request;
  PetscBool               random; /* starts from random data, not from the scene's */
  MpmMarch               *march;
  const MpmRunCallbacks  *callbacks;
  MpmTransferDiagnostics *diagnostics; /* NULL: the scene asks for none */
  PetscInt64              gap;         /* steps between samples */
  PetscReal               aside_s;     /* time that does not count as time of the loop */
  MpmConserved            start;
  PetscBool               large; /* at finite deformation the state has left the uniform one that it starts near */
} Loop;

/* Whether a run at finite deformation starts from noise, which has a growth. Other motions have none. */
static PetscBool IsNoise(const Loop *loop)
{
  return loop->random || loop->run->scene->initial == MPM_INITIAL_RANDOM ? PETSC_TRUE : PETSC_FALSE;
}

/*
   The steps between samples at finite deformation, where states are of order 1: for growth, or for the rows of a file.
*/
static PetscInt64 FiniteGap(const Loop *loop)
{
  const MpmPace   *pace  = loop->run->pace;
  const PetscInt64 steps = pace ? (PetscInt64)pace->expected : loop->request->steps;

  return PetscMax(1, IsNoise(loop) || loop->request->csv[0] ? steps / MOST_SAMPLES : steps);
}

/*
   Chooses the steps between samples. One step enlarges the state by at most a bound known from the table, so no run can
   overflow between samples.
*/
static PetscInt64 SampleGap(const MpmScene *scene, PetscInt64 steps)
{
  PetscReal least = MpmLayoutIsUniform(&scene->layout) ? MpmLayoutPpc(&scene->layout) : LEAST_MASS;
  PetscReal extreme[MPM_PROPERTIES], bound, safe;

  MpmMaterialBounds(&scene->layout, extreme);
  least *= extreme[MPM_MASS] / extreme[MPM_VOLUME];
  bound = MpmScheduleBound(scene->scheme.table, scene->scheme.basis, scene->step.courant, MpmLayoutPpc(&scene->layout),
                           least, extreme[MPM_STIFFNESS]);
  safe  = bound > 1 ? floor(ROOM / log2(bound)) : ROOM;
  return PetscMax(1, PetscMin((PetscInt64)safe, steps / MOST_SAMPLES));
}

/* Measures diagnostics and calls the caller's function at a sample. This time does not count as time of the loop. */
static PetscErrorCode Record(Loop *loop, PetscReal log_norm, PetscReal energy)
{
  const MpmRunCallbacks *c     = loop->callbacks;
  const PetscReal        begin = MPI_Wtime();

  PetscFunctionBegin;
  if (loop->diagnostics) PetscCall(MpmTransferDiagnosticsMeasure(loop->diagnostics));
  if (c->sample) PetscCall(c->sample(c->context, loop->run, loop->march, loop->diagnostics, log_norm, energy));
  loop->aside_s += MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Returns the energy in the scene's units. It is NaN when it is out of the range of doubles, or when there is none. */
static PetscReal TrueEnergy(const MpmMarch *march, PetscReal energy)
{
  const MpmProfile profile  = MpmSceneProfile(march->scene, 1);
  const MpmWave   *wave     = march->scheme->formulation->wave;
  const PetscReal  velocity = sqrt(energy) * (wave ? wave->velocity_unit(&profile) : 1);
  const PetscReal  value    = PetscSqr(scalbn(velocity, (int)march->exponent));

  return isnormal(value) || energy == 0 ? value : NAN;
}

/*
   Records norm and energy of a sampled step at finite deformation. Its state is not rescaled, since it is not linear.
   Noise has a growth as long as it is small.
*/
static PetscErrorCode SampleFinite(Loop *loop)
{
  MpmRun  *run = loop->run;
  MpmNorms norms;

  PetscFunctionBegin;
  PetscCall(MpmMarchNorms(loop->march, &norms));
  run->energy_final = norms.energy;
  if (loop->march->step == 0) run->energy_initial = norms.energy;
  run->energy_ratio = run->energy_initial > 0 ? run->energy_final / run->energy_initial : NAN;
  if (norms.state > SMALL) loop->large = PETSC_TRUE;
  if (!loop->large) PetscCall(MpmSeriesAppend(&run->series, loop->march->step, log(norms.state), log(norms.grid)));
  PetscCall(Record(loop, log(norms.state), run->energy_final));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Records norm and energy of a sampled step and rescales the state. follow: whether the run can go on to follow the
   state.
*/
static PetscErrorCode Sample(Loop *loop, PetscBool *follow)
{
  MpmMarch       *march = loop->march;
  MpmRun         *run   = loop->run;
  const PetscReal ln2   = M_LN2 * march->exponent;
  PetscReal       log_state;
  MpmNorms        norms;

  PetscFunctionBegin;
  if (march->particles->own) {
    PetscCall(SampleFinite(loop));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmMarchNorms(march, &norms));
  *follow = isfinite(norms.state) && !isinf(norms.energy) && isfinite(norms.grid) ? PETSC_TRUE : PETSC_FALSE;
  if (MpmSchemeEnergyTerms(march->scheme) && isnan(norms.energy)) *follow = PETSC_FALSE;
  log_state = log(norms.state) + ln2;
  if (run->blew_up_at_step == MPM_NEVER && !(log_state <= log(PETSC_MAX_REAL))) run->blew_up_at_step = march->step;
  run->energy_final = TrueEnergy(march, norms.energy);
  if (march->step == 0) {
    run->energy_initial   = run->energy_final;
    run->log_energy_first = log(norms.energy) + 2 * ln2;
  }
  run->energy_ratio = exp(log(norms.energy) + 2 * ln2 - run->log_energy_first);
  run->lost         = *follow ? PETSC_FALSE : PETSC_TRUE;
  if (!*follow) {
    run->growth_above = pow(SQUARES_END / scalbn(1, RESCALE_AT + 1), 1.0 / loop->gap);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmSeriesAppend(&run->series, march->step, log_state, log(norms.grid) + ln2));
  PetscCall(Record(loop, log_state, run->energy_final));
  if (norms.state > 0 && PetscAbsInt(ilogb(norms.state)) > RESCALE_AT)
    PetscCall(MpmMarchRescale(march, ilogb(norms.state)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Tells the caller of a step. stop: the caller wants the run to end. */
static PetscErrorCode TellStep(Loop *loop, PetscBool *stop)
{
  const MpmRunCallbacks *c = loop->callbacks;
  PetscReal              begin;

  PetscFunctionBegin;
  if (!c->step) PetscFunctionReturn(PETSC_SUCCESS);
  begin = MPI_Wtime();
  PetscCall(c->step(c->context, loop->run, loop->march, stop));
  loop->aside_s += MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes small perturbations through the next step. This time does not count as time of the loop. */
static PetscErrorCode Perturb(Loop *loop)
{
  const PetscReal begin = MPI_Wtime();

  PetscFunctionBegin;
  if (!loop->run->tangents) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmTangentsStep(loop->run->tangents, loop->march));
  loop->aside_s += MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Chooses the next step, if the run does so. This time counts: it is part of the work of such a run. */
static PetscErrorCode ChooseStep(Loop *loop)
{
  MpmRun *run = loop->run;

  PetscFunctionBegin;
  if (run->watch) PetscCall(MpmPaceWatch(run->watch, loop->march));
  if (!run->pace) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmPaceStep(run->pace, loop->march, &run->last));
  if (!loop->callbacks->silent) PetscCall(MpmPaceTell(run->pace, loop->march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode March(Loop *loop)
{
  const PetscInt64 expected = loop->run->pace ? (PetscInt64)loop->run->pace->expected : loop->request->steps;
  PetscReal        begin;
  PetscBool        follow = PETSC_TRUE, stop = PETSC_FALSE;
  MpmProgress      progress;

  PetscFunctionBegin;
  if (loop->march->step == 0) PetscCall(Sample(loop, &follow));
  /* a run that resumes at its last step takes no sample, but still reports diagnostics */
  if (loop->march->step == loop->run->last && loop->diagnostics)
    PetscCall(MpmTransferDiagnosticsMeasure(loop->diagnostics));
  PetscCall(TellStep(loop, &stop));
  PetscCall(MpmProgressBegin("step", &progress));
  loop->aside_s = 0;
  begin         = MPI_Wtime();
  while (loop->march->step < loop->run->last && follow && !stop) {
    const PetscInt64 step = loop->march->step + 1;
    PetscBool        sample;

    PetscCall(ChooseStep(loop));
    sample = step % loop->gap == 0 || step == loop->run->last ? PETSC_TRUE : PETSC_FALSE;
    PetscCall(Perturb(loop));
    PetscCall(MpmMarchStep(loop->march));
    if (loop->march->failure[0]) break;
    if (loop->run->pace) PetscCall(MpmPaceTook(loop->run->pace, loop->march));
    if (loop->run->watch) PetscCall(MpmPaceTook(loop->run->watch, loop->march));
    if (sample) PetscCall(Sample(loop, &follow));
    PetscCall(TellStep(loop, &stop));
    PetscCall(MpmProgressUpdate(&progress, step, PetscMax(step, expected)));
  }
  PetscCall(PetscStrncpy(loop->run->failure, loop->march->failure, sizeof loop->run->failure));
  if (loop->run->failure[0]) loop->run->lost = PETSC_TRUE;
  loop->run->stopped = stop && loop->march->step < loop->run->last ? PETSC_TRUE : PETSC_FALSE;
  loop->run->loop_s  = MPI_Wtime() - begin - loop->aside_s;
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Begin(Loop *loop)
{
  const MpmRunCallbacks *c = loop->callbacks;

  PetscFunctionBegin;
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, loop->run->scene, &loop->march));
  if (loop->random) PetscCall(MpmMarchFillRandom(loop->march, loop->run->scene->amplitude));
  if (c->begin) PetscCall(c->begin(c->context, loop->run, loop->march));
  loop->run->from = loop->march->step;
  PetscCall(MpmConservedSum(loop->march, &loop->start));
  PetscCall(MpmTransferDiagnosticsCreate(loop->march, loop->request, &loop->diagnostics));
  if (loop->request->tangent) PetscCall(MpmTangentsCreate(loop->march, loop->request, &loop->run->tangents));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Check(Loop *loop)
{
  PetscReal changes[2] = {NAN, NAN};

  PetscFunctionBegin;
  if (!loop->run->lost) PetscCall(MpmConservedCheck(loop->march, &loop->start, changes));
  PetscCall(MpmMarchLoad(loop->march, &loop->run->load));
  if (loop->march->halve) {
    loop->run->halved = loop->march->halve->steps;
    loop->run->parts  = loop->march->halve->finest;
  }
  loop->run->relaxed = loop->march->relax ? loop->march->relax->steps : 0;
  if (loop->run->relaxed) loop->run->least_factor = loop->march->relax->least;
  loop->run->mass_change     = changes[0];
  loop->run->momentum_change = changes[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes the results at the end of the march, such as errors and changes of conserved quantities. */
static PetscErrorCode Conclude(Loop *loop)
{
  MpmRun         *r     = loop->run;
  const MpmScene *scene = r->scene;
  const PetscBool alike = scene->layout.dim == 1 && scene->layout.jitter == 0 && scene->layout.counts.n == 1;

  PetscFunctionBegin;
  if (r->has_errors) PetscCall(MpmDiagnosticsErrors(loop->march, r->error));
  r->steps = loop->march->step;
  MpmImplicitSolveTotals(loop->march, &r->iterations, &r->newton, &r->solve_s);
  r->time  = MpmMarchTime(loop->march, r->steps);
  r->bytes = NAN; /* of the plain march nobody counts them */
  if (scene->layout.march == MPM_MARCH_FAST)
    r->bytes = MpmScheduleBytes(scene->scheme.table, &scene->layout, &loop->march->schedule,
                                (PetscReal)scene->layout.particles / MpmLayoutNodes(&scene->layout), alike);
  if (loop->diagnostics) {
    r->transfer_first = loop->diagnostics->first;
    r->transfer_last  = loop->diagnostics->last;
    r->transfer_most  = loop->diagnostics->most;
  }
  if (scene->scheme.space.finite && !IsNoise(loop)) {
    r->verdict = MPM_UNDECIDED;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmGrowthFit(&r->series, loop->request->tolerance, r->has_errors ? PETSC_FALSE : PETSC_TRUE, &r->growth));
  r->verdict = r->lost ? MPM_UNSTABLE : MpmGrowthVerdict(&r->growth, loop->request->tolerance);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Run(const MpmScene *scene, Loop *loop, MpmRun **run)
{
  const MpmRunCallbacks *c      = loop->callbacks;
  const PetscBool        output = loop->request->output[0] ? PETSC_TRUE : PETSC_FALSE;
  MpmRun                *r;

  PetscFunctionBegin;
  PetscCall(MpmLayoutCheckMemory(PETSC_COMM_WORLD, &scene->layout, MpmMarchBytes(scene, output), "the march"));
  PetscCall(PetscNew(run));
  r                  = *run;
  r->scene           = scene;
  r->request         = loop->request;
  r->blew_up_at_step = MPM_NEVER;
  r->has_errors      = !loop->random && MpmSceneHasExact(scene) ? PETSC_TRUE : PETSC_FALSE;
  r->eigenmode       = NAN;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &r->ranks));
  r->last   = loop->request->steps;
  loop->run = r;
  if (scene->safety > 0) PetscCall(MpmPaceCreate(scene, loop->request, &r->pace));
  if (scene->watched) PetscCall(MpmPaceCreate(scene, loop->request, &r->watch));
  PetscCall(Begin(loop));
  if (r->pace) PetscCall(MpmPaceBegin(r->pace, loop->march, loop->request));
  loop->gap = scene->scheme.space.finite ? FiniteGap(loop) : SampleGap(scene, loop->request->steps);
  PetscCall(March(loop));
  PetscCall(Check(loop));
  if (c->end) PetscCall(c->end(c->context, r, loop->march));
  PetscCall(Conclude(loop));
  PetscCall(MpmTransferDiagnosticsDestroy(&loop->diagnostics));
  PetscCall(MpmMarchDestroy(&loop->march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunCreate(const MpmScene *scene, const MpmRequest *request, const MpmRunCallbacks *callbacks,
                            PetscReal started, MpmRun **run)
{
  Loop loop = {.request = request, .callbacks = callbacks ? callbacks : &no_callbacks};

  PetscFunctionBegin;
  PetscCall(Run(scene, &loop, run));
  if (scene->scheme.space.finite) /* the closed forms are those of linear schemes */
    (*run)->predictions = (MpmPredictions){.published = NAN, .corrected = NAN, .corrected_mode = NAN};
  else
    PetscCall(MpmPredict(scene, &(*run)->predictions));
  (*run)->wall_s = MPI_Wtime() - started;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunRandom(const MpmScene *scene, PetscInt64 steps, PetscReal tolerance, MpmRun **run)
{
  const PetscReal  started = MPI_Wtime();
  const MpmRequest request = {.task = "run", .steps = steps, .tolerance = tolerance};
  Loop             loop    = {.request = &request, .callbacks = &no_callbacks, .random = PETSC_TRUE};

  PetscFunctionBegin;
  PetscCall(Run(scene, &loop, run));
  (*run)->request = NULL;
  (*run)->wall_s  = MPI_Wtime() - started;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunDestroy(MpmRun **run)
{
  PetscFunctionBegin;
  PetscCall(MpmSeriesDestroy(&(*run)->series));
  PetscCall(MpmTangentsDestroy(&(*run)->tangents));
  PetscCall(MpmPaceDestroy(&(*run)->pace));
  PetscCall(MpmPaceDestroy(&(*run)->watch));
  PetscCall(PetscFree(*run));
  PetscFunctionReturn(PETSC_SUCCESS);
}
