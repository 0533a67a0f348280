/*
   The maps of a step as sparse matrices. A weight is the product of the weights along the directions, which come from
   the basis' kernels (MpmMapRow), for all that is asked of a map here.
*/
#include "program/maps.h"
#include "linalg/normal_inverse.h"
#include "scene/layout.h"
#include "scene/material.h"
#include <math.h>

static const MpmParity even[MPM_MAX_DIM] = {MPM_EVEN, MPM_EVEN, MPM_EVEN};

PetscInt MpmNodeWeights(const MpmSlab *s, PetscReal row[][MPM_MAX_REACH], const MpmParity parity[], PetscBool drop,
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

PetscInt MpmNodeWeightsMost(const MpmSlab *s)
{
  PetscInt n = 1;

  for (PetscInt a = 0; a < s->layout->dim; a++) n *= MpmMapReach(s->scheme->basis);
  return n;
}

PetscErrorCode MpmNodeWeightsMatrix(const MpmSlab *s, Mat *matrix)
{
  const PetscInt most = MpmNodeWeightsMost(s);

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(s->comm, s->particles, s->nodes, PETSC_DETERMINE, PETSC_DETERMINE, PetscMin(most, s->nodes),
                         NULL, PetscMin(most, (PetscInt)MpmLayoutNodes(s->layout) - s->nodes), NULL, matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The matrix of a map, particles x nodes. Rows are particles in the order of their ids, times the property that the
   operation multiplies them with. Two of a particle's nodes may be one and the same, in a short periodic grid or at a
   wall; their weights add up.
*/
static PetscErrorCode ParticlesByNodes(const MpmMaps *maps, MpmOpKind kind, PetscInt axis, const MpmParity parity[],
                                       PetscBool drop, Mat *map)
{
  const MpmSlab    *s      = maps->slab;
  const MpmLayout  *layout = s->layout;
  const PetscInt    most   = MpmNodeWeightsMost(s);
  const MpmProperty weight = MpmLayoutWeight(layout, kind);
  PetscInt         *columns;
  PetscReal        *numbers;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(most, &columns, most, &numbers));
  PetscCall(MpmNodeWeightsMatrix(s, map));
  for (PetscInt p = 0; p < s->particles; p++) {
    const PetscInt  id = s->begin + p;
    PetscInt        cell[MPM_MAX_DIM], wall[2];
    PetscReal       xi[MPM_MAX_DIM], row[MPM_MAX_DIM][MPM_MAX_REACH];
    const PetscReal w = weight ? MpmMaterialProperty(layout, weight, id) : 1;

    MpmLayoutPlaceAt(layout, s->step.drift, id, maps->step, cell, xi);
    for (PetscInt a = 0; a < layout->dim; a++) {
      MpmDirectionWalls(&layout->grid[a], cell[a], wall);
      MpmMapRow(s->scheme->basis, MpmKindAlong(kind, axis, a), xi[a], layout->half_width[a], wall, row[a]);
    }
    (void)MpmNodeWeights(s, row, parity, drop, cell, columns, numbers);
    for (PetscInt i = 0; i < most && weight; i++) numbers[i] *= w;
    PetscCall(MatSetValues(*map, 1, &id, most, columns, numbers, ADD_VALUES));
  }
  PetscCall(PetscFree2(columns, numbers));
  PetscCall(MatAssemblyBegin(*map, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*map, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nodal masses. Images at a wall add to them with a positive sign, whatever the sign of the fields. */
static PetscErrorCode Masses(MpmMaps *maps)
{
  Mat shape;
  Vec ones;

  PetscFunctionBegin;
  if (maps->masses) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(ParticlesByNodes(maps, MPM_P2G, 0, even, PETSC_FALSE, &shape));
  PetscCall(MatCreateVecs(shape, &maps->masses, &ones));
  PetscCall(VecSet(ones, 1));
  PetscCall(MatMultTranspose(shape, ones, maps->masses));
  PetscCall(VecDestroy(&ones));
  PetscCall(MatDestroy(&shape));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix of a map between particles and nodes. */
static PetscErrorCode Between(MpmMaps *maps, MpmOpKind kind, PetscInt axis, const MpmParity parity[], Mat *map)
{
  Mat shape;
  Vec inverse;

  PetscFunctionBegin;
  if (MpmOpTraitsOf(kind).dst == MPM_ON_PARTICLES) {
    PetscCall(ParticlesByNodes(maps, kind, axis, parity, PETSC_FALSE, map));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(ParticlesByNodes(maps, kind, axis, parity, PETSC_FALSE, &shape));
  PetscCall(Masses(maps));
  PetscCall(VecDuplicate(maps->masses, &inverse));
  PetscCall(VecCopy(maps->masses, inverse));
  PetscCall(VecReciprocal(inverse)); /* of the numbers that are not 0 */
  PetscCall(MatDiagonalScale(shape, NULL, inverse));
  PetscCall(MatTranspose(shape, MAT_INITIAL_MATRIX, map));
  PetscCall(VecDestroy(&inverse));
  PetscCall(MatDestroy(&shape));
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
  PetscCall(ParticlesByNodes(maps, MPM_G2P, 0, parity, PETSC_TRUE, &W));
  PetscCall(WeighRoots(maps->slab, W));
  PetscCall(MpmNormalInverse(W, maps->masses, map));
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

PetscErrorCode MpmWallSelection(const MpmSlab *slab, PetscInt axis, PetscInt side, Mat *map)
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

PetscInt MpmParityClass(const MpmLayout *layout, const MpmParity parity[])
{
  if (MpmLayoutIsPeriodic(layout) || parity[0] == MPM_EVEN) return 0;
  for (PetscInt a = 0; a < layout->dim; a++)
    if (parity[a] == MPM_NORMAL) return 1 + a;
  return MPM_PARITIES - 1;
}

PetscErrorCode MpmMapsGet(MpmMaps *maps, const MpmOp *op, Mat *map)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const MpmParity  *parity = maps->slab->scheme->table->parity[traits.dst == MPM_ON_NODES ? op->dst : op->src];
  Mat              *known  = &maps->map[op->kind][op->axis][MpmParityClass(maps->slab->layout, parity)];

  PetscFunctionBegin;
  if (!*known && op->kind == MPM_SOLVE)
    PetscCall(Solve(maps, parity, known));
  else if (!*known && traits.dst == traits.src)
    PetscCall(Stencil(maps->slab, op, parity, known));
  else if (!*known)
    PetscCall(Between(maps, op->kind, op->axis, parity, known));
  *map = *known;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMapsEven(const MpmSlab *slab, PetscInt64 step, Mat *map)
{
  MpmMaps maps = {.slab = slab, .step = step};

  PetscFunctionBegin;
  PetscCall(Between(&maps, MPM_P2G, 0, even, map));
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

    if (!map) continue;
    PetscCall(MatGetInfo(map, MAT_GLOBAL_SUM, &info));
    *numbers += info.nz_used;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMapsDestroy(MpmMaps *maps)
{
  PetscFunctionBegin;
  for (PetscInt m = 0; m < EVERY_MAP; m++) PetscCall(MatDestroy(&(&maps->map[0][0][0])[m]));
  PetscCall(VecDestroy(&maps->masses));
  PetscFunctionReturn(PETSC_SUCCESS);
}
