/*
   Update stress first (USF): a momentum scheme. The stress is updated from the old nodal velocity, before the forces.

     v_t = c s_x, s_t = c v_x    with s = sigma / (rho0 c)

   With this s, E = rho0 c^2 does not appear.

   Source: Bardenhagen 2002.
*/
#include "scheme/formulation/closed_forms.h"

enum { V, S };     /* particles */
enum { V_I, A_I }; /* nodes     */

static const MpmOp ops[] = {
    P2G(V_I, V),                /* 1. v_i  = sum_p S_ip v_p                     */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                    */
    FILTER(V, V_I),             /*    v_p  = F v_p, the transfer (flip: none)   */
    GRAD(S, V_I, COURANT),      /* 2. s_p += k sum_i dS_ip/dx v_i               */
    MINUS_DIV(A_I, S, COURANT), /* 3. a_i  = - k sum_p V_p dS_ip/dx s_p         */
    REACT(A_I, V_I),            /*    a_i  = 0 at fixed ends, or the reaction   */
    G2P(V, A_I, ONE),           /* 4. v_p += sum_i S_ip a_i                     */
    MOVE(V_I),                  /* 5. x_p += dt sum_i S_ip (v_i + a_i)          */
    MOVE(A_I),                  /*                                              */
    DRIFT,                      /*    of which U0 dt is known                   */
};

const MpmFormulation MpmUsf = {.name = "usf",
                               .summary =
                                   "momentum, update stress first: stress from the old nodal velocity, then forces",
                               .reference = "Bardenhagen 2002",
                               .staggered = S,
                               MOMENTUM,
                               STRESS_AHEAD};
