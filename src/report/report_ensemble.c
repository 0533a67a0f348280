/* The share of unstable layouts: prints it in words, and writes it as JSON and as CSV. */
#include "report/results.h"
#include "base/textfile.h"
#include "report/report.h"
#include <math.h>

static void PrintVerdict(const MpmEnsemble *e)
{
  MpmPrint("\nverdict: %s", MpmVerdictNames[e->finding.verdict]);
  if (e->unstable)
    MpmPrint(", %" PetscInt_FMT " of %" PetscInt_FMT " layouts grow beyond 1 + %.6g\n", e->unstable, e->n,
             e->request->tolerance);
  else if (e->undecided)
    MpmPrint(", rounding or the solver leaves %" PetscInt_FMT " of %" PetscInt_FMT " layouts open\n", e->undecided,
             e->n);
  else
    MpmPrint(", none of %" PetscInt_FMT " layouts grows; of all there are at most %.4g%% do, with 95%% confidence\n",
             e->n, 100 * e->interval[1]);
  MpmPrint("evidence: %s\n", e->finding.evidence);
}

PetscErrorCode MpmEnsemblePrint(const MpmEnsemble *e)
{

  PetscFunctionBegin;
  PetscCall(MpmReportScene(e->scene, e->request));
  MpmPrint("\nlayouts    %" PetscInt_FMT ", seeds %" PetscInt64_FMT " to %" PetscInt64_FMT "\n", e->n,
           e->scene->layout.seed, e->scene->layout.seed + e->n - 1);
  MpmPrint("unstable   %" PetscInt_FMT "\nundecided  %" PetscInt_FMT "\n", e->unstable, e->undecided);
  MpmPrint("share      %.4g%%, with 95%% confidence from %.4g%% to %.4g%% (Wilson)\n", 100 * e->share,
           100 * e->interval[0], 100 * e->interval[1]);
  if (isnan(e->growth_max))
    MpmPrint("growth     of no layout is known\n");
  else
    MpmPrint("growth     per step: smallest %.9g, median %.9g, largest %.9g (-seed %" PetscInt64_FMT ")\n",
             e->growth_min, e->growth_median, e->growth_max, e->worst_seed);
  PrintVerdict(e);
  MpmPrint("time: %.3g s\n", e->seconds);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEnsembleWriteJson(const MpmEnsemble *e, PetscReal wall_s)
{
  json_t *object, *ensemble = json_object();

  PetscFunctionBegin;
  PetscCall(MpmJsonScene(e->scene, "ensemble", wall_s, &object));
  MpmJsonSetFinding(object, &e->finding);
  MpmJsonSetCount(ensemble, "layouts", e->n);
  MpmJsonSetCount(ensemble, "unstable", e->unstable);
  MpmJsonSetCount(ensemble, "undecided", e->undecided);
  MpmJsonSet(ensemble, "share", e->share);
  json_object_set_new(ensemble, "interval", json_pack("[f, f]", e->interval[0], e->interval[1]));
  MpmJsonSet(ensemble, "growth_min", e->growth_min);
  MpmJsonSet(ensemble, "growth_median", e->growth_median);
  MpmJsonSet(ensemble, "growth_max", e->growth_max);
  if (!isnan(e->growth_max)) MpmJsonSetCount(ensemble, "worst_seed", e->worst_seed);
  MpmJsonSet(ensemble, "tolerance", e->request->tolerance);
  MpmJsonSet(ensemble, "seconds", e->seconds);
  json_object_set_new(object, "ensemble", ensemble);
  PetscCall(MpmJsonWrite(e->request->json, object));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEnsembleWriteCsv(const MpmEnsemble *e)
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
