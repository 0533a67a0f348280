/*
   uGIMP: the hat averaged over the particle's domain of width h / ppc. With the distance d from the node and half the
   particle's width l, both in cells,

     abs(d) < l            1 - (d^2 + l^2) / (2 l)
     l <= abs(d) < 1 - l   1 - abs(d)
     abs(d) < 1 + l        (1 + l - abs(d))^2 / (4 l)

   Source: Bardenhagen and Kober 2004, contiguous particles of constant width.
*/
#define NODES 4
#define WIDE
#include "scheme/basis/nodes.h"
#include <math.h>

static inline PetscInt First(PetscReal xi)
{
  (void)xi;
  return -1;
}

static inline void Values(PetscReal xi, PetscReal l, PetscReal phi[NODES])
{
  for (int d = 0; d < NODES; d++) {
    const PetscReal x = fabs(xi + 1 - d);

    phi[d] = x < l ? 1 - (x * x + l * l) / (2 * l) : x <= 1 - l ? 1 - x : PetscSqr(PetscMax(1 + l - x, 0)) / (4 * l);
  }
}

static inline void Slopes(PetscReal xi, PetscReal l, PetscReal slope[NODES])
{
  for (int d = 0; d < NODES; d++) {
    const PetscReal x = fabs(xi + 1 - d);
    const PetscReal s = x < l ? x / l : x <= 1 - l ? 1 : PetscMax(1 + l - x, 0) / (2 * l);

    slope[d] = copysign(s, d - 1 - xi);
  }
}

static inline void Curves(PetscReal xi, PetscReal l, PetscReal curve[NODES])
{
  for (int d = 0; d < NODES; d++) {
    const PetscReal x = fabs(xi + 1 - d);

    curve[d] = x < l ? -1 / l : x <= 1 - l ? 0 : x < 1 + l ? 1 / (2 * l) : 0;
  }
}

const MpmBasis MpmGimp = {.name        = "gimp",
                          .summary     = "hat averaged over a particle's width h / ppc (uGIMP)",
                          .reference   = "Bardenhagen and Kober 2004",
                          .reach_left  = 1,
                          .reach_right = 2,
                          .slope_sum   = 2,
                          .wide        = PETSC_TRUE,
                          KERNELS};
