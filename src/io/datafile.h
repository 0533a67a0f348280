/* Data files: results as HDF5 that appear whole or not at all, with scene and version as attributes of the root. */
#pragma once
#include "io/hdf5.h"
#include "scene/request.h"

typedef struct {
  MpmHdf5 hdf5;
  char    path[PETSC_MAX_PATH_LEN], part[PETSC_MAX_PATH_LEN];
} MpmDataFile;

/* Collective. Opens the output that a request names, aside, with scene and request as attributes. */
PetscErrorCode MpmDataFileOpen(MPI_Comm comm, const MpmScene *scene, const MpmRequest *request, MpmDataFile *file);

/* Collective. Removes the file and refuses in one line when anything could not be written so far. */
PetscErrorCode MpmDataFileCheck(MpmDataFile *file);

/* Collective. Checks the file and gives it its name. */
PetscErrorCode MpmDataFileClose(MpmDataFile *file);

/* Collective. Closes a file and removes it. */
PetscErrorCode MpmDataFileDrop(MpmDataFile *file);

/* Collective. Writes rows x columns numbers that rank 0 has (one column: a vector). */
PetscErrorCode MpmDataFileArray(MpmDataFile *file, const char group[], const char name[], PetscInt rows,
                                PetscInt columns, const PetscReal values[]);
