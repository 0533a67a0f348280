/* The table over sparse registers: what MpmOperatorCreate is made of. */
#pragma once
#include <mpmstab/maps.h>
#include <mpmstab/scene.h>
#include <petscmat.h>

/*S
   MpmRegisters - a field is a sparse matrix: rows are its particles or nodes, columns the state at the start.

   counts are this rank's cells, particles and state numbers; a rank's cells are those that the march gives it.
*/
typedef struct {
  MPI_Comm        comm;
  const MpmScene *scene;
  PetscInt        first, cells, particles, state;
  PetscInt        fields, nodes;
  Mat             particle[MPM_MAX_FIELDS], node[MPM_MAX_FIELDS];
} MpmRegisters;

/* Collective. Particle registers are the identity's rows, node registers empty. */
PetscErrorCode MpmRegistersCreate(MPI_Comm comm, const MpmScene *scene, MpmRegisters *registers);
PetscErrorCode MpmRegistersDestroy(MpmRegisters *registers);

/*
   MpmRegistersMap - a map between particles and nodes at a step: particles x nodes, or for P2G nodes x particles,
   divided by the nodal masses (0 where there is none).

   Collective.
*/
PetscErrorCode MpmRegistersMap(const MpmRegisters *registers, MpmOpKind kind, PetscInt64 step, Mat *map);

/* Collective. The operations of one step, with particles where they are at that step. */
PetscErrorCode MpmRegistersStep(MpmRegisters *registers, PetscInt64 step);

/* Collective. The particle registers as one matrix, rows numbered like the state. */
PetscErrorCode MpmRegistersGather(const MpmRegisters *registers, Mat *A);
