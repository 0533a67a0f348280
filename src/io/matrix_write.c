/* Writes a matrix in the format that the ending of the file's name says. */
#include "base/file_names.h"
#include "base/textfile.h"
#include "io/datafile.h"
#include "io/matrix_file.h"
#include <mpmstab/errors.h>
#include <math.h>
#include <string.h>

#define LARGEST_NPZ 4e9 /* bytes of a zip archive without extensions */

static PetscErrorCode WriteHdf5(const char path[], const MpmCsr *c, PetscInt steps)
{
  const PetscMPIInt rank     = MpmRankOf(PETSC_COMM_WORLD);
  const PetscInt    n        = rank ? 0 : c->begin[c->order];
  PetscInt64        shape[2] = {c->order, c->order};
  MpmDataFile       file;
  hid_t             whole;

  PetscFunctionBegin;
  PetscCall(MpmDataFileCreate(PETSC_COMM_WORLD, path, &file)); /* first, as it prepares HDF5 */
  whole = sizeof(PetscInt) == sizeof(int32_t) ? H5T_NATIVE_INT32 : H5T_NATIVE_INT64;
  PetscCall(MpmHdf5Write(&file.hdf5, "/data", H5T_NATIVE_DOUBLE, n, 1, c->value));
  PetscCall(MpmHdf5Write(&file.hdf5, "/indices", whole, n, 1, c->column));
  PetscCall(MpmHdf5Write(&file.hdf5, "/indptr", whole, rank ? 0 : c->order + 1, 1, c->begin));
  PetscCall(MpmHdf5Write(&file.hdf5, "/shape", H5T_NATIVE_INT64, rank ? 0 : 2, 1, shape));
  MpmHdf5WriteText(&file.hdf5, "/", "format", "csr");
  MpmHdf5WriteInteger(&file.hdf5, "/", "steps", steps);
  PetscCall(MpmDataFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNpz(const MpmCsr *c, PetscInt steps, FILE *stream)
{
  static const char *const whole[] = {"indices", "indptr", "shape", "steps", NULL};
  const PetscInt           n       = c->begin[c->order];
  MpmArrays                arrays  = {.n = 0};
  MpmArray                *a;

  PetscFunctionBegin;
  PetscCall(MpmArraysAdd(&arrays, "indices", 1, (const PetscInt64[]){n}, &a));
  for (PetscInt k = 0; k < n; k++) a->real[k] = c->column[k];
  PetscCall(MpmArraysAdd(&arrays, "indptr", 1, (const PetscInt64[]){c->order + 1}, &a));
  for (PetscInt i = 0; i <= c->order; i++) a->real[i] = c->begin[i];
  PetscCall(MpmArraysAdd(&arrays, "format", -1, NULL, &a));
  (void)snprintf(a->text, sizeof a->text, "%s", "csr");
  PetscCall(MpmArraysAdd(&arrays, "shape", 1, (const PetscInt64[]){2}, &a));
  a->real[0] = a->real[1] = c->order;
  PetscCall(MpmArraysAdd(&arrays, "data", 1, (const PetscInt64[]){n}, &a));
  PetscCall(PetscArraycpy(a->real, c->value, n));
  PetscCall(MpmArraysAdd(&arrays, "steps", 0, NULL, &a));
  a->real[0] = steps;
  PetscCall(MpmArraysWriteNpz(&arrays, whole, stream));
  PetscCall(MpmArraysFree(&arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses what the format cannot hold. */
static PetscErrorCode Check(const char path[], const MpmCsr *c)
{
  int bad = 0;

  PetscFunctionBegin;
  if (MpmRankOf(PETSC_COMM_WORLD) == 0) {
    for (PetscInt k = 0; k < c->begin[c->order] && !bad; k++) bad = !isfinite(c->value[k]);
    if (MpmFileHasEnding(path, ".npz") && 16.0 * c->begin[c->order] + 8.0 * c->order > LARGEST_NPZ) bad = 2;
  }
  PetscCallMPI(MPI_Bcast(&bad, 1, MPI_INT, 0, PETSC_COMM_WORLD));
  MpmCheckInput(bad != 1,
                "-write_matrix %s: the operator's numbers leave the range of doubles; allowed: finite numbers", path);
  MpmCheckInput(bad != 2, "-write_matrix %s: larger than 4 GB; allowed: .mtx, .h5, .hdf5 or .petsc for it", path);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatrixWrite(const char path[], Mat A, PetscInt exponent, PetscInt steps, PetscBool *kept)
{
  MpmCsr      csr;
  MpmTextFile file;

  PetscFunctionBegin;
  *kept = MpmFileHasEnding(path, ".petsc") && steps > 1 ? PETSC_FALSE : PETSC_TRUE;
  PetscCall(MpmCsrGather(A, exponent, &csr));
  PetscCall(Check(path, &csr));
  if (MpmFileHasEnding(path, ".h5 .hdf5"))
    PetscCall(WriteHdf5(path, &csr, steps));
  else {
    PetscCall(MpmTextFileOpen(path, &file));
    if (file.stream && MpmFileHasEnding(path, ".npz"))
      PetscCall(WriteNpz(&csr, steps, file.stream));
    else if (file.stream && MpmFileHasEnding(path, ".mtx"))
      MpmMatrixWriteText(&csr, steps, file.stream);
    else if (file.stream)
      MpmMatrixWritePetsc(&csr, file.stream);
    PetscCall(MpmTextFileClose(&file));
  }
  PetscCall(MpmCsrFree(&csr));
  PetscFunctionReturn(PETSC_SUCCESS);
}
