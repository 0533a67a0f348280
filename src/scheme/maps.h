/* The maps between particles and nodes as a table's readers ask for them: by operation and basis. */
#pragma once
#include <mpmstab/basis.h>
#include <mpmstab/formulation.h>
#include <mpmstab/scene.h>

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

/*
   Not collective. The node that a node of the unbounded grid stands for: the grid's end meets its beginning, or what is
   beyond a wall is an image. *sign becomes that of the image of an odd or even field, 1 for a node itself.
*/
PetscInt MpmNodeImage(const MpmScene *scene, PetscInt node, PetscBool odd, PetscReal *sign);

/*
   Not collective. The nodes that a particle in a (global, unwrapped) cell sees, with what their values count for there:
   nodes wrap around or, beyond a wall, become their images with the sign of odd or even fields. With drop, the wall
   nodes that impose 0 count for nothing.
*/
void MpmNodesSeen(const MpmScene *scene, PetscInt cell, PetscBool odd, PetscBool drop, PetscInt node[],
                  PetscReal sign[]);
