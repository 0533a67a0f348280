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

static const MpmParity even[MPM_MAX_DIM] = {MPM_EVEN, MPM_EVEN, MPM_EVEN};

/*
   The nodes that a particle has weights at, and these weights: products of the weights along the directions. Returns how
   many there are.
*/
static PetscInt RowOf(const MpmRegisters *r, MpmOpKind kind, PetscInt axis, const MpmParity parity[], PetscBool drop,
                      const PetscInt cell[], const PetscReal xi[], PetscInt column[], PetscReal weight[])
{
  const MpmLayout *layout = r->layout;
  const MpmBasis  *basis  = r->scheme->basis;
  const PetscInt   reach  = MpmMapReach(basis);
  PetscInt         n = 1, stride = 1;

  column[0] = 0;
  weight[0] = 1;
  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscInt  node[MPM_MAX_REACH], wall[2];
    PetscReal row[MPM_MAX_REACH], sign[MPM_MAX_REACH];

    MpmDirectionWalls(&layout->grid[a], cell[a], wall);
    MpmMapRow(basis, MpmKindAlong(kind, axis, a), xi[a], layout->half_width[a], wall, row);
    MpmNodesSeen(&layout->grid[a], basis, cell[a], parity[a], drop, node, sign);
    for (PetscInt d = reach - 1; d >= 0; d--) { /* the first n products are read last */
      for (PetscInt i = 0; i < n; i++) {
        column[d * n + i] = column[i] + stride * node[d];
        weight[d * n + i] = weight[i] * (row[d] * sign[d]);
      }
    }
    n *= reach;
    stride *= layout->grid[a].nodes;
  }
  return n;
}

/* The number of nodes that a particle has weights at. */
static PetscInt NodesOfParticle(const MpmRegisters *r)
{
  PetscInt n = 1;

  for (PetscInt a = 0; a < r->layout->dim; a++) n *= MpmMapReach(r->scheme->basis);
  return n;
}

static PetscInt AllNodes(const MpmLayout *layout)
{
  PetscInt n = 1;

  for (PetscInt a = 0; a < layout->dim; a++) n *= layout->grid[a].nodes;
  return n;
}

