/*
   What laws that flow have in common: a law's file says how it flows along principal axes (MpmPlastic), and these
   functions do the rest. An isotropic law flows along the principal axes of the trial value (plastic.c). Where back
   does not come to the yield surface it sets q to NaN; F then stays the trial value, and the march ends
   (march/finite.c).
*/
#pragma once
#include <mpmstab/material.h>
#include <math.h>

#define MPM_ON_SURFACE 1e-11 /* a trial value that is so near to the yield surface is on it */

/* Not collective. The functions of MpmLaw of all laws that flow, MpmMaterialReturn and MpmMaterialReturnTangent. */
void      MpmPlasticStress(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                           PetscReal *const tau[]);
void      MpmPlasticTangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                            const PetscReal *const dF[], PetscReal *const dtau[]);
void      MpmPlasticEnergy(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, const PetscReal *const F[],
                           PetscReal psi[]);
void      MpmPlasticReturn(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, PetscReal *const F[]);
PetscInt  MpmPlasticReturnTangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, MpmBranch branch,
                                  const PetscReal *const F[], const PetscReal *const dF[], PetscReal *const after[]);
PetscReal MpmPlasticModulus(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[]);

/* dev e, and its norm */
static inline PetscReal MpmDeviator(const PetscReal e[3], PetscReal dev[3])
{
  for (PetscInt a = 0; a < 3; a++) dev[a] = e[a] - (e[0] + e[1] + e[2]) / 3;
  return sqrt(dev[0] * dev[0] + dev[1] * dev[1] + dev[2] * dev[2]);
}

/*
   Not collective. Hencky's solid, linear in the logarithms of the stretches: its stresses, their slopes, and its
   energy.
*/
void      MpmHenckyStress(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q, PetscReal T[3],
                          PetscReal slope[3][4]);
PetscReal MpmHenckyEnergy(const MpmMaterialNumbers *m, const PetscReal e[3], PetscReal q);

#define MPM_PLASTIC_FUNCTIONS                                                                                          \
  .solid = PETSC_TRUE, .stress = MpmPlasticStress, .tangent = MpmPlasticTangent, .energy = MpmPlasticEnergy
