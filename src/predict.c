/* The formulations' closed forms over the phases beta = 2 pi m / cells of a grid. */
#include <mpmstab/layout.h>
#include <mpmstab/predict.h>
#include <math.h>

/* Beyond this many phases the maximum is the same to all digits that matter. */
#define MOST_PHASES 65536

static const char *WhyNot(const MpmScene *scene)
{
  if (MpmSceneDrifts(scene)) return "the formulas are for particles at rest";
  if (!MpmLayoutIsUniform(scene)) return "the formulas are for cells that are all alike";
  if (!scene->basis->hat) return "the formulas are for the linear basis";
  return NULL;
}

PetscErrorCode MpmPredictorCreate(const MpmScene *scene, MpmPredictor *p)
{
  PetscReal mean = 0;

  PetscFunctionBegin;
  *p = (MpmPredictor){.scene = scene, .why_not = WhyNot(scene)};
  if (p->why_not) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(scene->ppc, &p->xi));
  for (PetscInt j = 0; j < scene->ppc; j++) {
    PetscInt n;

    MpmLayoutPlace(scene, j, &n, &p->xi[j]);
    mean += p->xi[j] / scene->ppc;
  }
  p->cell = (MpmCellMoments){.e = 2 * mean - 1, .ppc = scene->ppc, .xi = p->xi};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPredictorDestroy(MpmPredictor *p)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(p->xi));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmPredictorPublished(const MpmPredictor *p, PetscReal beta)
{
  return p->why_not ? NAN : p->scene->formulation->published(p->scene->courant, beta);
}

PetscReal MpmPredictorCorrected(const MpmPredictor *p, PetscReal beta)
{
  return p->why_not ? NAN : p->scene->formulation->corrected(&p->cell, p->scene->courant, beta);
}

PetscErrorCode MpmPredict(const MpmScene *scene, MpmPredictions *predictions)
{
  const PetscInt phases = PetscMin(scene->cells, MOST_PHASES);
  MpmPredictor   predictor;

  PetscFunctionBegin;
  *predictions = (MpmPredictions){.published = NAN, .corrected = NAN, .corrected_mode = NAN};
  PetscCall(MpmPredictorCreate(scene, &predictor));
  for (PetscInt m = 0; m < phases && !predictor.why_not; m++) {
    const PetscReal beta = MpmSymbolPhase(m, phases);

    predictions->published = fmax(predictions->published, MpmPredictorPublished(&predictor, beta));
    predictions->corrected = fmax(predictions->corrected, MpmPredictorCorrected(&predictor, beta));
  }
  if (scene->initial == MPM_INITIAL_MODE)
    predictions->corrected_mode = MpmPredictorCorrected(&predictor, MpmSymbolPhase(scene->mode, scene->cells));
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The larger of two distances, with its phase; the least phase when they are the same to rounding. */
static void Widest(PetscReal distance, PetscReal beta, PetscReal *widest, PetscReal *at)
{
  if (isnan(distance) || distance <= *widest + 1e-12) return;
  *widest = distance;
  *at     = beta;
}

PetscErrorCode MpmPredictCompare(MPI_Comm comm, const MpmPredictor *p, const MpmSymbol *s, MpmComparison *comparison)
{
  PetscReal   mine[4] = {-1, NAN, -1, NAN}, *all;
  PetscMPIInt size;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->count && s->seen; i++) {
    const PetscReal beta = MpmSymbolPhase(s->first + i, s->phases);

    Widest(fabs(MpmPredictorPublished(p, beta) - s->seen[i]), beta, &mine[0], &mine[1]);
    Widest(fabs(MpmPredictorCorrected(p, beta) - s->seen[i]), beta, &mine[2], &mine[3]);
  }
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(PetscMalloc1(4 * size, &all));
  PetscCallMPI(MPI_Allgather(mine, 4, MPIU_REAL, all, 4, MPIU_REAL, comm));
  for (PetscMPIInt r = 0; r < size; r++) {
    Widest(all[4 * r], all[4 * r + 1], &mine[0], &mine[1]);
    Widest(all[4 * r + 2], all[4 * r + 3], &mine[2], &mine[3]);
  }
  PetscCall(PetscFree(all));
  *comparison = (MpmComparison){mine[0] < 0 ? NAN : mine[0], mine[1], mine[2] < 0 ? NAN : mine[2], mine[3]};
  PetscFunctionReturn(PETSC_SUCCESS);
}
