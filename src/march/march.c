/*
   The march: sets up grid, particles and vectors, and takes steps pass by pass. Particles migrate to another rank
   before they would leave the ghost layer.
*/
#include "base/large_pages.h"
#include "march/clouds.h"
#include "march/finite.h"
#include "march/finite_state.h"
#include "march/implicit_solve.h"
#include "march/relax.h"
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
  PetscInt         need, spare, stride = 1;
  PetscMPIInt      size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(comm, &size));
  for (PetscInt a = 0; a < layout->dim; a++)
    stride = PetscMax(stride, own ? 2 : (PetscInt)ceil(PetscAbsReal(step->drift[a].value)) + 1);
  PetscCall(MpmScheduleCompile(table, basis, layout, step->courant, drifts, PETSC_TRUE, &march->schedule));
  need = reach + march->schedule.halo;
  PetscCall(MpmPartitionCreate(layout, size, need, drifts, partition));
  PetscCall(CheckCells(march, size, need, partition->smallest >= need ? PETSC_TRUE : PETSC_FALSE));
  spare        = PetscMin(partition->smallest - need, PetscMax(layout->dim == 1 ? MOST_SLACK : SLACK_OF_BOX, stride));
  march->slack = drifts && spare >= stride ? spare : 0;
  if (drifts && !march->slack)
    PetscCall(MpmScheduleCompile(table, basis, layout, step->courant, PETSC_TRUE, PETSC_FALSE, &march->schedule));
  *ghost = need + march->slack;
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmPass *MpmMarchPass(const MpmMarch *march, PetscInt number)
{
  const MpmSchedule *schedule = &march->schedule;
  const PetscInt     solve    = number - schedule->npasses - 1;

  if (number < schedule->npasses) return &schedule->pass[number];
  if (number == schedule->npasses) return &schedule->start;
  return solve < march->scheme->table->nstiff ? march->implicit[solve]->schedule.pass : NULL;
}

static PetscInt CountPasses(const MpmMarch *march)
{
  PetscInt n = 0;

  while (MpmMarchPass(march, n)) n++;
  return n;
}

