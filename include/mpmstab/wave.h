/*
   The continuous problems behind the formulations, and their exact solutions. X = x - U0 t is the Lagrangian coordinate
   on a domain of length L, which is periodic or has two ends. src/scheme/wave.c has the formulas.
*/
#pragma once
#include <mpmstab/compat.h>

/*E
   MpmInitial - the initial data of a run.

   MPM_INITIAL_MODE      - a Fourier mode
   MPM_INITIAL_RANDOM    - random numbers, hashed from the ids of the particles
   MPM_INITIAL_PULSE     - a Gaussian pulse that travels to the right
   MPM_INITIAL_EIGENMODE - an eigenvector that the task spectrum has written
   MPM_INITIAL_STEP      - a bar at rest, whose free end is loaded from time 0 on
E*/
typedef enum {
  MPM_INITIAL_MODE,
  MPM_INITIAL_RANDOM,
  MPM_INITIAL_PULSE,
  MPM_INITIAL_EIGENMODE,
  MPM_INITIAL_STEP
} MpmInitial;
extern const char *const MpmInitialNames[];

/* Not collective. Whether the exact solution from these initial data is known. */
static inline PetscBool MpmInitialHasExact(MpmInitial initial)
{
  return initial != MPM_INITIAL_RANDOM && initial != MPM_INITIAL_EIGENMODE ? PETSC_TRUE : PETSC_FALSE;
}

/*S
   MpmProfile - the parameters of an exact solution. Lengths and times are in the units of the scene.

   initial    - the initial data
   length     - L
   wave_speed - c
   cell_width - h
   amplitude  - A, the amplitude of the velocity; for a pulse in a second-order problem, that of the displacement
   wavenumber - K of a mode
   phase      - the phase of a mode at X = 0
   image      - image[end]: the sign of the velocities in the mirror image of a pulse beyond an end; -1 for a fixed end,
                1 for a free one, 0 in a periodic domain
S*/
typedef struct {
  MpmInitial initial;
  PetscReal  length, wave_speed, cell_width, amplitude, wavenumber, phase, image[2];
} MpmProfile;

/*S
   MpmWave - a continuous problem.

   equations     - as text
   value         - the exact value of a field at (X, t)
   amplitude     - the size of a field; errors of the field are relative to it
   velocity_unit - the number that turns the fields of a formulation's energy terms into velocities, so that half their
                   squares is energy per density

   Fields have the numbers of the formulation's particle fields. Field 2 of a first-order problem is h u_x, the affine
   part that some transfers give to velocities.

   Not collective: value, amplitude and velocity_unit.
S*/
typedef struct {
  const char *equations;
  PetscReal (*value)(const MpmProfile *profile, PetscInt field, PetscReal X, PetscReal t);
  PetscReal (*amplitude)(const MpmProfile *profile, PetscInt field);
  PetscReal (*velocity_unit)(const MpmProfile *profile);
} MpmWave;

extern const MpmWave MpmWaveFirstOrder;  /* gas: u_t = c r_x, r_t = c u_x with r = -(c/rho0) rho */
extern const MpmWave MpmWaveMomentum;    /* velocity and stress: v_t = c s_x, s_t = c v_x with s = sigma / (rho0 c) */
extern const MpmWave MpmWaveSecondOrder; /* the bar: u_t = (c/h) w, w_t = h c u_xx with w = v h / c */
