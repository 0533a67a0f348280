/*
   All eigenvalues and vectors by LAPACK's dgeev, which balances. SLEPc's solver lapack takes twice the time: it also
   sorts the Schur form by swapping rows one after the other, although Sort() sorts again, and it computes vectors one
   by one. Vectors take dgeev nearly as long as eigenvalues, so those of a band are found by inverse iteration.
*/
#include "base/hash.h"
#include "linalg/dense.h"
#include "linalg/eigen_parts.h"

/* Options that only SLEPc's solver can follow. */
static const char *const slepcs[] = {
    "-eps_type",           "-eps_view",           "-eps_view_values",    "-eps_view_vectors",
    "-eps_error_absolute", "-eps_error_relative", "-eps_error_backward", "-eps_converged_reason"};

PetscErrorCode MpmEigenDenseIsPlain(EPS eps, PetscBool *plain)
{
  ST          st;
  STType      transform;
  PetscScalar shift;
  PetscBool   lapack, asked = PETSC_FALSE;
  const char *prefix;

  PetscFunctionBegin;
  PetscCall(EPSGetST(eps, &st));
  PetscCall(STGetShift(st, &shift));
  PetscCall(STGetType(st, &transform));
  PetscCall(PetscObjectTypeCompare((PetscObject)eps, EPSLAPACK, &lapack));
  PetscCall(EPSGetOptionsPrefix(eps, &prefix));
  for (size_t o = 0; o < PETSC_STATIC_ARRAY_LENGTH(slepcs) && !asked; o++)
    PetscCall(PetscOptionsHasName(NULL, prefix, slepcs[o], &asked));
  *plain = lapack && !asked && shift == 0 && (!transform || !strcmp(transform, STSHIFT)) ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Solves on one rank. The vectors take the place of the matrix. */
static PetscErrorCode SolveAlone(PetscInt n, PetscReal re[], PetscReal im[], PetscReal **matrix, int *bad)
{
  PetscReal      *vectors;
  MpmBandVectors *band;

  PetscFunctionBegin;
  PetscCall(MpmBandVectorsCreate(n, *matrix, &band));
  if (band) {
    PetscCall(MpmDenseEigen(n, *matrix, re, im, NULL, bad));
    if (!*bad) PetscCall(MpmBandVectorsFind(band, re, im, *matrix));
    PetscCall(MpmBandVectorsDestroy(&band));
  } else {
    PetscCall(PetscMalloc1((size_t)n * n, &vectors));
    PetscCall(MpmDenseEigen(n, *matrix, re, im, vectors, bad));
    PetscCall(PetscFree(*matrix));
    *matrix = vectors;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenDenseSolve(Mat A, PetscReal re[], PetscReal im[], PetscReal *rows[], PetscBool *failed)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)A);
  PetscMPIInt    rank, count;
  PetscInt       n, begin, end;
  PetscReal     *whole, *column;
  int            bad = 0;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCall(MatGetSize(A, &n, NULL));
  PetscCall(MatGetOwnershipRange(A, &begin, &end));
  PetscCall(PetscMPIIntCast(n, &count));
  PetscCall(PetscMalloc1((size_t)n * n, &whole));
  PetscCall(PetscMalloc1(n, &column));
  PetscCall(MpmDenseCopy(A, whole));
  if (rank == 0)
    PetscCall(SolveAlone(n, re, im, &whole, &bad));
  else
    PetscCall(PetscFree(whole));
  PetscCallMPI(MPI_Bcast(&bad, 1, MPI_INT, 0, comm));
  PetscCallMPI(MPI_Bcast(re, count, MPIU_REAL, 0, comm));
  PetscCallMPI(MPI_Bcast(im, count, MPIU_REAL, 0, comm));
  PetscCall(PetscMalloc1((size_t)n * (end - begin), rows));
  for (PetscInt j = 0; j < n; j++) {
    if (rank == 0) PetscCall(PetscArraycpy(column, whole + (size_t)n * j, n));
    PetscCallMPI(MPI_Bcast(column, count, MPIU_REAL, 0, comm));
    PetscCall(PetscArraycpy(*rows + (size_t)(end - begin) * j, column + begin, end - begin));
  }
  PetscCall(PetscFree(column));
  PetscCall(PetscFree(whole));
  *failed = bad ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmEigenDenseVector(const PetscReal rows[], const PetscReal value_im[], PetscInt j, Vec re, Vec im)
{
  const PetscInt first = value_im[j] < 0 ? j - 1 : j;
  PetscInt       n;
  PetscReal     *x[2];

  PetscFunctionBegin;
  PetscCall(VecGetLocalSize(re, &n));
  PetscCall(VecGetArrayWrite(re, &x[0]));
  PetscCall(VecGetArrayWrite(im, &x[1]));
  for (PetscInt i = 0; i < n; i++) {
    const PetscReal *row = rows + (size_t)n * first + i;

    x[0][i] = row[0];
    x[1][i] = value_im[j] == 0 ? 0 : value_im[j] < 0 ? -row[n] : row[n];
  }
  PetscCall(VecRestoreArrayWrite(re, &x[0]));
  PetscCall(VecRestoreArrayWrite(im, &x[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   ---- vectors of a band ----

   Inverse iteration: y = (A - z)^-1 b in complex arithmetic, with partial pivoting. b is eliminated along with the
   matrix, so that only U is kept.

   Row i of the work space begins with column i - lower, or with column 0. When column i has been eliminated from a row,
   the row moves left by one number. So all rows that column i is eliminated from begin with this column, and they are
   swapped and subtracted number by number. Each row has its real parts first and then its imaginary parts.
*/

#define GOOD 1e-14  /* residual, over norm(A), with which a vector is not improved */
#define LARGE 1e100 /* a solution of this size is scaled, since that of a long Jordan block would overflow */

struct MpmBandVectors {
  PetscInt  n, lower, width; /* order, diagonals below, diagonals in all */
  PetscBool folded;
  PetscReal norm, *matrix, *rows, *x[2]; /* matrix: n x width, real; rows: n x 2 width; x: real and imaginary part */
};

/* The place of i in the folded order 0, n-1, 1, n-2, ... of a ring. */
static PetscInt FoldedPlace(PetscInt n, PetscInt i)
{
  return i < (n + 1) / 2 ? 2 * i : 2 * (n - 1 - i) + 1;
}

static PetscInt PlaceOf(const MpmBandVectors *b, PetscInt i)
{
  return b->folded ? FoldedPlace(b->n, i) : i;
}

/* Counts the diagonals of the matrix in its own order and in the folded order, and takes the one with less work. */
static void Measure(PetscInt n, const PetscReal matrix[], MpmBandVectors *b)
{
  MpmBandVectors way[2]   = {{.n = n, .folded = PETSC_FALSE}, {.n = n, .folded = PETSC_TRUE}};
  PetscInt       upper[2] = {0, 0};

  for (PetscInt j = 0; j < n; j++)
    for (PetscInt i = 0; i < n; i++) {
      if (matrix[(size_t)n * j + i] == 0) continue;
      for (int w = 0; w < 2; w++) {
        const PetscInt beyond = PlaceOf(&way[w], j) - PlaceOf(&way[w], i);

        way[w].lower = PetscMax(way[w].lower, -beyond);
        upper[w]     = PetscMax(upper[w], beyond);
      }
    }
  for (int w = 0; w < 2; w++) way[w].width = way[w].lower + upper[w] + 1;
  *b = way[way[1].lower * way[1].width < way[0].lower * way[0].width ? 1 : 0];
}

static void Copy(MpmBandVectors *b, const PetscReal matrix[])
{
  for (PetscInt i = 0; i < b->n; i++) {
    const PetscInt row  = PlaceOf(b, i);
    PetscReal     *into = b->matrix + b->width * row - PetscMax(0, row - b->lower), sum = 0;

    for (PetscInt j = 0; j < b->n; j++) {
      const PetscReal value = matrix[(size_t)b->n * j + i];

      if (value != 0) into[PlaceOf(b, j)] = value;
      sum += fabs(value);
    }
    b->norm = PetscMax(b->norm, sum);
  }
}

PetscErrorCode MpmBandVectorsCreate(PetscInt n, const PetscReal matrix[], MpmBandVectors **band)
{
  MpmBandVectors b;

  PetscFunctionBegin;
  *band = NULL;
  Measure(n, matrix, &b);
  if (b.lower * b.width > n / 2) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscCalloc1(n * b.width, &b.matrix));
  PetscCall(PetscMalloc3(2 * n * b.width, &b.rows, n, &b.x[0], n, &b.x[1]));
  Copy(&b, matrix);
  PetscCall(PetscNew(band));
  **band = b;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBandVectorsDestroy(MpmBandVectors **band)
{
  PetscFunctionBegin;
  if (!*band) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree((*band)->matrix));
  PetscCall(PetscFree3((*band)->rows, (*band)->x[0], (*band)->x[1]));
  PetscCall(PetscFree(*band));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fills the rows with A - z. */
static void Shift(MpmBandVectors *b, PetscReal re, PetscReal im)
{
  for (PetscInt i = 0; i < b->n; i++) {
    const PetscReal *from = b->matrix + b->width * i;
    PetscReal       *row  = b->rows + 2 * b->width * i;
    const PetscInt   here = PetscMin(i, b->lower);

    for (PetscInt c = 0; c < b->width; c++) {
      row[c]            = from[c];
      row[b->width + c] = 0;
    }
    row[here] -= re;
    row[b->width + here] -= im;
  }
}

/* Swaps row i with the one below that has the largest number in column i, and gives the pivot's inverse. */
static void Pivot(MpmBandVectors *b, PetscInt i, PetscInt last, PetscReal inverse[2])
{
  const PetscReal least = PETSC_MACHINE_EPSILON * (b->norm > 0 ? b->norm : 1);
  const PetscInt  w     = b->width;
  PetscReal      *row   = b->rows + 2 * w * i, *largest, size;
  PetscInt        at    = i;

  for (PetscInt r = i + 1; r <= last; r++) {
    const PetscReal *other = b->rows + 2 * w * r;

    largest = b->rows + 2 * w * at;
    if (fabs(other[0]) + fabs(other[w]) > fabs(largest[0]) + fabs(largest[w])) at = r;
  }
  largest = b->rows + 2 * w * at;
  for (PetscInt c = 0; c < 2 * w && at != i; c++) {
    const PetscReal kept = row[c];

    row[c]     = largest[c];
    largest[c] = kept;
  }
  for (int part = 0; part < 2; part++) {
    const PetscReal kept = b->x[part][i];

    b->x[part][i]  = b->x[part][at];
    b->x[part][at] = kept;
  }
  if (fabs(row[0]) + fabs(row[w]) < least) {
    row[0] = least;
    row[w] = 0;
  }
  size       = row[0] * row[0] + row[w] * row[w];
  inverse[0] = row[0] / size;
  inverse[1] = -row[w] / size;
}

/* Subtracts a multiple of the pivot's row, and moves the row left. */
static void Subtract(PetscInt width, PetscReal re, PetscReal im, const PetscReal pivot[], PetscReal *restrict row,
                     PetscReal *restrict imaginary)
{
  for (PetscInt c = 1; c < width; c++) {
    row[c - 1]       = row[c] - (re * pivot[c] - im * pivot[width + c]);
    imaginary[c - 1] = imaginary[c] - (re * pivot[width + c] + im * pivot[c]);
  }
  row[width - 1] = imaginary[width - 1] = 0;
}

static void Eliminate(MpmBandVectors *b)
{
  const PetscInt w = b->width;

  for (PetscInt i = 0; i < b->n; i++) {
    const PetscInt   last  = PetscMin(b->n - 1, i + b->lower);
    const PetscReal *pivot = b->rows + 2 * w * i;
    PetscReal        inverse[2];

    Pivot(b, i, last, inverse);
    for (PetscInt r = i + 1; r <= last; r++) {
      PetscReal      *row = b->rows + 2 * w * r;
      const PetscReal re = row[0] * inverse[0] - row[w] * inverse[1], im = row[0] * inverse[1] + row[w] * inverse[0];

      Subtract(w, re, im, pivot, row, row + w);
      b->x[0][r] -= re * b->x[0][i] - im * b->x[1][i];
      b->x[1][r] -= re * b->x[1][i] + im * b->x[0][i];
    }
  }
}

static void Scale(const MpmBandVectors *b, PetscReal factor)
{
  for (int part = 0; part < 2; part++)
    for (PetscInt i = 0; i < b->n; i++) b->x[part][i] *= factor;
}

static PetscReal Norm(const MpmBandVectors *b)
{
  PetscReal sum = 0;

  for (int part = 0; part < 2; part++)
    for (PetscInt i = 0; i < b->n; i++) sum += b->x[part][i] * b->x[part][i];
  return sqrt(sum);
}

/* Solves with U, and returns the scale of the solution. */
static PetscReal Substitute(MpmBandVectors *b)
{
  const PetscInt w     = b->width;
  PetscReal      scale = 1;

  for (PetscInt i = b->n - 1; i >= 0; i--) {
    const PetscReal *row = b->rows + 2 * w * i, size = row[0] * row[0] + row[w] * row[w];
    PetscReal        re = b->x[0][i], im = b->x[1][i];

    for (PetscInt c = 1; c < PetscMin(w, b->n - i); c++) {
      re -= row[c] * b->x[0][i + c] - row[w + c] * b->x[1][i + c];
      im -= row[c] * b->x[1][i + c] + row[w + c] * b->x[0][i + c];
    }
    b->x[0][i] = (re * row[0] + im * row[w]) / size;
    b->x[1][i] = (im * row[0] - re * row[w]) / size;
    if (fabs(b->x[0][i]) + fabs(b->x[1][i]) > LARGE) {
      Scale(b, 1 / LARGE);
      scale /= LARGE;
    }
  }
  return scale;
}

/* Fills x with a vector, or without one with random numbers, and makes its norm 1. */
static void Start(const MpmBandVectors *b, PetscInt64 seed, const PetscReal vector[], PetscInt parts)
{
  for (PetscInt part = 0; part < 2; part++)
    for (PetscInt i = 0; i < b->n; i++) {
      const PetscInt at = b->n * part + i;

      b->x[part][PlaceOf(b, i)] = part >= parts ? 0 : vector ? vector[at] : MpmHash(seed, at) - 0.5;
    }
  Scale(b, 1 / Norm(b));
}

/*
   Finds a vector from a random start and, unless its residual is small, from what was found. The second start gains a
   digit, but beside a defective eigenvalue it loses half of the digits, so the better vector is kept.
*/
static void FindOne(MpmBandVectors *b, PetscInt64 seed, PetscReal re, PetscReal im, PetscReal vector[])
{
  const PetscInt parts = im == 0 ? 1 : 2;
  PetscReal      least = PETSC_MAX_REAL;

  for (int start = 0; start < 2 && least > GOOD * b->norm; start++) {
    PetscReal scale, norm;

    Start(b, seed, start > 0 ? vector : NULL, parts);
    Shift(b, re, im);
    Eliminate(b);
    scale = Substitute(b);
    norm  = Norm(b);
    if (!(scale / norm < least)) continue;
    least = scale / norm;
    for (PetscInt part = 0; part < parts; part++)
      for (PetscInt i = 0; i < b->n; i++) vector[b->n * part + i] = b->x[part][PlaceOf(b, i)] / norm;
  }
}

PetscErrorCode MpmBandVectorsFind(MpmBandVectors *b, const PetscReal re[], const PetscReal im[], PetscReal vectors[])
{
  PetscFunctionBegin;
  for (PetscInt j = 0; j < b->n; j++)
    if (im[j] >= 0) FindOne(b, j, re[j], im[j], vectors + (size_t)b->n * j);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   ---- matrices whose eigenvalues are all 0 because of where their entries are ----

   Unknowns that feel nobody else are taken away, then those that felt only these, and so on (Kahn 1962). The matrix is
   strictly triangular in this order if none is left.
*/

/* The unknowns that are taken away, one after the other; AT has a row for each column of the matrix. */
static PetscErrorCode TakeAway(Mat A, Mat AT, PetscInt order, PetscInt *taken, PetscInt *last)
{
  PetscInt          *felt, *queue, n = 0;
  const PetscInt    *columns;
  const PetscScalar *values;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(order, &felt, order, &queue));
  for (PetscInt i = 0; i < order; i++) {
    PetscInt entries;

    PetscCall(MatGetRow(A, i, &entries, NULL, &values));
    for (PetscInt k = 0; k < entries; k++) felt[i] += values[k] != 0;
    PetscCall(MatRestoreRow(A, i, &entries, NULL, &values));
    if (!felt[i]) queue[n++] = i;
  }
  for (*taken = 0; *taken < n; ++*taken) {
    PetscInt entries;

    PetscCall(MatGetRow(AT, queue[*taken], &entries, &columns, &values));
    for (PetscInt k = 0; k < entries; k++)
      if (values[k] != 0 && !--felt[columns[k]]) queue[n++] = columns[k];
    PetscCall(MatRestoreRow(AT, queue[*taken], &entries, &columns, &values));
  }
  *last = n ? queue[n - 1] : -1;
  PetscCall(PetscFree2(felt, queue));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNilpotentFind(Mat A, PetscInt *unit)
{
  PetscInt    order, taken = 0, last = -1;
  PetscReal   diagonal;
  PetscBool   sparse;
  PetscMPIInt size;
  Vec         d;
  Mat         whole, transposed;

  PetscFunctionBegin;
  *unit = -1;
  PetscCall(PetscObjectTypeCompareAny((PetscObject)A, &sparse, MATSEQAIJ, MATMPIAIJ, ""));
  if (!sparse) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateVecs(A, &d, NULL));
  PetscCall(MatGetDiagonal(A, d));
  PetscCall(VecNorm(d, NORM_INFINITY, &diagonal));
  PetscCall(VecDestroy(&d));
  if (diagonal != 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)A), &size));
  PetscCall(MatCreateRedundantMatrix(A, size, MPI_COMM_NULL, MAT_INITIAL_MATRIX, &whole));
  PetscCall(MatTranspose(whole, MAT_INITIAL_MATRIX, &transposed));
  PetscCall(MatGetSize(A, &order, NULL));
  PetscCall(TakeAway(whole, transposed, order, &taken, &last));
  if (taken == order) *unit = last;
  PetscCall(MatDestroy(&transposed));
  PetscCall(MatDestroy(&whole));
  PetscFunctionReturn(PETSC_SUCCESS);
}
