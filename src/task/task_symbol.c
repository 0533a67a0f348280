/* The task symbol: mpmstab symbol [SCENE.yaml | -matrix_blocks FILE | -program COMMAND | -plugin FILE] [-option value]... */
#include "task/expect.h"
#include "report/results.h"
#include "io/blocks_file.h"
#include "io/symbol_files.h"
#include "analysis/waves.h"
#include "task/task.h"
#include <math.h>

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
static void Maximum(json_t *result, const MpmSymbol *s)
{
  PetscReal size = 0;
  char      text[256], waves[48] = "";

  for (PetscInt a = 0; a < s->dim; a++)
    size = hypot(size, PetscMin(s->beta_at_max[a], 2 * PETSC_PI - s->beta_at_max[a]));
  if (size > 0) (void)snprintf(waves, sizeof waves, " (waves of %.4g cells)", 2 * PETSC_PI / size);
  (void)snprintf(text, sizeof text, "at beta = %s%s of %s phases",
                 size > 0 ? MpmVectorText(s->dim, s->beta_at_max, 6, MPM_VECTOR_ROOM) : "0", waves,
                 MpmCountsText(s->dim, s->phases, MPM_VECTOR_ROOM));
  MpmReportGrowth(result, "predicted.symbol", "symbol", s->growth, text);
  MpmResultSymbol(result, s);
}

/* The phases that refined growth has looked at, and where growth is largest. */
static void Refined(json_t *result, PetscInt dim, const MpmRefined *r)
{
  const PetscBool none = isnan(r->beta[0]) ? PETSC_TRUE : PETSC_FALSE;
  char            text[256];

  (void)snprintf(text, sizeof text, "at %s%s of up to %" PetscInt_FMT " phases in (0, pi] and uphill%s",
                 none ? "none" : "beta = ", none ? "" : MpmVectorText(dim, r->beta, 6, MPM_VECTOR_ROOM), r->points,
                 r->settled ? "" : ", and still moves");
  MpmReportGrowth(result, "growth", "refined", r->growth, text);
  if (!none) MpmResultNumbers(result, "beta_at_max", dim, r->beta);
  MpmResultKeep(result, "%" PetscInt_FMT "{phases} %d{settled?}", r->points, r->settled);
}

static PetscErrorCode Report(const MpmScene *scene, const MpmRequest *request, const Answer *a, PetscReal wall_s)
{
  json_t *result;

  PetscFunctionBegin;
  PetscCall(MpmResultOfScene(scene, request, &result));
  MpmPrint("\ngrowth per step\n");
  MpmReportPredictions(result, &a->predictor, &a->predictions);
  Maximum(result, a->symbol);
  if (scene->written && !MpmSceneDrifts(scene)) PetscCall(MpmReportNodal(scene->scheme.table, "  nodal       "));
  if (a->refined) Refined(MpmResultIn(result, "refined"), scene->layout.dim, a->refined);
  MpmPrint("\n");
  MpmReportComparison(result, &a->predictor, &a->comparison);
  if (a->damping) MpmDampingReport(MpmResultIn(MpmResultIn(result, "symbol"), "damping"), scene, a->damping);
  MpmReportFinding(result, &a->finding, a->symbol->condition);
  MpmPrint("time: %.3g s\n", a->symbol->seconds);
  PetscCall(MpmResultEnd(request, wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteFiles(const MpmScene *scene, const MpmRequest *request, const Answer *a)
{
  MpmDataFile file;

  PetscFunctionBegin;
  if (request->csv[0] && a->damping) PetscCall(MpmDampingWriteCsv(a->damping, request->csv));
  if (request->csv[0] && !a->damping) PetscCall(MpmSymbolWriteCsv(a->symbol, &a->predictor, request->csv));
  if (!request->output[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmDataFileOpen(PETSC_COMM_WORLD, scene, request, &file));
  PetscCall(MpmSymbolWrite(a->symbol, &a->predictor, &file));
  if (a->damping) PetscCall(MpmDampingWrite(a->damping, &file));
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
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, MpmSceneDrifts(scene), &a.predictor));
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
