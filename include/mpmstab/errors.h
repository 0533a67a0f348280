/* How a program that uses mpmstab begins and ends, how bad input is refused, and how the program prints. */
#pragma once
#include <mpmstab/compat.h>

/*E
   Exit status of a program.

   MPM_EXIT_DONE    - the work is done
   MPM_EXIT_FAILED  - an error that is not the user's: of this library, PETSc, MPI, or a report that could not be
                      printed
   MPM_EXIT_REFUSED - bad input: an option, a scene or a file
   MPM_EXIT_MISSED  - the work is done, but something came out that is not what the scene expects
   MPM_EXIT_STOPPED - a signal ended the work early; shells report this number for a program that SIGTERM has ended
E*/
enum { MPM_EXIT_DONE = 0, MPM_EXIT_FAILED = 1, MPM_EXIT_REFUSED = 2, MPM_EXIT_MISSED = 3, MPM_EXIT_STOPPED = 143 };

/*@C
   MpmInitialize - starts MPI, PETSc and SLEPc, and installs the handler of errors that MpmErrorsInstall describes.

   Collective: all processes call it, before any other function of this library.

   Input Parameters:
+  argc - number of words on the command line
-  argv - the words; PETSc takes its options from them

   Without mpirun or srun, Open MPI is told that there is one process, so that it starts faster (environment variables
   that are set already stay as they are).

   Errors: not 0 when PETSc refuses one of its own options, such as -options_file with a file that does not exist. The
   message is printed; the program can only end, with MPM_EXIT_REFUSED.

   Note: a program that has called PetscInitialize by itself calls SlepcInitialize and MpmErrorsInstall instead.
@*/
PetscErrorCode MpmInitialize(int *argc, char ***argv);

/*@C
   MpmFinalize - ends what MpmInitialize has started, and returns the exit status of the program.

   Collective: all processes call it, as the last function of this library.

   Input Parameters:
+  error  - what the work of the program has returned. PETSC_ERR_USER_INPUT says that input was refused. Another error
            is not one of input; MPI_Abort then ends all processes with MPM_EXIT_FAILED.
-  status - the exit status if there was no error

   Returns: status; or MPM_EXIT_REFUSED after refused input, or when PETSc finds fault with an option at its end; or
   MPM_EXIT_FAILED when standard output has not taken all that was printed.

   Files that were being written when an error occurred are removed.
@*/
int MpmFinalize(PetscErrorCode error, int status);

/*MC
   MpmRefuse - returns from the calling function with PETSC_ERR_USER_INPUT, because of what the user gave: an option, a
   scene or a file.

   Collective: every process has the same input and refuses it alike. With the handler of MpmErrorsInstall, the first
   process prints the message, as one line.

   Input Parameters: a printf format and its arguments. The message names the option or file, the value and what is
   allowed; it is printed at its whole length.
M*/
#define MpmRefuse(...) return MpmRefusal(__VA_ARGS__)

/*
   Collective. Refuses as MpmRefuse does, and gives the error to a function that has to free something before it
   returns.
*/
#define MpmRefusal(...) (MpmErrorsRefuse(__LINE__, PETSC_FUNCTION_NAME, __FILE__, __VA_ARGS__), PETSC_ERR_USER_INPUT)
void MpmErrorsRefuse(int line, const char function[], const char file[], const char format[], ...)
    __attribute__((format(printf, 4, 5)));

/* Collective. Calls MpmRefuse with the rest of the arguments, unless the condition holds. */
#define MpmCheckInput(condition, ...)                                                                                  \
  do {                                                                                                                 \
    if (PetscUnlikely(!(condition))) MpmRefuse(__VA_ARGS__);                                                           \
  } while (0)

/*@C
   MpmErrorsInstall - installs an error handler of PETSc. It prints a refusal of input as one line on standard error,
   from the first process, and any other error as PETSc does, with its stack trace.

   Not collective. MpmInitialize calls it. PetscPopErrorHandler removes the handler.
@*/
PetscErrorCode MpmErrorsInstall(void);

/*@C
   MpmPrintFailure - prints a message of this program on standard error, as one line, from the first process.

   Not collective.

   Input Parameter: message - what ended the work, which is neither bad input nor an error of the program
@*/
void MpmPrintFailure(const char message[]);

/*@C
   MpmPrint - prints on standard output, from the first process.

   Not collective.

   Input Parameters: a printf format and its arguments.

   It returns no error: MpmFinalize asks once whether all output has arrived.
@*/
void MpmPrint(const char format[], ...) __attribute__((format(printf, 1, 2)));

/* The rank of this process in a communicator, and how many ranks there are. Not collective. */
static inline PetscMPIInt MpmRankOf(MPI_Comm comm)
{
  PetscMPIInt rank = 0;

  (void)MPI_Comm_rank(comm, &rank);
  return rank;
}

static inline PetscMPIInt MpmRanksOf(MPI_Comm comm)
{
  PetscMPIInt ranks = 1;

  (void)MPI_Comm_size(comm, &ranks);
  return ranks;
}
