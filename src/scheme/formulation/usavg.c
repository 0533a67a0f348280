/*
   Update stress averaged (USAVG): a momentum scheme. Half of the stress update comes first, and half last.

     v_t = c s_x, s_t = c v_x    with s = sigma / (rho0 c)

   With this s, E = rho0 c^2 does not appear.

   Source: Nairn 2003; it is the default of NairnMPM, which takes P2G of the new velocity for the second half.
*/
#include "scheme/formulation/closed_forms.h"

enum { V, S };     /* particles */
enum { V_I, A_I }; /* nodes     */

static const MpmOp ops[] = {
    P2G(V_I, V),                /* 1. v_i  = sum_p S_ip v_p                     */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                    */
    FILTER(V, V_I),             /*    v_p  = F v_p, the transfer (flip: none)   */
    HALF_GRAD(S, V_I, COURANT), /* 2. s_p += k/2 sum_i dS_ip/dx v_i             */
    MINUS_DIV(A_I, S, COURANT), /* 3. a_i  = - k sum_p V_p dS_ip/dx s_p         */
    REACT(A_I, V_I),            /*    a_i  = 0 at fixed ends, or the reaction   */
    G2P(V, A_I, ONE),           /* 4. v_p += sum_i S_ip a_i                     */
    MOVE(V_I),                  /* 5. x_p += dt sum_i S_ip (v_i + a_i)          */
    MOVE(A_I),                  /*                                              */
    P2G(V_I, V),                /* 6. v_i  = sum_p S_ip v_p    (the new v)      */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                    */
    HALF_GRAD(S, V_I, COURANT), /* 7. s_p += k/2 sum_i dS_ip/dx v_i             */
    MOVE_PROJECTED(V_I),        /*    x_p moves here instead with move projected */
    DRIFT,                      /*    U0 dt, the part of x_p's motion that is known */
};

const MpmFormulation MpmUsavg = {.name      = "usavg",
                                 .summary   = "momentum, update stress averaged: half first, half last",
                                 .reference = "Nairn 2003",
                                 .staggered = MPM_NONE,
                                 MOMENTUM,
                                 STRESS_AHEAD};
