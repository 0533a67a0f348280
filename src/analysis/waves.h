/* Waves: growth(k, beta) of a scheme on a uniform layout, which every search over phases and Courant numbers asks for. */
#pragma once
#include "symbol/bloch.h"
#include <mpmstab/verdict.h>

/*S
   MpmWaves - bloch and eigen: of its matrices. evaluations: the number of times that growth was computed. courant: for a
   caller that searches over phases at one Courant number.
S*/
typedef struct {
  MpmBloch      bloch;
  MpmSmallEigen eigen;
  PetscReal     courant;
  PetscInt64    evaluations;
} MpmWaves;

/* Not collective. layout and scheme must outlive it. drift: as of MpmBlochCreate. */
PetscErrorCode MpmWavesCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction drift[],
                              MpmWaves *waves);
PetscErrorCode MpmWavesDestroy(MpmWaves *waves);

/* Not collective. Growth per step of a phase at a Courant number. */
PetscErrorCode MpmWavesGrowth(MpmWaves *waves, PetscReal courant, const PetscReal beta[], PetscReal *growth);

/*
   MpmWavesRounding - what rounding makes of growth at a phase: the difference of two matrices whose steps are rounded
   differently. Sets defective_error, and where uncertainty is not NULL that of a growth: its eigenvalue moves by its
   condition number times this difference.

   Not collective.
*/
PetscErrorCode MpmWavesRounding(MpmWaves *waves, PetscReal courant, const PetscReal beta[], PetscReal growth,
                                PetscReal *defective_error, PetscReal *uncertainty);
