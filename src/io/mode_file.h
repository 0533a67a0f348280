/* Eigenvectors from files of the task spectrum, as initial data of a run. */
#pragma once
#include "march/particles.h"

/* Collective. Refuses a scene's mode_file unless it is of the same scheme, grid and particles and holds the mode. */
PetscErrorCode MpmModeFileCheck(const MpmScene *scene);

/* Not collective. The group of the file that holds the scene's mode. */
PetscErrorCode MpmModeFileGroup(const MpmScene *scene, char group[], size_t room);

/* Collective. Growth per step of the mode's eigenvalue. */
PetscErrorCode MpmModeFileGrowth(const MpmScene *scene, PetscReal *growth);

/*
   MpmModeFileFill - particle fields from the real or the imaginary part of the mode, whichever is larger, scaled to the
   scene's amplitude and divided by 2^exponent.

   Collective.
*/
PetscErrorCode MpmModeFileFill(const MpmScene *scene, PetscInt exponent, MpmParticles *particles);
