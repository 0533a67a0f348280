/* What registry.c calls of several materials. */
#pragma once
#include <mpmstab/material.h>

/* Not collective. As MpmMaterialReturn, MpmMaterialReturnTangent and MpmMaterialModulus. */
void      MpmSeveralReturn(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, PetscReal *const F[]);
PetscInt  MpmSeveralReturnTangent(const MpmMaterialNumbers *m, PetscInt dim, PetscInt n, MpmBranch branch,
                                  const PetscReal *const F[], const PetscReal *const dF[], PetscReal *const after[]);
PetscReal MpmSeveralModulus(const MpmMaterialNumbers *m, PetscInt dim, const PetscReal F[]);
