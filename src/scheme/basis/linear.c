/* The hat function, phi = 1 - abs(x - x_i) / h. Source: Sulsky, Chen and Schreyer 1994, the classical MPM. */
#define NODES 2
#define FITTED_WEIGHTS GradientWeights /* phi (x_i - x_p) h / D is -1 and 1; on a node it would be 0 / 0 */
#define NO_CURVES
#include "scheme/basis/nodes.h"

static inline PetscInt First(PetscReal xi)
{
  (void)xi;
  return 0;
}

static inline void Values(PetscReal xi, PetscReal phi[NODES])
{
  phi[0] = 1 - xi;
  phi[1] = xi;
}

static inline void Slopes(PetscReal xi, PetscReal slope[NODES])
{
  (void)xi;
  slope[0] = -1;
  slope[1] = 1;
}

const MpmBasis MpmLinear = {.name        = "linear",
                            .summary     = "hat functions, one cell to either side of a node",
                            .reference   = "Sulsky, Chen and Schreyer 1994",
                            .reach_left  = 0,
                            .reach_right = 1,
                            .slope_sum   = 2,
                            .hat         = PETSC_TRUE,
                            KERNELS};
