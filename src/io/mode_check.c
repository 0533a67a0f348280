/*
   Checks that MpmModesWrite has written a file, for this scene. The first rank alone reads it; whatever it finds, all
   ranks refuse together. mode_file.c then reads what is known to be there.
*/
#include "base/textfile.h"
#include <mpmstab/errors.h>
#include "scene/fields.h"
#include "io/mode_file.h"
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define WRITTEN "allowed: a file that 'mpmstab spectrum -output' has written"

typedef struct {
  const MpmScene *scene;
  MpmHdf5         file;
  char            why[1024]; /* "": nothing is wrong */
} Check;

/* Keeps the first fault, since the refusal names only one. */
__attribute__((format(printf, 2, 3))) static void Wrong(Check *c, const char format[], ...)
{
  va_list arguments;

  if (c->why[0]) return;
  va_start(arguments, format);
  (void)vsnprintf(c->why, sizeof c->why, format, arguments);
  va_end(arguments);
}

static void SameText(Check *c, const char name[], const char mine[])
{
  const hid_t text                   = H5Tcopy(H5T_C_S1);
  char        their[MPM_COUNTS_TEXT] = "";

  (void)H5Tset_size(text, sizeof their);
  if (!MpmHdf5ReadAttribute(&c->file, "/", name, text, their))
    Wrong(c, "no %s in it; " WRITTEN, name);
  else if (strncmp(mine, their, sizeof their))
    Wrong(c, "its %s is %.*s, the scene's is %s; allowed: the same", name, (int)sizeof their, their, mine);
  (void)H5Tclose(text);
}

static void SameNumber(Check *c, const char name[], PetscReal mine)
{
  double theirs = NAN;

  if (!MpmHdf5ReadAttribute(&c->file, "/", name, H5T_NATIVE_DOUBLE, &theirs))
    Wrong(c, "no %s in it; " WRITTEN, name);
  else if (theirs != mine)
    Wrong(c, "its %s is %.17g, the scene's is %.17g; allowed: the same", name, theirs, mine);
}

static void SameCount(Check *c, const char name[], PetscInt mine)
{
  long long theirs = 0;

  if (!MpmHdf5ReadAttribute(&c->file, "/", name, H5T_NATIVE_LLONG, &theirs))
    Wrong(c, "no %s in it; " WRITTEN, name);
  else if (theirs != mine)
    Wrong(c, "its %s is %lld, the scene's is %" PetscInt_FMT "; allowed: the same", name, theirs, mine);
}

/* Compares the value of direction a. */
static void SameValue(Check *c, const MpmValue *mine, PetscInt a)
{
  MpmAttribute of[2];
  PetscInt     n;

  MpmValueAttributes(mine, a, &n, of);
  for (PetscInt i = 0; i < n; i++) {
    if (of[i].kind == MPM_AS_COUNT)
      SameCount(c, of[i].name, of[i].count);
    else if (of[i].kind == MPM_AS_REAL)
      SameNumber(c, of[i].name, of[i].number);
    else
      SameText(c, of[i].name, of[i].text);
  }
}

static PetscErrorCode SameScene(Check *c)
{
  MpmValue mine[MPM_MAX_VALUES];
  PetscInt n;

  PetscFunctionBegin;
  PetscCall(MpmValuesIn(MPM_IN_MODE_FILE, c->scene, NULL, &n, mine));
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt a = 0; a < mine[i].n; a++) SameValue(c, &mine[i], a);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks a field of the mode: it needs as many numbers as there are particles, all of them finite. */
static PetscErrorCode Field(Check *c, const char group[], const char field[], const char part[], PetscReal *largest)
{
  const PetscInt64 n = c->scene->layout.particles;
  char             name[128];
  PetscInt64       length;
  double          *values;

  PetscFunctionBegin;
  (void)snprintf(name, sizeof name, "%s/%s_%s", group, field, part);
  PetscCall(MpmHdf5Length(&c->file, name, H5T_NATIVE_DOUBLE, &length));
  if (length != n) {
    Wrong(c, "%s is not %" PetscInt64_FMT " numbers; " WRITTEN, name, n);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(PetscCalloc1(n, &values));
  MpmHdf5Read(&c->file, name, H5T_NATIVE_DOUBLE, 0, n, values);
  if (c->file.failed) Wrong(c, "%s cannot be read; " WRITTEN, name);
  for (PetscInt64 i = 0; i < n && !c->why[0]; i++) {
    if (!isfinite(values[i])) Wrong(c, "%s holds a value that is not finite; " WRITTEN, name);
    *largest = PetscMax(*largest, fabs(values[i]));
  }
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Mode(Check *c)
{
  PetscReal largest = 0;
  double    growth;
  char      group[64];

  PetscFunctionBegin;
  MpmModeFileGroup(c->scene, group, sizeof group);
  if (!MpmHdf5ReadAttribute(&c->file, group, "growth", H5T_NATIVE_DOUBLE, &growth))
    Wrong(c, "it does not hold mode %" PetscInt_FMT "; allowed: one of those that 'mpmstab spectrum -modes' has kept",
          c->scene->mode[0]);
  for (PetscInt f = 0; c->scene->scheme.table->fields[f] && !c->why[0]; f++) {
    PetscCall(Field(c, group, c->scene->scheme.table->fields[f], "re", &largest));
    PetscCall(Field(c, group, c->scene->scheme.table->fields[f], "im", &largest));
  }
  if (largest == 0) Wrong(c, "mode %" PetscInt_FMT " is zero; " WRITTEN, c->scene->mode[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Examine(Check *c, const char path[])
{
  PetscBool failed;
  int       error;
  FILE     *file = MpmFileOpen(path, &error);

  PetscFunctionBegin;
  if (!file) {
    Wrong(c, "cannot be read; " WRITTEN);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  fclose(file);
  PetscCall(MpmHdf5Open(PETSC_COMM_SELF, path, &c->file));
  if (c->file.failed) {
    Wrong(c, H5Fis_hdf5(path) > 0 ? "cut short or damaged; " WRITTEN : "not an HDF5 file; " WRITTEN);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(SameScene(c));
  if (!c->why[0]) PetscCall(Mode(c));
  PetscCall(MpmHdf5Close(&c->file, &failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModeFileCheck(const MpmScene *scene, const char path[])
{
  Check check = {.scene = scene};

  PetscFunctionBegin;
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) PetscCall(Examine(&check, path));
  PetscCallMPI(MPI_Bcast(check.why, sizeof check.why, MPI_CHAR, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!check.why[0], "mode_file %s: %s", path, check.why);
  PetscFunctionReturn(PETSC_SUCCESS);
}
