/*
   Table: the list of operations of one step. MpmTableCreate makes it from a formulation, a transfer and a boundary. The
   march, the operator and the symbol interpret it.
*/
#pragma once
#include <mpmstab/boundary.h>
#include <mpmstab/transfer.h>

/*S
   MpmTable - the operations of one step, in order, and the registers they work on. A register is a field of particles
   or of nodes, and has a number.

   nops, room    - the number of operations, and of those that ops has memory for
   ops           - the operations
   nstate        - particle registers [0, nstate) are the state, which goes on from step to step
   nparticles    - particle registers [nstate, nparticles) are scratch: SCALE sets them to 0, G2P fills them, P2G sends
                   them to nodes, and after that they hold nothing
   nnodes        - the number of node registers
   unfiltered    - the number of state fields that no filter acts on
   fields        - the names of the state fields, NULL-terminated
   antisymmetric - antisymmetric[n]: node field n is 0 at fixed ends, so that nodes beyond such an end are its mirror
                   images with the other sign
   filtered      - filtered[f]: the filter of the transfer acts on state field f
   affine        - the state field that has an affine part, or MPM_NONE
   affine_part   - the state field that holds this affine part
   ends          - the kinds of the left and of the right end
S*/
struct MpmTable_ {
  PetscInt    nops, room;
  MpmOp      *ops;
  PetscInt    nstate, nparticles, nnodes, unfiltered;
  const char *fields[MPM_MAX_FIELDS + 1];
  PetscBool   antisymmetric[MPM_MAX_FIELDS], filtered[MPM_MAX_FIELDS];
  PetscInt    affine;
  PetscInt    affine_part;
  MpmEnd      ends[2];
};

/*
   MpmTableCreate - makes a table from a formulation, a transfer and a boundary.

   Not collective.

   Input Parameters:
+  formulation - its table of operations, which may contain FILTER, IMPOSE and REACT
.  transfer    - the operations that take the place of FILTER; for flip there are none
.  numbers     - the numbers that the transfer is given
-  ends        - the kinds of the two ends; IMPOSE and REACT become WALL at those that are fixed, and nothing at others

   Output Parameter: table - destroyed with MpmTableDestroy

   With a transfer that has an affine part, each P2G, G2P and SCALE of the field that has it is followed by one of that
   part.

   Errors: PETSC_ERR_SUP for a table that the interpreters do not support; it is an error of the program. They support
   none of these: an operation to particles that replaces, a SCALE, SOLVE or WALL that accumulates, a stencil on its own
   result, an axis that the table does not have, a sum that is continued after something else than sums, and a node
   field that is read before the step has written to it.
*/
PetscErrorCode MpmTableCreate(const MpmFormulation *formulation, const MpmTransfer *transfer,
                              const MpmTransferNumbers *numbers, const MpmEnd ends[2], MpmTable **table);
PetscErrorCode MpmTableDestroy(MpmTable **table);

/*
   These three functions are for the filters of transfers. Not collective.

   MpmTableAppend  - appends an operation, and the one on the affine part that belongs to it
   MpmTableNode    - adds a node field, which is antisymmetric where the node field like is
   MpmTableScratch - adds a scratch particle field

   Errors: PETSC_ERR_PLIB when there are more than MPM_MAX_FIELDS fields.
*/
PetscErrorCode MpmTableAppend(MpmTable *table, MpmOp op);
PetscErrorCode MpmTableNode(MpmTable *table, PetscInt like, PetscInt *node);
PetscErrorCode MpmTableScratch(MpmTable *table, PetscInt *particle);

/*
   MpmTableImpose - sets a node field that P2G has just filled to 0 at the ends of kind MPM_FIXED, where the field is
   antisymmetric. The filters of transfers call it.

   Not collective.
*/
PetscErrorCode MpmTableImpose(MpmTable *table, PetscInt node);

/*
   Not collective. The first operation that takes a particle field to the nodes: P2G, or DIV for a stress. NULL when the
   table has none.
*/
const MpmOp *MpmTableSeenBy(const MpmTable *table, PetscInt field);

/* Not collective. Whether P2G of a particle field is 0 at fixed ends (see antisymmetric of MpmTable). */
PetscBool MpmTableIsAntisymmetric(const MpmTable *table, PetscInt field);

/* Not collective. Whether the table has an operation of a kind. */
PetscBool MpmTableHas(const MpmTable *table, MpmOpKind kind);
