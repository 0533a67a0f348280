/* Where a march at finite deformation starts from, and the norms of its state. */
#include "march/finite_state.h"
#include "scene/material.h"
#include "scene/solution.h"
#include "scheme/deform.h"
#include <math.h>

/* A seed for each random field, so that these are independent. Places have the numbers after those of the state. */
static PetscInt64 SeedOf(const MpmMarch *march, PetscInt field)
{
  return (PetscInt64)(0x1p52 * MpmHash(march->layout->seed + 1, -2 - field));
}

/*
   What state register r starts from: of particles at X, in the scene's unit of length; without X what the uniform state
   has.
*/
static PetscReal Start(const MpmMarch *march, const MpmProfile *profile, PetscInt r, const PetscReal X[])
{
  const MpmTable *t   = march->scheme->table;
  const PetscInt  dim = t->dim, component = t->component[r];
  PetscReal       value = 0;

  if (X && MpmSolutionOf(march->scene)) return MpmSolutionRegister(march->scene, r, X, X, 0);
  if (t->field[r] == MPM_STRETCHED && component >= dim * dim) {
    (void)MpmMaterialInternal(t->material.law, component - dim * dim, &value);
    return value;
  }
  if (t->field[r] == MPM_STRETCHED)
    return component / dim == component % dim ? march->scheme->space.stretch[component / dim] : 0;
  if (t->field[r] != MPM_NONE) value = march->velocity[component];
  if (X && march->scene->initial == MPM_INITIAL_COLLISION && X[0] > march->scene->length[0] / 2) value = -value;
  if (profile) value += MpmSceneExact(march->scene, profile, r, X, 0) / march->scene->wave_speed;
  return value;
}

/* The unit of a component of the stretch: that at the start. Internal variables have none. */
static PetscReal UnitOf(const MpmMarch *march, PetscInt component)
{
  const PetscInt dim = march->scheme->table->dim;

  return component < dim * dim ? march->scheme->space.stretch[component % dim] : 1;
}

static PetscErrorCode FillField(MpmMarch *march, const MpmProfile *profile, PetscReal noise, PetscInt r,
                                const PetscInt64 id[])
{
  const MpmTable  *t        = march->scheme->table;
  const PetscBool  stretch  = t->field[r] == MPM_STRETCHED ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal  size     = noise * (stretch ? UnitOf(march, t->component[r]) : 1);
  const PetscBool  internal = stretch && t->component[r] >= t->dim * t->dim ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt64 seed     = SeedOf(march, r);
  const MpmGiven  *given    = march->layout->given;
  const PetscReal *own      = given && !stretch && t->field[r] != MPM_NONE ? given->velocity[t->component[r]] : NULL;
  PetscReal       *q;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, t->fields[r], &q));
  for (PetscInt p = 0; p < march->particles->count; p++) {
    PetscReal X[MPM_MAX_DIM] = {0};

    MpmParticlesLagrangian(march->particles, id[p], march->cell_width, X);
    q[p] = Start(march, profile, r, march->scene ? X : NULL);
    if (own) q[p] = own[id[p]];
    if (size > 0 && !internal) q[p] += size * (2 * MpmHash(seed, id[p]) - 1);
  }
  PetscCall(MpmParticlesRestore(march->particles, t->fields[r], &q));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Moves the particles out of their places at rest by random numbers in [-noise, noise) of a cell. */
