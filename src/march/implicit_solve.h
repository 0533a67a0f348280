/* The operation IMPLICIT on the grid of the march. */
#pragma once
#include "march/march_private.h"
#include <petscksp.h>

/*S
   MpmImplicitSolve - solves (1 + a K) y = f on the nodes. With the nodal masses M this is the symmetric system

     (M + a M K) y = M f

   of conjugate gradients, which options -implicit_* change. M K is DIV STRESS GRAD without the division by masses; a product
   with it is one pass over the particles. Nodes without mass, and components that a wall fixes, have y = f, which is 0.

   k         - the table of K; schedule: its pass
   shell     - the matrix of the system, which has products alone
   blocks    - what the preconditioner is made of: the blocks of a node on the diagonal or, where another preconditioner than
               pbjacobi, jacobi or none is asked for, the whole matrix
   term      - term[c][b][a][d]: the number by which K has slopes along b of component c's weights times those along d of
               component a's
   a, step   - of the blocks as they stand
   iterations, seconds - of all solves so far
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
  PetscInt64      step, iterations;
  PetscReal       seconds;
};

/* Collective. march must outlive the solve, and have grid and particles. */
PetscErrorCode MpmImplicitSolveCreate(MpmMarch *march, const MpmTable *k, MpmImplicitSolve **solve);
PetscErrorCode MpmImplicitSolveDestroy(MpmImplicitSolve **solve);

/*
   MpmImplicitSolveApply - the march's node registers of an operation become the solution, with particles at the places of a step.

   Collective. Where it does not converge, march->failure says so.

   MpmImplicitSolveTotals - the iterations of all solves of a march so far, and the seconds that they took. Not collective.
*/
void           MpmImplicitSolveTotals(const MpmMarch *march, PetscInt64 *iterations, PetscReal *seconds);
PetscErrorCode MpmImplicitSolveApply(MpmMarch *march, PetscInt64 step, const MpmNodeOp *op);
