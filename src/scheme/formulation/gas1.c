/*
   Formulation 1 of the slides: one-dimensional gas flow. Both updates use the old nodal fields.

     u_t = c r_x, r_t = c u_x    with r = -(a/rho0) rho and c = a

   With this r both updates carry a plus sign.

   Source: Berzins, Kirby and Gritton 2013, 'The Algorithms', Formulation 1; after Brackbill 1988.
*/
#include <mpmstab/formulation.h>
#include <math.h>

enum { U, R };     /* particles */
enum { U_I, R_I }; /* nodes     */

static const MpmOp ops[] = {
    FILTER_BEFORE(U, U_I), /*    the filter with            */
    FILTER_BEFORE(R, R_I), /*    pic_filter before          */
    P2G(U_I, U),           /* 1. u_i  = sum_p S_ip u_p      */
    IMPOSE(U_I),           /*    a wall reflects            */
    P2G(R_I, R),           /* 2. r_i  = sum_p S_ip r_p      */
    GRAD(U, R_I, COURANT), /* 3. u_p += k (r_{i+1} - r_i)   */
    GRAD(R, U_I, COURANT), /* 4. r_p += k (u_{i+1} - u_i)   */
    FILTER_AFTER(U, U_I),  /*    the transfer's filter      */
    FILTER_AFTER(R, R_I),  /*    (flip: none)               */
    DRIFT,                 /* 5. x_p += U0 dt               */
};

static const MpmEnergyTerm energy[] = {{MPM_ON_PARTICLES, U, PETSC_FALSE}, {MPM_ON_PARTICLES, R, PETSC_FALSE}};

/* The slides: G = 1 +- gamma, gamma = 2 i k sin(beta). */
static PetscReal Published(PetscReal k, PetscReal beta)
{
  return hypot(1, 2 * k * sin(beta));
}

/*
   By C1 + C2 = 1 the stencil has half of the slides' width:

     G = f (1 +- k mu),    for the hat mu = e (1 - cos beta) + i sin beta
*/
static PetscReal Corrected(const MpmCellSymbols *cell, PetscReal k)
{
  return cell->filter * fmax(cabs(1 + k * cell->mu), cabs(1 - k * cell->mu));
}

/* The limit is the k of (1 + 2 k abs(Re mu) + k^2 abs(mu)^2) f^2 = 1. */
static PetscReal Limit(const MpmCellSymbols *cell)
{
  const PetscReal re = fabs(creal(cell->mu)), size = cabs(cell->mu), room = 1 / PetscSqr(cell->filter) - 1;

  if (size < 1e-13 || cell->filter == 0) return INFINITY; /* mu is 0 up to rounding */
  return room / (re + sqrt(re * re + size * size * room));
}

const MpmFormulation MpmGas1 = {.name              = "gas1",
                                .summary           = "gas, Formulation 1: velocity and density from old nodal values",
                                .reference         = "Berzins, Kirby and Gritton 2013; Brackbill 1988",
                                .particle_fields   = {"u", "r"},
                                .particle_ranks    = {MPM_VECTOR, MPM_SCALAR},
                                .node_fields       = {"u_i", "r_i"},
                                .node_ranks        = {MPM_VECTOR, MPM_SCALAR},
                                .nops              = PETSC_STATIC_ARRAY_LENGTH(ops),
                                .ops               = ops,
                                .staggered         = MPM_NONE,
                                .affine            = MPM_NONE,
                                .conserved         = MPM_NONE,
                                .nenergy           = PETSC_STATIC_ARRAY_LENGTH(energy),
                                .energy            = energy,
                                .wave              = &MpmWaveFirstOrder,
                                .published_limit   = 0,
                                .published_text    = "abs(G)^2 = 1 + 4 k^2 sin^2 beta",
                                .published_slip    = "with C1 + C2 = 1 the stencil of P2G GRAD is half as "
                                                     "wide as the slides print it: gamma = i k sin beta",
                                .published_centred = PETSC_TRUE,
                                .corrected_text    = "G = f (1 +- k mu)",
                                .limit_text        = "f^2 (1 + 2 k abs(Re mu) + k^2 abs(mu)^2) <= 1; for flip none",
                                .published         = Published,
                                .corrected         = Corrected,
                                .limit             = Limit};
