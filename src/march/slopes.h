/* The slopes of a particle's weights, node by node, for those who make matrices and bounds of them. */
#pragma once
#include "march/grid.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>

/*S
   MpmSlopes - how the slopes of a vector's components are found. Beyond walls nodes stand for their images, with the sign of
   the component, and a component that a wall fixes has no slope there.

   kind   - the kind of operation that has the slopes, one of GRAD, DIV, GRAD_MLS and DIV_MLS; those of DIV are found faster
   parity - parity[c]: of component c
S*/
typedef struct {
  const MpmLayout *layout;
  const MpmBasis  *basis;
  const MpmGrid   *grid;
  MpmOpKind        kind;
  const MpmParity (*parity)[MPM_MAX_DIM];
} MpmSlopes;

/* Not collective. The most nodes that MpmSlopesAt finds. */
PetscInt MpmSlopesMost(const MpmSlopes *slopes);

/*
   MpmSlopesAt - the nodes of a particle in a local cell of the grid, at xi there. Returns how many there are. With merge none
   is there twice: two of a particle's nodes may be one and the same, at a wall or in a short periodic grid.

   Not collective.

   Output Parameters:
+  node  - indices in a local array, from its node 0
.  shape - phi of each node
-  slope - slope[(node dim + component) dim + direction], in units of 1 / h
*/
PetscInt MpmSlopesAt(const MpmSlopes *slopes, PetscBool merge, const PetscInt cell[], const PetscReal xi[],
                     PetscInt node[], PetscReal shape[], PetscReal slope[]);
