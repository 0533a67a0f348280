/*
   Bundles: how the maps act on particles that share no coordinate with one another.

   A bundle is a set of up to MPM_BUNDLE node fields whose values at a node lie side by side in memory. A particle then
   reads or adds to all fields of a node at once. The weights of a map are products over the directions: phi_ip in all
   but one of them, and those of a kind of operation in that one. So the sums over nodes are done one direction after
   another, for all these products together.
*/
#pragma once
#include "scheme/kernels.h"

#define MPM_BUNDLE 8       /* node fields in a bundle, at most */
#define MPM_CLOUD 64       /* particles that go through a map together, at most */
#define MPM_BUNDLE_KINDS 3 /* kinds of weights beside phi_ip in one map, at most */

/* The number of products of weights in dim directions: phi_ip in all of them, and each kind in each direction. */
#define MPM_PRODUCTS(dim, kinds) (1 + (dim) * (kinds))
#define MPM_MOST_PRODUCTS MPM_PRODUCTS(MPM_MAX_DIM, MPM_BUNDLE_KINDS)

/*
   n particles and their nodes: `nodes` of them in each of dim directions, with `kinds` kinds of weights beside phi_ip.
   Particle p has its first node at first[p], and nodes further along direction a are at multiples of stride[a]. Its
   weight of kind k at the d-th node along direction a is weight[a][k][d * MPM_CLOUD + p]. Kind 0 is phi_ip.
*/
typedef struct {
  PetscInt         n, dim, nodes, kinds, stride[MPM_MAX_DIM], first[MPM_CLOUD];
  const PetscReal *weight[MPM_MAX_DIM][1 + MPM_BUNDLE_KINDS];
} MpmCloud;

/*
   MpmBundleMap - a map between the particles of a cloud and a bundle of width fields. Node i has its values at
   node[width i], and particle p has its numbers for a product of weights at product[width (MPM_CLOUD c + p)]. A gather
   sets these to the sums of the nodes' values times the product. A spread adds them, times the product, to the nodes.
   Product 0 is that of phi_ip; product 1 + dim (k - 1) + a has kind k along direction a.

   Not collective. The arrays do not overlap.
*/
typedef void (*MpmBundleMap)(const MpmCloud *cloud, PetscReal node[], PetscReal product[]);

/*
   Not collective. The map to nodes (a spread) or from them (a gather) for bases whose particles have weights at so many
   nodes in each direction, with 0 to MPM_BUNDLE_KINDS kinds. MpmBundleWidth is the width of a bundle of so many fields.
   MpmBundleWidth(MPM_BUNDLE) is the largest width on this processor, and more fields need more bundles.
*/
MpmBundleMap MpmBundleMapFind(PetscBool to_nodes, PetscInt dim, PetscInt nodes, PetscInt kinds, PetscInt width);
PetscInt     MpmBundleWidth(PetscInt fields);
