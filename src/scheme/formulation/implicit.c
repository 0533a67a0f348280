/*
   Implicit: a momentum scheme that takes the theta step on the frozen grid, one linear system of the nodes.

     v_t = c s_x, s_t = c v_x    with s = sigma / (rho0 c)

   With the nodal velocity y before the step and y1 after it, and ym = theta y1 + (1 - theta) y,

     y1 = y - k DIV (s + theta k GRAD ym),    s += k GRAD ym.

   The increment a = y1 - y solves (1 + theta^2 k^2 K) a = - k DIV (s + theta k GRAD y), K = DIV GRAD. theta = 1/2 is
   the midpoint rule, 1 backward Euler. From theta = 1/2 on no step raises the energy of the particles, whatever k is
   and however they move (docs/theory.md, section 12).

   Source: Crank and Nicolson 1947; Guilkey and Weiss 2003, an implicit material point method
*/
#include "scheme/formulation/closed_forms.h"
#include <mpmstab/transfer.h>
#include <math.h>

#define ROUNDING 1e-12

enum { V, S, Q };       /* particles; q is the stress in the middle of the step without its part of a */
enum { V_I, A_I, W_I }; /* nodes; w_i = ym */

static PetscInt Lines(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer, MpmOp lines[])
{
  const PetscReal theta = numbers->theta;
  const MpmOp     ops[] = {
          P2G(V_I, V),    /*  1. v_i  = sum_p S_ip v_p                                    */
          IMPOSE(V_I),    /*     v_i  = 0 at fixed ends                                   */
          FILTER(V, V_I), /*     v_p  = F v_p, the transfer (flip: none)                  */
          SCALE(Q, 0),    /*  2. q_p  = s_p + theta k sum_i dS_ip/dx v_i                  */
          {.kind = MPM_ADD, .dst = Q, .src = S, .accumulates = PETSC_TRUE, .factor = 1},
          GRAD_TIMES(Q, V_I, theta, COURANT), /*                                                              */
          MINUS_DIV(A_I, Q, COURANT),         /*  3. a_i  = - k sum_p V_p dS_ip/dx q_p                        */
          IMPLICIT(A_I, theta * theta, COURANT_SQUARED), /*  4. (1 + theta^2 k^2 K) a_i = that                       */
          REACT(A_I, V_I),            /*     a_i  = 0 at fixed ends, or the reaction                  */
          COPY(W_I, V_I),             /*  5. w_i  = v_i + theta a_i                                   */
          ADD_TIMES(W_I, A_I, theta), /*                                                              */
          IMPOSE(W_I),                /*     w_i  = 0 at fixed ends                                   */
          G2P(V, A_I, ONE),           /*  6. v_p += sum_i S_ip a_i                                    */
          GRAD(S, W_I, COURANT),      /*  7. s_p += k sum_i dS_ip/dx w_i                              */
          MOVE(W_I),                  /*  8. x_p += dt sum_i S_ip w_i                                 */
          DRIFT,                      /*     of which U0 dt is known                                  */
  };

  PetscInt n = 0;

  (void)transfer;
  for (size_t o = 0; o < PETSC_STATIC_ARRAY_LENGTH(ops); o++) {
    lines[n] = ops[o];
    if (theta > 0 || (ops[o].kind != MPM_IMPLICIT && !(ops[o].kind == MPM_GRAD && ops[o].dst == Q) &&
                      !(ops[o].kind == MPM_COPY && ops[o].accumulates)))
      n++;
  }
  return n;
}

/*
   A step takes the node's velocity v and force b of the stress to

     a = - (b + theta s v) / q,    v' = f v + alpha a,    b' = b + (r + x) (v + theta a)

   with s = k^2 plain, r = k^2 kappa, x = k^2 chi and q = 1 + theta^2 k^2 times the stiffness of the grid.
*/
static PetscReal Corrected(const MpmCellSymbols *cell, PetscReal k)
{
  const PetscReal theta = cell->numbers->theta, q = 1 + theta * theta * k * k * cell->stiff, s = k * k * cell->plain;
  const double complex sx = k * k * (cell->kappa + cell->chi);
  const PetscReal      f = cell->filter, alpha = cell->alpha;
  const double complex trace = 1 + f - alpha * theta * s / q - theta * sx / q,
                       det   = f * (1 - theta * sx / q) + alpha * (sx - theta * s) / q;

  return MpmQuadraticRadius(trace, det);
}

/*
   Jury's conditions are linear in r = s / q, which is below the number most = kappa / (theta^2 stiff):

     det <= 1            r (alpha (1 - theta) - theta f) <= 1 - f
     trace >= -1 - det   r (theta (1 + f) - alpha (1 - 2 theta)) <= 2 (1 + f)
*/
static PetscReal Limit(const MpmCellSymbols *cell)
{
  const PetscReal theta = cell->numbers->theta, f = cell->filter, alpha = cell->alpha,
                  slope[2] = {alpha * (1 - theta) - theta * f, theta * (1 + f) - alpha * (1 - 2 * theta)},
                  bound[2] = {1 - f, 2 * (1 + f)}, ratio = theta * theta * cell->stiff / cell->kappa;
  PetscReal r = INFINITY;

  for (int i = 0; i < 2; i++)
    if (slope[i] > ROUNDING) r = fmin(r, fmax(bound[i], 0) / slope[i]);
  return r * ratio < 1 - ROUNDING ? sqrt(r / (1 - r * ratio) / cell->kappa) : INFINITY;
}

/* The proof does not hold where a transfer sharpens what GRAD takes, while K is that of the grid. */
static PetscReal Quiet(const MpmCellSymbols *cell)
{
  return cell->numbers->theta < 0.5 || cell->transfer->sharpen ? 0 : INFINITY;
}

static PetscReal StepBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  return numbers->theta < 0.5 || transfer->sharpen ? 0 : INFINITY;
}

const MpmFormulation MpmImplicit = {
    .name    = "implicit",
    .summary = "momentum, the theta step on the frozen grid, a linear system of the nodes: no limit from theta 1/2 on, "
               "but with fmpm",
    .reference       = "Crank and Nicolson 1947; Guilkey and Weiss 2003; docs/theory.md, section 12",
    .particle_fields = {"v", "s", "q"},
    .particle_ranks  = {MPM_VECTOR, MPM_TENSOR, MPM_TENSOR},
    .scratch         = {[Q] = PETSC_TRUE},
    .node_fields     = {"v_i", "a_i", "w_i"},
    .node_ranks      = {MPM_VECTOR, MPM_VECTOR, MPM_VECTOR},
    .options         = {"theta", "halvings"},
    .lines           = Lines,
    .staggered       = MPM_NONE,
    MOMENTUM_PROBLEM,
    .corrected_text =
        "tr = 1 + f - theta (1 + alpha) s / q, det = f + (alpha (1 - theta) - theta f) s / q, s = k^2 kappa, "
        "q = 1 + theta^2 s",
    .limit_text = "(alpha (1 - theta) - theta f) s / q <= 1 - f and "
                  "(theta (1 + f) - alpha (1 - 2 theta)) s / q <= 2 (1 + f)",
    .corrected  = Corrected,
    .limit      = Limit,
    .quiet      = Quiet,
    .step_bound = StepBound};
