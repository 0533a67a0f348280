/*
   Solids with a body force that makes a chosen motion an exact solution.

   manufactured: u_a = +-A sin(2 pi X_a / L_a) sin(2 pi c t / L_a), with the minus sign along y. F is diagonal and F_aa
   depends on X_a alone, so the force per mass along a is

     b_a = d2u_a/dt2 - c^2 dP_aa/dF_aa dF_aa/dX_a

   With dim 1 it is Wallstedt's bar, with dim 2 the axis-aligned displacement of P. C. Wallstedt and J. E. Guilkey, An
   evaluation of explicit time integration schemes for use with the generalized interpolation material point method
   (2008), section 5.2.

   vortex: a ring of radius R = 1 and width w = 1/2 around the middle turns by the angle alpha = A sin(pi t / T) h(r), with
   h = 1 - 8 s^2 + 16 s^4, s = (r - R) / w, and T = 1. At its edges h and dh/dr are 0, so that the material beyond them,
   if there is any, is at rest. With e1 and e2 the directions along and across the turned radius, J = 1 and

     P = mu r alpha' (e2 E_r + e1 E_theta)
     b = [r alpha_tt - mu / rho0 (3 alpha' + r alpha'')] e2 + [mu / rho0 r alpha'^2 - r alpha_t^2] e1

   K. Kamojjala, R. Brannon, A. Sadeghirad, J. Guilkey, Verification tests in solid mechanics (2015), section 5.
*/
#include "scene/solution.h"
#include <math.h>
#include <string.h>

/* R, w and T, in the units of the scene */
#define RADIUS 1.0
#define WIDTH 0.5
#define PERIOD 1.0

/* ---- manufactured ---- */

/* The displacement along a direction without its amplitude, and its derivatives by X, by X twice, and by t. */
typedef struct {
  PetscReal u, u_X, u_XX, u_t, u_tt;
} Displaced;

static Displaced DisplacedAt(const MpmScene *scene, PetscInt a, PetscReal X, PetscReal t)
{
  const PetscReal K = 2 * PETSC_PI / scene->length[a], omega = K * scene->wave_speed;
  const PetscReal A = (a == 1 ? -1 : 1) * scene->amplitude;

  return (Displaced){.u    = A * sin(K * X) * sin(omega * t),
                     .u_X  = A * K * cos(K * X) * sin(omega * t),
                     .u_XX = -A * K * K * sin(K * X) * sin(omega * t),
                     .u_t  = A * omega * sin(K * X) * cos(omega * t),
                     .u_tt = -A * omega * omega * sin(K * X) * sin(omega * t)};
}

static void ManufacturedExact(const MpmScene *scene, const PetscReal X[], const PetscReal x[], PetscReal t,
                              MpmSolutionState *state)
{
  const PetscInt dim = scene->layout.dim;

  (void)x;
  for (PetscInt c = 0; c < dim * dim; c++) state->stretch[c] = 0;
  for (PetscInt a = 0; a < dim; a++) {
    const Displaced d = DisplacedAt(scene, a, X[a], t);

    state->place[a]             = X[a] + d.u;
    state->velocity[a]          = d.u_t;
    state->stretch[a * dim + a] = 1 + d.u_X;
  }
}

/* dP_aa/dF_aa = (dtau_aa - tau_aa / F_aa) / F_aa, in units of rho0 c^2. */
static PetscReal Slope(const MpmScene *scene, PetscInt a, const PetscReal F[])
{
  const PetscInt   dim = scene->layout.dim, pair = a * dim - a * (a - 1) / 2;
  PetscReal        dF[MPM_MAX_DIM * MPM_MAX_DIM] = {0}, tau[6], dtau[6];
  const PetscReal *f[MPM_MAX_DIM * MPM_MAX_DIM], *df[MPM_MAX_DIM * MPM_MAX_DIM];
  PetscReal       *t[6], *dt[6];

  dF[a * dim + a] = 1;
  for (PetscInt c = 0; c < dim * dim; c++) {
    f[c]  = &F[c];
    df[c] = &dF[c];
  }
  for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++) {
    t[c]  = &tau[c];
    dt[c] = &dtau[c];
  }
  MpmMaterialStress(&scene->scheme.space.material, dim, 1, f, t);
  MpmMaterialTangent(&scene->scheme.space.material, dim, 1, f, df, dt);
  return (dtau[pair] - tau[pair] / F[a * dim + a]) / F[a * dim + a];
}

