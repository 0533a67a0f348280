/* Basis functions: which nodes a particle sees, and the maps written for them. */
#pragma once
#include <mpmstab/formulation.h>
#include "scheme/kernels.h"

/*S
   MpmBasis - a basis: its reach and its maps.

   A particle in cell i sees the nodes i - reach_left to i + reach_right; node i is at the left of cell i, where its
   function has its middle. slope_sum bounds h sum_i abs(dphi_ip/dx). kernel[] is by kind of operation; first_nodes
   says for particles in cells where the nodes begin that they see.
S*/
typedef struct {
  const char   *name, *summary, *reference;
  PetscInt      reach_left, reach_right;
  PetscReal     slope_sum;
  MpmKernel     kernel[MPM_OP_KINDS];
  MpmMassKernel p2g_mass;
  void (*first_nodes)(PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscInt first[]);
  PetscBool hat;  /* the slides' formulas are for this basis */
  PetscBool wide; /* its functions depend on the particle's width */
} MpmBasis;

/* Not collective. All bases, NULL-terminated. */
extern const MpmBasis *const MpmBases[];

/* Not collective. Looks a basis up by name; NULL when there is none. */
const MpmBasis *MpmBasisFind(const char name[]);

/*
   MpmBlockPlace - fills in a block of n <= MPM_BLOCK particles, of which cell[p] are the local indices of their cells.

   Not collective. xi[] must stay while the block is used.
*/
void MpmBlockPlace(const MpmBasis *basis, PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscReal half_width,
                   MpmBlock *block);
