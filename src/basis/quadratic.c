/*
   Quadratic B-splines with their middle on the nodes: d in cells from the node,

     abs(d) < 1/2          3/4 - d^2
     abs(d) < 3/2          (3/2 - abs(d))^2 / 2

   Source: Steffen, Kirby and Berzins 2008.
*/
#include "four_nodes.h"
#include <math.h>

static inline void Values(PetscReal xi, PetscReal width, PetscReal phi[4])
{
  (void)width;
  for (int d = 0; d < 4; d++) {
    const PetscReal x = fabs(xi + 1 - d);

    phi[d] = x < 0.5 ? 0.75 - x * x : 0.5 * PetscSqr(PetscMax(1.5 - x, 0));
  }
}

static inline void Slopes(PetscReal xi, PetscReal width, PetscReal slope[4])
{
  (void)width;
  for (int d = 0; d < 4; d++) {
    const PetscReal x = fabs(xi + 1 - d);

    slope[d] = copysign(x < 0.5 ? 2 * x : PetscMax(1.5 - x, 0), d - 1 - xi);
  }
}

const MpmBasis MpmQuadratic = {.name      = "quadratic",
                               .summary   = "quadratic B-splines, their middles on the nodes",
                               .reference = "Steffen, Kirby and Berzins 2008",
                               .slope_sum = 2,
                               FOUR_NODES};
