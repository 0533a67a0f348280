/* Cluster: particles anywhere in a grid, and what the nodal operator of these particles at rest says. */
#pragma once
#include "operator/nodal.h"
#include <mpmstab/critical.h>

/*S
   MpmCluster - particles of a case's scheme, and the nodes that they have.

   nodes, first - their number along each direction, and the first of them; all others are held: their values are 0
   wraps, beta  - the nodes follow one another again and again, each time with values e^(i beta) times those before. With
                  one node of a lattice this is a wave, with beta 0 a periodic box.
   n, cell, xi  - the particles: their cells and places there, dim numbers each
   count        - the number of limits and growths computed
S*/
typedef struct {
  const MpmCriticalCase *of;
  const MpmNodalPlan    *plan;
  PetscInt               nodes[MPM_MAX_DIM], first[MPM_MAX_DIM], n, *cell;
  PetscBool              wraps[MPM_MAX_DIM];
  PetscReal              beta[MPM_MAX_DIM], *xi;
  PetscInt               count;
} MpmCluster;

/* Not collective. Allocates the places of so many particles in a cluster whose case and plan are set. */
PetscErrorCode MpmClusterCreate(PetscInt most, MpmCluster *cluster);
PetscErrorCode MpmClusterDestroy(MpmCluster *cluster);

/*
   MpmClusterOperator - the nodal operator as a polynomial (see MpmNodalRun), in units in which a node's value is
   multiplied by the root of its mass.

   Not collective. coefficient: room for pointers to plan->degree + 1 matrices of order n; free each with PetscFree.
   Nodes without mass are left out. unseen: the largest abs of the eigenvalues that are left out too, those of nodal
   fields that a lone particle neither reads nor gives; 0 where there are none. They are not -1.
*/
PetscErrorCode MpmClusterOperator(const MpmCluster *cluster, PetscInt *n, double complex *coefficient[],
                                  PetscReal *unseen);

/*
   MpmClusterCrossing - the least Courant number up to MPM_CRITICAL_TO at which an eigenvalue is -1; infinite where there
                        is none. NaN: LAPACK did not converge.
   MpmClusterGrowth   - the largest abs of the eigenvalues at a Courant number; NaN as before. rounding: the growth that
                        rounding may make of a defective pair there (see MpmDefectiveErrorOf); it is large for a node
                        that has hardly any mass.

   Not collective.
*/
PetscErrorCode MpmClusterCrossing(MpmCluster *cluster, PetscReal *courant);
PetscErrorCode MpmClusterGrowth(MpmCluster *cluster, PetscReal courant, PetscReal *growth, PetscReal *rounding);
