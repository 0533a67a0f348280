/*
   A gas at constant temperature, p = c^2 rho, in one dimension. Particles start at regular places with the density of
   their place, so that F is 1 there (MpmMaterial).

   simple_wave: v = V(x - (v + c) t), rho = exp(v / c), V = A sin(2 pi x / L). It steepens to a shock at t = L / (2 pi A).

   shock_tube: at rest, of density 1 left of the middle and 1/8 right of it. A rarefaction runs to the left and a shock to
   the right, and between them density rho* and velocity u* satisfy

     u* = c ln(1 / rho*) = c (rho* - ratio) / sqrt(rho* ratio),     shock speed c sqrt(rho* / ratio)

   R. J. LeVeque, Finite Volume Methods for Hyperbolic Problems (2002), section 14.5 and exercise 13.5.
*/
#include "scene/material.h"
#include "scene/solution.h"
#include <math.h>

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

const MpmSolution MpmSimpleWave = {.initial   = MPM_INITIAL_SIMPLE_WAVE,
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

const MpmSolution MpmShockTube = {.initial   = MPM_INITIAL_SHOCK_TUBE,
                                  .law       = &MpmLawGas,
                                  .least     = 1,
                                  .most      = 1,
                                  .equations = "rho_t + (rho v)_x = 0, (rho v)_t + (rho v^2 + c^2 rho)_x = 0",
                                  .density   = PETSC_TRUE,
                                  .exact     = ShockTubeExact,
                                  .sizes     = ShockTubeSizes,
                                  .end       = ShockTubeEnd,
                                  .check     = ShockTubeCheck};
