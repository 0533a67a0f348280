/*
   Whether a file is one that MpmModesWrite has written, for this scene. The first rank alone looks, with plain HDF5:
   whatever it finds all ranks refuse together, and PETSc then reads what is known to be there.
*/
#include <mpmstab/errors.h>
#include "scene/material.h"
#include "io/mode_file.h"
#include <hdf5.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define WRITTEN "allowed: a file that 'mpmstab spectrum -output' has written"

typedef struct {
  const MpmScene *scene;
  hid_t           file;
  char            why[1024]; /* "": nothing is wrong */
} Check;

/* The first thing that is wrong is what is said. */
__attribute__((format(printf, 2, 3))) static void Wrong(Check *c, const char format[], ...)
{
  va_list arguments;

  if (c->why[0]) return;
  va_start(arguments, format);
  (void)vsnprintf(c->why, sizeof c->why, format, arguments);
  va_end(arguments);
}

/* One value, or nothing: an array would not fit. */
static PetscBool Attribute(const Check *c, const char object[], const char name[], H5T_class_t kind, hid_t memory,
                           void *value)
{
  const hid_t attribute = H5Aopen_by_name(c->file, object, name, H5P_DEFAULT, H5P_DEFAULT);
  hid_t       space, type;
  PetscBool   ok;

  if (attribute < 0) return PETSC_FALSE;
  space = H5Aget_space(attribute);
  type  = H5Aget_type(attribute);
  ok    = H5Sget_simple_extent_npoints(space) == 1 && H5Tget_class(type) == kind && H5Tis_variable_str(type) <= 0 &&
               H5Aread(attribute, memory, value) >= 0
              ? PETSC_TRUE
              : PETSC_FALSE;
  (void)H5Tclose(type);
  (void)H5Sclose(space);
  (void)H5Aclose(attribute);
  return ok;
}

static void SameText(Check *c, const char name[], const char mine[])
{
  const hid_t text                   = H5Tcopy(H5T_C_S1);
  char        their[MPM_COUNTS_TEXT] = "";

  (void)H5Tset_size(text, sizeof their);
  if (!Attribute(c, "/", name, H5T_STRING, text, their))
    Wrong(c, "no %s in it; " WRITTEN, name);
  else if (strncmp(mine, their, sizeof their))
    Wrong(c, "its %s is %.*s, the scene's is %s; allowed: the same", name, (int)sizeof their, their, mine);
  (void)H5Tclose(text);
}

static void SameNumber(Check *c, const char name[], PetscReal mine)
{
  double theirs = NAN;

  if (!Attribute(c, "/", name, H5T_FLOAT, H5T_NATIVE_DOUBLE, &theirs))
    Wrong(c, "no %s in it; " WRITTEN, name);
  else if (theirs != mine)
    Wrong(c, "its %s is %.17g, the scene's is %.17g; allowed: the same", name, theirs, mine);
}

static void SameCount(Check *c, const char name[], PetscInt mine)
{
  long long theirs = 0;

  if (!Attribute(c, "/", name, H5T_INTEGER, H5T_NATIVE_LLONG, &theirs))
    Wrong(c, "no %s in it; " WRITTEN, name);
  else if (theirs != mine)
    Wrong(c, "its %s is %lld, the scene's is %" PetscInt_FMT "; allowed: the same", name, theirs, mine);
}