/* Compiles the passes for more than one dimension. */
static PetscErrorCode CompilePlans(MpmMarch *march)
{
  PetscFunctionBegin;
  if (!march->plans) PetscCall(PetscMalloc1(CountPasses(march), &march->plans));
  for (PetscInt p = 0; MpmMarchPass(march, p); p++)
    MpmRowPlanCompile(MpmMarchPass(march, p), march->scheme->basis, march->grid->dim, &march->plans[p]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same for particles that share no coordinate: jitter is in all directions, and so is a motion of their own. */
static PetscErrorCode CompileClouds(MpmMarch *march)
{
  PetscInt size = 0;

  PetscFunctionBegin;
  if (march->layout->jitter == 0 && !march->particles->own) PetscFunctionReturn(PETSC_SUCCESS);
  if (!march->clouds) PetscCall(PetscMalloc1(CountPasses(march), &march->clouds));
  for (PetscInt p = 0; MpmMarchPass(march, p); p++) {
    MpmCloudPlanCompile(&march->plans[p], march->scheme->basis, march->layout->dim, march->scheme->table->nstate,
                        &march->clouds[p]);
    size = PetscMax(size, MpmCloudsSize(march->grid, &march->clouds[p]));
  }
  if (march->bundles) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(size, &march->bundles));
  MpmLargePages(march->bundles, sizeof(PetscReal) * (size_t)size);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The passes have the Courant number as a factor of their operations. */
PetscErrorCode MpmMarchSetCourant(MpmMarch *march, PetscReal courant)
{
  PetscFunctionBegin;
  march->courant = courant;
  PetscCall(MpmScheduleCompile(march->scheme->table, march->scheme->basis, march->layout, courant, PETSC_TRUE,
                               march->slack ? PETSC_TRUE : PETSC_FALSE, &march->schedule));
  if (march->layout->dim > 1) {
    PetscCall(CompilePlans(march));
    PetscCall(CompileClouds(march));
  }
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
  if (scheme->numbers.rk_relax) {
    PetscCall(PetscNew(&m->relax));
    m->relax->least = 1;
  }
  if (layout->dim > 1) {
    PetscCall(CompilePlans(m));
    PetscCall(CompileClouds(m));
  }
  PetscCall(MpmRowsFind(m));
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
  if (m->particles->own)
    PetscCall(MpmFiniteFill(m, scene->initial == MPM_INITIAL_RANDOM ? scene->amplitude / scene->wave_speed : 0));
  else {
    m->exponent = MpmSceneExponent(scene);
    PetscCall(MpmParticlesFill(scene, m->exponent, m->particles));
  }
  PetscCall(MpmMarchRunPasses(m, 1, &m->schedule.start, PETSC_FALSE));
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
  PetscCall(MpmMarchRunPasses(march, 1, &march->schedule.start, PETSC_FALSE));
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
  PetscCall(PetscFree((*march)->scratch));
  PetscCall(PetscFree((*march)->plans));
  PetscCall(PetscFree((*march)->row));
  PetscCall(PetscFree((*march)->clouds));
  PetscCall(PetscFree((*march)->bundles));
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

static PetscErrorCode Migrate(MpmMarch *march)
{
  PetscFunctionBegin;
  PetscCall(PetscLogEventBegin(march->migrate_event, 0, 0, 0, 0));
  PetscCall(MpmParticlesRebase(march->particles, march->grid));
  PetscCall(MpmRowsFind(march));
  PetscCall(PetscLogEventEnd(march->migrate_event, 0, 0, 0, 0));
  march->fullest = PetscMax(march->fullest, march->particles->count);
  march->migrations++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Ends a pass after which particles are at new places, each by its own velocity. They migrate before one could go beyond
   the ghost layer in the next step. They are sorted every few steps. A state that has been relaxed is summed to the grid
   anew, if it has been already.
*/
static PetscErrorCode Follow(MpmMarch *march, PetscBool summed)
{
  PetscInt  beyond;
  PetscBool scaled = PETSC_FALSE;

  PetscFunctionBegin;
  if (march->relax) PetscCall(MpmRelaxEnd(march, &scaled));
  if (scaled && summed) PetscCall(MpmMarchRunPasses(march, 1, &march->schedule.start, PETSC_FALSE));
  PetscCall(MpmFiniteAgree(march, &beyond));
  if (march->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  if (beyond + 1 > march->slack)
    PetscCall(Migrate(march));
  else if (march->particles->step % SORT_EVERY == 0)
    PetscCall(MpmParticlesSortIfNeeded(march->particles, march->grid));
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

PetscErrorCode MpmMarchStep(MpmMarch *march, PetscBool sample)
{
  PetscFunctionBegin;
  MpmFloatBegin();
  if (march->watch) MpmFiniteForget(march);
  if (march->relax) PetscCall(MpmRelaxBegin(march));
  if (sample) PetscCall(PetscArrayzero(march->squares, MPM_MAX_FIELDS));
  for (PetscInt p = 0, n; p < march->schedule.npasses; p += n) {
    const MpmPass *pass = &march->schedule.pass[p];

    for (n = 1; p + n < march->schedule.npasses && pass[n].joined; n++) continue;
    PetscCall(MpmMarchRunPasses(march, n, pass, sample));
    if (pass[n - 1].drifts && march->watch)
      PetscCall(Follow(march, pass[n - 1].rebase ? PETSC_FALSE : PETSC_TRUE));
    else if (pass[n - 1].rebase)
      PetscCall(Migrate(march));
    if (march->failure[0]) PetscFunctionReturn(PETSC_SUCCESS);
  }
  march->step++;
  march->elapsed += march->courant;
  if (!march->watch) PetscCall(MigrateInTime(march));
  PetscCall(MpmFloatEnd(PetscObjectComm((PetscObject)march->grid->da), &march->float_check, "march", march->step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   P2G of one particle field with the particles at the places of a step. With with_mass it also sets inverse_mass, the
   inverses of the nodal masses there.
*/
static PetscErrorCode Project(MpmMarch *march, PetscInt field, PetscInt64 step, PetscBool with_mass, Vec inverse_mass,
                              Vec node)
{
  const MpmBasis      *basis = march->scheme->basis;
  MpmParity            parity[1][MPM_MAX_DIM];
  const MpmPass        project = {.nops      = 1,
                                  .nsums     = 1,
                                  .sums_mass = with_mass,
                                  .op        = {{.kind        = with_mass ? MPM_PASS_MASS : MPM_PASS_MAP,
                                                 .map         = MPM_P2G,
                                                 .kernel      = basis->kernel[MPM_P2G],
                                                 .mass_kernel = basis->p2g_mass,
                                                 .a           = 1,
                                                 .particle    = field,
                                                 .to_nodes    = PETSC_TRUE,
                                                 .weight      = MpmLayoutWeight(march->layout, MPM_P2G)}}};
  Vec                  spare   = NULL;
  const MpmNodeVectors nodes   = {.n            = 1,
                                  .node         = &node,
                                  .spare        = &spare,
                                  .inverse_mass = inverse_mass,
                                  .parity       = (const MpmParity(*)[MPM_MAX_DIM])parity};

  PetscFunctionBegin;
  PetscCall(PetscArraycpy(parity[0], MpmTableParity(march->scheme->table, field), MPM_MAX_DIM));
  PetscCall(MpmMarchRunPassesOn(march, &nodes, &step, 1, &project, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, Vec node)
{
  PetscFunctionBegin;
  PetscCall(Project(march, field, march->particles->step, PETSC_FALSE, march->inverse_mass, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMarchProjectNext(MpmMarch *march, PetscInt field, Vec inverse_mass, Vec node)
{
  PetscFunctionBegin;
  PetscCall(Project(march, field, march->particles->step + 1, PETSC_TRUE, inverse_mass, node));
  PetscFunctionReturn(PETSC_SUCCESS);
}
