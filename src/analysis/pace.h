/*
   Pace: a run that chooses its steps. Each is a part of the largest step that is stable where waves are as fast as at the
   fastest of all particles:

     dt = safety K h / max_p c_p

   c_p is the speed of P waves at the stretch of particle p, and K the largest stable Courant number of the linear scheme
   with particles at rest in a uniform layout. Where there is a free surface it is that of a lone particle, or of a
   half-space where a lone particle has no limit or none in closed form. Steps are rounded down to a power of 2^(1/MPM_PACE_LEVELS) times safety K h / c,
   since each change of the step costs a sum over the grid.
*/
#pragma once
#include "march/march_private.h"
#include "scene/request.h"

#define MPM_PACE_LEVELS 16

/*E
   MpmPaceReason - what a step is bounded by: MPM_PACE_WAVES the fastest waves; MPM_PACE_MOTION the fastest particle, which
   may not go a cell or further in a step; MPM_PACE_END the end of the run, which the last two steps fill.
E*/
typedef enum { MPM_PACE_WAVES, MPM_PACE_MOTION, MPM_PACE_END, MPM_PACE_REASONS } MpmPaceReason;
extern const char *const MpmPaceReasonNames[];

/*S
   MpmPace - how a run has chosen its steps.

   limit, where    - K, and where particles are that have it
   end             - the time of the end in units of h / c; infinite: the run ends after its steps
   expected        - the number of steps, about
   fastest, motion - the largest speeds of waves and of particles at the last step, over c
   reason          - of the last step
   least, largest  - Courant numbers of steps; those that the end of the run shortens do not count
   changes         - how often the step has changed
   taken[reason]   - the number of steps for each reason
   told            - the step that was printed last
S*/
typedef struct {
  PetscReal     limit, end, expected, fastest, motion, least, largest, told;
  MpmPaceReason reason;

  MpmNeighbourhoodKind where;

  PetscInt64 changes, taken[MPM_PACE_REASONS];
} MpmPace;

/* Not collective. Whether a step counts in least and largest. */
static inline PetscBool MpmPaceHasChosen(const MpmPace *pace)
{
  return pace->taken[MPM_PACE_WAVES] + pace->taken[MPM_PACE_MOTION] > 0 ? PETSC_TRUE : PETSC_FALSE;
}

/*
   MpmPaceCreate - finds K for a scene, and begins.

   Collective.

   Errors: refuses (PETSC_ERR_USER_INPUT) a scheme that has no stable step, and one whose limit is not known.
*/
PetscErrorCode MpmPaceCreate(const MpmScene *scene, const MpmRequest *request, MpmPace **pace);
PetscErrorCode MpmPaceDestroy(MpmPace **pace);

/* Not collective. Whether a march is at the end of the run. */
PetscBool MpmPaceIsOver(const MpmPace *pace, const MpmMarch *march);

/*
   MpmPaceStep - chooses the next step of a march and sets its Courant number. last: it becomes the number of the next step
   if that one ends the run.
   MpmPaceTell - prints the next step, and why it is so large, if it differs much from the one printed before.

   Collective.
*/
PetscErrorCode MpmPaceStep(MpmPace *pace, MpmMarch *march, PetscInt64 *last);
PetscErrorCode MpmPaceTell(MpmPace *pace, const MpmMarch *march);
