/* A table applied to sparse matrices. MpmOperatorCreate is made of these functions. */
#pragma once
#include "base/float_check.h"
#include "scheme/maps.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>
#include <petscmat.h>

/*S
   MpmRegisters - the registers of a table as sparse matrices. The rows of a register are its particles or nodes, and
   its columns are the state at the start.

   first, cells     - of the last direction, the first cell of this rank and their number: a rank has a slab of the grid.
                      In one dimension the march gives a rank the same cells.
   node0            - the number of this rank's first node. Node (i, j, k) has the number i + nodes_x (j + nodes_y k).
   nodes, particles, state - the numbers of nodes, particles and unknowns of this rank
   begin            - the id of this rank's first particle
   fields           - the number of fields of the state
   masses           - the nodal masses at step masses_step, or NULL
   particle, node   - the registers
S*/
typedef struct {
  MPI_Comm         comm;
  const MpmLayout *layout;
  const MpmScheme *scheme;
  MpmStep          step;
  PetscInt         first, cells, node0, nodes, begin, particles, state, columns;
  PetscInt         fields;
  Vec              masses;
  PetscInt64       masses_step;
  Mat              particle[MPM_MAX_FIELDS], node[MPM_MAX_FIELDS], times_courant;
  MpmFloatCheck    float_check;
} MpmRegisters;

/* Collective. Sets the sizes alone; there are no registers. It is destroyed like registers. */
PetscErrorCode MpmRegistersSizes(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                 MpmRegisters *registers);

/* Collective. The particle registers of the state are rows of the identity; all other registers are empty. */
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
   MpmRegistersMap - the matrix of a map between particles and nodes along an axis or two, at a step. From nodes to particles it
   is particles x nodes. From particles to nodes it is nodes x particles, divided by the nodal masses; rows of nodes
   without mass are 0. parity is that of the node register, by direction (see MpmTable).

   Collective.
*/
PetscErrorCode MpmRegistersMap(MpmRegisters *registers, MpmOpKind kind, PetscInt axis, const MpmParity parity[],
                               PetscInt64 step, Mat *map);

/*
   MpmRegistersSolve - the matrix of SOLVE at a step, nodes x nodes:

     (W^T m W)^+ M

   W is G2P without the wall nodes that impose 0, m are the masses of the particles and M those of the nodes.

   Collective. It takes all eigenvalues of W^T m W, and refuses grids too large for that.
*/
PetscErrorCode MpmRegistersSolve(MpmRegisters *registers, const MpmParity parity[], PetscInt64 step, Mat *map);

#define MPM_PARITIES (MPM_MAX_DIM + 2)

/*
   Not collective. A number less than MPM_PARITIES for parities that mirror a node field alike. 0: even; 1 + a: the
   component of a vector along axis a; the last: a number that is imposed on walls.
*/
PetscInt MpmParityClass(const MpmLayout *layout, const MpmParity parity[]);

/*S
   MpmStepMaps - the matrices of a step's maps, by kind, by axes and by the parity of the node register. Each is made
   when it is first asked for. It starts as zeros.
S*/
typedef struct {
  Mat map[MPM_OP_KINDS][MPM_AXES][MPM_PARITIES];
} MpmStepMaps;

/* Collective. The matrix of an operation that is a map, at a step. MpmStepMapsDestroy destroys it. */
PetscErrorCode MpmStepMapsGet(MpmStepMaps *maps, MpmRegisters *registers, const MpmOp *op, PetscInt64 step, Mat *map);
PetscErrorCode MpmStepMapsDestroy(MpmStepMaps *maps);

/*
   Not collective. The index of a node along an axis. stride: the distance of neighbours along it in the numbering of
   nodes.
*/
PetscInt MpmNodeAlong(const MpmLayout *layout, PetscInt node, PetscInt axis, PetscInt *stride);

/* Collective. Applies the operations of one step, with the particles where they are at that step. */
PetscErrorCode MpmRegistersStep(MpmRegisters *registers, PetscInt64 step);

/* Collective. Gathers the particle registers in one matrix, whose rows are numbered like the state. */
PetscErrorCode MpmRegistersGather(const MpmRegisters *registers, Mat *A);

/*
   MpmInterleave - one matrix of so many parts: row i of part f becomes row parts x i + f.

   Collective. part: NULL where it is 0. rows, columns: how many this rank has of each part. diagonal: the result has every
   entry of its diagonal, if only as 0, so that it can be shifted.
*/
PetscErrorCode MpmInterleave(MPI_Comm comm, PetscInt parts, const Mat part[], PetscInt rows, PetscInt columns,
                             PetscBool diagonal, Mat *A);
