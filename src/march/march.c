/*
   The march: sets up grid, particles and vectors, and takes steps by the plain or the fast way. Particles migrate to
   another rank before they would leave the ghost layer.
*/
#include "base/large_pages.h"
#include "march/adapt.h"
#include "march/finite.h"
#include "march/implicit_solve.h"
#include "march/nodal_solve.h"
#include <math.h>

#define OF_PARTICLE 12.0 /* bytes: id and owner */
#define OF_PLACE 12.0    /* bytes: the place along a direction */
#define OF_OUTPUT 100.0  /* bytes a particle: its values and coordinates by global id */
#define OF_NODE 20.0     /* bytes: mass and DMDA's indices */
#define OF_NUMBER 8.0    /* bytes: a value of a field */

/* Cells beyond their rank's own that particles may reach before they migrate: few migrations for a few more ghosts. */
#define MOST_SLACK 64

/* The same in more than one dimension, where ghosts are many and all passes go over them. */
#define SLACK_OF_BOX 4

#define SORT_EVERY 8 /* steps, where particles move each by itself */

/* Refuses a grid on which a rank could not have need cells in each direction. */
static PetscErrorCode CheckCells(const MpmMarch *march, PetscMPIInt size, PetscInt need, PetscBool fits)
{
  const MpmLayout *layout = march->layout;
  PetscInt         cells = layout->grid[0].cells, product = 1;
  char             text[64];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < layout->dim; a++) product *= layout->ranks[a];
  MpmCheckInput(!product || product == size,
                "ranks: their product is %" PetscInt_FMT ", on %d ranks; allowed: numbers whose product is %d", product,
                size, size);
  for (PetscInt a = 1; a < layout->dim; a++) cells = PetscMin(cells, layout->grid[a].cells);
  if (need > cells)
    MpmRefuse("cells %" PetscInt_FMT ": too few; allowed: at least %" PetscInt_FMT " with formulation %s and basis %s",
              cells, need, march->scheme->formulation->name, march->scheme->basis->name);
  if (layout->dim == 1)
    MpmCheckInput(fits,
                  "cells %" PetscInt_FMT " on %d ranks: a rank needs %" PetscInt_FMT
                  " cells; allowed: at most %" PetscInt_FMT " ranks, or more cells",
                  cells, size, need, cells / need);
  if (layout->dim == 2)
    PetscCall(PetscSNPrintf(text, sizeof text, "%" PetscInt_FMT ",%" PetscInt_FMT, layout->grid[0].cells,
                            layout->grid[1].cells));
  else
    PetscCall(PetscSNPrintf(text, sizeof text, "%" PetscInt_FMT ",%" PetscInt_FMT ",%" PetscInt_FMT,
                            layout->grid[0].cells, layout->grid[1].cells, layout->grid[2].cells));
  MpmCheckInput(fits,
                "cells %s on %d ranks: a rank needs %" PetscInt_FMT
                " cells in each direction; allowed: fewer ranks, a number of ranks with more factors, or more cells",
                text, size, need);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Chooses the number of ghosts, and the cells of each rank. A particle in local cell c has weights at nodes
   c - reach_left to c + reach_right, and node operations need halo ghosts more. When a step's drift fits in the slack
   that is left, particles are summed to the grid where they are, and migrate rarely. If not, they migrate in every step
   before they are summed.