static PetscErrorCode Displace(MpmMarch *march, PetscReal noise, const PetscInt64 id[])
{
  const MpmGrid *grid   = march->grid;
  PetscInt64     failed = PETSC_MAX_INT;
  PetscReal     *way, *xi;
  PetscInt      *cell;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(march->particles->count, &way));
  for (PetscInt a = 0; a < grid->dim; a++) {
    const PetscInt64 seed     = SeedOf(march, march->scheme->table->nstate + a);
    PetscInt         range[2] = {0, 0}, bad;

    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &xi));
    for (PetscInt p = 0; p < march->particles->count; p++) way[p] = noise * (2 * MpmHash(seed, id[p]) - 1);
    bad = MpmAdvance(&march->layout->grid[a], grid->axis[a].first, march->particles->count, way, cell, xi, range);
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &xi));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
    if (bad < march->particles->count) failed = PetscMin(failed, id[bad]);
  }
  PetscCall(PetscFree(way));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPIU_INT64, MPI_MIN, PetscObjectComm((PetscObject)grid->da)));
  MpmCheckInput(failed == PETSC_MAX_INT,
                "amplitude %g: the random start moves particle %" PetscInt64_FMT
                " by a cell or more, or out of the domain; allowed: a smaller one",
                (double)(march->scene ? march->scene->amplitude : noise), failed);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteFill(MpmMarch *march, PetscReal noise)
{
  const MpmScene  *scene   = march->scene;
  const PetscBool  mode    = scene && scene->initial == MPM_INITIAL_MODE ? PETSC_TRUE : PETSC_FALSE;
  const MpmProfile profile = mode ? MpmSceneProfile(scene, scene->amplitude) : (MpmProfile){.dim = 0};
  PetscInt64      *id;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  for (PetscInt r = 0; r < march->scheme->table->nstate; r++)
    PetscCall(FillField(march, mode ? &profile : NULL, noise, r, id));
  if (noise > 0) PetscCall(Displace(march, noise, id));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  if (noise > 0) PetscCall(MpmMarchRebase(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- norms ---- */

/* The rest of way over a period, in [-period / 2, period / 2]. Most ways are there already, and remainder is slow. */
static PetscReal Shortest(PetscReal way, PetscInt period)
{
  return fabs(way) > period / 2.0 ? remainder(way, period) : way;
}

/* The ways of the particles from the uniform motion along each axis, in cells: the shortest ones in periodic directions. */
static PetscErrorCode Ways(const MpmMarch *march, const PetscInt64 id[], PetscReal *const way[])
{
  const MpmGrid   *grid = march->grid;
  const PetscInt  *cell[MPM_MAX_DIM];
  const PetscReal *xi[MPM_MAX_DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell[a]));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &xi[a]));
  }
  for (PetscInt p = 0; p < march->particles->count; p++) {
    PetscReal X[MPM_MAX_DIM];

    MpmLayoutRest(march->layout, id[p], X);
    for (PetscInt a = 0; a < grid->dim; a++) {
      const MpmDirection *direction = &march->layout->grid[a];
      const PetscReal     went      = march->velocity[a] * MpmMarchElapsed(march);
      const PetscReal     from_rest = (grid->axis[a].first + cell[a][p] - X[a]) + xi[a][p] - went;

      way[a][p] = direction->ends[0] == MPM_PERIODIC ? Shortest(from_rest, direction->cells) : from_rest;
    }
  }
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &xi[a]));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell[a]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The sum of n numbers over all ranks, and the sum of the squares of their differences from the mean, or from 0. */
static PetscErrorCode Squares(const MpmMarch *march, PetscInt64 n, const PetscReal q[], PetscBool about_mean,
                              PetscReal *sum)
{
  const MPI_Comm comm    = PetscObjectComm((PetscObject)march->grid->da);
  PetscReal      both[2] = {0, n}, all = 0, squares = 0, mean;

  PetscFunctionBegin;
#pragma omp simd reduction(+ : all)
  for (PetscInt64 p = 0; p < n; p++) all += q[p];
  both[0] = all;
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, both, 2, MPIU_REAL, MPI_SUM, comm));
  mean = about_mean && both[1] > 0 ? both[0] / both[1] : 0;
#pragma omp simd reduction(+ : squares)
  for (PetscInt64 p = 0; p < n; p++) squares += PetscSqr(q[p] - mean);
  *sum += squares;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The squares of what is left of a state register when its uniform value is taken out. */
