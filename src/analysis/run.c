/* The task run: scene -> particles and grid -> march -> diagnostics -> output. */
#include "io/checkpoint.h"
#include "march/conserved.h"
#include <mpmstab/errors.h>
#include "scene/layout.h"
#include "scene/material.h"
#include "io/mode_file.h"
#include "io/output.h"
#include "base/progress.h"
#include "report/run_csv.h"
#include "base/stop.h"
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
  MpmOutput              *output; /* NULL: none asked */
  MpmTextFile             csv;
  MpmTransferDiagnostics *exchange; /* NULL: none asked */
  PetscInt64              gap;      /* steps between samples */
  PetscReal               aside_s;
  MpmConserved            start;
  char                   *csv_before; /* what a run that this one goes on from had written; NULL: none */
} Loop;

/* A step enlarges the state by at most a bound known from the table, so that no run overflows between samples. */
static PetscInt64 SampleGap(const MpmScene *scene)
{
  PetscReal least = MpmLayoutIsUniform(&scene->layout) ? scene->layout.ppc : LEAST_MASS;
  PetscReal extreme[MPM_PROPERTIES], bound, safe;

  MpmMaterialBounds(&scene->layout, extreme);
  least *= extreme[MPM_MASS] / extreme[MPM_VOLUME];
  bound = MpmScheduleBound(scene->scheme.table, scene->scheme.basis, scene->step.courant, scene->layout.ppc, least,
                           extreme[MPM_STIFFNESS]);
  safe  = bound > 1 ? floor(ROOM / log2(bound)) : ROOM;
  return PetscMax(1, PetscMin((PetscInt64)safe, scene->steps / MOST_SAMPLES));
}

