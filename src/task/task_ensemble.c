/* The task ensemble: mpmstab ensemble [SCENE.yaml] [-option value]... The share of unstable layouts. */
#include "analysis/ensemble.h"
#include "base/textfile.h"
#include "report/report.h"
#include "task/task.h"
#include <math.h>

static void PrintVerdict(const MpmEnsemble *e, const char layout[])
{
  MpmPrint("\nverdict: %s", MpmVerdictNames[e->finding.verdict]);
  if (e->unstable)
    MpmPrint(", %" PetscInt_FMT " of %" PetscInt_FMT " layouts grow beyond 1 + %.6g", e->unstable, e->n,
             e->request->tolerance);
  else if (e->undecided)
    MpmPrint(", rounding or the solver leaves %" PetscInt_FMT " of %" PetscInt_FMT " layouts open", e->undecided, e->n);
  else
    MpmPrint(", none of %" PetscInt_FMT " layouts grows; of all there are at most %.4g%% do, with 95%% confidence",
             e->n, 100 * e->interval[1]);
  MpmPrint("; %s\nevidence: %s\n", layout, e->finding.evidence);
}

static PetscErrorCode Report(const MpmEnsemble *e, PetscReal wall_s)
{
  json_t *result, *found;
  char    layout[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmResultOfScene(e->scene, e->request, &result));
  PetscCall(MpmReportLayout(e->scene, e->request, sizeof layout, layout));
  found = MpmResultIn(result, "ensemble");
  MpmResultFinding(result, &e->finding);
  MpmResultKeep(found, "%g{share} %g{tolerance} %g{seconds}", e->share, e->request->tolerance, e->seconds);
  MpmResultNumbers(found, "interval", 2, e->interval);
  MpmResultSay(found, "\nlayouts    %" PetscInt_FMT "{layouts}, seeds %" PetscInt64_FMT " to %" PetscInt64_FMT "\n",
               e->n, e->scene->layout.seed, e->scene->layout.seed + e->n - 1);
  MpmResultSay(found, "unstable   %" PetscInt_FMT "{unstable}\nundecided  %" PetscInt_FMT "{undecided}\n", e->unstable,
               e->undecided);
  MpmPrint("share      %.4g%%, with 95%% confidence from %.4g%% to %.4g%% (Wilson); %s\n", 100 * e->share,
           100 * e->interval[0], 100 * e->interval[1], layout);
  if (isnan(e->growth_max))
    MpmPrint("growth     of no layout is known\n");
  else
    MpmResultSay(found,
                 "growth     per step: smallest %.9g{growth_min}, median %.9g{growth_median}, largest %.9g{growth_max} "
                 "(-seed %" PetscInt64_FMT "{worst_seed})\n",
                 e->growth_min, e->growth_median, e->growth_max, e->worst_seed);
  PrintVerdict(e, layout);
  MpmPrint("time: %.3g s\n", e->seconds);
  PetscCall(MpmResultEnd(e->request, wall_s, &result));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteCsv(const MpmEnsemble *e)
{
  MpmTextFile csv;

  PetscFunctionBegin;
  PetscCall(MpmTextFileOpen(e->request->csv, &csv));
  if (csv.stream) {
    fprintf(csv.stream, "seed,growth,verdict\n");
    for (PetscInt i = 0; i < e->n; i++) {
      fprintf(csv.stream, "%" PetscInt64_FMT, e->scene->layout.seed + i);
      MpmTextFileCell(&csv, e->growth[i]);
      fprintf(csv.stream, ",%s\n", MpmVerdictNames[e->verdict[i]]);
    }
  }
  PetscCall(MpmTextFileClose(&csv));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTaskEnsemble(const MpmScene *scene, const MpmRequest *request, PetscReal started, PetscInt *missed)
{
  MpmEnsemble *ensemble;

  PetscFunctionBegin;
  PetscCall(MpmEnsembleCreate(scene, request, &ensemble));
  if (request->csv[0]) PetscCall(WriteCsv(ensemble));
  PetscCall(Report(ensemble, MPI_Wtime() - started));
  PetscCall(MpmExpectFinding(&request->expect, ensemble->finding.verdict, ensemble->share, missed));
  PetscCall(MpmEnsembleDestroy(&ensemble));
  PetscFunctionReturn(PETSC_SUCCESS);
}
