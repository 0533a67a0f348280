/*
   clay: modified Cam clay. Hencky's elastic solid with the pressure p = - K tr e, K = lambda + 2 mu / 3, and Q =
   sqrt(3/2) norm(dev tau):

     (Q / M)^2 + p (p - c) <= 0,   c = yield exp(hardening q),   M = 6 sin f / (3 - sin f)

   c is the preconsolidation pressure, q the plastic loss of volume, f the angle of friction at the critical state p = c
   / 2. The flow is along the gradient, so that with x = q' - q and a number g >= 0

     x = g (2 p' - c'),   p' = - K (tr + x),   dev e' = r dev e,   r = 1 / (1 + 6 mu g / M^2)

   Newton's method for x and g together takes some six steps from 0. Where it fails, it is done in g alone: for a g the
   first equation is convex and grows in x, so that Newton's method comes to its root from above. The yield function is
   above 0 at g = 0, and below it for large g: Newton's method in g takes half of its bracket where it would leave it.
   Clay bears no tension, and without a load it stands on the yield surface.

   K. H. Roscoe and J. B. Burland, On the generalised stress-strain behaviour of 'wet' clay (1968); in logarithmic
   strains R. I. Borja and C. Tamagnini, Cam-Clay plasticity, part III (1998), here with elastic moduli that stay as
   they are.
*/
#include "scheme/material/plastic.h"
#include <math.h>

#define MOST_STEPS 200
#define MOST_TOGETHER 12
#define SMALL 1e-9 /* beside g */

/* A flow: from the trial values tr, d = norm(dev e) and c = start; to x and g. Of these: p, c, r and (Q / M)^2. */
typedef struct {
  PetscReal K, M2, mu, hardening, tr, d, start, x, g, p, c, r, Q2;
} Flow;

static Flow FlowOf(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q, PetscReal dev[3])
{
  const PetscReal sine = sin(m->plastic[MPM_FRICTION_ANGLE] * M_PI / 180), tr = e[0] + e[1] + e[2];
  Flow            f = {.K         = m->lambda + 2 * m->mu / 3,
                       .M2        = PetscSqr(6 * sine / (3 - sine)),
                       .mu        = m->mu,
                       .hardening = m->plastic[MPM_HARDENING],
                       .tr        = tr,
                       .start     = m->plastic[MPM_YIELD] * exp(m->plastic[MPM_HARDENING] * q)};

  f.d = MpmDeviator(e, dev);
  return f;
}

/* Sets what depends on x. */
static void SetPressures(Flow *f)
{
  f->p = -f->K * (f->tr + f->x);
  f->c = f->x == 0 ? f->start : f->start * exp(f->hardening * f->x);
}

/* Sets what depends on g; returns the yield function. */
static PetscReal SetShear(Flow *f)
{
  f->r  = 1 / (1 + 6 * f->mu * f->g / f->M2);
  f->Q2 = 6 * PetscSqr(f->mu * f->d * f->r) / f->M2;
  return f->Q2 + f->p * (f->p - f->c);
}

/*
   Sets x to the root for g, and what depends on both; returns the yield function. It begins at the x of the last g:
   after one step it comes from above.
*/
static PetscReal Follow(Flow *f, PetscReal g)
{
  PetscReal change = 1;

  f->g = g;
  f->x = g > 0 ? PetscMin(PetscMax(f->x, 0), PetscMax(-f->tr, 0)) : 0;
  for (PetscInt i = 0; i <= MOST_STEPS; i++) {
    SetPressures(f);
    if (g == 0 || i == MOST_STEPS || fabs(change) <= 1e-17 || (i > 1 && change <= 0)) break;
    change = (f->x - g * (2 * f->p - f->c)) / (1 + g * (2 * f->K + f->hardening * f->c));
    f->x -= change;
  }
  return SetShear(f);
}

/* The derivatives of x - g (2 p - c) and of the yield function, by g, x, tr, d and q. */
static void Differ(const Flow *f, PetscReal R[2][5])
{
  const PetscReal over = 2 * f->p - f->c, harder = f->hardening * f->c, loss = 6 * f->mu / f->M2;

  R[0][0] = -over;
  R[0][1] = 1 + f->g * (2 * f->K + harder);
  R[0][2] = 2 * f->K * f->g;
  R[0][3] = 0;
  R[0][4] = f->g * harder;
  R[1][0] = -2 * f->Q2 * loss * f->r;
  R[1][1] = -f->K * over - f->p * harder;
  R[1][2] = -f->K * over;
  R[1][3] = 12 * PetscSqr(f->mu * f->r) * f->d / f->M2;
  R[1][4] = -f->p * harder;
}

