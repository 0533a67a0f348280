/* Boundary: the conditions at the ends of the domain, and the mirror images that stand for nodes beyond them. */
#pragma once
#include <mpmstab/compat.h>

#define MPM_MAX_DIM 3 /* the largest number of space dimensions */

/*E
   MpmEnd - the condition at an end of the domain.

   MPM_PERIODIC       - the domain has no ends; both ends are periodic or none is
   MPM_FIXED          - fields that a table imposes are 0 at the wall node before and after the grid update. Their
                        increment is 0 there.
   MPM_FIXED_REACTION - the wall node has the same values, but the increment that particles get is the wall's reaction:
                        new value minus the value before the wall was imposed (as in Uintah's one-dimensional code)
   MPM_FREE           - nothing is imposed
   MPM_SYMMETRY       - a wall along which particles slip: as MPM_FIXED for the component normal to it, and nothing is
                        imposed on the others. In one dimension it is MPM_FIXED.

   Nodes beyond a wall are mirror images of those inside, unless the basis has other functions there (MpmSplineEnds).
   Fields that are imposed at the wall have the other sign there, and all others the same sign (MpmParity). So every
   basis keeps its one shape, partition of unity and linear reproduction up to the wall; a fixed wall's velocity is 0 at
   the wall itself; and LAP at a free end is 2 (f_{N-1} - f_N).
E*/
typedef enum { MPM_PERIODIC, MPM_FIXED, MPM_FIXED_REACTION, MPM_FREE, MPM_SYMMETRY } MpmEnd;
extern const char *const MpmEndNames[], *const MpmEndSummaries[];

/* Not collective. Whether the velocity normal to an end is 0 there. */
static inline PetscBool MpmEndIsFixed(MpmEnd end)
{
  return end == MPM_FIXED || end == MPM_FIXED_REACTION || end == MPM_SYMMETRY ? PETSC_TRUE : PETSC_FALSE;
}

/*E
   MpmParity - what a node field is beyond the ends of a direction.

   MPM_EVEN       - its mirror image, at any end
   MPM_TANGENTIAL - its mirror image with the other sign at ends that are fixed, with a reaction or without. It is 0 on
                    such a wall.
   MPM_NORMAL     - the same, and also at ends of symmetry: the component of a velocity along the direction
E*/
typedef enum { MPM_EVEN, MPM_TANGENTIAL, MPM_NORMAL } MpmParity;

/* Not collective. Whether a field of a parity has the other sign beyond an end, and is 0 on it. */
static inline PetscBool MpmEndIsOdd(MpmEnd end, MpmParity parity)
{
  if (end == MPM_SYMMETRY) return parity == MPM_NORMAL ? PETSC_TRUE : PETSC_FALSE;
  return MpmEndIsFixed(end) && parity != MPM_EVEN ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. Whether a field of a parity is set to 0 on an end, without a reaction. */
static inline PetscBool MpmEndImposes(MpmEnd end, MpmParity parity)
{
  return end != MPM_FIXED_REACTION && MpmEndIsOdd(end, parity) ? PETSC_TRUE : PETSC_FALSE;
}

/*S
   MpmDirection - one direction of the grid: its numbers of cells and nodes, and the conditions at its two ends.

   A periodic direction has as many nodes as cells; between walls there are more, one for most bases (wall_nodes of
   MpmBasis).
S*/
typedef struct {
  PetscInt cells, nodes;
  MpmEnd   ends[2];
} MpmDirection;

/* Not collective. For MpmDirectionWalls: there is no wall in reach. */
extern const PetscInt MpmNoWalls[2];

/*
   MpmDirectionWalls - the first and the last node of a direction, counted from a node of its grid. In a periodic
   direction they are MpmNoWalls.

   Not collective.
*/
void MpmDirectionWalls(const MpmDirection *direction, PetscInt node, PetscInt wall[2]);

/*
   MpmDirectionMirror - the sign of a node field beyond each end, relative to the nodes inside that are mirrored there:
   -1 where MpmEndIsOdd, else 1.

   Not collective.
*/
void MpmDirectionMirror(const MpmDirection *direction, MpmParity parity, PetscReal sign[2]);

/*
   MpmDirectionImage - the node of the grid that a node of the unbounded grid stands for. In a periodic direction nodes
   wrap around. A node beyond a wall is the mirror image of one inside.

   Not collective.

   Output Parameter: sign - of the image's value (see MpmDirectionMirror); 1 for a node of the grid itself
*/
PetscInt MpmDirectionImage(const MpmDirection *direction, PetscInt node, MpmParity parity, PetscReal *sign);
