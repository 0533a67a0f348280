/* Boundary: the conditions at the ends of the domain, and the mirror images that stand for nodes beyond them. */
#pragma once
#include <mpmstab/compat.h>

/*E
   MpmEnd - the condition at an end of the domain.

   MPM_PERIODIC       - the domain has no ends; both ends are periodic or none is
   MPM_FIXED          - fields that a table imposes are 0 at the wall node before and after the grid update. Their
                        increment is 0 there.
   MPM_FIXED_REACTION - the wall node has the same values, but the increment that particles get is the wall's reaction:
                        new value minus the value before the wall was imposed (as in Uintah's one-dimensional code)
   MPM_FREE           - nothing is imposed

   Nodes beyond a wall are mirror images of those inside. Fields that are imposed at the wall have the other sign there,
   and all others the same sign. So every basis keeps its one shape, partition of unity and linear reproduction up to
   the wall; a fixed wall's velocity is 0 at the wall itself; and LAP at a free end is 2 (f_{N-1} - f_N).
E*/
typedef enum { MPM_PERIODIC, MPM_FIXED, MPM_FIXED_REACTION, MPM_FREE } MpmEnd;
extern const char *const MpmEndNames[], *const MpmEndSummaries[];

/* Not collective. Whether an end is fixed, with a reaction or without. */
static inline PetscBool MpmEndIsFixed(MpmEnd end)
{
  return end == MPM_FIXED || end == MPM_FIXED_REACTION ? PETSC_TRUE : PETSC_FALSE;
}

/*S
   MpmDirection - one direction of the grid: its numbers of cells and nodes, and the conditions at its two ends.

   A periodic direction has as many nodes as cells; between walls there is one node more.
S*/
typedef struct {
  PetscInt cells, nodes;
  MpmEnd   ends[2];
} MpmDirection;

/*
   MpmDirectionMirror - the sign of a node field beyond each end, relative to the nodes inside that are mirrored there.
   It is -1 beyond a fixed end for an antisymmetric field, which is one that is 0 at fixed ends. Else it is 1.

   Not collective.
*/
void MpmDirectionMirror(const MpmDirection *direction, PetscBool antisymmetric, PetscReal sign[2]);

/*
   MpmDirectionImage - the node of the grid that a node of the unbounded grid stands for. In a periodic direction nodes
   wrap around. A node beyond a wall is the mirror image of one inside.

   Not collective.

   Output Parameter: sign - of the image's value (see MpmDirectionMirror); 1 for a node of the grid itself
*/
PetscInt MpmDirectionImage(const MpmDirection *direction, PetscInt node, PetscBool antisymmetric, PetscReal *sign);
