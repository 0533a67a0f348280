/*
   Runge-Kutta (rk): a momentum scheme that takes an explicit step of several stages on the frozen grid.

     v_t = c s_x, s_t = c v_x    with s = sigma / (rho0 c)

   A method is w_0 = u, w_j = u + c_j L w_{j-1}, j = 1 to m, c_m = 1, with one copy of the state u and its stability
   polynomial R(z) = 1 + z (1 + c_{m-1} z (1 + ...)). abs(R(i w)) <= 1 up to w = edge. L is skew in the energy of the
   particles, so that no step raises this energy while k sqrt(largest eigenvalue) <= edge, however particles move
   (docs/theory.md, section 12).

   Source: Kinnmark and Gray 1984 (kg3, kg5); Kutta 1901 (rk4, with the linear equations' polynomial)
*/
#include "scheme/formulation/closed_forms.h"
#include <mpmstab/transfer.h>
#include <math.h>

enum { V, S, P, Q };         /* particles; p and q are those of a stage */
enum { V_I, A_I, W_I, U_I }; /* nodes; w_i and u_i are velocities of stages, in turn */

#define MOST_STAGES 5
#define SCANS 400      /* Courant numbers at which Jury's conditions are tried, up to twice the edge */
#define ROUNDING 1e-12 /* of Jury's conditions */
#define BISECTIONS 60

static const struct {
  const char *name;
  PetscInt    stages;
  PetscReal   c[MOST_STAGES], edge;
} methods[] = {{"rk3", 3, {1. / 3, 1. / 2, 1}, 1.7320508075688772},
               {"kg3", 3, {1. / 2, 1. / 2, 1}, 2},
               {"rk4", 4, {1. / 4, 1. / 3, 1. / 2, 1}, 2.8284271247461903},
               {"kg5", 5, {1. / 4, 1. / 6, 3. / 8, 1. / 2, 1}, 4}};

const char *const MpmRkOnNames[] = {"auto", "particles", "nodes", NULL}, *const MpmRkPlacesNames[] = {"frozen",
                                                                                                      "stages", NULL};

const char *MpmRkWord(PetscInt i)
{
  return i < (PetscInt)PETSC_STATIC_ARRAY_LENGTH(methods) ? methods[i].name : NULL;
}

PetscBool MpmRkIsOnNodes(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  if (numbers->rk_on != MPM_RK_AUTO) return numbers->rk_on == MPM_RK_NODES ? PETSC_TRUE : PETSC_FALSE;
  return transfer && (transfer->filter || transfer->sharpen) ? PETSC_TRUE : PETSC_FALSE;
}

typedef struct {
  MpmOp   *line;
  PetscInt n;
} Table;

static void Put(Table *t, MpmOp line)
{
  t->line[t->n++] = line;
}

/* A field of particles of a stage is what it was at the start of the step, and what is added to that. */
static void Begin(Table *t, PetscInt scratch, PetscInt field)
{
  Put(t, (MpmOp)SCALE(scratch, 0));
  Put(t, (MpmOp){.kind = MPM_ADD, .dst = scratch, .src = field, .accumulates = PETSC_TRUE, .factor = 1});
}

/*
   A stage takes the velocity from and the force a_i of the stage before it to the velocity to and a new force. On
   particles to is P2G of p = v + c G2P a_i. On nodes it is v_i + c a_i. Scratch fields live between two sums, so that
   these come together. moves: a stage on particles moves them, too.
*/
static void Stage(Table *t, PetscBool on_nodes, PetscBool moves, PetscReal c, PetscInt from, PetscInt to)
{
  if (on_nodes) {
    Put(t, (MpmOp)COPY(to, V_I)); /* to = v_i + c a_i */
    Put(t, (MpmOp)ADD_TIMES(to, A_I, c));
    Put(t, (MpmOp)IMPOSE(to));
  } else {
    Begin(t, P, V);
    Put(t, (MpmOp)G2P_TIMES(P, A_I, c, ONE)); /* p_p = v_p + c sum_i S_ip a_i */
  }
  Begin(t, Q, S);
  Put(t, (MpmOp)GRAD_TIMES(Q, from, c, COURANT)); /* q_p = s_p + c k sum_i dS_ip/dx from_i */
  if (moves) Put(t, (MpmOp)MOVE_TO(from, c));     /* x_p = that of the start + c dt sum_i S_ip from_i */
  if (!on_nodes) Put(t, (MpmOp)P2G(to, P));       /* to = sum_p S_ip p_p */
  Put(t, (MpmOp)MINUS_DIV(A_I, Q, COURANT));      /* a_i = - k sum_p V_p dS_ip/dx q_p */
  if (!on_nodes) Put(t, (MpmOp)IMPOSE(to));
  Put(t, (MpmOp)REACT(A_I, V_I)); /* a_i = 0 at fixed ends, or the reaction */
}

