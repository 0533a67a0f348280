/* Reads and writes the blocks of a lattice as named arrays. */
#include "base/textfile.h"
#include "io/arrays.h"
#include "io/blocks_file.h"
#include "io/blocks_of_matrix.h"
#include "io/matrix_file.h"
#include "io/datafile.h"
#include <mpmstab/errors.h>
#include <errno.h>
#include <math.h>
#include <string.h>

#define FARTHEST 1e6 /* cells that a block may reach */

static void CheckShapes(const MpmArray *d, const MpmArray *A, char why[MPM_WHY_TEXT])
{
  if (!d || !A || A->dims != 3 || d->dims < 1 || d->dims > 2 || d->shape[0] != A->shape[0])
    (void)snprintf(why, MPM_WHY_TEXT, "%s",
                   "it has no blocks; allowed: arrays d (blocks x directions) and A (blocks x N x N)");
  else if (A->shape[1] != A->shape[2] || A->n == 0)
    (void)snprintf(why, MPM_WHY_TEXT,
                   "its blocks are %" PetscInt64_FMT " of %" PetscInt64_FMT " x %" PetscInt64_FMT
                   "; allowed: at least one, and square",
                   A->shape[0], A->shape[1], A->shape[2]);
  else if (A->shape[1] > MPM_BLOCKS_SIZE || A->n > MPM_BLOCKS_NUMBERS)
    (void)snprintf(why, MPM_WHY_TEXT,
                   "blocks of order %" PetscInt64_FMT ", %.3g numbers; allowed: up to order %d, and up to %.2g "
                   "numbers",
                   A->shape[1], (PetscReal)A->n, MPM_BLOCKS_SIZE, MPM_BLOCKS_NUMBERS);
  else if (d->dims == 2 && (d->shape[1] < 1 || d->shape[1] > MPM_MAX_DIM))
    (void)snprintf(why, MPM_WHY_TEXT, "%" PetscInt64_FMT " directions; allowed: 1 to %d", d->shape[1], MPM_MAX_DIM);
  else if (!MpmArrayIsWhole(d, -FARTHEST))
    (void)snprintf(why, MPM_WHY_TEXT, "array d; allowed: whole numbers of cells from -%g to %g", FARTHEST, FARTHEST);
  for (PetscInt64 i = 0; !why[0] && i < d->n; i++)
    if (d->real[i] > FARTHEST)
      (void)snprintf(why, MPM_WHY_TEXT, "array d; allowed: whole numbers of cells from -%g to %g", FARTHEST, FARTHEST);
  for (PetscInt64 i = 0; !why[0] && i < A->n; i++)
    if (!isfinite(A->real[i]))
      (void)snprintf(why, MPM_WHY_TEXT, "array A: number %" PetscInt64_FMT " is %s; allowed: finite numbers", i + 1,
                     isnan(A->real[i]) ? "nan" : "infinite");
}