static PetscErrorCode FieldSquares(const MpmMarch *march, PetscInt r, PetscReal left[], PetscReal *sum)
{
  const MpmTable  *t       = march->scheme->table;
  const PetscBool  stretch = t->field[r] == MPM_STRETCHED ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal  unit    = stretch ? UnitOf(march, t->component[r]) : 1;
  const PetscReal  start   = Start(march, NULL, r, NULL);
  const PetscReal *q;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, t->fields[r], &q));
  for (PetscInt p = 0; p < march->particles->count; p++) left[p] = (q[p] - start) / unit;
  PetscCall(MpmParticlesRestore(march->particles, t->fields[r], &q));
  PetscCall(Squares(march, march->particles->count, left, stretch ? PETSC_FALSE : PETSC_TRUE, sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The squares of a node register without its mean, at this rank's nodes. */
static PetscErrorCode NodeSquares(const MpmMarch *march, PetscInt node, PetscReal *sum)
{
  const MpmGrid   *grid = march->grid;
  const MpmGridBox box  = MpmGridBoxOf(grid, 0);
  PetscReal       *values, *f;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(MpmGridNodes(grid), &values));
  PetscCall(MpmGridGetArray(grid, march->node[node], &f));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++)
    PetscCall(PetscArraycpy(values + r * box.hi[0], f + MpmGridRow(grid, &box, r), box.hi[0]));
  PetscCall(MpmGridRestoreArray(grid, march->node[node], &f));
  PetscCall(Squares(march, MpmGridNodes(grid), values, PETSC_TRUE, sum));
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the squares of the node registers that particles are sent to. */
static PetscErrorCode SeenSquares(const MpmMarch *march, PetscReal *sum)
{
  const MpmTable *t                     = march->scheme->table;
  PetscBool       taken[MPM_MAX_FIELDS] = {PETSC_FALSE};

  PetscFunctionBegin;
  for (PetscInt o = 0; o < t->nops; o++) {
    const MpmOpTraits traits = MpmOpTraitsOf(t->ops[o].kind);

    if (traits.dst != MPM_ON_NODES || traits.src != MPM_ON_PARTICLES || taken[t->ops[o].dst]) continue;
    taken[t->ops[o].dst] = PETSC_TRUE;
    PetscCall(NodeSquares(march, t->ops[o].dst, sum));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds m v^2 / 2 of this rank's particles, and moment times that of an affine part, in units of rho0 c^2. */
static PetscErrorCode KineticEnergy(const MpmMarch *march, PetscReal moment, PetscReal *sum)
{
  const MpmTable  *t = march->scheme->table;
  const PetscReal *q, *mass;
  PetscReal        kinetic = 0;

  PetscFunctionBegin;
  PetscCall(MpmMarchGetProperty(march, MPM_MASS, &mass));
  for (PetscInt r = 0; r < t->nstate; r++) {
    const PetscReal part = t->field[r] == MPM_NONE ? moment : 1;

    if (t->field[r] == MPM_STRETCHED || part == 0) continue;
    kinetic = 0;
    PetscCall(MpmParticlesGet(march->particles, t->fields[r], &q));
#pragma omp simd reduction(+ : kinetic)
    for (PetscInt p = 0; p < march->particles->count; p++) kinetic += (mass ? mass[p] : 1) * q[p] * q[p] / 2;
    PetscCall(MpmParticlesRestore(march->particles, t->fields[r], &q));
    *sum += part * kinetic;
  }
  PetscCall(MpmMarchRestoreProperty(march, MPM_MASS, &mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the energy of this rank's particles in the gravity, in units of rho0 c^2. */
static PetscErrorCode GravityEnergy(const MpmMarch *march, PetscReal *sum)
{
  const MpmTable  *t = march->scheme->table;
  const PetscReal *q, *mass;
  const PetscInt  *cell;

  PetscFunctionBegin;
  PetscCall(MpmMarchGetProperty(march, MPM_MASS, &mass));
  for (PetscInt a = 0; a < t->dim && march->scene; a++) {
    const PetscReal gravity = march->scene->gravity[a] * march->cell_width / PetscSqr(march->scene->wave_speed);

    if (gravity == 0) continue;
    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &q));
    for (PetscInt p = 0; p < march->particles->count; p++)
      *sum -= (mass ? mass[p] : 1) * gravity * (march->grid->axis[a].first + cell[p] + q[p]);
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &q));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
  }
  PetscCall(MpmMarchRestoreProperty(march, MPM_MASS, &mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the energy of this rank's particles in colliders that push them, in units of rho0 c^2. */
static PetscErrorCode PushEnergy(const MpmMarch *march, PetscReal *sum)
{
  const MpmColliders *colliders = march->layout->colliders;
  const PetscInt      dim       = march->grid->dim;
  const PetscReal    *xi[MPM_MAX_DIM], *mass;
  const PetscInt     *cell[MPM_MAX_DIM];

  PetscFunctionBegin;
  if (!(MpmCollidersStiffness(colliders) > 0)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmMarchGetProperty(march, MPM_MASS, &mass));
  for (PetscInt a = 0; a < dim; a++) {
    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell[a]));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &xi[a]));
  }
  for (PetscInt p = 0; p < march->particles->count; p++) {
    PetscReal x[MPM_MAX_DIM];

    for (PetscInt a = 0; a < dim; a++) x[a] = march->grid->axis[a].first + cell[a][p] + xi[a][p];
    *sum += (mass ? mass[p] : 1) * MpmCollidersPush(colliders, dim, x, MpmMarchTime(march, march->step), NULL);
  }
  for (PetscInt a = 0; a < dim; a++) {
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &xi[a]));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell[a]));
  }
  PetscCall(MpmMarchRestoreProperty(march, MPM_MASS, &mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the strain energy of this rank's particles, in units of rho0 c^2. */
static PetscErrorCode StrainEnergy(const MpmMarch *march, PetscReal psi[], PetscReal *sum)
{
  const MpmTable  *t  = march->scheme->table;
  const PetscInt   dd = MpmTableStretches(t);
  const PetscReal *stiffness, *volume;
  PetscReal       *F[MPM_MOST_STRETCH], energy = 0;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < dd; c++) PetscCall(MpmParticlesGet(march->particles, t->fields[t->stretch + c], &F[c]));
  PetscCall(MpmMarchGetProperty(march, MPM_STIFFNESS, &stiffness));
  PetscCall(MpmMarchGetProperty(march, MPM_VOLUME, &volume));
  MpmMaterialEnergy(&t->material, t->dim, march->particles->count, (const PetscReal *const *)F, psi);
#pragma omp simd reduction(+ : energy)
  for (PetscInt p = 0; p < march->particles->count; p++)
    energy += (stiffness ? stiffness[p] : 1) * (volume ? volume[p] : 1) * psi[p];
  *sum += march->scheme->space.stiffness * energy;
  PetscCall(MpmMarchRestoreProperty(march, MPM_VOLUME, &volume));
  PetscCall(MpmMarchRestoreProperty(march, MPM_STIFFNESS, &stiffness));
  for (PetscInt c = 0; c < dd; c++) PetscCall(MpmParticlesRestore(march->particles, t->fields[t->stretch + c], &F[c]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The volume of a particle at rest, in the scene's unit. The cells are filled in the state that the scene starts from. */
static PetscReal VolumeAtRest(const MpmMarch *march)
{
  PetscReal volume = 1;

  for (PetscInt a = 0; a < march->grid->dim; a++)
    volume *= march->cell_width / (march->layout->ppc[a] * march->scheme->space.stretch[a]);
  return volume;
}

PetscErrorCode MpmFiniteEnergy(const MpmMarch *march, PetscReal psi[], PetscReal *energy)
{
  PetscFunctionBegin;
  *energy = 0;
  PetscCall(KineticEnergy(march, march->scheme->basis->moment, energy));
  PetscCall(StrainEnergy(march, psi, energy));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, energy, 1, MPIU_REAL, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteNorms(const MpmMarch *march, MpmNorms *norms)
{
  const PetscInt  count   = march->particles->count;
  const PetscReal speed   = march->scene ? march->scene->wave_speed : 1;
  PetscReal       sums[3] = {0, 0, 0}, *way[MPM_MAX_DIM];
  PetscInt64     *id;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < march->grid->dim; a++) PetscCall(PetscMalloc1(count, &way[a]));
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  PetscCall(Ways(march, id, way));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  for (PetscInt a = 0; a < march->grid->dim; a++) PetscCall(Squares(march, count, way[a], PETSC_TRUE, &sums[0]));
  /* the memory of the first way then serves for one number of each particle */
  for (PetscInt r = 0; r < march->scheme->table->nstate; r++) PetscCall(FieldSquares(march, r, way[0], &sums[0]));
  PetscCall(SeenSquares(march, &sums[2]));
  PetscCall(KineticEnergy(march, 0, &sums[1]));
  PetscCall(GravityEnergy(march, &sums[1]));
  PetscCall(PushEnergy(march, &sums[1]));
  PetscCall(StrainEnergy(march, way[0], &sums[1]));
  for (PetscInt a = 0; a < march->grid->dim; a++) PetscCall(PetscFree(way[a]));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  norms->state  = sqrt(sums[0] / (PetscReal)march->particles->total);
  norms->grid   = sqrt(sums[2] / (PetscReal)MpmLayoutNodes(march->layout));
  norms->energy = sums[1] * VolumeAtRest(march) * speed * speed;
  PetscFunctionReturn(PETSC_SUCCESS);
}
