/*
   Table: the list of operations of one step. MpmTableCreate makes it from a formulation, a transfer and a boundary. The
   march, the operator and the symbol interpret it.
*/
#pragma once
#include <mpmstab/boundary.h>
#include <mpmstab/material.h>
#include <mpmstab/transfer.h>

/*S
   MpmTable - the operations of one step, in order, and the registers they work on. A register is a number at each
   particle or node: a component of a field of the formulation. The registers of a field follow one another; a stress
   has its components in the order 00 01 02 11 12 22.

   dim           - the number of space dimensions
   nops, room    - the number of operations, and of those that ops has memory for
   ops           - the operations
   nstate        - particle registers [0, nstate) are the state, which goes on from step to step
   nkept         - particle registers [nstate, nstate + nkept) live to the end of a step: how far particles have gone in
                   it, where they move in stages. They go along with the particles to other ranks
   nparticles    - particle registers [nstate + nkept, nparticles) are scratch: SCALE sets them to 0, G2P fills them,
                   P2G sends them to nodes, and after that they hold nothing
   nnodes        - the number of node registers
   unfiltered    - the number of state registers that no filter acts on
   fields        - the names of the state registers, NULL-terminated; with more than one dimension v_x, s_xy and so on
   field         - field[r]: the field of the formulation that state register r is a component of, MPM_NONE for an
                   affine part, MPM_DISPLACEMENT or MPM_STRETCHED
   component     - component[r]: which of the field's components it is
   parity        - parity[n][a]: what node register n is beyond the ends of direction a
   filtered      - filtered[r]: the filter of the transfer acts on state register r
   stretch       - at finite deformation the first register of the stretch F, which has dim rows of dim numbers, and
                   after them the internal variables of the material (MpmTableStretches); else MPM_NONE
   material      - the material that gives a stress at a stretch
   displacement  - the first register of the displacement of particles, or MPM_NONE
   affine        - the first register of the vector that has an affine part, or MPM_NONE
   affine_part   - the first register of the affine part: dim rows, one for each component of the vector, of dim numbers
   affine_map    - the kind of operation that fills the affine part from nodes: G2P_AFFINE or G2P_SLOPE
   ends          - the kinds of the left and of the right end of each direction
   nstiff, stiff - the tables of the K of IMPLICIT, one for each vector that is solved for (MpmTableStiffness). They
                   have the registers of this table, and lines of their own: GRAD of the vector from register solved on
                   to scratch, DIV of that to the registers from image on, and walls. So image = K solved. At finite
                   deformation they have, from register solved on, the velocity w = start + theta a_i in the middle of
                   the step, and image is the acceleration there, both in units of h and of k h: a_i = k image of w = k
                   (start + theta a_i). start: the first register of the velocity before the step; theta: the part of
                   the step at which the stress is taken
   where, transfer - what messages call the formulation, and the transfer
S*/
#define MPM_MAX_STIFF 4
struct MpmTable_ {
  PetscInt           dim, nops, room;
  MpmOp             *ops;
  PetscInt           nstate, nkept, nparticles, nnodes, unfiltered;
  const char        *fields[MPM_MAX_FIELDS + 1];
  char               names[MPM_MAX_FIELDS][16]; /* what fields points to, and those of what is kept */
  PetscInt           field[MPM_MAX_FIELDS], component[MPM_MAX_FIELDS];
  MpmParity          parity[MPM_MAX_FIELDS][MPM_MAX_DIM];
  PetscBool          filtered[MPM_MAX_FIELDS];
  PetscInt           stretch, displacement, affine, affine_part;
  MpmMaterialNumbers material;
  MpmOpKind          affine_map;
  MpmEnd             ends[MPM_MAX_DIM][2];
  PetscInt           nstiff, solved, image, start;
  PetscReal          theta;
  MpmTable          *stiff[MPM_MAX_STIFF];
  char               where[512];
  const MpmTransfer *transfer;
};

/* Collective. Refuses the table of finite deformation, for those who interpret linear operations alone. */
PetscErrorCode MpmTableRequireLinear(const MpmTable *table);

