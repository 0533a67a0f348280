/* March: the explicit loop over time steps. It runs the operations of a table and knows nothing of gas or bar. */
#pragma once
#include <mpmstab/scene.h>

/* MpmMarch - the state of a run: a grid, particles, and the passes of a step. */
typedef struct MpmMarch_ MpmMarch;

/*
   MpmMarchCreate - makes the grid and the particles of a scene, with its initial data, ready for the first step.

   Collective. The scene must outlive the march, which is destroyed with MpmMarchDestroy. With initial data eigenmode
   the fields are 0.

   Errors: refuses (PETSC_ERR_USER_INPUT) a grid that is too small for the ranks.
*/
PetscErrorCode MpmMarchCreate(MPI_Comm comm, const MpmScene *scene, MpmMarch **march);
PetscErrorCode MpmMarchDestroy(MpmMarch **march);

/* Collective. Takes one time step. */
PetscErrorCode MpmMarchStep(MpmMarch *march);

/*S
   MpmNorms - norms of the state. With the exponent of the march, state and grid are in units of 2^exponent, and energy
   is in units of 4^exponent.

   state  - the square root of the integral of the squares of all particle fields
   energy - the formulation's energy, without the velocity_unit of its wave; NaN for a formulation without one
   grid   - the square root of the energy's terms, taken on node fields; without an energy, the node fields that
            particles are sent to. All exponential growth shows in it. Linear growth by rigid motion or in the null
            space of P2G, which is particle data that no node feels, does not.
S*/
typedef struct {
  PetscReal state, energy, grid;
} MpmNorms;

/* Collective. The norms of the state. */
PetscErrorCode MpmMarchNorms(const MpmMarch *march, MpmNorms *norms);