/* Takes blocks out of arrays. steps: 0 where the file does not say. */
static PetscErrorCode FromArrays(const MpmArrays *arrays, MpmBlocks *b, char why[MPM_WHY_TEXT])
{
  const MpmArray *d = MpmArraysFind(arrays, "d"), *A = MpmArraysFind(arrays, "A"),
                 *steps = MpmArraysFind(arrays, "steps"), *width = MpmArraysFind(arrays, "cell_width");

  PetscFunctionBegin;
  CheckShapes(d, A, why);
  if (!why[0] && steps && (steps->n != 1 || !MpmArrayIsWhole(steps, 1) || steps->real[0] > MPM_MATRIX_MOST_STEPS))
    (void)snprintf(why, MPM_WHY_TEXT, "steps; allowed: one whole number from 1 to %d", MPM_MATRIX_MOST_STEPS);
  if (!why[0] && width && (width->n != 1 || !(width->real[0] > 0) || isinf(width->real[0])))
    (void)snprintf(why, MPM_WHY_TEXT, "%s", "cell_width; allowed: one number greater than 0");
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  *b = (MpmBlocks){.dim        = d->dims == 1 ? 1 : (PetscInt)d->shape[1],
                   .size       = (PetscInt)A->shape[1],
                   .n          = (PetscInt)A->shape[0],
                   .period     = steps ? (PetscInt)steps->real[0] : 0,
                   .cell_width = width ? width->real[0] : 0};
  PetscCall(MpmBlocksAllocate(b));
  for (PetscInt64 i = 0; i < d->n; i++) b->d[i] = (PetscInt)d->real[i];
  PetscCall(PetscArraycpy(b->A, A->real, (size_t)A->n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Blocks of a matrix that the hook has written. */
static PetscErrorCode FromMatrix(FILE *stream, MpmHooked *hooked, MpmBlocks *b, char why[MPM_WHY_TEXT])
{
  MpmEntries entries = {.n = 0};

  PetscFunctionBegin;
  rewind(stream);
  MpmHookedBegin(&entries.hooked);
  PetscCall(MpmMatrixReadText(stream, &entries, why));
  if (!why[0]) MpmEntriesCheck(&entries, why);
  if (!why[0]) PetscCall(MpmBlocksOfMatrix(&entries, b, why));
  *hooked   = entries.hooked;
  hooked->x = NULL;
  PetscCall(MpmEntriesFree(&entries));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the file on the first rank. */
static PetscErrorCode ReadFile(const char path[], MpmHooked *hooked, MpmBlocks *b, char why[MPM_WHY_TEXT])
{
  static const char *const names[] = {"A", "d", "steps", "cell_width", NULL};
  int                      error;
  FILE                    *stream   = MpmFileOpen(path, &error);
  char                     begin[2] = "";
  PetscBool                hdf5     = PETSC_FALSE;
  MpmArrays                arrays   = {.n = 0};

  PetscFunctionBegin;
  if (stream) PetscCall(MpmHdf5Is(path, &hdf5));
  if (!stream || fread(begin, 1, sizeof begin, stream) != sizeof begin)
    (void)snprintf(why, MPM_WHY_TEXT, "%s; allowed: a file that can be read",
                   !stream          ? MpmFileReason(error)
                   : ferror(stream) ? strerror(errno)
                                    : "it is empty");
  else if (!memcmp(begin, "PK", sizeof begin))
    PetscCall(MpmArraysReadNpz(path, names, &arrays, why));
  else if (hdf5)
    PetscCall(MpmArraysReadHdf5(path, names, &arrays, why));
  else if (!memcmp(begin, "%%", sizeof begin))
    PetscCall(FromMatrix(stream, hooked, b, why));
  else
    (void)snprintf(
        why, MPM_WHY_TEXT, "%s",
        "its format is not known; allowed: HDF5, .npz of numpy.savez, or a matrix that the hook has written");
  if (!why[0] && !b->n) PetscCall(FromArrays(&arrays, b, why));
  PetscCall(MpmArraysFree(&arrays));
  if (stream) (void)fclose(stream);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlocksRead(MPI_Comm comm, const char path[], PetscInt steps, PetscReal tolerance, MpmCertificates *c,
                             MpmBlocks *b)
{
  char              why[MPM_WHY_TEXT] = "";
  PetscInt          sizes[4];
  MpmHooked         hooked;
  const PetscMPIInt rank = MpmRankOf(comm);

  PetscFunctionBegin;
  *b = (MpmBlocks){.n = 0};
  MpmHookedBegin(&hooked);
  if (rank == 0) PetscCall(ReadFile(path, &hooked, b, why));
  PetscCallMPI(MPI_Bcast(why, MPM_WHY_TEXT, MPI_CHAR, 0, comm));
  MpmCheckInput(!why[0], "-matrix_blocks %s: %s", path, why);
  PetscCall(MpmHookedCertificates(comm, &hooked, tolerance, c));
  sizes[0] = b->dim;
  sizes[1] = b->size;
  sizes[2] = b->n;
  sizes[3] = b->period;
  PetscCallMPI(MPI_Bcast(sizes, 4, MPIU_INT, 0, comm));
  MpmCheckInput(!sizes[3] || !steps || sizes[3] == steps,
                "-matrix_steps %" PetscInt_FMT ": %s says that it covers %" PetscInt_FMT "; allowed: without it", steps,
                path, sizes[3]);
  if (rank) {
    *b = (MpmBlocks){.dim = sizes[0], .size = sizes[1], .n = sizes[2]};
    PetscCall(MpmBlocksAllocate(b));
  }
  b->period = sizes[3] ? sizes[3] : PetscMax(1, steps);
  PetscCallMPI(MPI_Bcast(b->d, b->dim * b->n, MPIU_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(b->A, b->n * b->size * b->size, MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast(&b->cell_width, 1, MPIU_REAL, 0, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteHdf5(const char path[], const MpmBlocks *b)
{
  const PetscMPIInt rank = MpmRankOf(PETSC_COMM_WORLD);
  MpmDataFile       file;
  hid_t             whole;

  PetscFunctionBegin;
  PetscCall(MpmDataFileCreate(PETSC_COMM_WORLD, path, &file)); /* first, as it prepares HDF5 */
  whole = sizeof(PetscInt) == sizeof(int32_t) ? H5T_NATIVE_INT32 : H5T_NATIVE_INT64;
  PetscCall(MpmHdf5WriteRows(&file.hdf5, "/d", whole, rank ? 0 : b->n, 1, &b->dim, b->d));
  PetscCall(MpmHdf5WriteRows(&file.hdf5, "/A", H5T_NATIVE_DOUBLE, rank ? 0 : b->n, 2,
                             (const PetscInt[]){b->size, b->size}, b->A));
  MpmHdf5WriteInteger(&file.hdf5, "/", "steps", b->period);
  if (b->cell_width > 0) MpmHdf5WriteReal(&file.hdf5, "/", "cell_width", b->cell_width);
  PetscCall(MpmDataFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WriteNpz(const MpmBlocks *b, FILE *stream)
{
  static const char *const whole[] = {"d", "steps", NULL};
  MpmArrays                arrays  = {.n = 0};
  MpmArray                *a;

  PetscFunctionBegin;
  PetscCall(MpmArraysAdd(&arrays, "d", 2, (const PetscInt64[]){b->n, b->dim}, &a));
  for (PetscInt i = 0; i < b->n * b->dim; i++) a->real[i] = b->d[i];
  PetscCall(MpmArraysAdd(&arrays, "A", 3, (const PetscInt64[]){b->n, b->size, b->size}, &a));
  PetscCall(PetscArraycpy(a->real, b->A, (size_t)a->n));
  PetscCall(MpmArraysAdd(&arrays, "steps", 0, NULL, &a));
  a->real[0] = b->period;
  if (b->cell_width > 0) {
    PetscCall(MpmArraysAdd(&arrays, "cell_width", 0, NULL, &a));
    a->real[0] = b->cell_width;
  }
  PetscCall(MpmArraysWriteNpz(&arrays, whole, stream));
  PetscCall(MpmArraysFree(&arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlocksWrite(const char path[], const MpmBlocks *b)
{
  const char *ending = strrchr(path, '.');
  MpmTextFile file;

  PetscFunctionBegin;
  if (!ending || strcmp(ending, ".npz")) {
    PetscCall(WriteHdf5(path, b));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmTextFileOpen(path, &file));
  if (file.stream) PetscCall(WriteNpz(b, file.stream));
  PetscCall(MpmTextFileClose(&file));
  PetscFunctionReturn(PETSC_SUCCESS);
}
