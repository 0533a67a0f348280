/* Solves W^T m W y = M g on the grid of the march. m are the masses of the particles and M those of the nodes. */
#include <mpmstab/errors.h>
#include "scheme/maps.h"
#include "march/nodal_solve.h"

#define MOST_ITERATIONS 20000

PetscErrorCode MpmNodalSolveCreate(const MpmLayout *layout, const MpmBasis *basis, const MpmGrid *grid,
                                   MpmNodalSolve **solve)
{
  const PetscInt reach = MpmMapReach(basis), width = PetscMin(2 * reach - 1, layout->grid[0].nodes);
  const MPI_Comm comm = PetscObjectComm((PetscObject)grid->da);
  MpmNodalSolve *s;
  PC             pc;

  PetscFunctionBegin;
  PetscCall(PetscNew(solve));
  s         = *solve;
  s->layout = layout;
  s->basis  = basis;
  s->grid   = grid;
  s->step   = -1;
  PetscCall(MatCreateAIJ(comm, grid->axis[0].nodes, grid->axis[0].nodes, layout->grid[0].nodes, layout->grid[0].nodes,
                         PetscMin(width, grid->axis[0].nodes), NULL,
                         PetscMin(width, layout->grid[0].nodes - grid->axis[0].nodes), NULL, &s->matrix));
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
  PetscCall(MatDestroy(&(*solve)->matrix));
  PetscCall(VecDestroy(&(*solve)->right));
  PetscCall(VecDestroy(&(*solve)->solution));
  PetscCall(KSPDestroy(&(*solve)->ksp));
  PetscCall(PetscFree(*solve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the part of a particle, at xi in a cell, to W^T m W. */
static PetscErrorCode AddParticle(MpmNodalSolve *s, PetscInt cell, PetscReal xi, PetscReal mass)
{
  const PetscInt reach = MpmMapReach(s->basis);
  PetscInt       node[MPM_MAX_REACH];
  PetscReal      row[MPM_MAX_REACH], sign[MPM_MAX_REACH], square[MPM_MAX_REACH * MPM_MAX_REACH];

  PetscFunctionBegin;
  MpmMapRow(s->basis, MPM_G2P, xi, s->layout->half_width[0], row);
  MpmNodesSeen(&s->layout->grid[0], s->basis, cell, s->parity, PETSC_TRUE, node, sign);
  for (PetscInt i = 0; i < reach; i++)
    for (PetscInt j = 0; j < reach; j++) square[i * reach + j] = mass * sign[i] * row[i] * sign[j] * row[j];
  PetscCall(MatSetValues(s->matrix, reach, node, reach, node, square, ADD_VALUES));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Assemble(MpmNodalSolve *s, const MpmParticles *particles, PetscInt64 step,
                               const MpmPlaces *places)
{
  PetscInt  whole;
  PetscReal part;

  PetscFunctionBegin;
  PetscCall(MatZeroEntries(s->matrix));
  PetscCall(MpmParticlesWhere(particles, 0, step, &whole, &part));
  for (PetscInt p = 0; p < particles->count; p++) {
    PetscInt  cell;
    PetscReal xi;

    MpmPlaceBlock(1, &places->cell[p], &places->xi[p], whole, part, &cell, &xi);
    PetscCall(AddParticle(s, s->grid->axis[0].first + cell, xi, places->mass ? places->mass[p] : 1));
  }
  PetscCall(MatAssemblyBegin(s->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(s->matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(KSPSetOperators(s->ksp, s->matrix, s->matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalSolveTry(MpmNodalSolve *s, const MpmParticles *particles, PetscInt64 step,
                                const MpmPlaces *places, MpmParity parity, const PetscReal inverse_mass[],
                                const PetscReal g[], PetscReal y[], KSPConvergedReason *reason)
{
  const PetscInt   last = s->grid->axis[0].nodes - 1;
  const PetscReal *a;
  PetscReal       *b, mirror[2];

  PetscFunctionBegin;
  if (s->step < 0 || parity != s->parity || (s->step != step && particles->drift[0].value != 0)) {
    s->parity = parity;
    PetscCall(Assemble(s, particles, step, places));
  }
  s->step = step;
  PetscCall(VecGetArray(s->right, &b));
  for (PetscInt i = 0; i < s->grid->axis[0].nodes; i++) b[i] = inverse_mass[i] > 0 ? g[i] / inverse_mass[i] : 0;
  for (PetscInt end = 0; end < 2; end++)
    if (s->grid->axis[0].wall[end] && MpmEndImposes(s->layout->grid[0].ends[end], parity)) b[end ? last : 0] = 0;
  PetscCall(VecRestoreArray(s->right, &b));
  PetscCall(KSPSolve(s->ksp, s->right, s->solution));
  PetscCall(KSPGetConvergedReason(s->ksp, reason));
  PetscCall(VecGetArrayRead(s->solution, &a));
  PetscCall(PetscArraycpy(y, a, s->grid->axis[0].nodes));
  PetscCall(VecRestoreArrayRead(s->solution, &a));
  PetscCall(MpmGridSpread(s->grid, 1, &y));
  MpmDirectionMirror(&s->layout->grid[0], parity, mirror);
  MpmGridReflect(s->grid, 0, mirror, y);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalSolveApply(MpmNodalSolve *s, const MpmParticles *particles, PetscInt64 step,
                                  const MpmPlaces *places, MpmParity parity, const PetscReal inverse_mass[],
                                  const PetscReal g[], PetscReal y[])
{
  KSPConvergedReason reason;

  PetscFunctionBegin;
  PetscCall(MpmNodalSolveTry(s, particles, step, places, parity, inverse_mass, g, y, &reason));
  MpmCheckInput(reason > 0,
                "the nodal system P2G G2P did not converge (%s), as where particles almost coincide; allowed: "
                "other places, or -nodal_ksp_max_it and -nodal_ksp_rtol",
                KSPConvergedReasons[reason]);
  PetscFunctionReturn(PETSC_SUCCESS);
}