/*
   The matrix of a map, particles x nodes. Rows are particles in the order of their ids, times the property that the
   operation multiplies them with. Two of a particle's nodes may be one and the same, in a short periodic grid or at a
   wall; their weights add up.
*/
static PetscErrorCode ParticlesByNodes(const MpmRegisters *r, MpmOpKind kind, PetscInt axis, const MpmParity parity[],
                                       PetscBool drop, PetscInt64 step, Mat *map)
{
  const MpmLayout  *layout = r->layout;
  const PetscInt    most = NodesOfParticle(r), own = PetscMin(most, r->nodes);
  const PetscInt    far    = PetscMin(most, AllNodes(layout) - r->nodes);
  const MpmProperty weight = MpmLayoutWeight(layout, kind);
  PetscInt         *columns;
  PetscReal        *row;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(most, &columns, most, &row));
  PetscCall(MatCreateAIJ(r->comm, r->particles, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, own, NULL, far, NULL, map));
  for (PetscInt p = 0; p < r->particles; p++) {
    const PetscInt  id = r->begin + p;
    PetscInt        cell[MPM_MAX_DIM];
    PetscReal       xi[MPM_MAX_DIM];
    const PetscReal w = weight ? MpmMaterialProperty(layout, weight, id) : 1;

    MpmLayoutPlaceAt(layout, r->step.drift, id, step, cell, xi);
    (void)RowOf(r, kind, axis, parity, drop, cell, xi, columns, row);
    for (PetscInt i = 0; i < most && weight; i++) row[i] *= w;
    PetscCall(MatSetValues(*map, 1, &id, most, columns, row, ADD_VALUES));
  }
  PetscCall(PetscFree2(columns, row));
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
  PetscCall(ParticlesByNodes(r, MPM_P2G, 0, even, PETSC_FALSE, step, &shape));
  PetscCall(MatCreateVecs(shape, &r->masses, &ones));
  PetscCall(VecSet(ones, 1));
  PetscCall(MatMultTranspose(shape, ones, r->masses));
  PetscCall(VecDestroy(&ones));
  PetscCall(MatDestroy(&shape));
  r->masses_step = step;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersMap(MpmRegisters *r, MpmOpKind kind, PetscInt axis, const MpmParity parity[],
                               PetscInt64 step, Mat *map)
{
  Mat        shape;
  Vec        inverse;
  PetscReal *m;

  PetscFunctionBegin;
  if (MpmOpTraitsOf(kind).dst == MPM_ON_PARTICLES) {
    PetscCall(ParticlesByNodes(r, kind, axis, parity, PETSC_FALSE, step, map));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ParticlesByNodes(r, kind, axis, parity, PETSC_FALSE, step, &shape));
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

PetscErrorCode MpmRegistersSolve(MpmRegisters *r, const MpmParity parity[], PetscInt64 step, Mat *map)
{
  Mat W;

  PetscFunctionBegin;
  PetscCall(Masses(r, step));
  PetscCall(ParticlesByNodes(r, MPM_G2P, 0, parity, PETSC_TRUE, step, &W));
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

PetscErrorCode MpmRegistersSizes(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                 MpmRegisters *r)
{
  const PetscInt last = layout->dim - 1;
  PetscMPIInt    rank, size;
  PetscInt       plane_nodes = 1;
  PetscInt64     begin, end, plane = 1; /* the particles of a plane across the last direction */

  PetscFunctionBegin;
  *r = (MpmRegisters){.comm = comm, .layout = layout, .scheme = scheme, .step = *step, .masses_step = -1};
  PetscCallMPI(MPI_Comm_rank(r->comm, &rank));
  PetscCallMPI(MPI_Comm_size(r->comm, &size));
  r->cells = MpmGridCount(layout->grid[last].cells, size, rank);
  r->first = MpmGridFirst(layout->grid[last].cells, size, rank);
  for (PetscInt a = 0; a < last; a++) {
    plane_nodes *= layout->grid[a].nodes;
    plane *= layout->row[a];
  }
  r->node0 = r->first * plane_nodes;
  r->nodes = (r->cells + (rank == size - 1 ? layout->grid[last].nodes - layout->grid[last].cells : 0)) * plane_nodes;
  begin    = MpmLayoutParticlesBefore(layout, last, r->first);
  end      = MpmLayoutParticlesBefore(layout, last, r->first + r->cells);
  r->begin = (PetscInt)(plane * begin);
  r->particles = (PetscInt)(plane * (end - begin));
  r->fields    = r->scheme->table->nstate;
  r->state     = r->particles * r->fields;
  r->columns   = r->state;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The registers at the start: those of the state are rows of the identity. */
static PetscErrorCode Fill(MpmRegisters *r)
{
  PetscFunctionBegin;
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
  PetscCall(MpmRegistersSizes(comm, layout, scheme, step, r));
  PetscCall(Fill(r));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersCreatePolynomial(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                            PetscInt degree, MpmRegisters *r)
{
  PetscFunctionBegin;
  PetscCall(MpmRegistersSizes(PETSC_COMM_SELF, layout, scheme, step, r));
  r->columns *= degree + 1;
  PetscCall(Fill(r));
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

PetscInt MpmNodeAlong(const MpmLayout *layout, PetscInt node, PetscInt axis, PetscInt *stride)
{
  *stride = 1;
  for (PetscInt a = 0; a < axis; a++) *stride *= layout->grid[a].nodes;
  return node / *stride % layout->grid[axis].nodes;
}

/* The matrix of a stencil. Nodes beyond a wall are replaced by those that they are images of. */
static PetscErrorCode Stencil(const MpmRegisters *r, const MpmOp *op, const MpmParity parity[], Mat *map)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->nodes, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, PetscMin(3, r->nodes), NULL,
                         PetscMin(2, AllNodes(r->layout) - r->nodes), NULL, map));
  for (PetscInt node = r->node0; node < r->node0 + r->nodes; node++) {
    PetscInt       stride;
    const PetscInt i = MpmNodeAlong(r->layout, node, op->axis, &stride);

    for (PetscInt d = -traits.halo; d <= traits.halo; d++) {
      PetscReal      sign;
      const PetscInt j = MpmDirectionImage(&r->layout->grid[op->axis], i + d, parity[op->axis], &sign);

      PetscCall(MatSetValue(*map, node, node + (j - i) * stride, sign * traits.stencil[d + 1], ADD_VALUES));
    }
  }
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The rows of the nodes on one wall become a times those of register src. */
static PetscErrorCode SetWall(MpmRegisters *r, const MpmOp *op, PetscReal a)
{
  const PetscInt wall = op->side ? r->layout->grid[op->axis].nodes - 1 : 0;
  PetscInt       stride;
  Mat            only, row;
  Vec            keep;

  PetscFunctionBegin;
  if (!r->node[op->dst]) PetscCall(Empty(r, r->nodes, &r->node[op->dst]));
  PetscCall(MatCreateVecs(r->node[op->dst], NULL, &keep));
  PetscCall(VecSet(keep, 1));
  for (PetscInt node = r->node0; node < r->node0 + r->nodes; node++)
    if (MpmNodeAlong(r->layout, node, op->axis, &stride) == wall) PetscCall(VecSetValue(keep, node, 0, INSERT_VALUES));
  PetscCall(VecAssemblyBegin(keep));
  PetscCall(VecAssemblyEnd(keep));
  PetscCall(MatDiagonalScale(r->node[op->dst], keep, NULL));
  PetscCall(VecDestroy(&keep));
  if (a == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateAIJ(r->comm, r->nodes, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, &only));
  for (PetscInt node = r->node0; node < r->node0 + r->nodes; node++)
    if (MpmNodeAlong(r->layout, node, op->axis, &stride) == wall)
      PetscCall(MatSetValue(only, node, node, a, INSERT_VALUES));
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

PetscInt MpmParityClass(const MpmLayout *layout, const MpmParity parity[])
{
  if (MpmLayoutIsPeriodic(layout) || parity[0] == MPM_EVEN) return 0;
  for (PetscInt a = 0; a < layout->dim; a++)
    if (parity[a] == MPM_NORMAL) return 1 + a;
  return MPM_PARITIES - 1;
}

PetscErrorCode MpmStepMapsGet(MpmStepMaps *maps, MpmRegisters *r, const MpmOp *op, PetscInt64 step, Mat *map)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const MpmParity  *parity = r->scheme->table->parity[traits.dst == MPM_ON_NODES ? op->dst : op->src];
  Mat              *known  = &maps->map[op->kind][op->axis][MpmParityClass(r->layout, parity)];

  PetscFunctionBegin;
  if (!*known && op->kind == MPM_SOLVE)
    PetscCall(MpmRegistersSolve(r, parity, step, known));
  else if (!*known && traits.dst == traits.src)
    PetscCall(Stencil(r, op, parity, known));
  else if (!*known)
    PetscCall(MpmRegistersMap(r, op->kind, op->axis, parity, step, known));
  *map = *known;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepMapsDestroy(MpmStepMaps *maps)
{
  PetscFunctionBegin;
  for (PetscInt k = 0; k < MPM_OP_KINDS; k++)
    for (PetscInt a = 0; a < MPM_AXES; a++)
      for (PetscInt c = 0; c < MPM_PARITIES; c++) PetscCall(MatDestroy(&maps->map[k][a][c]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* dst += a src, both registers of particles. */
static PetscErrorCode AddParticles(MpmRegisters *r, const MpmOp *op, PetscReal a)
{
  Mat term;

  PetscFunctionBegin;
  PetscCall(MatDuplicate(r->particle[op->src], MAT_COPY_VALUES, &term));
  PetscCall(Raise(r, op, &term));
  PetscCall(MatAXPY(r->particle[op->dst], a, term, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatDestroy(&term));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode ApplyOp(MpmRegisters *r, const MpmOp *op, PetscInt64 step, MpmStepMaps *maps)
{
  const MpmOpTraits traits   = MpmOpTraitsOf(op->kind);
  const PetscReal   a        = ValueOf(r, op);
  Mat *const        sides[2] = {r->particle, r->node};
  Mat               map      = NULL;

  PetscFunctionBegin;
  if (traits.dst == MPM_NOWHERE) PetscFunctionReturn(PETSC_SUCCESS);
  if (op->kind == MPM_WALL)
    PetscCall(SetWall(r, op, a));
  else if (op->kind == MPM_ADD)
    PetscCall(AddParticles(r, op, a));
  else if (op->kind == MPM_SCALE && a == 0)
    PetscCall(Empty(r, r->particles, &r->particle[op->dst]));
  else if (op->kind == MPM_SCALE) {
    PetscCall(MatScale(r->particle[op->dst], a));
    PetscCall(Raise(r, op, &r->particle[op->dst]));
  } else {
    PetscCall(MpmStepMapsGet(maps, r, op, step, &map));
    PetscCall(
        Apply(r, op, map, a, sides[traits.src == MPM_ON_NODES][op->src], &sides[traits.dst == MPM_ON_NODES][op->dst]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersStep(MpmRegisters *r, PetscInt64 step)
{
  const MpmTable *table = r->scheme->table;
  MpmStepMaps     maps  = {{{{NULL}}}};

  PetscFunctionBegin;
  MpmFloatBegin();
  for (PetscInt o = 0; o < table->nops; o++) PetscCall(ApplyOp(r, &table->ops[o], step, &maps));
  PetscCall(MpmStepMapsDestroy(&maps));
  PetscCall(MpmFloatEnd(r->comm, &r->float_check, "assembly", step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Counts the numbers of each row, in the columns of this rank (own) and in those of others (far). */
static PetscErrorCode CountRows(PetscInt parts, const Mat part[], PetscInt rows, PetscBool diagonal, PetscInt own[],
                                PetscInt far[])
{
  PetscFunctionBegin;
  for (PetscInt row = 0; row < parts * rows; row++) {
    own[row] = diagonal;
    far[row] = 0;
  }
  for (PetscInt f = 0; f < parts; f++) {
    PetscInt first, begin, end;

    if (!part[f]) continue;
    PetscCall(MatGetOwnershipRange(part[f], &first, NULL));
    PetscCall(MatGetOwnershipRangeColumn(part[f], &begin, &end));
    for (PetscInt p = 0; p < rows; p++) {
      const PetscInt *columns;
      PetscInt        n;

      PetscCall(MatGetRow(part[f], first + p, &n, &columns, NULL));
      for (PetscInt c = 0; c < n; c++)
        if (columns[c] >= begin && columns[c] < end)
          own[parts * p + f]++;
        else
          far[parts * p + f]++;
      PetscCall(MatRestoreRow(part[f], first + p, &n, &columns, NULL));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CopyRows(PetscInt parts, const Mat part[], Mat A)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < parts; f++) {
    PetscInt begin, end;

    if (!part[f]) continue;
    PetscCall(MatGetOwnershipRange(part[f], &begin, &end));
    for (PetscInt p = begin; p < end; p++) {
      const PetscInt     row = parts * p + f;
      const PetscInt    *columns;
      const PetscScalar *values;
      PetscInt           n;

      PetscCall(MatGetRow(part[f], p, &n, &columns, &values));
      PetscCall(MatSetValues(A, 1, &row, n, columns, values, INSERT_VALUES));
      PetscCall(MatRestoreRow(part[f], p, &n, &columns, &values));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmInterleave(MPI_Comm comm, PetscInt parts, const Mat part[], PetscInt rows, PetscInt columns,
                             PetscBool diagonal, Mat *A)
{
  PetscInt *own, *far, begin, end;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(parts * rows, &own, parts * rows, &far));
  PetscCall(CountRows(parts, part, rows, diagonal, own, far));
  PetscCall(MatCreateAIJ(comm, parts * rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, 0, own, 0, far, A));
  PetscCall(PetscFree2(own, far));
  PetscCall(MatGetOwnershipRange(*A, &begin, &end));
  for (PetscInt row = begin; diagonal && row < end; row++) PetscCall(MatSetValue(*A, row, row, 0, INSERT_VALUES));
  PetscCall(CopyRows(parts, part, *A));
  PetscCall(MatAssemblyBegin(*A, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*A, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmRegistersGather(const MpmRegisters *r, Mat *A)
{
  PetscFunctionBegin;
  PetscCall(MpmInterleave(r->comm, r->fields, r->particle, r->particles, r->columns, PETSC_FALSE, A));
  PetscFunctionReturn(PETSC_SUCCESS);
}
