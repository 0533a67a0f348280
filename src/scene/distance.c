/*
   The signed distance of a body, from an HDF5 file: the array distance at the nodes of a grid, with the axes in the
   order x, y, z (as numpy's meshgrid with indexing='ij' has it), the array origin, the place of the first node, and the
   array spacing, of one number or of one for each axis. All are in the scene's unit of length. The first rank reads it,
   and all have a copy.
*/
#include "base/hdf5.h"
#include "base/memory.h"
#include "base/textfile.h"
#include "scene/layout.h"
#include <mpmstab/errors.h>
#include <math.h>

#define MOST_NODES (1 << 30)
#define STEEPEST                                                                                                       \
  2 /* the slope of a distance is 1; of one that is nearly a distance, or of its corners, somewhat more */

typedef struct {
  PetscInt dim;
  char     why[256]; /* what is wrong with the file, after its name; empty: nothing */
} Reader;

#define Why(r, ...) (void)snprintf((r)->why, sizeof(r)->why, __VA_ARGS__)

/* An array of at most three numbers, each finite, or one for all axes. */
static void ReadAxes(Reader *r, MpmHdf5 *file, const char name[], PetscBool one, PetscReal value[])
{
  PetscInt64 shape[1] = {1}; /* of a scalar */
  int        dims;

  if (r->why[0]) return;
  if (!MpmHdf5Array(file, name, 1, &dims, shape) || (dims != 1 && !(one && dims == 0)) ||
      (shape[0] != r->dim && !(one && shape[0] == 1)))
    Why(r, "there is no array %s of %" PetscInt_FMT " numbers in it; allowed: one number for each direction", name,
        r->dim);
  else
    MpmHdf5ReadArray(file, name, value);
  for (PetscInt a = 0; a < r->dim && !r->why[0]; a++) {
    if (shape[0] == 1) value[a] = value[0];
    if (!isfinite(value[a]) || (one && !(value[a] > 0)))
      Why(r, "%s %g; allowed: %s", name, value[a], one ? "finite numbers above 0" : "finite numbers");
  }
}

static void ReadShape(Reader *r, MpmHdf5 *file, MpmDistance *grid)
{
  PetscInt64 shape[MPM_MAX_DIM] = {0}, all = 1;
  int        dims = 0;

  if (!MpmHdf5Array(file, "distance", MPM_MAX_DIM, &dims, shape))
    Why(r, "there is no array distance of at most 3 dimensions in it; allowed: arrays distance, origin and spacing");
  else if (dims != r->dim)
    Why(r, "its distance has %d dimension%s; allowed: as many as the scene, %" PetscInt_FMT, dims, dims > 1 ? "s" : "",
        r->dim);
  for (PetscInt a = 0; a < r->dim && !r->why[0]; a++) {
    grid->n[a] = (PetscInt)shape[a];
    all *= shape[a];
    if (shape[a] < 2 || all > MOST_NODES)
      Why(r, "its distance has %" PetscInt64_FMT " nodes along a direction; allowed: 2 or more, and at most %d in all",
          shape[a], MOST_NODES);
  }
}

/* Values that a distance can have: finite, and not much steeper than 1, below 0 somewhere and above elsewhere. */
static void CheckValues(Reader *r, const MpmDistance *grid, PetscInt all)
{
  PetscBool has[2] = {PETSC_FALSE, PETSC_FALSE};

  for (PetscInt at = 0; at < all && !r->why[0]; at++) {
    if (!isfinite(grid->value[at]))
      Why(r, "number %" PetscInt_FMT " of its distance is %g; allowed: finite numbers", at, grid->value[at]);
    has[grid->value[at] > 0] = PETSC_TRUE;
    for (PetscInt a = r->dim - 1, stride = 1; a >= 0; stride *= grid->n[a--])
      if (at / stride % grid->n[a] && fabs(grid->value[at] - grid->value[at - stride]) > STEEPEST * grid->spacing[a])
        Why(r,
            "its distance changes by %g between nodes that are %g apart; allowed: a distance, in the same unit as its "
            "spacing",
            fabs(grid->value[at] - grid->value[at - stride]), grid->spacing[a]);
  }
  if (!r->why[0] && (!has[0] || !has[1]))
    Why(r, "its distance is %s everywhere; allowed: below 0 inside the body, and above 0 outside",
        has[0] ? "not above 0" : "above 0");
}

