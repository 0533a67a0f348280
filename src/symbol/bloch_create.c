/* What a Bloch mode is made with: its registers, the weights of its maps, and where particles stand after a turn. */
#include "symbol/bloch_gained.h"
#include "symbol/bloch_nodal.h"
#include "symbol/bloch.h"
#include <math.h>

#define LANES_UP_TO 64 /* columns of a Courant number; wider rows fill the blocks well enough */

/*
   Finds the kinds whose weights the maps of a scheme have along some direction. Every table has a P2G, whose weights give
   the masses. SOLVE needs G2P too.
*/
static void FindUsed(const MpmTable *t, PetscBool used[])
{
  for (PetscInt o = 0; o < t->nops; o++) {
    const MpmOp      *op     = &t->ops[o];
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

    if (op->kind == MPM_SOLVE) used[MPM_G2P] = PETSC_TRUE;
    if (traits.src == traits.dst) continue;
    for (PetscInt a = 0; a < t->dim; a++) used[MpmKindAlong(op->kind, op->axis, a)] = PETSC_TRUE;
  }
}

static PetscInt FloorOver(PetscInt a, PetscInt b)
{
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/*
   A turn is over when every particle has the place that some particle of a cell had at the start: after a whole number
   of the distances between them, 1 / ppc.
*/
static PetscErrorCode FindTurn(const MpmFraction drift[], MpmBloch *b)
{
  const PetscInt *ppc = b->layout->ppc;

  PetscFunctionBegin;
  b->turn = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    const PetscInt steps =
        drift[a].value == 0 ? 1 : (PetscInt)drift[a].den / (PetscInt)MpmCommonDivisor(drift[a].den, ppc[a]);

    b->turn *= steps / (PetscInt)MpmCommonDivisor(b->turn, steps);
  }
  PetscCall(PetscMalloc2(b->ppc, &b->place, b->ppc, &b->beyond));
  for (PetscInt j = 0; j < b->ppc; j++) {
    PetscInt stride = 1, rest = j;

    b->place[j] = 0;
    for (PetscInt a = 0; a < b->layout->dim; a++) {
      const PetscInt moved = drift[a].value == 0 ? 0 : (PetscInt)(drift[a].num * b->turn * ppc[a] / drift[a].den),
                     to    = rest % ppc[a] + moved;

      b->beyond[j][a] = FloorOver(to, ppc[a]);
      b->place[j] += stride * (to - ppc[a] * b->beyond[j][a]);
      stride *= ppc[a];
      rest /= ppc[a];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles that move take the smaller matrix of a turn where there is one. */
static PetscErrorCode FindTaken(MpmBloch *b)
{
  PetscFunctionBegin;
  b->turn_size = b->size;
  if (b->period == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmTakenFind(b->scheme->table, PETSC_FALSE, &b->taken));
  if (b->taken) b->turn_size = b->taken->numbers + b->taken->left * b->ppc;
  if (b->taken && b->turn_size < b->size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(b->taken));
  b->turn_size = b->size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction drift[], MpmBloch *b)
{
  const MpmTable *table = scheme->table;
  MpmStep         step  = {.courant = 0};

  PetscFunctionBegin;
  PetscCall(MpmTableRequireLinear(table));
  *b = (MpmBloch){.layout = layout, .scheme = scheme, .fields = table->nstate, .ppc = MpmLayoutPpc(layout)};
  for (PetscInt a = 0; a < layout->dim; a++) step.drift[a] = drift[a];
  PetscCall(MpmStepPeriod(&step, &b->period));
  b->size = b->fields * b->ppc;
  PetscCall(FindTurn(drift, b));
  PetscCall(FindTaken(b));
  b->most = b->size <= LANES_UP_TO ? MPM_BLOCH_LANES : 1;
  PetscCall(PetscMalloc3(2 * table->nparticles * b->ppc * MpmBlochFullWidth(b->size * b->most), &b->particle,
                         2 * table->nnodes * MpmBlochFullWidth(b->size * b->most), &b->nodes,
                         b->most > 1 ? b->most * b->turn_size * b->turn_size : 0, &b->turns));
  PetscCall(PetscMalloc2(table->nops, &b->traits, table->nops * MPM_BLOCH_LANES, &b->values));
  for (PetscInt o = 0; o < table->nops; o++) b->traits[o] = MpmOpTraitsOf(table->ops[o].kind);
  FindUsed(scheme->table, b->used);
  for (PetscInt i = 0; i < table->nstiff; i++) FindUsed(table->stiff[i], b->used);
  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscCall(MpmTiesCreate(layout, scheme, a, &drift[a], b->used, &b->ties[a]));
    PetscCall(PetscMalloc1(b->ties[a].period * MPM_OP_KINDS * layout->ppc[a], &b->tie[a]));
    b->beta[a] = NAN;
  }
  PetscCall(MpmBlochNodalCreate(b, &b->nodal));
  if (!b->nodal && !b->taken && b->most == 1) PetscCall(MpmBlochGainedCreate(b, drift, &b->gained));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochDestroy(MpmBloch *b)
{
  PetscFunctionBegin;
  PetscCall(MpmBlochNodalDestroy(&b->nodal));
  PetscCall(MpmBlochGainedDestroy(&b->gained));
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    PetscCall(MpmTiesDestroy(&b->ties[a]));
    PetscCall(PetscFree(b->tie[a]));
  }
  PetscCall(PetscFree3(b->particle, b->nodes, b->turns));
  PetscCall(PetscFree2(b->place, b->beyond));
  PetscCall(PetscFree(b->taken));
  PetscCall(PetscFree2(b->traits, b->values));
  PetscFunctionReturn(PETSC_SUCCESS);
}
