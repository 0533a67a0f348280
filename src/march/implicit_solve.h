/* The operation IMPLICIT on the grid of the march. */
#pragma once
#include "march/finite.h"
#include <petscsnes.h>

/*E
   MpmAhead - what STRESS_AHEAD does in a pass of a nonlinear system: the stress T; T and its tangent; or the product of
              the tangent.
E*/
typedef enum { MPM_AHEAD_STRESS, MPM_AHEAD_TANGENT, MPM_AHEAD_PRODUCT } MpmAhead;

/*S
   MpmImplicitSolve - solves (1 + a K) y = f on the nodes. With the nodal masses M this is the symmetric system

     (M + a M K) y = M f

   of conjugate gradients, which options -implicit_* change. M K is DIV STRESS GRAD without the division by masses; a
   product with it is one pass over the particles. Nodes without mass, and components that a wall fixes, have y = f,
   which is 0.

   k         - the table of K; schedule: its pass
   shell     - the matrix of the system, which has products alone
   blocks    - what the preconditioner is made of: the blocks of a node on the diagonal or, where another preconditioner
               than pbjacobi, jacobi or none is asked for, the whole matrix
   term      - term[c][b][a][d]: the number by which K has slopes along b of component c's weights times those along d
               of component a's
   a, step   - of the blocks as they stand
   iterations, seconds - of all solves so far

   At finite deformation it solves M (a_i - k f(k (v_i + theta a_i))) = 0 by Newton's method, where f is one pass of the
   table k (MpmTable). Forces have a potential, so that the tangent is symmetric.

   snes      - NULL where the system is linear
   velocity, middle - v_i, and k (v_i + theta a_i)
   tangent   - dT_r / dL_c of particle p at (c dim^2 + r) room + p; room: the particles that it has room for
   does      - what a pass does; inverted: it has met a particle without a positive volume
   newton    - the iterations of Newton's method so far; iterations are those of its linear systems
S*/
struct MpmImplicitSolve_ {
  MpmMarch       *march;
  const MpmTable *k;
  MpmSchedule     schedule;
  MpmOpKind       slope;
  PetscReal       term[MPM_MAX_DIM][MPM_MAX_DIM][MPM_MAX_DIM][MPM_MAX_DIM], a;
  PetscBool       whole;
  Mat             shell, blocks;
  Vec             right, solution;
  KSP             ksp;
  PetscInt64      step, iterations, newton;
  PetscReal       seconds, *tangent;
  SNES            snes;
  Vec             velocity, middle;
  PetscInt        room;
  MpmAhead        does;
  PetscBool       inverted;
};

/* Collective. march must outlive the solve, and have grid and particles. */
PetscErrorCode MpmImplicitSolveCreate(MpmMarch *march, const MpmTable *k, MpmImplicitSolve **solve);
PetscErrorCode MpmImplicitSolveDestroy(MpmImplicitSolve **solve);

/*
   MpmImplicitBlocksCreate - makes blocks, of the kind that whole says, and finds slope and term (implicit_blocks.c).
   MpmImplicitBlocksFill   - fills blocks with M + a M K at the places of step.

   Collective.
*/
PetscErrorCode MpmImplicitBlocksCreate(MpmImplicitSolve *solve);
PetscErrorCode MpmImplicitBlocksFill(MpmImplicitSolve *solve);

/*
   MpmImplicitSolveApply - the march's node registers of an operation become the solution, with particles at the places
                           of a step. The operation's factor is all that multiplies it.

   Collective. Where it does not converge, march->failure says so.

   MpmImplicitSolveTotals - the iterations of all solves of a march so far, of linear systems and of Newton's method,
   and the seconds that they took. Not collective.
*/
void MpmImplicitSolveTotals(const MpmMarch *march, PetscInt64 *iterations, PetscInt64 *newton, PetscReal *seconds);
PetscErrorCode MpmImplicitSolveApply(MpmMarch *march, PetscInt64 step, const MpmOp *op);
