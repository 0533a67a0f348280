/* Stability map: growth over a rectangle of two parameters, of a scene through the symbol or of a code by probing. */
#pragma once
#include "scene/request.h"
#include <mpmstab/scene.h>
#include <mpmstab/verdict.h>

typedef struct MpmProgram_ MpmProgram; /* probe/program.h */

/*S
   MpmStabilityMap - the result of the task map: growth at points[0] x points[1] points, stored with the second axis
   varying fastest. Either scene or program is NULL.

   waves: the number of directions in which growth is that of waves, with phases[a] phases in each; 0 of a code whose
   cells are not alike, where growth is the spectral radius of all particles. fault: of a code, for each point the first
   certificate that does not hold, MPM_CERTIFICATES if all hold; else NULL.

   at[a]: the points[a] numbers along axis a. growth (per step, the largest over the phases), beta (the least phase that
   has it, beta[a] in direction a) and verdict are those of each point, on every rank. drift[a]: where the map keeps a
   Mach number M, the drift of each point in direction a, which is M k rounded to a fraction (MpmMachNearest); else
   NULL. unstable, undecided: the number of such points. worst: the point that grows fastest. finding: unstable when any
   point is, stable when all are.

   published_limit: where one axis is the Courant number, the largest at which, according to the slides, particles at
   rest are stable wherever they are; NaN when the slides do not treat the scene. limits: NULL until
   MpmStabilityMapLimits.
S*/
typedef struct {
  const MpmScene   *scene;
  MpmProgram       *program;
  const MpmRequest *request;
  PetscInt          points[2], unstable, undecided, worst, waves, phases[MPM_MAX_DIM], *fault;
  PetscReal        *at[2], *growth, *beta[MPM_MAX_DIM], *drift[MPM_MAX_DIM], *limits, published_limit, seconds;
  PetscInt         *verdict; /* an MpmVerdict for each point */
  MpmFinding        finding;
} MpmStabilityMap;

/*
   MpmStabilityMapCreate - computes the symbol at each point of the request's axes; the scene's other parameters stay as
   they are.

   Collective on PETSC_COMM_WORLD. One rank computes each point (see farm.h), so that nothing depends on the number of
   ranks. Refuses scenes without a symbol, drifts without a short period, and too many points. Method: docs/theory.md,
   section 3.
*/
PetscErrorCode MpmStabilityMapCreate(const MpmScene *scene, const MpmRequest *request, MpmStabilityMap **map);
PetscErrorCode MpmStabilityMapDestroy(MpmStabilityMap **map);

/*
   MpmStabilityMapBegin, MpmStabilityMapSum - make an empty map of a request, whose scene or program, waves and phases
   are set after it; and count its points when all are known.

   Collective. Parts of making a map.
*/
PetscErrorCode MpmStabilityMapBegin(const MpmRequest *request, MpmStabilityMap **map);
PetscErrorCode MpmStabilityMapSum(MpmStabilityMap *map);

/* Not collective. The number of phases at each point, over all directions. */
PetscInt64 MpmStabilityMapPhases(const MpmStabilityMap *map);

/*
   MpmStabilityMapLimits - where one axis is the Courant number, sets limits. For each number of the other axis it is
   the Courant number up to which, according to the closed form, particles at rest are stable; NaN where no closed form
   covers them.

   Not collective.
*/
PetscErrorCode MpmStabilityMapLimits(MpmStabilityMap *map);
