/* Runs the operations of finite deformation on blocks of particles, and tells which particle has failed. */
#include "march/finite.h"
#include "scheme/deform.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

MpmFiniteWidth MpmFiniteWidthOf(MpmOpKind kind, PetscInt dim, PetscInt stretches)
{
  switch (kind) {
  case MPM_STRESS:
    return (MpmFiniteWidth){dim * (dim + 1) / 2, stretches, 0};
  case MPM_RETURN:
    return (MpmFiniteWidth){stretches, 0, 0};
  case MPM_STRETCH:
    return (MpmFiniteWidth){dim * dim, dim * dim, 0};
  case MPM_STRESS_AHEAD:
    return (MpmFiniteWidth){dim * dim, dim * dim, dim * dim};
  default:
    return (MpmFiniteWidth){dim, 0, 0};
  }
}

/* Notes that particle p of a block has failed, unless another one has before. */
static void Note(const MpmMarch *march, MpmFailureKind kind, const MpmFiniteBlock *block, PetscInt p)
{
  MpmWatch *watch = march->watch;

  if (watch->kind != MPM_NO_FAILURE) return;
  watch->kind     = kind;
  watch->particle = block->begin + p;
  for (PetscInt a = 0; a < march->grid->dim && kind == MPM_TOO_FAST; a++) watch->way[a] = block->to[a][p];
}

static void Advance(const MpmMarch *march, const MpmFiniteBlock *block)
{
  const MpmGrid *grid = march->grid;

  for (PetscInt a = 0; a < grid->dim; a++) {
    const PetscInt bad = MpmAdvance(&march->layout->grid[a], grid->axis[a].first, block->n, block->to[a],
                                    block->cell[a], block->xi[a], march->watch->range[a]);

    if (bad < block->n) Note(march, MPM_TOO_FAST, block, bad);
  }
}

void MpmFiniteLoad(const MpmMarch *march, PetscInt64 id, PetscInt64 step, PetscReal part, PetscReal load[])
{
  const MpmScene *scene = march->scene;
  const PetscReal unit  = scene->cell_width / (scene->wave_speed * scene->wave_speed);
  PetscReal       X[MPM_MAX_DIM], force[MPM_MAX_DIM] = {0};

  if (scene->body_force) {
    MpmParticlesLagrangian(march->particles, id, march->cell_width, X);
    scene->body_force(scene, X, MpmMarchTime(march, step) + part * MpmSceneTimeStep(scene, march->courant), force);
  }
  for (PetscInt a = 0; a < march->grid->dim; a++) load[a] = unit * (scene->gravity[a] + force[a]);
}

/* Adds what colliders of contact penalty give particle p. */
static void Push(const MpmMarch *march, const MpmFiniteBlock *block, PetscInt p, PetscReal load[])
{
  PetscReal x[MPM_MAX_DIM];

  for (PetscInt a = 0; a < march->grid->dim; a++)
    x[a] = march->grid->axis[a].first + block->cell[a][p] + block->xi[a][p];
  (void)MpmCollidersPush(march->layout->colliders, march->grid->dim, x, MpmMarchTime(march, block->step), load);
}

/* Tables of marches without a scene have no LOAD. */
static void Load(const MpmMarch *march, const MpmFiniteBlock *block)
{
  const PetscBool pushes = MpmCollidersStiffness(march->layout->colliders) > 0 ? PETSC_TRUE : PETSC_FALSE;
  PetscReal       load[MPM_MAX_DIM];

  for (PetscInt p = 0; p < block->n; p++) {
    if (march->solving && march->solving->product)
      load[0] = load[1] = load[2] = 0;
    else if (p == 0 || march->scene->body_force || pushes)
      MpmFiniteLoad(march, block->id[p], block->step, block->a, load);
    if (pushes) Push(march, block, p, load);
    for (PetscInt a = 0; a < march->grid->dim; a++) block->to[a][p] = load[a];
  }
}

/* A material whose stiffness differs from particle to particle has so much of the stress. */
static void Stress(const MpmMarch *march, const MpmFiniteBlock *block)
{
  const PetscInt dim = march->grid->dim;

  MpmMaterialStress(&march->scheme->table->material, dim, block->n, (const PetscReal *const *)block->from, block->to);
  for (PetscInt c = 0; c < dim * (dim + 1) / 2 && block->stiffness; c++)
    for (PetscInt p = 0; p < block->n; p++) block->to[c][p] *= block->stiffness[p];
}

