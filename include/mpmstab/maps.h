/* The maps between particles and nodes as a table's readers ask for them: by operation and basis. */
#pragma once
#include <mpmstab/basis.h>
#include <mpmstab/formulation.h>

#define MPM_MAX_REACH 8 /* nodes that one particle may see */

/* Not collective. How many nodes a particle sees. */
static inline PetscInt MpmMapReach(const MpmBasis *basis)
{
  return basis->reach_left + 1 + basis->reach_right;
}

/*
   MpmMapRow - the numbers that tie a particle at xi in its cell to the nodes it sees, from the one at -reach_left of
   its cell's left node on: phi_ip for P2G (undivided) and G2P, h dphi_ip/dx for GRAD. width: see kernels.h.

   Not collective. They are what the operation's kernel does to unit vectors: what is analysed is what runs.
*/
void MpmMapRow(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal width, PetscReal row[]);
