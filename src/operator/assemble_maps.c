/* The maps between particles and nodes as sparse matrices, at the particles' places of a step. */
#include "operator/assemble.h"
#include "scene/layout.h"
#include "scene/material.h"
#include "linalg/normal_inverse.h"
#include <math.h>

/*
   Rows are particles in the order of their ids, times what the operation weighs them with. Nodes that a short grid's
   wrap or a wall makes one add up.
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

/* The nodal masses at a step: of both images together, whatever the sign of the fields. */
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

/* sqrt(m) W, so that its square is W^T m W. */
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
