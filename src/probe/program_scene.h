/* Scenes that an option names by keys, such as cells=8,ppc=2, and those that a code is asked to take. */
#pragma once
#include "base/text.h"
#include "probe/stepper.h"

/*
   MpmKeysSay - whether a text has one of some keys, as key=value at its beginning or after a comma. keys end with NULL.
   MpmKeysAdd - adds a line 'key: value' for each of them to a text in YAML. What follows a comma without a key belongs
                to the value before.

   Not collective. Errors: PETSC_ERR_USER_INPUT where the text of the option has no keys.
*/
PetscBool      MpmKeysSay(const char text[], const char *const keys[]);
PetscErrorCode MpmKeysAdd(const char option[], const char text[], MpmText *yaml);

/*
   MpmProgramTakeScene - gives a code the particles of a scene of ours: their places, volumes and masses, in its units.
   It answers with its base state. keys: of the option program_scene; what they leave open are CELLS cells each way, or
   the period of the code, and the defaults of scenes.

   Collective. Errors: PETSC_ERR_USER_INPUT where the code takes no scenes, the keys are none, or the scene does not fit
   its grid.
*/
PetscErrorCode MpmProgramTakeScene(const char keys[], MpmStepper *stepper);