/* What a sample is kept in beside the series; no part of the loop's time. */
static PetscErrorCode Record(Loop *loop, PetscReal log_norm, PetscReal energy)
{
  const PetscReal begin = MPI_Wtime();

  PetscFunctionBegin;
  if (loop->exchange) PetscCall(MpmTransferDiagnosticsMeasure(loop->exchange));
  if (loop->run->scene->csv[0])
    PetscCall(MpmRunCsvRow(loop->run, loop->march, loop->exchange, log_norm, energy, &loop->csv));
  loop->aside_s += MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The energy in the scene's units; NaN when it is out of the range of doubles, or when there is none. */
static PetscReal TrueEnergy(const MpmMarch *march, PetscReal energy)
{
  const MpmProfile profile  = MpmSceneProfile(march->scene, 1);
  const MpmWave   *wave     = march->scheme->formulation->wave;
  const PetscReal  velocity = sqrt(energy) * (wave ? wave->velocity_unit(&profile) : 1);
  const PetscReal  value    = PetscSqr(scalbn(velocity, (int)march->exponent));

  return isnormal(value) || energy == 0 ? value : NAN;
}

/* Records norm and energy of a sampled step and rescales the state. follow: whether the run can go on. */
static PetscErrorCode Sample(Loop *loop, PetscBool *follow)
{
  MpmMarch       *march = loop->march;
  MpmRun         *run   = loop->run;
  const PetscReal ln2   = M_LN2 * march->exponent;
  PetscReal       log_state;
  MpmNorms        norms;

  PetscFunctionBegin;
  PetscCall(MpmMarchNorms(march, &norms));
  *follow = isfinite(norms.state) && !isinf(norms.energy) && isfinite(norms.grid) ? PETSC_TRUE : PETSC_FALSE;
  if (march->scheme->formulation->nenergy && isnan(norms.energy)) *follow = PETSC_FALSE;
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

static PetscErrorCode WriteOutput(Loop *loop)
{
  const PetscReal begin = MPI_Wtime();

  PetscFunctionBegin;
  PetscCall(MpmOutputStep(loop->output, loop->march));
  loop->aside_s += MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Asks for SIGTERM only where something can be done about it. stop: the ranks have agreed to. */
static PetscErrorCode Keep(Loop *loop, PetscBool *stop)
{
  const MpmScene *scene = loop->run->scene;
  const PetscReal begin = MPI_Wtime();
  char           *csv   = NULL;

  PetscFunctionBegin;
  *stop = PETSC_FALSE;
  if (!scene->checkpoint[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmStopAgreed(PETSC_COMM_WORLD, stop));
  if (*stop || loop->march->step % scene->checkpoint_every == 0 || loop->march->step == scene->steps) {
    PetscCall(MpmTextFileSoFar(&loop->csv, &csv));
    PetscCall(MpmCheckpointWrite(scene->checkpoint, loop->march, loop->run, csv));
    PetscCall(PetscFree(csv));
  }
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
  if (loop->output) PetscCall(WriteOutput(loop));
  PetscCall(MpmProgressBegin(scene->progress, "step", &progress));
  loop->aside_s = 0;
  begin         = MPI_Wtime();
  while (loop->march->step < scene->steps && follow && !stop) {
    const PetscInt64 step   = loop->march->step + 1;
    const PetscBool  sample = step % loop->gap == 0 || step == scene->steps ? PETSC_TRUE : PETSC_FALSE;

    PetscCall(MpmMarchStep(loop->march, sample));
    if (sample) PetscCall(Sample(loop, &follow));
    if (loop->output && (step % scene->output_every == 0 || step == scene->steps)) PetscCall(WriteOutput(loop));
    if (follow) PetscCall(Keep(loop, &stop));
    PetscCall(MpmProgressUpdate(&progress, step, scene->steps));
  }
  loop->run->stopped = stop;
  loop->run->loop_s  = MPI_Wtime() - begin - loop->aside_s;
  PetscCall(MpmProgressEnd(&progress));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Every file was tried when the scene was read, and has its name only when the work is done. */
static PetscErrorCode OpenFiles(Loop *loop)
{
  const MpmScene *scene = loop->run->scene;

  PetscFunctionBegin;
  if (scene->output[0]) PetscCall(MpmOutputCreate(loop->march, &loop->output));
  if (scene->csv[0]) {
    PetscCall(MpmTextFileOpen(scene->csv, &loop->csv));
    PetscCall(MpmRunCsvBegin(loop->run, loop->csv_before, &loop->csv));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A run that was stopped leaves its checkpoint alone. */
static PetscErrorCode CloseFiles(Loop *loop)
{
  const PetscBool keep = loop->run->stopped ? PETSC_FALSE : PETSC_TRUE;

  PetscFunctionBegin;
  if (loop->output) PetscCall(MpmOutputDestroy(keep, &loop->output));
  if (loop->run->scene->csv[0] && keep) PetscCall(MpmTextFileClose(&loop->csv));
  if (!keep) MpmTextFileDrop(&loop->csv);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* From the scene's initial data, or from where another run was. */
static PetscErrorCode Begin(Loop *loop)
{
  const MpmScene *scene = loop->run->scene;

  PetscFunctionBegin;
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &loop->march));
  if (scene->restart[0]) PetscCall(MpmCheckpointRead(scene->restart, loop->march, loop->run, &loop->csv_before));
  loop->run->from = loop->march->step;
  PetscCall(MpmConservedSum(loop->march, &loop->start));
  PetscCall(MpmTransferDiagnosticsCreate(loop->march, &loop->exchange));
  if (scene->checkpoint[0]) MpmStopInstall();
  PetscCall(OpenFiles(loop));
  PetscCall(PetscFree(loop->csv_before));
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

PetscErrorCode MpmRunCreate(const MpmScene *scene, PetscReal started, MpmRun **run)
{
  Loop      loop = {.gap = SampleGap(scene)};
  MpmRun   *r;
  PetscBool alike; /* on all ranks */

  PetscFunctionBegin;
  PetscCall(MpmLayoutCheckMemory(PETSC_COMM_WORLD, &scene->layout, MpmMarchBytes(scene), "the march"));
  PetscCall(PetscNew(run));
  r                  = *run;
  r->scene           = scene;
  r->blew_up_at_step = MPM_NEVER;
  r->has_errors      = MpmSceneHasExact(scene);
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &r->ranks));
  PetscCall(MpmPredict(scene, &r->predictions));
  r->eigenmode = NAN;
  if (scene->initial == MPM_INITIAL_EIGENMODE) PetscCall(MpmModeFileGrowth(scene, &r->eigenmode));
  loop.run = r;
  PetscCall(Begin(&loop));
  PetscCall(March(&loop));
  PetscCall(Check(&loop));
  PetscCall(CloseFiles(&loop));
  if (r->has_errors) PetscCall(MpmDiagnosticsErrors(loop.march, r->error));
  r->steps = loop.march->step;
  alike    = loop.march->particles->per_cell || !loop.march->particles->count ? PETSC_TRUE : PETSC_FALSE;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &alike, 1, MPIU_BOOL, MPI_LAND, PETSC_COMM_WORLD));
  r->bytes = MpmScheduleBytes(scene->scheme.table, &loop.march->schedule,
                              (PetscReal)scene->layout.particles / scene->layout.grid.nodes, alike);
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

PetscErrorCode MpmRunDestroy(MpmRun **run)
{
  PetscFunctionBegin;
  PetscCall(MpmSeriesDestroy(&(*run)->series));
  PetscCall(PetscFree(*run));
  PetscFunctionReturn(PETSC_SUCCESS);
}
