/* Parts that formulations and their closed forms share. */
#pragma once
#include <mpmstab/formulation.h>

/* Not collective. The larger abs of the roots of G^2 - trace G + det = 0. */
PetscReal MpmQuadraticRadius(double complex trace, double complex det);

/*
   Not collective. MpmStressAheadGrowth is the larger abs of the two amplification factors, and MpmStressAheadLimit is
   the largest stable Courant number. They are for schemes that update the stress from P2G of the particles' velocity,
   not from a nodal velocity that was advanced on the grid (usf, musl, usavg). With s = k^2 kappa and f = filter:

     trace = 1 + f - alpha s,    det = f

   With a prestress and x = k^2 chi, trace = 1 + f - alpha s - x and det = f - (f - alpha) x where particles move with
   the grid's velocity, and trace = 1 + f - alpha (s + x), det = f where they move with the projected one. Damping and
   viscosity take alpha k drag off trace and det.
*/
PetscReal MpmStressAheadGrowth(const MpmCellSymbols *cell, PetscReal courant);
PetscReal MpmStressAheadLimit(const MpmCellSymbols *cell);

/* Not collective. The limit with damping and viscosity of a scheme whose limit without them is the other number. */
PetscReal MpmDampedLimit(const MpmCellSymbols *cell, PetscReal limit);

/* Not collective. The step_bound of these schemes: alpha s <= 2 (1 + f) is least where alpha and f are 1. */
PetscReal MpmStressAheadBound(const MpmSchemeNumbers *numbers, const MpmTransfer *transfer);

/* The energy of velocity and stress, the first two particle fields. */
extern const MpmEnergyTerm MpmMomentumEnergy[2];

/* The initialisers that formulations of velocity v and stress s share. ops is the table of the file. */
/* clang-format off */
#define MOMENTUM                                                                                                       \
  .particle_fields = {"v", "s"}, .particle_ranks = {MPM_VECTOR, MPM_TENSOR}, .node_fields = {"v_i", "a_i"},            \
  .node_ranks = {MPM_VECTOR, MPM_VECTOR}, .nops = PETSC_STATIC_ARRAY_LENGTH(ops), .ops = ops, MOMENTUM_PROBLEM

/* What they share besides fields and table. */
#define MOMENTUM_PROBLEM                                                                                               \
  .affine = V, .conserved = V, .free_ends = PETSC_TRUE, .materials = PETSC_TRUE,                                       \
  .nenergy = PETSC_STATIC_ARRAY_LENGTH(MpmMomentumEnergy),                                                             \
  .energy = MpmMomentumEnergy, .wave = &MpmWaveMomentum

/* The closed forms of schemes that update the stress from P2G of the particles' velocity. */
#define STRESS_AHEAD                                                                                                   \
  .corrected_text = "tr = 1 + f - alpha s, det = f, s = k^2 kappa",                                                    \
  .limit_text = "alpha s <= 2 (1 + f), s = k^2 kappa", .corrected = MpmStressAheadGrowth, .limit = MpmStressAheadLimit,      \
  .mls_bound = PETSC_TRUE, .leftmost = PETSC_TRUE, .step_bound = MpmStressAheadBound
/* clang-format on */
