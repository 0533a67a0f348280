/*
   LU factorization of a band with partial pivoting, by LAPACK's dgbtrf. A ring of cells is folded in the order 0, n-1,
   1, n-2, ... so that its two ends become neighbours; rows that were d apart are then at most 2 d apart. The factors
   take twice the memory of those in a fill-reducing order, but they are dense blocks, and rows can be pivoted. One rank
   does all of the work, since a narrow band has no parallelism.

   Column j is stored from row j - lower - upper on. These are lower rows more than the matrix has; pivoting fills them.
*/
#include "linalg/band_lu.h"
#include "linalg/lapack_names.h"

#define DGBTRF MPM_LAPACK(dgbtrf, DGBTRF)

extern void DGBTRF(const PetscBLASInt *m, const PetscBLASInt *n, const PetscBLASInt *kl, const PetscBLASInt *ku,
                   double *ab, const PetscBLASInt *ldab, PetscBLASInt *ipiv, PetscBLASInt *info);

/* The first rank alone uses all members but n, lower, upper and folded, which give the place of a row. */
typedef struct {
  PetscBLASInt  n, lower, upper; /* order, diagonals below and above */
  PetscBool     folded, first_rank;
  PetscReal    *column;
  PetscBLASInt *pivot, *first; /* first: row of the first nonzero of U's column */
  PetscReal    *x;
  Vec           whole;
  VecScatter    gather;
} Band;

static PetscInt RowLength(const Band *b)
{
  return 2 * b->lower + b->upper + 1;
}

/* Returns the place of the matrix' row i in the band. */
static PetscInt PlaceOf(const Band *b, PetscInt i)
{
  return b->folded ? MpmFoldedPlace(b->n, i) : i;
}

