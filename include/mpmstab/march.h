/* March: the explicit loop. Reads a table's passes; knows nothing of gas or bar. */
#pragma once
#include <mpmstab/scene.h>

/* A scene in motion: its grid, its particles and the passes of a step. */
typedef struct MpmMarch_ MpmMarch;

/*
   MpmMarchCreate - grid, particles and passes for a scene, ready for the first step.

   Collective. Refuses a grid too small for the ranks.
*/
PetscErrorCode MpmMarchCreate(MPI_Comm comm, const MpmScene *scene, MpmMarch **march);
PetscErrorCode MpmMarchDestroy(MpmMarch **march);

/* Collective. One step; sample asks for the sums that MpmMarchNorms needs. */
PetscErrorCode MpmMarchStep(MpmMarch *march, PetscBool sample);

/*S
   MpmNorms - sizes of the state, in units of 2^exponent (energy: of its square).

   state: square root of the integral of the squares of all particle fields. energy: the formulation's,
   without the velocity_unit of its wave. grid: square root of the energy that the grid sees, the energy's terms
   taken on the node fields. What no node sees changes nothing, so whatever grows exponentially grows there;
   growth by rigid motion or in the null space of P2G, which is linear, does not show there.
S*/
typedef struct {
  PetscReal state, energy, grid;
} MpmNorms;

/* Collective. Valid after a sampled step, and before the first. */
PetscErrorCode MpmMarchNorms(const MpmMarch *march, MpmNorms *norms);
