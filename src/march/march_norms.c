/* Norms of the state: of all particle fields, the formulation's energy, and that energy on the grid. */
#include "march/march_private.h"
#include <math.h>

static PetscBool Differ(const MpmLayout *layout)
{
  return layout->varies[MPM_MASS] || layout->varies[MPM_STIFFNESS] ? PETSC_TRUE : PETSC_FALSE;
}

/* The array of a property where it varies, else NULL. */
static PetscErrorCode GetProperty(const MpmMarch *march, MpmProperty property, const PetscReal **values)
{
  PetscFunctionBegin;
  *values = NULL;
  if (march->layout->varies[property]) PetscCall(MpmParticlesGet(march->particles, MpmPropertyNames[property], values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RestoreProperty(const MpmMarch *march, MpmProperty property, const PetscReal **values)
{
  PetscFunctionBegin;
  if (*values) PetscCall(MpmParticlesRestore(march->particles, MpmPropertyNames[property], values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The sum of squares of a field, weighted by volume, or as in a term of the energy. Where particles differ they are
   gone through again at each sample.
*/
static PetscErrorCode WeighedSquares(const MpmMarch *march, const MpmEnergyTerm *term, const PetscReal q[],
                                     PetscReal *sum)
{
  const MpmProperty by     = term && !term->stress ? MPM_MASS : MPM_VOLUME;
  const PetscBool   stress = term && term->stress ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal  *weight, *stiffness;

  PetscFunctionBegin;
  PetscCall(GetProperty(march, by, &weight));
  PetscCall(GetProperty(march, MPM_STIFFNESS, &stiffness));
  *sum = 0;
  for (PetscInt p = 0; p < march->particles->count; p++)
    *sum += q[p] * q[p] * (weight ? weight[p] : 1) / (stress && stiffness ? stiffness[p] : 1);
  PetscCall(RestoreProperty(march, MPM_STIFFNESS, &stiffness));
  PetscCall(RestoreProperty(march, by, &weight));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of squares of a particle field. The passes of a sampled step have computed it, but for the first step. */
static PetscErrorCode ParticleSquares(const MpmMarch *march, PetscInt field, const MpmEnergyTerm *term, PetscReal *sum)
{
  const char     *name   = march->scheme->table->fields[field];
  const PetscBool differ = Differ(march->layout);
  PetscReal      *q;

  PetscFunctionBegin;
  *sum = march->squares[field];
  if (march->step > 0 && !differ) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmParticlesGet(march->particles, name, &q));
  if (differ)
    PetscCall(WeighedSquares(march, term, q, sum));
  else
    *sum = MpmSumSquares(march->particles->count, q);
  PetscCall(MpmParticlesRestore(march->particles, name, &q));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of squares of a node field, or of its differences over cells. */
static PetscErrorCode NodeSquares(const MpmMarch *march, PetscInt field, PetscBool differences, PetscReal *sum)
{
  PetscReal *f;

  PetscFunctionBegin;
  *sum = 0;
  PetscCall(MpmGridGetArray(march->grid, march->node[field], &f));
  if (differences)
    for (PetscInt i = 0; i < march->grid->axis[0].count; i++) *sum += PetscSqr(f[i + 1] - f[i]);
  else
    *sum = MpmSumSquares(march->grid->axis[0].nodes, f);
  PetscCall(MpmGridRestoreArray(march->grid, march->node[field], &f));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* For a formulation without an energy: the sum of squares of the node fields that particle fields are sent to. */
static PetscErrorCode SeenSquares(const MpmMarch *march, PetscReal *sum)
{
  const MpmTable *table = march->scheme->table;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < table->nstate; f++) {
    const MpmOp *seen = MpmTableSeenBy(table, f);
    PetscReal    squares;

    if (!seen) continue;
    PetscCall(NodeSquares(march, seen->dst, PETSC_FALSE, &squares));
    *sum += march->cell_width * squares;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchNorms(const MpmMarch *march, MpmNorms *norms)
{
  const MpmTable       *table       = march->scheme->table;
  const MpmFormulation *formulation = march->scheme->formulation;
  const PetscReal       h           = march->cell_width;
  PetscReal             sums[3]     = {0, 0, 0}, squares;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < table->nstate; f++) {
    PetscCall(ParticleSquares(march, f, NULL, &squares));
    sums[0] += h / march->layout->ppc[0] * squares;
  }
  if (!formulation->nenergy) PetscCall(SeenSquares(march, &sums[2]));
  for (PetscInt t = 0; t < formulation->nenergy; t++) {
    const MpmEnergyTerm *term         = &formulation->energy[t];
    const PetscBool      on_particles = term->place == MPM_ON_PARTICLES ? PETSC_TRUE : PETSC_FALSE;
    const MpmOp         *seen         = on_particles ? MpmTableSeenBy(table, term->field) : NULL;

    squares = 0;
    if (seen || !on_particles)
      PetscCall(NodeSquares(march, seen ? seen->dst : term->field, on_particles ? PETSC_FALSE : PETSC_TRUE, &squares));
    sums[2] += h * squares;
    if (on_particles) {
      PetscCall(ParticleSquares(march, term->field, term, &squares));
      squares /= march->layout->ppc[0];
    }
    sums[1] += h * squares;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  norms->state  = sqrt(sums[0]);
  norms->energy = formulation->nenergy ? sums[1] / 2 : NAN;
  norms->grid   = sqrt(sums[2] / 2);
  PetscFunctionReturn(PETSC_SUCCESS);
}