static void ManufacturedForce(const MpmScene *scene, const PetscReal X[], PetscReal t, PetscReal force[])
{
  MpmSolutionState state;

  ManufacturedExact(scene, X, NULL, t, &state);
  for (PetscInt a = 0; a < scene->layout.dim; a++) {
    const Displaced d = DisplacedAt(scene, a, X[a], t);

    force[a] = d.u_tt - PetscSqr(scene->wave_speed) * Slope(scene, a, state.stretch) * d.u_XX;
  }
}

static void ManufacturedSizes(const MpmScene *scene, PetscReal size[3])
{
  const PetscReal K = 2 * PETSC_PI / scene->length[0];

  size[0] = scene->amplitude;
  size[1] = K * scene->amplitude * scene->wave_speed;
  size[2] = K * scene->amplitude;
}

static PetscReal Forever(const MpmScene *scene)
{
  (void)scene;
  return PETSC_MAX_REAL;
}

static PetscErrorCode ManufacturedCheck(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < scene->layout.dim; a++) {
    const MpmEnd *ends = scene->layout.grid[a].ends;

    MpmSettingsRefuseIf(2 * PETSC_PI * scene->amplitude >= scene->length[a], settings, "amplitude",
                        "the material would be compressed to nothing; allowed: less than length / (2 pi)");
    MpmSettingsRefuseIf(ends[0] == MPM_FREE || ends[1] == MPM_FREE, settings, "boundary",
                        "nothing holds a free end; allowed: periodic or walls");
    MpmSettingsRefuseIf(scene->layout.dim > 1 && (ends[0] == MPM_FIXED || ends[0] == MPM_FIXED_REACTION ||
                                                  ends[1] == MPM_FIXED || ends[1] == MPM_FIXED_REACTION),
                        settings, "boundary", "the material slides along the walls; allowed: periodic or symmetry");
  }
  MpmSettingsRefuseIf(!MpmLayoutIsFull(&scene->layout), settings, "initial",
                      "its exact solution fills the domain; allowed: without fill and shape");
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmSolution MpmManufacturedBar = {.initial   = MPM_INITIAL_MANUFACTURED,
                                        .any       = PETSC_TRUE,
                                        .least     = 1,
                                        .most      = MPM_MAX_DIM,
                                        .equations = "rho0 x_tt = div P + rho0 b, x = X + A sin(2 pi X) sin(2 pi c t)",
                                        .exact     = ManufacturedExact,
                                        .force     = ManufacturedForce,
                                        .sizes     = ManufacturedSizes,
                                        .end       = Forever,
                                        .check     = ManufacturedCheck};

/* ---- vortex ---- */

/* A particle at rest, from the middle, and its angle with the derivatives by r and by t. */
typedef struct {
  PetscReal r, radius[2], alpha, alpha_r, alpha_rr, alpha_t, alpha_tt;
} Turned;

static Turned TurnedAt(const MpmScene *scene, const PetscReal X[], PetscReal t)
{
  const PetscReal dx = X[0] - scene->length[0] / 2, dy = X[1] - scene->length[1] / 2, r = hypot(dx, dy);
  const PetscReal w = WIDTH, s = (r - RADIUS) / w, omega = PETSC_PI / PERIOD;
  const PetscReal A = scene->amplitude, g = A * sin(omega * t), h = 1 - 8 * s * s + 16 * s * s * s * s;

  if (fabs(s) >= 0.5) return (Turned){.r = r, .radius = {r > 0 ? dx / r : 1, r > 0 ? dy / r : 0}};
  return (Turned){.r        = r,
                  .radius   = {dx / r, dy / r},
                  .alpha    = g * h,
                  .alpha_r  = g * (64 * s * s * s - 16 * s) / w,
                  .alpha_rr = g * (192 * s * s - 16) / (w * w),
                  .alpha_t  = A * omega * cos(omega * t) * h,
                  .alpha_tt = -omega * omega * g * h};
}

