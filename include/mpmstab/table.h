/* Table: a formulation with a transfer and a boundary worked into it, as the three readers interpret it. */
#pragma once
#include <mpmstab/boundary.h>
#include <mpmstab/transfer.h>

/*S
   MpmTable - the operations of one step, in order, and the registers they work on.

   Particle registers [0, nstate) are the state, those up to nparticles scratch that holds nothing from one operation
   sequence P2G or G2P to the next. antisymmetric[n]: node field n is 0 at fixed ends, so that nodes beyond one are its mirror
   images with the other sign. filtered[f]: a filter acts on state field f; unfiltered: how many have none.
S*/
struct MpmTable_ {
  PetscInt    nops, room;
  MpmOp      *ops;
  PetscInt    nstate, nparticles, nnodes, unfiltered;
  const char *fields[MPM_MAX_FIELDS + 1];
  PetscBool   antisymmetric[MPM_MAX_FIELDS], filtered[MPM_MAX_FIELDS];
  PetscInt    affine; /* the field that has an affine part, or MPM_NONE */
  PetscInt    affine_part;
  MpmEnd      ends[2];
};

/*
   MpmTableCreate - works a transfer and a boundary into a formulation's table.

   Not collective. FILTER becomes the transfer's operations (none for flip); IMPOSE and REACT become WALL at the ends
   that are fixed, nothing at others. With a transfer that has an affine part, what is done to the velocity is done to
   that part too. A combination that the interpreters do not support is an error of the program (PETSC_ERR_SUP): an
   operation to particles that replaces, a SCALE, SOLVE or WALL that accumulates, a stencil on its own result, an axis
   that the table does not have, a sum that is continued after something else than sums, and a node field that is read
   before the step has written to it.
*/
PetscErrorCode MpmTableCreate(const MpmFormulation *formulation, const MpmTransfer *transfer,
                              const MpmTransferNumbers *numbers, const MpmEnd ends[2], MpmTable **table);
PetscErrorCode MpmTableDestroy(MpmTable **table);

/* Not collective. For transfers: one more operation; one more node field like another; a scratch particle field. */
PetscErrorCode MpmTableAppend(MpmTable *table, MpmOp op);
PetscErrorCode MpmTableNode(MpmTable *table, PetscInt like, PetscInt *node);
PetscErrorCode MpmTableScratch(MpmTable *table, PetscInt *particle);

/* Not collective. For transfers: a node field that P2G has just filled is 0 at fixed ends. */
PetscErrorCode MpmTableImpose(MpmTable *table, PetscInt node);

/* Not collective. The first operation through which nodes see a particle field (P2G; DIV for a stress), or NULL. */
const MpmOp *MpmTableSeenBy(const MpmTable *table, PetscInt field);

/* Not collective. Whether P2G of a particle field is 0 at fixed ends (see antisymmetric). */
PetscBool MpmTableIsAntisymmetric(const MpmTable *table, PetscInt field);

/* Not collective. Whether the table has an operation of a kind. */
PetscBool MpmTableHas(const MpmTable *table, MpmOpKind kind);
