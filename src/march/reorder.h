/*
   Reorder: the operations of a table in an order for which a march needs fewer passes over the particles. They do the same
   but for rounding.
*/
#pragma once
#include <mpmstab/table.h>

/* Operations that are run one after the other as those of a table. */
typedef struct {
  PetscInt n, room;
  MpmOp   *op;
} MpmOpList;

/*
   MpmOpListCreate - the operations of a table, in its order.

   MpmOpListSumFirst - takes sums from particles to nodes before the operations on nodes that they do not depend on.

   MpmOpListDelay - lets particles take values from nodes as late as they can. Where a node field changes by n += b m in
   between, its old value is n - b m. Operations of the same map and fields become one, and vanish where their factors
   cancel. So particles with apic or pic take the new velocity at once, not the old one and then its change.

   Not collective. MpmOpListDelay may add operations.
*/
PetscErrorCode MpmOpListCreate(const MpmTable *table, MpmOpList *list);
void           MpmOpListSumFirst(MpmOpList *list);
PetscErrorCode MpmOpListDelay(const MpmTable *table, MpmOpList *list);
PetscErrorCode MpmOpListDestroy(MpmOpList *list);
