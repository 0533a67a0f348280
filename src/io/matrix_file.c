/*
   Reads a matrix on the first rank, checks it, and deals it to all ranks; writes one in the format that its name's
   ending says.
*/
#include "base/hdf5.h"
#include "base/memory.h"
#include "base/textfile.h"
#include "io/datafile.h"
#include "io/matrix_file.h"
#include "linalg/dense.h"
#include <mpmstab/errors.h>
#include <errno.h>
#include <math.h>
#include <string.h>

/* A sparse matrix on its way between the first rank, which has the file, and all ranks. */

PetscErrorCode MpmEntriesRoom(PetscReal rows, PetscReal columns, PetscReal n, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  PetscFunctionBegin;
  if (!(rows >= 1 && columns >= 1))
    MpmWhy(why, "it is empty, %.0f x %.0f; allowed: a square matrix", rows, columns);
  else if (rows != columns)
    MpmWhy(why, "it is not square, %.0f x %.0f; allowed: a matrix from a state to a state", rows, columns);
  else if (rows != rint(rows) || rows > PETSC_MAX_INT / 2 || !(n >= 0 && n <= MPM_MATRIX_ENTRIES))
    MpmWhy(why, "order %.10g with %.10g entries; allowed: up to %d, with up to %.2g", rows, n, PETSC_MAX_INT / 2,
           MPM_MATRIX_ENTRIES);
  if (!why[0]) MpmMemoryRoom((n + rows) * (2 * sizeof(PetscInt) + sizeof(PetscReal)), MPM_WHY_TEXT, why);
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  e->rows    = (PetscInt64)rows;
  e->columns = (PetscInt64)columns;
  e->n       = (PetscInt64)n;
  PetscCall(PetscMalloc3(e->n + e->rows, &e->row, e->n + e->rows, &e->column, e->n + e->rows, &e->value));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmEntriesCheck(const MpmEntries *e, char why[MPM_WHY_TEXT])
{
  for (PetscInt64 i = 0; i < e->n && !why[0]; i++) {
    if (e->row[i] < 0 || e->row[i] >= e->rows || e->column[i] < 0 || e->column[i] >= e->columns)
      MpmWhy(why,
             "entry %" PetscInt64_FMT " is in row %" PetscInt_FMT " and column %" PetscInt_FMT
             "; allowed: from 0 to %" PetscInt64_FMT ", counted from 0",
             i + 1, e->row[i], e->column[i], e->rows - 1);
    else if (!isfinite(e->value[i]))
      MpmWhy(why,
             "row %" PetscInt_FMT ", column %" PetscInt_FMT ", counted from 0, is %s; allowed: finite "
             "numbers",
             e->row[i], e->column[i], isnan(e->value[i]) ? "nan" : "infinite");
  }
}

void MpmEntriesToScales(MpmEntries *e)
{
  const MpmHooked *h     = &e->hooked;
  const PetscInt   width = (PetscInt)h->scales;

  if (width < 1 || width > MPM_HOOKED_NUMBERS || h->numbers != (PetscReal)width || e->rows % width) return;
  for (PetscInt64 k = 0; k < e->n; k++) e->value[k] *= h->scale[e->column[k] % width] / h->scale[e->row[k] % width];
}

PetscErrorCode MpmEntriesFree(MpmEntries *e)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(e->row, e->column, e->value));
  PetscCall(MpmHookedFree(&e->hooked));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MatrixOf(MPI_Comm comm, MpmEntries *e, Mat *A)
{
  PetscInt order = (PetscInt)e->rows;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(&order, 1, MPIU_INT, 0, comm));
  for (PetscInt i = 0; i < order && MpmRankOf(comm) == 0; i++) {
    e->row[e->n] = e->column[e->n] = i;
    e->value[e->n++]               = 0;
  }
  PetscCall(MatCreate(comm, A));
  PetscCall(MatSetSizes(*A, PETSC_DECIDE, PETSC_DECIDE, order, order));
  PetscCall(MatSetType(*A, MATMPIAIJ));
  PetscCall(MatSetPreallocationCOO(*A, e->n, e->row, e->column));
  PetscCall(MatSetValuesCOO(*A, e->value, INSERT_VALUES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Gather(Mat A, PetscInt exponent, MpmCsr *c)
{
  const PetscMPIInt rank = MpmRankOf(PetscObjectComm((PetscObject)A));
  PetscInt          rows;
  PetscBool         done;

  PetscFunctionBegin;
  PetscCall(MatGetSize(A, &c->order, NULL));
  PetscCall(MpmDenseWhole(A, rank ? PETSC_FALSE : PETSC_TRUE, &c->whole));
  PetscCall(MatGetRowIJ(*c->whole, 0, PETSC_FALSE, PETSC_FALSE, &rows, &c->begin, &c->column, &done));
  PetscCheck(done, PETSC_COMM_SELF, PETSC_ERR_SUP, "a matrix without rows");
  PetscCall(MatSeqAIJGetArray(*c->whole, &c->value));
  for (PetscInt k = 0; k < c->begin[rows]; k++) c->value[k] = scalbn(c->value[k], (int)exponent);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- reading ---- */

/* What the spectrum of a sparse matrix was measured to take at least; LAPACK, up to order 4096, takes 0.3 GB more. */
#define UNKNOWN_BYTES 500
#define ENTRY_BYTES 36

static const char *const formats = "allowed: Matrix Market, PETSc's binary, HDF5, or .npz of scipy.sparse.save_npz";

/* ---- matrices as named arrays ---- */

/* The arrays of a compressed matrix: by rows or by columns, in the names of scipy or of MATLAB. */
typedef struct {
  const MpmArray *data, *inner, *pointer;
  PetscBool       by_columns;
} Compressed;

/* A row or column as PetscInt; what is none becomes -1, which is refused later. */
static PetscInt Index(PetscReal number)
{
  return number >= 0 && number < PETSC_MAX_INT && number == rint(number) ? (PetscInt)number : -1;
}

static PetscErrorCode ReadCompressed(const Compressed *c, const MpmArray *shape, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  const PetscInt64 outer = c->pointer->n - 1, n = c->data->n;
  const PetscReal *at  = c->pointer->real;
  const PetscReal  row = shape ? shape->real[0] : (PetscReal)outer, column = shape ? shape->real[1] : (PetscReal)outer;

  PetscFunctionBegin;
  if (c->inner->n != n || outer < 0 || at[0] != 0 || at[outer] != (PetscReal)n ||
      (PetscReal)outer != (c->by_columns ? column : row) || !MpmArrayIsWhole(c->pointer, 0))
    MpmWhy(why, "its indices and pointers do not fit its data; allowed: pointers from 0 to the number of "
                "entries, one more than rows (or columns, of csc)");
  for (PetscInt64 i = 0; i < outer && !why[0]; i++)
    if (at[i] > at[i + 1]) MpmWhy(why, "its pointers decrease; allowed: csr or csc");
  if (!why[0]) PetscCall(MpmEntriesRoom(row, column, (PetscReal)n, e, why));
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt64 i = 0; i < outer; i++) {
    for (PetscInt64 k = (PetscInt64)at[i]; k < (PetscInt64)at[i + 1]; k++) {
      const PetscInt inner = Index(c->inner->real[k]);

      e->row[k]    = c->by_columns ? inner : (PetscInt)i;
      e->column[k] = c->by_columns ? (PetscInt)i : inner;
      e->value[k]  = c->data->real[k];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadCoo(const MpmArrays *arrays, const MpmArray *data, const MpmArray *shape, MpmEntries *e,
                              char why[MPM_WHY_TEXT])
{
  const MpmArray *row = MpmArraysFind(arrays, "row"), *column = MpmArraysFind(arrays, "col");

  PetscFunctionBegin;
  if (!row || !column || !shape || row->n != data->n || column->n != data->n)
    MpmWhy(why, "it is no coo matrix; allowed: arrays row, col and data of one length, and shape");
  if (!why[0]) PetscCall(MpmEntriesRoom(shape->real[0], shape->real[1], (PetscReal)data->n, e, why));
  if (why[0]) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt64 k = 0; k < data->n; k++) {
    e->row[k]    = Index(row->real[k]);
    e->column[k] = Index(column->real[k]);
    e->value[k]  = data->real[k];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FromArrays(const MpmArrays *arrays, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  const MpmArray *data = MpmArraysFind(arrays, "data"), *shape = MpmArraysFind(arrays, "shape"),
                 *steps = MpmArraysFind(arrays, "steps"), *format = MpmArraysFind(arrays, "format");
  Compressed c = {.data = data, .inner = MpmArraysFind(arrays, "indices"), .pointer = MpmArraysFind(arrays, "indptr")};

  PetscFunctionBegin;
  if (!format) format = MpmArraysFind(arrays, "encoding-type");
  if (shape && shape->n != 2) shape = NULL;
  if (steps && (steps->n != 1 || !MpmArrayIsWhole(steps, 1) || steps->real[0] > MPM_MATRIX_MOST_STEPS)) {
    MpmWhy(why, "steps; allowed: one whole number from 1 to %d", MPM_MATRIX_MOST_STEPS);
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (steps) e->steps = (PetscInt64)steps->real[0];
  if (!c.inner && MpmArraysFind(arrays, "ir")) {
    c.inner      = MpmArraysFind(arrays, "ir");
    c.pointer    = MpmArraysFind(arrays, "jc");
    c.by_columns = PETSC_TRUE;
  }
  if (format && !strncmp(format->text, "csc", 3)) c.by_columns = PETSC_TRUE;
  if (format && strncmp(format->text, "cs", 2) && strncmp(format->text, "coo", 3))
    MpmWhy(why, "format %s; allowed: csr, csc or coo", format->text);
  else if (format && !strncmp(format->text, "coo", 3) && data)
    PetscCall(ReadCoo(arrays, data, shape, e, why));
  else if (data && c.inner && c.pointer && c.pointer->n)
    PetscCall(ReadCompressed(&c, shape, e, why));
  else
    MpmWhy(why, "it has no matrix; allowed: arrays data, indices and indptr (or data, ir and jc)");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- any format ---- */

typedef enum { FORMAT_NONE, FORMAT_TEXT, FORMAT_PETSC, FORMAT_ARRAYS } Format;

static PetscErrorCode FindFormat(const char path[], FILE *stream, Format *format)
{
  static const unsigned char wide[8]  = {0, 0, 0, 0, 0, 0x12, 0x7b, 0x50};
  unsigned char              begin[8] = {0};
  const size_t               n        = fread(begin, 1, sizeof begin, stream);

  PetscBool hdf5;

  PetscFunctionBegin;
  rewind(stream);
  PetscCall(MpmHdf5Is(path, &hdf5));
  *format = hdf5 ? FORMAT_ARRAYS : FORMAT_NONE;
  if (n >= 2 && begin[0] == '%' && begin[1] == '%') *format = FORMAT_TEXT;
  if (n >= 4 && !memcmp(begin, "PK", 2)) *format = FORMAT_ARRAYS;
  if (n == sizeof begin && (!memcmp(begin, wide + 4, 4) || !memcmp(begin, wide, sizeof wide))) *format = FORMAT_PETSC;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ReadFormat(const char path[], FILE *stream, MpmEntries *e, char why[MPM_WHY_TEXT])
{
  static const char *const names[] = {"data",  "indices", "indptr",        "ir", "jc", "row", "col", "format",
                                      "shape", "steps",   "encoding-type", NULL};
  MpmArrays                arrays  = {.n = 0};
  Format                   format  = FORMAT_NONE;

  PetscFunctionBegin;
  PetscCall(FindFormat(path, stream, &format));
  if (format == FORMAT_TEXT) PetscCall(MpmMatrixReadText(stream, e, why));
  if (format == FORMAT_PETSC) PetscCall(MpmMatrixReadPetsc(stream, e, why));
  if (format == FORMAT_ARRAYS) PetscCall(MpmArraysRead(path, names, &arrays, why));
  if (format == FORMAT_NONE) MpmWhy(why, "its format is not known; %s", formats);
  if (format == FORMAT_ARRAYS && !why[0]) PetscCall(FromArrays(&arrays, e, why));
  PetscCall(MpmArraysFree(&arrays));
  if (!why[0]) MpmEntriesCheck(e, why);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Reads the file on the first rank. */
static PetscErrorCode ReadFile(const char path[], MpmEntries *e, char why[MPM_WHY_TEXT])
{
  int   error;
  FILE *stream = MpmFileOpen(path, &error);

  PetscFunctionBegin;
  if (stream && getc(stream) == EOF && ferror(stream)) error = errno;
  if (error)
    MpmWhy(why, "%s; allowed: a file that can be read", MpmFileReason(error));
  else {
    rewind(stream);
    PetscCall(ReadFormat(path, stream, e, why));
  }
  if (stream) (void)fclose(stream);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses a matrix whose spectrum would not fit, before it is one. */
static PetscErrorCode CheckRoom(MPI_Comm comm, const char path[], const MpmEntries *e)
{
  PetscReal size[2] = {(PetscReal)e->rows, (PetscReal)e->n};
  char      what[PETSC_MAX_PATH_LEN];

  PetscFunctionBegin;
  PetscCallMPI(MPI_Bcast(size, 2, MPIU_REAL, 0, comm));
  (void)snprintf(what, sizeof what, "-matrix %.1000s: order %.10g with %.10g entries", path, size[0], size[1]);
  PetscCall(MpmMemoryCheck(comm, what, UNKNOWN_BYTES * size[0] + ENTRY_BYTES * size[1], "its spectrum"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatrixRead(MPI_Comm comm, const char path[], PetscReal tolerance, PetscInt *steps,
                             MpmCertificates *certificates, Mat *A)
{
  MpmEntries        entries           = {.n = 0};
  char              why[MPM_WHY_TEXT] = "";
  PetscInt64        said              = 0;
  const PetscMPIInt rank              = MpmRankOf(comm);

  PetscFunctionBegin;
  MpmHookedBegin(&entries.hooked);
  if (rank == 0) PetscCall(ReadFile(path, &entries, why));
  PetscCallMPI(MPI_Bcast(why, MPM_WHY_TEXT, MPI_CHAR, 0, comm));
  if (why[0]) PetscCall(MpmEntriesFree(&entries));
  MpmCheckInput(!why[0], "-matrix %s: %s", path, why);
  PetscCall(CheckRoom(comm, path, &entries));
  said = entries.steps;
  PetscCallMPI(MPI_Bcast(&said, 1, MPIU_INT64, 0, comm));
  MpmCheckInput(!said || !*steps || said == *steps,
                "-matrix_steps %" PetscInt_FMT ": %s says that it covers %" PetscInt64_FMT "; allowed: without it",
                *steps, path, said);
  MpmCheckInput(said >= 0 && said <= MPM_MATRIX_MOST_STEPS,
                "-matrix %s: it says that it covers %" PetscInt64_FMT " steps; allowed: from 1 to %d", path, said,
                MPM_MATRIX_MOST_STEPS);
  PetscCall(MpmHookedCertificates(comm, &entries.hooked, tolerance, certificates));
  if (!*steps) *steps = said ? (PetscInt)said : 1;
  if (rank == 0) MpmEntriesToScales(&entries);
  PetscCall(MatrixOf(comm, &entries, A));
  PetscCall(MpmEntriesFree(&entries));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- writing ---- */

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
  PetscCall(Gather(A, exponent, &csr));
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
  PetscCall(MatSeqAIJRestoreArray(*csr.whole, &csr.value));
  PetscCall(MatDestroySubMatrices(1, &csr.whole));
  PetscFunctionReturn(PETSC_SUCCESS);
}
