/* A q = march(q): the assembled operator is the code that runs, at rest, jittered and drifting. */
#include "check.h"
#include <mpmstab/operator.h>

static PetscErrorCode Agrees(const char formulation[], const char rest[])
{
  char         options[256];
  MpmScene    *scene;
  MpmOperator *op;
  PetscReal    mismatch;
  Vec          q, image;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s %s", formulation, rest));
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmOperatorMismatch(op, &mismatch));
  CHECK(mismatch <= 1e-14 * op->period, "%s: %.3g", options, mismatch);
  CHECK(op->order == op->fields * scene->layout.particles, "%s: order %d", options, (int)op->order);
  /* a uniform state stays as it is, so the test above would also pass with an empty march and A = I: check that not */
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
  static const char *const rests[] = {
      "-cells 24",
      "-cells 6 -ppc 1 -offset 0",
      "-cells 25 -jitter 0.9 -ppc 3 -courant 1.2",
      "-cells 24 -drift 1/4 -courant 0.2", /* meets nodes exactly */
      "-cells 24 -drift -3/7 -jitter 0.5 -courant 0.2",
      "-cells 20 -drift 7/2 -courant 0.2 -ppc 1",      /* whole cells on the way */
      "-cells 24 -drift 0.3 -offset 0.1 -courant 0.1", /* ten steps */
      "-cells 16 -drift 1/2 -courant 1.3 -ppc 4",
  };

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) PetscCall(Agrees(MpmFormulations[f]->name, rests[r]));
  PetscCall(Agrees("gas1", "-cells 8 -drift 1/40 -courant 1e5 -ppc 1")); /* a period of growth beyond 1e154 */
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
