/*
   Tangent: the derivative of a step of a nonlinear scheme with respect to the state before it (theory of the tangent,
   docs/theory.md, section 11). It is made of the same table as the step: each operation is followed by its
   differential.
*/
#pragma once
#include "march/march_private.h"
#include "program/program.h"

/*S
   MpmTangentSpace - what the tangents of one scheme have in common.

   sizes  - which particles and nodes this rank has
   nstate - the number of fields of a state: the places in each direction, in cells, and then the registers of the
            table's state. Unknown f of particle id has the number nstate id + f.
   work   - the memory in which tangents are applied; they share it
   branch, on_surface - with a material that flows: which derivative particles on the yield surface have, and how many
            of them the last tangent has met there, on all ranks
S*/
typedef struct {
  MpmSlab     sizes;
  PetscInt    nstate;
  MpmVectors *work;
  MpmBranch   branch;
  PetscInt64  on_surface;
} MpmTangentSpace;

/*S
   MpmTangentState - a state that a tangent is taken at, of this rank's particles in the order of their ids.

   places - where they are
   field  - the registers of the table's state
   time   - of the state, at which colliders are where they are
   load   - the body force on each particle in each direction, which does not depend on the state, in units of c^2 / h
S*/
typedef struct {
  MpmParticlePlaces places;
  PetscReal         time;
  Vec               field[MPM_MAX_FIELDS], load[MPM_MAX_DIM];
} MpmTangentState;

/*
   MpmTangentSpaceCreate - makes what the tangents of a scheme have in common. layout and scheme must outlive it. Its
   members are freed with MpmTangentSpaceDestroy, and tangents may outlive it.

   Collective.
*/
PetscErrorCode MpmTangentSpaceCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme,
                                     MpmTangentSpace *space);
PetscErrorCode MpmTangentSpaceDestroy(MpmTangentSpace *space);

/* Collective. Memory for a state, with places and fields that are 0. */
PetscErrorCode MpmTangentStateCreate(const MpmTangentSpace *space, MpmTangentState *state);
PetscErrorCode MpmTangentStateDestroy(const MpmTangentSpace *space, MpmTangentState *state);

/*
   MpmTangentRoom - how far the particles of a state are from places where the step has no derivative, in cells: the
   least distance of any particle, in any direction. On hats these places are the nodes, where the slopes of the weights
   jump, and the tangent holds for perturbations that take no particle there. On quadratic splines they are the middles
   of cells, and with gimp where the edge of a particle meets a node: there the slopes of the slopes jump. Infinite for
   cubic splines.

   MpmTangentCheck - refuses (PETSC_ERR_USER_INPUT) a state with a particle at such a place. In a run that goes through
   such a state the tangent is that of one side.

   Collective.
*/
PetscErrorCode MpmTangentRoom(const MpmTangentSpace *space, const MpmTangentState *state, PetscReal *room);
PetscErrorCode MpmTangentCheck(const MpmTangentSpace *space, const MpmTangentState *state);

/*
   MpmTangentOf - the tangent of one step at a state.

   Collective.

   Input Parameters:
+  courant - the Courant number of the step
-  state   - the state before the step

   Output Parameters:
+  tangent - a MATSHELL with products and transposed products
-  after   - NULL, or the vectors of the state after the step: how far particles have moved in each direction, in cells,
             and then the registers of the table's state. This is the step itself, by sparse matrices.
*/
PetscErrorCode MpmTangentOf(MpmTangentSpace *space, PetscReal courant, const MpmTangentState *state, Mat *tangent,
                            Vec after[]);

/* Collective. The tangent as a sparse matrix, and the bytes that it takes as a MATSHELL. */
PetscErrorCode MpmTangentAssemble(Mat tangent, Mat *matrix);
PetscErrorCode MpmTangentBytes(Mat tangent, PetscReal *bytes);

/* ---- the states of a march ---- */

/*
   MpmMarchPut - puts a field of a march's particles, of whole numbers or of others, plus a number, into a column of
   all, a table with a row for each id.

   Collective. The caller assembles the vector.
*/
PetscErrorCode MpmMarchPut(const MpmMarch *march, const char name[], PetscBool whole, PetscReal plus, PetscInt columns,
                           PetscInt column, Vec all);

/*
   MpmTangentStateOf - copies the present state of a march of the space's scheme, particles in the order of their ids.

   Collective.
*/
PetscErrorCode MpmTangentStateOf(const MpmTangentSpace *space, const MpmMarch *march, MpmTangentState *state);

/*
   MpmTangentMismatch - takes a march through its next step, and compares it with the step that the tangent at the state
   before is made of. The result is the largest difference of a place, in cells, or of a field, over the largest number
   of that field or 1.

   Collective. tangent: that of the step. The result is NaN when the march fails in this step.
*/
PetscErrorCode MpmTangentMismatch(MpmTangentSpace *space, MpmMarch *march, Mat *tangent, PetscReal *mismatch);