static PetscInt Lines(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer, MpmOp lines[])
{
  const PetscBool on_nodes = MpmRkIsOnNodes(numbers, transfer);
  const PetscReal share    = numbers->move_share;
  PetscInt        from = V_I, other = MPM_NONE;
  Table           t = {.line = lines};

  Put(&t, (MpmOp)P2G(V_I, V));                /* 1. v_i = sum_p S_ip v_p                   */
  Put(&t, (MpmOp)IMPOSE(V_I));                /*    v_i = 0 at fixed ends                  */
  Put(&t, (MpmOp)FILTER(V, V_I));             /*    v_p = F v_p, the transfer (flip: none) */
  Put(&t, (MpmOp)MINUS_DIV(A_I, S, COURANT)); /* 2. a_i = - k sum_p V_p dS_ip/dx s_p       */
  Put(&t, (MpmOp)REACT(A_I, V_I));
  for (PetscInt j = 0; j < methods[numbers->rk].stages - 1; j++) { /* 3. the stages in between */
    const PetscInt to = j % 2 ? U_I : W_I;

    Stage(&t, on_nodes, numbers->rk_places == MPM_RK_STAGES, methods[numbers->rk].c[j], from, to);
    from = to;
  }
  if (share != 0.5) { /* n_i = v_i + a_i, in the place of the stage before */
    other = from == W_I ? U_I : W_I;
    Put(&t, (MpmOp)COPY(other, V_I));
    Put(&t, (MpmOp)ADD(other, A_I));
    Put(&t, (MpmOp)IMPOSE(other));
  }
  Put(&t, (MpmOp)G2P(V, A_I, ONE));       /* 4. v_p += sum_i S_ip a_i            */
  Put(&t, (MpmOp)GRAD(S, from, COURANT)); /* 5. s_p += k sum_i dS_ip/dx w_i      */
  if (share != 1)                         /* 6. x_p += dt sum_i S_ip (w_i + (2 m - 1) (n_i - w_i)) */
    Put(&t, (MpmOp)MOVE_TIMES(from, 2 - 2 * share));
  if (share != 0.5) Put(&t, (MpmOp)MOVE_TIMES(other, 2 * share - 1));
  Put(&t, (MpmOp)DRIFT); /*    of which U0 dt is known          */
  return t.n;
}

/*
   A step takes the node's velocity v and force b to M (v, b): run on (1, 0) and on (0, 1). A stage has a = - b - k drag
   v. The velocity of the next one changes by c a on nodes, and by c alpha a by way of the particles. Particles move
   with w + (2 m - 1) (v - b - w), m = move_share.
*/
static void Step(const MpmCellSymbols *cell, PetscReal k, double complex *trace, double complex *det)
{
  const MpmSchemeNumbers *numbers = cell->numbers;
  const PetscReal         s = k * k * cell->kappa, lost = k * cell->drag,
                  alpha       = MpmRkIsOnNodes(numbers, cell->transfer) ? 1 : cell->alpha;
  const double complex x      = k * k * cell->chi;
  const PetscInt       stages = methods[numbers->rk].stages;
  double complex       m[2][2];

  for (int start = 0; start < 2; start++) {
    const double complex v = start == 0, b = start == 1;
    double complex       wv = v, wb = b;

    for (PetscInt j = 0; j < stages - 1; j++) {
      const PetscReal      c    = methods[numbers->rk].c[j];
      const double complex next = v - c * alpha * (wb + lost * wv);

      wb = b + c * s * wv;
      wv = next;
    }
    m[start][0] = cell->filter * v - cell->alpha * (wb + lost * wv);
    m[start][1] = b + s * wv + x * (wv + (2 * numbers->move_share - 1) * (v - wb - lost * wv - wv));
  }
  *trace = m[0][0] + m[1][1];
  *det   = m[0][0] * m[1][1] - m[0][1] * m[1][0];
}

