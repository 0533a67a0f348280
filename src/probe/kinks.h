/* A base state on a switch: growth on both sides of it, or a state beside it. */
#pragma once
#include "probe/program.h"

/*S
   MpmKinks - what is found where the certificate 'one side' fails.

   particles - that show it; all: there are so many. few: they are so few that both sides of the base state are two operators
   growth    - of these two, NaN where they were not computed; field: NULL, or else a field which, changed by amount of its units at
               all particles, leaves the switch; growth[0] is then that of this state
S*/
typedef struct {
  PetscInt64  particles, all;
  PetscBool   few;
  PetscReal   growth[2], amount;
  const char *field;
} MpmKinks;

/*
   MpmKinksFind - looks at the states beside the base state: of few switches at a random one and its opposite, else at those with
   one field changed.

   Collective. The program must have its certificates; afterwards it must be forgotten.
*/
PetscErrorCode MpmKinksFind(MpmProgram *program, MpmKinks *kinks);
