/* Mode files: eigenvectors that the task spectrum writes, and that a run takes as its initial data. */
#pragma once
#include "io/datafile.h"
#include "linalg/eigen.h"
#include "march/particles.h"
#include <mpmstab/operator.h>

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

/*
   MpmModesWrite - the first count listed eigenvectors as particle fields /modes/NNNN/FIELD_re and FIELD_im, in the
   order of global ids, counted from 1, and where the particles start, /modes/coordinates; the group's attributes re, im
   and growth are the eigenvalue and its growth per step.

   Collective.
*/
PetscErrorCode MpmModesWrite(const MpmOperator *op, PetscReal cell_width, const MpmEigen *eigen, PetscInt count,
                             MpmDataFile *file);
