/* Parts that formulations and their closed forms share. */
#pragma once
#include <mpmstab/formulation.h>

/* Not collective. The larger abs of the roots of G^2 - trace G + det = 0. */
PetscReal MpmQuadraticRadius(double complex trace, double complex det);

/* The energy of velocity and stress, the first two particle fields. */
extern const MpmEnergyTerm MpmMomentumEnergy[2];

/* The initialisers that formulations of velocity v and stress s share, with the table of a file, or another. */
/* clang-format off */
#define MOMENTUM MOMENTUM_OF(ops)
#define MOMENTUM_OF(table)                                                                                             \
  .particle_fields = {"v", "s"}, .particle_ranks = {MPM_VECTOR, MPM_TENSOR}, .node_fields = {"v_i", "a_i"},            \
  .node_ranks = {MPM_VECTOR, MPM_VECTOR}, .nops = PETSC_STATIC_ARRAY_LENGTH(table), .ops = table, MOMENTUM_PROBLEM

/* What they share besides fields and table. */
#define MOMENTUM_PROBLEM                                                                                               \
  .affine = V, .conserved = V, .free_ends = PETSC_TRUE, .materials = PETSC_TRUE,                                       \
  .nenergy = PETSC_STATIC_ARRAY_LENGTH(MpmMomentumEnergy),                                                             \
  .energy = MpmMomentumEnergy, .wave = &MpmWaveMomentum
/* clang-format on */
