/*
   A table as a sparse matrix: each operation is a product of sparse matrices, and q(t+1) = A(x_t) q(t).

     particle -> node       g  = a M^-1 S^T q
     node -> particle       q += a S g
     node -> node           g  = a L f

   S has phi_ip, or h dphi_ip/dx for DIV and GRAD. M has the nodal masses, and L the stencil of the operation.
*/
#include "linalg/normal_inverse.h"
#include "march/grid.h"
#include "operator/assemble.h"
#include "scene/layout.h"
#include "scene/material.h"
#include <math.h>

/*
   The matrix of a map, particles x nodes. Rows are particles in the order of their ids, times the property that the
   operation multiplies them with. Two of a particle's nodes may be one and the same, in a short periodic grid or at a
   wall; their weights add up.
*/
static PetscErrorCode ParticlesByNodes(const MpmRegisters *r, MpmOpKind kind, PetscBool antisymmetric, PetscBool drop,
                                       PetscInt64 step, Mat *map)
{
  const MpmLayout  *layout = r->layout;
  const MpmBasis   *basis  = r->scheme->basis;
  const PetscInt    reach = MpmMapReach(basis), own = PetscMin(reach, r->nodes);
  const PetscInt    far    = PetscMin(reach, layout->grid.nodes - r->nodes);
  const MpmProperty weight = MpmLayoutWeight(layout, kind);

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->particles, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, own, NULL, far, NULL, map));
  for (PetscInt p = 0; p < r->particles; p++) {
    const PetscInt  id = r->begin + p;
    PetscInt        cell, columns[MPM_MAX_REACH];
    PetscReal       xi, row[MPM_MAX_REACH], sign[MPM_MAX_REACH];
    const PetscReal w = weight ? MpmMaterialProperty(layout, weight, id) : 1;

    MpmLayoutPlaceAt(layout, &r->step.drift, id, step, &cell, &xi);
    MpmMapRow(basis, kind, xi, layout->half_width, row);
    MpmNodesSeen(&r->layout->grid, basis, cell, antisymmetric, drop, columns, sign);
    for (PetscInt d = 0; d < reach; d++) row[d] *= sign[d] * w;
    PetscCall(MatSetValues(*map, 1, &id, reach, columns, row, ADD_VALUES));
  }
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodal masses at a step. Images at a wall add to them with a positive sign, whatever the sign of the fields. */
static PetscErrorCode Masses(MpmRegisters *r, PetscInt64 step)
{
  Mat shape;
  Vec ones;

  PetscFunctionBegin;
  if (r->masses && r->masses_step == step) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDestroy(&r->masses));
  PetscCall(ParticlesByNodes(r, MPM_P2G, PETSC_FALSE, PETSC_FALSE, step, &shape));
  PetscCall(MatCreateVecs(shape, &r->masses, &ones));
  PetscCall(VecSet(ones, 1));
  PetscCall(MatMultTranspose(shape, ones, r->masses));
  PetscCall(VecDestroy(&ones));
  PetscCall(MatDestroy(&shape));
  r->masses_step = step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersMap(MpmRegisters *r, MpmOpKind kind, PetscBool antisymmetric, PetscInt64 step, Mat *map)
{
  Mat        shape;
  Vec        inverse;
  PetscReal *m;

  PetscFunctionBegin;
  if (MpmOpTraitsOf(kind).dst == MPM_ON_PARTICLES) {
    PetscCall(ParticlesByNodes(r, kind, antisymmetric, PETSC_FALSE, step, map));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ParticlesByNodes(r, kind, antisymmetric, PETSC_FALSE, step, &shape));
  PetscCall(Masses(r, step));
  PetscCall(VecDuplicate(r->masses, &inverse));
  PetscCall(VecCopy(r->masses, inverse));
  PetscCall(VecGetArray(inverse, &m));
  for (PetscInt i = 0; i < r->nodes; i++) m[i] = m[i] > 0 ? 1 / m[i] : 0;
  PetscCall(VecRestoreArray(inverse, &m));
  PetscCall(MatDiagonalScale(shape, NULL, inverse));
  PetscCall(MatTranspose(shape, MAT_INITIAL_MATRIX, map));
  PetscCall(VecDestroy(&inverse));
  PetscCall(MatDestroy(&shape));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Multiplies W by sqrt(m), so that its normal equations have the matrix W^T m W. */
static PetscErrorCode WeighRoots(const MpmRegisters *r, Mat W)
{
  Vec        root;
  PetscReal *m;

  PetscFunctionBegin;
  if (!r->layout->varies[MPM_MASS]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateVecs(W, NULL, &root));
  PetscCall(VecGetArray(root, &m));
  for (PetscInt p = 0; p < r->particles; p++) m[p] = sqrt(MpmMaterialProperty(r->layout, MPM_MASS, r->begin + p));
  PetscCall(VecRestoreArray(root, &m));
  PetscCall(MatDiagonalScale(W, root, NULL));
  PetscCall(VecDestroy(&root));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersSolve(MpmRegisters *r, PetscBool antisymmetric, PetscInt64 step, Mat *map)
{
  Mat W;

  PetscFunctionBegin;
  PetscCall(Masses(r, step));
  PetscCall(ParticlesByNodes(r, MPM_G2P, antisymmetric, PETSC_TRUE, step, &W));
  PetscCall(WeighRoots(r, W));
  PetscCall(MpmNormalInverse(W, r->masses, map));
  PetscCall(MatDestroy(&W));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of the identity for one field: particle p of this rank is unknown fields p + field of the state. */
static PetscErrorCode Identity(const MpmRegisters *r, PetscInt field, Mat *matrix)
{
  PetscInt row, column;

  PetscFunctionBegin;
  PetscCall(
      MatCreateAIJ(r->comm, r->particles, r->columns, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, matrix));
  PetscCall(MatGetOwnershipRange(*matrix, &row, NULL));
  column = r->fields * row + field;
  for (PetscInt p = 0; p < r->particles; p++)
    PetscCall(MatSetValue(*matrix, row + p, column + r->fields * p, 1, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets a register to a matrix of zeros. */
static PetscErrorCode Empty(const MpmRegisters *r, PetscInt rows, Mat *matrix)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(matrix));
  PetscCall(MatCreateAIJ(r->comm, rows, r->columns, PETSC_DETERMINE, PETSC_DETERMINE, 0, NULL, 0, NULL, matrix));
  PetscCall(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sizes and the registers at the start, for polynomials of a degree; 0 for numbers. */
static PetscErrorCode SetUp(MpmRegisters *r, PetscInt degree)
{
  const MpmLayout *layout = r->layout;
  PetscMPIInt      rank, size;
  PetscInt64       begin, end;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(r->comm, &rank));
  PetscCallMPI(MPI_Comm_size(r->comm, &size));
  r->cells     = MpmGridCount(layout->grid.cells, size, rank);
  r->first     = MpmGridFirst(layout->grid.cells, size, rank);
  r->nodes     = r->cells + (rank == size - 1 ? layout->grid.nodes - layout->grid.cells : 0);
  begin        = PetscMax(MpmLayoutSitesBefore(layout, r->first) - layout->first, 0);
  end          = PetscMin(MpmLayoutSitesBefore(layout, r->first + r->cells) - layout->first, layout->particles);
  r->begin     = (PetscInt)begin;
  r->particles = (PetscInt)PetscMax(end - begin, 0);
  r->fields    = r->scheme->table->nstate;
  r->state     = r->particles * r->fields;
  r->columns   = r->state * (degree + 1);
  for (PetscInt f = 0; f < r->scheme->table->nparticles; f++)
    if (f < r->fields)
      PetscCall(Identity(r, f, &r->particle[f]));
    else
      PetscCall(Empty(r, r->particles, &r->particle[f]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                  MpmRegisters *r)
{
  PetscFunctionBegin;
  *r = (MpmRegisters){.comm = comm, .layout = layout, .scheme = scheme, .step = *step, .masses_step = -1};
  PetscCall(SetUp(r, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersCreatePolynomial(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                            PetscInt degree, MpmRegisters *r)
{
  PetscFunctionBegin;
  *r = (MpmRegisters){.comm = PETSC_COMM_SELF, .layout = layout, .scheme = scheme, .step = *step, .masses_step = -1};
  PetscCall(SetUp(r, degree));
  PetscCall(MatCreateSeqAIJ(PETSC_COMM_SELF, r->columns, r->columns, 1, NULL, &r->times_courant));
  for (PetscInt c = 0; c + r->state < r->columns; c++)
    PetscCall(MatSetValue(r->times_courant, c, c + r->state, 1, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(r->times_courant, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(r->times_courant, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersDestroy(MpmRegisters *r)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < MPM_MAX_FIELDS; f++) {
    PetscCall(MatDestroy(&r->particle[f]));
    PetscCall(MatDestroy(&r->node[f]));
  }
  PetscCall(MatDestroy(&r->times_courant));
  PetscCall(VecDestroy(&r->masses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The number that multiplies an operation. For polynomials it is the factor alone: Raise multiplies by the Courant number. */
static PetscReal ValueOf(const MpmRegisters *r, const MpmOp *op)
{
  return r->times_courant ? op->factor : MpmOpValue(op, r->step.courant);
}

/* Multiplies a polynomial by the power of the Courant number that an operation carries. */
static PetscErrorCode Raise(const MpmRegisters *r, const MpmOp *op, Mat *matrix)
{
  PetscFunctionBegin;
  for (PetscInt power = 0; r->times_courant && power < op->coefficient; power++) {
    Mat product;

    PetscCall(MatMatMult(*matrix, r->times_courant, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &product));
    PetscCall(MatDestroy(matrix));
    *matrix = product;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix of a stencil. Nodes beyond a wall are replaced by those that they are images of. */
static PetscErrorCode Stencil(const MpmRegisters *r, const MpmOp *op, PetscBool antisymmetric, Mat *map)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->nodes, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, PetscMin(3, r->nodes), NULL,
                         PetscMin(2, r->layout->grid.nodes - r->nodes), NULL, map));
  for (PetscInt i = r->first; i < r->first + r->nodes; i++) {
    for (PetscInt d = -traits.halo; d <= traits.halo; d++) {
      PetscReal      sign;
      const PetscInt j = MpmDirectionImage(&r->layout->grid, i + d, antisymmetric, &sign);

      PetscCall(MatSetValue(*map, i, j, sign * traits.stencil[d + 1], ADD_VALUES));
    }
  }
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The row of one wall node becomes a times that of register src. */
static PetscErrorCode SetWall(MpmRegisters *r, const MpmOp *op, PetscReal a)
{
  const PetscInt  wall = op->side ? r->layout->grid.nodes - 1 : 0;
  const PetscBool mine = wall >= r->first && wall < r->first + r->nodes ? PETSC_TRUE : PETSC_FALSE;
  Mat             only, row;
  Vec             keep;

  PetscFunctionBegin;
  if (!r->node[op->dst]) PetscCall(Empty(r, r->nodes, &r->node[op->dst]));
  PetscCall(MatCreateVecs(r->node[op->dst], NULL, &keep));
  PetscCall(VecSet(keep, 1));
  if (mine) PetscCall(VecSetValue(keep, wall, 0, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(keep));
  PetscCall(VecAssemblyEnd(keep));
  PetscCall(MatDiagonalScale(r->node[op->dst], keep, NULL));
  PetscCall(VecDestroy(&keep));
  if (a == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateAIJ(r->comm, r->nodes, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, &only));
  if (mine) PetscCall(MatSetValue(only, wall, wall, a, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(only, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(only, MAT_FINAL_ASSEMBLY));
  PetscCall(MatMatMult(only, r->node[op->src], MAT_INITIAL_MATRIX, PETSC_DETERMINE, &row));
  PetscCall(Raise(r, op, &row));
  PetscCall(MatAXPY(r->node[op->dst], 1, row, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatDestroy(&row));
  PetscCall(MatDestroy(&only));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* dst = a map src; accumulating, dst += a map src. */
static PetscErrorCode Apply(const MpmRegisters *r, const MpmOp *op, Mat map, PetscReal a, Mat src, Mat *dst)
{
  Mat product;

  PetscFunctionBegin;
  PetscCall(MatMatMult(map, src, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &product));
  PetscCall(Raise(r, op, &product));
  if (op->accumulates) {
    PetscCall(MatAXPY(*dst, a, product, DIFFERENT_NONZERO_PATTERN));
    PetscCall(MatDestroy(&product));
  } else {
    PetscCall(MatScale(product, a));
    PetscCall(MatDestroy(dst));
    *dst = product;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrices of a step's maps, for symmetric and antisymmetric node fields. Each is made when it is first used. */
typedef struct {
  Mat map[MPM_OP_KINDS][2];
} Maps;

static PetscErrorCode MapOf(MpmRegisters *r, const MpmOp *op, PetscInt64 step, Maps *maps, Mat *map)
{
  const MpmOpTraits traits        = MpmOpTraitsOf(op->kind);
  const PetscBool   antisymmetric = r->scheme->table->antisymmetric[traits.dst == MPM_ON_NODES ? op->dst : op->src];
  Mat              *known         = &maps->map[op->kind][antisymmetric ? 1 : 0];

  PetscFunctionBegin;
  if (!*known && op->kind == MPM_SOLVE)
    PetscCall(MpmRegistersSolve(r, antisymmetric, step, known));
  else if (!*known && traits.dst == traits.src)
    PetscCall(Stencil(r, op, antisymmetric, known));
  else if (!*known)
    PetscCall(MpmRegistersMap(r, op->kind, antisymmetric, step, known));
  *map = *known;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyOp(MpmRegisters *r, const MpmOp *op, PetscInt64 step, Maps *maps)
{
  const MpmOpTraits traits   = MpmOpTraitsOf(op->kind);
  const PetscReal   a        = ValueOf(r, op);
  Mat *const        sides[2] = {r->particle, r->node};
  Mat               map      = NULL;

  PetscFunctionBegin;
  if (traits.dst == MPM_NOWHERE) PetscFunctionReturn(PETSC_SUCCESS);
  if (op->kind == MPM_WALL)
    PetscCall(SetWall(r, op, a));
  else if (op->kind == MPM_SCALE && a == 0)
    PetscCall(Empty(r, r->particles, &r->particle[op->dst]));
  else if (op->kind == MPM_SCALE) {
    PetscCall(MatScale(r->particle[op->dst], a));
    PetscCall(Raise(r, op, &r->particle[op->dst]));
  } else {
    PetscCall(MapOf(r, op, step, maps, &map));
    PetscCall(
        Apply(r, op, map, a, sides[traits.src == MPM_ON_NODES][op->src], &sides[traits.dst == MPM_ON_NODES][op->dst]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersStep(MpmRegisters *r, PetscInt64 step)
{
  const MpmTable *table = r->scheme->table;
  Maps            maps  = {{{NULL}}};

  PetscFunctionBegin;
  MpmFloatBegin();
  for (PetscInt o = 0; o < table->nops; o++) PetscCall(ApplyOp(r, &table->ops[o], step, &maps));
  for (PetscInt k = 0; k < MPM_OP_KINDS; k++)
    for (int antisymmetric = 0; antisymmetric < 2; antisymmetric++) PetscCall(MatDestroy(&maps.map[k][antisymmetric]));
  PetscCall(MpmFloatEnd(r->comm, &r->float_check, "assembly", step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts the numbers of each row of A, in the columns of this rank (own) and in those of others (far). */
static PetscErrorCode CountRows(const MpmRegisters *r, PetscInt begin, PetscInt end, PetscInt own[], PetscInt far[])
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->fields; f++) {
    PetscInt first;

    PetscCall(MatGetOwnershipRange(r->particle[f], &first, NULL));
    for (PetscInt p = 0; p < r->particles; p++) {
      const PetscInt  row = r->fields * p + f;
      const PetscInt *columns;
      PetscInt        n;

      PetscCall(MatGetRow(r->particle[f], first + p, &n, &columns, NULL));
      own[row] = far[row] = 0;
      for (PetscInt c = 0; c < n; c++)
        if (columns[c] >= begin && columns[c] < end)
          own[row]++;
        else
          far[row]++;
      PetscCall(MatRestoreRow(r->particle[f], first + p, &n, &columns, NULL));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyRows(const MpmRegisters *r, Mat A)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->fields; f++) {
    PetscInt begin, end;

    PetscCall(MatGetOwnershipRange(r->particle[f], &begin, &end));
    for (PetscInt p = begin; p < end; p++) {
      const PetscInt     row = r->fields * p + f;
      const PetscInt    *columns;
      const PetscScalar *values;
      PetscInt           n;

      PetscCall(MatGetRow(r->particle[f], p, &n, &columns, &values));
      PetscCall(MatSetValues(A, 1, &row, n, columns, values, INSERT_VALUES));
      PetscCall(MatRestoreRow(r->particle[f], p, &n, &columns, &values));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersGather(const MpmRegisters *r, Mat *A)
{
  PetscInt *own, *far, begin, end;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRangeColumn(r->particle[0], &begin, &end));
  PetscCall(PetscMalloc2(r->state, &own, r->state, &far));
  PetscCall(CountRows(r, begin, end, own, far));
  PetscCall(MatCreateAIJ(r->comm, r->state, r->state, PETSC_DETERMINE, PETSC_DETERMINE, 0, own, 0, far, A));
  PetscCall(PetscFree2(own, far));
  PetscCall(CopyRows(r, *A));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}
