/* The task symbol: mpmstab symbol [SCENE.yaml] [-option value]... */
#include "task/expect.h"
#include "report/report.h"
#include "report/results.h"
#include "io/symbol_files.h"
#include "task/task.h"
#include <math.h>

/* Where growth is largest: the phase, and the length of its waves in cells. */
static PetscErrorCode DescribeMaximum(const MpmSymbol *s, size_t room, char text[])
{
  const PetscInt dim  = s->layout->dim;
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

static PetscErrorCode Print(const MpmScene *scene, const MpmRequest *request, const MpmSymbol *s, const MpmPredictor *p,
                            const MpmPredictions *predictions, const MpmComparison *comparison,
                            const MpmFinding *finding, const MpmDamping *damping, PetscMPIInt ranks)
{
  char text[256];

  PetscFunctionBegin;
  PetscCall(MpmReportScene(scene, request, ranks));
  MpmPrint("\ngrowth per step\n");
  PetscCall(MpmReportPredictions(p, predictions));
  PetscCall(DescribeMaximum(s, sizeof text, text));
  PetscCall(MpmReportGrowth("symbol", s->growth, text));
  MpmPrint("\n");
  PetscCall(MpmReportComparison(p, comparison));
  if (damping) PetscCall(MpmDampingPrint(scene, damping));
  PetscCall(MpmReportFinding(finding, s->condition));
  MpmPrint("time: %.3g s\n", s->seconds);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteJson(const char path[], const MpmScene *scene, const MpmSymbol *s,
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

static PetscErrorCode Run(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  const PetscInt dim  = scene->layout.dim;
  MpmSymbolWish  wish = {.keep = request->output[0] ? PETSC_TRUE : PETSC_FALSE, .tolerance = request->tolerance};
  PetscMPIInt    ranks;
  MpmSymbol     *symbol;
  MpmDamping    *damping = NULL;
  MpmPredictor   predictor;
  MpmPredictions predictions;
  MpmComparison  comparison;
  MpmFinding     finding = {.tolerance = request->tolerance};
  char           phases[64];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++) wish.phases[a] = request->phases[a];
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &wish, &symbol));
  PetscCall(MpmPredict(scene, &predictions));
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, MpmSceneDrifts(scene), &predictor));
  PetscCall(MpmPredictCompare(PETSC_COMM_WORLD, &predictor, symbol, &comparison));
  finding.growth          = symbol->growth;
  finding.uncertainty     = symbol->uncertainty;
  finding.defective_error = symbol->defective_error;
  finding.verdict         = MpmVerdictOf(&finding);
  PetscCall(MpmReportCounts(dim, symbol->phases, sizeof phases, phases));
  PetscCall(PetscSNPrintf(finding.evidence, sizeof finding.evidence,
                          "the symbol at %s phases, the whole spectrum of %s cells", phases, phases));
  for (PetscInt a = 0; a < dim; a++)
    PetscCall(MpmFindingOfPhases(&finding, symbol->phases[a], scene->layout.grid[a].cells));
  if (MpmPredictDisagrees(&comparison, symbol->growth))
    PetscCall(MpmFindingDispute(&finding, "the corrected closed form says otherwise"));
  if (request->damping) PetscCall(MpmDampingCreate(scene, request, &damping));
  PetscCall(WriteFiles(scene, request, symbol, &predictor, damping));
  if (request->json[0])
    PetscCall(WriteJson(request->json, scene, symbol, &predictions, &comparison, &finding, damping, ranks,
                        MPI_Wtime() - started));
  PetscCall(Print(scene, request, symbol, &predictor, &predictions, &comparison, &finding, damping, ranks));
  PetscCall(MpmExpectFinding(&request->expect, &finding, missed));
  PetscCall(MpmDampingDestroy(&damping));
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskSymbol(int argc, char **argv, PetscReal started, int *status)
{
  PetscFunctionBegin;
  PetscCall(MpmTaskOnScene("symbol", Run, argc, argv, started, status));
  PetscFunctionReturn(PETSC_SUCCESS);
}
