/*
   Passes: a table compiled for marching. The particle operations that follow one another between two sums over the grid
   become one pass over the particles, done block by block.

   A step is cut where its particles first read the grid. The operations before (the first P2Gs) join the pass that ends
   the step before, since both go over the same particles. So gas1 and elastic need one pass a step, and gas2 two.
*/
#pragma once
#include "scheme/maps.h"
#include "scene/layout.h"
#include <mpmstab/table.h>

#define MPM_MAX_PASS_OPS 128 /* the largest number of operations on particles in one pass, and on nodes after it */

/*
   MpmPass - operations of a table on particles, and those on nodes that follow them. Their factors are all that
   multiplies them: the powers of the Courant number are in them. The nsums node fields sum[] are complete when the
   particles are done. The masses of the nodes are summed with operation mass, the first P2G after particles have moved,
   or MPM_NONE. A node operation is done on ghosts too, as far as its operands are valid: on depth[] ghosts fewer than
   the grid has. With rebase the particles migrate after the pass. within: they move in the middle of a step.
*/
typedef struct {
  PetscInt  nops, nsums, nnode_ops, mass;
  MpmOp     op[MPM_MAX_PASS_OPS], node_op[MPM_MAX_PASS_OPS];
  PetscInt  sum[MPM_MAX_FIELDS], depth[MPM_MAX_PASS_OPS];
  PetscBool drifts, within, rebase;
} MpmPass;

/* Not collective. Whether an operation is a sum over particles. MpmOpIsGather: it is one over nodes. */
static inline PetscBool MpmOpIsSum(const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  return traits.src == MPM_ON_PARTICLES && traits.dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;
}

/*S
   MpmSchedule - the passes of a step, and the one before the first step (start).

   halo  - the number of ghosts that node operations need
   spare - spare[n]: node field n is summed while its old values are still read, so it needs a second array
S*/
typedef struct {
  MpmPass   start, *pass;
  PetscInt  npasses, room, halo;
  PetscBool spare[MPM_MAX_FIELDS];
} MpmSchedule;

/*
   MpmHeadLength - the number of operations before the particles first read the grid or move, all of which one pass can
   do: its sums come before its operations on nodes, so none may begin anew in a field that has been set or read. A
   nonlinear system belongs to the step itself, which may have to be taken in parts.

   Not collective.
*/
PetscInt MpmHeadLength(const MpmTable *table, PetscInt nops, const MpmOp ops[]);

/*
   MpmScheduleCompile - compiles a table to passes, and frees what schedule held before.

   Not collective. A new schedule must be all zeros.

   Input Parameters:
+  drifts - particles move; if not, DRIFT is left out and the masses are summed once
-  fused  - particles may be summed to the grid before they migrate, because they stay within the ghost layer
*/
PetscErrorCode MpmScheduleCompile(const MpmTable *table, PetscReal courant, PetscBool drifts, PetscBool fused,
                                  MpmSchedule *schedule);
PetscErrorCode MpmScheduleDestroy(MpmSchedule *schedule);

/*
   MpmScheduleBound - a bound of the factor by which one step can enlarge the largest number of the state. It says when
   a march must be rescaled.

   Not collective. It follows the table with the maximum norms of the maps.

   Input Parameters:
+  least_mass - a lower bound of the nodal masses that DIV divides by, in particles
-  stiffness  - the largest number that GRAD multiplies with
*/
PetscReal MpmScheduleBound(const MpmTable *table, const MpmBasis *basis, PetscReal courant, PetscInt ppc,
                           PetscReal least_mass, PetscReal stiffness);

/*
   MpmScheduleBytes - bytes per particle and step that a march moves between memory and processor, when its arrays fit
   in no cache.

   Not collective. NaN for a table with SOLVE, whose number of iterations is not known. Ghosts are left
   out. alike says that all cells are alike, so that no particle's place is read.
*/
PetscReal MpmScheduleBytes(const MpmTable *table, const MpmLayout *layout, const MpmSchedule *schedule,
                           PetscReal particles_per_node, PetscBool alike);
