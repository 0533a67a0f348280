/*
   Cubic B-splines, centred on the nodes. With the distance d from the node, in cells,

     abs(d) < 1            2/3 - d^2 + abs(d)^3 / 2
     abs(d) < 2            (2 - abs(d))^3 / 6

   Source: Steffen, Kirby and Berzins 2008.
*/
#define NODES 4
#include "scheme/basis/nodes.h"
#include "scheme/basis/splines.h"

const MpmBasis MpmCubic = {.name        = "cubic",
                           .summary     = "cubic B-splines, their middles on the nodes",
                           .reference   = "Steffen, Kirby and Berzins 2008",
                           .reach_left  = 1,
                           .reach_right = 2,
                           .slope_sum   = 2,
                           .curve_sum   = 8,
                           .moment      = 1.0 / 3,
                           .smooth      = PETSC_TRUE,
                           KERNELS};