static PetscErrorCode Read(Reader *r, const char path[], MpmDistance *grid)
{
  MpmHdf5   file  = {.file = -1};
  PetscBool is    = PETSC_FALSE, failed;
  int       error = 0;
  PetscInt  all   = 1;
  FILE     *stream;

  PetscFunctionBegin;
  stream = MpmFileOpen(path, &error);
  if (!stream) Why(r, "%s; allowed: an HDF5 file with a signed distance", MpmFileReason(error));
  if (stream) {
    (void)fclose(stream);
    PetscCall(MpmHdf5Is(path, &is));
    if (!is) Why(r, "it is not HDF5; allowed: an HDF5 file with a signed distance");
  }
  if (!is) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmHdf5Open(PETSC_COMM_SELF, path, &file));
  ReadShape(r, &file, grid);
  ReadAxes(r, &file, "origin", PETSC_FALSE, grid->origin);
  ReadAxes(r, &file, "spacing", PETSC_TRUE, grid->spacing);
  for (PetscInt a = 0; a < r->dim; a++) all *= grid->n[a];
  if (!r->why[0]) MpmMemoryRoom((PetscReal)all * sizeof(PetscReal), sizeof r->why, r->why);
  if (!r->why[0]) {
    PetscCall(PetscMalloc1(all, &grid->value));
    MpmHdf5ReadArray(&file, "distance", grid->value);
    if (file.failed) Why(r, "HDF5 cannot read it; allowed: a whole file");
    CheckValues(r, grid, all);
  }
  PetscCall(MpmHdf5Close(&file, &failed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDistanceRead(const char where[], const char path[], PetscInt dim, PetscReal unit, MpmDistance **made)
{
  Reader       r = {.dim = dim};
  MpmDistance *grid;
  PetscInt     all = 1;

  PetscFunctionBegin;
  PetscCall(PetscNew(made));
  grid = *made;
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) PetscCall(Read(&r, path, grid));
  PetscCallMPI(MPI_Bcast(r.why, sizeof r.why, MPI_CHAR, 0, PETSC_COMM_WORLD));
  MpmCheckInput(!r.why[0], "%s %s: %s", where, path, r.why);
  PetscCallMPI(MPI_Bcast(grid->n, MPM_MAX_DIM, MPIU_INT, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(grid->origin, MPM_MAX_DIM, MPIU_REAL, 0, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Bcast(grid->spacing, MPM_MAX_DIM, MPIU_REAL, 0, PETSC_COMM_WORLD));
  for (PetscInt a = 0; a < dim; a++) {
    all *= grid->n[a];
    grid->origin[a] /= unit;
    grid->spacing[a] /= unit;
  }
  PetscCall(MpmMemoryCheck(PETSC_COMM_WORLD, path,
                           (PetscReal)all * (PetscReal)sizeof(PetscReal) * MpmRanksOf(PETSC_COMM_WORLD),
                           "a copy of the signed distance on each rank"));
  if (!grid->value) PetscCall(PetscMalloc1(all, &grid->value));
  PetscCallMPI(MPI_Bcast(grid->value, (PetscMPIInt)all, MPIU_REAL, 0, PETSC_COMM_WORLD));
  for (PetscInt at = 0; at < all; at++) grid->value[at] /= unit;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDistanceDestroy(MpmDistance **grid)
{
  PetscFunctionBegin;
  if (*grid) PetscCall(PetscFree((*grid)->value));
  PetscCall(PetscFree(*grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}
