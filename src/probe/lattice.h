/*
   Bloch probing: where all cells are alike, the response to one cell's unknowns is that to every cell's. It gives the
   blocks A_d, the response of the cell at distance d, and with them G(beta) = sum over d of A_d e^(-i beta.d) for every
   phase, whatever the number of cells.
*/
#pragma once
#include "probe/probe.h"
#include "symbol/blocks.h"

/*S
   MpmProbeLattice - the cells of a base state.

   cells    - their number in each direction, 1 beyond the last one
   wraps    - whether they fill the period of that direction, so that they have no edge there
   sites    - the number of particles in each cell; xi: their places in it, MPM_MAX_DIM numbers each, 0 without a place
   lo, hi   - the least and the largest of these in each direction; gap: the largest distance of two next to one another
   particle - the particle of each site of each cell: particle[cell * sites + site], x fastest
   cell_of, site_of - the same the other way round
S*/
typedef struct {
  PetscInt    cells[MPM_MAX_DIM], sites;
  PetscBool   wraps[MPM_MAX_DIM];
  PetscReal  *xi, lo[MPM_MAX_DIM], hi[MPM_MAX_DIM], gap[MPM_MAX_DIM];
  PetscInt64 *particle;
  PetscInt   *cell_of, *site_of;
} MpmProbeLattice;

/*S
   MpmProbePlaces - where n particles are: dim numbers each, in cell widths, as the periods are (0: none). near: places
   in a cell that differ by less are the same.
S*/
typedef struct {
  PetscInt         dim;
  PetscInt64       n;
  const PetscReal *at;
  PetscReal        period[MPM_MAX_DIM], near;
} MpmProbePlaces;

/*
   MpmProbeLatticeFind - sorts particles into cells. MpmProbeLatticeOf - does so with those of a base state, whose cells
   must also have the same values. why_not: why the cells are not alike, empty if they are.

   Not collective.
*/
PetscErrorCode MpmProbeLatticeFind(const MpmProbePlaces *places, MpmProbeLattice *lattice, size_t room, char why_not[]);
PetscErrorCode MpmProbeLatticeOf(const MpmProbe *probe, MpmProbeLattice *lattice, size_t room, char why_not[]);
PetscErrorCode MpmProbeLatticeDestroy(MpmProbeLattice *lattice);

/*
   Not collective. The cell in the middle; and the distance of a cell from another one in a direction, the shorter way
   round where there is a period.
*/
PetscInt MpmProbeLatticeMiddle(const MpmProbeLattice *lattice);
PetscInt MpmProbeLatticeDistance(const MpmProbeLattice *lattice, PetscInt cell, PetscInt from, PetscInt axis);

/*
   MpmProbeBlocks - probes the unknowns of a cell, with perturbations of a size.

   Collective: the ranks share the columns, and all get all blocks. farthest: the largest entry of the blocks for
   particles at the edge, over the largest of all: 0 when nothing arrives there.
*/
PetscErrorCode MpmProbeBlocks(MpmProbe *probe, const MpmProbeLattice *lattice, PetscInt cell, PetscReal size,
                              MpmBlocks *blocks, PetscReal *farthest);

/*
   MpmProbeBlocksMatrix - the operator of all particles, whose cells fill the period in each direction. Collective;
   blocks may be without numbers of particles that are set apart.

   MpmProbeLatticeAt - the cell of a particle in each direction, and its site. Not collective.
*/
PetscErrorCode MpmProbeBlocksMatrix(const MpmProbe *probe, const MpmProbeLattice *lattice, const MpmBlocks *blocks,
                                    Mat *A);
void           MpmProbeLatticeAt(const void *lattice, PetscInt64 particle, PetscInt64 cell[], PetscInt *site);

/*
   MpmProbeBlocksCompare - compares a response with what the blocks give, in all cells that no edge can have touched.

   Not collective. amount, response: as MpmProbeRandom has them. apart[c]: whether number c of a particle is left out.
   differ: the largest difference, over the largest number of the response. compared: the number of cells.
*/
void MpmProbeBlocksCompare(const MpmProbe *probe, const MpmProbeLattice *lattice, const MpmBlocks *blocks,
                           const PetscReal amount[], const PetscReal response[], const PetscBool apart[],
                           PetscReal *differ, PetscInt *compared);
