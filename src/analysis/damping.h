/*
   Damping: how fast a scheme damps waves along x, and how far their frequency is off, from the symbol.

   The physical mode of a wave is the branch of amplification factors that continues omega = c abs(beta).
*/
#pragma once
#include "scene/request.h"

/*S
   MpmDamping - decay and frequency of waves along x, at time steps that are parts of the scene's. Particles keep their
   speed: a time step over d has its drift over d, too.

   The physical mode of a wave is the eigenvector of the symbol that is nearest to the exact wave, which travels to the
   right, at the particles: the one of largest match. The fields have the weights of the exact wave's amplitudes, and an
   affine part, which follows from the velocity, does not count. Of modes with 3/5 of the largest match it is the one
   that decays most slowly: an overdamped wave does not travel, and falls into two modes that match about equally well.

   nwaves, wavelength - the waves: phases / m cells long, for 1 <= m <= phases / 3, longest first; shorter than 3
               cells there is hardly a wave on the grid
   nsteps, divisor, courant - the time steps: the scene's over divisor, and their Courant numbers
   decay     - decay[nwaves i + w]: of wave w at time step i the decay r of the amplitude e^(-r t), t in h / c; negative
               when it grows
   frequency - frequency[nwaves i + w]: the frequency over the exact one, minus 1, for an observer who moves with the
               particles. -1: it does not travel
   match     - match[nwaves i + w]: the square of the cosine of the angle between the mode and the exact wave, from 0 to
               1. Below 1/2 another field or wave prevails in the mode.
   seconds   - the time that the computation took

   Source: docs/theory.md, section 4.
S*/
typedef struct {
  PetscInt        nwaves, nsteps;
  const PetscInt *divisor;
  PetscReal      *wavelength, *courant, *decay, *frequency, *match, seconds;
} MpmDamping;

/*
   MpmDampingCreate - finds the damping of the scheme of a scene, at the phases along x and the time steps of a request.

   Collective. The request must outlive it. Destroy it with MpmDampingDestroy.

   Errors: refuses (PETSC_ERR_USER_INPUT) a drift that has no short period at one of the time steps (MpmStepPeriod).
*/
PetscErrorCode MpmDampingCreate(const MpmScene *scene, const MpmRequest *request, MpmDamping **damping);
PetscErrorCode MpmDampingDestroy(MpmDamping **damping);
