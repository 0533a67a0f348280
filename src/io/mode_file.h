/* Mode files: eigenvectors that the task spectrum writes, and that a run takes as its initial data. */
#pragma once
#include "io/datafile.h"
#include "linalg/eigen.h"
#include <mpmstab/march.h>
#include <mpmstab/operator.h>

/* Collective. Refuses a scene's mode_file unless it is of the same scheme, grid and particles and holds the mode. */
PetscErrorCode MpmModeFileCheck(const MpmScene *scene);

/* Not collective. Names the group of the file that holds the scene's mode. */
PetscErrorCode MpmModeFileGroup(const MpmScene *scene, char group[], size_t room);

/* Collective. Reads the growth per step of the mode's eigenvalue. */
PetscErrorCode MpmModeFileGrowth(const MpmScene *scene, PetscReal *growth);

/*
   MpmModeFileFill - gives the particles of a march at its start the real or the imaginary part of the mode, whichever is
   larger, scaled to the scene's amplitude.

   Collective. To be called after MpmMarchCreate, which leaves such fields unset.
*/
PetscErrorCode MpmModeFileFill(MpmMarch *march);

/*
   MpmModesWrite - the first count listed eigenvectors as particle fields /modes/NNNN/FIELD_re and FIELD_im, in the
   order of global ids, counted from 1, and where the particles start, /modes/coordinates; the group's attributes re, im
   and growth are the eigenvalue and its growth per step.

   Collective.
*/
PetscErrorCode MpmModesWrite(const MpmOperator *op, const MpmEigen *eigen, PetscInt count, MpmDataFile *file);
