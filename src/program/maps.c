/*
   The maps of a step as sparse matrices. A weight is the product of the weights along the directions, which come from
   the basis' kernels (MpmMapRow), for all that is asked of a map here.
*/
#include "program/maps.h"
#include "linalg/dense.h"
#include "scene/layout.h"
#include "scene/material.h"
#include <mpmstab/errors.h>
#include <petscblaslapack.h>
#include <math.h>

#define MOST_NODES 3000
#define SINGULAR 1e-12   /* relative to the largest eigenvalue */
#define NEGLIGIBLE 1e-18 /* relative to the largest number of the inverse */

static const MpmParity even[MPM_MAX_DIM] = {MPM_EVEN, MPM_EVEN, MPM_EVEN};

PetscErrorCode MpmSlabOf(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                         MpmSlab *s)
{
  const PetscInt last = layout->dim - 1;
  PetscMPIInt    rank, size;
  PetscInt       plane_nodes = 1;
  PetscInt64     begin, end, plane = 1; /* the particles of a plane across the last direction */

  PetscFunctionBegin;
  *s = (MpmSlab){.comm = comm, .layout = layout, .scheme = scheme, .step = *step};
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  PetscCallMPI(MPI_Comm_size(comm, &size));
  s->cells = MpmGridCount(layout->grid[last].cells, size, rank);
  s->first = MpmGridFirst(layout->grid[last].cells, size, rank);
  for (PetscInt a = 0; a < last; a++) {
    plane_nodes *= layout->grid[a].nodes;
    plane *= layout->row[a];
  }
  s->node0 = s->first * plane_nodes;
  s->nodes = (s->cells + (rank == size - 1 ? layout->grid[last].nodes - layout->grid[last].cells : 0)) * plane_nodes;
  begin    = MpmLayoutParticlesBefore(layout, last, s->first);
  end      = MpmLayoutParticlesBefore(layout, last, s->first + s->cells);
  s->begin = (PetscInt)(plane * begin);
  s->particles = (PetscInt)(plane * (end - begin));
  if (layout->given) { /* in the order of their ids, wherever they are */
    s->begin     = (PetscInt)(layout->particles * rank / size);
    s->particles = (PetscInt)(layout->particles * (rank + 1) / size) - s->begin;
  }
  s->fields = scheme->table->nstate;
  s->state  = s->particles * s->fields;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt MpmNodeAlong(const MpmLayout *layout, PetscInt node, PetscInt axis, PetscInt *stride)
{
  *stride = 1;
  for (PetscInt a = 0; a < axis; a++) *stride *= layout->grid[a].nodes;
  return node / *stride % layout->grid[axis].nodes;
}

PetscErrorCode MpmReciprocals(Vec numbers, Vec *reciprocals)
{
  PetscFunctionBegin;
  PetscCall(VecDuplicate(numbers, reciprocals));
  PetscCall(VecCopy(numbers, *reciprocals));
  PetscCall(VecReciprocal(*reciprocals));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The nodes that a particle in a cell has weights at, and these weights: products of row[a][.] over the directions a, as
   MpmMapRow numbers them. drop is that of MpmNodesSeen. Returns how many there are.
*/
static PetscInt NodeWeights(const MpmSlab *s, PetscReal row[][MPM_MAX_REACH], const MpmParity parity[], PetscBool drop,
                            const PetscInt cell[], PetscInt column[], PetscReal weight[])
{
  const PetscInt reach = MpmMapReach(s->scheme->basis);
  PetscInt       n = 1, stride = 1;

  column[0] = 0;
  weight[0] = 1;
  for (PetscInt a = 0; a < s->layout->dim; a++) {
    PetscInt  node[MPM_MAX_REACH];
    PetscReal sign[MPM_MAX_REACH];

    MpmNodesSeen(&s->layout->grid[a], s->scheme->basis, cell[a], parity[a], drop, node, sign);
    for (PetscInt d = reach - 1; d >= 0; d--) { /* the first n products are read last */
      for (PetscInt i = 0; i < n; i++) {
        column[d * n + i] = column[i] + stride * node[d];
        weight[d * n + i] = weight[i] * (row[a][d] * sign[d]);
      }
    }
    n *= reach;
    stride *= s->layout->grid[a].nodes;
  }
  return n;
}

static PetscInt WeightsMost(const MpmSlab *s)
{
  PetscInt n = 1;

  for (PetscInt a = 0; a < s->layout->dim; a++) n *= MpmMapReach(s->scheme->basis);
  return n;
}

/* The kind of the slopes of P2G_AFFINE, which no operation has: phi' r - phi, r = x_i - x_p. */
#define MOMENT_SLOPE MPM_OP_KINDS

static void Row(const MpmSlab *s, MpmOpKind kind, PetscInt a, PetscReal xi, const PetscInt wall[2], PetscReal row[])
{
  const MpmBasis *basis      = s->scheme->basis;
  const PetscReal half_width = s->layout->half_width[a];
  PetscReal       slope[MPM_MAX_REACH];

  MpmMapRow(basis, kind == MOMENT_SLOPE ? MPM_G2P : kind, xi, half_width, wall, row);
  if (kind != MOMENT_SLOPE) return;
  MpmMapRow(basis, MPM_G2P_SLOPE, xi, half_width, wall, slope);
  for (PetscInt d = 0; d < MpmMapReach(basis); d++) row[d] = slope[d] * (d - basis->reach_left - xi) - row[d];
}

/* The weights of a particle, with the kinds that they are of along each direction. */
static PetscInt Weights(const MpmMaps *maps, const MpmOpKind kinds[], const MpmParity parity[], PetscBool drop,
                        PetscInt p, PetscInt column[], PetscReal weight[])
{
  const MpmSlab *s = maps->slab;
  PetscInt       cell[MPM_MAX_DIM], wall[2];
  PetscReal      xi[MPM_MAX_DIM], row[MPM_MAX_DIM][MPM_MAX_REACH];

  if (!maps->places) MpmLayoutPlaceAt(s->layout, s->step.drift, s->begin + p, maps->step, cell, xi);
  for (PetscInt a = 0; a < s->layout->dim; a++) {
    if (maps->places) cell[a] = maps->places->cell[a][p];
    if (maps->places) xi[a] = maps->places->xi[a][p];
    MpmDirectionWalls(&s->layout->grid[a], cell[a], wall);
    Row(s, kinds[a], a, xi[a], wall, row[a]);
  }
  return NodeWeights(s, row, parity, drop, cell, column, weight);
}

/*
   A matrix of weights, particles x nodes. Rows are particles in the order of their ids, times a property. Two of a
   particle's nodes may be one and the same, in a short periodic grid or at a wall; their weights add up. At places
   weights of 0 are left out.
*/
static PetscErrorCode ParticlesByNodes(const MpmMaps *maps, const MpmOpKind kinds[], const MpmParity parity[],
                                       PetscBool drop, MpmProperty property, Mat *map)
{
  const MpmSlab *s    = maps->slab;
  const PetscInt most = WeightsMost(s);
  PetscInt      *column;
  PetscReal     *weight;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(most, &column, most, &weight));
  PetscCall(MatCreateAIJ(s->comm, s->particles, s->nodes, PETSC_DETERMINE, PETSC_DETERMINE, PetscMin(most, s->nodes),
                         NULL, PetscMin(most, (PetscInt)MpmLayoutNodes(s->layout) - s->nodes), NULL, map));
  for (PetscInt p = 0; p < s->particles; p++) {
    const PetscInt  id = s->begin + p, n = Weights(maps, kinds, parity, drop, p, column, weight);
    const PetscReal w    = property ? MpmMaterialProperty(s->layout, property, id) : 1;
    PetscInt        kept = 0;

    for (PetscInt i = 0; i < n; i++) {
      if (maps->places && weight[i] == 0) continue;
      column[kept]   = column[i];
      weight[kept++] = property ? weight[i] * w : weight[i];
    }
    PetscCall(MatSetValues(*map, 1, &id, kept, column, weight, ADD_VALUES));
  }
  PetscCall(PetscFree2(column, weight));
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of an operation. */
static PetscErrorCode OfKind(const MpmMaps *maps, MpmOpKind kind, PetscInt axis, PetscInt side,
                             const MpmParity parity[], PetscBool drop, Mat *map)
{
  MpmOpKind kinds[MPM_MAX_DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) kinds[a] = MpmKindAlong(kind, axis, a);
  PetscCall(ParticlesByNodes(maps, kinds, parity, drop,
                             maps->places ? MPM_NO_PROPERTY : MpmLayoutWeight(maps->slab->layout, kind, side), map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A number less than MPM_PARITIES for parities that mirror a node field alike. 0: even; 1 + a: the component of a
   vector along axis a; the last: a number that is imposed on walls.
*/
static PetscInt ParityClass(const MpmLayout *layout, const MpmParity parity[])
{
  if (MpmLayoutIsPeriodic(layout) || parity[0] == MPM_EVEN) return 0;
  for (PetscInt a = 0; a < layout->dim; a++)
    if (parity[a] == MPM_NORMAL) return 1 + a;
  return MPM_PARITIES - 1;
}

/*
   Along the axis that an operation acts along weights are those of its kind, along the others phi. So the derivative of
   a weight with respect to the place x_c of the particle is the same product, with the factor of direction c replaced
   by its derivative:

     weight     phi    phi'    phi r          phi r / D        r = x_i - x_p, D = sum_i phi r^2
     derivative phi'   phi''   phi' r - phi   (phi r / D)'

   Most are weights of another kind. Hats have the same slope all over a cell, and fit fields with it.
*/
PetscErrorCode MpmMapsWeights(MpmMaps *maps, MpmOpKind kind, PetscInt axis, PetscInt along, const MpmParity parity[],
                              Mat *map)
{
  const PetscBool value = kind == MPM_P2G || kind == MPM_G2P ? PETSC_TRUE : PETSC_FALSE,
                  slope = kind == MPM_DIV || kind == MPM_GRAD || kind == MPM_G2P_SLOPE ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt class  = ParityClass(maps->slab->layout, parity);
  Mat *known;

  PetscFunctionBegin;
  *map = NULL;
  if (kind == MPM_P2G_AFFINE && along != MPM_NONE) {
    MpmOpKind kinds[MPM_MAX_DIM] = {MPM_P2G, MPM_P2G, MPM_P2G};

    kinds[axis]  = kind;
    kinds[along] = along == axis ? MOMENT_SLOPE : MPM_G2P_SLOPE;
    known        = &maps->moment[axis][along][class];
    if (!*known) PetscCall(ParticlesByNodes(maps, kinds, parity, PETSC_FALSE, MPM_NO_PROPERTY, known));
    *map = *known;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (along == axis && !value && !maps->slab->scheme->basis->weights[MPM_CURVE]) PetscFunctionReturn(PETSC_SUCCESS);
  if (value && along != MPM_NONE) axis = along;
  if (value)
    kind = along == MPM_NONE ? MPM_G2P : MPM_G2P_SLOPE;
  else if (along != MPM_NONE) {
    kind = slope ? MPM_CURVE : MPM_CURVE_MLS;
    axis = slope ? MpmAxes(PetscMin(axis, along), PetscMax(axis, along)) : MpmAxes(axis, along);
  } else if (kind != MPM_P2G_AFFINE)
    kind = slope ? MPM_G2P_SLOPE : MPM_G2P_AFFINE;
  known = &maps->map[kind][axis][class];
  if (!*known) PetscCall(OfKind(maps, kind, axis, 0, parity, PETSC_FALSE, known));
  *map = *known;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodal masses. Images at a wall add to them with a positive sign, whatever the sign of the fields. */
static PetscErrorCode Masses(MpmMaps *maps)
{
  Mat shape;
  Vec ones;

  PetscFunctionBegin;
  if (maps->masses) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(OfKind(maps, MPM_P2G, 0, 0, even, PETSC_FALSE, &shape));
  PetscCall(MatCreateVecs(shape, &maps->masses, &ones));
  PetscCall(VecSet(ones, 1));
  PetscCall(MatMultTranspose(shape, ones, maps->masses));
  PetscCall(VecDestroy(&ones));
  PetscCall(MatDestroy(&shape));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix of a map between particles and nodes. */
static PetscErrorCode Between(MpmMaps *maps, MpmOpKind kind, PetscInt axis, PetscInt side, const MpmParity parity[],
                              Mat *map)
{
  Mat shape;
  Vec inverse;

  PetscFunctionBegin;
  if (MpmOpTraitsOf(kind).dst == MPM_ON_PARTICLES) {
    PetscCall(OfKind(maps, kind, axis, side, parity, PETSC_FALSE, map));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(OfKind(maps, kind, axis, side, parity, PETSC_FALSE, &shape));
  PetscCall(Masses(maps));
  PetscCall(MpmReciprocals(maps->masses, &inverse));
  PetscCall(MatDiagonalScale(shape, NULL, inverse));
  PetscCall(MatTranspose(shape, MAT_INITIAL_MATRIX, map));
  PetscCall(VecDestroy(&inverse));
  PetscCall(MatDestroy(&shape));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes W^T W as a dense matrix on every rank. */
static PetscErrorCode Square(Mat W, PetscReal square[])
{
  Mat product;

  PetscFunctionBegin;
  PetscCall(MatTransposeMatMult(W, W, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &product));
  PetscCall(MpmDenseCopy(product, square));
  PetscCall(MatDestroy(&product));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Replaces a symmetric matrix by its eigenvectors, as columns, divided by the square roots of their eigenvalues. Where
   an eigenvalue counts as 0 the column becomes 0.
*/
static PetscErrorCode HalfInverse(PetscInt n, PetscReal a[])
{
  PetscReal *lambda;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(n, &lambda));
  PetscCall(MpmDenseSymmetric(n, a, lambda));
  for (PetscInt j = 0; j < n; j++) {
    const PetscReal scale = lambda[j] > SINGULAR * lambda[n - 1] ? 1 / sqrt(lambda[j]) : 0;

    for (PetscInt i = 0; i < n; i++) a[(size_t)j * n + i] *= scale;
  }
  PetscCall(PetscFree(lambda));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Fills this rank's rows of half half^T. Negligible numbers, which are rounding, are left out. */
static PetscErrorCode FillRows(PetscInt n, const PetscReal half[], Mat inverse)
{
  PetscReal      *rows, largest = 0;
  PetscInt       *columns, begin, end;
  PetscBLASInt    order, count;
  const PetscReal one = 1, zero = 0;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(inverse, &begin, &end));
  PetscCall(PetscMalloc2((size_t)n * (end - begin) + 1, &rows, n, &columns));
  PetscCall(PetscBLASIntCast(n, &order));
  PetscCall(PetscBLASIntCast(end - begin, &count));
  if (count)
    PetscCallBLAS("BLASgemm", BLASgemm_("N", "T", &order, &count, &order, &one, half, &order, half + begin, &order,
                                        &zero, rows, &order));
  for (size_t i = 0; i < (size_t)n * (end - begin); i++) largest = PetscMax(largest, fabs(rows[i]));
  for (PetscInt i = begin; i < end; i++) {
    PetscReal *row  = rows + (size_t)n * (i - begin);
    PetscInt   kept = 0;

    for (PetscInt j = 0; j < n; j++) {
      if (fabs(row[j]) <= NEGLIGIBLE * largest) continue;
      columns[kept] = j;
      row[kept++]   = row[j];
    }
    PetscCall(MatSetValues(inverse, 1, &i, kept, columns, row, INSERT_VALUES));
  }
  PetscCall(PetscFree2(rows, columns));
  PetscCall(MatAssemblyBegin(inverse, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(inverse, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   (W^T W)^+ M for W (particles x nodes) and the masses M on the nodes, by all eigenvalues and vectors, in the scaled
   form

     D (D W^T W D)^+ D^-1   with D = M^-1/2

   The scaling gives light and heavy nodes the same weight. Then only nodal data that no particle feels are singular. W
   is overwritten. Every rank diagonalises the whole matrix.
*/
static PetscErrorCode NormalInverse(Mat W, Vec masses, Mat *inverse)
{
  PetscInt   n, local;
  PetscReal *half;
  Vec        root, inverse_root;

  PetscFunctionBegin;
  PetscCall(MatGetSize(W, NULL, &n));
  PetscCall(MatGetLocalSize(W, NULL, &local));
  MpmCheckInput(n <= MOST_NODES,
                "cells: the operator of this transfer holds an inverse of %" PetscInt_FMT
                " nodes; allowed: at most %d ('mpmstab run' and 'symbol' take more)",
                n, MOST_NODES);
  PetscCall(PetscMalloc1((size_t)n * n, &half));
  PetscCall(VecDuplicate(masses, &root));
  PetscCall(VecCopy(masses, root));
  PetscCall(VecSqrtAbs(root));
  PetscCall(MpmReciprocals(root, &inverse_root));
  PetscCall(MatDiagonalScale(W, NULL, inverse_root));
  PetscCall(Square(W, half));
  PetscCall(HalfInverse(n, half));
  PetscCall(MatCreateAIJ(PetscObjectComm((PetscObject)W), local, local, n, n, local, NULL, n - local, NULL, inverse));
  PetscCall(FillRows(n, half, *inverse));
  PetscCall(PetscFree(half));
  PetscCall(MatDiagonalScale(*inverse, inverse_root, root));
  PetscCall(VecDestroy(&root));
  PetscCall(VecDestroy(&inverse_root));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Multiplies W by sqrt(m), so that its normal equations have the matrix W^T m W. */
static PetscErrorCode WeighRoots(const MpmSlab *r, Mat W)
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

/* The matrix of SOLVE. */
static PetscErrorCode Solve(MpmMaps *maps, const MpmParity parity[], Mat *map)
{
  Mat W;

  PetscFunctionBegin;
  PetscCall(Masses(maps));
  PetscCall(OfKind(maps, MPM_G2P, 0, 0, parity, PETSC_TRUE, &W));
  PetscCall(WeighRoots(maps->slab, W));
  PetscCall(NormalInverse(W, maps->masses, map));
  PetscCall(MatDestroy(&W));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix of a stencil. Nodes beyond a wall are replaced by those that they are images of. */
static PetscErrorCode Stencil(const MpmSlab *r, const MpmOp *op, const MpmParity parity[], Mat *map)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(r->comm, r->nodes, r->nodes, PETSC_DETERMINE, PETSC_DETERMINE, PetscMin(3, r->nodes), NULL,
                         PetscMin(2, (PetscInt)MpmLayoutNodes(r->layout) - r->nodes), NULL, map));
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

/* The nodes of a wall: 1 for these, and no other entries. */
static PetscErrorCode Wall(const MpmSlab *slab, PetscInt axis, PetscInt side, Mat *map)
{
  const PetscInt wall = side ? slab->layout->grid[axis].nodes - 1 : 0;
  PetscInt       stride;

  PetscFunctionBegin;
  PetscCall(
      MatCreateAIJ(slab->comm, slab->nodes, slab->nodes, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0, NULL, map));
  for (PetscInt node = slab->node0; node < slab->node0 + slab->nodes; node++)
    if (MpmNodeAlong(slab->layout, node, axis, &stride) == wall)
      PetscCall(MatSetValue(*map, node, node, 1, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMapsGet(MpmMaps *maps, const MpmOp *op, Mat *map)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const MpmParity  *parity = maps->slab->scheme->table->parity[traits.dst == MPM_ON_NODES ? op->dst : op->src];
  const PetscBool   wall   = op->kind == MPM_WALL ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt    axes   = op->axis + (wall ? 0 : MPM_MAX_DIM * op->side); /* GRAD has an axis and a modulus */
  Mat              *known  = &maps->map[op->kind][axes][wall ? op->side : ParityClass(maps->slab->layout, parity)];

  PetscFunctionBegin;
  if (!*known && wall)
    PetscCall(Wall(maps->slab, op->axis, op->side, known));
  else if (!*known && op->kind == MPM_SOLVE)
    PetscCall(Solve(maps, parity, known));
  else if (!*known && traits.dst == traits.src)
    PetscCall(Stencil(maps->slab, op, parity, known));
  else if (!*known)
    PetscCall(Between(maps, op->kind, op->axis, op->side, parity, known));
  *map = *known;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMapsEven(const MpmSlab *slab, PetscInt64 step, Mat *map)
{
  MpmMaps maps = {.slab = slab, .step = step};

  PetscFunctionBegin;
  PetscCall(Between(&maps, MPM_P2G, 0, 0, even, map));
  PetscCall(MpmMapsDestroy(&maps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define EVERY_MAP (MPM_OP_KINDS * MPM_AXES * MPM_PARITIES)

PetscErrorCode MpmMapsCount(const MpmMaps *maps, PetscReal *numbers)
{
  PetscFunctionBegin;
  *numbers = 0;
  for (PetscInt m = 0; m < EVERY_MAP; m++) {
    const Mat map = (&maps->map[0][0][0])[m];
    MatInfo   info;

    if (!map || m / (MPM_AXES * MPM_PARITIES) == MPM_WALL) continue;
    PetscCall(MatGetInfo(map, MAT_GLOBAL_SUM, &info));
    *numbers += info.nz_used;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMapsDestroy(MpmMaps *maps)
{
  PetscFunctionBegin;
  for (PetscInt m = 0; m < EVERY_MAP; m++) PetscCall(MatDestroy(&(&maps->map[0][0][0])[m]));
  for (size_t m = 0; m < sizeof maps->moment / sizeof(Mat); m++) PetscCall(MatDestroy(&(&maps->moment[0][0][0])[m]));
  PetscCall(VecDestroy(&maps->masses));
  PetscFunctionReturn(PETSC_SUCCESS);
}
