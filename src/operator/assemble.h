/* The table over sparse registers: what MpmOperatorCreate is made of. */
#pragma once
#include "base/float_check.h"
#include "scheme/maps.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>
#include <petscmat.h>

/*S
   MpmRegisters - a field is a sparse matrix: rows are its particles or nodes, columns the state at the start.

   cells, nodes, particles and state are this rank's counts; a rank's cells are those that the march gives it. begin is
   its first particle's id.
*/
typedef struct {
  MPI_Comm         comm;
  const MpmLayout *layout;
  const MpmScheme *scheme;
  MpmStep          step;
  PetscInt         first, cells, nodes, begin, particles, state, columns;
  PetscInt         fields;
  Vec              masses;
  PetscInt64       masses_step;
  Mat              particle[MPM_MAX_FIELDS], node[MPM_MAX_FIELDS], times_courant;
  MpmFloatCheck    float_check;
} MpmRegisters;

/* Collective. Particle registers are the identity's rows, node registers empty. */
PetscErrorCode MpmRegistersCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                  MpmRegisters *registers);

/*
   MpmRegistersCreatePolynomial - the same, as polynomials in the Courant number up to a degree; step's is not used.

   Not collective: the calling rank holds everything. Powers beyond the degree are dropped.
*/
PetscErrorCode MpmRegistersCreatePolynomial(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                            PetscInt degree, MpmRegisters *registers);
PetscErrorCode MpmRegistersDestroy(MpmRegisters *registers);

/*
   MpmRegistersMap - a map between particles and nodes at a step: particles x nodes, or nodes x particles, divided by
   the nodal masses (0 where there is none). antisymmetric: of the node field, see MpmTable.

   Collective.
*/
PetscErrorCode MpmRegistersMap(MpmRegisters *registers, MpmOpKind kind, PetscBool antisymmetric, PetscInt64 step,
                               Mat *map);

/*
   MpmRegistersSolve - the map of SOLVE at a step, nodes x nodes: (W^T W)^+ M, W: G2P without the wall nodes that impose
   0.

   Collective. By all eigenvalues of W^T W; refuses grids too large for that.
*/
PetscErrorCode MpmRegistersSolve(MpmRegisters *registers, PetscBool antisymmetric, PetscInt64 step, Mat *map);

/* Collective. The operations of one step, with particles where they are at that step. */
PetscErrorCode MpmRegistersStep(MpmRegisters *registers, PetscInt64 step);

/* Collective. The particle registers as one matrix, rows numbered like the state. */
PetscErrorCode MpmRegistersGather(const MpmRegisters *registers, Mat *A);
