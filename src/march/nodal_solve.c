/* Solves W^T m W y = M g on the grid of the march. m are the masses of the particles and M those of the nodes. */
#include <mpmstab/errors.h>
#include "scheme/maps.h"
#include "march/nodal_solve.h"

#define MOST_ITERATIONS 20000

/* The number of nodes that a particle has weights at, and of those that share a particle with a node. */
static PetscInt Neighbours(const MpmLayout *layout, PetscInt along)
{
  PetscInt n = 1;

  for (PetscInt a = 0; a < layout->dim; a++) n *= along;
  return n;
}

PetscErrorCode MpmNodalSolveCreate(const MpmMarch *march, MpmNodalSolve **solve)
{
  const MpmLayout       *layout = march->layout;
  const MpmBasis        *basis  = march->scheme->basis;
  const MpmGrid         *grid   = march->grid;
  const PetscInt         reach = MpmMapReach(basis), own = MpmGridNodes(grid), all = MpmLayoutNodes(layout);
  const PetscInt         width = PetscMin(Neighbours(layout, 2 * reach - 1), all);
  const MPI_Comm         comm  = PetscObjectComm((PetscObject)grid->da);
  ISLocalToGlobalMapping map;
  MpmNodalSolve         *s;
  PC                     pc;

  PetscFunctionBegin;
  PetscCall(PetscNew(solve));
  s         = *solve;
  s->layout = layout;
  s->basis  = basis;
  s->grid   = grid;
  s->step   = -1;
  s->seen   = Neighbours(layout, reach);
  PetscCall(PetscMalloc3(s->seen, &s->node, s->seen, &s->weight, s->seen * s->seen, &s->square));
  PetscCall(
      MatCreateAIJ(comm, own, own, all, all, PetscMin(width, own), NULL, PetscMin(width, all - own), NULL, &s->matrix));
  PetscCall(DMGetLocalToGlobalMapping(grid->da, &map));
  PetscCall(MatSetLocalToGlobalMapping(s->matrix, map, map));
  PetscCall(MatSetOption(s->matrix, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  PetscCall(MatSetOption(s->matrix, MAT_SYMMETRIC, PETSC_TRUE));
  PetscCall(MatCreateVecs(s->matrix, &s->solution, &s->right));
  PetscCall(KSPCreate(comm, &s->ksp));
  PetscCall(KSPSetOptionsPrefix(s->ksp, "nodal_"));
  PetscCall(KSPSetType(s->ksp, KSPCG));
  PetscCall(KSPGetPC(s->ksp, &pc));
  PetscCall(PCSetType(pc, PCJACOBI));
  PetscCall(KSPSetTolerances(s->ksp, 1e-14, PETSC_CURRENT, PETSC_CURRENT, MOST_ITERATIONS));
  PetscCall(KSPSetFromOptions(s->ksp));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalSolveDestroy(MpmNodalSolve **solve)
{
  PetscFunctionBegin;
  if (!*solve) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree3((*solve)->node, (*solve)->weight, (*solve)->square));
  PetscCall(MatDestroy(&(*solve)->matrix));
  PetscCall(VecDestroy(&(*solve)->right));
  PetscCall(VecDestroy(&(*solve)->solution));
  PetscCall(KSPDestroy(&(*solve)->ksp));
  PetscCall(PetscFree(*solve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether node i of a direction, counted over the grid, is on a wall where the field is set to 0. */
static PetscBool IsImposed(const MpmNodalSolve *s, PetscInt a, PetscInt i)
{
  const MpmDirection *direction = &s->layout->grid[a];

  if (direction->ends[0] == MPM_PERIODIC) return PETSC_FALSE;
  return (i == 0 && MpmEndImposes(direction->ends[0], s->parity[a])) ||
                 (i == direction->nodes - 1 && MpmEndImposes(direction->ends[1], s->parity[a]))
             ? PETSC_TRUE
             : PETSC_FALSE;
}

/*
   The weights along a direction of a particle at xi in a local cell, and the places of their nodes in a local array.
   Beyond a wall these are those of the images.
*/
static void RowAlong(const MpmNodalSolve *s, PetscInt a, PetscInt cell, PetscReal xi, PetscInt place[],
                     PetscReal weight[])
{
  const MpmGridAxis *axis = &s->grid->axis[a];
  PetscInt           wall[2], node[MPM_MAX_REACH];
  PetscReal          sign[MPM_MAX_REACH];

  MpmDirectionWalls(&s->layout->grid[a], axis->first + cell, wall);
  MpmMapRow(s->basis, MPM_G2P, xi, s->layout->half_width[a], wall, weight);
  MpmNodesSeen(&s->layout->grid[a], s->basis, axis->first + cell, s->parity[a], PETSC_TRUE, node, sign);
  for (PetscInt d = 0; d < MpmMapReach(s->basis); d++) {
    place[d] = (axis->periodic ? cell - s->basis->reach_left + d : node[d] - axis->first) * axis->stride;
    weight[d] *= sign[d];
  }
}

/* Adds the part of a particle, at xi in a cell of each direction, to W^T m W. */
static PetscErrorCode AddParticle(MpmNodalSolve *s, const PetscInt cell[], const PetscReal xi[], PetscReal mass)
{
  const PetscInt reach = MpmMapReach(s->basis);
  PetscInt       n     = 1;

  PetscFunctionBegin;
  s->node[0]   = s->grid->origin;
  s->weight[0] = 1;
  for (PetscInt a = 0; a < s->layout->dim; a++) {
    PetscInt  place[MPM_MAX_REACH];
    PetscReal row[MPM_MAX_REACH];

    RowAlong(s, a, cell[a], xi[a], place, row);
    for (PetscInt d = reach - 1; d >= 0; d--) { /* the first n are read last */
      for (PetscInt i = 0; i < n; i++) {
        s->node[d * n + i]   = s->node[i] + place[d];
        s->weight[d * n + i] = s->weight[i] * row[d];
      }
    }
    n *= reach;
  }
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) s->square[i * n + j] = mass * s->weight[i] * s->weight[j];
  PetscCall(MatSetValuesLocal(s->matrix, n, s->node, n, s->node, s->square, ADD_VALUES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Assemble(MpmNodalSolve *s, const MpmMarchArrays *at, PetscInt64 step)
{
  const PetscReal *mass = at->weight[MPM_MASS];

  PetscFunctionBegin;
  PetscCall(MatZeroEntries(s->matrix));
  for (PetscInt p = 0; p < at->march->particles->count; p++) {
    PetscInt  cell[MPM_MAX_DIM];
    PetscReal xi[MPM_MAX_DIM];

    for (PetscInt a = 0; a < s->layout->dim; a++)
      MpmMarchPlaces(at, a, 1, &at->cell[a][p], &at->xi[a][p], (PetscInt)(step - at->step), &cell[a], &xi[a]);
    PetscCall(AddParticle(s, cell, xi, mass ? mass[p] : 1));
  }
  PetscCall(MatAssemblyBegin(s->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(s->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(KSPSetOperators(s->ksp, s->matrix, s->matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* M g at this rank's nodes; 0 on walls where the field is set to 0. */
static PetscErrorCode SetRight(MpmNodalSolve *s, const PetscReal inverse_mass[], const PetscReal g[])
{
  const MpmGridBox box = MpmGridBoxOf(s->grid, 0);
  const PetscInt   ny  = box.hi[1];
  PetscReal       *b;

  PetscFunctionBegin;
  PetscCall(VecGetArray(s->right, &b));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscInt row = MpmGridRow(s->grid, &box, r), at[MPM_MAX_DIM] = {0, r % ny, r / ny};
    PetscBool      imposed = PETSC_FALSE;

    for (PetscInt a = 1; a < s->layout->dim; a++)
      if (IsImposed(s, a, s->grid->axis[a].first + at[a])) imposed = PETSC_TRUE;
    for (PetscInt i = 0; i < box.hi[0]; i++)
      *b++ = imposed || IsImposed(s, 0, s->grid->axis[0].first + i) || !(inverse_mass[row + i] > 0)
                 ? 0
                 : g[row + i] / inverse_mass[row + i];
  }
  b -= MpmGridNodes(s->grid);
  PetscCall(VecRestoreArray(s->right, &b));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies the solution to a local array, with its ghosts and the images beyond walls. */
static PetscErrorCode CopySolution(const MpmNodalSolve *s, PetscReal y[])
{
  PetscReal *a;

  PetscFunctionBegin;
  PetscCall(VecGetArray(s->solution, &a));
  PetscCall(MpmGridCopy(s->grid, PETSC_FALSE, 1, a, y));
  PetscCall(VecRestoreArray(s->solution, &a));
  PetscCall(MpmGridSum(s->grid, 1, &y));
  MpmGridImages(s->grid, s->layout->grid, s->parity, PETSC_FALSE, y);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalSolveApply(MpmNodalSolve *s, const MpmMarchArrays *at, PetscInt64 step, const MpmParity parity[],
                                  const PetscReal g[], PetscReal y[], KSPConvergedReason *reason)
{
  const MpmParticles *particles = at->march->particles;
  KSPConvergedReason  ended;
  PetscBool           same;

  PetscFunctionBegin;
  PetscCall(PetscArraycmp(parity, s->parity, s->layout->dim, &same));
  if (s->step < 0 || !same || (s->step != step && (particles->own || MpmParticlesMove(particles)))) {
    PetscCall(PetscArraycpy(s->parity, parity, s->layout->dim));
    PetscCall(Assemble(s, at, step));
  }
  s->step = step;
  PetscCall(SetRight(s, at->sum[MPM_MASSES], g));
  PetscCall(KSPSolve(s->ksp, s->right, s->solution));
  PetscCall(KSPGetConvergedReason(s->ksp, &ended));
  PetscCall(CopySolution(s, y));
  if (reason) *reason = ended;
  MpmCheckInput(reason || ended > 0,
                "the nodal system P2G G2P did not converge (%s), as where particles almost coincide; allowed: "
                "other places, or -nodal_ksp_max_it and -nodal_ksp_rtol",
                KSPConvergedReasons[ended]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
