/*
   Places, velocities and deformation gradients of particles against an exact solution. A place in a periodic direction
   is off by the shortest way. Of a gas the density is known: that at rest over F.
*/
#include "march/solution_errors.h"
#include "scene/material.h"
#include "scene/solution.h"
#include <math.h>

/* What is measured: place along an axis, or a state register where that is MPM_NONE. */
typedef struct {
  PetscInt  axis, r;
  PetscReal size;
} Measured;

static PetscInt List(const MpmScene *scene, const MpmSolution *solution, Measured measured[])
{
  const MpmTable *t = scene->scheme.table;
  PetscReal       size[3];
  PetscInt        n = 0;

  solution->sizes(scene, size);
  for (PetscInt a = 0; a < scene->layout.dim && !solution->density; a++)
    measured[n++] = (Measured){a, MPM_NONE, size[0]};
  for (PetscInt r = 0; r < t->nstate; r++)
    if (t->field[r] != MPM_NONE)
      measured[n++] = (Measured){MPM_NONE, r, t->field[r] == MPM_STRETCHED ? size[2] : size[1] / scene->wave_speed};
  return n;
}

/* Where the particles are, in the scene's unit of length: a direction after another. */
static PetscErrorCode Places(const MpmMarch *march, PetscReal x[])
{
  const PetscInt   n = march->particles->count;
  const PetscInt  *cell;
  const PetscReal *xi;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < march->grid->dim; a++) {
    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &xi));
    for (PetscInt p = 0; p < n; p++)
      x[a * n + p] = march->scene->cell_width * (march->grid->axis[a].first + cell[p] + xi[p]);
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &xi));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal ErrorAt(const MpmScene *scene, const MpmSolution *solution, const Measured *m, const PetscReal X[],
                         const PetscReal x[], const PetscReal q[], PetscInt p, PetscReal t)
{
  MpmSolutionState state;
  PetscReal        exact, density;

  if (m->axis != MPM_NONE) {
    solution->exact(scene, X, x, t, &state);
    exact = x[m->axis] - state.place[m->axis];
    return scene->layout.grid[m->axis].ends[0] == MPM_PERIODIC ? remainder(exact, scene->length[m->axis]) : exact;
  }
  exact = MpmSolutionRegister(scene, m->r, X, x, t);
  if (!solution->density || scene->scheme.table->field[m->r] != MPM_STRETCHED) return q[p] - exact;
  density = MpmMaterialDensity(&scene->layout, (PetscReal[]){X[0] / scene->cell_width});
  return density / q[p] - density / exact;
}

/* Over this rank: the sums of abs(e) and e^2, and the largest abs(e). */
static PetscErrorCode LocalSums(const MpmMarch *march, const Measured *m, const PetscReal places[], PetscReal sums[3])
{
  const MpmScene    *scene    = march->scene;
  const MpmSolution *solution = MpmSolutionOf(scene);
  const char        *name     = m->r != MPM_NONE ? scene->scheme.table->fields[m->r] : NULL;
  const PetscReal   *q        = NULL;
  const PetscInt64  *id;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  if (name) PetscCall(MpmParticlesGet(march->particles, name, &q));
  sums[0] = sums[1] = sums[2] = 0;
  for (PetscInt p = 0; p < march->particles->count; p++) {
    PetscReal X[MPM_MAX_DIM], x[MPM_MAX_DIM], e;

    MpmLayoutRest(march->layout, id[p], X);
    for (PetscInt a = 0; a < march->grid->dim; a++) {
      X[a] *= scene->cell_width;
      x[a] = places[a * march->particles->count + p];
    }
    e = fabs(ErrorAt(scene, solution, m, X, x, q, p, MpmMarchTime(march, march->step)));
    sums[0] += e;
    sums[1] += e * e;
    if (!(e <= sums[2])) sums[2] = e; /* NaN is the largest */
  }
  if (name) PetscCall(MpmParticlesRestore(march->particles, name, &q));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmSolutionErrors(const MpmMarch *march, MpmError error[])
{
  const MPI_Comm  comm  = PetscObjectComm((PetscObject)march->grid->da);
  const PetscReal total = (PetscReal)march->layout->particles;
  Measured        measured[MPM_MOST_ERRORS];
  const PetscInt  n = List(march->scene, MpmSolutionOf(march->scene), measured);
  PetscReal      *places;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(march->grid->dim * march->particles->count, &places));
  PetscCall(Places(march, places));
  for (PetscInt i = 0; i < n; i++) {
    PetscReal sums[3];

    PetscCall(LocalSums(march, &measured[i], places, sums));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPI_SUM, comm));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sums[2], 1, MPIU_REAL, MPI_MAX, comm));
    error[i].l1   = sums[0] / total / measured[i].size;
    error[i].l2   = sqrt(sums[1] / total) / measured[i].size;
    error[i].linf = sums[2] / measured[i].size;
  }
  PetscCall(PetscFree(places));
  PetscFunctionReturn(PETSC_SUCCESS);
}
