/* Registers as sparse matrices: a program's own matrix, or its powers of the Courant number, of the same lines. */
#include "program/program.h"

/* Where a line is multiplied by k to a power, which for polynomials is not yet a number. */
static PetscReal ValueOf(const MpmMatrices *m, const MpmLine *line)
{
  return m->times_courant ? line->factor : MpmLineValue(line, m->courant);
}

static PetscErrorCode Raise(const MpmMatrices *m, const MpmLine *line, Mat *matrix)
{
  PetscFunctionBegin;
  for (PetscInt power = 0; m->times_courant && power < line->power; power++) {
    Mat product;

    PetscCall(MatMatMult(*matrix, m->times_courant, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &product));
    PetscCall(MatDestroy(matrix));
    *matrix = product;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- one matrix of several ---- */

/*
   Copies the rows of the parts to those of A. A NULL: counts their numbers, in the columns of this rank (own) and in
   those of others (far).
*/
static PetscErrorCode CopyRows(PetscInt parts, const Mat part[], Mat A, PetscInt own[], PetscInt far[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < parts; f++) {
    PetscInt first, end, begin_column, end_column;

    if (!part[f]) continue;
    PetscCall(MatGetOwnershipRange(part[f], &first, &end));
    PetscCall(MatGetOwnershipRangeColumn(part[f], &begin_column, &end_column));
    for (PetscInt p = first; p < end; p++) {
      const PetscInt     row = parts * p + f, mine = parts * (p - first) + f;
      const PetscInt    *columns;
      const PetscScalar *values;
      PetscInt           n;

      PetscCall(MatGetRow(part[f], p, &n, &columns, &values));
      if (A) PetscCall(MatSetValues(A, 1, &row, n, columns, values, INSERT_VALUES));
      for (PetscInt c = 0; c < n && !A; c++)
        ++*(columns[c] >= begin_column && columns[c] < end_column ? &own[mine] : &far[mine]);
      PetscCall(MatRestoreRow(part[f], p, &n, &columns, &values));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   One matrix of so many parts, NULL where they are 0: row i of part f becomes row parts x i + f. rows, columns: how
   many this rank has of each part. diagonal: the result has every entry of its diagonal, if only as 0, so that it can
   be shifted.
*/
static PetscErrorCode Interleave(MPI_Comm comm, PetscInt parts, const Mat part[], PetscInt rows, PetscInt columns,
                                 PetscBool diagonal, Mat *A)
{
  PetscInt *own, *far, begin, end;

  PetscFunctionBegin;
  PetscCall(PetscCalloc2(parts * rows, &own, parts * rows, &far));
  for (PetscInt row = 0; row < parts * rows; row++) own[row] = diagonal;
  PetscCall(CopyRows(parts, part, NULL, own, far));
  PetscCall(MatCreateAIJ(comm, parts * rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, 0, own, 0, far, A));
  PetscCall(PetscFree2(own, far));
  PetscCall(MatGetOwnershipRange(*A, &begin, &end));
  for (PetscInt row = begin; diagonal && row < end; row++) PetscCall(MatSetValue(*A, row, row, 0, INSERT_VALUES));
  PetscCall(CopyRows(parts, part, *A, NULL, NULL));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the algebra ---- */

static PetscErrorCode Zero(void *registers, PetscInt dst)
{
  const MpmMatrices *m = registers;

  PetscFunctionBegin;
  PetscCall(MatDestroy(&m->reg[dst]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Scale(void *registers, const MpmLine *line)
{
  const MpmMatrices *m     = registers;
  const PetscReal    value = ValueOf(m, line);

  PetscFunctionBegin;
  if (value == 0) PetscCall(MatDestroy(&m->reg[line->dst]));
  if (!m->reg[line->dst]) PetscFunctionReturn(PETSC_SUCCESS);
  if (line->left) PetscCall(MatDiagonalScale(m->reg[line->dst], line->left, NULL));
  if (value != 1) PetscCall(MatScale(m->reg[line->dst], value));
  PetscCall(Raise(m, line, &m->reg[line->dst]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* left M right src, a matrix of its own */
static PetscErrorCode Image(const MpmLine *line, Mat src, Mat *image)
{
  Mat x = src;

  PetscFunctionBegin;
  if (line->right || !line->map) PetscCall(MatDuplicate(src, MAT_COPY_VALUES, &x));
  if (line->right) PetscCall(MatDiagonalScale(x, line->right, NULL));
  *image = x;
  if (line->map) {
    PetscCall(line->transposed ? MatTransposeMatMult(line->map, x, MAT_INITIAL_MATRIX, PETSC_DETERMINE, image)
                               : MatMatMult(line->map, x, MAT_INITIAL_MATRIX, PETSC_DETERMINE, image));
    if (x != src) PetscCall(MatDestroy(&x));
  }
  if (line->left) PetscCall(MatDiagonalScale(*image, line->left, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Add(void *registers, const MpmLine *line, PetscBool back)
{
  const MpmMatrices *m     = registers;
  const PetscReal    value = ValueOf(m, line);
  Mat               *dst   = &m->reg[line->dst], image;

  PetscFunctionBegin;
  PetscCheck(!back, m->registers.comm, PETSC_ERR_SUP, "a program runs backwards on vectors alone");
  if (!m->reg[line->src]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Image(line, m->reg[line->src], &image));
  PetscCall(Raise(m, line, &image));
  if (*dst) {
    PetscCall(MatAXPY(*dst, value, image, DIFFERENT_NONZERO_PATTERN));
    PetscCall(MatDestroy(&image));
  } else {
    PetscCall(MatScale(image, value));
    *dst = image;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Of the columns of the right side all at once, which fills them: every node feels every other one.
*/
static PetscErrorCode Solve(void *registers, const MpmLine *line, PetscBool back)
{
  const MpmMatrices *m = registers;
  const PetscInt     n = line->nsolve, nodes = m->registers.rows[1];
  const Mat         *part  = &m->reg[line->dst];
  Mat                right = NULL, dense, solution;
  PetscReal         *x;
  PetscInt           lda, begin;

  PetscFunctionBegin;
  PetscCheck(!back && !m->times_courant, m->registers.comm, PETSC_ERR_SUP,
             "a solve has no powers of the Courant number");
  PetscCall(Interleave(m->registers.comm, n, part, nodes, m->columns, PETSC_FALSE, &right));
  PetscCall(MatConvert(right, MATDENSE, MAT_INITIAL_MATRIX, &dense));
  PetscCall(MatDestroy(&right));
  PetscCall(MatDuplicate(dense, MAT_DO_NOT_COPY_VALUES, &solution));
  PetscCall(KSPMatSolve(line->solve, dense, solution));
  PetscCall(MatDestroy(&dense));
  PetscCall(MatDenseGetArray(solution, &x));
  PetscCall(MatDenseGetLDA(solution, &lda));
  for (PetscInt c = 0; c < n; c++) {
    Mat     *reg = &m->reg[line->dst + c];
    PetscInt all;

    PetscCall(MatDestroy(reg));
    PetscCall(MatGetSize(solution, NULL, &all));
    PetscCall(MatCreateAIJ(m->registers.comm, nodes, m->columns, PETSC_DETERMINE, all, m->columns, NULL,
                           all - m->columns, NULL, reg));
    PetscCall(MatGetOwnershipRange(*reg, &begin, NULL));
    for (PetscInt i = 0; i < nodes; i++)
      for (PetscInt j = 0; j < all; j++)
        PetscCall(MatSetValue(*reg, begin + i, j, x[j * lda + n * i + c], INSERT_VALUES));
    PetscCall(MatAssemblyBegin(*reg, MAT_FINAL_ASSEMBLY));
    PetscCall(MatAssemblyEnd(*reg, MAT_FINAL_ASSEMBLY));
  }
  PetscCall(MatDenseRestoreArray(solution, &x));
  PetscCall(MatDestroy(&solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const MpmAlgebra matrix_algebra = {.zero = Zero, .scale = Scale, .add = Add, .solve = Solve};

/* ---- a program's matrix ---- */

/* The rows of the identity for number f of each row. */
static PetscErrorCode Identity(const MpmMatrices *m, PetscInt f, Mat *matrix)
{
  const MpmRegisters *r    = &m->registers;
  const PetscInt      rows = r->rows[MpmRegisterPlace(r, r->in[f])];
  PetscInt            begin, column;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, rows, m->columns, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, matrix));
  PetscCall(MatGetOwnershipRange(*matrix, &begin, NULL));
  for (PetscInt i = begin; i < begin + rows; i++) {
    column = r->nin * i + f;
    PetscCall(MatSetValue(*matrix, i, column, 1, INSERT_VALUES));
  }
  PetscCall(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatricesCreate(const MpmRegisters *r, PetscReal courant, PetscInt degree, MpmMatrices *m)
{
  const PetscInt block = r->nin * r->rows[MpmRegisterPlace(r, r->in[0])];

  PetscFunctionBegin;
  *m = (MpmMatrices){.registers = *r, .courant = courant, .columns = block * (degree + 1)};
  PetscCall(PetscCalloc1(r->n[0] + r->n[1], &m->reg));
  for (PetscInt f = 0; f < r->nin; f++) PetscCall(Identity(m, f, &m->reg[r->in[f]]));
  if (degree == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, m->columns, m->columns, 1, NULL, &m->times_courant));
  for (PetscInt c = 0; c + block < m->columns; c++)
    PetscCall(MatSetValue(m->times_courant, c, c + block, 1, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(m->times_courant, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(m->times_courant, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatricesRun(MpmMatrices *m, const MpmStepProgram *program, PetscInt64 step)
{
  PetscFunctionBegin;
  MpmFloatBegin();
  PetscCall(MpmStepProgramRun(program, &matrix_algebra, m, PETSC_FALSE));
  PetscCall(MpmFloatEnd(m->registers.comm, &m->float_check, "assembly", step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatricesGather(const MpmMatrices *m, PetscBool diagonal, Mat *A)
{
  const MpmRegisters *r = &m->registers;
  Mat                 part[MPM_MAX_STATE];

  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->nout; f++) part[f] = m->reg[r->out[f]];
  PetscCall(Interleave(r->comm, r->nout, part, r->rows[MpmRegisterPlace(r, r->out[0])], m->columns, diagonal, A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatricesDestroy(MpmMatrices *m)
{
  PetscFunctionBegin;
  for (PetscInt s = 0; s < m->registers.n[0] + m->registers.n[1]; s++) PetscCall(MatDestroy(&m->reg[s]));
  PetscCall(MatDestroy(&m->times_courant));
  PetscCall(PetscFree(m->reg));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepProgramAssemble(const MpmStepProgram *program, PetscBool diagonal, Mat *A)
{
  MpmMatrices m;

  PetscFunctionBegin;
  PetscCall(MpmMatricesCreate(&program->registers, program->courant, 0, &m));
  PetscCall(MpmStepProgramRun(program, &matrix_algebra, &m, PETSC_FALSE));
  PetscCall(MpmMatricesGather(&m, diagonal, A));
  PetscCall(MpmMatricesDestroy(&m));
  PetscFunctionReturn(PETSC_SUCCESS);
}
