/* Options of PETSc that were given, and what is printed later. */
#pragma once
#include "base/text.h"
#include <mpmstab/errors.h>

/*
   MpmErrorsGivenOptions - adds the options of PETSc and SLEPc that the user has given, as '-name value' with blanks
                           between.

   Not collective.
*/
PetscErrorCode MpmErrorsGivenOptions(MpmText *given);

/*
   MpmPrintHold - keeps what is printed in memory until MpmPrintRelease prints it. What has not been released when the
   program ends is lost: a task that is refused has printed nothing. MpmPrintArguments - prints as MpmPrint does.

   Not collective.
*/
void MpmPrintHold(void);
void MpmPrintRelease(void);
void MpmPrintArguments(const char format[], va_list arguments) __attribute__((format(printf, 1, 0)));
