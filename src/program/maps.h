/* Maps: what the operations of a step multiply by, as sparse matrices, for particles at their places at one step. */
#pragma once
#include "scheme/maps.h"
#include <mpmstab/layout.h>
#include <mpmstab/scheme.h>
#include <petscmat.h>

/* ---- which particles and nodes of a layout a rank has, as rows of matrices and vectors ---- */

/*S
   MpmSlab - the rows of a rank.

   first, cells     - of the last direction, the first cell of this rank and their number: a rank has a slab of the
   grid.
                      In one dimension the march gives a rank the same cells.
   node0            - the number of this rank's first node. Node (i, j, k) has the number i + nodes_x (j + nodes_y k).
   nodes, particles, state - the numbers of nodes, particles and unknowns of this rank
   begin            - the id of this rank's first particle
   fields           - the number of fields of the state
S*/
typedef struct {
  MPI_Comm         comm;
  const MpmLayout *layout;
  const MpmScheme *scheme;
  MpmStep          step;
  PetscInt         first, cells, node0, nodes, begin, particles, state, fields;
} MpmSlab;

/* Collective. layout and scheme must outlive the slab, which holds no memory. */
PetscErrorCode MpmSlabOf(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                         MpmSlab *slab);

/*
   Not collective. The index of a node along an axis. stride: the distance of neighbours along it in the numbering of
   nodes.
*/
PetscInt MpmNodeAlong(const MpmLayout *layout, PetscInt node, PetscInt axis, PetscInt *stride);

/* ---- maps ---- */

#define MPM_PARITIES (MPM_MAX_DIM + 2)

/*S
   MpmParticlePlaces - where particles are: cell[a][p] and xi[a][p] in [0,1), in direction a. The cell is global, and
   need not be inside of a periodic domain.
S*/
typedef struct {
  PetscInt  *cell[MPM_MAX_DIM];
  PetscReal *xi[MPM_MAX_DIM];
} MpmParticlePlaces;

/*S
   MpmMaps - the maps of a step, by kind, by axes and by the parity of the node register. Each is made when it is first
   asked for, once for all operations that use it. It starts with slab and step, or slab and places; MpmMapsDestroy
   destroys the rest.

   places - NULL: particles are where the layout has them at that step
   masses - the nodal masses, or NULL
   moment - by axis and by the direction along which it is the derivative (MpmMapsWeights)
S*/
typedef struct {
  const MpmSlab           *slab;
  PetscInt64               step;
  const MpmParticlePlaces *places;
  Vec                      masses;
  Mat                      map[MPM_OP_KINDS][MPM_AXES][MPM_PARITIES], moment[MPM_MAX_DIM][MPM_MAX_DIM][MPM_PARITIES];
} MpmMaps;

/*
   MpmMapsGet - the matrix of an operation that is a map.

   From nodes to particles it is particles x nodes. From particles to nodes it is nodes x particles, divided by the
   nodal masses; rows of nodes without mass are 0. A stencil is nodes x nodes, and so is WALL, 1 for the nodes of the
   wall. SOLVE is (W^T m W)^+ M: W is G2P without the wall nodes that impose 0, m are the masses of the particles and M
   those of the nodes.

   Collective. SOLVE takes all eigenvalues of W^T m W, and refuses grids too large for that.
*/
PetscErrorCode MpmMapsGet(MpmMaps *maps, const MpmOp *op, Mat *map);

/*
   MpmMapsWeights - the weights of a map at places, particles x nodes, without the property of particles that the
   operation multiplies them with and without nodal masses. parity is that of the node register. along: the derivative
   with respect to the places in this direction, or MPM_NONE for the weights themselves.

   Collective. map: NULL for a derivative that is 0 wherever the particles are.
*/
PetscErrorCode MpmMapsWeights(MpmMaps *maps, MpmOpKind kind, PetscInt axis, PetscInt along, const MpmParity parity[],
                              Mat *map);

/* Collective. A copy of the matrix of P2G of a field that is even at walls, which the caller destroys. */
PetscErrorCode MpmMapsEven(const MpmSlab *slab, PetscInt64 step, Mat *map);

/* Collective. The numbers in the maps that were made, but for walls, on all ranks. */
PetscErrorCode MpmMapsCount(const MpmMaps *maps, PetscReal *numbers);
PetscErrorCode MpmMapsDestroy(MpmMaps *maps);

/* Collective. A new vector of the reciprocals of the numbers that are not 0; those stay 0. */
PetscErrorCode MpmReciprocals(Vec numbers, Vec *reciprocals);
