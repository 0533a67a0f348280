/* A q = march(q): the assembled operator does what the march does, at rest, jittered and drifting. */
#include "operators.h"

static PetscErrorCode Agrees(const char formulation[], const char rest[])
{
  char options[256];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s %s", formulation, rest));
  PetscCall(CheckOperator(options, 1e-14));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const rests[] = {
      "-cells 24",
      "-cells 6 -ppc 1 -offset 0",
      "-cells 25 -jitter 0.9 -ppc 3 -courant 1.2",
      "-cells 24 -drift 1/4 -courant 0.2", /* particles meet nodes exactly */
      "-cells 24 -drift -3/7 -jitter 0.5 -courant 0.2",
      "-cells 20 -drift 7/2 -courant 0.2 -ppc 1",      /* the drift includes whole cells */
      "-cells 24 -drift 0.3 -offset 0.1 -courant 0.1", /* a period of ten steps */
      "-cells 16 -drift 1/2 -courant 1.3 -ppc 4",
  };
  PetscBool turn = PETSC_FALSE;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) {
      PetscCall(CheckHasTurn(f + (PetscInt)r, &turn));
      if (turn) PetscCall(Agrees(MpmFormulations[f]->name, rests[r]));
    }
  PetscCall(Agrees("gas1", "-cells 8 -drift 1/40 -courant 1e5 -ppc 1")); /* the growth of a period exceeds 1e154 */
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
