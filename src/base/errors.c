/* Refusals print one line; errors inside the program keep PETSc's stack trace. */
#include <mpmstab/errors.h>
#include "base/unfinished.h"
#include <ctype.h>
#include <stdarg.h>
#include <sys/stat.h>
#include <unistd.h>

static char blamed[PETSC_MAX_PATH_LEN];

void MpmErrorsBlame(const char file[])
{
  (void)PetscStrncpy(blamed, file, sizeof blamed);
}

/* One line whatever the input holds: a value may have line ends in it, or a terminal's control sequences. */
static void PrintLine(const char message[])
{
  fflush(stdout); /* so that the two do not mix where both go to one place */
  fprintf(stderr, "mpmstab: ");
  for (const char *c = message; *c; c++) fputc(iscntrl((unsigned char)*c) ? '?' : *c, stderr);
  fprintf(stderr, "\n");
}

/* One rank's write has failed, the others may wait for it: whoever finds the file still there speaks for all. */
static void LeaveFile(const char message[])
{
  char        why[PETSC_MAX_PATH_LEN + 256];
  PetscMPIInt size = 1;

  (void)PetscSNPrintf(why, sizeof why, "%s: cannot be written: %s; allowed: a disk with room", blamed, message);
  if (MpmUnfinishedRemove()) PrintLine(why);
  MPI_Comm_size(PETSC_COMM_WORLD, &size);
  if (size == 1) _exit(MPM_EXIT_REFUSED); /* MPI_Abort would have words of its own */
  MPI_Abort(PETSC_COMM_WORLD, MPM_EXIT_REFUSED);
}

static PetscErrorCode RefusalHandler(MPI_Comm comm, int line, const char *function, const char *file,
                                     PetscErrorCode code, PetscErrorType kind, const char *message, void *context)
{
  PetscMPIInt rank = 0;

  if (code == PETSC_ERR_LIB && kind == PETSC_ERROR_INITIAL && blamed[0]) LeaveFile(message);
  if (code != PETSC_ERR_USER_INPUT)
    return PetscTraceBackErrorHandler(comm, line, function, file, code, kind, message, context);
  if (kind == PETSC_ERROR_INITIAL) {
    MPI_Comm_rank(comm, &rank);
    if (rank == 0) PrintLine(message);
  }
  return code;
}

static PetscErrorCode OutsideHandler(MPI_Comm comm, int line, const char *function, const char *file,
                                     PetscErrorCode code, PetscErrorType kind, const char *message, void *context)
{
  char        why[1024];
  int         started = 0;
  PetscMPIInt rank    = 0;

  (void)comm, (void)line, (void)function, (void)file, (void)context;
  if (kind != PETSC_ERROR_INITIAL) return code;
  MPI_Initialized(&started);
  if (started) MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  (void)snprintf(why, sizeof why, "PETSc refuses one of its options: %s", message);
  if (rank == 0) PrintLine(why);
  return code;
}

PetscErrorCode MpmErrorsOutside(void)
{
  return PetscPushErrorHandler(OutsideHandler, NULL);
}

PetscErrorCode MpmErrorsInstall(void)
{
  PetscFunctionBeginUser;
  PetscCall(PetscPushErrorHandler(RefusalHandler, NULL));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmPrint(const char format[], ...)
{
  PetscMPIInt rank = 0;
  va_list     arguments;

  MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
  if (rank) return;
  va_start(arguments, format);
  (void)vprintf(format, arguments);
  va_end(arguments);
}

PetscBool MpmErrorsReportLost(void)
{
  struct stat is;

  if (!fflush(stdout) && !ferror(stdout)) return PETSC_FALSE;
  if (!fstat(fileno(stdout), &is) && (S_ISFIFO(is.st_mode) || S_ISSOCK(is.st_mode))) return PETSC_FALSE;
  fprintf(stderr, "mpmstab: standard output cannot be written: the report is lost\n");
  if (!freopen("/dev/null", "w", stdout)) (void)fclose(stdout); /* PETSc flushes it when it ends, and would complain */
  return PETSC_TRUE;
}
