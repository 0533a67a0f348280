/* HDF5 files through PETSc's parallel viewer: the scene as attributes, renamed when whole. */
#include "io/datafile.h"
#include <mpmstab/errors.h>
#include "scene/material.h"
#include "base/unfinished.h"
#include <hdf5.h>
#include <petscvec.h>
#include <petscviewerhdf5.h>
#include <errno.h>
#include <string.h>
#include <unistd.h>

static PetscErrorCode WriteText(PetscViewer viewer, const char name[], const char text[])
{
  PetscFunctionBegin;
  PetscCall(PetscViewerHDF5WriteAttribute(viewer, "/", name, PETSC_STRING, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNumber(PetscViewer viewer, const char name[], PetscReal value)
{
  PetscFunctionBegin;
  PetscCall(PetscViewerHDF5WriteAttribute(viewer, "/", name, PETSC_REAL, &value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As text too, which keeps 1/7 what it is. */
static PetscErrorCode WriteFraction(PetscViewer viewer, const char name[], const MpmFraction *f)
{
  char exact[64], text[64];

  PetscFunctionBegin;
  PetscCall(WriteNumber(viewer, name, f->value));
  if (!f->den) PetscFunctionReturn(PETSC_SUCCESS);
  snprintf(exact, sizeof exact, "%s_exact", name);
  snprintf(text, sizeof text, "%" PetscInt64_FMT "/%" PetscInt64_FMT, f->num, f->den);
  PetscCall(WriteText(viewer, exact, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteSceneAttributes(const MpmScene *s, PetscViewer viewer)
{
  char counts[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(WriteText(viewer, "version", MPMSTAB_VERSION));
  PetscCall(WriteText(viewer, "formulation", s->scheme.formulation->name));
  PetscCall(WriteText(viewer, "basis", s->scheme.basis->name));
  PetscCall(WriteText(viewer, "transfer", s->scheme.transfer->name));
  PetscCall(WriteText(viewer, "layout", s->layout.name));
  PetscCall(WriteText(viewer, "boundary", s->boundary));
  PetscCall(WriteText(viewer, "initial", MpmInitialNames[s->initial]));
  PetscCall(WriteText(viewer, "stagger", s->stagger ? "true" : "false"));
  PetscCall(WriteFraction(viewer, "drift", &s->step.drift));
  PetscCall(WriteFraction(viewer, "offset", &s->layout.offset));
  PetscCall(PetscViewerHDF5WriteAttribute(viewer, "/", "dim", PETSC_INT, &s->dim));
  PetscCall(PetscViewerHDF5WriteAttribute(viewer, "/", "cells", PETSC_INT, &s->layout.grid.cells));
  PetscCall(PetscViewerHDF5WriteAttribute(viewer, "/", "ppc", PETSC_INT, &s->layout.ppc));
  PetscCall(PetscViewerHDF5WriteAttribute(viewer, "/", "mode", PETSC_INT, &s->mode));
  PetscCall(WriteNumber(viewer, "seed", (PetscReal)s->layout.seed));
  PetscCall(WriteNumber(viewer, "steps", (PetscReal)s->steps));
  PetscCall(WriteNumber(viewer, "length", s->length));
  PetscCall(WriteNumber(viewer, "wave_speed", s->wave_speed));
  PetscCall(WriteNumber(viewer, "courant", s->step.courant));
  PetscCall(WriteNumber(viewer, "dt", s->dt));
  PetscCall(WriteNumber(viewer, "jitter", s->layout.jitter));
  PetscCall(WriteNumber(viewer, "amplitude", s->amplitude));
  PetscCall(WriteNumber(viewer, "tolerance", s->tolerance));
  PetscCall(WriteNumber(viewer, "first", (PetscReal)s->layout.first));
  PetscCall(WriteNumber(viewer, "particles", (PetscReal)s->layout.particles));
  PetscCall(WriteNumber(viewer, "cluster_from", s->layout.cluster[0]));
  PetscCall(WriteNumber(viewer, "cluster_to", s->layout.cluster[1]));
  PetscCall(MpmSceneCountsText(s, sizeof counts, counts));
  PetscCall(WriteText(viewer, "counts", counts));
  PetscCall(WriteText(viewer, "material", MpmMaterialNames[s->layout.material.kind]));
  PetscCall(WriteNumber(viewer, "density_ratio", s->layout.material.density));
  PetscCall(WriteNumber(viewer, "stiffness_ratio", s->layout.material.stiffness));
  PetscCall(WriteNumber(viewer, "inclusion_from", s->layout.material.inclusion[0]));
  PetscCall(WriteNumber(viewer, "inclusion_to", s->layout.material.inclusion[1]));
  if (s->scheme.transfer->option)
    PetscCall(WriteNumber(viewer, s->scheme.transfer->option, s->scheme.transfer->number(&s->scheme.numbers)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileOpen(MPI_Comm comm, const MpmScene *scene, MpmDataFile *file)
{
  PetscFunctionBegin;
  PetscCall(PetscStrncpy(file->path, scene->output, sizeof file->path));
  PetscCall(PetscSNPrintf(file->part, sizeof file->part, "%s.part", file->path));
  (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* a file that cannot be written is told in one line */
  MpmUnfinishedAdd(file->part);
  MpmErrorsBlame(file->path);
  PetscCall(PetscViewerHDF5Open(comm, file->part, FILE_MODE_WRITE, &file->viewer));
  PetscCall(WriteSceneAttributes(scene, file->viewer));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileClose(MpmDataFile *file, const char also[])
{
  PetscMPIInt rank;
  int         error = 0;

  PetscFunctionBegin;
  PetscCall(PetscViewerDestroy(&file->viewer));
  MpmErrorsBlame("");
  MpmUnfinishedDone(file->part);
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0 && rename(file->part, file->path)) {
    error = errno;
    (void)unlink(file->part);
    if (also) (void)unlink(also);
  }
  PetscCallMPI(MPI_Bcast(&error, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileDrop(MpmDataFile *file)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCall(PetscViewerDestroy(&file->viewer));
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) (void)unlink(file->part);
  MpmUnfinishedDone(file->part);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileArray(MpmDataFile *file, const char group[], const char name[], PetscInt rows,
                                PetscInt columns, const PetscReal values[])
{
  MPI_Comm    comm = PetscObjectComm((PetscObject)file->viewer);
  PetscMPIInt rank;
  Vec         array;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(VecCreate(comm, &array));
  PetscCall(VecSetBlockSize(array, columns));
  PetscCall(VecSetSizes(array, rank ? 0 : rows * columns, rows * columns));
  PetscCall(VecSetType(array, VECSTANDARD));
  if (rank == 0) {
    PetscReal *a;

    PetscCall(VecGetArray(array, &a));
    PetscCall(PetscArraycpy(a, values, rows * columns));
    PetscCall(VecRestoreArray(array, &a));
  }
  PetscCall(PetscObjectSetName((PetscObject)array, name));
  PetscCall(PetscViewerHDF5PushGroup(file->viewer, group));
  PetscCall(VecView(array, file->viewer));
  PetscCall(PetscViewerHDF5PopGroup(file->viewer));
  PetscCall(VecDestroy(&array));
  PetscFunctionReturn(PETSC_SUCCESS);
}
