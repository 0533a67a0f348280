/*
   Passes: a table compiled for marching. Consecutive particle operations between two grid sums
   become one pass over the particles, done block by block.

   A step is cut where its particles first read the grid: what comes before (the first P2Gs) joins the pass
   that ends the step before it, since both go over the same particles. So gas1 and elastic need one pass a
   step, gas2 two.
*/
#pragma once
#include "scheme/maps.h"
#include "scene/layout.h"
#include <mpmstab/table.h>

#define MPM_MAX_PASS_OPS 128 /* operations on particles in one pass, and on nodes after it */
#define MPM_MAX_JOINED 8     /* passes that follow one another through the particles */

/*E
   MpmPassOpKind - what a pass does to a block of particles.

   MPM_PASS_MAP    - a map between particles and nodes (a kernel of the basis)
   MPM_PASS_MASS   - the first P2G after particles have moved, with the nodal masses
   MPM_PASS_SCALE  - a particle field times a number
   MPM_PASS_DRIFT  - particles are at the next step's places from here on
   MPM_PASS_SAMPLE - sum of squares of a particle field, when the step is sampled
E*/
typedef enum { MPM_PASS_MAP, MPM_PASS_MASS, MPM_PASS_SCALE, MPM_PASS_DRIFT, MPM_PASS_SAMPLE } MpmPassOpKind;

/* to_nodes: the map writes the node field. weight: a property that varies, or MPM_NO_PROPERTY. */
typedef struct {
  MpmPassOpKind kind;
  MpmKernel     kernel;
  MpmMassKernel mass_kernel;
  PetscReal     a;
  PetscInt      particle, node;
  PetscBool     to_nodes;
  MpmProperty   weight;
} MpmPassOp;

/*
   A node operation, done on ghosts too as far as its operands are valid: depth ghosts fewer than the grid has. side: the
   end at which a WALL acts.
*/
typedef struct {
  MpmOpKind kind;
  PetscReal a;
  PetscInt  dst, src, depth, side;
  PetscBool accumulates;
} MpmNodeOp;

/* Not collective. Whether a node's new value depends on it and its neighbours alone, of any rank and of no wall. */
static inline PetscBool MpmNodeOpIsLocal(MpmOpKind kind)
{
  return kind == MPM_LAP || kind == MPM_COPY ? PETSC_TRUE : PETSC_FALSE;
}

/* nsums node fields are complete when the pass is done; the node operations follow; rebase: particles then migrate. */
typedef struct {
  PetscInt  nops, nsums, nnode_ops;
  MpmPassOp op[MPM_MAX_PASS_OPS];
  PetscInt  sum[MPM_MAX_FIELDS];
  MpmNodeOp node_op[MPM_MAX_PASS_OPS];
  PetscBool sums_mass, drifts, rebase, joined;
} MpmPass;

/*S
   MpmSchedule - the passes of a step, and the one that comes before the first step.

   spare[n]: node field n is summed while its old values are still read, so it needs a second array. halo: ghosts used
   up by node operations.
S*/
typedef struct {
  MpmPass   start, *pass;
  PetscInt  npasses, room, halo;
  PetscBool spare[MPM_MAX_FIELDS];
} MpmSchedule;

/*
   MpmScheduleCompile - compiles a table; what schedule held before is freed.

   Not collective. Begin with a schedule of zeros.

   Input Parameters:
+  layout - says in which properties particles differ, and so which operations weigh them
.  drifts - whether particles move; if not, DRIFT is left out and the masses are summed once
-  fused  - whether particles may be summed to the grid before they migrate (they stay within the ghost layer)
*/
PetscErrorCode MpmScheduleCompile(const MpmTable *table, const MpmBasis *basis, const MpmLayout *layout,
                                  PetscReal courant, PetscBool drifts, PetscBool fused, MpmSchedule *schedule);
PetscErrorCode MpmScheduleDestroy(MpmSchedule *schedule);

/*
   MpmScheduleBound - a bound on how much one step can enlarge the largest number of the state.

   Not collective. Follows the table with the maps' maximum norms; used to rescale in time. least_mass: a bound from
   below on the nodal masses that DIV divides by, in particles. stiffness: the largest that GRAD multiplies with.
*/
PetscReal MpmScheduleBound(const MpmTable *table, const MpmBasis *basis, PetscReal courant, PetscInt ppc,
                           PetscReal least_mass, PetscReal stiffness);