/* The directions along and across the turned radius. */
static void Directions(const Turned *turned, PetscReal e1[2], PetscReal e2[2])
{
  const PetscReal cosine = cos(turned->alpha), sine = sin(turned->alpha);

  e1[0] = cosine * turned->radius[0] - sine * turned->radius[1];
  e1[1] = sine * turned->radius[0] + cosine * turned->radius[1];
  e2[0] = -e1[1];
  e2[1] = e1[0];
}

static void VortexExact(const MpmScene *scene, const PetscReal X[], const PetscReal x[], PetscReal t,
                        MpmSolutionState *state)
{
  const Turned    turned    = TurnedAt(scene, X, t);
  const PetscReal across[2] = {-turned.radius[1], turned.radius[0]};
  PetscReal       e1[2], e2[2];

  (void)x;
  Directions(&turned, e1, e2);
  for (PetscInt a = 0; a < 2; a++) {
    state->place[a]    = scene->length[a] / 2 + turned.r * e1[a];
    state->velocity[a] = turned.r * turned.alpha_t * e2[a];
    for (PetscInt b = 0; b < 2; b++)
      state->stretch[a * 2 + b] =
          e1[a] * turned.radius[b] + e2[a] * (turned.r * turned.alpha_r * turned.radius[b] + across[b]);
  }
}

static void VortexForce(const MpmScene *scene, const PetscReal X[], PetscReal t, PetscReal force[])
{
  const Turned    turned = TurnedAt(scene, X, t);
  const PetscReal mu     = scene->scheme.space.material.mu * PetscSqr(scene->wave_speed);
  const PetscReal along  = turned.r * (mu * PetscSqr(turned.alpha_r) - PetscSqr(turned.alpha_t));
  const PetscReal across = turned.r * turned.alpha_tt - mu * (3 * turned.alpha_r + turned.r * turned.alpha_rr);
  PetscReal       e1[2], e2[2];

  Directions(&turned, e1, e2);
  for (PetscInt a = 0; a < 2; a++) force[a] = along * e1[a] + across * e2[a];
}

/* The largest dh/ds is 16 / (3 sqrt(3)), at s = 1 / sqrt(12). */
static void VortexSizes(const MpmScene *scene, PetscReal size[3])
{
  size[0] = scene->amplitude * RADIUS;
  size[1] = scene->amplitude * RADIUS * PETSC_PI / PERIOD;
  size[2] = scene->amplitude * RADIUS * 16 / (3 * sqrt(3) * WIDTH);
}

static PetscErrorCode VortexCheck(const MpmSettings *settings, MpmScene *scene)
{
  const MpmLayout *l = &scene->layout;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(l->row[0] * l->row[1] != l->sites || (l->shape && strcmp(l->shape, "ring")), settings, "initial",
                      "its exact solution fills the ring; allowed: without fill, and shape box or ring");
  for (PetscInt a = 0; a < 2; a++)
    MpmSettingsRefuseIf(scene->length[a] < 2 * RADIUS + WIDTH, settings, "length",
                        "the ring of the vortex needs 2.5 units of it; allowed: 2.5 or more");
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmSolution MpmVortex = {.initial   = MPM_INITIAL_VORTEX,
                               .law       = &MpmLawNeo,
                               .least     = 2,
                               .most      = 2,
                               .equations = "rho0 x_tt = div P + rho0 b, turned by alpha(r, t)",
                               .exact     = VortexExact,
                               .force     = VortexForce,
                               .sizes     = VortexSizes,
                               .end       = Forever,
                               .check     = VortexCheck};
