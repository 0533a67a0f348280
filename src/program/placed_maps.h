/*
   Maps between nodes and particles that are anywhere, as sparse matrices, and the derivatives of these maps with
   respect to the places of the particles.
*/
#pragma once
#include "program/maps.h"

/*S
   MpmParticlePlaces - where particles are: cell[a][p] and xi[a][p] in [0,1), in direction a. The cell is global, and
   need not be
   inside of a periodic domain.
S*/
typedef struct {
  PetscInt  *cell[MPM_MAX_DIM];
  PetscReal *xi[MPM_MAX_DIM];
} MpmParticlePlaces;

typedef struct MpmPlacedMap_ MpmPlacedMap;

/*S
   MpmPlacedMaps - the matrices of one state. Each is made when it is first asked for.

   sizes  - which particles and nodes this rank has
   places - of the particles of this rank, in the order of their ids
S*/
typedef struct {
  const MpmSlab           *sizes;
  const MpmParticlePlaces *places;
  PetscInt                 n, room;
  MpmPlacedMap            *map;
} MpmPlacedMaps;

/*
   MpmPlacedMapsGet - the weights of a map, particles x nodes, without the property of particles that the operation
   multiplies them with and without nodal masses. parity is that of the node register. along: the derivative with
   respect to the places in this direction, or MPM_NONE for the weights themselves.

   Collective. map: destroyed by MpmPlacedMapsDestroy; NULL for a derivative that is 0 wherever the particles are.
*/
PetscErrorCode MpmPlacedMapsGet(MpmPlacedMaps *maps, MpmOpKind kind, PetscInt axis, PetscInt along,
                                const MpmParity parity[], Mat *map);
PetscErrorCode MpmPlacedMapsDestroy(MpmPlacedMaps *maps);