static PetscErrorCode SameScene(Check *c)
{
  const MpmScene *s = c->scene;
  char            counts[MPM_COUNTS_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmSceneCountsText(s, sizeof counts, counts));
  SameText(c, "formulation", s->scheme.formulation->name);
  SameText(c, "basis", s->scheme.basis->name);
  SameText(c, "transfer", s->scheme.transfer->name);
  SameText(c, "boundary", s->boundary);
  SameCount(c, "cells", s->layout.grid.cells);
  SameCount(c, "ppc", s->layout.ppc);
  SameText(c, "counts", counts);
  SameNumber(c, "cluster_from", s->layout.cluster[0]);
  SameNumber(c, "cluster_to", s->layout.cluster[1]);
  SameText(c, "material", MpmMaterialNames[s->layout.material.kind]);
  SameNumber(c, "density_ratio", s->layout.material.density);
  SameNumber(c, "stiffness_ratio", s->layout.material.stiffness);
  SameNumber(c, "inclusion_from", s->layout.material.inclusion[0]);
  SameNumber(c, "inclusion_to", s->layout.material.inclusion[1]);
  SameNumber(c, "offset", s->layout.offset.value);
  SameNumber(c, "jitter", s->layout.jitter);
  if (s->layout.jitter != 0) SameNumber(c, "seed", (PetscReal)s->layout.seed);
  SameNumber(c, "courant", s->step.courant);
  SameNumber(c, "first", (PetscReal)s->layout.first);
  SameNumber(c, "particles", (PetscReal)s->layout.particles);
  if (s->scheme.transfer->option)
    SameNumber(c, s->scheme.transfer->option, s->scheme.transfer->number(&s->scheme.numbers));
  SameNumber(c, "drift", s->step.drift.value);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A field of the mode: as many numbers as there are particles, all of them finite. */
static PetscErrorCode Field(Check *c, const char group[], const char field[], const char part[], PetscReal *largest)
{
  const PetscInt64 n = c->scene->layout.particles;
  char             name[128];
  hid_t            set, space, type;
  double          *values;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(name, sizeof name, "%s/%s_%s", group, field, part));
  set   = H5Dopen2(c->file, name, H5P_DEFAULT);
  space = set < 0 ? -1 : H5Dget_space(set);
  type  = set < 0 ? -1 : H5Dget_type(set);
  if (set < 0 || H5Sget_simple_extent_ndims(space) != 1 || H5Sget_simple_extent_npoints(space) != n ||
      H5Tget_class(type) != H5T_FLOAT)
    Wrong(c, "%s is not %" PetscInt64_FMT " numbers; " WRITTEN, name, n);
  else {
    PetscCall(PetscMalloc1(n, &values));
    if (H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) < 0)
      Wrong(c, "%s cannot be read; " WRITTEN, name);
    for (PetscInt64 i = 0; i < n && !c->why[0]; i++) {
      if (!isfinite(values[i])) Wrong(c, "%s holds a value that is not finite; " WRITTEN, name);
      *largest = PetscMax(*largest, fabs(values[i]));
    }
    PetscCall(PetscFree(values));
  }
  if (type >= 0) (void)H5Tclose(type);
  if (space >= 0) (void)H5Sclose(space);
  if (set >= 0) (void)H5Dclose(set);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Mode(Check *c)
{
  PetscReal largest = 0;
  double    growth;
  char      group[64];

  PetscFunctionBegin;
  PetscCall(MpmModeFileGroup(c->scene, group, sizeof group));
  if (!Attribute(c, group, "growth", H5T_FLOAT, H5T_NATIVE_DOUBLE, &growth))
    Wrong(c, "it does not hold mode %" PetscInt_FMT "; allowed: one of those that 'mpmstab spectrum -modes' has kept",
          c->scene->mode);
  for (PetscInt f = 0; c->scene->scheme.table->fields[f] && !c->why[0]; f++) {
    PetscCall(Field(c, group, c->scene->scheme.table->fields[f], "re", &largest));
    PetscCall(Field(c, group, c->scene->scheme.table->fields[f], "im", &largest));
  }
  if (largest == 0) Wrong(c, "mode %" PetscInt_FMT " is zero; " WRITTEN, c->scene->mode);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A pipe is not opened: it would wait for its writer. */
static PetscErrorCode Examine(Check *c, const char path[])
{
  struct stat is;
  FILE       *file = !stat(path, &is) && S_ISREG(is.st_mode) ? fopen(path, "rb") : NULL;

  PetscFunctionBegin;
  if (!file) {
    Wrong(c, "cannot be read; " WRITTEN);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  fclose(file);
  (void)H5Eset_auto2(H5E_DEFAULT, NULL, NULL); /* it would print a stack of complaints */
  c->file = H5Fis_hdf5(path) > 0 ? H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT) : -1;
  if (c->file < 0) {
    Wrong(c, H5Fis_hdf5(path) > 0 ? "cut short or damaged; " WRITTEN : "not an HDF5 file; " WRITTEN);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(SameScene(c));
  if (!c->why[0]) PetscCall(Mode(c));
  (void)H5Fclose(c->file);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileCheck(const MpmScene *scene)
{
  Check       check = {.scene = scene};
  PetscMPIInt rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  if (rank == 0) PetscCall(Examine(&check, scene->mode_file));
  PetscCallMPI(MPI_Bcast(check.why, sizeof check.why, MPI_CHAR, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!check.why[0], "mode_file %s: %s", scene->mode_file, check.why);
  PetscFunctionReturn(PETSC_SUCCESS);
}
