/* Predictions: closed forms of abs(G), at each phase, and the largest over the modes of the scene's grid. */
#pragma once
#include "symbol/ties.h"
#include <mpmstab/scene.h>
#include <mpmstab/symbol.h>

/* Not collective. The corrected formula of a scheme as text. */
const char *MpmPredictionText(const MpmScheme *scheme);

/*S
   MpmPredictor - the closed forms of a scheme on a layout.

   why_not           - says what the closed forms leave out: particles that move, cells that differ, ends, a transfer
                       without filter symbol; NULL when they cover the case
   why_not_corrected - the same for the corrected formula, or that the formulation has none
   why_not_published - the same for the slides' formula, or that the slides leave out the formulation, the basis, the
                       transfer or the dimension
   problems          - a step of a phase splits into so many problems of two amplification factors each: with a stress,
                       one for each direction of motion that particles resist; else 1
   e                 - C1 - C2 of the slides' weights
   ties, at          - the weights of the maps along each direction, at the steps of a drift; the step that symbols are
                       of
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmScheme *scheme;
  const char      *why_not, *why_not_corrected, *why_not_published;
  PetscInt         problems;
  PetscReal        e;
  MpmTies          ties[MPM_MAX_DIM];
  PetscInt         at;
} MpmPredictor;

/*
   Not collective. drifts says whether particles move; the closed forms do not cover that. frozen: the drift of a frozen
   grid, whose particles have moved by so many steps of it (at), and which is at rest for the closed forms; NULL: none.
*/
PetscErrorCode MpmPredictorCreate(const MpmLayout *layout, const MpmScheme *scheme, PetscBool drifts,
                                  const MpmFraction frozen[], MpmPredictor *predictor);
PetscErrorCode MpmPredictorDestroy(MpmPredictor *predictor);

/*
   MpmPredictorSymbols - the symbols at a phase that the closed forms are functions of: those of each of the predictor's
   problems, the stiffest first. Returns how many there are.

   Not collective. The predictor must cover the case (why_not). beta has one entry for each direction.

   With a stress a problem belongs to an eigenvector of

     K = lambda M + mu (tr M I + conj M),    M_ab = the symbol of DIV_a GRAD_b,

   and its kappa is the eigenvalue. Each eigenvector that no particle resists (a fluid has many) leaves one
   amplification factor besides, the filter symbol. So do the motions of a gas without divergence. With a prestress, in
   more dimensions, a problem belongs to an eigenvector of DIV STRESS GRAD + sigma0 CURVE G2P; its chi is the
   eigenvalue, and kappa 0.
*/
PetscInt MpmPredictorSymbols(const MpmPredictor *predictor, const PetscReal beta[], MpmCellSymbols cell[MPM_MAX_DIM]);

/*
   MpmPredictorPolarisation - the nodal velocity of problem i at a phase: the eigenvector of K, of norm 1.

   Not collective. vector has one entry for each direction. The formulation must have a stress.
*/
void MpmPredictorPolarisation(const MpmPredictor *predictor, const PetscReal beta[], PetscInt i,
                              double complex vector[]);

/*
   Not collective. abs(G) at a Courant number and a phase, as the slides print it and corrected; NaN where undefined.
   The corrected one is the largest of the predictor's problems.
*/
PetscReal MpmPredictorPublished(const MpmPredictor *predictor, PetscReal courant, const PetscReal beta[]);
PetscReal MpmPredictorCorrected(const MpmPredictor *predictor, PetscReal courant, const PetscReal beta[]);

/*S
   MpmPredictions - growth per step by the closed forms: the largest over the phases of the scene's grid. NaN where a
   formula does not cover the scene (see MpmPredictor), or the slides leave out its Courant number.

   corrected_mode is the corrected formula at the one phase of initial mode, for its P or its S wave.
*/
typedef struct {
  PetscReal published, corrected, corrected_mode;
} MpmPredictions;

/* Not collective. The predictions for a scene. */
PetscErrorCode MpmPredict(const MpmScene *scene, MpmPredictions *predictions);

/*S
   MpmComparison - the largest distance over the phases between abs(G) by a formula and the growth by the symbol without
   the null space of P2G (without_null of MpmSymbol), and the phase where it is. NaN: there is nothing to compare. The
   slides have one dimension. allowed: the largest distance that may come from rounding, relative to growth.
*/
typedef struct {
  PetscReal published, published_beta, corrected, corrected_beta[MPM_MAX_DIM], allowed;
} MpmComparison;

/*
   Not collective. Whether the corrected closed form and the symbol are so far apart that one of the two is wrong.
   growth is that of the symbol.
*/
PetscBool MpmPredictDisagrees(const MpmComparison *comparison, PetscReal growth);

/* Collective. Compares the closed forms with the symbol at all its phases. */
PetscErrorCode MpmPredictCompare(MPI_Comm comm, const MpmPredictor *predictor, const MpmSymbol *symbol,
                                 MpmComparison *comparison);
