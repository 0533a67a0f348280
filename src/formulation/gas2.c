/*
   Formulation 2 of the slides: one-dimensional gas flow, the density update sees the new velocity.

     u_t = c r_x, r_t = c u_x    with r = -(a/rho0) rho, so that both updates carry a plus sign; c = a.

   Source: Berzins, Kirby and Gritton 2013, 'The Algorithms', Formulation 2; after Brackbill 1988.
*/
#include <mpmstab/formulation.h>
#include "quadratic.h"
#include <math.h>

enum { U, R };     /* particles */
enum { U_I, R_I }; /* nodes     */

static const MpmOp ops[] = {
    P2G(R_I, R),           /* 1. r_i  = sum_p S_ip r_p                        */
    GRAD(U, R_I, COURANT), /* 2. u_p += k (r_{i+1} - r_i)                     */
    P2G(U_I, U),           /* 3. u_i  = sum_p S_ip u_p    (the old weights)   */
    GRAD(R, U_I, COURANT), /* 4. r_p += k (u_{i+1} - u_i)                     */
    DRIFT,                 /* 5. x_p += U0 dt                                 */
};

static const MpmEnergyTerm energy[] = {{MPM_ON_PARTICLES, U}, {MPM_ON_PARTICLES, R}};

/* The slides print abs(G) for k <= 1/sqrt 2 only. */
static PetscReal Published(PetscReal k, PetscReal beta)
{
  return k <= M_SQRT1_2 ? sqrt(1 - 2 * PetscSqr(k * sin(beta))) : NAN;
}

/* (gamma^2 + 2)^2 - 4 = gamma^4 + 4 gamma^2, and the lost half restored: G^2 - (2 + k^2 mu^2) G + 1 = 0. */
static PetscReal Corrected(const MpmCellMoments *cell, PetscReal k, PetscReal beta)
{
  const double complex mu = cell->e * (1 - cos(beta)) + I * sin(beta);
  return MpmQuadraticRadius(2 + k * k * mu * mu, 1);
}

const MpmFormulation MpmGas2 = {.name              = "gas2",
                                .summary           = "gas, Formulation 2: density from the new nodal velocity",
                                .reference         = "Berzins, Kirby and Gritton 2013; Brackbill 1988",
                                .particle_fields   = {"u", "r"},
                                .node_fields       = {"u_i", "r_i"},
                                .nops              = PETSC_STATIC_ARRAY_LENGTH(ops),
                                .ops               = ops,
                                .staggered         = U,
                                .nenergy           = PETSC_STATIC_ARRAY_LENGTH(energy),
                                .energy            = energy,
                                .wave              = &MpmWaveFirstOrder,
                                .published_text    = "abs(G) = sqrt(1 - 2 k^2 sin^2 beta), k <= 1/sqrt 2",
                                .published_slip    = "(gamma^2 + 2)^2 - 4 is gamma^4 + 4 gamma^2, not + 2 gamma^2, "
                                                     "and gamma has lost the half of C1 = C2 = 1/2",
                                .published_centred = PETSC_TRUE,
                                .corrected_text = "G^2 - (2 + k^2 mu^2) G + 1 = 0, mu = e (1 - cos beta) + i sin beta",
                                .published      = Published,
                                .corrected      = Corrected};
