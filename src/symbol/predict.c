/* The closed forms of the formulations, at the phases beta = 2 pi m / cells of a grid. */
#include "scene/layout.h"
#include "scheme/maps.h"
#include "symbol/predict.h"
#include <math.h>

/* With more phases than this the maximum has the same digits. */
#define MOST_PHASES 65536

#define AGREE 1e-6    /* closed form and symbol, relative to growth: a defective pair has an error of 1e-8 */
#define NOTHING 1e-24 /* rounding alone may make a symbol of P2G G2P this large */

static const char *WhyNot(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts)
{
  if (layout->dim > 1) return "the formulas are for one dimension";
  if (drifts) return "the formulas are for particles at rest";
  if (!MpmLayoutIsPeriodic(layout)) return "the formulas are for a periodic domain";
  if (!MpmLayoutIsUniform(layout)) return "the formulas are for cells that are all alike";
  if (!scheme->transfer->filter_symbol) return "no closed form for this transfer";
  return NULL;
}

static const char *WhyNotPublished(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts)
{
  if (!scheme->formulation->published) return "the slides do not treat this formulation";
  if (!scheme->basis->hat) return "the slides treat the linear basis";
  if (scheme->transfer->filter) return "the slides treat flip";
  return WhyNot(layout, scheme, drifts);
}

PetscErrorCode MpmPredictorCreate(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts, MpmPredictor *p)
{
  const PetscInt reach = MpmMapReach(scheme->basis);
  PetscReal      mean  = 0;

  PetscFunctionBegin;
  *p                   = (MpmPredictor){.layout            = layout,
                                        .scheme            = scheme,
                                        .why_not           = WhyNot(layout, scheme, drifts),
                                        .why_not_published = WhyNotPublished(layout, scheme, drifts)};
  p->why_not_corrected = scheme->formulation->corrected ? p->why_not : "the formulation has no closed form";
  if (p->why_not) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(
      PetscMalloc3(layout->ppc[0], &p->node, layout->ppc[0] * reach, &p->value, layout->ppc[0] * reach, &p->slope));
  for (PetscInt j = 0; j < layout->ppc[0]; j++) {
    PetscReal xi;

    MpmLayoutPlace(layout, j, &p->node[j], &xi);
    MpmMapRow(scheme->basis, MPM_G2P, xi, layout->half_width[0], p->value + j * reach);
    MpmMapRow(scheme->basis, MPM_GRAD, xi, layout->half_width[0], p->slope + j * reach);
    mean += xi / layout->ppc[0];
  }
  p->e = 2 * mean - 1;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmPredictorDestroy(MpmPredictor *p)
{
  PetscFunctionBegin;
  if (p->node) PetscCall(PetscFree3(p->node, p->value, p->slope));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The symbol of phi or of h dphi/dx at particle j. */
static double complex SymbolOf(const MpmPredictor *p, const PetscReal row[], PetscInt j, PetscReal beta)
{
  const PetscInt reach = MpmMapReach(p->scheme->basis);
  double complex sum   = 0;

  for (PetscInt d = 0; d < reach; d++) sum += row[j * reach + d] * cexp(I * (beta * (p->node[j] + d)));
  return sum;
}

MpmCellSymbols MpmPredictorSymbols(const MpmPredictor *p, PetscReal beta)
{
  const PetscInt ppc  = p->layout->ppc[0];
  MpmCellSymbols cell = {.lap = 4 * PetscSqr(sin(beta / 2))};

  for (PetscInt j = 0; j < ppc; j++) {
    const double complex value = SymbolOf(p, p->value, j, beta), slope = SymbolOf(p, p->slope, j, beta);

    cell.alpha += creal(conj(value) * value) / ppc;
    cell.kappa += creal(conj(slope) * slope) / ppc;
    cell.mu += conj(value) * slope / ppc;
  }
  if (cell.alpha < NOTHING) cell.alpha = 0;
  cell.filter = p->scheme->transfer->filter_symbol(&p->scheme->numbers, cell.alpha);
  return cell;
}

PetscReal MpmPredictorPublished(const MpmPredictor *p, PetscReal courant, PetscReal beta)
{
  return p->why_not_published ? NAN : p->scheme->formulation->published(courant, beta);
}

PetscReal MpmPredictorCorrected(const MpmPredictor *p, PetscReal courant, PetscReal beta)
{
  MpmCellSymbols cell;

  if (p->why_not_corrected) return NAN;
  cell = MpmPredictorSymbols(p, beta);
  return p->scheme->formulation->corrected(&cell, courant);
}

PetscErrorCode MpmPredict(const MpmScene *scene, MpmPredictions *predictions)
{
  const PetscInt phases = PetscMin(scene->layout.grid[0].cells, MOST_PHASES);
  MpmPredictor   predictor;

  PetscFunctionBegin;
  *predictions = (MpmPredictions){.published = NAN, .corrected = NAN, .corrected_mode = NAN};
  PetscCall(MpmPredictorCreate(&scene->layout, &scene->scheme, MpmSceneDrifts(scene), &predictor));
  for (PetscInt m = 0; m < phases && !predictor.why_not; m++) {
    const PetscReal beta = MpmSymbolPhase(m, phases);

    predictions->published = fmax(predictions->published, MpmPredictorPublished(&predictor, scene->step.courant, beta));
    predictions->corrected = fmax(predictions->corrected, MpmPredictorCorrected(&predictor, scene->step.courant, beta));
  }
  if (scene->initial == MPM_INITIAL_MODE && MpmSceneIsPeriodic(scene))
    predictions->corrected_mode = MpmPredictorCorrected(&predictor, scene->step.courant,
                                                        MpmSymbolPhase(scene->mode[0], scene->layout.grid[0].cells));
  PetscCall(MpmPredictorDestroy(&predictor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Keeps the larger of two distances, with its phase. Of equal ones, but for rounding, it keeps the first. */
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
  for (PetscInt i = 0; i < s->count && s->without_null; i++) {
    const PetscReal beta = MpmSymbolPhase(s->first + i, s->phases);

    Widest(fabs(MpmPredictorPublished(p, s->step.courant, beta) - s->without_null[i]), beta, &mine[0], &mine[1]);
    Widest(fabs(MpmPredictorCorrected(p, s->step.courant, beta) - s->without_null[i]), beta, &mine[2], &mine[3]);
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

PetscBool MpmPredictDisagrees(const MpmComparison *comparison, PetscReal growth)
{
  return comparison->corrected > AGREE * PetscMax(1, growth) ? PETSC_TRUE : PETSC_FALSE;
}
