/* Cubic B-splines with modified ends. */
#define NODES 4
#include "scheme/basis/modified.h"
#include "scheme/basis/splines.h"

const MpmBasis MpmCubicModified = {.name        = "cubic",
                                   .summary     = "cubic B-splines, modified next to walls",
                                   .reference   = "Steffen, Kirby and Berzins 2008",
                                   .reach_left  = 1,
                                   .reach_right = 2,
                                   .wall_nodes  = 1,
                                   .spline_ends = MPM_SPLINES_MODIFIED,
                                   .slope_sum   = 2,
                                   KERNELS};
