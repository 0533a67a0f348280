/*
   Cubic B-splines, centred on the nodes. With the distance d from the node, in cells,

     abs(d) < 1            2/3 - d^2 + abs(d)^3 / 2
     abs(d) < 2            (2 - abs(d))^3 / 6

   Source: Steffen, Kirby and Berzins 2008.
*/
#define NODES 4
#include "scheme/basis/nodes.h"

static inline PetscInt First(PetscReal xi)
{
  (void)xi;
  return -1;
}

static inline void Values(PetscReal xi, PetscReal half_width, PetscReal phi[NODES])
{
  const PetscReal eta = 1 - xi;

  (void)half_width;
  phi[0] = eta * eta * eta / 6;
  phi[1] = 2.0 / 3 - xi * xi + xi * xi * xi / 2;
  phi[2] = 2.0 / 3 - eta * eta + eta * eta * eta / 2;
  phi[3] = xi * xi * xi / 6;
}

static inline void Slopes(PetscReal xi, PetscReal half_width, PetscReal slope[NODES])
{
  const PetscReal eta = 1 - xi;

  (void)half_width;
  slope[0] = -eta * eta / 2;
  slope[1] = -2 * xi + 1.5 * xi * xi;
  slope[2] = 2 * eta - 1.5 * eta * eta;
  slope[3] = xi * xi / 2;
}

const MpmBasis MpmCubic = {.name        = "cubic",
                           .summary     = "cubic B-splines, their middles on the nodes",
                           .reference   = "Steffen, Kirby and Berzins 2008",
                           .reach_left  = 1,
                           .reach_right = 2,
                           .slope_sum   = 2,
                           KERNELS};
