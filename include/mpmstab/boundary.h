/* Ends of the domain. */
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
