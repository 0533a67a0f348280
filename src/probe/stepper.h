/*
   Stepper: one step of a code that is not ours, from outside. It takes the state of particles and gives the state after
   some steps. A child process stands behind it: a program, or the host of a shared library (a plugin). Both speak
   protocol 1.

   A step may fail on one rank alone. So MpmStepperStep returns no error for that; MpmStepperAgree tells all ranks.
*/
#pragma once
#include "base/child.h"
#include "base/progress.h"
#include "base/text.h"
#include <mpmstab/compat.h>
#include <mpmstab/fraction.h>
#include <mpmstab/layout.h>
#include <jansson.h>

#define MPM_STEPPER_NAME 64
#define MPM_STEPPER_FIELDS 64
#define MPM_STEPPER_PARAMETERS 64
#define MPM_STEPPER_WIDTH 4096   /* numbers that a particle may have */
#define MPM_STEPPER_FAILURE 8192 /* a message that names all parameters fits */

/*
   A field of a particle: size numbers, from number first of the particle's. scale: what a change of order 1 means; 0:
   it is not said, and not yet found. found: it was not said.
*/
typedef struct {
  char      name[MPM_STEPPER_NAME];
  PetscInt  size, first;
  PetscReal scale;
  PetscBool found;
} MpmStepperField;

typedef struct {
  char      name[MPM_STEPPER_NAME];
  PetscReal value, now;
} MpmStepperParameter;

/*S
   MpmStepper - a code and what it says of itself.

   where       - the option and its value, for messages; whose: 'the program' or 'the library'
   name        - of the code
   dim, cell_width, period - of its grid; a period of 0: none in that direction
   described   - the number of particles that the code has described, or of the scene that it was given since; 0: of
                 none
   particles   - the number in the base state; width: of the numbers of a particle, which the fields share
   place       - the number of the field that is the particle's place, or MPM_NONE
   cell        - instead of a place the cell of each particle, dim numbers each, or NULL
   parameters  - what can be set, with the values that the code came with and those that are set now
   steps       - the number of steps after which the state can be compared with the one before; changes: it was found,
                 since steps are not alike
   resets      - before a step the code can forget all that it keeps besides the state
   batch       - so many states may come in one request
   searched    - scales of fields have been looked for; unsettled: by so many powers of 2 they change when that is done
                 again, infinite: they were not found
   any_count   - a step may be asked for another number of particles
   scenes      - the code takes particles by place, volume and mass; has_periods: it has said its periods, which a scene
                 must have
   base        - the base state: particles x width numbers
   failure     - of this rank; empty: none
   calls, done - states that were stepped on this rank, and their steps; slowest: seconds that one took
   expected    - calls that progress says, counted from begun; 0: it says nothing. nested: work
                 that has begun it
   timeout     - seconds that an answer may take
   child       - the process that does the steps
S*/
typedef struct MpmStepper_ MpmStepper;
struct MpmStepper_ {
  const char         *whose;
  char                where[PETSC_MAX_PATH_LEN], name[MPM_STEPPER_NAME], failure[MPM_STEPPER_FAILURE];
  PetscInt            dim, nfields, width, place, nparameters, steps, batch, nested;
  PetscReal           cell_width, period[MPM_MAX_DIM], unsettled, slowest, timeout;
  PetscInt64          described, particles, calls, done, expected, begun;
  PetscBool           any_count, scenes, has_periods, searched, changes, resets;
  MpmStepperField     fields[MPM_STEPPER_FIELDS];
  MpmStepperParameter parameters[MPM_STEPPER_PARAMETERS];
  PetscInt           *cell;
  PetscReal          *base;
  MpmChild           *child;
  MpmProgress         progress;
};

/*
   MpmStepperStartProgram - starts a command that speaks protocol 1, and asks it to describe itself.
   MpmStepperStartPlugin  - starts a process that loads a shared library with the functions of <mpmstab/plugin.h>.

   Collective on PETSC_COMM_WORLD: each rank has a process of its own. timeout: seconds that an answer may take.

   Errors: PETSC_ERR_USER_INPUT with the reason, and the last lines of the child's standard error.
*/
PetscErrorCode MpmStepperStartProgram(const char command[], PetscReal timeout, MpmStepper **stepper);
PetscErrorCode MpmStepperStartPlugin(const char path[], PetscReal timeout, MpmStepper **stepper);

/*
   MpmStepperTakeScene - gives a code the place, volume and mass of particles, dim + 2 numbers each, and takes its base
   state. material: is freed; NULL: the code's. Collective.
*/
PetscErrorCode MpmStepperTakeScene(MpmStepper *stepper, PetscInt64 particles, const PetscReal given[],
                                   json_t *material);

/* Not collective. The place of a particle in the base state, dim numbers; NULL if no field is the place. */
const PetscReal *MpmStepperPlace(const MpmStepper *stepper, PetscInt64 particle);

/* Collective. Ends the child. */
PetscErrorCode MpmStepperDestroy(MpmStepper **stepper);

/*
   MpmStepperSet - gives a parameter a value. Collective; it agrees with MpmStepperAgree.

   Errors: PETSC_ERR_USER_INPUT when there is no such parameter, or the code does not take the value.
*/
PetscErrorCode MpmStepperSet(MpmStepper *stepper, const char name[], PetscReal value);

/* Not collective. The value that a parameter had at the start; *found says whether there is one. */
void MpmStepperParameterOf(const MpmStepper *stepper, const char name[], PetscReal *value, PetscBool *found);

/* Not collective. Adds what messages say of the parameters that a code names: their names, or that there are none. */
PetscErrorCode MpmStepperParameterNames(const MpmStepper *stepper, MpmText *names);

/*
   MpmStepperStep - replaces the state of particles by the one after some steps. A number that is not finite is a
   failure of the code. After a failure the state stays as it is. MpmStepperStepAll: several states, one after another
   in memory; the code gets as many at a time as it takes.

   MpmStepperExpect - begins a progress line of about so many calls from now on, unless there is one.
   MpmStepperForgetExpected ends it.

   Not collective. particles: stepper->particles, or another number if any_count.
*/
PetscErrorCode MpmStepperStep(MpmStepper *stepper, PetscInt steps, PetscInt64 particles, PetscReal state[]);
PetscErrorCode MpmStepperStepAll(MpmStepper *stepper, PetscInt steps, PetscInt64 particles, PetscInt count,
                                 PetscReal states[]);
PetscErrorCode MpmStepperExpect(MpmStepper *stepper, const char unit[], PetscInt64 calls);
PetscErrorCode MpmStepperForgetExpected(MpmStepper *stepper);

/* Collective. Refuses, with one message, if any rank's stepper has failed. */
PetscErrorCode MpmStepperAgree(MpmStepper *stepper);

/* Collective. Checks a base state that is new, and gives all ranks that of the first one. */
PetscErrorCode MpmStepperBegin(MpmStepper *stepper);
