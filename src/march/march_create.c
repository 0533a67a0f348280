/* Setting a march up: how wide the ghost layer is, and what the scene needs of vectors. */
#include "march/march_private.h"
#include <math.h>

#define OF_PARTICLE 24.0 /* bytes of place, number and owner */
#define OF_OUTPUT 100.0  /* bytes more a particle: its numbers and coordinates by global id */
#define OF_NODE 20.0     /* bytes of mass and DMDA's numbers */
#define OF_NUMBER 8.0    /* bytes of each field's value */

/* Cells that particles may run beyond their rank's own before they migrate: rarer migration for a few more ghosts. */
#define MOST_SLACK 64

/*
   A particle in local cell c sees the nodes c - reach_left to c + reach_right, node operations use up halo
   more. When a step's drift fits the slack that is left, particles are summed to the grid where they are and
   migrate rarely; if not, they migrate in every step before they are summed.
*/
static PetscErrorCode ChooseGhosts(MPI_Comm comm, const MpmStep *step, MpmMarch *march, PetscInt *ghost)
{
  const MpmBasis *basis  = march->scheme->basis;
  const MpmTable *table  = march->scheme->table;
  const PetscBool drifts = MpmStepDrifts(step);
  const PetscInt  reach = PetscMax(basis->reach_left, basis->reach_right), cells = march->layout->grid.cells;
  const PetscInt  stride = (PetscInt)ceil(PetscAbsReal(step->drift.value)) + 1;
  PetscInt        need, spare;
  PetscMPIInt     size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCall(MpmScheduleCompile(table, basis, march->layout, step->courant, drifts, PETSC_TRUE, &march->schedule));
  need  = reach + march->schedule.halo;
  spare = PetscMin(MpmGridSmallestCount(cells, size) - need, PetscMax(MOST_SLACK, stride));
  if (spare < 0 && need > cells)
    MpmRefuse("cells %" PetscInt_FMT ": too few; allowed: at least %" PetscInt_FMT " with formulation %s and basis %s",
              cells, need, march->scheme->formulation->name, basis->name);
  MpmCheckInput(spare >= 0,
                "cells %" PetscInt_FMT " on %d ranks: a rank needs %" PetscInt_FMT
                " cells; allowed: at most %" PetscInt_FMT " ranks, or more cells",
                cells, size, need, cells / need);
  march->slack = drifts && spare >= stride ? spare : 0;
  if (drifts && !march->slack)
    PetscCall(
        MpmScheduleCompile(table, basis, march->layout, step->courant, PETSC_TRUE, PETSC_FALSE, &march->schedule));
  *ghost = need + march->slack;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateVectors(MpmMarch *march)
{
  PetscFunctionBegin;
  march->nnodes = march->scheme->table->nnodes;
  for (PetscInt f = 0; f < march->nnodes; f++) {
    PetscCall(DMCreateLocalVector(march->grid->da, &march->node[f]));
    if (march->schedule.spare[f]) PetscCall(VecDuplicate(march->node[f], &march->spare[f]));
  }
  PetscCall(DMCreateLocalVector(march->grid->da, &march->inverse_mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RegisterEvents(MpmMarch *march)
{
  PetscClassId id;

  PetscFunctionBegin;
  PetscCall(PetscClassIdRegister("MpmMarch", &id));
  PetscCall(PetscLogEventRegister("MpmPass", id, &march->pass_event));
  PetscCall(PetscLogEventRegister("MpmGridSum", id, &march->sum_event));
  PetscCall(PetscLogEventRegister("MpmMigrate", id, &march->migrate_event));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* All but the particles' fields. */
static PetscErrorCode SetUp(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                            MpmMarch *m)
{
  PetscInt ghost;

  PetscFunctionBegin;
  m->layout     = layout;
  m->scheme     = scheme;
  m->cell_width = 1;
  PetscCall(ChooseGhosts(comm, step, m, &ghost));
  PetscCall(MpmGridCreate(comm, layout->grid.cells, ghost, MpmLayoutIsPeriodic(layout), &m->grid));
  PetscCall(MpmParticlesCreate(layout, scheme->table, &step->drift, m->grid, &m->particles));
  PetscCall(CreateVectors(m));
  PetscCall(PetscMalloc1((scheme->table->nparticles - scheme->table->nstate) * MPM_BLOCK, &m->scratch));
  PetscCall(RegisterEvents(m));
  if (MpmTableHas(scheme->table, MPM_SOLVE))
    PetscCall(MpmNodalSolveCreate(layout, scheme->basis, m->grid, &m->nodal_solve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchCreate(MPI_Comm comm, const MpmScene *scene, MpmMarch **march)
{
  MpmMarch *m;

  PetscFunctionBegin;
  PetscCall(PetscNew(march));
  m = *march;
  PetscCall(SetUp(comm, &scene->layout, &scene->scheme, &scene->step, m));
  m->scene      = scene;
  m->cell_width = scene->cell_width;
  m->exponent   = MpmSceneExponent(scene);
  PetscCall(MpmParticlesFill(scene, m->grid, m->exponent, m->particles));
  PetscCall(MpmMarchRunPasses(m, 1, &m->schedule.start, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchCreateRandom(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme,
                                    const MpmStep *step, PetscReal amplitude, MpmMarch **march)
{
  MpmMarch *m;

  PetscFunctionBegin;
  PetscCall(PetscNew(march));
  m = *march;
  PetscCall(SetUp(comm, layout, scheme, step, m));
  m->exponent = ilogb(amplitude);
  PetscCall(MpmParticlesFillRandom(layout->seed, scalbn(amplitude, -(int)m->exponent), m->particles));
  PetscCall(MpmMarchRunPasses(m, 1, &m->schedule.start, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchDestroy(MpmMarch **march)
{
  PetscFunctionBegin;
  for (PetscInt f = 0; f < (*march)->nnodes; f++) {
    PetscCall(VecDestroy(&(*march)->node[f]));
    PetscCall(VecDestroy(&(*march)->spare[f]));
  }
  PetscCall(VecDestroy(&(*march)->inverse_mass));
  PetscCall(PetscFree((*march)->scratch));
  PetscCall(MpmNodalSolveDestroy(&(*march)->nodal_solve));
  PetscCall(MpmScheduleDestroy(&(*march)->schedule));
  PetscCall(MpmParticlesDestroy(&(*march)->particles));
  PetscCall(MpmGridDestroy(&(*march)->grid));
  PetscCall(PetscFree(*march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchRescale(MpmMarch *march, PetscInt shift)
{
  const PetscReal factor = scalbn(1, -(int)shift);

  PetscFunctionBegin;
  for (PetscInt f = 0; march->scheme->table->fields[f]; f++) {
    PetscReal *q;

    PetscCall(MpmParticlesGet(march->particles, march->scheme->table->fields[f], &q));
    for (PetscInt p = 0; p < march->particles->count; p++) q[p] *= factor;
    PetscCall(MpmParticlesRestore(march->particles, march->scheme->table->fields[f], &q));
  }
  for (PetscInt f = 0; f < march->nnodes; f++) PetscCall(VecScale(march->node[f], factor));
  march->exponent += shift;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmMarchBytes(const MpmScene *scene)
{
  PetscReal particle = OF_PARTICLE + OF_NUMBER * scene->scheme.table->nparticles + (scene->output[0] ? OF_OUTPUT : 0);

  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (scene->layout.varies[w]) particle += OF_NUMBER;
  return (PetscReal)scene->layout.particles * particle +
         (PetscReal)scene->layout.grid.nodes * (OF_NODE + OF_NUMBER * scene->scheme.table->nnodes);
}
