/*
   What the nodes need to know of a step, for particles at rest. MpmNodalPlanCreate derives it from a table alone.

   A particle register is, at every point of a step, c q plus a sum of terms W y. q is its value at the start, c a
   number, y what some node register held, and W a map from nodes to particles. A map P to the nodes makes of it c (P q)
   plus a sum of (P W) y. So the nodes need only the images z = P q of what the particles hold at the start, and a step
   takes these to

     z' = c z + sum of (P W) y

   where the y are again sums over images. Images that are only ever read together are one: DIV of a stress is one
   vector. The eigenvalues of this nodal operator are those of the operator A of all particles, but for numbers c: on
   data that all images map to 0, A is c. So a usl step with flip in one dimension has two numbers a node, P v and DIV s, however
   many particles there are.
*/
#pragma once
#include "linalg/reduced.h"
#include "program/program.h"
#include <mpmstab/operator.h>
#include <complex.h>

#define MPM_MAX_IMAGES 16 /* the most images of a plan */

/*S
   MpmNodalImage - an unknown at each node: a sum of n operations from registers of the state to nodes, each times its
   factor. A step multiplies the registers of all of them by c before it adds to them.
S*/
typedef struct {
  PetscInt  n;
  MpmOp     term[MPM_MAX_FIELDS];
  PetscReal c;
} MpmNodalImage;

/*S
   MpmNodalMap - a map from nodes to nodes: P W, with P that of to_nodes and W that of to_particles, or where it is no
   product that of to_nodes, an operation between nodes. Of a WALL it is the selection of the wall's nodes: 1 on them, 0
   on others. The operations' factors do not count.
S*/
typedef struct {
  PetscBool product;
  MpmOp     to_nodes, to_particles;
} MpmNodalMap;

/*S
   MpmNodalSent - a part of what a step adds to a particle register op->dst: the operation of the table, its number
   there, and the slot that it reads.
S*/
typedef struct {
  MpmOp    op;
  PetscInt at, slot;
} MpmNodalSent;

/*S
   MpmNodalPlan - the nodal operator of a table: a program without matrices, all of whose lines accumulate. Its
   registers are slots, with a number at each node. Slot g starts as image g, for g < nimages, and all others as 0.

   nimages, image - the unknowns
   nslots, nmaps, map, program - the slots, the maps by their keys, and the program
   next    - next[g]: the slot that holds image g after the step
   nsent, sent, nlines_sent - what a step adds to the registers of the state; the first nlines_sent lines make the slots
             that it reads
   kept    - kept[r]: the number c of state register r
   powers  - powers[s x nimages + g]: bit j is set where slot s may have a part k^j times image g
   weight, stride, degree - the operator on k^weight[g] z_g, which has the same eigenvalues, is a polynomial of this
             degree in k^stride. stride is 2 where that is possible, as it is for all waves of second order, and else 1.
S*/
typedef struct {
  PetscInt        dim, nstate, nimages, nslots, nmaps;
  MpmNodalImage   image[MPM_MAX_IMAGES];
  MpmNodalMap    *map;
  MpmStepProgram *program;
  PetscInt        next[MPM_MAX_IMAGES], weight[MPM_MAX_IMAGES], stride, degree;
  PetscReal       kept[MPM_MAX_FIELDS];
  PetscInt64     *powers;
  PetscInt        nsent, nlines_sent;
  MpmNodalSent   *sent;
} MpmNodalPlan;

/*
   MpmNodalPlanCreate - derives the plan of a table, for particles at rest.

   Collective. plan: NULL where the table has none. why: NULL, or why that is so; the reason is NULL for a table that
   reads so many sums that it has more than MPM_MAX_IMAGES images. Other tables without a plan come from schemes as text
   that add a particle field to another one of the state, or multiply one by the Courant number. Scratch may be set to a
   field.

   Errors: where why is NULL, refuses (PETSC_ERR_USER_INPUT) a table without a plan.
*/
PetscErrorCode MpmNodalPlanCreate(const MpmTable *table, const char **why, MpmNodalPlan **plan);
PetscErrorCode MpmNodalPlanDestroy(MpmNodalPlan **plan);

/*
   MpmNodalRun - the nodal operator as a polynomial, C_0 + x C_1 + x^2 C_2 + ... with x = k^stride, on the unknowns
   k^weight[g] z_g.

   Not collective.

   Input Parameters:
+  plan    - the plan
.  nodes   - the number of nodes; with 1 and the symbols of the maps, the operator of a Bloch mode comes out
.  map     - makes the matrix of a map of the plan, nodes x nodes by columns, of zeros
-  context - for map

   Output Parameter: coefficient - coefficient[j], j <= degree: n x n by columns, n = nimages x nodes. Unknown g of node
                     i has the number g nodes + i.
*/
typedef PetscErrorCode (*MpmNodalMapMatrix)(void *context, const MpmNodalMap *map, double complex matrix[]);
PetscErrorCode MpmNodalRun(const MpmNodalPlan *plan, PetscInt nodes, MpmNodalMapMatrix map, void *context,
                           double complex *const coefficient[]);

/*
   ---- the nodal operator of a layout as a sparse matrix, with its maps to and from the particles (nodal_matrix.c) ----
*/

/*
   MpmNodalMatrixUnknowns - the order of the nodal operator of a layout, or 0 where it is not smaller than that of the
   particles or does not have its eigenvalues: particles that drift, tables without a plan, more
   unknowns on nodes than on particles.

   Not collective.
*/
PetscErrorCode MpmNodalMatrixUnknowns(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                      PetscInt64 *unknowns);

/*
   MpmNodalMatrixCreate - the nodal operator M of a layout at rest, the images Z that nodes have of the particles, and
   what B a step sends to the particles: A = C + B Z (see MpmReduced), with A the operator of one step.

   Collective. layout and scheme must outlive it; MpmReducedDestroy destroys it. Call it where MpmNodalMatrixUnknowns is
   not 0. unit: NULL, or that of an operator, which then is its balanced in place of A.

   Unknown g of node i has the number g + images x i. The slab of nodes of a rank is that of its registers (MpmSlab).
   B is a shell that runs the plan on vectors.
*/
PetscErrorCode MpmNodalMatrixCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme,
                                    const MpmStep *step, Vec unit, MpmReduced **nodal);

/*
   MpmNodalMatrixOf - the nodal operator of an operator, checked against it, or NULL where it has none or the check
                      fails.

   Collective.
*/
PetscErrorCode MpmNodalMatrixOf(const MpmOperator *op, MpmReduced **nodal);
