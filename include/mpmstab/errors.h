/* Refusal of bad input: one message, from one rank, and all ranks end. */
#pragma once
#include <mpmstab/compat.h>

/* Exit status of the program. MPM_EXIT_STOPPED is what shells report for a program that SIGTERM has ended. */
enum { MPM_EXIT_DONE = 0, MPM_EXIT_FAILED = 1, MPM_EXIT_REFUSED = 2, MPM_EXIT_MISSED = 3, MPM_EXIT_STOPPED = 143 };

/*MC
   MpmRefuse - ends the task because of what the user gave: an option, a scene or a file.

   Collective: every rank has the same input and refuses it alike; the first rank prints.

   Input Parameters: a printf format and its arguments. The message names the option or file, the value
   and what is allowed.
M*/
#define MpmRefuse(...) SETERRQ(PETSC_COMM_WORLD, PETSC_ERR_USER_INPUT, __VA_ARGS__)

/* Refuses unless the condition holds. */
#define MpmCheckInput(condition, ...)                                                                                  \
  do {                                                                                                                 \
    if (PetscUnlikely(!(condition))) MpmRefuse(__VA_ARGS__);                                                           \
  } while (0)

/*
   Not collective. Installs the handler for what happens while PETSc starts and ends: nothing of ours is at work then,
   so
   that it is one of PETSc's own options which cannot be, such as -options_file with a file that is not there.
*/
PetscErrorCode MpmErrorsOutside(void);

/*
   MpmPrint - prints on standard output, from the first rank; a printf format and its arguments.

   Not collective. Whether it has arrived is asked once, at the end: newer PETSc would end the program in a
   stack trace where the disk is full.
*/
void MpmPrint(const char format[], ...) __attribute__((format(printf, 1, 2)));

/* Not collective. Whether what was printed has not arrived, and says so; a reader that has gone is no loss. */
PetscBool MpmErrorsReportLost(void);

/* Installs the handler that prints a refusal as one line and any other error as PETSc's stack trace. */
PetscErrorCode MpmErrorsInstall(void);

/*
   Not collective. From here on ("": no more) an error of HDF5 is this file's, which cannot be written: it is said as a
   refusal by one rank, and the program ends at once on all, since a collective operation half done has no other end.
*/
void MpmErrorsBlame(const char file[]);