void MpmFinitePlace(const MpmMarchArrays *a, MpmFiniteBlock *block)
{
  block->id = a->id + block->begin;
  for (PetscInt d = 0; d < a->march->grid->dim; d++) {
    block->cell[d] = a->cell[d] + block->begin;
    block->xi[d]   = a->xi[d] + block->begin;
  }
  if (a->weight[MPM_STIFFNESS]) block->stiffness = a->weight[MPM_STIFFNESS] + block->begin;
}

void MpmFiniteRun(const MpmMarch *march, MpmOpKind kind, const MpmFiniteBlock *block)
{
  const PetscInt          dim  = march->grid->dim;
  const PetscReal *const *from = (const PetscReal *const *)block->from;

  if (kind == MPM_STRESS)
    Stress(march, block);
  else if (kind == MPM_STRESS_AHEAD)
    march->solving->stress(march->solving->system, block);
  else if (kind == MPM_LOAD)
    Load(march, block);
  else if (kind == MPM_ADVANCE)
    Advance(march, block);
  else if (kind == MPM_RETURN)
    MpmMaterialReturn(&march->scheme->table->material, dim, block->n, block->to);
  else {
    const PetscInt bad = MpmStretch(dim, block->n, block->a, block->to, from);

    if (bad < block->n) Note(march, MPM_INVERTED, block, bad);
  }
}

void MpmFiniteForget(MpmMarch *march)
{
  march->watch->kind = MPM_NO_FAILURE;
  for (PetscInt a = 0; a < march->grid->dim; a++) {
    march->watch->range[a][0] = march->grid->axis[a].count;
    march->watch->range[a][1] = -1;
  }
}

/* Numbers with commas between them, as a message has them. */
static void Append(size_t room, char text[], PetscInt n, const PetscReal number[])
{
  for (PetscInt i = 0; i < n; i++) {
    const size_t used = strlen(text);

    (void)snprintf(text + used, room - used, "%s%.6g", i ? "," : "", number[i]);
  }
}

/* What the rank of the failed particle says: which particle it is, where it is, and how it is stretched. */
static PetscErrorCode Describe(const MpmMarch *march, size_t room, char text[])
{
  const MpmWatch *watch = march->watch;
  const PetscInt  dim = march->grid->dim, p = watch->particle;
  PetscReal       x[MPM_MAX_DIM], F[MPM_MAX_DIM * MPM_MAX_DIM], *values;
  PetscInt       *cell;
  PetscInt64     *id;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++) {
    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &values));
    x[a] = march->cell_width * (march->grid->axis[a].first + cell[p] + values[p]);
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &values));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
  }
  for (PetscInt c = 0; c < dim * dim; c++) {
    const char *name = march->scheme->table->fields[march->scheme->table->stretch + c];

    PetscCall(MpmParticlesGet(march->particles, name, &values));
    F[c] = values[p];
    PetscCall(MpmParticlesRestore(march->particles, name, &values));
  }
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  (void)snprintf(text, room, "step %" PetscInt64_FMT ": particle %" PetscInt64_FMT " at x = ", march->step + 1, id[p]);
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  Append(room, text, dim, x);
  (void)snprintf(text + strlen(text), room - strlen(text), " with the stretch F = ");
  Append(room, text, dim * dim, F);
  if (watch->kind == MPM_INVERTED)
    (void)snprintf(text + strlen(text), room - strlen(text),
                   " has the volume det F = %.6g, which is not positive and finite", MpmDeterminant(dim, F));
  else {
    (void)snprintf(text + strlen(text), room - strlen(text), " would move by ");
    Append(room, text, dim, watch->way);
    (void)snprintf(text + strlen(text), room - strlen(text),
                   " cells in this step: a cell or more, or out of the domain");
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteAgree(MpmMarch *march, PetscInt *beyond)
{
  const MPI_Comm comm   = PetscObjectComm((PetscObject)march->grid->da);
  PetscInt64     all[2] = {0, PETSC_MAX_INT};
  PetscMPIInt    rank, owner;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < march->grid->dim; a++) {
    all[0] = PetscMax(all[0], -march->watch->range[a][0]);
    all[0] = PetscMax(all[0], march->watch->range[a][1] - march->grid->axis[a].count + 1);
  }
  PetscCallMPI(MPI_Comm_rank(comm, &rank));
  if (march->watch->kind != MPM_NO_FAILURE) all[1] = rank;
  all[0] = -all[0];
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, all, 2, MPIU_INT64, MPI_MIN, comm));
  *beyond = (PetscInt)-all[0];
  if (all[1] == PETSC_MAX_INT) PetscFunctionReturn(PETSC_SUCCESS);
  owner = (PetscMPIInt)all[1];
  if (rank == owner) PetscCall(Describe(march, sizeof march->failure, march->failure));
  PetscCallMPI(MPI_Bcast(march->failure, sizeof march->failure, MPI_CHAR, owner, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}
