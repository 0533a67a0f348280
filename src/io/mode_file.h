/* Mode files: eigenvectors that the task spectrum writes, and that a run can take as its initial data. */
#pragma once
#include "io/datafile.h"
#include "linalg/eigen.h"
#include <mpmstab/march.h>
#include <mpmstab/operator.h>

/* Collective. Refuses a mode file unless it has the scene's scheme, grid and particles and holds the scene's mode. */
PetscErrorCode MpmModeFileCheck(const MpmScene *scene, const char path[]);

/* Collective. Reads the growth per step of the mode's eigenvalue. */
PetscErrorCode MpmModeFileGrowth(const MpmScene *scene, const char path[], PetscReal *growth);

/*
   MpmModeFileFill - gives the particles of a march at its start the real or the imaginary part of the mode, whichever
   is larger, scaled to the scene's amplitude.

   Collective. Call it after MpmMarchCreate, which leaves such fields unset.
*/
PetscErrorCode MpmModeFileFill(const char path[], MpmMarch *march);

/*
   MpmModesWrite - writes the first count listed eigenvectors as particle fields /modes/NNNN/FIELD_re and FIELD_im, in
   the order of global ids. NNNN counts from 1. It writes the particles' starting places as /modes/coordinates. The
   attributes re, im and growth of each group are the eigenvalue and its growth per step.

   Collective.
*/
PetscErrorCode MpmModesWrite(const MpmOperator *op, PetscReal cell_width, const MpmEigen *eigen, PetscInt count,
                             MpmDataFile *file);

/*
   MpmVectorsWrite - writes the first count listed eigenvectors of a matrix that was given, as /modes/NNNN/vector_re and
   vector_im in the order of its rows, with the same attributes.

   Collective.
*/
PetscErrorCode MpmVectorsWrite(const MpmOperator *op, const MpmEigen *eigen, PetscInt count, MpmDataFile *file);
