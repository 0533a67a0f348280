/* The maps between particles and nodes as rows of numbers, for those who assemble or analyse an operation. */
#pragma once
#include "scheme/kernels.h"
#include <mpmstab/formulation.h>
#include <mpmstab/boundary.h>

#define MPM_MAX_REACH (MPM_MOST_NODES + 1) /* of MpmMapReach: the first node may depend on the half of the cell */

/* Not collective. The number of nodes that a particle can have weights at. */
static inline PetscInt MpmMapReach(const MpmBasis *basis)
{
  return basis->reach_left + 1 + basis->reach_right;
}

/*
   MpmMapRow - the weights of the nodes of a particle at xi in its cell, in one direction, for one kind of operation:
   phi_ip for P2G and G2P, h dphi_ip/dx for DIV and GRAD. row[0] belongs to the node reach_left to the left of its
   cell's left node. half_width is that of MpmBlock, and wall is counted from the cell (MpmDirectionWalls).

   Not collective. The weights are those that the march has, so that what is analysed is what runs. They are not divided
   by the nodal masses. row has MpmMapReach entries.

   In more dimensions a map's weights are products over the directions: of the row of its kind in the direction that it
   acts along, and of the row of G2P, phi_ip, in the others.
*/
void MpmMapRow(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal half_width, const PetscInt wall[2],
               PetscReal row[]);

/*
   MpmNodesSeen - the nodes of a particle in a global, unwrapped cell of a direction, and the sign that multiplies their
   values. In a periodic direction nodes wrap around. Nodes beyond a wall are replaced by those that they are images of,
   with the sign that the field's parity says (MpmDirectionImage). With drop, the sign is 0 at wall nodes that are set
   to 0 (MpmEndImposes).

   Not collective. node and sign have MpmMapReach entries.
*/
void MpmNodesSeen(const MpmDirection *direction, const MpmBasis *basis, PetscInt cell, MpmParity parity, PetscBool drop,
                  PetscInt node[], PetscReal sign[]);
