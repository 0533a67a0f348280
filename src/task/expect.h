/* What a scene says must come out, against what came out. */
#pragma once
#include "analysis/run.h"

/* Collective. Compares a run with its scene's expectations; prints each that is missed and counts them. */
PetscErrorCode MpmExpectRun(const MpmRun *run, PetscInt *missed);

/* Collective. The same for a computed spectrum or symbol: its verdict, and its growth (expect_spectrum). */
PetscErrorCode MpmExpectFinding(const MpmExpect *expect, const MpmFinding *finding, PetscInt *missed);

/* Collective. The same for a critical Courant number (expect_critical); adds to what was missed. */
PetscErrorCode MpmExpectCritical(const MpmExpect *expect, PetscReal courant, PetscInt *missed);

/* Collective. The same for the share of unstable layouts (expect_share). */
PetscErrorCode MpmExpectShare(const MpmExpect *expect, PetscReal share, PetscInt *missed);
