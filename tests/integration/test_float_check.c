/*
   Floating-point flags that are raised within a step end it with one message, on all ranks. Those of a state that has
   left the range of doubles do not.
*/
#include "check.h"
#include "base/float_check.h"
#include <fenv.h>

static char said[256];

static PetscErrorCode Keep(MPI_Comm comm, int line, const char *function, const char *file, PetscErrorCode code,
                           PetscErrorType kind, const char *message, void *context)
{
  (void)comm;
  (void)line;
  (void)function;
  (void)file;
  (void)context;
  if (kind == PETSC_ERROR_INITIAL) snprintf(said, sizeof said, "%s", message);
  return code;
}

/* Makes a step in which the last rank divides. */
static PetscErrorCode Step(PetscReal over, PetscReal under, MpmFloatCheck *check)
{
  volatile PetscReal number = 0;
  PetscMPIInt        rank, size;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  said[0] = 0;
  MpmFloatBegin();
  if (rank == size - 1) number = over / under;
  (void)number;
  return MpmFloatEnd(PETSC_COMM_WORLD, check, "test", 7);
}

static PetscErrorCode Test(int argc, char **argv)
{
  MpmFloatCheck check = {PETSC_FALSE};

  (void)argc;
  (void)argv;
  PetscFunctionBegin;
  PetscCall(PetscPushErrorHandler(Keep, NULL));
  (void)feraiseexcept(FE_INVALID); /* before the step, so not its own */
  CHECK(!Step(1, 3, &check), "%s", said);
  CHECK(Step(0, 0, &check) == PETSC_ERR_FP && strstr(said, "test, step 7: an invalid"), "0/0: '%s'", said);
  CHECK(Step(1, 0, &check) == PETSC_ERR_FP && strstr(said, "test, step 7: a division"), "1/0: '%s'", said);
  CHECK(!Step(1e300, 1e-300, &check) && check.left, "an overflow: '%s'", said);
  CHECK(!Step(0, 0, &check), "0/0 after an overflow: '%s'", said);
  PetscCall(PetscPopErrorHandler());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
