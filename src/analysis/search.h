/*
   The searches behind critical, map, the thresholds and the worst phases. A user gives a function, and takes from here

     largest over phases, least over places                                   MpmZoomLeast (zoom.h)
     first k with growth, where what grows goes on growing                    MpmSearchFirst
     first k with growth, where it may stop again                             MpmSearchScan
     first k with growth, by following amplification factors                  MpmFollowFirst (follow.h)
     whether there is a threshold, or growth fades with k                     MpmSearchThreshold
     least value in one variable                                              MpmSearchLeast
     least value in several, from a start                                     MpmSearchDescend

   Each function here is collective when the function is that it searches.
*/
#pragma once
#include <mpmstab/critical.h>

/* Computes growth per step at a Courant number. NaN, which is not known, counts as growth. */
typedef PetscErrorCode (*MpmSearchGrowth)(void *context, PetscReal courant, PetscReal *growth);

/*
   The Courant numbers of a search: from, then on by ratio but by no more than width, up to to. Where from grows already
   they are halved down to least, or with 0 down to 1e-24.
*/
typedef struct {
  PetscReal from, to, ratio, width, least;
} MpmSearchSteps;

/*
   MpmSearchFirst - the bracket [stable, unstable] in which growth first leaves 1 + tolerance. unstable is infinite when
   growth leaves it nowhere. stable is 0 when none is stable. The bracket is narrowed to a relative precision: unstable
   values show how growth begins and where, and values on both sides of that are looked at until they are next to one
   another.

   A window of instability that is narrower than a step may be missed.
*/
PetscErrorCode MpmSearchFirst(MpmSearchGrowth growth, void *context, PetscReal tolerance, const MpmSearchSteps *steps,
                              PetscReal precision, PetscReal bracket[2]);

/*
   MpmSearchScan - looks for the limit without taking for granted that what has become unstable stays so. Sets
   stable_at, unstable_at, threshold, fading and windows.

   It looks at Courant numbers from MPM_CRITICAL_FROM to MPM_CRITICAL_TO that grow by a quarter each, at 32 equal
   distances up to the limit, at 'also' where that is above 0, and where all grow at halves of the smallest. The limit
   is the end of the widest range without growth. A window between two of these numbers is missed.
*/
PetscErrorCode MpmSearchScan(MpmSearchGrowth growth, void *context, PetscReal tolerance, PetscReal also,
                             PetscReal precision, MpmCritical *critical);

/*
   MpmSearchThreshold - sets threshold and fading. from: the least Courant number of the range without growth, 0 where
   no window is below it. There is a threshold when growth in the middle of this range is none but for rounding, which
   is up to 1e-7 where eigenvalues 1 are defective, or when it is not, but growth is steep beyond unstable_at. Without a
   threshold fading is the power of the Courant number with which growth - 1 fades, and windows are part of it.
*/
PetscErrorCode MpmSearchThreshold(MpmSearchGrowth growth, void *context, PetscReal tolerance, PetscReal from,
                                  MpmCritical *critical);

/*
   MpmSearchLeast - the place in [lo, hi] of the least value of a function that has one minimum there, by golden
   section. steps: each makes the interval 0.62 times as long.
*/
#define MPM_SEARCH_GOLDEN 34 /* steps to 8e-8 of the interval; a minimum is flat on a smaller one */
typedef PetscErrorCode (*MpmSearchFunction)(void *context, PetscReal x, PetscReal *value);
PetscErrorCode MpmSearchLeast(MpmSearchFunction f, void *context, PetscInt steps, PetscReal lo, PetscReal hi,
                              PetscReal *x, PetscReal *value);

/*S
   MpmSearchDescent - f: computes what is made least, and moves variables back into their ranges. n: their number.
   together: a step changes so many of them at most. finest: the search ends with this step.
S*/
#define MPM_SEARCH_VARIABLES 6
typedef struct {
  PetscErrorCode (*f)(void *context, PetscReal u[], PetscReal *value);
  void     *context;
  PetscInt  n, together;
  PetscReal finest;
} MpmSearchDescent;

/*
   MpmSearchDescend - goes down from u by steps along all variables and diagonals, half as long where none goes down.
   value: that at u, before and after. The function need not be smooth.
*/
PetscErrorCode MpmSearchDescend(const MpmSearchDescent *descent, PetscReal step, PetscReal u[], PetscReal *value);

/*
   Not collective. Phase m of MPM_CRITICAL_PHASES in (0, pi]. They lie closer near 0 and pi, where instability may be
   confined to a narrow range of phases.
*/
PetscReal MpmSearchPhase(PetscReal m);
