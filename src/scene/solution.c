/* The exact solutions at finite strain, and which scenes have them. */
#include "scene/material.h"
#include "scene/solution.h"
#include <math.h>
#include <string.h>

/*
   A gas at constant temperature, p = c^2 rho, in one dimension. Particles start at regular places with the density of
   their place, so that F is 1 there (MpmMaterial).

   simple_wave: v = V(x - (v + c) t), rho = exp(v / c), V = A sin(2 pi x / L). It steepens to a shock at t = L / (2 pi
   A).

   shock_tube: at rest, of density 1 left of the middle and 1/8 right of it. A rarefaction runs to the left and a shock
   to the right, and between them density rho* and velocity u* satisfy

     u* = c ln(1 / rho*) = c (rho* - ratio) / sqrt(rho* ratio),     shock speed c sqrt(rho* / ratio)

   R. J. LeVeque, Finite Volume Methods for Hyperbolic Problems (2002), section 14.5 and exercise 13.5.
*/

#define NEWTON_STEPS 50
#define RATIO 0.125 /* of the densities in the shock tube */

/* The profile V and its derivative. */
static PetscReal Profile(const MpmScene *scene, PetscReal x, PetscReal *slope)
{
  const PetscReal K = 2 * PETSC_PI / scene->length[0];

  *slope = scene->amplitude * K * cos(K * x);
  return scene->amplitude * sin(K * x);
}

/* Velocity relative to c from density relative to the start: the state of a gas particle. F = rho(start) / rho(now). */
static void SetGas(const MpmScene *scene, const PetscReal X[], const PetscReal x[], PetscReal velocity,
                   PetscReal density, MpmSolutionState *state)
{
  state->place[0]    = x[0];
  state->velocity[0] = velocity;
  state->stretch[0]  = MpmMaterialDensity(&scene->layout, (PetscReal[]){X[0] / scene->cell_width}) / density;
}

/* Newton's method for v, whose equation has one root before the shock. */
static void SimpleWaveExact(const MpmScene *scene, const PetscReal X[], const PetscReal x[], PetscReal t,
                            MpmSolutionState *state)
{
  const PetscReal c  = scene->wave_speed;
  PetscReal       lo = -scene->amplitude, hi = scene->amplitude, v = 0;

  for (PetscInt k = 0; k < NEWTON_STEPS; k++) {
    PetscReal       slope;
    const PetscReal rest = v - Profile(scene, x[0] - (v + c) * t, &slope), next = v - rest / (1 + slope * t);

    if (rest > 0)
      hi = v;
    else
      lo = v;
    if (next == v) break;
    v = next > lo && next < hi ? next : (lo + hi) / 2;
  }
  SetGas(scene, X, x, v, exp(v / c), state);
}

static void SimpleWaveSizes(const MpmScene *scene, PetscReal size[3])
{
  size[0] = scene->length[0];
  size[1] = scene->amplitude;
  size[2] = scene->amplitude / scene->wave_speed;
}

/* When the wave breaks. */
static PetscReal SimpleWaveEnd(const MpmScene *scene)
{
  return scene->length[0] / (2 * PETSC_PI * scene->amplitude);
}

/* Particles of a gas whose density at rest is that of the initial data, and so is the stiffness rho c^2. */
static void SetDensity(MpmScene *scene, MpmMaterialKind kind, PetscReal ratio)
{
  MpmMaterial *m = &scene->layout.material;

  *m                             = (MpmMaterial){.kind = kind, .density = ratio, .stiffness = ratio};
  m->inclusion[0][0]             = scene->layout.grid[0].cells / 2.0;
  m->inclusion[0][1]             = scene->layout.grid[0].cells;
  scene->layout.varies[MPM_MASS] = scene->layout.varies[MPM_STIFFNESS] = PETSC_TRUE;
}

