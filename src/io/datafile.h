/* HDF5 files that appear whole or not at all, with scene and version as attributes of the root. */
#pragma once
#include "scene/request.h"
#include <petscviewer.h>

typedef struct {
  PetscViewer viewer;
  char        path[PETSC_MAX_PATH_LEN], part[PETSC_MAX_PATH_LEN];
} MpmDataFile;

/* Collective. Opens the output that a request names, aside, with scene and request as attributes. */
PetscErrorCode MpmDataFileOpen(MPI_Comm comm, const MpmScene *scene, const MpmRequest *request, MpmDataFile *file);

/* Collective. Gives the file its name; when that fails, refuses and removes it and also (NULL: nothing else). */
PetscErrorCode MpmDataFileClose(MpmDataFile *file, const char also[]);

/* Collective. Closes a file and removes it. */
PetscErrorCode MpmDataFileDrop(MpmDataFile *file);

/* Collective. Writes rows x columns numbers that rank 0 has (one column: a vector). */
PetscErrorCode MpmDataFileArray(MpmDataFile *file, const char group[], const char name[], PetscInt rows,
                                PetscInt columns, const PetscReal values[]);
