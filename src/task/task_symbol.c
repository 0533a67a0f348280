/* The task symbol: mpmstab symbol [SCENE.yaml | -matrix_blocks FILE | -program COMMAND | -plugin FILE] [-option value]... */
#include "task/expect.h"
#include "report/report.h"
#include "report/results.h"
#include "io/blocks_file.h"
#include "io/symbol_files.h"
#include "analysis/refined.h"
#include "task/symbol_blocks.h"
#include "task/task.h"
#include <math.h>

/* Where growth is largest: the phase, and the length of its waves in cells. */
static PetscErrorCode DescribeMaximum(const MpmSymbol *s, size_t room, char text[])
{
  const PetscInt dim  = s->dim;
  PetscReal      size = 0;
  char           beta[96], phases[64];

  PetscFunctionBegin;
  PetscCall(MpmReportVector(dim, s->beta_at_max, 6, sizeof beta, beta));
  PetscCall(MpmReportCounts(dim, s->phases, sizeof phases, phases));
  for (PetscInt a = 0; a < dim; a++) size = hypot(size, PetscMin(s->beta_at_max[a], 2 * PETSC_PI - s->beta_at_max[a]));
  if (size > 0)
    PetscCall(PetscSNPrintf(text, room, "at beta = %s (waves of %.4g cells) of %s phases", beta, 2 * PETSC_PI / size,
                            phases));
  else
    PetscCall(PetscSNPrintf(text, room, "at beta = 0 of %s phases", phases));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The phases that refined growth has looked at, and where growth is largest. */
static PetscErrorCode DescribeRefined(PetscInt dim, const MpmRefined *r, size_t room, char text[])
{
  char beta[96], grid[64];

  PetscFunctionBegin;
  PetscCall(MpmReportVector(dim, r->beta, 6, sizeof beta, beta));
  PetscCall(PetscSNPrintf(grid, sizeof grid, "up to %" PetscInt_FMT " phases in (0, pi] and uphill%s", r->points,
                          r->settled ? "" : ", and still moves"));
  if (isnan(r->beta[0]))
    PetscCall(PetscSNPrintf(text, room, "at none of %s", grid));
  else
    PetscCall(PetscSNPrintf(text, room, "at beta = %s of %s", beta, grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode PrintRefined(PetscInt dim, const MpmRefined *r)
{
  char text[256];

  PetscFunctionBegin;
  if (!r) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(DescribeRefined(dim, r, sizeof text, text));
  PetscCall(MpmReportGrowth("refined", r->growth, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Print(const MpmScene *scene, const MpmRequest *request, const MpmSymbol *s, const MpmRefined *r,
                            const MpmPredictor *p, const MpmPredictions *predictions, const MpmComparison *comparison,
                            const MpmFinding *finding, const MpmDamping *damping, PetscMPIInt ranks)
{
  char text[256];

  PetscFunctionBegin;
  PetscCall(MpmReportScene(scene, request, ranks));
  MpmPrint("\ngrowth per step\n");
  PetscCall(MpmReportPredictions(p, predictions));
  PetscCall(DescribeMaximum(s, sizeof text, text));
  PetscCall(MpmReportGrowth("symbol", s->growth, text));
  if (scene->written && !MpmSceneDrifts(scene)) PetscCall(MpmReportNodal(scene->scheme.table, "  nodal       "));
  PetscCall(PrintRefined(scene->layout.dim, r));
  MpmPrint("\n");
  PetscCall(MpmReportComparison(p, comparison));
  if (damping) PetscCall(MpmDampingPrint(scene, damping));
  PetscCall(MpmReportFinding(finding, s->condition));
  MpmPrint("time: %.3g s\n", s->seconds);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static json_t *JsonRefined(PetscInt dim, const MpmRefined *r)
{
  json_t *object = json_object(), *beta = json_array();

  MpmJsonSet(object, "growth", r->growth);
  for (PetscInt a = 0; a < dim; a++) json_array_append_new(beta, json_real(r->beta[a]));
  if (isnan(r->beta[0]))
    json_decref(beta);
  else
    json_object_set_new(object, "beta_at_max", beta);
  json_object_set_new(object, "phases", json_integer(r->points));
  json_object_set_new(object, "settled", json_boolean(r->settled));
  return object;
}

static PetscErrorCode WriteJson(const char path[], const MpmScene *scene, const MpmSymbol *s, const MpmRefined *r,
                                const MpmPredictions *predictions, const MpmComparison *comparison,
                                const MpmFinding *finding, const MpmDamping *damping, PetscMPIInt ranks,
                                PetscReal wall_s)
{
  json_t *object, *symbol = MpmJsonSymbol(s);

  PetscFunctionBegin;
  PetscCall(MpmJsonScene(scene, "symbol", ranks, wall_s, &object));
  MpmJsonSetFinding(object, finding);
  json_object_set_new(object, "predicted", MpmJsonPredicted(predictions, comparison, s->growth));
  if (damping) json_object_set_new(symbol, "damping", MpmDampingJson(scene, damping));
  json_object_set_new(object, "symbol", symbol);
  if (r) json_object_set_new(object, "refined", JsonRefined(scene->layout.dim, r));
  PetscCall(MpmJsonWrite(path, object));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteFiles(const MpmScene *scene, const MpmRequest *request, const MpmSymbol *s,
                                 const MpmPredictor *p, const MpmDamping *damping)
{
  MpmDataFile file;

  PetscFunctionBegin;
  if (request->csv[0] && damping) PetscCall(MpmDampingWriteCsv(damping, request->csv));
  if (request->csv[0] && !damping) PetscCall(MpmSymbolWriteCsv(s, p, request->csv));
  if (!request->output[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmDataFileOpen(PETSC_COMM_WORLD, scene, request, &file));
  PetscCall(MpmSymbolWrite(s, p, &file));
  if (damping) PetscCall(MpmDampingWrite(damping, &file));
  PetscCall(MpmDataFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the symbol says of growth, at its phases or at those of the refined search. */
static PetscErrorCode Find(const MpmScene *scene, const MpmRequest *request, const MpmSymbol *s, MpmRefined *r,
                           MpmFinding *finding)
{
  char phases[64];

  PetscFunctionBegin;
  *finding = (MpmFinding){.tolerance       = request->tolerance,
                          .growth          = s->growth,
                          .uncertainty     = s->uncertainty,
                          .defective_error = s->defective_error};
  PetscCall(MpmReportCounts(scene->layout.dim, s->phases, sizeof phases, phases));
  PetscCall(PetscSNPrintf(finding->evidence, sizeof finding->evidence,
                          "the symbol at %s phases, the whole spectrum of %s cells", phases, phases));
  finding->verdict = MpmVerdictOf(finding);
  if (!request->refine) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmRefinedGrowth(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, r));
  if (r->growth > s->growth) PetscCall(MpmRefinedFinding(r, request->tolerance, finding));
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
  const PetscInt dim  = scene->layout.dim;
  MpmSymbolWish  wish = {.keep = request->output[0] ? PETSC_TRUE : PETSC_FALSE, .tolerance = request->tolerance};
  PetscMPIInt    ranks;
  MpmSymbol     *symbol;
  MpmDamping    *damping = NULL;
  MpmPredictor   predictor;
  MpmPredictions predictions;
  MpmComparison  comparison;
  MpmFinding     finding;
  MpmRefined     refined, *r = request->refine ? &refined : NULL;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++) wish.phases[a] = request->phases[a];
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &wish, &symbol));
  PetscCall(MpmPredict(scene, &predictions));
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, MpmSceneDrifts(scene), &predictor));
  PetscCall(MpmPredictCompare(PETSC_COMM_WORLD, &predictor, symbol, &comparison));
  PetscCall(Find(scene, request, symbol, &refined, &finding));
  for (PetscInt a = 0; a < dim; a++)
    PetscCall(MpmFindingOfPhases(&finding, symbol->phases[a], scene->layout.grid[a].cells));
  if (MpmPredictDisagrees(&comparison, symbol->growth))
    PetscCall(MpmFindingDispute(&finding, "the corrected closed form says otherwise"));
  if (request->damping) PetscCall(MpmDampingCreate(scene, request, &damping));
  PetscCall(WriteFiles(scene, request, symbol, &predictor, damping));
  if (request->write_blocks[0]) PetscCall(WriteBlocks(scene, request->write_blocks));
  if (request->json[0])
    PetscCall(WriteJson(request->json, scene, symbol, r, &predictions, &comparison, &finding, damping, ranks,
                        MPI_Wtime() - started));
  PetscCall(Print(scene, request, symbol, r, &predictor, &predictions, &comparison, &finding, damping, ranks));
  PetscCall(MpmExpectFinding(&request->expect, &finding, missed));
  PetscCall(MpmDampingDestroy(&damping));
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Run(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  PetscFunctionBegin;
  PetscCall(scene ? OfScene(scene, request, started, missed) : MpmSymbolOfBlocks(request, started, missed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskSymbol(int argc, char **argv, PetscReal started, int *status)
{
  PetscFunctionBegin;
  PetscCall(MpmTaskOnScene("symbol", Run, argc, argv, started, status));
  PetscFunctionReturn(PETSC_SUCCESS);
}
