/*
   The continuous problems behind the formulations and their exact solutions, in the Lagrangian coordinate
   X = x - U0 t on a domain of length L, periodic or between ends.
*/
#pragma once
#include <mpmstab/compat.h>

/*
   Initial data: a Fourier mode, numbers hashed from the particle's id, a travelling pulse, an eigenvector that the task
   spectrum has written, a bar that is loaded at its free end from time 0 on.
*/
typedef enum {
  MPM_INITIAL_MODE,
  MPM_INITIAL_RANDOM,
  MPM_INITIAL_PULSE,
  MPM_INITIAL_EIGENMODE,
  MPM_INITIAL_STEP
} MpmInitial;
extern const char *const MpmInitialNames[];

/* Not collective. Whether the continuous problem's solution from these data is known. */
static inline PetscBool MpmInitialHasExact(MpmInitial initial)
{
  return initial != MPM_INITIAL_RANDOM && initial != MPM_INITIAL_EIGENMODE ? PETSC_TRUE : PETSC_FALSE;
}

/*S
   MpmProfile - which exact solution: its shape and its numbers.

   length L, wave_speed c, cell_width h, amplitude A, wavenumber K, phase of the mode at X = 0. image[end]: the sign
   that velocities have in the mirror image of a pulse beyond an end, -1 fixed, 1 free, 0 for a periodic domain.
S*/
typedef struct {
  MpmInitial initial;
  PetscReal  length, wave_speed, cell_width, amplitude, wavenumber, phase, image[2];
} MpmProfile;

/*S
   MpmWave - a continuous problem: the exact value of field f at (X, t), and the amplitude errors are relative
   to. Field 2 of the first-order problem is h u_x, the affine part that some transfers give to velocities.

   velocity_unit(profile) turns the fields of a formulation's energy terms into velocities, so that half their
   squares is energy per density.
S*/
typedef struct {
  const char *equations;
  PetscReal (*value)(const MpmProfile *profile, PetscInt field, PetscReal X, PetscReal t);
  PetscReal (*amplitude)(const MpmProfile *profile, PetscInt field);
  PetscReal (*velocity_unit)(const MpmProfile *profile);
} MpmWave;

extern const MpmWave MpmWaveFirstOrder;  /* u_t = c r_x, r_t = c u_x: gas */
extern const MpmWave MpmWaveMomentum;    /* the same with velocity and stress, v_t = c s_x, s_t = c v_x */
extern const MpmWave MpmWaveSecondOrder; /* u_t = (c/h) w, w_t = h c u_xx: the bar, w = v h / c */
