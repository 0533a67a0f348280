/* Basis functions: which nodes a particle sees, and the maps written for them. */
#pragma once
#include <mpmstab/formulation.h>

#define MPM_BLOCK 256 /* particles that go through a pass together, at most */

/*S
   MpmBlock - where a block of particles is: what kernels need to know of them besides the data.

   Particles come in the order of their cells for speed (any order is correct). xi[p] in [0,1) is a particle's place in
   its cell, first[p] the local index of the first node that it sees; half_width is half of a particle's width, in cells, for
   bases that have one. Particles [begin, end) come in runs of length: those of a run see the same nodes, those of the
   next run the nodes one further on. begin = end = n: nothing of the kind.
S*/
typedef struct {
  PetscInt         n, begin, end, length, first[MPM_BLOCK];
  const PetscReal *xi;
  PetscReal        half_width;
} MpmBlock;

/*
   Every map between particles and nodes has this shape:

     P2G         node[]     += a sum over particles of phi_ip particle[p]
     P2G_AFFINE  node[]     += a sum over particles of phi_ip particle[p] (x_i - x_p) / h
     DIV         node[]     += a h sum over particles of dphi_ip/dx particle[p]
     G2P         particle[] += a sum_i phi_ip node[i]
     G2P_AFFINE  particle[] += a sum_i phi_ip node[i] (x_i - x_p) h / sum_i phi_ip (x_i - x_p)^2
     GRAD        particle[] += a h sum_i dphi_ip/dx node[i]

   What goes to nodes is not yet divided by mass. Node i is at the left of cell i. All arrays are distinct.
*/
typedef void (*MpmKernel)(const MpmBlock *block, PetscReal a, PetscReal particle[], PetscReal node[]);

/* P2G and the nodal masses in one go, for particles that have moved: mass[] += sum over particles of phi_ip. */
typedef void (*MpmMassKernel)(const MpmBlock *block, const PetscReal particle[], PetscReal node[], PetscReal mass[]);

/*S
   MpmBasis - a basis: its reach and its maps.

   A particle in cell i sees the nodes i - reach_left to i + reach_right; node i is at the left of cell i, where its
   function has its middle. slope_sum bounds h sum_i abs(dphi_ip/dx). kernel[] is by kind of operation; first_nodes
   says for particles in cells where the nodes begin that they see.
S*/
typedef struct {
  const char   *name, *summary, *reference;
  PetscInt      reach_left, reach_right;
  PetscReal     slope_sum;
  MpmKernel     kernel[MPM_OP_KINDS];
  MpmMassKernel p2g_mass;
  void (*first_nodes)(PetscInt n, const PetscInt cell[], const PetscReal xi[], PetscInt first[]);
  PetscBool hat;  /* the slides' formulas are for this basis */
  PetscBool wide; /* its functions depend on the particle's width */
} MpmBasis;

/* Not collective. All bases, NULL-terminated. */
extern const MpmBasis *const MpmBases[];

/* Not collective. Looks a basis up by name; NULL when there is none. */
const MpmBasis *MpmBasisFind(const char name[]);