*/
static PetscErrorCode ChooseGhosts(MPI_Comm comm, const MpmStep *step, MpmMarch *march, PetscInt *ghost,
                                   MpmPartition *partition)
{
  const MpmLayout *layout = march->layout;
  const MpmBasis  *basis  = march->scheme->basis;
  const MpmTable  *table  = march->scheme->table;
  const PetscBool  own    = MpmTableIsFinite(table);
  const PetscBool  drifts = own || MpmStepDrifts(step) ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt   reach  = PetscMax(basis->reach_left, basis->reach_right);
  PetscInt         need, least, spare, stride = 1;
  PetscMPIInt      size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  for (PetscInt a = 0; a < layout->dim; a++)
    stride = PetscMax(stride, own ? 2 : (PetscInt)ceil(PetscAbsReal(step->drift[a].value)) + 1);
  PetscCall(MpmScheduleCompile(table, step->courant, drifts, PETSC_TRUE, &march->schedule));
  need  = reach + march->schedule.halo;
  least = need + (table->nkept ? stride : 0); /* in stages scratch must not be lost where particles migrate */
  PetscCall(MpmPartitionCreate(layout, size, least, drifts, partition));
  PetscCall(CheckCells(march, size, least, partition->smallest >= least ? PETSC_TRUE : PETSC_FALSE));
  spare        = PetscMin(partition->smallest - need, PetscMax(layout->dim == 1 ? MOST_SLACK : SLACK_OF_BOX, stride));
  march->slack = drifts && spare >= stride ? spare : 0;
  if (drifts && !march->slack)
    PetscCall(MpmScheduleCompile(table, step->courant, PETSC_TRUE, PETSC_FALSE, &march->schedule));
  *ghost = need + march->slack;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The passes have the Courant number as a factor of their operations. */
PetscErrorCode MpmMarchSetCourant(MpmMarch *march, PetscReal courant)
{
  PetscFunctionBegin;
  march->courant = courant;
  PetscCall(MpmScheduleCompile(march->scheme->table, courant, PETSC_TRUE, march->slack ? PETSC_TRUE : PETSC_FALSE,
                               &march->schedule));
  if (march->engine->compile) PetscCall(march->engine->compile(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchGetArrays(const MpmMarch *march, PetscInt64 step, MpmMarchArrays *a)
{
  PetscFunctionBegin;
  a->step = step;
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &a->id));
  for (PetscInt d = 0; d < march->grid->dim; d++) {
    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[d], &a->cell[d]));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[d], &a->xi[d]));
    for (PetscInt after = 0; after < 2; after++)
      PetscCall(MpmParticlesWhere(march->particles, d, step + after, &a->whole[after][d], &a->part[after][d]));
  }
  for (PetscInt f = 0; f < MpmTableHeld(march->scheme->table); f++)
    PetscCall(MpmParticlesGet(march->particles, march->scheme->table->names[f], &a->particle[f]));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (march->layout->varies[w]) PetscCall(MpmParticlesGet(march->particles, MpmPropertyNames[w], &a->weight[w]));
  for (PetscInt f = 0; f < march->nnodes; f++) PetscCall(MpmGridGetArray(march->grid, march->node[f], &a->node[f]));
  PetscCall(MpmGridGetArray(march->grid, march->inverse_mass, &a->sum[MPM_MASSES]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchRestoreArrays(const MpmMarch *march, MpmMarchArrays *a)
{
  PetscFunctionBegin;
  PetscCall(MpmGridRestoreArray(march->grid, march->inverse_mass, &a->sum[MPM_MASSES]));
  for (PetscInt f = 0; f < march->nnodes; f++) PetscCall(MpmGridRestoreArray(march->grid, march->node[f], &a->node[f]));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (march->layout->varies[w]) PetscCall(MpmParticlesRestore(march->particles, MpmPropertyNames[w], &a->weight[w]));
  for (PetscInt f = 0; f < MpmTableHeld(march->scheme->table); f++)
    PetscCall(MpmParticlesRestore(march->particles, march->scheme->table->names[f], &a->particle[f]));
  for (PetscInt d = 0; d < march->grid->dim; d++) {
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[d], &a->xi[d]));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[d], &a->cell[d]));
  }
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &a->id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmMarchPlaces(const MpmMarchArrays *a, PetscInt axis, PetscInt n, const PetscInt cell0[], const PetscReal xi0[],
                    PetscInt after, PetscInt cell[], PetscReal xi[])
{
  if (a->march->particles->drift[axis].value != 0) {
    MpmPlaceBlock(n, cell0, xi0, a->whole[after][axis], a->part[after][axis], cell, xi);
    return;
  }
  for (PetscInt p = 0; p < n; p++) {
    cell[p] = cell0[p];
    xi[p]   = xi0[p];
  }
}

