/* Basis functions: which nodes a particle has weights at, and the maps between particles and nodes. */
#pragma once
#include <mpmstab/formulation.h>

#define MPM_BLOCK 256    /* the largest number of particles in a block */
#define MPM_MOST_NODES 6 /* that a particle has weights at along one direction; all arrays for these follow from it */

/*S
   MpmBlock - the places of a block of particles, of which a basis makes weights.

   n          - the number of particles, at most MPM_BLOCK, in any order
   xi         - xi[p] in [0,1): the place of particle p in its cell, in cells
   first      - first[p]: the local index of the first node that particle p has a weight at
   half_width - half of a particle's width, in cells; only bases with wide set use it
   wall       - the local indices of the first and the last node of the direction, or MpmNoWalls; only bases whose
                functions differ near walls use it
S*/
typedef struct {
  PetscInt         n, first[MPM_BLOCK];
  const PetscReal *xi;
  PetscReal        half_width;
  PetscInt         wall[2];
} MpmBlock;

/*E
   MpmSplineEnds - the B-splines next to the ends of a direction that is not periodic.

   MPM_SPLINES_MIRRORED - all splines have one shape, and nodes beyond the end are mirror images of those inside
   MPM_SPLINES_MODIFIED - a node beyond the end has the value that continues the last two nodes in a straight line. So
                          the functions of these two nodes change shape, and there are no nodes beyond the end (Steffen,
                          Kirby and Berzins 2008; Karamelo). At the end itself the function of the last node is 1.
   MPM_SPLINES_OPEN     - open knot vectors: the knots are the ends of cells, and those at the ends of the direction are
                          repeated. There are as many functions as cells and the degree together. x_i is the mean of a
                          function's inner knots (Greville), so that linear functions are reproduced.
E*/
typedef enum { MPM_SPLINES_MIRRORED, MPM_SPLINES_MODIFIED, MPM_SPLINES_OPEN } MpmSplineEnds;
extern const char *const MpmSplineEndNames[];

/*
   MpmWeights - the weights of the nodes of each particle of a block, for a kind of map: weight[d * stride + p] is that
   of node first[p] + d. With the basis function phi_ip of node i at particle p they are

     P2G, G2P                        phi_ip
     P2G_AFFINE                      phi_ip (x_i - x_p) / h
     DIV, GRAD, G2P_SLOPE            h dphi_ip/dx
     DIV_MLS, GRAD_MLS, G2P_AFFINE   phi_ip (x_i - x_p) h / sum_j phi_jp (x_j - x_p)^2
     CURVE                           h^2 d2phi_ip/dx2
     CURVE_MLS                       h d/dx_p of the weight of DIV_MLS

   A map to nodes adds a sum_p weight particle[p] to node[i], before the division by nodal masses, and one to particles
   adds a sum_i weight node[i] to particle[p]. Node i is the left end of cell i.

   Not collective. stride is at least block->n.
*/
typedef void (*MpmWeights)(const MpmBlock *block, PetscInt stride, PetscReal weight[]);

/*S
   MpmBasis - a family of basis functions, one function a node. The function of node i is centred on the node, which is
   the left end of cell i. With open ends, node i is the i-th function.

   name, summary, reference - the word of the option basis, a line about it, and its source
   reach_left, reach_right  - a particle in cell i has weights at nodes i - reach_left to i + reach_right at most
   nodes       - the number of nodes that a particle has weights at in each direction, at most MPM_MOST_NODES
   wall_nodes  - between walls there are so many nodes more than cells
   spline_ends - how functions next to walls differ from all others
   slope_sum   - a bound of h sum_i abs(dphi_ip/dx)
   curve_sum   - a bound of h^2 sum_i abs(d2phi_ip/dx2), and of h times the sum of the slopes of DIV_MLS's weights; 0
                 for hats, whose slopes do not change but on nodes
   moment      - sum_i phi_ip (x_i - x_p)^2 / h^2 where it is the same at all places; 0 where it is not
   smooth      - the slopes of the functions have slopes at any place of a particle
   weights     - by kind of operation; NULL for kinds that are no map between particles and nodes, and for curves where
                 slopes do not change
   first_nodes - for n particles at xi in cells cell, the first node that each has a weight at
   hat         - the functions are hats, for which the slides' formulas are
   wide        - the functions depend on the width of the particle
S*/
typedef struct {
  const char   *name, *summary, *reference;
  PetscInt      reach_left, reach_right, nodes, wall_nodes;
  MpmSplineEnds spline_ends;
  PetscReal     slope_sum, curve_sum, moment;
  PetscBool     smooth;
  MpmWeights    weights[MPM_OP_KINDS];
  void (*first_nodes)(PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscInt first[]);
  PetscBool hat;
  PetscBool wide;
} MpmBasis;

/* Not collective. All bases, NULL-terminated. */
extern const MpmBasis *const MpmBases[];

/* Not collective. Whether a basis has other functions next to walls than elsewhere. */
static inline PetscBool MpmBasisIsAltered(const MpmBasis *basis)
{
  return basis->spline_ends != MPM_SPLINES_MIRRORED ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. A basis of the list with other functions next to walls, or NULL when it has no such choice. */
const MpmBasis *MpmBasisWithEnds(const MpmBasis *basis, MpmSplineEnds ends);

/*
   MpmBasisCheck - refuses a basis whose weights do not fit into the arrays for them, or whose particles have weights at
   nodes beyond its reach. Such weights would be lost.

   Not collective. Errors: PETSC_ERR_ARG_OUTOFRANGE.
*/
PetscErrorCode MpmBasisCheck(const MpmBasis *basis);

/* Not collective. The basis of a name, or NULL when there is none. */
const MpmBasis *MpmBasisFind(const char name[]);
