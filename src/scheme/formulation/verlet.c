/*
   Verlet: a momentum scheme. A part of the strain comes before the force, and the rest, share w, after it.

     v_t = c s_x, s_t = c v_x    with s = sigma / (rho0 c)

   w = 1/2 is the velocity Verlet of particles on a grid; w = 0 is usf and w = 1 is usl. Unlike usavg, both parts are
   taken from nodal velocities of one P2G: the new velocity of the particles is not projected a second time.
*/
#include "scheme/formulation/closed_forms.h"
#include <mpmstab/transfer.h>
#include <math.h>

enum { V, S };     /* particles */
enum { V_I, A_I }; /* nodes     */

static const MpmOp ops[] = {
    P2G(V_I, V),                /* 1. v_i  = sum_p S_ip v_p                        */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                       */
    FILTER(V, V_I),             /*    v_p  = F v_p, the transfer (flip: none)      */
    HALF_GRAD(S, V_I, COURANT), /* 2. s_p += (1 - w) k sum_i dS_ip/dx v_i          */
    MINUS_DIV(A_I, S, COURANT), /* 3. a_i  = - k sum_p V_p dS_ip/dx s_p            */
    REACT(A_I, V_I),            /*    a_i  = 0 at fixed ends, or the reaction      */
    MOVE(V_I),                  /*    x_p += (1 - m) dt sum_i S_ip v_i             */
    ADD(V_I, A_I),              /* 4. v_i += a_i                                   */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                       */
    G2P(V, A_I, ONE),           /* 5. v_p += sum_i S_ip a_i                        */
    HALF_GRAD(S, V_I, COURANT), /* 6. s_p += w k sum_i dS_ip/dx v_i                */
    MOVE(V_I),                  /* 7. x_p += m dt sum_i S_ip v_i                   */
    DRIFT,                      /*    of which U0 dt is known                      */
};

/* The table with the two parts of the strain and of the motion; none of them where it is 0. */
static PetscInt Lines(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer, MpmOp lines[])
{
  PetscReal strain = 1 - numbers->share, way = 1 - numbers->move_share;
  PetscInt  n = 0;

  (void)transfer;
  for (size_t o = 0; o < PETSC_STATIC_ARRAY_LENGTH(ops); o++) {
    lines[n] = ops[o];
    if (ops[o].kind == MPM_GRAD) {
      lines[n].factor = strain;
      strain          = numbers->share;
    }
    if (ops[o].kind == MPM_MOVE) {
      lines[n].factor = way;
      way             = numbers->move_share;
    }
    if ((lines[n].kind != MPM_GRAD && lines[n].kind != MPM_MOVE) || lines[n].factor != 0) n++;
  }
  return n;
}

/*
   A step takes the node's velocity v and the force b of the strain so far to

     a = - b - (p + d) v,    v' = f v + alpha a,    b' = b + p v + q (v + a) + x (v + m a)

   with p = (1 - w) k^2 kappa, q = w k^2 kappa, d = k drag, x = k^2 chi, and m the share of the new velocity that
   particles move with.
*/
static PetscReal Corrected(const MpmCellSymbols *cell, PetscReal k)
{
  const PetscReal f = cell->filter, w = cell->numbers->share, m = cell->numbers->move_share,
                  p = (1 - w) * k * k * cell->kappa, q = w * k * k * cell->kappa, lost = cell->alpha * k * cell->drag;
  const double complex x = k * k * cell->chi;

  return MpmQuadraticRadius(1 + f - cell->alpha * p - q - m * x - lost,
                            f - (f - cell->alpha) * q - (m * f - cell->alpha) * x - lost);
}

/* The limit is where Jury's condition trace >= -(1 + det) holds with equality. */
static PetscReal Limit(const MpmCellSymbols *cell)
{
  const PetscReal f = cell->filter, w = cell->numbers->share;

  return MpmDampedLimit(cell, sqrt(2 * (1 + f) / ((w * (1 + f) + (1 - 2 * w) * cell->alpha) * cell->kappa)));
}

/* With f = 1 the limit is linear in alpha, and least at one of its ends: s <= 4, or s <= 2 / w. */
static PetscReal StepBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  return transfer->step_bound && !transfer->filter ? sqrt(2 / fmax(numbers->share, 0.5)) : 0;
}

const MpmFormulation MpmVerlet = {.name = "verlet",
                                  .summary =
                                      "momentum, part of the stress before the force and the rest (share) after it",
                                  .reference  = "Verlet 1967; on a grid docs/theory.md, section 12",
                                  .staggered  = MPM_NONE,
                                  .options    = {"share", "move_share"},
                                  .move_share = 1,
                                  .lines      = Lines,
                                  MOMENTUM,
                                  .corrected_text = "tr = 1 + f - (alpha (1 - w) + w) s, det = f - w (f - alpha) s, "
                                                    "s = k^2 kappa, w = share",
                                  .limit_text     = "s = k^2 kappa <= 2 (1 + f) / (w (1 + f) + (1 - 2 w) alpha)",
                                  .corrected      = Corrected,
                                  .limit          = Limit,
                                  .step_bound     = StepBound};
