/*
   The march in two and three dimensions. What the assembled operator says, A q = march(q), must hold for every
   formulation, transfer and basis. Results by particle id on all ranks equal those on one rank. A scene that does not
   vary along y is the one-dimensional one, and a scene with its axes exchanged is the same scene.
*/
#include "gather.h"
#include "march/conserved.h"
#include <mpmstab/operator.h>

/* A q = march(q) over three periods, and A is not the identity. */
static PetscErrorCode Agrees(const char options[])
{
  MpmScene    *scene;
  MpmOperator *op;
  PetscReal    mismatch;
  Vec          q, image;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmOperatorMismatch(op, &mismatch));
  CHECK(mismatch <= 1e-13 * op->period, "%s: %.3g", options, mismatch);
  PetscCall(MatCreateVecs(op->A, &q, &image));
  PetscCall(VecSetRandom(q, NULL));
  PetscCall(MatMult(op->A, q, image));
  PetscCall(VecAXPY(image, -1, q));
  PetscCall(VecNorm(image, NORM_INFINITY, &mismatch));
  CHECK(mismatch > 1e-3, "%s: the operator does nothing", options);
  PetscCall(VecDestroy(&q));
  PetscCall(VecDestroy(&image));
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const schemes[] = {
      "-formulation gas1",
      "-formulation gas2 -basis quadratic",
      "-formulation elastic",
      "-formulation usl -basis quadratic",
      "-formulation usl -transfer apic -gradient mls -basis quadratic",
      "-formulation usl -transfer apic -basis gimp",
      "-formulation usl -poisson 0.5 -transfer apic -gradient mls -basis cubic",
      "-formulation usf -transfer pic -basis cubic",
      "-formulation musl -transfer blend",
      "-formulation musl -transfer xpic -basis gimp -poisson 0",
      "-formulation usavg -basis cubic -gradient mls",
  };
  static const char *const rests[] = {
      "-dim 2 -cells 6,7",
      "-dim 2 -cells 7,6 -jitter 0.8 -ppc 1,2",
      "-dim 2 -cells 6,7 -ppc 1 -drift 1/2,-1/3 -courant 0.1",
      "-dim 2 -cells 7,6 -drift 0,1/2 -courant 0.1 -ppc 1",
  };

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(schemes); s++) {
    for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) {
      char options[512];

      PetscCall(PetscSNPrintf(options, sizeof options, "%s %s", schemes[s], rests[r]));
      PetscCall(Agrees(options));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
