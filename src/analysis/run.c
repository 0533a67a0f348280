/* A run: scene -> particles and grid -> march -> samples, growth and diagnostics. Files are the callbacks' affair. */
#include "analysis/run.h"
#include "march/conserved.h"
#include "march/march_private.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "base/progress.h"
#include "march/traffic.h"
#include <math.h>

#define MOST_SAMPLES 256 /* equally spaced, unless growth asks for more */

/* Rescaling keeps the state within 2^+-100; between two samples it may grow to 2^480, and its squares fit a double. */
#define RESCALE_AT 100
#define ROOM 380

#define SQUARES_END 1e154 /* beyond it squares are out of range */

#define LEAST_MASS 0x1p-52 /* of a node in a layout that is not uniform, in particles */

typedef struct {
  MpmRun                 *run;
  MpmMarch               *march;
  const MpmRunCallbacks  *callbacks;
  MpmTransferDiagnostics *exchange; /* NULL: the scene asks for none */
  PetscInt64              gap;      /* steps between samples */
  PetscReal               aside_s;  /* time that is no part of the loop's */
  MpmConserved            start;
} Loop;

/* A step enlarges the state by at most a bound known from the table, so that no run overflows between samples. */
static PetscInt64 SampleGap(const MpmScene *scene)
{
  PetscReal least = MpmLayoutIsUniform(scene) ? scene->ppc : LEAST_MASS;
  PetscReal extreme[MPM_PROPERTIES], bound, safe;

  MpmMaterialBounds(scene, extreme);
  least *= extreme[MPM_MASS] / extreme[MPM_VOLUME];
  bound = MpmScheduleBound(scene->table, scene->basis, scene->courant, scene->ppc, least, extreme[MPM_STIFFNESS]);
  safe  = bound > 1 ? floor(ROOM / log2(bound)) : ROOM;
  return PetscMax(1, PetscMin((PetscInt64)safe, scene->steps / MOST_SAMPLES));
}

