/* The operator of a scene beside its march. */
#pragma once
#include "check.h"
#include <mpmstab/operator.h>

/*
   A q = march(q) of a scene to a tolerance in each step of a period, or to that of the march's solver where it has one. options
   name the scene in messages.
*/
static inline PetscErrorCode CheckOperatorOf(const MpmScene *scene, const char options[], PetscReal tolerance)
{
  MpmOperator *op;
  PetscReal    mismatch;
  Vec          q, image;

  PetscFunctionBegin;
  if (MpmTableSolves(scene->scheme.table)) tolerance = PetscMax(tolerance, 1e-12);
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmOperatorMismatch(op, &mismatch));
  CHECK(mismatch <= tolerance * op->period, "%s: %.3g", options, mismatch);
  CHECK(op->order == op->fields * scene->layout.particles, "%s: order %d", options, (int)op->order);
  /* A uniform state stays as it is, so an empty march with A = I would pass the test above. A random state must change. */
  PetscCall(MatCreateVecs(op->A, &q, &image));
  PetscCall(VecSetRandom(q, NULL));
  PetscCall(MatMult(op->A, q, image));
  PetscCall(VecAXPY(image, -1, q));
  PetscCall(VecNorm(image, NORM_INFINITY, &mismatch));
  CHECK(mismatch > 1e-3, "%s: the operator does nothing", options);
  PetscCall(VecDestroy(&q));
  PetscCall(VecDestroy(&image));
  PetscCall(MpmOperatorDestroy(&op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode CheckOperator(const char options[], PetscReal tolerance)
{
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckOperatorOf(scene, options, tolerance));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}
