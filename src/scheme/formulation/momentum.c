/*
   The explicit momentum schemes of one stage. They differ in when the stress is updated, and from which nodal velocity.

     v_t = c s_x, s_t = c v_x    with s = sigma / (rho0 c)

   With this s, E = rho0 c^2 does not appear.

     usl     update stress last: from the new nodal velocity. Sulsky, Chen and Schreyer 1994; the name after Bardenhagen
             2002
     usf     update stress first: from the old nodal velocity, before the forces. Bardenhagen 2002
     musl    modified update stress last: from P2G of the new velocity. Sulsky, Zhou and Schreyer 1995; Bardenhagen 2002
     usavg   update stress averaged: half first, and half last from P2G of the new velocity. Nairn 2003; it is the
             default of NairnMPM
     verlet  a part first, and the rest, share w, last. w = 1/2 is the velocity Verlet of particles on a grid; w = 0 is
             usf and w = 1 is usl. Unlike usavg, both parts are taken from nodal velocities of one P2G: the new velocity
             of the particles is not projected a second time.
*/
#include "scheme/formulation/closed_forms.h"
#include <mpmstab/transfer.h>
#include <math.h>

enum { V, S };     /* particles */
enum { V_I, A_I }; /* nodes     */

static const MpmOp usl[] = {
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

static const MpmOp usf[] = {
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

static const MpmOp musl[] = {
    P2G(V_I, V),                /* 1. v_i  = sum_p S_ip v_p                      */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                     */
    FILTER(V, V_I),             /*    v_p  = F v_p, the transfer (flip: none)    */
    MINUS_DIV(A_I, S, COURANT), /* 2. a_i  = - k sum_p V_p dS_ip/dx s_p          */
    REACT(A_I, V_I),            /*    a_i  = 0 at fixed ends, or the reaction    */
    G2P(V, A_I, ONE),           /* 3. v_p += sum_i S_ip a_i                      */
    MOVE(V_I),                  /* 4. x_p += dt sum_i S_ip (v_i + a_i)           */
    MOVE(A_I),                  /*                                               */
    P2G(V_I, V),                /* 5. v_i  = sum_p S_ip v_p    (the new v)       */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                     */
    GRAD(S, V_I, COURANT),      /* 6. s_p += k sum_i dS_ip/dx v_i                */
    MOVE_PROJECTED(V_I),        /*    x_p moves here instead with move projected */
    DRIFT,                      /*    U0 dt, the part of x_p's motion that is known */
};

static const MpmOp usavg[] = {
    P2G(V_I, V),                /* 1. v_i  = sum_p S_ip v_p                      */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                     */
    FILTER(V, V_I),             /*    v_p  = F v_p, the transfer (flip: none)    */
    HALF_GRAD(S, V_I, COURANT), /* 2. s_p += k/2 sum_i dS_ip/dx v_i              */
    MINUS_DIV(A_I, S, COURANT), /* 3. a_i  = - k sum_p V_p dS_ip/dx s_p          */
    REACT(A_I, V_I),            /*    a_i  = 0 at fixed ends, or the reaction    */
    G2P(V, A_I, ONE),           /* 4. v_p += sum_i S_ip a_i                      */
    MOVE(V_I),                  /* 5. x_p += dt sum_i S_ip (v_i + a_i)           */
    MOVE(A_I),                  /*                                               */
    P2G(V_I, V),                /* 6. v_i  = sum_p S_ip v_p    (the new v)       */
    IMPOSE(V_I),                /*    v_i  = 0 at fixed ends                     */
    HALF_GRAD(S, V_I, COURANT), /* 7. s_p += k/2 sum_i dS_ip/dx v_i              */
    MOVE_PROJECTED(V_I),        /*    x_p moves here instead with move projected */
    DRIFT,                      /*    U0 dt, the part of x_p's motion that is known */
};

static const MpmOp verlet[] = {
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

/* The table of verlet with the two parts of the strain and of the motion; none of them where it is 0. */
static PetscInt VerletLines(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer, MpmOp lines[])
{
  PetscReal strain = 1 - numbers->share, way = 1 - numbers->move_share;
  PetscInt  n = 0;

  (void)transfer;
  for (size_t o = 0; o < PETSC_STATIC_ARRAY_LENGTH(verlet); o++) {
    lines[n] = verlet[o];
    if (verlet[o].kind == MPM_GRAD) {
      lines[n].factor = strain;
      strain          = numbers->share;
    }
    if (verlet[o].kind == MPM_MOVE) {
      lines[n].factor = way;
      way             = numbers->move_share;
    }
    if ((lines[n].kind != MPM_GRAD && lines[n].kind != MPM_MOVE) || lines[n].factor != 0) n++;
  }
  return n;
}

/* ---- closed forms ---- */

/*
   A step takes the node's velocity v and the force b of the strain so far to

     a = - b - (p + d) v,    v' = f v + alpha a,    b' = b + p v + q (v + a) + x (v + m a)

   with p = (1 - w) k^2 kappa, q = w k^2 kappa, d = k drag, x = k^2 chi, and m the share of the new velocity that
   particles move with. Of usf, musl and usavg w is 0: they update the stress from P2G of the particles' velocity, not
   from a nodal velocity that was advanced on the grid.
*/
static PetscReal Growth(const MpmCellSymbols *cell, PetscReal k, PetscReal w, PetscReal m)
{
  const PetscReal f = cell->filter, alpha = cell->alpha, p = (1 - w) * k * k * cell->kappa, q = w * k * k * cell->kappa,
                  lost   = alpha * k * cell->drag;
  const double complex x = k * k * cell->chi;

  return MpmQuadraticRadius(1 + f - alpha * p - q - m * x - lost, f - (f - alpha) * q - (m * f - alpha) * x - lost);
}

/*
   Jury's conditions are abs(det) <= 1 and abs(trace) <= 1 + det. The limit is where trace >= -(1 + det) holds with
   equality. With y = 2 (1 + f) this is k^2 (y / limit^2) + 2 alpha drag k <= y, linear in what is lost per time.
*/
static PetscReal Limit(const MpmCellSymbols *cell, PetscReal w)
{
  const PetscReal f = cell->filter, alpha = cell->alpha, lost = alpha * cell->drag / (1 + f),
                  square = (w * (1 + f) + (1 - 2 * w) * alpha) * cell->kappa / (2 * (1 + f));

  return lost == 0 ? sqrt(1 / square) : 2 / (lost + sqrt(lost * lost + 4 * square));
}

static PetscReal LastGrowth(const MpmCellSymbols *cell, PetscReal k)
{
  return Growth(cell, k, 1, 1);
}

/* Where particles move with the projected velocity their displacement comes of the same velocity as the strain. */
static PetscReal AheadGrowth(const MpmCellSymbols *cell, PetscReal k)
{
  const PetscReal      alpha = cell->alpha, lost = alpha * k * cell->drag;
  const double complex s = k * k * (cell->kappa + cell->chi);

  if (cell->projected) return MpmQuadraticRadius(1 + cell->filter - alpha * s - lost, cell->filter - lost);
  return Growth(cell, k, 0, 1);
}

static PetscReal VerletGrowth(const MpmCellSymbols *cell, PetscReal k)
{
  return Growth(cell, k, cell->numbers->share, cell->numbers->move_share);
}

static PetscReal LastLimit(const MpmCellSymbols *cell)
{
  return Limit(cell, 1);
}

static PetscReal AheadLimit(const MpmCellSymbols *cell)
{
  return Limit(cell, 0);
}

static PetscReal VerletLimit(const MpmCellSymbols *cell)
{
  return Limit(cell, cell->numbers->share);
}

/* s <= 2 (1 + f) / (1 + f - alpha) is least where alpha is 0. */
static PetscReal LastBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  (void)numbers;
  return transfer->step_bound ? sqrt(2) : 0;
}

/* alpha s <= 2 (1 + f) is least where alpha and f are 1. */
static PetscReal AheadBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  (void)numbers;
  return transfer->step_bound ? 2 : 0;
}

/* With f = 1 the limit is linear in alpha, and least at one of its ends: s <= 4, or s <= 2 / w. */
static PetscReal VerletBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  return transfer->step_bound && !transfer->filter ? sqrt(2 / fmax(numbers->share, 0.5)) : 0;
}

