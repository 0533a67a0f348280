/*
   The one-dimensional linear elastic model of the slides: displacement u and w = v h / c, so that v dt = k w.

     u_t = v, v_t = c^2 u_xx

   Source: Berzins, Kirby and Gritton 2013, '1d Linear Elastic Model', The Algorithm. The slides print the sums of steps
   5 and 6 over p; they must run over the nodes i.

   The slides stop at one dimension. In more, u and w stay one number each, and LAP is the Laplacian of 2 dim + 1 nodes:
   the scalar wave equation u_tt = c^2 div grad u.
*/
#include "scheme/formulation/closed_forms.h"
#include <math.h>

enum { U, W };          /* particles */
enum { U_I, W_I, A_I }; /* nodes     */

static const MpmOp ops[] = {
    P2G(U_I, U),            /* 1. u_i  = sum_p S_ip u_p                    */
    IMPOSE(U_I),            /*    u_i  = 0 at fixed ends                   */
    FILTER_BEFORE(W, W_I),  /*    the filter with pic_filter before        */
    P2G(W_I, W),            /* 2. w_i  = sum_p S_ip w_p                    */
    IMPOSE(W_I),            /*    w_i  = 0 at fixed ends                   */
    FILTER_AFTER(W, W_I),   /*    the transfer's filter (flip: none)       */
    LAP(A_I, U_I, COURANT), /* 3. a_i  = k (u_{i+1} - 2 u_i + u_{i-1})     */
    REACT(A_I, W_I),        /*    a_i  = 0 at fixed ends, or the reaction  */
    ADD(W_I, A_I),          /* 4. w_i += a_i                               */
    IMPOSE(W_I),            /*    w_i  = 0 at fixed ends                   */
    G2P(W, A_I, ONE),       /* 5. w_p += sum_i S_ip a_i                    */
    G2P(U, W_I, COURANT),   /* 6. u_p += k sum_i S_ip w_i                  */
    DRIFT,                  /* 7. x_p += U0 dt                             */
};

static const MpmEnergyTerm energy[] = {{MPM_ON_PARTICLES, W, PETSC_FALSE}, {MPM_ON_NODES, U_I, PETSC_FALSE}};

/* The slides: G^2 - 2 gamma G + 1 = 0, gamma = 1 - 2 k^2 sin^2(beta/2). */
static PetscReal Published(PetscReal k, PetscReal beta)
{
  return MpmQuadraticRadius(2 - 4 * PetscSqr(k * sin(beta / 2)), 1);
}

/*
   P2G G2P is not the identity. Its symbol is alpha, for the hat 1 - 4 q sin^2(beta/2) with q = mean of xi (1 - xi).
   With u and w on the nodes and a = -(s/k) u, a step makes

     w' = f w + alpha a,    u' = u + k alpha (t w + a)
*/
static PetscReal Corrected(const MpmCellSymbols *cell, PetscReal k)
{
  const PetscReal s = k * k * cell->lap, alpha = cell->alpha, f = cell->filter;

  return MpmQuadraticRadius(1 + f - alpha * s, f - alpha * (f - alpha * cell->taken) * s);
}

/* The limit is where Jury's condition trace >= -(1 + det) holds with equality. */
static PetscReal Limit(const MpmCellSymbols *cell)
{
  const PetscReal alpha = cell->alpha, f = cell->filter;

  return sqrt(2 * (1 + f) / (alpha * (1 + f - alpha * cell->taken)) / cell->lap);
}

const MpmFormulation MpmElastic = {.name            = "elastic",
                                   .summary         = "linear elastic bar: displacement and velocity",
                                   .reference       = "Berzins, Kirby and Gritton 2013",
                                   .particle_fields = {"u", "w"}, /* numbers, in any dimension */
                                   .node_fields     = {"u_i", "w_i", "a_i"},
                                   .nops            = PETSC_STATIC_ARRAY_LENGTH(ops),
                                   .ops             = ops,
                                   .staggered       = W,
                                   .affine          = MPM_NONE,
                                   .conserved       = MPM_NONE,
                                   .free_ends       = PETSC_TRUE,
                                   .nenergy         = PETSC_STATIC_ARRAY_LENGTH(energy),
                                   .energy          = energy,
                                   .wave            = &MpmWaveSecondOrder,
                                   .published_limit = 1,
                                   .published_text  = "G^2 - 2 (1 - 2 k^2 sin^2(beta/2)) G + 1 = 0",
                                   .published_slip  = "it takes P2G G2P for the identity; the symbol of that is "
                                                      "alpha = 1 - 4 q sin^2(beta/2), q = mean of xi (1 - xi)",
                                   .corrected_text  = "tr = 1 + f - alpha s, det = f - alpha (f - alpha t) s, "
                                                      "s = 4 k^2 sin^2(beta/2)",
                                   .limit_text      = "s <= 2 (1 + f) / (alpha (1 + f - alpha t))",
                                   .published       = Published,
                                   .corrected       = Corrected,
                                   .limit           = Limit};
