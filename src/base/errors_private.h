/* Handlers of errors: the parts that MpmInitialize, MpmFinalize and the files of a run use. */
#pragma once
#include "base/text.h"
#include <mpmstab/errors.h>

/*
   MpmErrorsOutside - installs the handler for errors that occur while PETSc starts and ends. This library does nothing
   then, so such an error means that one of PETSc's own options is wrong; the handler says so in one line.

   Not collective. Part of MpmInitialize, which calls it before PETSc starts.
*/
PetscErrorCode MpmErrorsOutside(void);

/*
   MpmErrorsReportLost - whether standard output has not taken all that was printed, as on a full disk; if so, says it in
   one line on standard error. A pipe whose reader has gone, as with '| head', is no loss.

   Not collective. Part of MpmFinalize.
*/
PetscBool MpmErrorsReportLost(void);

/*
   MpmErrorsGivenOptions - adds the options of PETSc and SLEPc that the user has given, as '-name value' with blanks between.

   Not collective.
*/
PetscErrorCode MpmErrorsGivenOptions(MpmText *given);

/*
   MpmErrorsStatus - the exit status for an error: MPM_EXIT_REFUSED for one that was told in one line.

   Not collective. Part of MpmFinalize.
*/
int MpmErrorsStatus(PetscErrorCode error);

/*
   MpmErrorsEnd - ends the program on all processes, also where this one alone has failed and others wait for it.

   Not collective. Part of MpmFinalize.
*/
void MpmErrorsEnd(int status);

/*
   MpmPrintHold - keeps what is printed in memory until MpmPrintRelease prints it. What has not been released when the
   program ends is lost: a task that is refused has printed nothing. MpmPrintArguments - prints as MpmPrint does.

   Not collective.
*/
void MpmPrintHold(void);
void MpmPrintRelease(void);
void MpmPrintArguments(const char format[], va_list arguments) __attribute__((format(printf, 1, 0)));
