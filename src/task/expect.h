/* Compares what a scene expects with what came out. */
#pragma once
#include "analysis/run.h"

/* Collective. Compares a run with its scene's expectations; prints each that is missed and counts them. */
PetscErrorCode MpmExpectRun(const MpmRun *run, PetscInt *missed);

/* Collective. Does the same for a computed spectrum or symbol: its verdict, and its growth (expect_spectrum). */
PetscErrorCode MpmExpectFinding(const MpmExpect *expect, const MpmFinding *finding, PetscInt *missed);

/* Collective. Does the same for a critical Courant number (expect_critical); adds to the number of missed ones. */
PetscErrorCode MpmExpectCritical(const MpmExpect *expect, PetscReal courant, PetscInt *missed);

/* Collective. Does the same for the share of unstable layouts (expect_share). */
PetscErrorCode MpmExpectShare(const MpmExpect *expect, PetscReal share, PetscInt *missed);
