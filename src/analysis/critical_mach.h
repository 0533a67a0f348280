/* Critical at a Mach number: growth at Courant numbers k whose drift M k is a fraction with a small denominator. */
#pragma once
#include "analysis/waves.h"
#include "scene/mach.h"
#include <mpmstab/critical.h>

/* A Courant number that was searched: k unit is the fraction part, and growth that of refined phases. */
typedef struct {
  MpmFraction part;
  PetscReal   courant, growth, beta[MPM_MAX_DIM];
  PetscInt    verdict; /* an MpmVerdict */
} MpmMachPoint;

/*S
   MpmCriticalMach - what was searched, and what was found.

   points, n  - the Courant numbers, from the smallest on
   steps      - so many equal steps of the Courant number up to to, of each of which the nearest fraction with a
                denominator up to MPM_CRITICAL_MACH_STEPS is among them (see MpmMachNearest); so are all fractions with
                denominators up to MPM_CRITICAL_MACH_ALL
   to, rest   - the largest Courant number, and the limit of particles at rest, as courant of MpmCritical
   stable     - the number of points up to the first that is not stable; n: all are
   unstable, undecided - the number of such points
   worst      - the point that grows fastest of those up to rest
   asked      - growth and verdict at the scene's own Courant number
   theorem    - quiet, no_theorem and cure of MpmCritical, of the layouts that the scene's own drift meets
S*/
#define MPM_CRITICAL_MACH_STEPS 60
#define MPM_CRITICAL_MACH_ALL 16
typedef struct {
  MpmMachPoint *points;
  PetscInt      n, steps, stable, unstable, undecided, worst;
  PetscReal     to, rest, seconds;
  MpmFinding    asked;
  MpmCritical   theorem;
} MpmCriticalMach;

/*
   MpmCriticalMachCreate - computes growth at each of the Courant numbers. The drift of the case's step is that at its
   own Courant number.

   Collective on PETSC_COMM_WORLD; a rank does a point alone, so that the result does not depend on their number.

   Growth under drift is not monotone. Between the fractions nothing is computed.

   Errors: refuses (PETSC_ERR_USER_INPUT) layouts without a symbol.
*/
PetscErrorCode MpmCriticalMachCreate(const MpmCriticalCase *of, const MpmMach *mach, MpmCriticalMach *found);
PetscErrorCode MpmCriticalMachDestroy(MpmCriticalMach *found);