/* Not collective. Whether particles carry a stretch and move each by itself. */
static inline PetscBool MpmTableIsFinite(const MpmTable *table)
{
  return table->stretch != MPM_NONE ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. The number of registers of the stretch, with the internal variables of the material. */
static inline PetscInt MpmTableStretches(const MpmTable *table)
{
  return MpmMaterialComponents(&table->material, table->dim);
}

/*
   Not collective. The number of particle registers that have arrays of their own: the state and what is kept in a step.
*/
static inline PetscInt MpmTableHeld(const MpmTable *table)
{
  return table->nstate + table->nkept;
}

#define MPM_MAX_NODE_OPS 128 /* the largest number of operations on nodes that follow one another */

/*E
   MpmGradient - the weights of DIV and GRAD.

   MPM_GRADIENT_BASIS - the gradient of the basis functions
   MPM_GRADIENT_MLS   - phi_ip (x_i - x_p) / D_p, as in MLS-MPM (Hu et al. 2018)
E*/
typedef enum { MPM_GRADIENT_BASIS, MPM_GRADIENT_MLS } MpmGradient;
extern const char *const MpmGradientNames[];

/*E
   MpmFilterTime - when the transfer's filter acts in a formulation that has both places, FILTER_BEFORE and
   FILTER_AFTER. Momentum schemes have one place, FILTER, which is that of after.

   MPM_FILTERS_AFTER  - nodes take the particles' values as they are; then the filter acts. pic is then the textbook's:
                        particles take the new values of the grid.
   MPM_FILTERS_BEFORE - the filter acts first, and nodes take what it leaves
E*/
typedef enum { MPM_FILTERS_AFTER, MPM_FILTERS_BEFORE } MpmFilterTime;
extern const char *const MpmFilterTimeNames[];

/*E
   MpmMove - the velocity of the grid that particles move with.

   MPM_MOVES_WITH_GRID - the new velocity of the grid, before particles send theirs a second time
   MPM_MOVES_PROJECTED - the velocity of the second P2G, in formulations that have one
E*/
typedef enum { MPM_MOVES_WITH_GRID, MPM_MOVES_PROJECTED } MpmMove;
extern const char *const MpmMoveNames[];

/*S
   MpmSpace - what a table depends on besides formulation and transfer.

   dim      - the number of space dimensions
   gradient - the weights of DIV and GRAD
   poisson  - Poisson's ratio nu, from 0 to 1/2; plane strain with dim 2. With 1/2 the material is a fluid. With dim 1
              it has no effect. In units of rho c^2, c the speed of P waves, the Lame constants are
              lambda = nu / (1 - nu) and mu = (1 - 2 nu) / (2 (1 - nu)).
   lames    - lambda and mu are properties of particles, and poisson gives the unit alone
   filter   - when the transfer's filter acts, in formulations with FILTER_BEFORE and FILTER_AFTER
   prestress - sigma0 / (rho c^2), the stress of the state that the scheme is linear about, with the components 00 01 02
              11 12 22; 0: without one. c is the speed of small P waves along x about this state. In one dimension it is
              one number s0, and c^2 = F0^2 P'(F0) / rho0.
   lambda, mu, squares - with a prestress in more dimensions the stiffness of the state, in units of rho c^2:
              c_abcd = lambda q_a q_c d_ab d_cd + mu q_a q_b (d_ac d_bd + d_ad d_bc), q = squares, d the identity. It is
              that of the Truesdell rate (docs/theory.md, section 9).
   curved   - the slopes of the basis functions change within a cell. Those of hats do not along their own direction.
   displaced - particles carry their displacement, which the prestress makes a force of. Not with hats in one dimension,
              where there is none.
   move     - with a prestress, the velocity that particles move with
   finite   - finite deformation: particles carry the stretch F and move with the grid's velocity. There is no prestress
              then, and poisson has no effect beside that of the material.
   loaded   - at finite deformation a body force acts
   material - at finite deformation the material
   stretch  - at finite deformation the uniform stretch of the start along each direction
   stiffness - at finite deformation c0^2 / c^2, where c0 is the wave speed at rest, the unit of the material, and c
              that of the Courant number
   collides - there are colliders (collider.h): IMPOSE and REACT of a vector have their COLLIDE besides
   ends     - the kinds of the left and of the right end of each direction. IMPOSE and REACT become WALL at those that
              are fixed, and nothing at others.
   damping  - alpha, the part of the velocity that is lost per time, in units of c / h
   local    - the part of the force on a node that is taken off against its velocity (Cundall). The step is not linear
              then.
   viscous  - lambda and mu of the viscous stress lambda tr(D) I + 2 mu D, D the symmetric part of the velocity's
              gradient, in units of rho c h. At finite deformation this is a Kirchhoff stress.
   proportional - the viscous stress is that of STRESS at a strain of D times a number, which is lambda + 2 mu
S*/
typedef struct {
  PetscInt      dim;
  MpmGradient   gradient;
  PetscReal     poisson;
  PetscBool     lames;
  MpmFilterTime filter;
  PetscReal     prestress[MPM_MAX_STRESS], lambda, mu, squares[MPM_MAX_DIM];
  PetscBool     curved, displaced;
  MpmMove       move;
  PetscBool     finite, loaded, collides;
  PetscReal     stretch[MPM_MAX_DIM], stiffness;
  MpmEnd        ends[MPM_MAX_DIM][2];
  PetscReal     damping, local, viscous[2];
  PetscBool     proportional;

  MpmMaterialNumbers material;
} MpmSpace;

/* Not collective. Whether a table has terms of damping or viscosity (src/scheme/table_damping.c). */
static inline PetscBool MpmSpaceIsDamped(const MpmSpace *space)
{
  return space->damping != 0 || space->local != 0 || space->viscous[0] != 0 || space->viscous[1] != 0 ||
                 MpmMaterialIsViscous(&space->material)
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/*
   Not collective. What a motion whose strains have the stiffness kappa loses per time, in units of c / h: alpha + eta
   kappa.
*/
static inline PetscReal MpmSpaceDrag(const MpmSpace *space, PetscReal kappa)
{
  return space->damping + (space->viscous[0] + 2 * space->viscous[1]) * kappa;
}

/* Not collective. Whether the state that a scheme is linear about has a stress. */
PetscBool MpmSpaceIsPrestressed(const MpmSpace *space);

/* Not collective. The component ab of the prestress. */
PetscReal MpmSpacePrestress(const MpmSpace *space, PetscInt a, PetscInt b);

/*
   MpmSpaceTangent - d s_ab / d (dv_c/dx_d), the change of the stress per change of the velocity's gradient in a step
   that is linear about a prestress, in units of rho c^2:

     c_abcd + d_ac sigma0_db + sigma0_ad d_bc

   It multiplies the gradient in GRAD to a stress. Of a fluid it is (1 + s0) d_ab d_cd, of which GRAD has d_ab d_cd and
   DIV the rest. Not collective. Source: docs/theory.md, section 9.
*/
PetscReal MpmSpaceTangent(const MpmSpace *space, PetscInt a, PetscInt b, PetscInt c, PetscInt d);

/*
   MpmSpaceMirrors - whether a space is its own mirror image in direction a, MpmSpaceAlike whether it is the same when
   directions a and b are exchanged. A prestress with shear is not.

   Not collective.
*/
PetscBool MpmSpaceMirrors(const MpmSpace *space, PetscInt a);
PetscBool MpmSpaceAlike(const MpmSpace *space, PetscInt a, PetscInt b);

/* Not collective. Whether a space is that of a fluid, whose stress is one number, the pressure. */
static inline PetscBool MpmSpaceIsFluid(const MpmSpace *space)
{
  return space->dim > 1 && space->poisson == 0.5 && !space->finite ? PETSC_TRUE : PETSC_FALSE;
}

/*
   MpmTableCreate - makes a table from a formulation and a transfer.

   Not collective.

   Input Parameters:
+  formulation - its table of operations on fields, which may contain FILTER, IMPOSE and REACT
.  transfer    - the operations that take the place of FILTER; for flip there are none
.  numbers     - the numbers that formulation and transfer are given
-  space       - the dimension, the gradient, the material and the ends

   Output Parameter: table - destroyed with MpmTableDestroy

   Each operation on fields is written out for their components:

     P2G, G2P, SCALE, COPY   one for each component
     DIV of a stress         a_a = sum_b DIV_b s_ab
     DIV of a number         a_a = DIV_a r
     DIV of a vector         a = sum_b DIV_b u_b
     GRAD to a stress        s_ab += lambda delta_ab sum_c GRAD_c v_c + mu (GRAD_b v_a + GRAD_a v_b), for a fluid
                             s += sum_c GRAD_c v_c
     GRAD to a vector        u_a += GRAD_a r
     GRAD to a number        r += sum_a GRAD_a u_a
     LAP                     the sum over the directions
     MOVE                    x_a += k G2P_a, with a prestress, in cells
     with a prestress (theory of the tangent, docs/theory.md, section 9):
     DIV of a stress         a_a = sum_b DIV_b s_ab + sum_bc sigma0_ab CURVE_bc x_c; in one dimension, and of a fluid,
                             (1 + s0) DIV for DIV
     GRAD to a stress        s_ab += sum_cd MpmSpaceTangent_abcd GRAD_d v_c; in one dimension, and of a fluid, as without

   At finite deformation the operations on the stress become those of table_finite.c: STRESS, STRETCH and ADVANCE.

   With a transfer that has an affine part, each P2G, G2P and SCALE of the vector that has it is followed by those of
   that part, one for each direction. Particles take what a transfer's sharpen makes of node fields, in G2P and GRAD.

   Errors: PETSC_ERR_USER_INPUT for a written scheme with more registers or operations than fit. PETSC_ERR_SUP for a
   table that the interpreters do not support; it is an error of the program. They support none of these: an operation
   to particles that replaces, a SCALE, SOLVE or WALL that accumulates, a stencil on its own result, an axis that the
   table does not have, a sum that is continued after something else than sums, a node field that is read before the
   step has written to it, and fields of ranks that do not go together.
*/
PetscErrorCode MpmTableCreate(const MpmFormulation *formulation, const MpmTransfer *transfer,
                              const MpmSchemeNumbers *numbers, const MpmSpace *space, MpmTable **table);
PetscErrorCode MpmTableDestroy(MpmTable **table);

/*
   These functions are for the filters of transfers. Not collective.

   MpmTableAppend       - appends an operation on registers, and those on the affine part that belong to it
   MpmTableAppendOwn    - appends an operation on registers, and none on the affine part
   MpmTableAppendAffine - appends only the operations on the affine part that belong to an operation on registers
   MpmTableNode         - adds a node register, of the parity of the node register like
   MpmTableScratch      - adds a scratch particle register

   Errors: PETSC_ERR_PLIB when there are more than MPM_MAX_FIELDS registers.
*/
PetscErrorCode MpmTableAppend(MpmTable *table, MpmOp op);
PetscErrorCode MpmTableAppendOwn(MpmTable *table, MpmOp op);
PetscErrorCode MpmTableAppendAffine(MpmTable *table, MpmOp op);
PetscErrorCode MpmTableNode(MpmTable *table, PetscInt like, PetscInt *node);
PetscErrorCode MpmTableScratch(MpmTable *table, PetscInt *particle);

/*
   MpmTableImpose - sets a node register that P2G has just filled to 0 at the ends where its parity says so
   (MpmEndImposes). The filters of transfers call it.

   Not collective.
*/
PetscErrorCode MpmTableImpose(MpmTable *table, PetscInt node);

/*
   Not collective. The first operation that takes a particle register to the nodes: P2G, or DIV for a stress. NULL when
   the table has none.
*/
const MpmOp *MpmTableSeenBy(const MpmTable *table, PetscInt particle);

/* Not collective. The parity of P2G of a particle register, by direction. */
const MpmParity *MpmTableParity(const MpmTable *table, PetscInt particle);

/*
   Not collective. Whether the table has an operation of a kind. MpmTableSolves: SOLVE or IMPLICIT, which couple all
   nodes.
*/
PetscBool MpmTableHas(const MpmTable *table, MpmOpKind kind);
PetscBool MpmTableSolves(const MpmTable *table);

/* Not collective. The table of K of an operation IMPLICIT. */
const MpmTable *MpmTableStiffness(const MpmTable *table, const MpmOp *implicit);