/* ---- the formulations ---- */

/* clang-format off */
#define AHEAD                                                                                                          \
  .corrected_text = "tr = 1 + f - alpha s, det = f, s = k^2 kappa",                                                    \
  .limit_text = "alpha s <= 2 (1 + f), s = k^2 kappa", .corrected = AheadGrowth, .limit = AheadLimit,                  \
  .mls_bound = PETSC_TRUE, .leftmost = PETSC_TRUE,                                                                     \
  .step_bound = AheadBound
/* clang-format on */

const MpmFormulation MpmUsl = {.name      = "usl",
                               .summary   = "momentum, update stress last: stress from the new nodal velocity",
                               .reference = "Sulsky, Chen and Schreyer 1994; Bardenhagen 2002",
                               .staggered = V,
                               MOMENTUM_OF(usl),
                               .corrected_text = "tr = 1 + f - s, det = f + (alpha - f) s, s = k^2 kappa",
                               .limit_text     = "s = k^2 kappa <= 2 (1 + f) / (1 + f - alpha)",
                               .corrected      = LastGrowth,
                               .limit          = LastLimit,
                               .mls_bound      = PETSC_TRUE,
                               .leftmost       = PETSC_TRUE,
                               .step_bound     = LastBound,
                               .sums_chi       = PETSC_TRUE};

const MpmFormulation MpmUsf = {.name = "usf",
                               .summary =
                                   "momentum, update stress first: stress from the old nodal velocity, then forces",
                               .reference = "Bardenhagen 2002",
                               .staggered = S,
                               MOMENTUM_OF(usf),
                               AHEAD};

const MpmFormulation MpmMusl = {
    .name      = "musl",
    .summary   = "momentum, modified update stress last: stress from the new particles' velocity on the grid",
    .reference = "Sulsky, Zhou and Schreyer 1995; Bardenhagen 2002",
    .staggered = V,
    MOMENTUM_OF(musl),
    AHEAD};

const MpmFormulation MpmUsavg = {.name      = "usavg",
                                 .summary   = "momentum, update stress averaged: half first, half last",
                                 .reference = "Nairn 2003",
                                 .staggered = MPM_NONE,
                                 MOMENTUM_OF(usavg),
                                 AHEAD};

const MpmFormulation MpmVerlet = {
    .name       = "verlet",
    .summary    = "momentum, part of the stress before the force and the rest (share) after it",
    .reference  = "Verlet 1967; on a grid docs/theory.md, section 12",
    .staggered  = MPM_NONE,
    .options    = {"share", "move_share"},
    .move_share = 1,
    .lines      = VerletLines,
    MOMENTUM_OF(verlet),
    .corrected_text = "tr = 1 + f - (alpha (1 - w) + w) s, det = f - w (f - alpha) s, s = k^2 kappa, w = share",
    .limit_text     = "s = k^2 kappa <= 2 (1 + f) / (w (1 + f) + (1 - 2 w) alpha)",
    .corrected      = VerletGrowth,
    .limit          = VerletLimit,
    .step_bound     = VerletBound};
