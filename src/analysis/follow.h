/*
   Amplification factors followed along a line of Courant numbers or of phases, so that no window of growth is missed.
*/
#pragma once
#include <mpmstab/compat.h>
#include <complex.h>

/*
   Sets the n amplification factors of a period at a place x of the line, in any order. They are infinite where they
   leave the range of doubles.
*/
typedef PetscErrorCode (*MpmFactorsAt)(void *context, PetscReal x, double complex value[]);

/*S
   MpmMeeting - a place x of the line where two amplification factors meet, or where they come nearest to each other.

   peak: the largest growth there, as the logarithm of the abs of an amplification factor per step. angle: the argument
   of the mean of the two.
S*/
typedef struct {
  PetscReal x, peak, angle;
} MpmMeeting;

typedef struct MpmSample_ MpmSample;

/*S
   MpmFollow - the amplification factors along a line, and what was found on it.

   n: their number; they are those of a period of so many steps. most: the logarithm of the largest abs over a period
   that does not count as growth. meetings: those of the last line whose peak is at least MPM_MEETING_FLOOR of the
   tolerance. doubtful: the least place, of all lines so far, where amplification factors could not be told apart at the
   least step; infinite for none. evaluations: the number of places computed so far. allowed: a line ends early when
   there are more than so many; it may be set before the line.
S*/
typedef struct {
  PetscInt        n, period, nmeetings, room;
  PetscInt64      evaluations, allowed;
  PetscReal       tolerance, most, peak, hit, doubtful;
  MpmFactorsAt    at;
  void           *context;
  MpmMeeting     *meetings;
  MpmSample      *samples;
  double complex *beside;
  PetscInt       *match;
  PetscReal      *cost;
} MpmFollow;

#define MPM_MEETING_FLOOR 0.03

/* Not collective. at computes the amplification factors, and context is passed to it. */
PetscErrorCode MpmFollowCreate(PetscInt n, PetscInt period, PetscReal tolerance, MpmFactorsAt at, void *context,
                               MpmFollow *follow);
PetscErrorCode MpmFollowDestroy(MpmFollow *follow);

/*
   MpmFollowLine - finds the first place of [from, to] where growth per step exceeds 1 + tolerance.

   Not collective. from must be positive. bracket: growth is within tolerance at bracket[0] and beyond it at bracket[1],
   which is next to it. bracket[1] is infinite when growth is nowhere beyond, and bracket[0] is then to, or less where
   the line ended early; bracket[0] is 0 when it is beyond already at from. follow->peak becomes the largest growth on
   the line, as in MpmMeeting.

   Each step predicts the amplification factors from their derivatives. The step is halved until each of them is where
   it was predicted, so that none is mistaken for another. Growth can begin only where two come near each other between
   two places, or where one alone rises beyond 1; there the line is examined between the places. With l1 and l2 the two
   that meet, their mean and (l1 - l2)^2 / 4 are smooth functions of x even where l1 and l2 are not, so that few places
   show how large abs becomes. Source: docs/theory.md, section 4.
*/
PetscErrorCode MpmFollowLine(MpmFollow *follow, PetscReal from, PetscReal to, PetscReal bracket[2]);

/*
   MpmFollowFirst - the same, and where growth is beyond at from already, the first place from start on; where it is
   beyond there too, smaller places are tried by halving (MpmSearchFirst).

   Not collective.
*/
PetscErrorCode MpmFollowFirst(MpmFollow *follow, PetscReal start, PetscReal from, PetscReal to, PetscReal bracket[2]);

/* Not collective. Growth per step at a place; context is the MpmFollow. */
PetscErrorCode MpmFollowGrowth(void *context, PetscReal x, PetscReal *growth);
