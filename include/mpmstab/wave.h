/*
   The continuous problems behind the formulations, and their exact solutions. X = x - U0 t is the Lagrangian coordinate
   on a domain that is periodic or has two ends in each direction. src/scheme/wave.c has the formulas.
*/
#pragma once
#include <mpmstab/boundary.h>

#define MPM_NONE -1         /* no field, no register */
#define MPM_STRETCHED -3    /* the stretch F of particles at finite deformation */
#define MPM_DISPLACEMENT -2 /* the displacement of particles in cells, a field that a prestress adds to all others */

/*E
   MpmInitial - the initial data of a run.

   MPM_INITIAL_MODE      - a Fourier mode
   MPM_INITIAL_RANDOM    - random numbers, hashed from the ids of the particles
   MPM_INITIAL_PULSE     - a Gaussian pulse that travels to the right
   MPM_INITIAL_EIGENMODE - an eigenvector that the task spectrum has written
   MPM_INITIAL_STEP      - a bar at rest, whose free end is loaded from time 0 on

   At finite strain (src/scene/solution.c):

   MPM_INITIAL_MANUFACTURED - a standing wave of large amplitude, which a body force makes exact
   MPM_INITIAL_VORTEX       - a ring that turns, by more in its middle than at its edges; in the plane
   MPM_INITIAL_SIMPLE_WAVE  - a wave in a gas that steepens
   MPM_INITIAL_SHOCK_TUBE   - a gas at rest, 8 times denser left of the middle than right of it
   MPM_INITIAL_COLLISION    - what is left of the middle of the domain has the velocity of the scene, and what is right
                              of it the opposite
   MPM_INITIAL_UNIFORM      - at rest, or with the velocity of the scene
E*/
typedef enum {
  MPM_INITIAL_MODE,
  MPM_INITIAL_RANDOM,
  MPM_INITIAL_PULSE,
  MPM_INITIAL_EIGENMODE,
  MPM_INITIAL_STEP,
  MPM_INITIAL_MANUFACTURED,
  MPM_INITIAL_VORTEX,
  MPM_INITIAL_SIMPLE_WAVE,
  MPM_INITIAL_SHOCK_TUBE,
  MPM_INITIAL_COLLISION,
  MPM_INITIAL_UNIFORM
} MpmInitial;
extern const char *const MpmInitialNames[];

/* Not collective. Whether the exact solution of the linear problem from these initial data is known. */
static inline PetscBool MpmInitialHasExact(MpmInitial initial)
{
  return initial == MPM_INITIAL_MODE || initial == MPM_INITIAL_PULSE || initial == MPM_INITIAL_STEP ? PETSC_TRUE
                                                                                                    : PETSC_FALSE;
}

/*E
   MpmPolarisation - which way the material of a momentum scheme moves in a mode, with more than one dimension.

   MPM_P_WAVE - along the wave, with speed c
   MPM_S_WAVE - across it, with speed c sqrt(mu), where mu = (1 - 2 nu) / (2 (1 - nu)). In three dimensions it moves in
                the plane of x and y, and along x when the wave is along z.
E*/
typedef enum { MPM_P_WAVE, MPM_S_WAVE } MpmPolarisation;
extern const char *const MpmPolarisationNames[];

/*S
   MpmPlaneWave - one of the plane waves that a mode is the sum of.

   normal    - the unit vector along the wave
   direction - the unit vector along which the material moves; not used for a scalar
   weight    - what it is multiplied by
S*/
typedef struct {
  PetscReal normal[MPM_MAX_DIM], direction[MPM_MAX_DIM], weight;
} MpmPlaneWave;

#define MPM_MAX_WAVES 4 /* a plane wave, and its mirror images in two directions */

/*S
   MpmProfile - the parameters of an exact solution. Lengths and times are in the units of the scene.

   initial    - the initial data
   dim        - the number of space dimensions; a pulse and a step are of one
   length     - L of direction 0
   wave_speed - c
   cell_width - h
   amplitude  - A, the amplitude of the velocity; for a pulse in a second-order problem, that of the displacement
   poisson    - Poisson's ratio; 1/2 where the stress is one number
   speed      - the speed of a mode: c, or that of S waves
   wavenumber - abs(K) of a mode
   decay      - the part of the velocity that a mode of a momentum scheme loses per time, by damping and viscosity
   phase      - the phase of a mode at X = 0
   nwaves, wave - the plane waves of a mode: one in a periodic domain and along a direction with ends, and its mirror
                images otherwise. 0 when there is no such mode between the ends of the domain.
   image      - image[end]: the sign of the velocities in the mirror image of a pulse beyond an end; -1 for a fixed end,
                1 for a free one, 0 in a periodic domain
S*/
typedef struct {
  MpmInitial   initial;
  PetscInt     dim, nwaves;
  PetscReal    length, wave_speed, cell_width, amplitude, poisson, speed, wavenumber, decay, phase, image[2];
  MpmPlaneWave wave[MPM_MAX_WAVES];
} MpmProfile;

/*S
   MpmWave - a continuous problem.

   equations     - as text, in one dimension
   equations_nd  - and in more
   value         - the exact value of a component of a field at (X, t)
   amplitude     - the size of a field's components; their errors are relative to it
   velocity_unit - the number that turns the fields of a formulation's energy terms into velocities, so that half their
                   squares is energy per density

   Fields have the numbers of the formulation's particle fields, and components those of MpmTable. Field MPM_NONE of a
   first-order problem is the affine part that some transfers give to velocities, h times the gradient. Field
   MPM_DISPLACEMENT is c / h times the integral of the velocity.

   Not collective: value, amplitude and velocity_unit.
S*/
typedef struct {
  const char *equations, *equations_nd;
  PetscReal (*value)(const MpmProfile *profile, PetscInt field, PetscInt component, const PetscReal X[], PetscReal t);
  PetscReal (*amplitude)(const MpmProfile *profile, PetscInt field);
  PetscReal (*velocity_unit)(const MpmProfile *profile);
} MpmWave;

extern const MpmWave MpmWaveFirstOrder; /* gas: u_t = c grad r, r_t = c div u with r = -(c/rho0) rho */
extern const MpmWave
    MpmWaveMomentum; /* velocity and stress: v_t = c div s, s_t = c C:grad v with s = sigma / (rho0 c) */
extern const MpmWave MpmWaveSecondOrder; /* the bar: u_t = (c/h) w, w_t = h c div grad u with w = v h / c */
