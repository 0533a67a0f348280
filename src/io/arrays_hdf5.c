/*
   Arrays by name in HDF5, as many programs write them: datasets of the root or of a group, with attributes for what is one
   number or a text.
*/
#include "base/memory.h"
#include "io/arrays.h"
#include "base/hdf5.h"
#include <string.h>

#define PATH_TEXT 160

/* The group that has an array: "" for the root, else "/NAME"; the root if none has it. */
static void FindGroup(const MpmHdf5 *file, const char first[], char group[PATH_TEXT])
{
  char name[64], path[PATH_TEXT];

  group[0] = '\0';
  if (MpmHdf5Has(file, first)) return;
  for (PetscInt i = 0; MpmHdf5Group(file, i, sizeof name, name); i++) {
    if (!name[0]) continue;
    (void)snprintf(path, sizeof path, "/%s/%s", name, first);
    if (!MpmHdf5Has(file, path)) continue;
    (void)snprintf(group, PATH_TEXT, "/%s", name);
    break;
  }
}

/* Reads what has a name in a group: a dataset of numbers, or an attribute that is one number or a text. */
static PetscErrorCode ReadNamed(MpmHdf5 *file, const char group[], const char name[], MpmArrays *arrays,
                                char why[MPM_WHY_TEXT])
{
  const char *object = group[0] ? group : "/";
  char        path[PATH_TEXT], text[32];
  int         dims;
  PetscInt64  shape[MPM_ARRAY_DIMS] = {0};
  PetscReal   number, bytes = sizeof(PetscReal);
  MpmArray   *a;

  PetscFunctionBegin;
  (void)snprintf(path, sizeof path, "%s/%s", group, name);
  if (MpmHdf5Has(file, path)) {
    if (!MpmHdf5Array(file, path, MPM_ARRAY_DIMS, &dims, shape)) {
      (void)snprintf(why, MPM_WHY_TEXT,
                     "array %s; allowed: whole or real numbers in up to %d dimensions, in a whole file", name,
                     MPM_ARRAY_DIMS);
      PetscFunctionReturn(PETSC_SUCCESS);
    }
    for (int d = 0; d < dims; d++) bytes *= (PetscReal)shape[d];
    MpmMemoryRoom(bytes, MPM_WHY_TEXT, why);
    if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(MpmArraysAdd(arrays, name, dims, shape, &a));
    MpmHdf5ReadArray(file, path, a->real);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (MpmHdf5ReadText(file, object, name, sizeof text, text)) {
    PetscCall(MpmArraysAdd(arrays, name, -1, NULL, &a));
    (void)snprintf(a->text, sizeof a->text, "%s", text);
  } else if (MpmHdf5ReadAttribute(file, object, name, H5T_NATIVE_DOUBLE, &number)) {
    PetscCall(MpmArraysAdd(arrays, name, 0, NULL, &a));
    a->real[0] = number;
  } else {
    int64_t whole;

    if (!MpmHdf5ReadAttribute(file, object, name, H5T_NATIVE_INT64, &whole)) PetscFunctionReturn(PETSC_SUCCESS);
    PetscCall(MpmArraysAdd(arrays, name, 0, NULL, &a));
    a->real[0] = (PetscReal)whole;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmArraysReadHdf5(const char path[], const char *const names[], MpmArrays *arrays,
                                 char why[MPM_WHY_TEXT])
{
  MpmHdf5   file;
  PetscBool failed;
  char      group[PATH_TEXT];

  PetscFunctionBegin;
  *arrays = (MpmArrays){.n = 0};
  why[0]  = '\0';
  PetscCall(MpmHdf5Open(PETSC_COMM_SELF, path, &file));
  if (file.file >= 0) {
    FindGroup(&file, names[0], group);
    for (int k = 0; names[k] && !why[0]; k++) PetscCall(ReadNamed(&file, group, names[k], arrays, why));
  }
  PetscCall(MpmHdf5Close(&file, &failed));
  if (failed && !why[0]) (void)snprintf(why, MPM_WHY_TEXT, "%s", "HDF5 cannot read it; allowed: a whole file");
  PetscFunctionReturn(PETSC_SUCCESS);
}