PetscErrorCode MpmMarchStart(MpmMarch *march)
{
  PetscFunctionBegin;
  PetscCall(march->engine->start(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateVector(const MpmMarch *march, Vec *vector)
{
  PetscInt   n;
  PetscReal *values;

  PetscFunctionBegin;
  PetscCall(DMCreateLocalVector(march->grid->da, vector));
  PetscCall(VecGetLocalSize(*vector, &n));
  PetscCall(VecGetArray(*vector, &values));
  MpmLargePages(values, sizeof *values * (size_t)n);
  PetscCall(VecRestoreArray(*vector, &values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateVectors(MpmMarch *march)
{
  PetscFunctionBegin;
  march->nnodes = march->scheme->table->nnodes;
  for (PetscInt f = 0; f < march->nnodes; f++) {
    PetscCall(CreateVector(march, &march->node[f]));
    if (march->schedule.spare[f]) PetscCall(CreateVector(march, &march->spare[f]));
  }
  PetscCall(CreateVector(march, &march->inverse_mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The class is registered once: PETSc has room for a hundred or so, and writes beyond it without a word. */
static PetscClassId class_id;

static PetscErrorCode ForgetClass(void)
{
  PetscFunctionBegin;
  class_id = 0;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RegisterEvents(MpmMarch *march)
{
  PetscFunctionBegin;
  if (!class_id) {
    PetscCall(PetscClassIdRegister("MpmMarch", &class_id));
    PetscCall(PetscRegisterFinalize(ForgetClass));
  }
  PetscCall(PetscLogEventRegister("MpmPass", class_id, &march->pass_event));
  PetscCall(PetscLogEventRegister("MpmGridSum", class_id, &march->sum_event));
  PetscCall(PetscLogEventRegister("MpmMigrate", class_id, &march->migrate_event));
  PetscCall(PetscLogEventRegister("MpmWatch", class_id, &march->watch_event));
  PetscCall(PetscLogEventRegister("MpmCertificate", class_id, &march->certificate_event));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes all of a march but the values of the particle fields. */
static PetscErrorCode SetUp(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                            MpmMarch *m)
{
  PetscInt     ghost = 0;
  MpmPartition partition;

  PetscFunctionBegin;
  m->layout     = layout;
  m->scheme     = scheme;
  m->engine     = layout->march == MPM_MARCH_PLAIN ? &MpmPlainMarch : &MpmFastMarch;
  m->cell_width = 1;
  m->courant    = step->courant;
  for (PetscInt a = 0; a < layout->dim; a++) m->velocity[a] = step->drift[a].value / step->courant;
  PetscCall(ChooseGhosts(comm, step, m, &ghost, &partition));
  PetscCall(MpmGridCreate(comm, layout->dim, layout->grid, &partition, ghost, &m->grid));
  PetscCall(MpmPartitionDestroy(&partition));
  PetscCall(MpmParticlesCreate(layout, scheme->table, step->drift, m->grid, &m->particles));
  m->fullest = m->particles->count;
  if (m->particles->own) PetscCall(PetscNew(&m->watch));
  for (PetscInt i = 0; i < scheme->table->nstiff; i++)
    PetscCall(MpmImplicitSolveCreate(m, scheme->table->stiff[i], &m->implicit[i]));
  if (m->particles->own && scheme->table->nstiff) {
    PetscCall(PetscNew(&m->halve));
    m->halve->most = scheme->numbers.halvings;
  }
  if (scheme->numbers.rk_relax) {
    PetscCall(PetscNew(&m->relax));
    m->relax->least = 1;
  }
  if (m->engine->compile) PetscCall(m->engine->compile(m));
  PetscCall(CreateVectors(m));
  if (m->engine->placed) PetscCall(m->engine->placed(m));
  PetscCall(RegisterEvents(m));
  if (MpmTableHas(scheme->table, MPM_SOLVE)) PetscCall(MpmNodalSolveCreate(m, &m->nodal_solve));
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
  if (m->particles->own)
    PetscCall(MpmFiniteFill(m, scene->initial == MPM_INITIAL_RANDOM ? scene->amplitude / scene->wave_speed : 0));
  else {
    m->exponent = MpmSceneExponent(scene);
    PetscCall(MpmParticlesFill(scene, m->exponent, m->particles));
  }
  PetscCall(MpmMarchStart(m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchFillRandom(MpmMarch *march, PetscReal amplitude)
{
  PetscFunctionBegin;
  if (march->particles->own)
    PetscCall(MpmFiniteFill(march, amplitude));
  else {
    march->exponent = ilogb(amplitude);
    PetscCall(MpmParticlesFillRandom(march->layout->seed, scalbn(amplitude, -(int)march->exponent), march->particles));
  }
  PetscCall(MpmMarchStart(march));
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
  PetscCall(MpmMarchFillRandom(m, amplitude));
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
  PetscCall(PetscFree((*march)->watch));
  PetscCall(MpmRelaxDestroy(&(*march)->relax));
  if ((*march)->engine->destroy) PetscCall((*march)->engine->destroy(*march));
  PetscCall(MpmHalveDestroy(&(*march)->halve));
  PetscCall(MpmNodalSolveDestroy(&(*march)->nodal_solve));
  for (PetscInt i = 0; i < MPM_MAX_STIFF; i++) PetscCall(MpmImplicitSolveDestroy(&(*march)->implicit[i]));
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

PetscReal MpmMarchBytes(const MpmScene *scene, PetscBool output)
{
  PetscReal particle = OF_PARTICLE + OF_PLACE * scene->layout.dim + OF_NUMBER * scene->scheme.table->nparticles +
                       (output ? OF_OUTPUT : 0);

  if (scene->scheme.numbers.rk_relax) particle += OF_NUMBER * (scene->scheme.table->nstate + 1);
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (scene->layout.varies[w]) particle += OF_NUMBER;
  return (PetscReal)scene->layout.particles * particle +
         (PetscReal)MpmLayoutNodes(&scene->layout) * (OF_NODE + OF_NUMBER * scene->scheme.table->nnodes);
}

PetscErrorCode MpmMarchLoad(const MpmMarch *march, PetscReal *load)
{
  MPI_Comm    comm    = PetscObjectComm((PetscObject)march->grid->da);
  PetscInt    fullest = march->fullest;
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &fullest, 1, MPIU_INT, MPI_MAX, comm));
  *load = (PetscReal)fullest * size / (PetscReal)march->particles->total;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchRebase(MpmMarch *march)
{
  PetscFunctionBegin;
  PetscCall(MpmParticlesRebase(march->particles, march->grid));
  if (march->engine->placed) PetscCall(march->engine->placed(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Migrate(MpmMarch *march)
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(march->migrate_event, 0, 0, 0, 0));
  PetscCall(MpmMarchRebase(march));
  PetscCall(PetscLogEventEnd(march->migrate_event, 0, 0, 0, 0));
  march->fullest = PetscMax(march->fullest, march->particles->count);
  march->migrations++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Particles are at new places, each by its own velocity. They migrate before one could go beyond the ghost layer in the
   next step. They are sorted every few steps. A state that has been relaxed is summed to the grid anew, if it has been
   already.
*/
static PetscErrorCode Follow(MpmMarch *march, PetscBool summed)
{
  PetscInt  beyond;
  PetscBool scaled = PETSC_FALSE;

  PetscFunctionBegin;
  if (march->relax) PetscCall(MpmRelaxEnd(march, &scaled));
  if (scaled && summed) PetscCall(MpmMarchStart(march));
  PetscCall(MpmFiniteAgree(march, &beyond));
  if (march->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (beyond + 1 > march->slack)
    PetscCall(Migrate(march));
  else if (march->particles->step % SORT_EVERY == 0)
    PetscCall(MpmParticlesSortIfNeeded(march->particles, march->grid));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchMoved(MpmMarch *march, PetscBool summed)
{
  PetscFunctionBegin;
  if (march->watch)
    PetscCall(Follow(march, summed));
  else if (!march->slack)
    PetscCall(Migrate(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles that the next step would take beyond the ghost layer migrate to the ranks that own their cells. */
static PetscErrorCode MigrateInTime(MpmMarch *march)
{
  PetscInt  whole, most = 0;
  PetscReal part;

  PetscFunctionBegin;
  if (!march->slack) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < march->layout->dim; a++) {
    PetscCall(MpmParticlesWhere(march->particles, a, march->step + 1, &whole, &part));
    most = PetscMax(most, PetscAbsInt(whole));
  }
  if (most + 1 > march->slack) PetscCall(Migrate(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes a step, or a part of one. */
static PetscErrorCode Take(MpmMarch *march)
{
  PetscFunctionBegin;
  if (march->watch) MpmFiniteForget(march);
  if (march->relax) PetscCall(MpmRelaxBegin(march));
  PetscCall(march->engine->step(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchStep(MpmMarch *march)
{
  PetscFunctionBegin;
  MpmFloatBegin();
  if (march->halve)
    PetscCall(MpmHalveStep(march, Take));
  else
    PetscCall(Take(march));
  if (march->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  march->step++;
  march->elapsed += march->courant;
  if (!march->watch) PetscCall(MigrateInTime(march));
  PetscCall(MpmFloatEnd(PetscObjectComm((PetscObject)march->grid->da), &march->float_check, "march", march->step));
  PetscFunctionReturn(PETSC_SUCCESS);
}
