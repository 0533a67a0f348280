/* Data files: results as HDF5 files that appear whole or not at all. Scene and version are attributes of the root. */
#pragma once
#include "base/hdf5.h"
#include "scene/request.h"
#include <petscvec.h>

typedef struct MpmDataFile MpmDataFile;
struct MpmDataFile {
  MpmHdf5 hdf5;
  char    path[PETSC_MAX_PATH_LEN], part[PETSC_MAX_PATH_LEN];
};

/*
   Collective. Opens the output file that a request names, under a temporary name, and writes scene and request as
   attributes. scene NULL: a matrix takes its place, which the request names.
*/
PetscErrorCode MpmDataFileOpen(MPI_Comm comm, const MpmScene *scene, const MpmRequest *request, MpmDataFile *file);

/* Collective. Opens an empty file under a temporary name. */
PetscErrorCode MpmDataFileCreate(MPI_Comm comm, const char path[], MpmDataFile *file);

/* Collective. Removes the file and refuses in one line when anything could not be written so far. */
PetscErrorCode MpmDataFileCheck(MpmDataFile *file);

/* Collective. Checks the file and gives it its own name. */
PetscErrorCode MpmDataFileClose(MpmDataFile *file);

/* Collective. Closes a file and removes it. */
PetscErrorCode MpmDataFileDrop(MpmDataFile *file);

/* Collective. Writes rows x columns numbers that rank 0 holds; one column makes a vector. */
PetscErrorCode MpmDataFileArray(MpmDataFile *file, const char group[], const char name[], PetscInt rows,
                                PetscInt columns, const PetscReal values[]);

/* Collective. Writes a vector; each of its blocks is a row of n dimensions, 0: a number. */
PetscErrorCode MpmDataFileVector(MpmDataFile *file, const char path[], PetscInt n, const PetscInt row[], Vec vector);
