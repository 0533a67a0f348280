/*
   The task symbol: mpmstab symbol [SCENE.yaml | -matrix_blocks FILE | -program COMMAND | -plugin FILE]
   [-option value]...
*/
#include "analysis/damping.h"
#include "base/textfile.h"
#include "io/datafile.h"
#include "io/matrix_file.h"
#include "report/report.h"
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

PetscErrorCode MpmSymbolWriteCsv(const MpmSymbol *s, const MpmPredictor *p, const char path[])
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

/* What is said of a scene. refined, damping: NULL where they are not asked for. */
typedef struct {
  MpmSymbol     *symbol;
  MpmRefined     place, *refined;
  MpmDamping    *damping;
  MpmPredictor   predictor;
  MpmPredictions predictions;
  MpmComparison  comparison;
  MpmFinding     finding;
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
  MpmDataFile file;

  PetscFunctionBegin;
  if (request->csv[0] && a->damping) PetscCall(WriteDampingCsv(a->damping, request->csv));
  if (request->csv[0] && !a->damping) PetscCall(MpmSymbolWriteCsv(a->symbol, &a->predictor, request->csv));
  if (!request->output[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmDataFileOpen(PETSC_COMM_WORLD, scene, request, &file));
  PetscCall(MpmSymbolWrite(a->symbol, &a->predictor, &file));
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

/* Writes the blocks of a scene's lattice, of which its cells are a part. */
static PetscErrorCode WriteBlocks(const MpmScene *scene, const char path[])
{
  MpmBlocks blocks;

  PetscFunctionBegin;
  PetscCall(MpmTableBlocks(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, "write_blocks", &blocks));
  blocks.cell_width = scene->cell_width;
  PetscCall(MpmBlocksWrite(path, &blocks));
  PetscCall(MpmBlocksFree(&blocks));
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
  if (request->write_blocks[0]) PetscCall(WriteBlocks(scene, request->write_blocks));
  PetscCall(Report(scene, request, &a, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&request->expect, &a.finding, missed));
  PetscCall(MpmDampingDestroy(&a.damping));
  PetscCall(MpmPredictorDestroy(&a.predictor));
  PetscCall(MpmSymbolDestroy(&a.symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskSymbol(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  return scene ? OfScene(scene, request, started, missed) : MpmSymbolOfBlocks(request, started, missed);
}
