/* The task symbol: mpmstab symbol [SCENE.yaml] [-option value]... */
#include "task/expect.h"
#include "report/report.h"
#include "io/symbol_files.h"
#include "task/task.h"
#include <math.h>

static PetscErrorCode Print(const MpmScene *scene, const MpmRequest *request, const MpmSymbol *s, const MpmPredictor *p,
                            const MpmPredictions *predictions, const MpmComparison *comparison,
                            const MpmFinding *finding, PetscMPIInt ranks)
{
  char text[128];

  PetscFunctionBegin;
  PetscCall(MpmReportScene(scene, request, ranks));
  MpmPrint("\ngrowth per step\n");
  PetscCall(MpmReportPredictions(p, predictions));
  PetscCall(PetscSNPrintf(text, sizeof text, "at beta = %.6g (waves of %.4g cells) of %" PetscInt_FMT " phases",
                          s->beta_at_max, 2 * PETSC_PI / s->beta_at_max, s->phases));
  if (s->beta_at_max == 0)
    PetscCall(PetscSNPrintf(text, sizeof text, "at beta = 0 of %" PetscInt_FMT " phases", s->phases));
  PetscCall(MpmReportGrowth("symbol", s->growth, text));
  MpmPrint("\n");
  PetscCall(MpmReportComparison(p, comparison));
  PetscCall(MpmReportFinding(finding, s->condition));
  MpmPrint("time: %.3g s\n", s->seconds);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteJson(const char path[], const MpmScene *scene, const MpmSymbol *s,
                                const MpmPredictions *predictions, const MpmComparison *comparison,
                                const MpmFinding *finding, PetscMPIInt ranks, PetscReal wall_s)
{
  json_t *object;

  PetscFunctionBegin;
  PetscCall(MpmJsonScene(scene, "symbol", ranks, wall_s, &object));
  MpmJsonSetFinding(object, finding);
  json_object_set_new(object, "predicted", MpmJsonPredicted(predictions, comparison, s->growth));
  json_object_set_new(object, "symbol", MpmJsonSymbol(s));
  PetscCall(MpmJsonWrite(path, object));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteFiles(const MpmScene *scene, const MpmRequest *request, const MpmSymbol *s,
                                 const MpmPredictor *p)
{
  MpmDataFile file;

  PetscFunctionBegin;
  if (request->csv[0]) PetscCall(MpmSymbolWriteCsv(s, p, request->csv));
  if (!request->output[0]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmDataFileOpen(PETSC_COMM_WORLD, scene, request, &file));
  PetscCall(MpmSymbolWrite(s, p, &file));
  PetscCall(MpmDataFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Run(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  const MpmSymbolWish wish = {.phases    = request->phases,
                              .keep      = request->output[0] ? PETSC_TRUE : PETSC_FALSE,
                              .tolerance = request->tolerance};
  PetscMPIInt         ranks;
  MpmSymbol          *symbol;
  MpmPredictor        predictor;
  MpmPredictions      predictions;
  MpmComparison       comparison;
  MpmFinding          finding = {.tolerance = request->tolerance};

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(MpmSymbolCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &wish, &symbol));
  PetscCall(MpmPredict(scene, &predictions));
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, MpmSceneDrifts(scene), &predictor));
  PetscCall(MpmPredictCompare(PETSC_COMM_WORLD, &predictor, symbol, &comparison));
  finding.growth          = symbol->growth;
  finding.uncertainty     = symbol->uncertainty;
  finding.defective_error = symbol->defective_error;
  finding.verdict         = MpmVerdictOf(&finding);
  PetscCall(PetscSNPrintf(finding.evidence, sizeof finding.evidence,
                          "the symbol at %" PetscInt_FMT " phases, the whole spectrum of %" PetscInt_FMT " cells",
                          symbol->phases, symbol->phases));
  PetscCall(MpmFindingOfPhases(&finding, symbol->phases, scene->layout.grid[0].cells));
  if (MpmPredictDisagrees(&comparison, symbol->growth))
    PetscCall(MpmFindingDispute(&finding, "the corrected closed form says otherwise"));
  PetscCall(WriteFiles(scene, request, symbol, &predictor));
  if (request->json[0])
    PetscCall(
        WriteJson(request->json, scene, symbol, &predictions, &comparison, &finding, ranks, MPI_Wtime() - started));
  PetscCall(Print(scene, request, symbol, &predictor, &predictions, &comparison, &finding, ranks));
  PetscCall(MpmExpectFinding(&request->expect, &finding, missed));
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