/*
   Counts the diagonals of the matrix in its own order and in the folded order, and takes the order that needs less
   memory.
*/
static PetscErrorCode Measure(Mat matrix, Band *b)
{
  Band     way[2]   = {{.folded = PETSC_FALSE}, {.folded = PETSC_TRUE}};
  PetscInt sides[4] = {0, 0, 0, 0}, begin, end, n;

  PetscFunctionBegin;
  PetscCall(MatGetSize(matrix, &n, NULL));
  for (int w = 0; w < 2; w++) PetscCall(PetscBLASIntCast(n, &way[w].n));
  PetscCall(MatGetOwnershipRange(matrix, &begin, &end));
  for (PetscInt i = begin; i < end; i++) {
    const PetscInt *columns;
    PetscInt        count;

    PetscCall(MatGetRow(matrix, i, &count, &columns, NULL));
    for (PetscInt c = 0; c < count; c++)
      for (int w = 0; w < 2; w++) {
        const PetscInt beyond = PlaceOf(&way[w], columns[c]) - PlaceOf(&way[w], i);

        sides[2 * w]     = PetscMax(sides[2 * w], -beyond);
        sides[2 * w + 1] = PetscMax(sides[2 * w + 1], beyond);
      }
    PetscCall(MatRestoreRow(matrix, i, &count, &columns, NULL));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sides, 4, MPIU_INT, MPI_MAX, PetscObjectComm((PetscObject)matrix)));
  for (int w = 0; w < 2; w++) {
    PetscCall(PetscBLASIntCast(sides[2 * w], &way[w].lower));
    PetscCall(PetscBLASIntCast(sides[2 * w + 1], &way[w].upper));
  }
  *b = way[RowLength(&way[1]) < RowLength(&way[0]) ? 1 : 0];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBandLUBytes(Mat matrix, PetscReal *bytes)
{
  Band b;

  PetscFunctionBegin;
  PetscCall(Measure(matrix, &b));
  *bytes = (PetscReal)sizeof(PetscReal) * (PetscReal)RowLength(&b) * (PetscReal)b.n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Release(Band *b)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(b->column));
  PetscCall(PetscFree3(b->pivot, b->first, b->x));
  PetscCall(VecDestroy(&b->whole));
  PetscCall(VecScatterDestroy(&b->gather));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FactorSymbolic(Mat factor, Mat matrix, IS rows, IS columns, const MatFactorInfo *info)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)matrix);
  PetscMPIInt    rank;
  Band          *b;
  Vec            x;
  int            failed = 0;

  PetscFunctionBegin;
  (void)rows;
  (void)columns;
  (void)info;
  PetscCall(MatShellGetContext(factor, &b));
  PetscCall(Release(b));
  PetscCall(Measure(matrix, b));
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  b->first_rank = rank ? PETSC_FALSE : PETSC_TRUE;
  PetscCall(MatCreateVecs(matrix, &x, NULL));
  PetscCall(VecScatterCreateToZero(x, &b->gather, &b->whole));
  PetscCall(VecDestroy(&x));
  if (rank == 0)
    failed = PetscMalloc1((size_t)RowLength(b) * (size_t)b->n, &b->column) ||
             PetscMalloc3(b->n, &b->pivot, b->n, &b->first, b->n, &b->x);
  PetscCallMPI(MPI_Bcast(&failed, 1, MPI_INT, 0, comm)); /* otherwise they would wait for the first rank */
  PetscCheck(!failed, comm, PETSC_ERR_MEM, "no memory for the factors of a band");
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Gathers the whole matrix on the first rank; on others whole holds no matrix. */
static PetscErrorCode Gather(Mat matrix, const Band *b, Mat **whole)
{
  IS all;

  PetscFunctionBegin;
  PetscCall(ISCreateStride(PETSC_COMM_SELF, b->n, 0, 1, &all));
  PetscCall(MatCreateSubMatrices(matrix, b->first_rank ? 1 : 0, &all, &all, MAT_INITIAL_MATRIX, whole));
  PetscCall(ISDestroy(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Fill(Mat matrix, Band *b)
{
  const PetscInt length = RowLength(b);

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(b->column, (size_t)length * (size_t)b->n));
  for (PetscInt i = 0; i < b->n; i++) {
    const PetscInt     row = PlaceOf(b, i);
    const PetscInt    *columns;
    const PetscScalar *values;
    PetscInt           count;

    PetscCall(MatGetRow(matrix, i, &count, &columns, &values));
    for (PetscInt c = 0; c < count; c++) {
      const PetscInt column = PlaceOf(b, columns[c]);

      b->column[(size_t)length * (size_t)column + (size_t)(b->lower + b->upper + row - column)] = values[c];
    }
    PetscCall(MatRestoreRow(matrix, i, &count, &columns, &values));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Finds the first nonzero of each column of U. Where few rows were swapped, U does not fill all of its room. */
static void FindFirst(Band *b)
{
  const PetscBLASInt above = b->lower + b->upper;

  for (PetscBLASInt j = 0; j < b->n; j++) {
    const PetscReal *column = b->column + (size_t)RowLength(b) * (size_t)j;
    PetscBLASInt     i      = PetscMax(0, above - j);

    while (i < above && column[i] == 0) i++;
    b->first[j] = j - above + i;
  }
}

static PetscErrorCode FactorNumeric(Mat factor, Mat matrix, const MatFactorInfo *how)
{
  const MPI_Comm comm = PetscObjectComm((PetscObject)matrix);
  Band          *b;
  Mat           *whole = NULL;
  PetscMPIInt    ranks;
  PetscBLASInt   length;
  int            info = 0;

  PetscFunctionBegin;
  (void)how;
  PetscCall(MatShellGetContext(factor, &b));
  PetscCall(PetscBLASIntCast(RowLength(b), &length));
  PetscCallMPI(MPI_Comm_size(comm, &ranks));
  if (ranks > 1) PetscCall(Gather(matrix, b, &whole));
  if (b->first_rank) {
    PetscBLASInt row;

    PetscCall(Fill(whole ? whole[0] : matrix, b));
    DGBTRF(&b->n, &b->n, &b->lower, &b->upper, b->column, &length, b->pivot, &row);
    info = (int)row;
    FindFirst(b);
  }
  if (ranks > 1) PetscCall(MatDestroySubMatrices(b->first_rank ? 1 : 0, &whole));
  PetscCallMPI(MPI_Bcast(&info, 1, MPI_INT, 0, comm));
  PetscCheck(info <= 0, comm, PETSC_ERR_MAT_LU_ZRPVT, "pivot %d is 0", info);
  PetscCheck(info == 0, comm, PETSC_ERR_LIB, "dgbtrf failed: %d", info);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Solves with the factors: x = U^-1 L^-1 x. Rows are swapped just before the elimination that needs it. This replaces
   LAPACK's dgbtrs, which calls BLAS for each column.
*/
static void SolveBand(const Band *b, PetscReal *restrict x)
{
  const PetscInt length = RowLength(b), above = b->lower + b->upper, n = b->n;

  for (PetscInt j = 0; j < n; j++) {
    const PetscReal *restrict column = b->column + (size_t)length * (size_t)j + above;
    const PetscInt  below = PetscMin(b->lower, n - 1 - j), other = b->pivot[j] - 1;
    const PetscReal value = x[other];

    x[other] = x[j];
    x[j]     = value;
    for (PetscInt i = 1; i <= below; i++) x[j + i] -= value * column[i];
  }
  for (PetscInt j = n - 1; j >= 0; j--) {
    const PetscReal *restrict column = b->column + (size_t)length * (size_t)j + above - j;
    const PetscReal value            = x[j] / column[j];

    x[j] = value;
    for (PetscInt i = b->first[j]; i < j; i++) x[i] -= value * column[i];
  }
}

static PetscErrorCode Solve(Mat factor, Vec right, Vec solution)
{
  Band      *b;
  PetscReal *y;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(factor, &b));
  PetscCall(VecScatterBegin(b->gather, right, b->whole, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(b->gather, right, b->whole, INSERT_VALUES, SCATTER_FORWARD));
  if (b->first_rank) {
    PetscCall(VecGetArray(b->whole, &y));
    for (PetscInt i = 0; i < b->n; i++) b->x[PlaceOf(b, i)] = y[i];
    SolveBand(b, b->x);
    for (PetscInt i = 0; i < b->n; i++) y[i] = b->x[PlaceOf(b, i)];
    PetscCall(VecRestoreArray(b->whole, &y));
  }
  PetscCall(VecScatterBegin(b->gather, b->whole, solution, INSERT_VALUES, SCATTER_REVERSE));
  PetscCall(VecScatterEnd(b->gather, b->whole, solution, INSERT_VALUES, SCATTER_REVERSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode GetInfo(Mat factor, MatInfoType which, MatInfo *info)
{
  Band *b;

  PetscFunctionBegin;
  (void)which;
  PetscCall(MatShellGetContext(factor, &b));
  PetscCall(PetscMemzero(info, sizeof *info));
  info->nz_allocated = info->nz_used = (PetscLogDouble)RowLength(b) * b->n;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Mat factor)
{
  Band *b;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(factor, &b));
  PetscCall(Release(b));
  PetscCall(PetscFree(b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode SolverType(Mat factor, MatSolverType *type)
{
  (void)factor;
  *type = MPM_SOLVER_BAND;
  return PETSC_SUCCESS;
}

static PetscErrorCode Create(Mat matrix, MatFactorType type, Mat *factor)
{
  PetscInt rows, n;
  Band    *b;

  PetscFunctionBegin;
  PetscCall(MatGetLocalSize(matrix, &rows, NULL));
  PetscCall(MatGetSize(matrix, &n, NULL));
  PetscCall(PetscNew(&b));
  PetscCall(MatCreateShell(PetscObjectComm((PetscObject)matrix), rows, rows, n, n, b, factor));
  PetscCall(MatShellSetOperation(*factor, MATOP_LUFACTOR_SYMBOLIC, (void (*)(void))FactorSymbolic));
  PetscCall(MatShellSetOperation(*factor, MATOP_LUFACTOR_NUMERIC, (void (*)(void))FactorNumeric));
  PetscCall(MatShellSetOperation(*factor, MATOP_SOLVE, (void (*)(void))Solve));
  PetscCall(MatShellSetOperation(*factor, MATOP_GETINFO, (void (*)(void))GetInfo));
  PetscCall(MatShellSetOperation(*factor, MATOP_DESTROY, (void (*)(void))Destroy));
  PetscCall(PetscObjectComposeFunction((PetscObject)*factor, "MatFactorGetSolverType_C", SolverType));
  PetscCall(MatSetFactorType(*factor, type));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBandLURegister(void)
{
  static PetscBool registered;

  PetscFunctionBegin;
  if (registered) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatSolverTypeRegister(MPM_SOLVER_BAND, MATSEQAIJ, MAT_FACTOR_LU, Create));
  PetscCall(MatSolverTypeRegister(MPM_SOLVER_BAND, MATMPIAIJ, MAT_FACTOR_LU, Create));
  registered = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}
