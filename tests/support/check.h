/* Checks that print what failed. A test that does not fail prints nothing. */
#pragma once
#include "scene/request.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static int check_failures;

#define CHECK(condition, ...)                                                                                          \
  do {                                                                                                                 \
    if (!(condition)) {                                                                                                \
      fprintf(stderr, "%s:%d: %s: ", __FILE__, __LINE__, #condition);                                                  \
      fprintf(stderr, __VA_ARGS__);                                                                                    \
      fprintf(stderr, "\n");                                                                                           \
      check_failures++;                                                                                                \
    }                                                                                                                  \
  } while (0)

#define CHECK_NEAR(a, b, tolerance)                                                                                    \
  CHECK(fabs((a) - (b)) <= (tolerance), "%.17g and %.17g differ by %.3g, allowed %.3g", (double)(a), (double)(b),      \
        fabs((double)((a) - (b))), (double)(tolerance))

/*
   Says whether these ranks try the i-th case: on P ranks every P-th. That a scheme is right is shown on one rank, where
   all are tried unless a test says that its ranks at night have the others; that ranks do not matter is shown by enough of them.
*/
static inline PetscErrorCode CheckHasTurn(PetscInt i, PetscBool *turn)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  *turn = i % size == 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The request that belongs to the scene which CheckScene or CheckSceneOf made last. */
static MpmRequest check_request;

/* Makes the scene of a task from options such as "-cells 8 -drift 1/8", which are read as the program reads them. */
static inline PetscErrorCode CheckSceneOf(const char task[], const char options[], MpmScene **scene)
{
  PetscFunctionBegin;
  PetscCall(PetscOptionsClear(NULL));
  PetscCall(PetscOptionsInsertString(NULL, options));
  PetscCall(MpmSceneCreate(task, NULL, scene, &check_request));
  PetscCall(PetscOptionsClear(NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode CheckScene(const char options[], MpmScene **scene)
{
  PetscFunctionBegin;
  PetscCall(CheckSceneOf("run", options, scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

#define CHECK_MAIN(body)                                                                                               \
  int main(int argc, char **argv)                                                                                      \
  {                                                                                                                    \
    if (PetscInitialize(&argc, &argv, NULL, NULL)) return 1;                                                           \
    if (MpmErrorsInstall() || body(argc, argv)) MPI_Abort(PETSC_COMM_WORLD, 1);                                        \
    if (PetscFinalize()) return 1;                                                                                     \
    return check_failures ? 1 : 0;                                                                                     \
  }
