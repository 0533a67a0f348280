/* Predictions: closed forms of abs(G), at each phase, and the largest over the modes of the scene's grid. */
#pragma once
#include <mpmstab/scene.h>
#include <mpmstab/symbol.h>

/*S
   MpmPredictor - the closed forms of a scheme on a layout.

   why_not           - says what the closed forms leave out: particles that move, cells that differ, ends, a transfer
                       without filter symbol; NULL when they cover the case
   why_not_corrected - the same for the corrected formula, or that the formulation has none
   why_not_published - the same for the slides' formula, or that the slides leave out the formulation, the basis or the
                       transfer
   e                 - C1 - C2 of the slides' weights
   node              - node[j]: the first node of particle j of a cell
   value, slope      - phi_ip and h dphi_ip/dx of each particle, MpmMapReach of each
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  const char      *why_not, *why_not_corrected, *why_not_published;
  PetscReal        e;
  PetscInt        *node;
  PetscReal       *value, *slope;
} MpmPredictor;

/* Not collective. drifts says whether particles move; the closed forms do not cover that. */
PetscErrorCode MpmPredictorCreate(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts,
                                  MpmPredictor *predictor);
PetscErrorCode MpmPredictorDestroy(MpmPredictor *predictor);

/* Not collective. The symbols at a phase that the closed forms are functions of. */
MpmCellSymbols MpmPredictorSymbols(const MpmPredictor *predictor, PetscReal beta);

/* Not collective. abs(G) at a Courant number and a phase, as the slides print it and corrected; NaN where undefined. */
PetscReal MpmPredictorPublished(const MpmPredictor *predictor, PetscReal courant, PetscReal beta);
PetscReal MpmPredictorCorrected(const MpmPredictor *predictor, PetscReal courant, PetscReal beta);

/*S
   MpmPredictions - growth per step by the closed forms: the largest over the phases of the scene's grid. NaN where a
   formula does not cover the scene (see MpmPredictor), or the slides leave out its Courant number.

   corrected_mode is the corrected formula at the one phase of initial mode.
*/
typedef struct {
  PetscReal published, corrected, corrected_mode;
} MpmPredictions;

/* Not collective. The predictions for a scene. */
PetscErrorCode MpmPredict(const MpmScene *scene, MpmPredictions *predictions);

/*S
   MpmComparison - the largest distance over the phases between abs(G) by a formula and the growth by the symbol without
   the null space of P2G (without_null of MpmSymbol), and the phase where it is. NaN: there is nothing to compare.
*/
typedef struct {
  PetscReal published, published_beta, corrected, corrected_beta;
} MpmComparison;

/*
   Not collective. Whether the corrected closed form and the symbol are so far apart that one of the two is wrong.
   growth is that of the symbol.
*/
PetscBool MpmPredictDisagrees(const MpmComparison *comparison, PetscReal growth);

/* Collective. Compares the closed forms with the symbol at all its phases. */
PetscErrorCode MpmPredictCompare(MPI_Comm comm, const MpmPredictor *predictor, const MpmSymbol *symbol,
                                 MpmComparison *comparison);
