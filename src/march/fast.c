/*
   The fast march: a table compiled to passes. Particles go through a pass row by row in a uniform layout and in one
   dimension, and else in clouds, while they are in the cache.
*/
#include "base/large_pages.h"
#include "march/clouds.h"
#include "march/implicit_solve.h"

/* The passes that have plans: those of the schedule, its start, and that of each K. NULL after the last. */
static const MpmPass *PassOf(const MpmMarch *march, PetscInt number)
{
  const MpmSchedule *schedule = &march->schedule;
  const PetscInt     solve    = number - schedule->npasses - 1;

  if (number < schedule->npasses) return &schedule->pass[number];
  if (number == schedule->npasses) return &schedule->start;
  return solve < march->scheme->table->nstiff ? march->implicit[solve]->schedule.pass : NULL;
}

/*
   Compiles the passes. Where particles share no coordinate, which jitter or a motion of their own makes so, for clouds
   too.
*/
static PetscErrorCode Compile(MpmMarch *march)
{
  const PetscBool clouds = march->layout->dim > 1 && (MpmLayoutIsScattered(march->layout) || march->particles->own)
                               ? PETSC_TRUE
                               : PETSC_FALSE;
  PetscInt        n = 0, size = 0;

  PetscFunctionBegin;
  while (PassOf(march, n)) n++;
  if (!march->plans) PetscCall(PetscMalloc1(n, &march->plans));
  if (clouds && !march->clouds) PetscCall(PetscMalloc1(n, &march->clouds));
  for (PetscInt p = 0; p < n; p++) {
    MpmRowPlanCompile(PassOf(march, p), march->scheme->basis, march->layout, &march->plans[p]);
    if (!clouds) continue;
    MpmCloudPlanCompile(&march->plans[p], march->scheme->basis, march->layout->dim, MpmTableHeld(march->scheme->table),
                        &march->clouds[p]);
    size = PetscMax(size, MpmCloudsSize(march->grid, &march->clouds[p]));
  }
  if (!march->scratch)
    PetscCall(PetscMalloc1((march->scheme->table->nparticles - MpmTableHeld(march->scheme->table)) * MPM_BLOCK,
                           &march->scratch));
  if (!clouds || march->bundles) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(size, &march->bundles));
  MpmLargePages(march->bundles, sizeof(PetscReal) * (size_t)size);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(MpmMarch *march)
{
  PetscFunctionBegin;
  PetscCall(PetscFree(march->scratch));
  PetscCall(PetscFree(march->plans));
  PetscCall(PetscFree(march->row));
  PetscCall(PetscFree(march->clouds));
  PetscCall(PetscFree(march->bundles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A field that the pass sums while it reads it is summed to its second array. */
static PetscErrorCode GetSums(MpmMarch *march, const MpmPass *pass, MpmMarchArrays *a)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < pass->nsums; i++) {
    const PetscInt f = pass->sum[i];

    a->sum[f] = a->node[f];
    if (march->spare[f]) PetscCall(MpmGridGetArray(march->grid, march->spare[f], &a->sum[f]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* After that the two arrays change places. */
static PetscErrorCode RestoreSums(MpmMarch *march, const MpmPass *pass, MpmMarchArrays *a)
{
  PetscFunctionBegin;
  for (PetscInt i = 0; i < pass->nsums; i++) {
    const PetscInt f    = pass->sum[i];
    const Vec      kept = march->node[f];

    if (!march->spare[f]) continue;
    PetscCall(MpmGridRestoreArray(march->grid, march->spare[f], &a->sum[f]));
    PetscCall(MpmGridRestoreArray(march->grid, march->node[f], &a->node[f]));
    march->node[f]  = march->spare[f];
    march->spare[f] = kept;
    PetscCall(MpmGridGetArray(march->grid, march->node[f], &a->node[f]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes this rank's particles through a pass, and sums over ranks what they gave to nodes. */
static PetscErrorCode RunParticles(MpmMarch *march, const MpmPass *pass, PetscInt number,
                                   const MpmParity parity[][MPM_MAX_DIM], const MpmMarchArrays *a)
{
  const MpmParity *of_sum[MPM_MAX_FIELDS];
  PetscReal       *sums[MPM_MAX_FIELDS];

  PetscFunctionBegin;
  for (PetscInt s = 0; s < pass->nsums; s++) {
    sums[s]   = a->sum[pass->sum[s]];
    of_sum[s] = parity[pass->sum[s]];
    if (!march->clouds) PetscCall(MpmGridZero(march->grid, sums[s]));
  }
  if (pass->mass != MPM_NONE && !march->clouds) PetscCall(MpmGridZero(march->grid, a->sum[MPM_MASSES]));
  PetscCall(PetscLogEventBegin(march->pass_event, 0, 0, 0, 0));
  if (march->clouds)
    PetscCall(MpmCloudsRun(a, &march->clouds[number], march->bundles));
  else
    MpmRowsRun(a);
  PetscCall(PetscLogEventEnd(march->pass_event, 0, 0, 0, 0));
  PetscCall(MpmNodesSum(march, pass->nsums, sums, of_sum, pass->mass != MPM_NONE ? PETSC_TRUE : PETSC_FALSE,
                        a->sum[MPM_MASSES]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes particles through a pass, and then does its operations on nodes. step: of their places; DRIFT moves it on. */
static PetscErrorCode RunPass(MpmMarch *march, PetscInt number, const MpmParity parity[][MPM_MAX_DIM], PetscInt64 *step)
{
  const MpmPass *pass   = PassOf(march, number);
  MpmMarchArrays arrays = {
      .march = march, .plan = &march->plans[number], .within = pass->within, .scratch = march->scratch};

  PetscFunctionBegin;
  PetscCall(MpmMarchGetArrays(march, *step, &arrays));
  PetscCall(GetSums(march, pass, &arrays));
  PetscCall(RunParticles(march, pass, number, parity, &arrays));
  PetscCall(RestoreSums(march, pass, &arrays));
  if (pass->drifts && !pass->within) ++*step;
  for (PetscInt o = 0; o < pass->nnode_ops; o++) {
    const MpmOp *op = &pass->node_op[o];

    if (op->kind != MPM_IMPLICIT) {
      PetscCall(MpmNodesRun(&arrays, op, pass->depth[o], *step, arrays.node));
      continue;
    }
    if (op->axis > 0) continue;
    PetscCall(MpmMarchRestoreArrays(march, &arrays)); /* a solve takes particles through a pass of its own */
    PetscCall(MpmImplicitSolveApply(march, *step, op));
    PetscCall(MpmMarchGetArrays(march, *step, &arrays));
  }
  PetscCall(MpmMarchRestoreArrays(march, &arrays));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Start(MpmMarch *march)
{
  PetscFunctionBegin;
  PetscCall(RunPass(march, march->schedule.npasses, march->scheme->table->parity, &march->particles->step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Step(MpmMarch *march)
{
  PetscFunctionBegin;
  for (PetscInt p = 0; p < march->schedule.npasses && !march->failure[0]; p++) {
    const MpmPass *pass = &march->schedule.pass[p];

    PetscCall(RunPass(march, p, march->scheme->table->parity, &march->particles->step));
    if (pass->drifts) PetscCall(MpmMarchMoved(march, pass->rebase ? PETSC_FALSE : PETSC_TRUE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Stiffness(MpmMarch *march, PetscInt64 step, PetscInt i)
{
  PetscFunctionBegin;
  PetscCall(RunPass(march, march->schedule.npasses + 1 + i, march->scheme->table->stiff[i]->parity, &step));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmMarchEngine MpmFastMarch = {.compile   = Compile,
                                     .placed    = MpmRowsFind,
                                     .start     = Start,
                                     .step      = Step,
                                     .stiffness = Stiffness,
                                     .destroy   = Destroy};
