/* What a pass of the march does to nodes alone: images beyond walls, and the operations between node fields. */
#pragma once
#include "march/march_private.h"

/*
   Not collective. Nodes beyond a wall are images of those inside. MpmMarchFold gives what the pass has summed to them,
   and their mass, to those they stand for, before the sum over ranks; MpmMarchReflect sets them after. field[] and antisymmetric[] are by
   node field.
*/
void MpmMarchFold(const MpmMarch *march, const PetscBool antisymmetric[], const MpmPass *pass, PetscReal *const field[],
                  PetscReal mass[]);
void MpmMarchReflect(const MpmMarch *march, const PetscBool antisymmetric[], const MpmPass *pass,
                     PetscReal *const field[]);

/* The nodes [lo, hi) on which a node operation has been done while the pass was on its way; lo = hi: none. */
typedef struct {
  PetscInt lo, hi;
} MpmNodesDone;

/*
   Not collective. The node operations that follow a pass, on those of its nodes [lo, hi) where they can be done already:
   these are complete, and no particle will read them any more. hi grows from call to call. Operations that look at
   neighbours, and all after them, stay so far behind that each finds what it would if they came one after the other.
   Walls and what comes after them wait.
*/
void MpmMarchFollowNodes(const MpmPass *pass, PetscReal *const field[], PetscInt lo, PetscInt hi, MpmNodesDone done[]);

/* Collective. The node operations that follow a pass, where they have not been done; step is that of the particles' places. */
PetscErrorCode MpmMarchNodeOps(const MpmMarch *march, PetscInt64 step, const MpmPass *pass, PetscReal *const field[],
                               const PetscReal inverse_mass[], const MpmPlaces *places, const MpmNodesDone done[]);
