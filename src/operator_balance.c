/* The operator in variables whose squares make the energy 1/2 sum m v^2 + V s^2 / E. */
#include <mpmstab/material.h>
#include <mpmstab/operator.h>
#include <math.h>

static PetscBool IsStress(const MpmScene *scene, PetscInt field)
{
  for (PetscInt t = 0; t < scene->formulation->nenergy; t++) {
    const MpmEnergyTerm *term = &scene->formulation->energy[t];

    if (term->place == MPM_ON_PARTICLES && term->field == field) return term->stress;
  }
  return PETSC_FALSE;
}

/* sqrt(m), or sqrt(V / E) of a stress, to the next power of two. */
static PetscReal UnitOf(const MpmScene *scene, PetscInt field, PetscInt64 id)
{
  const PetscReal square = IsStress(scene, field) ? MpmMaterialProperty(scene, MPM_VOLUME, id) /
                                                        MpmMaterialProperty(scene, MPM_STIFFNESS, id)
                                                  : MpmMaterialProperty(scene, MPM_MASS, id);

  return exp2(rint(log2(square) / 2));
}

PetscErrorCode MpmOperatorBalance(MpmOperator *op)
{
  const PetscBool *varies = op->scene->table->varies;
  PetscInt         begin, end;
  PetscReal       *unit;
  Vec              inverse;

  PetscFunctionBegin;
  if (!varies[MPM_MASS] && !varies[MPM_STIFFNESS]) {
    PetscCall(PetscObjectReference((PetscObject)op->A));
    op->balanced = op->A;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatCreateVecs(op->A, NULL, &op->unit));
  PetscCall(VecGetOwnershipRange(op->unit, &begin, &end));
  PetscCall(VecGetArray(op->unit, &unit));
  for (PetscInt row = begin; row < end; row++)
    unit[row - begin] = UnitOf(op->scene, row % op->fields, row / op->fields);
  PetscCall(VecRestoreArray(op->unit, &unit));
  PetscCall(VecDuplicate(op->unit, &inverse));
  PetscCall(VecCopy(op->unit, inverse));
  PetscCall(VecReciprocal(inverse));
  PetscCall(MatDuplicate(op->A, MAT_COPY_VALUES, &op->balanced));
  PetscCall(MatDiagonalScale(op->balanced, op->unit, inverse));
  PetscCall(VecDestroy(&inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorToState(const MpmOperator *op, Vec re, Vec im)
{
  PetscReal norm[2];

  PetscFunctionBegin;
  if (!op->unit) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecPointwiseDivide(re, re, op->unit));
  PetscCall(VecPointwiseDivide(im, im, op->unit));
  PetscCall(VecNorm(re, NORM_2, &norm[0]));
  PetscCall(VecNorm(im, NORM_2, &norm[1]));
  PetscCall(VecScale(re, 1 / hypot(norm[0], norm[1])));
  PetscCall(VecScale(im, 1 / hypot(norm[0], norm[1])));
  PetscFunctionReturn(PETSC_SUCCESS);
}
