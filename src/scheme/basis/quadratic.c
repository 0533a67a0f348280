/*
   Quadratic B-splines, centred on the nodes. With the distance d from the node, in cells,

     abs(d) < 1/2          3/4 - d^2
     abs(d) < 3/2          (3/2 - abs(d))^2 / 2

   A particle has weights at its nearest node, which is its cell's left or right one, and at that node's neighbours.

   Source: Steffen, Kirby and Berzins 2008.
*/
#define NODES 3
#include "scheme/basis/nodes.h"
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

static inline void Curves(PetscReal xi, PetscReal curve[NODES])
{
  (void)xi;
  QuadraticCurves(curve);
}

const MpmBasis MpmQuadratic = {.name        = "quadratic",
                               .summary     = "quadratic B-splines, their middles on the nodes",
                               .reference   = "Steffen, Kirby and Berzins 2008",
                               .reach_left  = 1,
                               .reach_right = 2,
                               .slope_sum   = 2,
                               .curve_sum   = 8,
                               .moment      = 1.0 / 4,
                               KERNELS};