static PetscReal Corrected(const MpmCellSymbols *cell, PetscReal k)
{
  double complex trace, det;

  Step(cell, k, &trace, &det);
  return MpmQuadraticRadius(trace, det);
}

/* Jury's conditions are abs(det) <= 1 and abs(trace) <= 1 + det. */
static PetscBool IsStable(const MpmCellSymbols *cell, PetscReal k)
{
  double complex trace, det;

  Step(cell, k, &trace, &det);
  return fabs(creal(det)) <= 1 + ROUNDING && fabs(creal(trace)) <= 1 + creal(det) + ROUNDING ? PETSC_TRUE : PETSC_FALSE;
}

/* No frequency of the frozen grid is beyond the edge: k sqrt(alpha kappa) on particles, k sqrt(kappa) on nodes. */
static PetscReal Quiet(const MpmCellSymbols *cell)
{
  const PetscReal alpha = MpmRkIsOnNodes(cell->numbers, cell->transfer) ? 1 : cell->alpha;

  return methods[cell->numbers->rk].edge / sqrt(alpha * cell->kappa);
}

/*
   With flip on particles the step is R(i w), w = k sqrt(alpha kappa). Else it is where one of Jury's conditions ends.
*/
static PetscReal Limit(const MpmCellSymbols *cell)
{
  const PetscReal edge = methods[cell->numbers->rk].edge;
  PetscReal       to = 2 * edge / sqrt(cell->kappa), bracket[2] = {0, INFINITY};

  if (cell->drag == 0 && !MpmRkIsOnNodes(cell->numbers, cell->transfer) && !cell->transfer->filter) return Quiet(cell);
  if (!isfinite(to)) return INFINITY;
  for (PetscInt i = 1; i <= SCANS && isinf(bracket[1]); i++) {
    const PetscReal k = to * (PetscReal)i / SCANS;

    bracket[IsStable(cell, k) ? 0 : 1] = k;
  }
  for (PetscInt i = 0; i < BISECTIONS && isfinite(bracket[1]); i++) {
    const PetscReal middle = (bracket[0] + bracket[1]) / 2;

    bracket[IsStable(cell, middle) ? 0 : 1] = middle;
  }
  return bracket[1];
}

/*
   With flip on particles a step is R of a matrix with the eigenvalues of i k sqrt(A^(1/2) K A^(1/2)), A = P2G G2P at
   most 1.
*/
static PetscReal StepBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer)
{
  return transfer->step_bound && !transfer->filter && !MpmRkIsOnNodes(numbers, transfer) ? methods[numbers->rk].edge
                                                                                         : 0;
}

const MpmFormulation MpmRk = {
    .name      = "rk",
    .summary   = "momentum, an explicit Runge-Kutta step (rk) on the frozen grid: it cannot ring, but with aflip, or "
                 "apic on hats",
    .reference = "Kinnmark and Gray 1984; docs/theory.md, section 12",
    .particle_fields = {"v", "s", "p", "q"},
    .particle_ranks  = {MPM_VECTOR, MPM_TENSOR, MPM_VECTOR, MPM_TENSOR},
    .scratch         = {[P] = PETSC_TRUE, [Q] = PETSC_TRUE},
    .node_fields     = {"v_i", "a_i", "w_i", "u_i"},
    .node_ranks      = {MPM_VECTOR, MPM_VECTOR, MPM_VECTOR, MPM_VECTOR},
    .options         = {"rk", "rk_on", "rk_places", "rk_relax", "move_share"},
    .move_share      = 0.5,
    .lines           = Lines,
    .staggered       = MPM_NONE,
    MOMENTUM_PROBLEM,
    .corrected_text =
        "s = k^2 kappa, z = sqrt(alpha s): on particles abs(R(i z)); on nodes by w = u + c L w, of velocity and force",
    .limit_text = "on particles k sqrt(alpha kappa) <= edge of R; on nodes Jury's conditions, by bisection",
    .corrected  = Corrected,
    .limit      = Limit,
    .quiet      = Quiet,
    .step_bound = StepBound};
