/*
   The continuous problems behind the formulations and their exact solutions, in the Lagrangian coordinate
   X = x - U0 t on a periodic domain of length L.
*/
#pragma once
#include <mpmstab/compat.h>

/*
   Initial data: a Fourier mode, numbers hashed from the particle's id, a travelling pulse, an eigenvector that the task
   spectrum has written.
*/
typedef enum { MPM_INITIAL_MODE, MPM_INITIAL_RANDOM, MPM_INITIAL_PULSE, MPM_INITIAL_EIGENMODE } MpmInitial;
extern const char *const MpmInitialNames[];

/* Not collective. Whether the continuous problem's solution from these data is known. */
static inline PetscBool MpmInitialHasExact(MpmInitial initial)
{
  return initial == MPM_INITIAL_MODE || initial == MPM_INITIAL_PULSE ? PETSC_TRUE : PETSC_FALSE;
}

/*S
   MpmProfile - which exact solution: its shape and its numbers.

   length L, wave_speed c, cell_width h, amplitude A, wavenumber K = 2 pi mode / L.
S*/
typedef struct {
  MpmInitial initial;
  PetscReal  length, wave_speed, cell_width, amplitude, wavenumber;
} MpmProfile;

/*S
   MpmWave - a continuous problem: the exact value of field f at (X, t), and the amplitude errors are relative
   to.

   velocity_unit(profile) turns the fields of a formulation's energy terms into velocities, so that half their
   squares is energy per density.
S*/
typedef struct {
  const char *equations;
  PetscReal (*value)(const MpmProfile *profile, PetscInt field, PetscReal X, PetscReal t);
  PetscReal (*amplitude)(const MpmProfile *profile, PetscInt field);
  PetscReal (*velocity_unit)(const MpmProfile *profile);
} MpmWave;

extern const MpmWave MpmWaveFirstOrder;  /* u_t = c r_x, r_t = c u_x: gas; velocity and stress */
extern const MpmWave MpmWaveSecondOrder; /* u_t = (c/h) w, w_t = h c u_xx: the bar, w = v h / c */
