/* What a pass of the march does to nodes alone: images beyond walls, and the operations between node fields. */
#pragma once
#include <mpmstab/march.h>

/*
   Not collective. Nodes beyond a wall are images of those inside. MpmMarchFold gives what the pass has summed to them,
   and their mass, to those they stand for, before the sum over ranks; MpmMarchReflect sets them after. field[] by node
   field.
*/
void MpmMarchFold(const MpmMarch *march, const MpmPass *pass, PetscReal *const field[], PetscReal mass[]);
void MpmMarchReflect(const MpmMarch *march, const MpmPass *pass, PetscReal *const field[]);

/* Collective. The node operations that follow a pass. */
PetscErrorCode MpmMarchNodeOps(const MpmMarch *march, const MpmPass *pass, PetscReal *const field[],
                               const PetscReal inverse_mass[], const MpmPlaces *places);
