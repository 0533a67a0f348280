/* Refusals print one line; errors inside the program keep PETSc's stack trace. */
#include <mpmstab/errors.h>
#include <ctype.h>

/* One line whatever the input holds: a value may have line ends in it, or a terminal's control sequences. */
static void PrintLine(const char message[])
{
  fflush(stdout); /* so that the two do not mix where both go to one place */
  fprintf(stderr, "mpmstab: ");
  for (const char *c = message; *c; c++) fputc(iscntrl((unsigned char)*c) ? '?' : *c, stderr);
  fprintf(stderr, "\n");
}

static PetscErrorCode RefusalHandler(MPI_Comm comm, int line, const char *function, const char *file,
                                     PetscErrorCode code, PetscErrorType kind, const char *message, void *context)
{
  PetscMPIInt rank = 0;

  if (code != PETSC_ERR_USER_INPUT)
    return PetscTraceBackErrorHandler(comm, line, function, file, code, kind, message, context);
  if (kind == PETSC_ERROR_INITIAL) {
    MPI_Comm_rank(comm, &rank);
    if (rank == 0) PrintLine(message);
  }
  return code;
}

PetscErrorCode MpmErrorsInstall(void)
{
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(RefusalHandler, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}
