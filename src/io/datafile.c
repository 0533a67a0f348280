/* The scene as attributes of an HDF5 file, and the file aside until it is whole. */
#include "io/datafile.h"
#include "base/errors_private.h"
#include "scene/material.h"
#include "base/textfile.h"
#include "base/unfinished.h"
#include <string.h>

static PetscErrorCode WriteText(MpmHdf5 *file, const char name[], const char text[])
{
  PetscFunctionBegin;
  PetscCall(MpmHdf5WriteText(file, "/", name, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNumber(MpmHdf5 *file, const char name[], PetscReal value)
{
  PetscFunctionBegin;
  PetscCall(MpmHdf5WriteReal(file, "/", name, value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* As text too, which keeps 1/7 what it is. */
static PetscErrorCode WriteFraction(MpmHdf5 *file, const char name[], const MpmFraction *f)
{
  char exact[64], text[64];

  PetscFunctionBegin;
  PetscCall(WriteNumber(file, name, f->value));
  if (!f->den) PetscFunctionReturn(PETSC_SUCCESS);
  snprintf(exact, sizeof exact, "%s_exact", name);
  snprintf(text, sizeof text, "%" PetscInt64_FMT "/%" PetscInt64_FMT, f->num, f->den);
  PetscCall(WriteText(file, exact, text));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteSceneAttributes(const MpmScene *s, MpmHdf5 *file)
{
  char counts[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(WriteText(file, "version", MPMSTAB_VERSION));
  PetscCall(WriteText(file, "formulation", s->scheme.formulation->name));
  PetscCall(WriteText(file, "basis", s->scheme.basis->name));
  PetscCall(WriteText(file, "transfer", s->scheme.transfer->name));
  PetscCall(WriteText(file, "layout", s->layout.name));
  PetscCall(WriteText(file, "boundary", s->boundary));
  PetscCall(WriteText(file, "initial", MpmInitialNames[s->initial]));
  PetscCall(WriteText(file, "stagger", s->stagger ? "true" : "false"));
  PetscCall(WriteFraction(file, "drift", &s->step.drift));
  PetscCall(WriteFraction(file, "offset", &s->layout.offset));
  PetscCall(MpmHdf5WriteInteger(file, "/", "dim", s->dim));
  PetscCall(MpmHdf5WriteInteger(file, "/", "cells", s->layout.grid.cells));
  PetscCall(MpmHdf5WriteInteger(file, "/", "ppc", s->layout.ppc));
  PetscCall(MpmHdf5WriteInteger(file, "/", "mode", s->mode));
  PetscCall(WriteNumber(file, "seed", (PetscReal)s->layout.seed));
  PetscCall(WriteNumber(file, "steps", (PetscReal)s->steps));
  PetscCall(WriteNumber(file, "length", s->length));
  PetscCall(WriteNumber(file, "wave_speed", s->wave_speed));
  PetscCall(WriteNumber(file, "courant", s->step.courant));
  PetscCall(WriteNumber(file, "dt", s->dt));
  PetscCall(WriteNumber(file, "jitter", s->layout.jitter));
  PetscCall(WriteNumber(file, "amplitude", s->amplitude));
  PetscCall(WriteNumber(file, "tolerance", s->tolerance));
  PetscCall(WriteNumber(file, "first", (PetscReal)s->layout.first));
  PetscCall(WriteNumber(file, "particles", (PetscReal)s->layout.particles));
  PetscCall(WriteNumber(file, "cluster_from", s->layout.cluster[0]));
  PetscCall(WriteNumber(file, "cluster_to", s->layout.cluster[1]));
  PetscCall(MpmSceneCountsText(s, sizeof counts, counts));
  PetscCall(WriteText(file, "counts", counts));
  PetscCall(WriteText(file, "material", MpmMaterialNames[s->layout.material.kind]));
  PetscCall(WriteNumber(file, "density_ratio", s->layout.material.density));
  PetscCall(WriteNumber(file, "stiffness_ratio", s->layout.material.stiffness));
  PetscCall(WriteNumber(file, "inclusion_from", s->layout.material.inclusion[0]));
  PetscCall(WriteNumber(file, "inclusion_to", s->layout.material.inclusion[1]));
  if (s->scheme.transfer->option)
    PetscCall(WriteNumber(file, s->scheme.transfer->option, s->scheme.transfer->number(&s->scheme.numbers)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileOpen(MPI_Comm comm, const MpmScene *scene, MpmDataFile *file)
{
  int error;

  PetscFunctionBegin;
  PetscCall(PetscStrncpy(file->path, scene->output, sizeof file->path));
  PetscCall(MpmFileCreate(comm, file->path, file->part, &error));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscCall(MpmHdf5Create(comm, file->part, 0, &file->hdf5));
  PetscCall(WriteSceneAttributes(scene, &file->hdf5));
  PetscCall(MpmDataFileCheck(file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileCheck(MpmDataFile *file)
{
  PetscBool failed;

  PetscFunctionBegin;
  PetscCall(MpmHdf5Failed(&file->hdf5, &failed));
  if (!failed) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmDataFileDrop(file));
  MpmRefuse("%s: cannot be written: %s; allowed: a disk with room for it", file->path, file->hdf5.why);
}

PetscErrorCode MpmDataFileClose(MpmDataFile *file)
{
  int       error;
  PetscBool failed;

  PetscFunctionBegin;
  PetscCall(MpmDataFileCheck(file));
  PetscCall(MpmHdf5Close(&file->hdf5, &failed));
  if (failed) PetscCall(MpmDataFileDrop(file));
  MpmCheckInput(!failed, "%s: cannot be written: %s; allowed: a disk with room for it", file->path, file->hdf5.why);
  PetscCall(MpmFileFinish(file->hdf5.comm, file->path, file->part, &error));
  MpmCheckInput(!error, "%s: cannot be written: %s", file->path, strerror(error));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Removed before it is closed: closing may fail on a full disk, and the file is not to stay. */
PetscErrorCode MpmDataFileDrop(MpmDataFile *file)
{
  PetscBool failed;

  PetscFunctionBegin;
  MpmUnfinishedDrop(file->part);
  PetscCall(MpmHdf5Close(&file->hdf5, &failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDataFileArray(MpmDataFile *file, const char group[], const char name[], PetscInt rows,
                                PetscInt columns, const PetscReal values[])
{
  PetscMPIInt rank;
  char        path[256];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(file->hdf5.comm, &rank));
  PetscCall(PetscSNPrintf(path, sizeof path, "%s/%s", group, name));
  PetscCall(MpmHdf5Write(&file->hdf5, path, H5T_NATIVE_DOUBLE, rank ? 0 : rows, columns, values));
  PetscFunctionReturn(PETSC_SUCCESS);
}
