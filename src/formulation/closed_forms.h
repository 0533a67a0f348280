/* What the formulations' closed forms share. */
#pragma once
#include <mpmstab/formulation.h>

/* Not collective. The larger abs of the roots of G^2 - trace G + det = 0. */
PetscReal MpmQuadraticRadius(double complex trace, double complex det);

/*
   Not collective. The larger abs of the roots, and the largest stable Courant number, for schemes whose stress sees the
   velocity it goes on with (usf, musl, usavg): with s = k^2 kappa, f = retained: trace = 1 + f - alpha s, det = f.
*/
PetscReal MpmStressAheadGrowth(const MpmCellSymbols *cell, PetscReal courant);
PetscReal MpmStressAheadLimit(const MpmCellSymbols *cell);

/* The energy of velocity and stress, the first two particle fields. */
extern const MpmEnergyTerm MpmMomentumEnergy[2];
