/* Amplification factors followed along a line of Courant numbers or of phases, so that no window of growth is missed. */
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>

/* Sets the n factors of a period at a place x of the line, in any order; infinite where they leave the range. */
typedef PetscErrorCode (*MpmFactorsAt)(void *context, PetscReal x, double complex value[]);

/*S
   MpmMeeting - a place x of the line where two factors meet, or where they come nearest to each other.

   peak: the largest growth there, as the logarithm of the abs of a factor per step. angle: the argument of their mean.
S*/
typedef struct {
  PetscReal x, peak, angle;
} MpmMeeting;

typedef struct MpmSample_ MpmSample;

/*S
   MpmFollow - the factors of a line and what was found on it.

   n factors, of a period of so many steps. most: the logarithm of the largest abs over a period that counts as no
   growth. meetings: those of the last line whose peak is at least MPM_MEETING_FLOOR of the tolerance. doubtful: the least
   place, of all lines so far, where factors could not be told apart at the least step; infinite for none. evaluations:
   places looked at so far; a line ends early where they are more than allowed, which may be set before it.
S*/
typedef struct {
  PetscInt        n, period, nmeetings, room;
  PetscInt64      evaluations, allowed;
  PetscReal       most, peak, hit, doubtful;
  MpmFactorsAt    at;
  void           *context;
  MpmMeeting     *meetings;
  MpmSample      *samples;
  double complex *beside;
  PetscInt       *match;
  PetscReal      *cost;
} MpmFollow;

#define MPM_MEETING_FLOOR 0.03

/* Not collective. */
PetscErrorCode MpmFollowCreate(PetscInt n, PetscInt period, PetscReal tolerance, MpmFactorsAt at, void *context,
                               MpmFollow *follow);
PetscErrorCode MpmFollowDestroy(MpmFollow *follow);

/*
   MpmFollowLine - the first place of [from, to] where growth per step is beyond 1 + tolerance.

   Not collective. bracket: growth is within tolerance at bracket[0], beyond it at bracket[1], which is next to it;
   infinite when nowhere, bracket[0] = 0 when growth is beyond already at from. When bracket[1] is infinite, bracket[0] is
   to, or less where the line ended early. x must be positive. peak becomes the largest growth met on the line, as in
   MpmMeeting.

   Each step predicts the factors from their derivatives and is halved until every factor is where it was predicted, so
   that none is taken for another. Where two come near each other between two places, and where one alone might rise
   beyond 1, the line is looked at between them. Growth can begin nowhere else. With l1 and l2 the two that meet, their
   mean and (l1 - l2)^2 / 4 are smooth functions of x also where l1 and l2 are not, and few places show how large abs
   becomes. Source: THEORY.md, section 4.
*/
PetscErrorCode MpmFollowLine(MpmFollow *follow, PetscReal from, PetscReal to, PetscReal bracket[2]);
