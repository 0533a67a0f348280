/*
   The one-dimensional gas flow of the slides: gas1 is its Formulation 1, whose updates both use the old nodal fields, and
   gas2 its Formulation 2, whose density update uses the new velocity.

     u_t = c r_x, r_t = c u_x    with r = -(a/rho0) rho and c = a

   With this r both updates carry a plus sign.

   Source: Berzins, Kirby and Gritton 2013, 'The Algorithms', Formulations 1 and 2; after Brackbill 1988.
*/
#include "scheme/formulation/closed_forms.h"
#include <math.h>

#define ROUNDING 1e-13 /* rounding error of mu and of f */

enum { U, R };     /* particles */
enum { U_I, R_I }; /* nodes     */

static const MpmOp old_velocity[] = {
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

static const MpmOp new_velocity[] = {
    FILTER_BEFORE(U, U_I), /*    the filter with pic_filter before            */
    FILTER_BEFORE(R, R_I), /*    (flip: none)                                 */
    P2G(R_I, R),           /* 1. r_i  = sum_p S_ip r_p                        */
    GRAD(U, R_I, COURANT), /* 2. u_p += k (r_{i+1} - r_i)                     */
    P2G(U_I, U),           /* 3. u_i  = sum_p S_ip u_p    (the old weights)   */
    IMPOSE(U_I),           /*    a wall reflects                              */
    FILTER_AFTER(U, U_I),  /*    the transfer's filter (flip: none)           */
    GRAD(R, U_I, COURANT), /* 4. r_p += k (u_{i+1} - u_i)                     */
    FILTER_AFTER(R, R_I),  /*    the transfer's filter                        */
    DRIFT,                 /* 5. x_p += U0 dt                                 */
};

static const MpmEnergyTerm energy[] = {{MPM_ON_PARTICLES, U, PETSC_FALSE}, {MPM_ON_PARTICLES, R, PETSC_FALSE}};

/* What both share. */
/* clang-format off */
#define GAS(table)                                                                                                     \
  .particle_fields = {"u", "r"}, .particle_ranks = {MPM_VECTOR, MPM_SCALAR}, .node_fields = {"u_i", "r_i"},            \
  .node_ranks = {MPM_VECTOR, MPM_SCALAR}, .nops = PETSC_STATIC_ARRAY_LENGTH(table), .ops = table, .affine = MPM_NONE,  \
  .conserved = MPM_NONE, .nenergy = PETSC_STATIC_ARRAY_LENGTH(energy), .energy = energy, .wave = &MpmWaveFirstOrder,   \
  .published_centred = PETSC_TRUE
/* clang-format on */

/* ---- gas1 ---- */

/* The slides: G = 1 +- gamma, gamma = 2 i k sin(beta). */
static PetscReal Published1(PetscReal k, PetscReal beta)
{
  return hypot(1, 2 * k * sin(beta));
}

/*
   By C1 + C2 = 1 the stencil has half of the slides' width:

     G = f (1 +- k mu),    for the hat mu = e (1 - cos beta) + i sin beta
*/
static PetscReal Corrected1(const MpmCellSymbols *cell, PetscReal k)
{
  return cell->filter * fmax(cabs(1 + k * cell->mu), cabs(1 - k * cell->mu));
}

/* The limit is the k of (1 + 2 k abs(Re mu) + k^2 abs(mu)^2) f^2 = 1. */
static PetscReal Limit1(const MpmCellSymbols *cell)
{
  const PetscReal re = fabs(creal(cell->mu)), size = cabs(cell->mu), room = 1 / PetscSqr(cell->filter) - 1;

  if (size < ROUNDING || cell->filter == 0) return INFINITY; /* mu is 0 up to rounding */
  return room / (re + sqrt(re * re + size * size * room));
}

const MpmFormulation MpmGas1 = {.name      = "gas1",
                                .summary   = "gas, Formulation 1: velocity and density from old nodal values",
                                .reference = "Berzins, Kirby and Gritton 2013; Brackbill 1988",
                                GAS(old_velocity),
                                .staggered       = MPM_NONE,
                                .published_limit = 0,
                                .published_text  = "abs(G)^2 = 1 + 4 k^2 sin^2 beta",
                                .published_slip  = "with C1 + C2 = 1 the stencil of P2G GRAD is half as "
                                                   "wide as the slides print it: gamma = i k sin beta",
                                .corrected_text  = "G = f (1 +- k mu)",
                                .limit_text      = "f^2 (1 + 2 k abs(Re mu) + k^2 abs(mu)^2) <= 1; for flip none",
                                .published       = Published1,
                                .corrected       = Corrected1,
                                .limit           = Limit1};

/* ---- gas2 ---- */

/* The slides print abs(G) for k <= 1/sqrt 2 only. */
static PetscReal Published2(PetscReal k, PetscReal beta)
{
  return k <= M_SQRT1_2 ? sqrt(1 - 2 * PetscSqr(k * sin(beta))) : NAN;
}

/*
   The slides' analysis with two slips mended: (gamma^2 + 2)^2 - 4 is gamma^4 + 4 gamma^2, and C1 = C2 = 1/2 makes
   gamma = i k sin(beta), half of what the slides print. So

     G = f g,    g^2 - (2 + k^2 mu^2) g + 1 = 0
*/
static PetscReal Corrected2(const MpmCellSymbols *cell, PetscReal k)
{
  return cell->filter * MpmQuadraticRadius(2 + k * k * cell->mu * cell->mu, 1);
}

/*
   abs(g) = 1/f where k^2 mu^2 = g + 1/g - 2 crosses the ellipse around -2 of half axes 1/f + f and 1/f - f. For flip
   the ellipse is the line from -4 to 0. Only k^2 mu^2 of a purely imaginary mu (centred particles) lies on it, up to
   k = 2 / abs(mu).
*/
static PetscReal Limit2(const MpmCellSymbols *cell)
{
  const double complex square = cell->mu * cell->mu;
  const PetscReal      size = cabs(square), f = cell->filter, a = 1 / f + f, b = 1 / f - f;
  PetscReal            c, p, q;

  if (size < PetscSqr(ROUNDING) || f == 0) return INFINITY;
  if (b < ROUNDING) return fabs(creal(cell->mu)) <= ROUNDING ? 2 / sqrt(size) : 0;
  c = creal(square) / size;
  p = c * c / (a * a) + (1 - c * c) / (b * b);
  q = 2 * c / (a * a);
  return sqrt((-q + sqrt(q * q + p * (1 - 4 / (a * a)))) / p / size);
}

const MpmFormulation MpmGas2 = {.name      = "gas2",
                                .summary   = "gas, Formulation 2: density from the new nodal velocity",
                                .reference = "Berzins, Kirby and Gritton 2013; Brackbill 1988",
                                GAS(new_velocity),
                                .staggered       = U,
                                .published_limit = M_SQRT1_2,
                                .published_text  = "abs(G) = sqrt(1 - 2 k^2 sin^2 beta), k <= 1/sqrt 2",
                                .published_slip  = "(gamma^2 + 2)^2 - 4 is gamma^4 + 4 gamma^2, not + 2 gamma^2, "
                                                   "and gamma has lost the half of C1 = C2 = 1/2",
                                .corrected_text  = "G = f g, g^2 - (2 + k^2 mu^2) g + 1 = 0",
                                .limit_text =
                                    "f abs(g) <= 1; for flip k <= 2 / abs(mu) where Re mu = 0, none elsewhere",
                                .published = Published2,
                                .corrected = Corrected2,
                                .limit     = Limit2};
