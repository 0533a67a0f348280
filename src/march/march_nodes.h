/* The part of a pass that concerns nodes alone: images beyond walls, and the operations between node fields. */
#pragma once
#include "march/march_private.h"

/*
   Not collective. Nodes beyond a wall are images of those inside. Before the sum over ranks, MpmMarchFold adds the sums
   and masses of a pass at images to the nodes that they are images of. After it, MpmMarchReflect sets the images.
   field[] and parity[] are by node field.
*/
void MpmMarchFold(const MpmMarch *march, const MpmParity parity[][MPM_MAX_DIM], const MpmPass *pass,
                  PetscReal *const field[], PetscReal mass[]);
void MpmMarchReflect(const MpmMarch *march, const MpmParity parity[][MPM_MAX_DIM], const MpmPass *pass,
                     PetscReal *const field[]);

/* The nodes [lo, hi) on which a node operation was done while the pass was under way; lo = hi: none. */
typedef struct {
  PetscInt lo, hi;
} MpmNodesDone;

/*
   Not collective. Does the node operations of a pass that is under way, as far as they can be done. Nodes [lo, hi) are
   complete, and no particle will read them any more; hi grows from call to call. An operation that reads neighbours,
   and all after it, stay so far behind that each finds the same numbers as if the operations came one after the other.
   Walls and the operations after them wait for MpmMarchNodeOps.
*/
void MpmMarchFollowNodes(const MpmPass *pass, PetscReal *const field[], PetscInt lo, PetscInt hi, MpmNodesDone done[]);

/*
   Collective. Does the node operations that follow a pass on all other nodes, from number *next on, which becomes that of the
   first IMPLICIT there, or their number. step is that of the particles' places.
*/
PetscErrorCode MpmMarchNodeOps(const MpmMarch *march, PetscInt64 step, const MpmPass *pass, PetscReal *const field[],
                               const PetscReal inverse_mass[], const MpmPlaces *places, const MpmNodesDone done[],
                               PetscInt *next);
