/* Mode files: eigenvectors that the task spectrum writes, and that a run takes as its initial data. */
#pragma once
#include "io/datafile.h"
#include "linalg/eigen.h"
#include <mpmstab/march.h>
#include <mpmstab/operator.h>

/* Collective. Refuses a mode file unless it is of the scene's scheme, grid and particles and holds its mode. */
PetscErrorCode MpmModeFileCheck(const MpmScene *scene, const char path[]);

/* Not collective. Names the group of the file that holds the scene's mode. */
PetscErrorCode MpmModeFileGroup(const MpmScene *scene, char group[], size_t room);

/* Collective. Reads the growth per step of the mode's eigenvalue. */
PetscErrorCode MpmModeFileGrowth(const MpmScene *scene, const char path[], PetscReal *growth);

/*
   MpmModeFileFill - gives the particles of a march at its start the real or the imaginary part of the mode, whichever is
   larger, scaled to the scene's amplitude.

   Collective. To be called after MpmMarchCreate, which leaves such fields unset.
*/
PetscErrorCode MpmModeFileFill(const char path[], MpmMarch *march);

/*
   MpmModesWrite - the first count listed eigenvectors as particle fields /modes/NNNN/FIELD_re and FIELD_im, in the
   order of global ids, counted from 1, and where the particles start, /modes/coordinates; the group's attributes re, im
   and growth are the eigenvalue and its growth per step.

   Collective.
*/
PetscErrorCode MpmModesWrite(const MpmOperator *op, PetscReal cell_width, const MpmEigen *eigen, PetscInt count,
                             MpmDataFile *file);
