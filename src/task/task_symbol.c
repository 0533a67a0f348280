/*
   The task symbol: mpmstab symbol [SCENE.yaml | -matrix_blocks FILE | -program COMMAND | -plugin FILE]
   [-option value]...
*/
#include "analysis/damping.h"
#include "base/textfile.h"
#include "io/datafile.h"
#include "io/matrix_file.h"
#include "probe/motion.h"
#include "report/report.h"
#include "report/report_program.h"
#include "report/results.h"
#include "analysis/waves.h"
#include "task/task.h"
#include <math.h>

/* The phases of a symbol and its curves over them. The first rank has those that the ranks have computed. */
typedef struct {
  PetscInt    n;
  const char *name[4];
  PetscReal  *beta, *at[4];
} Curves;

static PetscErrorCode MakeCurves(MPI_Comm comm, const MpmSymbol *s, const MpmPredictor *p, Curves *c)
{
  const PetscReal *const computed[]                                                = {s->per_phase, s->without_null};
  PetscReal (*const formula[])(const MpmPredictor *, PetscReal, const PetscReal[]) = {MpmPredictorPublished,
                                                                                      MpmPredictorCorrected};
  PetscReal *growth;
  PetscBool  conjugate;

  PetscFunctionBegin;
  *c = (Curves){.n = 0};
  PetscCall(PetscMalloc1(s->dim * s->all, &c->beta));
  for (PetscInt m = 0; m < s->all; m++) MpmSymbolBeta(s, m, c->beta + s->dim * m);
  for (int k = 0; k < 2; k++) {
    if (!computed[k]) continue;
    PetscCall(MpmSymbolGather(comm, s, computed[k], &growth));
    PetscCall(PetscCalloc1(s->all, &c->at[c->n]));
    for (PetscInt m = 0; m < s->all && !MpmRankOf(comm); m++) c->at[c->n][m] = growth[MpmSymbolClass(s, m, &conjugate)];
    c->name[c->n++] = k ? "growth_seen" : "growth";
    PetscCall(PetscFree(growth));
  }
  for (int k = 0; k < 2 && p; k++) {
    PetscCall(PetscMalloc1(s->all, &c->at[c->n]));
    for (PetscInt m = 0; m < s->all; m++) c->at[c->n][m] = formula[k](p, s->step.courant, c->beta + s->dim * m);
    c->name[c->n++] = k ? "corrected" : "published";
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FreeCurves(Curves *c)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < c->n; k++) PetscCall(PetscFree(c->at[k]));
  PetscCall(PetscFree(c->beta));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSymbolWrite(const MpmSymbol *s, const MpmPredictor *p, MpmDataFile *file)
{
  PetscReal *factors;
  Curves     curves;

  PetscFunctionBegin;
  PetscCall(MakeCurves(file->hdf5.comm, s, p, &curves));
  PetscCall(MpmDataFileArray(file, "/symbol", "beta", s->all, s->dim, curves.beta));
  for (PetscInt k = 0; k < curves.n; k++)
    PetscCall(MpmDataFileArray(file, "/symbol", curves.name[k], s->all, 1, curves.at[k]));
  PetscCall(FreeCurves(&curves));
  if (!s->factors) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmSymbolGatherFactors(file->hdf5.comm, s, 0, &factors));
  PetscCall(MpmDataFileArray(file, "/symbol", "factors", s->all, 2 * s->size, factors));
  PetscCall(PetscFree(factors));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Rows of beta, growth, growth without the null space of P2G (at rest; it is the particle data that no node feels),
   published and corrected growth. In one dimension there is a row for each phase up to pi, in more for each phase.
*/
static PetscErrorCode WriteSymbolCsv(const MpmSymbol *s, const MpmPredictor *p, const char path[])
{
  static const char *const names[MPM_MAX_DIM] = {"beta", "beta_x,beta_y", "beta_x,beta_y,beta_z"};
  const PetscInt           rows               = s->dim == 1 ? s->classes : s->all;
  Curves                   curves;
  MpmTextFile              csv;

  PetscFunctionBegin;
  PetscCall(MakeCurves(PETSC_COMM_WORLD, s, p, &curves));
  PetscCall(MpmTextFileOpen(path, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "%s", names[s->dim - 1]);
    for (PetscInt k = 0; k < curves.n; k++) fprintf(csv.stream, ",%s", curves.name[k]);
    for (PetscInt m = 0; m < rows; m++) {
      for (PetscInt a = 0; a < s->dim; a++) fprintf(csv.stream, "%s%.17g", a ? "," : "\n", curves.beta[s->dim * m + a]);
      for (PetscInt k = 0; k < curves.n; k++) MpmTextFileCell(&csv, curves.at[k][m]);
    }
    fprintf(csv.stream, "\n");
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscCall(FreeCurves(&curves));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define ROUNDING 1e-12 /* decay of less per unit of time h / c is rounding */
#define STANDS -1      /* the error of the frequency of a wave that does not travel */

/* Of waves 1, 2, 4, 8, ... the table has a row. */
static PetscBool IsShown(PetscInt w)
{
  return ((w + 1) & w) == 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* Prints a row for each wave. unit: what decay is multiplied by, with a column for it; 0: none. */
static void PrintStep(const MpmDamping *d, PetscInt i, PetscReal unit)
{
  for (PetscInt w = 0; w < d->nwaves; w++) {
    const PetscInt  at    = d->nwaves * i + w;
    const PetscReal decay = fabs(d->decay[at]) < ROUNDING ? 0 : d->decay[at];

    if (!IsShown(w)) continue;
    MpmPrint("  %-10.6g  %-9.6g  %12.5g", d->courant[i], d->wavelength[w], decay);
    if (unit > 0) MpmPrint("  %12.5g", decay * unit);
    MpmPrint("  %13.6g", exp(-decay * d->wavelength[w]));
    if (isnan(d->frequency[at]))
      MpmPrint("  %15s", "not known");
    else if (fabs(d->frequency[at] - STANDS) < ROUNDING)
      MpmPrint("  %15s", "does not travel");
    else
      MpmPrint("  %+15.5g", d->frequency[at]);
    MpmPrint("  %7.4f\n", d->match[at]);
  }
}

/* Keeps a list for each time step. */
static void Rows(json_t *result, const char name[], const MpmDamping *d, const PetscReal values[], PetscReal unit)
{
  for (PetscInt i = 0; i < d->nsteps; i++) {
    json_t *row = json_array();

    for (const PetscReal *v = values + d->nwaves * i; v < values + d->nwaves * (i + 1); v++)
      (void)json_array_append_new(row, isfinite(*v) ? json_real(*v * unit) : json_null());
    (void)json_array_append_new(MpmResultList(result, name), row);
  }
}

static void Damping(json_t *result, const MpmScene *scene, const MpmDamping *d)
{
  const PetscReal unit = MpmSceneIsPhysical(scene) ? scene->wave_speed / scene->cell_width : 0;

  MpmPrint(
      "\ndamping of waves along x, of the mode of each that is nearest to the exact wave travelling to the right\n");
  MpmPrint("  %-10s  %-9s  %12s", "courant", "cells", "decay c/h");
  if (unit > 0) MpmPrint("  %12s", "decay 1/time");
  MpmPrint("  %13s  %15s  %7s\n", "kept a period", "frequency error", "match");
  for (PetscInt i = 0; i < d->nsteps; i++) PrintStep(d, i, unit);
  MpmPrint("\n");
  MpmResultNumbers(result, "wavelength", d->nwaves, d->wavelength);
  MpmResultNumbers(result, "courant", d->nsteps, d->courant);
  Rows(result, "decay", d, d->decay, 1);
  if (unit > 0) Rows(result, "decay_per_time", d, d->decay, unit);
  Rows(result, "frequency_error", d, d->frequency, 1);
  Rows(result, "match", d, d->match, 1);
  MpmResultKeep(result, "%g{seconds}", d->seconds);
}

static PetscErrorCode WriteDampingCsv(const MpmDamping *d, const char path[])
{
  MpmTextFile csv;

  PetscFunctionBegin;
  PetscCall(MpmTextFileOpen(path, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "courant,wavelength,decay,kept_a_period,frequency_error,match\n");
    for (PetscInt i = 0; i < d->nsteps * d->nwaves; i++) {
      const PetscReal cells = d->wavelength[i % d->nwaves];

      fprintf(csv.stream, "%.17g", d->courant[i / d->nwaves]);
      MpmTextFileCell(&csv, cells);
      MpmTextFileCell(&csv, d->decay[i]);
      MpmTextFileCell(&csv, exp(-d->decay[i] * cells));
      MpmTextFileCell(&csv, d->frequency[i]);
      MpmTextFileCell(&csv, d->match[i]);
      fprintf(csv.stream, "\n");
    }
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteDamping(const MpmDamping *d, MpmDataFile *file)
{
  PetscFunctionBegin;
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_wavelength", d->nwaves, 1, d->wavelength));
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_courant", d->nsteps, 1, d->courant));
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_decay", d->nsteps, d->nwaves, d->decay));
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_frequency_error", d->nsteps, d->nwaves, d->frequency));
  PetscCall(MpmDataFileArray(file, "/symbol", "damping_match", d->nsteps, d->nwaves, d->match));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the task ---- */

/*
   What is found. Of a scene: refined and damping are NULL where they are not asked for. Of blocks: the phase of largest
   growth at the phases of the symbol or between them; program, and other, which are the blocks with another size of
   perturbations, of a code that is probed; compare if asked for; certificates of a file; motion of a code that is set to
   the places of a drift, where n is not 0.
*/
typedef struct {
  MpmSymbol *symbol;
  MpmFinding finding;

  MpmRefined     place, *refined;
  MpmDamping    *damping;
  MpmPredictor   predictor;
  MpmPredictions predictions;
  MpmComparison  comparison;

  MpmProgram        program;
  MpmBlocks         blocks, other;
  MpmCertificates   certificates;
  PetscReal         beta[MPM_MAX_DIM];
  MpmSourceGrowth   worst;
  PetscReal         worst_uncertainty;
  MpmCompareProgram compare;
  MpmMotion         motion;
} Answer;

/* Where growth is largest: the phase, and the length of its waves in cells. */
static void Maximum(json_t *result, const MpmSymbol *s, const char layout[])
{
  PetscReal size = 0;
  char      text[MPM_COUNTS_TEXT + 256], waves[48] = "";

  for (PetscInt a = 0; a < s->dim; a++)
    size = hypot(size, PetscMin(s->beta_at_max[a], 2 * PETSC_PI - s->beta_at_max[a]));
  if (size > 0) (void)snprintf(waves, sizeof waves, " (waves of %.4g cells)", 2 * PETSC_PI / size);
  (void)snprintf(text, sizeof text, "at beta = %s%s of %s phases; %s",
                 size > 0 ? MpmVectorText(s->dim, s->beta_at_max, 6, MPM_VECTOR_ROOM) : "0", waves,
                 MpmCountsText(s->dim, s->phases, MPM_VECTOR_ROOM), layout);
  MpmReportGrowth(result, "predicted.symbol", "symbol", s->growth, text);
  MpmResultSymbol(result, s);
}

/* The phases that refined growth has looked at, and where growth is largest. */
static void Refined(json_t *result, PetscInt dim, const MpmRefined *r, const char layout[])
{
  const PetscBool none = isnan(r->beta[0]) ? PETSC_TRUE : PETSC_FALSE;
  char            text[MPM_COUNTS_TEXT + 256];

  (void)snprintf(text, sizeof text, "at %s%s of up to %" PetscInt_FMT " phases in (0, pi] and uphill%s; %s",
                 none ? "none" : "beta = ", none ? "" : MpmVectorText(dim, r->beta, 6, MPM_VECTOR_ROOM), r->points,
                 r->settled ? "" : ", and still moves", layout);
  MpmReportGrowth(result, "growth", "refined", r->growth, text);
  if (!none) MpmResultNumbers(result, "beta_at_max", dim, r->beta);
  MpmResultKeep(result, "%" PetscInt_FMT "{phases} %d{settled?}", r->points, r->settled);
}

static PetscErrorCode Report(const MpmScene *scene, const MpmRequest *request, const Answer *a, PetscReal wall_s)
{
  json_t *result;
  char    layout[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmResultOfScene(scene, request, &result));
  MpmPrint("\ngrowth per step\n");
  MpmReportPredictions(result, &a->predictor, &a->predictions);
  PetscCall(MpmReportLayout(scene, request, sizeof layout, layout));
  Maximum(result, a->symbol, layout);
  if (scene->written && !MpmSceneDrifts(scene)) PetscCall(MpmReportNodal(scene->scheme.table, "  nodal       "));
  if (a->refined) Refined(MpmResultIn(result, "refined"), scene->layout.dim, a->refined, layout);
  MpmPrint("\n");
  MpmReportComparison(result, &a->predictor, &a->comparison);
  if (a->damping) Damping(MpmResultIn(MpmResultIn(result, "symbol"), "damping"), scene, a->damping);
  PetscCall(MpmReportFinding(result, scene, request, &a->finding, a->symbol->condition));
  MpmPrint("time: %.3g s\n", a->symbol->seconds);
  PetscCall(MpmResultEnd(request, wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteFiles(const MpmScene *scene, const MpmRequest *request, const Answer *a)
{
  const MpmPredictor *predictor = scene ? &a->predictor : NULL;
  MpmBlocks           blocks    = a->blocks;
  MpmDataFile         file;

  PetscFunctionBegin;
  if (request->csv[0] && a->damping) PetscCall(WriteDampingCsv(a->damping, request->csv));
  if (request->csv[0] && !a->damping) PetscCall(WriteSymbolCsv(a->symbol, predictor, request->csv));
  if (request->write_blocks[0]) {
    if (scene) { /* of its lattice, of which its cells are a part */
      PetscCall(
          MpmTableBlocks(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, "write_blocks", &blocks));
      blocks.cell_width = scene->cell_width;
    }
    PetscCall(MpmBlocksWrite(request->write_blocks, &blocks));
    if (scene) PetscCall(MpmBlocksFree(&blocks));
  }
  if (!request->output[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmDataFileOpen(PETSC_COMM_WORLD, scene, request, &file));
  PetscCall(MpmSymbolWrite(a->symbol, predictor, &file));
  if (a->damping) PetscCall(WriteDamping(a->damping, &file));
  PetscCall(MpmDataFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the symbol says of growth, at its phases or at those of the refined search. */
static PetscErrorCode Find(const MpmScene *scene, const MpmRequest *request, Answer *a)
{
  const MpmSymbol *s                       = a->symbol;
  char             phases[MPM_VECTOR_TEXT] = "";

  PetscFunctionBegin;
  a->finding = (MpmFinding){.tolerance       = request->tolerance,
                            .growth          = s->growth,
                            .uncertainty     = s->uncertainty,
                            .defective_error = s->defective_error};
  (void)MpmCountsText(s->dim, s->phases, phases);
  (void)snprintf(a->finding.evidence, sizeof a->finding.evidence,
                 "the symbol at %s phases, the whole spectrum of %s cells", phases, phases);
  a->finding.verdict = MpmVerdictOf(&a->finding);
  if (request->refine) {
    a->refined = &a->place;
    PetscCall(MpmRefinedGrowth(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, PETSC_TRUE, a->refined));
    if (a->refined->growth > s->growth) PetscCall(MpmRefinedFinding(a->refined, request->tolerance, &a->finding));
  }
  for (PetscInt d = 0; d < s->dim; d++)
    PetscCall(MpmFindingOfPhases(&a->finding, s->phases[d], scene->layout.grid[d].cells));
  if (MpmPredictDisagrees(&a->comparison, s->growth))
    PetscCall(MpmFindingDispute(&a->finding, "the corrected closed form says otherwise"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OfScene(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmSymbolWish wish = {.keep = request->output[0] ? PETSC_TRUE : PETSC_FALSE, .tolerance = request->tolerance};
  Answer        a    = {.refined = NULL};

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(wish.phases, request->phases, scene->layout.dim));
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &wish, &a.symbol));
  PetscCall(MpmPredict(scene, &a.predictions));
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, MpmSceneDrifts(scene), NULL, &a.predictor));
  PetscCall(MpmPredictCompare(PETSC_COMM_WORLD, &a.predictor, a.symbol, &a.comparison));
  PetscCall(Find(scene, request, &a));
  if (request->damping) PetscCall(MpmDampingCreate(scene, request, &a.damping));
  PetscCall(WriteFiles(scene, request, &a));
  PetscCall(Report(scene, request, &a, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&request->expect, a.finding.verdict, a.finding.growth, missed));
  PetscCall(MpmDampingDestroy(&a.damping));
  PetscCall(MpmPredictorDestroy(&a.predictor));
  PetscCall(MpmSymbolDestroy(&a.symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- blocks from a file, or of a code that is probed: growth between phases where it is largest, too ---- */

#define GAINS 1e-12 /* relative; growth between phases that is larger by less is rounding */

/* The blocks, or the product of those of a period, with either size of perturbations. */
static PetscErrorCode SourceOf(const MpmRequest *request, const Answer *a, PetscBool other, MpmBlocksSteps *steps,
                               MpmSource *source)
{
  const char *name = MpmRequestSource(request);

  PetscFunctionBegin;
  if (a->motion.n)
    PetscCall(MpmMotionSource(&a->motion, other, name, steps, source));
  else
    PetscCall(MpmBlocksSource(other ? &a->other : &a->blocks, name, source));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes the phase of the symbol where the search between its phases has found no larger growth. */
static PetscErrorCode Compare(Answer *a)
{
  const MpmSymbol *s = a->symbol;

  PetscFunctionBegin;
  a->worst_uncertainty = MpmUncertaintyOf(a->worst.growth, a->worst.relative, a->symbol->period);
  if (a->worst.growth > s->growth * (1 + GAINS)) PetscFunctionReturn(PETSC_SUCCESS);
  a->worst.growth      = s->growth;
  a->worst.condition   = s->condition;
  a->worst_uncertainty = s->uncertainty;
  PetscCall(PetscArraycpy(a->beta, s->beta_at_max, a->blocks.dim));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Judge(const MpmRequest *request, Answer *a)
{
  MpmFinding *f = &a->finding;

  PetscFunctionBegin;
  *f = (MpmFinding){.tolerance       = request->tolerance,
                    .growth          = a->worst.growth,
                    .uncertainty     = a->worst_uncertainty,
                    .defective_error = a->symbol->defective_error};
  (void)snprintf(f->evidence, sizeof f->evidence,
                 "the symbol at %s phases, and a search between them from where growth is largest",
                 MpmCountsText(a->blocks.dim, a->symbol->phases, MPM_VECTOR_ROOM));
  f->verdict = MpmVerdictOf(f);
  if (MpmRequestProbes(request)) {
    MpmSource       source;
    MpmBlocksSteps  steps;
    MpmSourceGrowth other;

    PetscCall(SourceOf(request, a, PETSC_TRUE, &steps, &source));
    PetscCall(MpmSourceGrowthAt(&source, a->beta, &other));
    PetscCall(MpmProgramJudge(&a->program, other.growth, a->worst.condition, f));
  } else if (MpmCertificatesTaken(&a->certificates))
    PetscCall(MpmCertificatesJudge(&a->certificates, NULL, a->worst.condition, a->blocks.period, f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Blocks from the file, or by probing. */
static PetscErrorCode GetBlocks(const MpmRequest *request, Answer *a)
{
  MpmProbed one, other;

  PetscFunctionBegin;
  if (!MpmRequestProbes(request)) {
    PetscCall(MpmBlocksRead(PETSC_COMM_WORLD, request->matrix_blocks, request->matrix_steps, request->tolerance,
                            &a->certificates, &a->blocks));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmProgramOpen(request, &a->program));
  PetscCall(MpmProgramPrepare(&a->program));
  if (request->compare[0]) PetscCall(MpmCompareProgramBegin(&a->program, &a->compare));
  if (request->program_drift[0].den) {
    PetscCall(MpmMotionBegin(&a->program, &a->motion));
    MpmReportProgram(&a->program);
    MpmPrint("  all this at each of %" PetscInt_FMT " places of the drift\n", a->motion.n);
    PetscCall(MpmMotionFind(&a->program, &a->motion));
    a->blocks = a->motion.blocks[0][0];
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  MpmReportProgram(&a->program);
  PetscCall(MpmProgramOperator(&a->program, &one, &other));
  a->blocks = one.blocks;
  a->other  = other.blocks;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Compute(const MpmRequest *request, Answer *a)
{
  const MPI_Comm comm = PETSC_COMM_WORLD;
  MpmSymbolWish  wish = {.keep = request->output[0] ? PETSC_TRUE : PETSC_FALSE, .tolerance = request->tolerance};
  MpmBlocksSteps steps;
  MpmSource      source;

  PetscFunctionBegin;
  PetscCall(GetBlocks(request, a));
  PetscCall(SourceOf(request, a, PETSC_FALSE, &steps, &source));
  PetscCall(MpmRequestPhases(request, source.dim, wish.phases));
  PetscCall(MpmSymbolFromSource(comm, &source, &wish, &a->symbol));
  PetscCall(MpmWorstPhase(comm, &source, a->symbol->phases, a->beta, &a->worst));
  PetscCall(Compare(a));
  PetscCall(Judge(request, a));
  if (request->compare[0]) PetscCall(MpmCompareProgramFind(&a->program, &a->blocks, a->worst.growth, &a->compare));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReportBlocks(const MpmRequest *request, Answer *a, PetscReal wall_s)
{
  const PetscBool  probed = MpmRequestProbes(request);
  const MpmBlocks *b      = &a->blocks;
  char             text[256];
  json_t          *result;
  MpmKinks         kinks;

  PetscFunctionBegin;
  PetscCall(MpmResultOfFile(request, probed ? NULL : "the blocks", &result));
  if (probed)
    MpmReportProbed(result, &a->program);
  else if (MpmCertificatesTaken(&a->certificates))
    MpmReportCertificates(result, &a->certificates);
  if (a->motion.n) MpmReportMotion(MpmResultIn(result, "motion"), b->dim, &a->motion);
  MpmResultSay(MpmResultIn(result, "lattice"),
               "%" PetscInt_FMT "{blocks} blocks of %" PetscInt_FMT "{unknowns} unknowns a cell, %" PetscInt_FMT
               "{dim} direction%s, of %" PetscInt_FMT "{period_steps} step%s\n\ngrowth per step\n",
               b->n, b->size, b->dim, b->dim == 1 ? "" : "s", a->symbol->period, a->symbol->period == 1 ? "" : "s");
  if (b->cell_width > 0) MpmResultKeep(result, "%g{lattice.cell_width}", b->cell_width);
  (void)snprintf(text, sizeof text, "at beta = %s of %s phases",
                 MpmVectorText(b->dim, a->symbol->beta_at_max, 6, MPM_VECTOR_ROOM),
                 MpmCountsText(b->dim, a->symbol->phases, MPM_VECTOR_ROOM));
  MpmReportGrowth(NULL, NULL, "symbol", a->symbol->growth, text);
  MpmResultSymbol(result, a->symbol);
  (void)snprintf(text, sizeof text, "at beta = %s, the largest of a search between these phases",
                 MpmVectorText(b->dim, a->beta, 6, MPM_VECTOR_ROOM));
  MpmReportGrowth(NULL, NULL, "all waves", a->worst.growth, text);
  MpmResultKeep(MpmResultIn(result, "refined"), "%g{growth} %g{condition}", a->worst.growth, a->worst.condition);
  MpmResultVector(result, "refined.beta_at_max", b->dim, a->beta);
  if (request->compare[0]) MpmReportCompare(MpmResultIn(result, "comparison"), &a->program, &a->compare);
  MpmPrint("\n");
  PetscCall(MpmReportFinding(result, NULL, NULL, &a->finding, a->worst.condition));
  if (probed && !a->motion.n && MpmCertificatesSwitch(&a->program.certificates)) {
    PetscCall(MpmKinksFind(&a->program, &kinks));
    MpmReportKinks(result, &kinks);
  }
  MpmPrint("time: %.3g s\n", a->symbol->seconds);
  PetscCall(MpmResultEnd(request, wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode OfBlocks(const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  Answer answer = {.symbol = NULL};

  PetscFunctionBegin;
  PetscCall(Compute(request, &answer));
  PetscCall(WriteFiles(NULL, request, &answer));
  PetscCall(ReportBlocks(request, &answer, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&request->expect, answer.finding.verdict, answer.finding.growth, missed));
  PetscCall(MpmSymbolDestroy(&answer.symbol));
  if (answer.motion.n)
    PetscCall(MpmMotionDestroy(&answer.motion));
  else
    PetscCall(MpmBlocksFree(&answer.blocks));
  if (MpmRequestProbes(request)) {
    PetscCall(MpmBlocksFree(&answer.other));
    if (request->compare[0]) PetscCall(MpmCompareProgramDestroy(&answer.compare));
    PetscCall(MpmProgramClose(&answer.program));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskSymbol(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  return scene ? OfScene(scene, request, started, missed) : OfBlocks(request, started, missed);
}
