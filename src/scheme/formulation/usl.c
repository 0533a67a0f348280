/*
   Update stress last (USL): a momentum scheme. The stress is updated from the new nodal velocity.

     v_t = c s_x, s_t = c v_x    with s = sigma / (rho0 c)

   With this s, E = rho0 c^2 does not appear.

   Source: Sulsky, Chen and Schreyer 1994; the name after Bardenhagen 2002.
*/
#include "scheme/formulation/closed_forms.h"
#include <mpmstab/transfer.h>
#include <math.h>

enum { V, S };     /* particles */
enum { V_I, A_I }; /* nodes     */

static const MpmOp ops[] = {
    P2G(V_I, V),                /* 1. v_i  = sum_p S_ip v_p                     */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                    */
    FILTER(V, V_I),             /*    v_p  = F v_p, the transfer (flip: none)   */
    MINUS_DIV(A_I, S, COURANT), /* 2. a_i  = - k sum_p V_p dS_ip/dx s_p         */
    REACT(A_I, V_I),            /*    a_i  = 0 at fixed ends, or the reaction   */
    ADD(V_I, A_I),              /* 3. v_i += a_i                                */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                    */
    G2P(V, A_I, ONE),           /* 4. v_p += sum_i S_ip a_i                     */
    GRAD(S, V_I, COURANT),      /* 5. s_p += k sum_i dS_ip/dx v_i               */
    MOVE(V_I),                  /* 6. x_p += dt sum_i S_ip v_i                  */
    DRIFT,                      /*    of which U0 dt is known                   */
};

/*
   A step takes the node's velocity v and increment a to

     v' = f v + alpha a,    b' = b + s (v + a),    a = - b - d v    with s = k^2 (kappa + chi), d = k drag

   b is the force of the stress.
*/
static PetscReal Corrected(const MpmCellSymbols *cell, PetscReal k)
{
  const double complex s = k * k * (cell->kappa + cell->chi);
  const PetscReal      f = cell->filter, lost = cell->alpha * k * cell->drag;

  return MpmQuadraticRadius(1 + f - s - lost, f + (cell->alpha - f) * s - lost);
}

/* The limit is where Jury's condition trace >= -(1 + det) holds with equality. */
static PetscReal Limit(const MpmCellSymbols *cell)
{
  return MpmDampedLimit(cell, sqrt(2 * (1 + cell->filter) / ((1 + cell->filter - cell->alpha) * cell->kappa)));
}

/* s <= 2 (1 + f) / (1 + f - alpha) is least where alpha is 0. */
static PetscReal StepBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  (void)numbers;
  return transfer->step_bound ? sqrt(2) : 0;
}

const MpmFormulation MpmUsl = {.name      = "usl",
                               .summary   = "momentum, update stress last: stress from the new nodal velocity",
                               .reference = "Sulsky, Chen and Schreyer 1994; Bardenhagen 2002",
                               .staggered = V,
                               MOMENTUM,
                               .corrected_text = "tr = 1 + f - s, det = f + (alpha - f) s, s = k^2 kappa",
                               .limit_text     = "s = k^2 kappa <= 2 (1 + f) / (1 + f - alpha)",
                               .corrected      = Corrected,
                               .limit          = Limit,
                               .mls_bound      = PETSC_TRUE,
                               .leftmost       = PETSC_TRUE,
                               .step_bound     = StepBound,
                               .sums_chi       = PETSC_TRUE};
