/* What is installed beside the program, made from its list of options: a schema of scenes, completions, a man page. */
#pragma once
#include <mpmstab/errors.h>

/*
   MpmPrintSchema     - a JSON schema of scene files, for editors
   MpmPrintCompletion - for bash, or for zsh
   MpmPrintManual     - the man page, in the language of man(7)

   Collective: the first rank prints.
*/
PetscErrorCode MpmPrintSchema(void);
void           MpmPrintCompletion(PetscBool zsh);
void           MpmPrintManual(void);
