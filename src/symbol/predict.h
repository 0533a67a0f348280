/* Predictions: closed forms of abs(G), per phase and the largest over the modes of the scene's grid. */
#pragma once
#include <mpmstab/scene.h>
#include <mpmstab/symbol.h>

/*S
   MpmPredictor - a scheme's closed forms on a layout. why_not: NULL when closed forms can cover it, else what they leave
   out (moving or scattered particles, ends); why_not_corrected: the same, or that the formulation has none;
   why_not_published: the same of the slides' (other bases and transfers too).

   e = C1 - C2 of the slides' weights. node[j]: the first that particle j of a cell sees; value and slope: its phi_ip
   and h dphi_ip/dx, MpmMapReach of each.
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  const char      *why_not, *why_not_corrected, *why_not_published;
  PetscReal        e;
  PetscInt        *node;
  PetscReal       *value, *slope;
} MpmPredictor;

/* Not collective. drifts: whether particles move, which the closed forms do not cover. */
PetscErrorCode MpmPredictorCreate(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts,
                                  MpmPredictor *predictor);
PetscErrorCode MpmPredictorDestroy(MpmPredictor *predictor);

/* Not collective. What the closed forms are made of, at a phase. */
MpmCellSymbols MpmPredictorSymbols(const MpmPredictor *predictor, PetscReal beta);

/* Not collective. abs(G) at a Courant number and a phase; NaN where the formula says nothing. */
PetscReal MpmPredictorPublished(const MpmPredictor *predictor, PetscReal courant, PetscReal beta);
PetscReal MpmPredictorCorrected(const MpmPredictor *predictor, PetscReal courant, PetscReal beta);

/*S
   MpmPredictions - growth per step; NaN where a formula does not cover the scene (see MpmPredictor; or a Courant number
   the slides leave out).

   corrected_mode is the corrected formula at the one phase of initial mode.
*/
typedef struct {
  PetscReal published, corrected, corrected_mode;
} MpmPredictions;

/* Not collective. */
PetscErrorCode MpmPredict(const MpmScene *scene, MpmPredictions *predictions);

/*S
   MpmComparison - the largest distance over the phases of a formula's abs(G) from the symbol's (without what no node
   sees), and the phase where it is. NaN: nothing to compare.
*/
typedef struct {
  PetscReal published, published_beta, corrected, corrected_beta;
} MpmComparison;

/*
   Not collective. Whether the corrected closed form and the symbol, whose growth this is, are so far apart that one of
   the two is wrong.
*/
PetscBool MpmPredictDisagrees(const MpmComparison *comparison, PetscReal growth);

/* Collective. */
PetscErrorCode MpmPredictCompare(MPI_Comm comm, const MpmPredictor *predictor, const MpmSymbol *symbol,
                                 MpmComparison *comparison);
