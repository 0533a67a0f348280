/*
   Pace: a run that chooses its steps. Each is a part of a step that is stable for the particles as they stand:

     dt = safety K h / max_p c_p

   c_p is the speed of P waves at the stretch of particle p. K c / max_p c_p is a bound of the largest stable step
   (mpmstab/step_bound.h), with the moduli of now: lone or particle at each step; or a certificate by lanczos, which a
   watch by particle follows. With k_0, P_0 and c_0 the certificate, bound particle and the fastest waves when it was
   made,

     K = max(P c, k_0 min(c_0, c P / P_0))

   where P is looked at anew when particles have moved so far that it may have changed. Formulations without a bound
   have the K of the linear scheme with particles at rest in a uniform layout or, where there is a free surface, that of
   a lone particle, or of a half-space where a lone particle has no limit. Steps are rounded down to a power of
   2^(1/MPM_PACE_LEVELS) times the first one, since each change of the step costs a sum over the grid. Source of the
   distances: docs/theory.md, section 10.
*/
#pragma once
#include "march/march_private.h"
#include <mpmstab/critical.h>
#include <mpmstab/step_bound.h>
#include "scene/request.h"

#define MPM_PACE_LEVELS 16
#define MPM_PACE_FACTORS 5
extern const PetscReal MpmPaceFactors[MPM_PACE_FACTORS]; /* of steps that would be so many times as long */

/*E
   MpmPaceReason - what a step is bounded by: MPM_PACE_WAVES the fastest waves; MPM_PACE_MOTION the fastest particle,
   which may not go a cell or further in a step; MPM_PACE_END the end of the run, which the last two steps fill.
E*/
typedef enum { MPM_PACE_WAVES, MPM_PACE_MOTION, MPM_PACE_END, MPM_PACE_REASONS } MpmPaceReason;
extern const char *const MpmPaceReasonNames[];

/*S
   MpmPaceHeld - what the next step depends on besides the state; reals alone, which a checkpoint has in this order.

   limit, first    - K, and that of the first step
   certified, particle, fastest - k_0, P_0 and c_0; 0: there is no certificate
   artificial      - the largest artificial viscosity in the step before
   form            - what the loss by damping and viscosity depends on (MpmStepBounds): of the certificate, or of the
                     last look; falls: by how much bound particle has fallen since that certificate, or 1
   way, seen       - cells that the fastest particle has moved, at most, since the certificate and since the last look
                     at P
   waves           - the fastest waves at that look
   certificates, looks - how many there were
   id, place, number, step - the particle that decided P at the smallest step, its place in cells, P, and that step;
                     step 0: none. Of a run that is watched: at the step above which the bound stood least
   steps, under    - the steps that were compared with the bound, and those that would stand under it if they were
                     longer by a factor
   above, share    - the first step above the bound, 0: none; and the least bound over its step
S*/
typedef struct {
  PetscReal limit, first, certified, particle, fastest, way, seen, waves, certificates, looks, id, place[MPM_MAX_DIM],
      number, step, steps, under[MPM_PACE_FACTORS], above, share, artificial, form[2], falls;
} MpmPaceHeld;
#define MPM_PACE_HELD ((PetscInt)(sizeof(MpmPaceHeld) / sizeof(PetscReal)))

/*S
   MpmPace - how a run has chosen its steps.

   held            - see there
   why_not, where  - why no bound is known, and where particles are whose K is taken then; NULL: a bound is known
   at              - the particle that decided P at the last look
   by              - the bound that gave K then; number: that of P, or of bound lone
   chance          - of a certificate
   moduli          - of this rank's particles
   end             - the time of the end in units of h / c; infinite: the run ends after its steps
   expected        - the number of steps, about
   fastest, motion - the largest speeds of waves and of particles at the last step, over c
   reason          - of the last step
   least, largest, sum - of the Courant numbers of steps; those that the end of the run shortens do not count
   changes         - how often the step has changed
   taken[reason]   - the number of steps for each reason
   told            - the step that was printed last
S*/
typedef struct {
  MpmPaceHeld   held;
  const char   *why_not;
  MpmStepBound  by;
  MpmDecider    at;
  PetscReal    *moduli, number, chance, end, expected, fastest, motion, least, largest, sum, told;
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
   MpmPaceCreate - begins. Without a bound it finds K for the scene.
   MpmPaceBegin  - finds the first bound of a march, unless a checkpoint had one, and so the number of steps
   MpmPaceWatch  - compares the next step of a march, which it leaves as it is, with the bound

   Collective.

   Errors: refuse (PETSC_ERR_USER_INPUT) a scheme that has no stable step, and one whose limit is not known.
*/
PetscErrorCode MpmPaceCreate(const MpmScene *scene, const MpmRequest *request, MpmPace **pace);
PetscErrorCode MpmPaceBegin(MpmPace *pace, MpmMarch *march, const MpmRequest *request);
PetscErrorCode MpmPaceWatch(MpmPace *pace, MpmMarch *march);
PetscErrorCode MpmPaceDestroy(MpmPace **pace);

/*
   MpmPaceSpeeds - the largest speeds of waves and of particles along an axis, over c. moduli: the squares of the speeds
   of waves at this rank's particles, for PetscFree; what it held before is freed.

   Collective.
*/
PetscErrorCode MpmPaceSpeeds(const MpmMarch *march, PetscReal **moduli, PetscReal speed[2]);

/* Not collective. What gave K at the last look: a bound or, without one, where particles are. */
const char *MpmPaceLimitName(const MpmPace *pace);

/* Not collective. Whether a march is at the end of the run. */
PetscBool MpmPaceIsOver(const MpmPace *pace, const MpmMarch *march);

/* Collective. Notes after a step what the next one depends on besides the state. */
PetscErrorCode MpmPaceTook(MpmPace *pace, const MpmMarch *march);

/*
   MpmPaceStep - chooses the next step of a march and sets its Courant number. last: it becomes the number of the next
   step if that one ends the run.
   MpmPaceTell - prints the next step, and why it is so large, if it differs much from the one printed before.

   Collective.
*/
PetscErrorCode MpmPaceStep(MpmPace *pace, MpmMarch *march, PetscInt64 *last);
PetscErrorCode MpmPaceTell(MpmPace *pace, const MpmMarch *march);
