/* Stability map: growth over a rectangle of two parameters, through the symbol. */
#pragma once
#include "scene/request.h"

/*S
   MpmStabilityMap - the result of the task map: growth at points[0] x points[1] points, the second axis running
   fastest.

   at[a]: the numbers along axis a, points[a] of them. growth (per step, the largest over the phases), beta (the least
   phase that has it) and verdict are of each point, on every rank. unstable, undecided: how many points are. worst: the
   point that grows fastest. finding: unstable when any point is, stable when all are.

   published_limit: where one axis is the Courant number, the one up to which the slides say that particles at rest are
   stable, whatever their places (NaN: they do not treat the scene). limits: NULL until MpmStabilityMapLimits.
S*/
typedef struct {
  const MpmScene   *scene;
  const MpmRequest *request;
  PetscInt          points[2], unstable, undecided, worst;
  PetscReal        *at[2], *growth, *beta, *limits, published_limit, seconds;
  PetscInt         *verdict; /* MpmVerdict */
  MpmFinding        finding;
} MpmStabilityMap;

/*
   MpmStabilityMapCreate - the symbol at each point of the request's axes; the scene's other parameters stay as they are.

   Collective on PETSC_COMM_WORLD. Points are dealt to ranks in turn and each is one rank's, so that nothing depends on
   the number of ranks. Refuses what has no symbol, drifts without a short period, and more points than can be counted.
   Method: THEORY.md, section 3.
*/
PetscErrorCode MpmStabilityMapCreate(const MpmScene *scene, const MpmRequest *request, MpmStabilityMap **map);
PetscErrorCode MpmStabilityMapDestroy(MpmStabilityMap **map);

/*
   Not collective. Where one axis is the Courant number, sets limits: for each number of the other axis the Courant
   number up to which the closed form says that particles at rest are stable (NaN: it does not cover them).
*/
PetscErrorCode MpmStabilityMapLimits(MpmStabilityMap *map);
