/* The operator in variables whose squares make the energy 1/2 sum m v^2 + V s^2 / E: for solvers, and as a norm. */
#include "scene/material.h"
#include <mpmstab/operator.h>
#include <math.h>

static PetscBool IsStress(const MpmFormulation *formulation, PetscInt field)
{
  for (PetscInt t = 0; t < formulation->nenergy; t++) {
    const MpmEnergyTerm *term = &formulation->energy[t];

    if (term->place == MPM_ON_PARTICLES && term->field == field) return term->stress;
  }
  return PETSC_FALSE;
}

/* sqrt(m), or sqrt(V / E) of a stress. */
static PetscReal RootOf(const MpmOperator *op, PetscInt field, PetscInt64 id)
{
  return sqrt(IsStress(op->scheme->formulation, field)
                  ? MpmMaterialProperty(op->layout, MPM_VOLUME, id) / MpmMaterialProperty(op->layout, MPM_STIFFNESS, id)
                  : MpmMaterialProperty(op->layout, MPM_MASS, id));
}

static PetscBool IsAlike(const MpmOperator *op)
{
  const PetscBool *varies = op->layout->varies;

  return !varies[MPM_MASS] && !varies[MPM_STIFFNESS] ? PETSC_TRUE : PETSC_FALSE;
}

/* D A D^-1, and D; the roots themselves, or the powers of two next to them. */
static PetscErrorCode Scale(const MpmOperator *op, PetscBool powers, Mat A, Vec *unit, Mat *scaled)
{
  PetscInt   begin, end;
  PetscReal *d;
  Vec        inverse;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(A, NULL, unit));
  PetscCall(VecGetOwnershipRange(*unit, &begin, &end));
  PetscCall(VecGetArray(*unit, &d));
  for (PetscInt row = begin; row < end; row++) {
    const PetscReal root = RootOf(op, row % op->fields, row / op->fields);

    d[row - begin] = powers ? exp2(rint(log2(root))) : root;
  }
  PetscCall(VecRestoreArray(*unit, &d));
  PetscCall(VecDuplicate(*unit, &inverse));
  PetscCall(VecCopy(*unit, inverse));
  PetscCall(VecReciprocal(inverse));
  PetscCall(MatDuplicate(A, MAT_COPY_VALUES, scaled));
  PetscCall(MatDiagonalScale(*scaled, *unit, inverse));
  PetscCall(VecDestroy(&inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorBalance(MpmOperator *op)
{
  PetscFunctionBegin;
  if (IsAlike(op)) {
    PetscCall(PetscObjectReference((PetscObject)op->A));
    op->balanced = op->A;
  } else
    PetscCall(Scale(op, PETSC_TRUE, op->A, &op->unit, &op->balanced));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorWeigh(const MpmOperator *op, Mat A, Mat *weighed)
{
  Vec unit;

  PetscFunctionBegin;
  if (IsAlike(op)) {
    PetscCall(PetscObjectReference((PetscObject)A));
    *weighed = A;
  } else {
    PetscCall(Scale(op, PETSC_FALSE, A, &unit, weighed));
    PetscCall(VecDestroy(&unit));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

const char *MpmOperatorNorm(const MpmOperator *op)
{
  const MpmFormulation *f       = op->scheme->formulation;
  PetscInt              squares = 0;

  for (PetscInt t = 0; t < f->nenergy; t++) squares += f->energy[t].place == MPM_ON_PARTICLES;
  if (squares == op->fields) return "the energy's, of the particles";
  return IsAlike(op) ? "Euclidean over particles and fields, no energy"
                     : "over particles and fields, velocities weighted as in the energy, no energy";
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