static PetscErrorCode SimpleWaveCheck(const MpmSettings *settings, MpmScene *scene)
{
  PetscFunctionBegin;
  MpmSettingsRefuseIf(!MpmSceneIsPeriodic(scene), settings, "boundary", "the wave goes round; allowed: periodic");
  MpmSettingsRefuseIf(!MpmLayoutIsFull(&scene->layout), settings, "initial",
                      "its exact solution fills the domain; allowed: without fill");
  SetDensity(scene, MPM_MATERIAL_WAVE, exp(scene->amplitude / scene->wave_speed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const MpmSolution simple_wave = {.initial   = MPM_INITIAL_SIMPLE_WAVE,
                                        .law       = &MpmLawGas,
                                        .least     = 1,
                                        .most      = 1,
                                        .equations = "rho_t + (rho v)_x = 0, v_t + v v_x = -c^2 rho_x / rho",
                                        .density   = PETSC_TRUE,
                                        .exact     = SimpleWaveExact,
                                        .sizes     = SimpleWaveSizes,
                                        .end       = SimpleWaveEnd,
                                        .check     = SimpleWaveCheck};

/* ln(1 / rho*) falls with rho*, and the other side rises with it. */
MpmRiemann MpmRiemannSolve(PetscReal ratio)
{
  PetscReal lo = ratio, hi = 1;

  for (PetscInt k = 0; k < 2 * NEWTON_STEPS; k++) {
    const PetscReal density = (lo + hi) / 2;

    if (-log(density) > (density - ratio) / sqrt(density * ratio))
      lo = density;
    else
      hi = density;
  }
  return (MpmRiemann){ratio, lo, -log(lo), sqrt(lo / ratio)};
}

static void ShockTubeExact(const MpmScene *scene, const PetscReal X[], const PetscReal x[], PetscReal t,
                           MpmSolutionState *state)
{
  const MpmRiemann riemann = MpmRiemannSolve(RATIO);
  const PetscReal  c = scene->wave_speed, from = x[0] - scene->length[0] / 2;
  const PetscReal  place = t > 0 ? from / (c * t) : (from < 0 ? -PETSC_MAX_REAL : PETSC_MAX_REAL);

  if (place < -1)
    SetGas(scene, X, x, 0, 1, state);
  else if (place < riemann.velocity - 1)
    SetGas(scene, X, x, c * (place + 1), exp(-place - 1), state);
  else if (place < riemann.shock)
    SetGas(scene, X, x, c * riemann.velocity, riemann.density, state);
  else
    SetGas(scene, X, x, 0, riemann.ratio, state);
}

static void ShockTubeSizes(const MpmScene *scene, PetscReal size[3])
{
  size[0] = scene->length[0];
  size[1] = MpmRiemannSolve(RATIO).velocity * scene->wave_speed;
  size[2] = 1;
}

/* When the shock comes to the end. */
static PetscReal ShockTubeEnd(const MpmScene *scene)
{
  return scene->length[0] / (2 * scene->wave_speed * MpmRiemannSolve(RATIO).shock);
}

static PetscErrorCode ShockTubeCheck(const MpmSettings *settings, MpmScene *scene)
{
  const MpmEnd *ends = scene->layout.grid[0].ends;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(!MpmEndIsFixed(ends[0]) || !MpmEndIsFixed(ends[1]), settings, "boundary",
                      "walls hold the pressure; allowed: fixed, fixed_reaction or symmetry");
  MpmSettingsRefuseIf(!MpmLayoutIsFull(&scene->layout), settings, "initial",
                      "its exact solution fills the domain; allowed: without fill");
  SetDensity(scene, MPM_MATERIAL_TWO, RATIO);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const MpmSolution shock_tube = {.initial   = MPM_INITIAL_SHOCK_TUBE,
                                       .law       = &MpmLawGas,
                                       .least     = 1,
                                       .most      = 1,
                                       .equations = "rho_t + (rho v)_x = 0, (rho v)_t + (rho v^2 + c^2 rho)_x = 0",
                                       .density   = PETSC_TRUE,
                                       .exact     = ShockTubeExact,
                                       .sizes     = ShockTubeSizes,
                                       .end       = ShockTubeEnd,
                                       .check     = ShockTubeCheck};

/*
   Solids with a body force that makes a chosen motion an exact solution.

   manufactured: u_a = +-A sin(2 pi X_a / L_a) sin(2 pi c t / L_a), with the minus sign along y. F is diagonal and F_aa
   depends on X_a alone, so the force per mass along a is

     b_a = d2u_a/dt2 - c^2 dP_aa/dF_aa dF_aa/dX_a

   With dim 1 it is Wallstedt's bar, with dim 2 the axis-aligned displacement of P. C. Wallstedt and J. E. Guilkey, An
   evaluation of explicit time integration schemes for use with the generalized interpolation material point method
   (2008), section 5.2.

   vortex: a ring of radius R = 1 and width w = 1/2 around the middle turns by the angle alpha = A sin(pi t / T) h(r),
   with h = 1 - 8 s^2 + 16 s^4, s = (r - R) / w, and T = 1. At its edges h and dh/dr are 0, so that the material beyond
   them, if there is any, is at rest. With e1 and e2 the directions along and across the turned radius, J = 1 and

     P = mu r alpha' (e2 E_r + e1 E_theta) b = [r alpha_tt - mu / rho0 (3 alpha' + r alpha'')] e2 + [mu / rho0 r
     alpha'^2 - r alpha_t^2] e1

   K. Kamojjala, R. Brannon, A. Sadeghirad, J. Guilkey, Verification tests in solid mechanics (2015), section 5.
*/

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
  const PetscInt dim = scene->layout.dim, pair = a * dim - a * (a - 1) / 2;
  PetscReal      dF[MPM_MOST_STRETCH] = {0}, tau[6], dtau[6];

  dF[a * dim + a] = 1;
  MpmMaterialOne(&scene->scheme.space.material, dim, F, dF, tau, dtau);
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

static const MpmSolution manufactured_bar = {.initial = MPM_INITIAL_MANUFACTURED,
                                             .any     = PETSC_TRUE,
                                             .least   = 1,
                                             .most    = MPM_MAX_DIM,
                                             .equations =
                                                 "rho0 x_tt = div P + rho0 b, x = X + A sin(2 pi X) sin(2 pi c t)",
                                             .exact = ManufacturedExact,
                                             .force = ManufacturedForce,
                                             .sizes = ManufacturedSizes,
                                             .end   = Forever,
                                             .check = ManufacturedCheck};

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

static const MpmSolution vortex = {.initial   = MPM_INITIAL_VORTEX,
                                   .law       = &MpmLawNeo,
                                   .least     = 2,
                                   .most      = 2,
                                   .equations = "rho0 x_tt = div P + rho0 b, turned by alpha(r, t)",
                                   .exact     = VortexExact,
                                   .force     = VortexForce,
                                   .sizes     = VortexSizes,
                                   .end       = Forever,
                                   .check     = VortexCheck};

/* ---- all of them ---- */

static const MpmSolution *const solutions[] = {&manufactured_bar, &vortex, &simple_wave, &shock_tube};

static const MpmSolution *Find(MpmInitial initial)
{
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(solutions); s++)
    if (solutions[s]->initial == initial) return solutions[s];
  return NULL;
}

const MpmSolution *MpmSolutionOf(const MpmScene *scene)
{
  return scene->scheme.space.finite ? Find(scene->initial) : NULL;
}

/* The velocity's gradient da v_b in cells, in units of c. */
static PetscReal Gradient(const MpmScene *scene, const PetscReal X[], PetscInt a, PetscInt b, PetscReal t)
{
  const MpmSolution *solution = MpmSolutionOf(scene);
  PetscReal          velocity[2];

  for (int side = 0; side < 2; side++) {
    PetscReal        beside[MPM_MAX_DIM];
    MpmSolutionState state;

    memcpy(beside, X, sizeof(PetscReal) * (size_t)scene->layout.dim);
    beside[b] += (side ? -0.5 : 0.5) * scene->cell_width;
    solution->exact(scene, beside, beside, t, &state);
    velocity[side] = state.velocity[a];
  }
  return (velocity[0] - velocity[1]) / scene->wave_speed;
}

PetscReal MpmSolutionRegister(const MpmScene *scene, PetscInt r, const PetscReal X[], const PetscReal x[], PetscReal t)
{
  const MpmTable       *table      = scene->scheme.table;
  const MpmFormulation *f          = scene->scheme.formulation;
  const PetscBool       is_stretch = table->field[r] == MPM_STRETCHED ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt        component = table->component[r], dim = scene->layout.dim;
  MpmSolutionState      state;

  if (scene->stagger && is_stretch == (f->particle_ranks[f->staggered] == MPM_TENSOR)) t -= scene->dt / 2;
  if (table->field[r] == MPM_NONE)
    return Gradient(scene, X, (r - table->affine_part) / dim, (r - table->affine_part) % dim, t);
  MpmSolutionOf(scene)->exact(scene, X, x, t, &state);
  return is_stretch ? state.stretch[component] : state.velocity[component] / scene->wave_speed;
}

/* ---- which scenes have them ---- */

static PetscErrorCode CheckSpace(const MpmSettings *settings, const MpmScene *scene, const MpmSolution *s)
{
  const MpmLayout *l = &scene->layout;

  PetscFunctionBegin;
  MpmSettingsRefuseIf(l->dim < s->least || l->dim > s->most, settings, "initial",
                      s->most == 1 ? "its exact solution is of one dimension; allowed: dim 1"
                                   : "its exact solution is of the plane; allowed: dim 2");
  MpmSettingsRefuseIf(!s->any && scene->law != s->law, settings, "initial",
                      s->law == &MpmLawNeo ? "its exact solution is of another material; allowed: material neo"
                                           : "its exact solution is of another material; allowed: material gas");
  MpmSettingsRefuseIf(s->any && (!scene->law->solid || scene->law->plastic), settings, "initial",
                      "it is of a solid; allowed: material uniform, neo or svk");
  for (PetscInt a = 0; a < l->dim; a++) {
    MpmSettingsRefuseIf(scene->stretch[a] != 1, settings, "initial",
                        "its exact solution starts from rest; allowed: stretch 1");
    MpmSettingsRefuseIf(scene->step.drift[a].value != 0 || scene->gravity[a] != 0, settings, "initial",
                        "its exact solution is without drift, velocity and gravity; allowed: none of them");
  }
  MpmSettingsRefuseIf(l->counts.n > 1, settings, "initial", "allowed: with ppc, and not with counts");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSettingsReadSolution(const MpmSettings *settings, MpmScene *scene)
{
  const MpmSolution *s = Find(scene->initial);

  PetscFunctionBegin;
  if (!s) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(CheckSpace(settings, scene, s));
  PetscCall(s->check(settings, scene));
  scene->body_force = s->force;
  if (s->force) scene->scheme.space.loaded = PETSC_TRUE;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- errors ---- */

PetscInt MpmSceneErrorFields(const MpmScene *scene, const char *name[])
{
  static const char *const places[] = {"x", "y", "z"};
  const MpmSolution       *s        = MpmSolutionOf(scene);
  const MpmTable          *table    = scene->scheme.table;
  PetscInt                 n        = 0;

  for (PetscInt a = 0; s && !s->density && a < scene->layout.dim; a++) name[n++] = places[a];
  for (PetscInt r = 0; r < table->nstate; r++) {
    if (s && table->field[r] == MPM_NONE) continue;
    name[n++] = s && s->density && table->field[r] == MPM_STRETCHED ? "rho" : table->fields[r];
  }
  return n;
}
