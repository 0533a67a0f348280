/* Errors of particle fields: field minus exact solution at the particle's Lagrangian coordinate X = x - U0 t. */
#include "march/diagnostics.h"
#include <math.h>

/* Over this rank: the sums of V abs(e) and V e^2, and the largest abs(e). */
static PetscErrorCode LocalSums(const MpmMarch *march, PetscInt field, const MpmProfile *profile, PetscReal scale,
                                PetscReal sums[3])
{
  const MpmScene     *scene     = march->scene;
  const MpmParticles *particles = march->particles;
  const char         *name      = scene->scheme.table->fields[field];
  const PetscReal     t         = MpmMarchTime(march, march->step);
  const PetscBool     weighed   = scene->layout.varies[MPM_VOLUME];
  const PetscReal    *q, *volume = NULL;
  const PetscInt64   *id;

  PetscFunctionBegin;
  if (weighed) PetscCall(MpmParticlesGet(particles, MpmPropertyNames[MPM_VOLUME], &volume));
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesGet(particles, name, &q));
  sums[0] = sums[1] = sums[2] = 0;
  for (PetscInt p = 0; p < particles->count; p++) {
    const PetscReal V = weighed ? volume[p] : 1;
    PetscReal       X[MPM_MAX_DIM], e;

    MpmParticlesLagrangian(particles, id[p], scene->cell_width, X);
    e = fabs(q[p] - scale * MpmSceneExact(scene, profile, field, X, t));
    sums[0] += V * e;
    sums[1] += V * e * e;
    if (!(e <= sums[2])) sums[2] = e; /* NaN is the largest */
  }
  if (weighed) PetscCall(MpmParticlesRestore(particles, MpmPropertyNames[MPM_VOLUME], &volume));
  PetscCall(MpmParticlesRestore(particles, name, &q));
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmDiagnosticsErrors(const MpmMarch *march, MpmError error[])
{
  const MpmScene       *scene = march->scene;
  const MpmFormulation *f     = scene->scheme.formulation;
  const int             start = ilogb(scene->amplitude), grown = (int)march->exponent - start;
  const MpmProfile      profile = MpmSceneProfile(scene, scalbn(scene->amplitude, -start));
  const MPI_Comm        comm    = PetscObjectComm((PetscObject)march->grid->da);
  /* the sum of all volumes: in a full grid it is ppc a cell, however many particles share the cell */
  const PetscReal volume = MpmSceneIsFull(scene)
                               ? (PetscReal)MpmLayoutCells(&scene->layout) * MpmLayoutPpc(&scene->layout)
                               : (PetscReal)scene->layout.particles;

  PetscFunctionBegin;
  if (scene->scheme.space.finite) {
    PetscCall(MpmSolutionErrors(march, error));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  for (PetscInt field = 0; field < scene->scheme.table->nstate; field++) {
    const PetscReal unit = f->wave->amplitude(&profile, scene->scheme.table->field[field]);
    PetscReal       sums[3];

    PetscCall(LocalSums(march, field, &profile, scalbn(1, -grown), sums));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 2, MPIU_REAL, MPI_SUM, comm));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &sums[2], 1, MPIU_REAL, MPI_MAX, comm));
    error[field].l1   = scalbn(sums[0] / volume / unit, grown);
    error[field].l2   = scalbn(sqrt(sums[1] / volume) / unit, grown);
    error[field].linf = scalbn(sums[2] / unit, grown);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
