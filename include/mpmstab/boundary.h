/* Boundary: what holds at the ends of the domain, and what the nodes beyond them stand for. */
#pragma once
#include <mpmstab/compat.h>

/*E
   MpmEnd - what holds at an end of the domain.

   MPM_PERIODIC       - both ends or none
   MPM_FIXED          - at the wall node what a table imposes is 0 before and after the grid update, its increment 0
   MPM_FIXED_REACTION - the same node values, but particles are handed the wall's reaction: new value minus the value
                        before the wall was imposed (as Uintah's one-dimensional code does)
   MPM_FREE           - nothing imposed

   Nodes beyond a wall are mirror images of those inside: of the other sign for fields that are imposed there, of the
   same sign for others. So every basis keeps its one shape, partition of unity and linear reproduction up to the wall,
   a fixed wall's velocity is 0 at the wall itself, and LAP at a free end is 2 (f_{N-1} - f_N).
E*/
typedef enum { MPM_PERIODIC, MPM_FIXED, MPM_FIXED_REACTION, MPM_FREE } MpmEnd;
extern const char *const MpmEndNames[], *const MpmEndSummaries[];

/* Not collective. Whether something is imposed at an end. */
static inline PetscBool MpmEndIsFixed(MpmEnd end)
{
  return end == MPM_FIXED || end == MPM_FIXED_REACTION ? PETSC_TRUE : PETSC_FALSE;
}

/*S
   MpmDirection - one direction of the grid: how many cells and nodes it has, and what holds at its two ends.

   A periodic direction has as many nodes as cells; between walls there is one node more.
S*/
typedef struct {
  PetscInt cells, nodes;
  MpmEnd   ends[2];
} MpmDirection;

/*
   MpmDirectionMirror - the sign that a node field has beyond each end, where nodes are mirror images of those inside:
   -1 beyond a fixed end for an antisymmetric field, that is one which is 0 at the wall; else 1.

   Not collective.
*/
void MpmDirectionMirror(const MpmDirection *direction, PetscBool antisymmetric, PetscReal sign[2]);

/*
   MpmDirectionImage - the node of the grid that a node of the unbounded grid stands for: in a periodic direction the
   grid's end meets its beginning; a node beyond a wall is the mirror image of one inside.

   Not collective. sign: of the image's value, 1 for a node itself (see MpmDirectionMirror).
*/
PetscInt MpmDirectionImage(const MpmDirection *direction, PetscInt node, PetscBool antisymmetric, PetscReal *sign);