/* What is done with a sample besides the series; no part of the loop's time. */
static PetscErrorCode Record(Loop *loop, PetscReal log_norm, PetscReal energy)
{
  const MpmRunCallbacks *c     = loop->callbacks;
  const PetscReal        begin = MPI_Wtime();

  PetscFunctionBegin;
  if (loop->exchange) PetscCall(MpmTransferDiagnosticsMeasure(loop->exchange));
  if (c->sample) PetscCall(c->sample(c->context, loop->run, loop->march, loop->exchange, log_norm, energy));
  loop->aside_s += MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The energy in the scene's units; NaN when it is out of the range of doubles. */
static PetscReal TrueEnergy(const MpmMarch *march, PetscReal energy)
{
  const MpmProfile profile  = MpmSceneProfile(march->scene, 1);
  const PetscReal  velocity = sqrt(energy) * march->scene->formulation->wave->velocity_unit(&profile);
  const PetscReal  value    = PetscSqr(scalbn(velocity, (int)march->exponent));

  return isnormal(value) || energy == 0 ? value : NAN;
}

/* Records norm and energy of a sampled step and rescales the state. follow: whether the run can follow its state. */
static PetscErrorCode Sample(Loop *loop, PetscBool *follow)
{
  MpmMarch       *march = loop->march;
  MpmRun         *run   = loop->run;
  const PetscReal ln2   = M_LN2 * march->exponent;
  PetscReal       log_state;
  MpmNorms        norms;

  PetscFunctionBegin;
  PetscCall(MpmMarchNorms(march, &norms));
  *follow   = isfinite(norms.state) && isfinite(norms.energy) && isfinite(norms.grid) ? PETSC_TRUE : PETSC_FALSE;
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

/* stop: the caller wants the run to end here. */
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

static PetscErrorCode March(Loop *loop)
{
  const MpmScene *scene = loop->run->scene;
  PetscReal       begin;
  PetscBool       follow = PETSC_TRUE, stop = PETSC_FALSE;
  MpmProgress     progress;

  PetscFunctionBegin;
  if (loop->march->step == 0) PetscCall(Sample(loop, &follow));
  /* a run that resumes at its last step takes no sample, and still has diagnostics to show */
  if (loop->march->step == scene->steps && loop->exchange) PetscCall(MpmTransferDiagnosticsMeasure(loop->exchange));
  PetscCall(TellStep(loop, &stop));
  PetscCall(MpmProgressBegin(scene->progress, "step", &progress));
  loop->aside_s = 0;
  begin         = MPI_Wtime();
  while (loop->march->step < scene->steps && follow && !stop) {
    const PetscInt64 step   = loop->march->step + 1;
    const PetscBool  sample = step % loop->gap == 0 || step == scene->steps ? PETSC_TRUE : PETSC_FALSE;

    PetscCall(MpmMarchStep(loop->march, sample));
    if (sample) PetscCall(Sample(loop, &follow));
    PetscCall(TellStep(loop, &stop));
    PetscCall(MpmProgressUpdate(&progress, step, scene->steps));
  }
  loop->run->stopped = stop && loop->march->step < scene->steps ? PETSC_TRUE : PETSC_FALSE;
  loop->run->loop_s  = MPI_Wtime() - begin - loop->aside_s;
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Begin(Loop *loop)
{
  const MpmRunCallbacks *c = loop->callbacks;

  PetscFunctionBegin;
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, loop->run->scene, &loop->march));
  if (c->begin) PetscCall(c->begin(c->context, loop->run, loop->march));
  loop->run->from = loop->march->step;
  PetscCall(MpmConservedSum(loop->march, &loop->start));
  PetscCall(MpmTransferDiagnosticsCreate(loop->march, &loop->exchange));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Check(Loop *loop)
{
  PetscReal changes[2] = {NAN, NAN};

  PetscFunctionBegin;
  if (!loop->run->lost) PetscCall(MpmConservedCheck(loop->march, &loop->start, changes));
  loop->run->mass_change     = changes[0];
  loop->run->momentum_change = changes[1];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunCreateWith(const MpmScene *scene, const MpmRunCallbacks *callbacks, PetscReal started,
                                MpmRun **run)
{
  Loop      loop = {.gap = SampleGap(scene), .callbacks = callbacks};
  MpmRun   *r;
  PetscBool alike; /* on all ranks */

  PetscFunctionBegin;
  PetscCall(MpmSceneCheckMemory(PETSC_COMM_WORLD, scene, MpmMarchBytes(scene), "the march"));
  PetscCall(PetscNew(run));
  r                  = *run;
  r->scene           = scene;
  r->blew_up_at_step = MPM_NEVER;
  r->has_errors      = MpmSceneHasExact(scene);
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &r->ranks));
  PetscCall(MpmPredict(scene, &r->predictions));
  r->eigenmode = NAN;
  loop.run     = r;
  PetscCall(Begin(&loop));
  PetscCall(March(&loop));
  PetscCall(Check(&loop));
  if (callbacks->end) PetscCall(callbacks->end(callbacks->context, r, loop.march));
  if (r->has_errors) PetscCall(MpmDiagnosticsErrors(loop.march, r->error));
  r->steps = loop.march->step;
  alike    = loop.march->particles->per_cell || !loop.march->particles->count ? PETSC_TRUE : PETSC_FALSE;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &alike, 1, MPIU_BOOL, MPI_LAND, PETSC_COMM_WORLD));
  r->bytes = MpmScheduleBytes(scene->table, &loop.march->schedule, (PetscReal)scene->particles / scene->nodes, alike);
  if (loop.exchange) {
    r->exchange_first = loop.exchange->first;
    r->exchange_last  = loop.exchange->last;
    r->exchange_most  = loop.exchange->most;
  }
  PetscCall(MpmTransferDiagnosticsDestroy(&loop.exchange));
  PetscCall(MpmMarchDestroy(&loop.march));
  PetscCall(MpmGrowthFit(&r->series, scene->tolerance, r->has_errors ? PETSC_FALSE : PETSC_TRUE, &r->growth));
  r->verdict = r->lost ? MPM_UNSTABLE : MpmGrowthVerdict(&r->growth, scene->tolerance);
  r->wall_s  = MPI_Wtime() - started;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunCreate(const MpmScene *scene, PetscReal started, MpmRun **run)
{
  const MpmRunCallbacks none = {.context = NULL};

  PetscFunctionBegin;
  PetscCall(MpmRunCreateWith(scene, &none, started, run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRunDestroy(MpmRun **run)
{
  PetscFunctionBegin;
  PetscCall(MpmSeriesDestroy(&(*run)->series));
  PetscCall(PetscFree(*run));
  PetscFunctionReturn(PETSC_SUCCESS);
}
