/* The weights of the maps along one direction, from the rows of their kernels. */
#include "scene/layout.h"
#include "symbol/ties.h"

/* The number of the particle of the first cell that is j-th along an axis and first along the others. */
static PetscInt64 Along(const MpmLayout *layout, PetscInt axis, PetscInt j)
{
  PetscInt64 id = j;

  for (PetscInt a = 0; a < axis; a++) id *= layout->row[a];
  return id;
}

PetscErrorCode MpmTiesCreate(const MpmLayout *layout, const MpmScheme *scheme, PetscInt axis, const MpmFraction *drift,
                             const PetscBool used[MPM_OP_KINDS], MpmTies *t)
{
  const PetscInt n = layout->ppc[axis], reach = MpmMapReach(scheme->basis);
  PetscInt       highest             = -PETSC_MAX_INT;
  MpmFraction    drifts[MPM_MAX_DIM] = {{0}};

  PetscFunctionBegin;
  for (PetscInt a = 0; a < layout->dim; a++) drifts[a].den = 1;
  drifts[axis] = *drift;
  *t           = (MpmTies){
                .n = n, .period = drift->value == 0 ? 1 : (PetscInt)drift->den, .reach = reach, .lowest = PETSC_MAX_INT};
  PetscCall(
      PetscMalloc3(t->period * n, &t->node, t->period * MPM_OP_KINDS * n * reach, &t->rows, t->period, &t->masses));
  for (PetscInt step = 0; step < t->period; step++) {
    t->masses[step] = 0;
    for (PetscInt j = 0; j < n; j++) {
      PetscReal *rows = t->rows + (step * MPM_OP_KINDS * n + j) * reach, xi[MPM_MAX_DIM];
      PetscInt   cell[MPM_MAX_DIM];

      MpmLayoutPlaceAt(layout, drifts, Along(layout, axis, j), step, cell, xi);
      t->node[step * n + j] = cell[axis] - scheme->basis->reach_left;
      for (PetscInt kind = 0; kind < MPM_OP_KINDS; kind++)
        if (used[kind])
          MpmMapRow(scheme->basis, (MpmOpKind)kind, xi[axis], layout->half_width[axis], MpmNoWalls,
                    rows + kind * n * reach);
      for (PetscInt d = 0; d < reach; d++) t->masses[step] += rows[MPM_P2G * n * reach + d];
      t->lowest = PetscMin(t->lowest, t->node[step * n + j]);
      highest   = PetscMax(highest, t->node[step * n + j]);
    }
  }
  t->seen = highest - t->lowest + reach;
  PetscCheck(t->seen <= MPM_MOST_SEEN, PETSC_COMM_SELF, PETSC_ERR_PLIB, "raise MPM_MOST_SEEN");
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTiesDestroy(MpmTies *t)
{
  PetscFunctionBegin;
  if (t->node) PetscCall(PetscFree3(t->node, t->rows, t->masses));
  PetscFunctionReturn(PETSC_SUCCESS);
}

void MpmTiesWave(const MpmTies *t, PetscReal beta, double complex wave[MPM_MOST_SEEN])
{
  for (PetscInt i = 0; i < t->seen; i++) wave[i] = cexp(I * (beta * (t->lowest + i)));
}
