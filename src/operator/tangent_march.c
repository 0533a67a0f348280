/*
   A rank of the march has the particles that are in its cells now, and one of a tangent those that were there at rest.
   So each particle sends its numbers to the row of its id.
*/
#include "operator/tangent.h"
#include "march/finite.h"
#include <math.h>

#define TIE 1e-9 /* places nearer to one without a derivative are at it */

PetscErrorCode MpmMarchPut(const MpmMarch *march, const char name[], PetscBool whole, PetscReal plus, PetscInt columns,
                           PetscInt column, Vec all)
{
  const PetscInt64 *id;
  const void       *field;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesGet(march->particles, name, &field));
  for (PetscInt p = 0; p < march->particles->count; p++) {
    const PetscInt  row   = (PetscInt)id[p] * columns + column;
    const PetscReal value = whole ? ((const PetscInt *)field)[p] : ((const PetscReal *)field)[p];

    PetscCall(VecSetValue(all, row, value + plus, INSERT_VALUES));
  }
  PetscCall(MpmParticlesRestore(march->particles, name, &field));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The body force at the time of the next step, or where it is taken in that step. */
static PetscErrorCode SetLoad(const MpmTangentSpace *space, const MpmMarch *march, MpmTangentState *state)
{
  const PetscInt  dim  = space->sizes.layout->dim;
  const PetscReal part = march->scheme->table->nstiff ? march->scheme->table->stiff[0]->theta : 0;
  PetscReal      *to[MPM_MAX_DIM], load[MPM_MAX_DIM];

  PetscFunctionBegin;
  if (!march->scheme->space.loaded) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt a = 0; a < dim; a++) PetscCall(VecGetArray(state->load[a], &to[a]));
  for (PetscInt p = 0; p < space->sizes.particles; p++) {
    MpmFiniteLoad(march, space->sizes.begin + p, march->particles->step, part, load);
    for (PetscInt a = 0; a < dim; a++) to[a][p] = load[a];
  }
  for (PetscInt a = 0; a < dim; a++) PetscCall(VecRestoreArray(state->load[a], &to[a]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentStateOf(const MpmTangentSpace *space, const MpmMarch *march, MpmTangentState *state)
{
  const MpmTable  *t   = march->scheme->table;
  const PetscInt   dim = t->dim, columns = 2 * dim + t->nstate, n = space->sizes.particles;
  const PetscReal *value;
  Vec              all;

  PetscFunctionBegin;
  PetscCall(VecCreateMPI(space->sizes.comm, columns * n, PETSC_DETERMINE, &all));
  for (PetscInt a = 0; a < dim; a++) {
    PetscCall(MpmMarchPut(march, MpmFieldCell[a], PETSC_TRUE, march->grid->axis[a].first, columns, a, all));
    PetscCall(MpmMarchPut(march, MpmFieldXi[a], PETSC_FALSE, 0, columns, dim + a, all));
  }
  for (PetscInt f = 0; f < t->nstate; f++)
    PetscCall(MpmMarchPut(march, t->fields[f], PETSC_FALSE, 0, columns, 2 * dim + f, all));
  PetscCall(VecAssemblyBegin(all));
  PetscCall(VecAssemblyEnd(all));
  PetscCall(VecGetArrayRead(all, &value));
  for (PetscInt f = 0; f < t->nstate; f++) {
    PetscReal *q;

    PetscCall(VecGetArray(state->field[f], &q));
    for (PetscInt p = 0; p < n; p++) q[p] = value[columns * p + 2 * dim + f];
    PetscCall(VecRestoreArray(state->field[f], &q));
  }
  for (PetscInt p = 0; p < n; p++)
    for (PetscInt a = 0; a < dim; a++) {
      state->places.cell[a][p] = (PetscInt)value[columns * p + a];
      state->places.xi[a][p]   = value[columns * p + dim + a];
    }
  PetscCall(VecRestoreArrayRead(all, &value));
  state->time = march->scene ? MpmMarchTime(march, march->particles->step) : 0;
  PetscCall(SetLoad(space, march, state));
  PetscCall(VecDestroy(&all));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The largest difference of how far particles have moved along a direction. In a periodic one they may come in anew. */
static PetscReal MovedApart(const MpmTangentSpace *space, PetscInt a, const MpmTangentState *before,
                            const MpmTangentState *state, const PetscReal moved[])
{
  const MpmDirection *direction = &space->sizes.layout->grid[a];
  PetscReal           largest   = 0;

  for (PetscInt p = 0; p < space->sizes.particles; p++) {
    const PetscInt  whole = state->places.cell[a][p] - before->places.cell[a][p];
    const PetscReal apart = whole + (state->places.xi[a][p] - before->places.xi[a][p]) - moved[p];

    largest = PetscMax(largest, fabs(direction->ends[0] == MPM_PERIODIC ? remainder(apart, direction->cells) : apart));
  }
  return largest;
}

static PetscErrorCode Compare(const MpmTangentSpace *space, const MpmTangentState *before, const MpmTangentState *state,
                              Vec after[], PetscReal *mismatch)
{
  const PetscInt dim = space->sizes.layout->dim;

  PetscFunctionBegin;
  *mismatch = 0;
  for (PetscInt f = 0; f < space->nstate; f++) {
    PetscReal size = 1, apart;

    if (f < dim) {
      const PetscReal *moved;

      PetscCall(VecGetArrayRead(after[f], &moved));
      apart = MovedApart(space, f, before, state, moved);
      PetscCall(VecRestoreArrayRead(after[f], &moved));
    } else {
      PetscCall(VecNorm(after[f], NORM_INFINITY, &size));
      PetscCall(VecAXPY(after[f], -1, state->field[f - dim]));
      PetscCall(VecNorm(after[f], NORM_INFINITY, &apart));
    }
    *mismatch = PetscMax(*mismatch, apart / PetscMax(1, size));
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, mismatch, 1, MPIU_REAL, MPI_MAX, space->sizes.comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentMismatch(MpmTangentSpace *space, MpmMarch *march, Mat *tangent, PetscReal *mismatch)
{
  MpmTangentState before, state;
  Vec             after[MPM_MAX_STATE];

  PetscFunctionBegin;
  PetscCall(MpmTangentStateCreate(space, &before));
  PetscCall(MpmTangentStateCreate(space, &state));
  PetscCall(MpmTangentStateOf(space, march, &before));
  for (PetscInt f = 0; f < space->nstate; f++) PetscCall(VecDuplicate(state.field[0], &after[f]));
  PetscCall(MpmTangentOf(space, march->courant, &before, tangent, after));
  PetscCall(MpmMarchStep(march));
  *mismatch = NAN;
  if (!march->failure[0]) {
    PetscCall(MpmTangentStateOf(space, march, &state));
    PetscCall(Compare(space, &before, &state, after, mismatch));
  }
  for (PetscInt f = 0; f < space->nstate; f++) PetscCall(VecDestroy(&after[f]));
  PetscCall(MpmTangentStateDestroy(space, &before));
  PetscCall(MpmTangentStateDestroy(space, &state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentRoom(const MpmTangentSpace *space, const MpmTangentState *state, PetscReal *room)
{
  const MpmSlab  *r     = &space->sizes;
  const MpmBasis *basis = r->scheme->basis;

  PetscFunctionBegin;
  *room = INFINITY;
  for (PetscInt a = 0; a < r->layout->dim && !basis->smooth; a++) {
    const PetscReal at = basis->hat ? 0 : basis->wide ? r->layout->half_width[a] : 0.5;

    for (PetscInt p = 0; p < r->particles; p++) {
      const PetscReal xi = state->places.xi[a][p];

      *room = PetscMin(*room, PetscMin(fabs(remainder(xi - at, 1)), fabs(remainder(xi + at, 1))));
    }
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, room, 1, MPIU_REAL, MPI_MIN, r->comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTangentCheck(const MpmTangentSpace *space, const MpmTangentState *state)
{
  const MpmBasis *basis = space->sizes.scheme->basis;
  PetscReal       room;

  PetscFunctionBegin;
  PetscCall(MpmTangentRoom(space, state, &room));
  MpmCheckInput(room > TIE,
                "basis %s: a particle is where the weights %s, and the step has no derivative there; allowed: another "
                "offset, ppc or jitter, or basis cubic",
                basis->name, basis->hat ? "have jumps in their slopes" : "have jumps in the slopes of their slopes");
  PetscFunctionReturn(PETSC_SUCCESS);
}
