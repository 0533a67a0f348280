/* The maps between particles and nodes as a table's readers ask for them: by operation and basis. */
#pragma once
#include "scheme/kernels.h"
#include <mpmstab/formulation.h>
#include <mpmstab/boundary.h>

#define MPM_MAX_REACH 8 /* nodes that one particle may see */

/* Not collective. How many nodes a particle sees. */
static inline PetscInt MpmMapReach(const MpmBasis *basis)
{
  return basis->reach_left + 1 + basis->reach_right;
}

/*
   MpmMapRow - the numbers that tie a particle at xi in its cell to the nodes it sees, from the one at -reach_left of
   its cell's left node on: phi_ip for P2G (undivided) and G2P, h dphi_ip/dx for GRAD. half_width: see kernels.h.

   Not collective. They are what the operation's kernel does to unit vectors: what is analysed is what runs.
*/
void MpmMapRow(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal half_width, PetscReal row[]);

/*
   MpmNodesSeen - the nodes that a particle in a (global, unwrapped) cell sees, with what their values count for there:
   nodes wrap around or, beyond a wall, become their images with the sign of antisymmetric or symmetric fields. With
   drop, the wall nodes that impose 0 count for nothing.

   Not collective. node and sign have MpmMapReach entries.
*/
void MpmNodesSeen(const MpmDirection *direction, const MpmBasis *basis, PetscInt cell, PetscBool antisymmetric,
                  PetscBool drop, PetscInt node[], PetscReal sign[]);
