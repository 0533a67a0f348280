/* Quadratic B-splines with modified ends. */
#define NODES 3
#include "scheme/basis/modified.h"
#include "scheme/basis/splines.h"

static inline PetscInt First(PetscReal xi)
{
  return xi < 0.5 ? -1 : 0;
}

static inline void Values(PetscReal xi, PetscReal phi[NODES])
{
  QuadraticValues(xi < 0.5 ? xi : xi - 1, phi);
}

static inline void Slopes(PetscReal xi, PetscReal slope[NODES])
{
  QuadraticSlopes(xi < 0.5 ? xi : xi - 1, slope);
}

const MpmBasis MpmQuadraticModified = {.name        = "quadratic",
                                       .summary     = "quadratic B-splines, modified next to walls",
                                       .reference   = "Steffen, Kirby and Berzins 2008",
                                       .reach_left  = 1,
                                       .reach_right = 2,
                                       .wall_nodes  = 1,
                                       .spline_ends = MPM_SPLINES_MODIFIED,
                                       .slope_sum   = 2,
                                       KERNELS};