static PetscReal Yield(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q)
{
  PetscReal dev[3];
  Flow      f = FlowOf(m, e, q, dev);

  return Follow(&f, 0) / f.c;
}

/*
   Newton's method squares the error, so that the step after a small one is exact: for x and g together, from 0, where
   value is the yield function. Returns whether it has found the flow.
*/
static PetscBool SolveTogether(Flow *f, PetscReal value)
{
  for (PetscInt i = 0; i < MOST_TOGETHER; i++) {
    const PetscReal first = f->x - f->g * (2 * f->p - f->c);
    PetscReal       R[2][5], det, dx, dg;

    Differ(f, R);
    det = R[0][0] * R[1][1] - R[0][1] * R[1][0];
    dg  = (first * R[1][1] - R[0][1] * value) / det;
    dx  = (R[0][0] * value - first * R[1][0]) / det;
    f->g -= dg;
    f->x -= dx;
    if (!(f->g > 0)) return PETSC_FALSE;
    SetPressures(f);
    value = SetShear(f);
    if (fabs(dg) <= SMALL * f->g && fabs(dx) <= PetscMax(SMALL * fabs(f->x), 1e-17)) return PETSC_TRUE;
  }
  return PETSC_FALSE;
}

/* The same for g alone. */
static PetscBool SolveInBracket(Flow *f)
{
  PetscReal low = 0, high = INFINITY, value, R[2][5], g = 0, change = INFINITY;

  for (PetscInt i = 0; i < MOST_STEPS && change > SMALL * g; i++) {
    PetscReal next;

    value = Follow(f, g);
    if (value > 0)
      low = g;
    else
      high = g;
    Differ(f, R);
    next = g - value / (R[1][0] - R[1][1] * R[0][0] / R[0][1]);
    if (!(next > low && next < high) && !(fabs(next - g) <= SMALL * g))
      next = isfinite(high) ? (low + high) / 2 : 2 * g + f->M2 / (6 * f->mu);
    change = fabs(next - g);
    g      = next;
  }
  (void)Follow(f, g);
  return change <= SMALL * g ? PETSC_TRUE : PETSC_FALSE;
}

static void Back(const MpmMaterialNumbers *m, PetscReal e[3], PetscReal *q, PetscReal slope[4][4])
{
  PetscReal dev[3], R[2][5], by[2][5] = {{0}};
  Flow      f     = FlowOf(m, e, *q, dev);
  PetscReal value = Follow(&f, 0);
  PetscBool found = value > 0 && !SolveTogether(&f, value) ? SolveInBracket(&f) : PETSC_TRUE;

  for (PetscInt a = 0; a < 3; a++) e[a] = (f.tr + f.x) / 3 + f.r * dev[a];
  *q = found ? *q + f.x : NAN;
  if (!slope) return;
  Differ(&f, R);
  for (PetscInt u = 2; u < 5; u++) { /* of g and x, by tr, d and q */
    const PetscReal det = R[0][0] * R[1][1] - R[0][1] * R[1][0];

    by[0][u] = (R[0][1] * R[1][u] - R[1][1] * R[0][u]) / det;
    by[1][u] = (R[1][0] * R[0][u] - R[0][0] * R[1][u]) / det;
  }
  for (PetscInt b = 0; b < 4; b++) {
    const PetscReal n = b < 3 && f.d > 0 ? dev[b] / f.d : 0;
    const PetscReal g = b < 3 ? by[0][2] + n * by[0][3] : by[0][4], x = b < 3 ? by[1][2] + n * by[1][3] : by[1][4];

    for (PetscInt a = 0; a < 3; a++)
      slope[a][b] = ((b < 3 ? 1 : 0) + x) / 3 + (b < 3 ? f.r * ((a == b ? 1 : 0) - 1. / 3) : 0) -
                    6 * f.mu / f.M2 * f.r * f.r * dev[a] * g;
    slope[3][b] = x + (b == 3 ? 1 : 0);
  }
}

static const MpmPlastic plastic = {.internal = "plastic_loss",
                                   .outside  = PETSC_TRUE,
                                   .yield    = Yield,
                                   .back     = Back,
                                   .stress   = MpmHenckyStress,
                                   .energy   = MpmHenckyEnergy};

const MpmLaw MpmLawClay = {.name = "clay",
                           MPM_PLASTIC_FUNCTIONS,
                           .plastic = &plastic,
                           .number  = {[MPM_YIELD]          = {PETSC_TRUE, 0.01, 1e-9, 1e3},
                                       [MPM_HARDENING]      = {PETSC_TRUE, 10, 0, 500},
                                       [MPM_FRICTION_ANGLE] = {PETSC_TRUE, 25, 0.01, 89}}};
