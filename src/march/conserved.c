/*
   By partition of unity the masses of the nodes add up to those of the particles. sum_p m_p P2G is adjoint to G2P, and
   DIV of anything sums to 0. So momentum schemes conserve sum_p m_p v_p where no wall acts on them, with every
   transfer.

   There is one exception. A particle that is on a node, alone in its cell, has weight 0 at the cell's other node but a
   slope there. A force on that node, which has no mass, moves nothing. It occurs for bars that drift through an empty
   grid.
*/
#include "march/conserved.h"
#include <math.h>

static PetscErrorCode SumParticles(const MpmMarch *march, PetscInt field, PetscReal sums[2])
{
  const MpmParticles *particles = march->particles;
  const PetscBool     weighed   = march->layout->varies[MPM_MASS];
  const PetscReal    *q, *mass = NULL;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, march->scheme->table->fields[field], &q));
  if (weighed) PetscCall(MpmParticlesGet(particles, MpmPropertyNames[MPM_MASS], &mass));
  for (PetscInt p = 0; p < particles->count; p++) {
    const PetscReal momentum = weighed ? mass[p] * q[p] : q[p];

    sums[0] += momentum;
    sums[1] += fabs(momentum);
  }
  if (weighed) PetscCall(MpmParticlesRestore(particles, MpmPropertyNames[MPM_MASS], &mass));
  PetscCall(MpmParticlesRestore(particles, march->scheme->table->fields[field], &q));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The mass of a node at a wall includes that of its image, in every step. */
static PetscErrorCode SumNodes(const MpmMarch *march, PetscReal *sum)
{
  const MpmGrid   *grid = march->grid;
  const MpmGridBox box  = MpmGridBoxOf(grid, 0);
  PetscReal       *inverse;

  PetscFunctionBegin;
  PetscCall(MpmGridGetArray(grid, march->inverse_mass, &inverse));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscReal *row = inverse + MpmGridRow(grid, &box, r);

    for (PetscInt i = 0; i < box.hi[0]; i++) *sum += row[i] > 0 ? 1 / row[i] : 0;
  }
  PetscCall(MpmGridRestoreArray(grid, march->inverse_mass, &inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether some wall stops a component of the velocity. */
static PetscBool IsStopped(const MpmLayout *layout, PetscInt component)
{
  for (PetscInt a = 0; a < layout->dim; a++)
    for (int end = 0; end < 2; end++)
      if (MpmEndIsOdd(layout->grid[a].ends[end], a == component ? MPM_NORMAL : MPM_TANGENTIAL)) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmConservedSum(const MpmMarch *march, MpmConserved *c)
{
  const MpmTable *table                    = march->scheme->table;
  const PetscInt  field                    = march->scheme->formulation->conserved;
  PetscReal       sums[MPM_MAX_DIM + 1][2] = {{0}}, affine[2] = {0, 0};
  MPI_Comm        comm = PetscObjectComm((PetscObject)march->grid->da);

  PetscFunctionBegin;
  *c = (MpmConserved){.particles = march->particles->count, .exponent = march->exponent};
  PetscCall(SumNodes(march, &sums[MPM_MAX_DIM][0]));
  for (PetscInt r = 0; r < table->nstate; r++) {
    const PetscInt component = table->component[r];

    if (r >= table->affine_part && table->affine != MPM_NONE) /* nodes get it too, and its sum over them is 0 */
      PetscCall(SumParticles(march, r, affine));
    if (field == MPM_NONE || table->field[r] != field || IsStopped(march->layout, component)) continue;
    c->has_momentum = PETSC_TRUE;
    PetscCall(SumParticles(march, r, sums[component]));
  }
  sums[0][1] += affine[1];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &c->particles, 1, MPIU_INT64, MPI_SUM, comm));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2 * (MPM_MAX_DIM + 1), MPIU_REAL, MPI_SUM, comm));
  c->mass = sums[MPM_MAX_DIM][0];
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) {
    c->momentum[a] = sums[a][0];
    c->size += sums[a][1];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmConservedCheck(const MpmMarch *march, const MpmConserved *before, PetscReal changes[2])
{
  MpmConserved now;
  PetscReal    scale;

  PetscFunctionBegin;
  PetscCall(MpmConservedSum(march, &now));
  scale      = scalbn(1, (int)(before->exponent - now.exponent));
  changes[0] = fabs(now.mass - before->mass) / before->mass;
  changes[1] = NAN;
  if (now.has_momentum) {
    PetscReal largest = 0;

    for (PetscInt a = 0; a < MPM_MAX_DIM; a++)
      largest = PetscMax(largest, fabs(now.momentum[a] - scale * before->momentum[a]));
    changes[1] = largest / PetscMax(now.size, scale * before->size);
  }
  PetscCheck(now.particles == before->particles, PETSC_COMM_WORLD, PETSC_ERR_PLIB,
             "%" PetscInt64_FMT " particles at step %" PetscInt64_FMT ", %" PetscInt64_FMT " at the start",
             now.particles, march->step, before->particles);
  PetscCheck(changes[0] <= MPM_MASS_ROUNDING, PETSC_COMM_WORLD, PETSC_ERR_PLIB,
             "the nodes' mass at step %" PetscInt64_FMT " is %.17g, %.17g at the start", march->step, now.mass,
             before->mass);
  PetscFunctionReturn(PETSC_SUCCESS);
}
