/* Basis functions: which nodes a particle has weights at, and the maps between particles and nodes. */
#pragma once
#include <mpmstab/formulation.h>

#define MPM_BLOCK 256    /* the largest number of particles in a block */
#define MPM_MOST_NODES 6 /* that a particle has weights at along one direction; all arrays for these follow from it */

/*S
   MpmBlock - the places of a block of particles. The kernels of a basis need them besides the data.

   n          - the number of particles, at most MPM_BLOCK. Their order is that of their cells for speed; any order is
                correct.
   xi         - xi[p] in [0,1): the place of particle p in its cell, in cells
   first      - first[p]: the local index of the first node that particle p has a weight at
   half_width - half of a particle's width, in cells; only bases with wide set use it
   wall       - the local indices of the first and the last node of the direction, or MpmNoWalls; only bases whose
                functions differ near walls use it
   begin, end, length - particles [begin, end) come in runs of length particles each. Those of a run have the same first
                node; the first node of the next run is one further on. begin = end = n: there are no such runs.
S*/
typedef struct {
  PetscInt         n, begin, end, length, first[MPM_BLOCK];
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
   MpmKernel - a map between the particles of a block and the nodes. phi_ip is the basis function of node i at particle
   p, and a is the argument:

     P2G         node[i]     += a sum_p phi_ip particle[p]
     P2G_AFFINE  node[i]     += a sum_p phi_ip particle[p] (x_i - x_p) / h
     DIV         node[i]     += a h sum_p dphi_ip/dx particle[p]
     DIV_MLS     node[i]     += a sum_p phi_ip particle[p] (x_i - x_p) h / sum_j phi_jp (x_j - x_p)^2
     CURVE       node[i]     += a h^2 sum_p d2phi_ip/dx2 particle[p]
     CURVE_MLS   node[i]     += a sum_p particle[p] h d/dx_p of the weight of DIV_MLS
     G2P         particle[p] += a sum_i phi_ip node[i]
     G2P_AFFINE  particle[p] += a sum_i phi_ip node[i] (x_i - x_p) h / sum_i phi_ip (x_i - x_p)^2
     GRAD        particle[p] += a h sum_i dphi_ip/dx node[i]
     GRAD_MLS    particle[p] += as G2P_AFFINE
     G2P_SLOPE   particle[p] += as GRAD

   Not collective. The kernel does not divide the sums at nodes by the nodal masses. Node i is the left end of cell i.
   No two arrays overlap.
*/
typedef void (*MpmKernel)(const MpmBlock *block, PetscReal a, PetscReal particle[], PetscReal node[]);

/*
   MpmMassKernel - P2G with a = 1 and the nodal masses in one loop, for particles that have moved and have equal masses:

     node[i] += sum_p phi_ip particle[p],    mass[i] += sum_p phi_ip

   Not collective.
*/
typedef void (*MpmMassKernel)(const MpmBlock *block, const PetscReal particle[], PetscReal node[], PetscReal mass[]);

/*
   MpmWeights - the weights of the NODES nodes of each particle of a block, as they are in the sum of a kernel that goes
   to nodes: weight[d * stride + p] is that of node first[p] + d.

   Not collective. stride is at least block->n, or 1 for one particle.
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
   curve_sum   - a bound of h^2 sum_i abs(d2phi_ip/dx2), and of h times the sum of the slopes of DIV_MLS's weights; 0 for
                 hats, whose slopes do not change but on nodes
   moment      - sum_i phi_ip (x_i - x_p)^2 / h^2 where it is the same at all places; 0 where it is not
   smooth      - the slopes of the functions have slopes at any place of a particle
   kernel      - the maps, by kind of operation; NULL for kinds that are no map between particles and nodes
   p2g_mass    - P2G with the nodal masses
   weights     - the weights of the kernels that go to nodes, by kind; NULL for all other kinds
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
  MpmKernel     kernel[MPM_OP_KINDS];
  MpmMassKernel p2g_mass;
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
