/*
   A march at finite deformation: its operations on blocks of particles, which particle has failed, where it starts
   from, and the norms of its state.
*/
#include "march/finite.h"
#include "scene/material.h"
#include "scene/solution.h"
#include "scheme/deform.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

MpmFiniteWidth MpmFiniteWidthOf(MpmOpKind kind, PetscInt dim, PetscInt stretches)
{
  switch (kind) {
  case MPM_STRESS:
    return (MpmFiniteWidth){dim * (dim + 1) / 2, stretches, 0};
  case MPM_VISCOUS:
    return (MpmFiniteWidth){dim * (dim + 1) / 2, dim * dim, stretches};
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

/* A return mapping that does not converge leaves an internal variable that is no number (scheme/material/plastic.h). */
static void Return(const MpmMarch *march, const MpmFiniteBlock *block)
{
  const MpmTable *t   = march->scheme->table;
  const PetscInt  dim = march->grid->dim;

  MpmMaterialReturn(&t->material, dim, block->n, block->to);
  for (PetscInt c = dim * dim; c < MpmTableStretches(t); c++)
    for (PetscInt p = 0; p < block->n; p++)
      if (isnan(block->to[c][p])) Note(march, MPM_NOT_RETURNED, block, p);
}

/* The watch keeps the largest artificial viscosity, which bounds the next step. */
static void Viscous(const MpmMarch *march, const MpmFiniteBlock *block)
{
  const PetscReal found =
      MpmMaterialViscous(&march->scheme->table->material, block->a, march->grid->dim, block->n,
                         (const PetscReal *const *)block->from, (const PetscReal *const *)block->stretch,
                         (const PetscReal *[3]){block->mass, block->volume, block->stiffness}, block->to);

  march->watch->viscosity = PetscMax(march->watch->viscosity, found);
}

/* Sets what a block from begin on has besides the fields. */
static void Place(const MpmMarchArrays *a, MpmFiniteBlock *block)
{
  block->id = a->id + block->begin;
  for (PetscInt d = 0; d < a->march->grid->dim; d++) {
    block->cell[d] = a->cell[d] + block->begin;
    block->xi[d]   = a->xi[d] + block->begin;
  }
  if (a->weight[MPM_MASS]) block->mass = a->weight[MPM_MASS] + block->begin;
  if (a->weight[MPM_VOLUME]) block->volume = a->weight[MPM_VOLUME] + block->begin;
  if (a->weight[MPM_STIFFNESS]) block->stiffness = a->weight[MPM_STIFFNESS] + block->begin;
}

static void Run(const MpmMarch *march, MpmOpKind kind, const MpmFiniteBlock *block)
{
  const PetscInt          dim  = march->grid->dim;
  const PetscReal *const *from = (const PetscReal *const *)block->from;

  if (kind == MPM_STRESS)
    Stress(march, block);
  else if (kind == MPM_VISCOUS)
    Viscous(march, block);
  else if (kind == MPM_STRESS_AHEAD)
    march->solving->stress(march->solving->system, block);
  else if (kind == MPM_LOAD)
    Load(march, block);
  else if (kind == MPM_ADVANCE)
    Advance(march, block);
  else if (kind == MPM_RETURN)
    Return(march, block);
  else {
    const PetscInt bad = MpmStretch(dim, block->n, block->a, block->to, from);

    if (bad < block->n) Note(march, MPM_INVERTED, block, bad);
  }
}

void MpmMarchOnParticles(const MpmMarchArrays *a, const MpmOp *op, PetscInt begin, PetscInt n, PetscBool after)
{
  const MpmTable *table = a->march->scheme->table;
  const PetscInt  dst   = op->kind == MPM_ADVANCE ? op->src : op->dst;
  MpmFiniteWidth  width;
  MpmFiniteBlock  block = {.begin = begin, .n = n, .step = a->step + (after && !a->within), .a = op->factor};

  if (op->kind == MPM_DRIFT) return;
  if (op->kind == MPM_SCALE) {
    MpmScale(n, op->factor, MpmMarchRegister(a, op->dst, begin));
    return;
  }
  if (op->kind == MPM_ADD) {
    MpmNodeAdd(0, n, op->factor, MpmMarchRegister(a, op->src, begin), MpmMarchRegister(a, op->dst, begin));
    return;
  }
  width = MpmFiniteWidthOf(op->kind, table->dim, MpmTableStretches(table));
  for (PetscInt c = 0; c < width.to; c++) block.to[c] = MpmMarchRegister(a, dst + c, begin);
  for (PetscInt c = 0; c < width.from; c++) block.from[c] = MpmMarchRegister(a, op->src + c, begin);
  for (PetscInt c = 0; c < width.stretch; c++) block.stretch[c] = MpmMarchRegister(a, table->stretch + c, begin);
  Place(a, &block);
  Run(a->march, op->kind, &block);
}

void MpmFiniteForget(MpmMarch *march)
{
  march->watch->kind      = MPM_NO_FAILURE;
  march->watch->viscosity = 0;
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
  const MpmTable *t     = march->scheme->table;
  const MpmWatch *watch = march->watch;
  const PetscInt  dim = march->grid->dim, p = watch->particle;

  const MpmMaterialNumbers *material = &t->material;

  PetscReal   x[MPM_MAX_DIM], F[MPM_MAX_DIM * MPM_MAX_DIM], *values;
  PetscInt   *cell;
  PetscInt64 *id;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < dim; a++) {
    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &values));
    x[a] = march->cell_width * (march->grid->axis[a].first + cell[p] + values[p]);
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &values));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
  }
  for (PetscInt c = 0; c < dim * dim; c++) {
    const char *name = t->fields[t->stretch + c];

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
  if (material->several) { /* the last internal variable is the number of the material */
    PetscCall(MpmParticlesGet(march->particles, t->fields[t->stretch + MpmTableStretches(t) - 1], &values));
    material = &material->several->of[lrint(values[p])];
    PetscCall(MpmParticlesRestore(march->particles, t->fields[t->stretch + MpmTableStretches(t) - 1], &values));
  }
  if (watch->kind == MPM_INVERTED)
    (void)snprintf(text + strlen(text), room - strlen(text),
                   " has the volume det F = %.6g, which is not positive and finite", MpmDeterminant(dim, F));
  else if (watch->kind == MPM_NOT_RETURNED) {
    (void)snprintf(text + strlen(text), room - strlen(text), " does not come back to the yield surface of material %s",
                   material->law->name);
  } else {
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

/* ---- where a march starts from ---- */

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
    (void)MpmMaterialInternal(&t->material, dim, component - dim * dim, &value);
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

/* Whether a state register has the numbers of the particles' materials. */
static PetscBool IsNumber(const MpmTable *t, PetscInt r)
{
  return t->material.several && t->field[r] == MPM_STRETCHED && t->component[r] == MpmTableStretches(t) - 1
             ? PETSC_TRUE
             : PETSC_FALSE;
}

static PetscErrorCode FillField(MpmMarch *march, const MpmProfile *profile, PetscReal noise, PetscInt r,
                                const PetscInt64 id[])
{
  const MpmTable  *t        = march->scheme->table;
  const PetscBool  stretch  = t->field[r] == MPM_STRETCHED ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal  size     = noise * (stretch ? UnitOf(march, t->component[r]) : 1);
  const PetscBool  internal = stretch && t->component[r] >= t->dim * t->dim ? PETSC_TRUE : PETSC_FALSE;
  const PetscInt64 seed     = MpmParticlesSeed(march->layout->seed, r);
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
    if (IsNumber(t, r)) q[p] = given->material[id[p]];
    if (size > 0 && !internal) q[p] += size * (2 * MpmHash(seed, id[p]) - 1);
  }
  PetscCall(MpmParticlesRestore(march->particles, t->fields[r], &q));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Collective. Refuses a random start in which a particle failed, if any did: the least of the ranks' ids. */
static PetscErrorCode CheckNoise(const MpmMarch *march, PetscReal noise, PetscInt64 failed, const char does[],
                                 const char what[])
{
  PetscFunctionBegin;
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, &failed, 1, MPIU_INT64, MPI_MIN, PetscObjectComm((PetscObject)march->grid->da)));
  MpmCheckInput(failed == PETSC_MAX_INT,
                "amplitude %g: the random start %s particle %" PetscInt64_FMT "%s; allowed: a smaller one",
                (double)(march->scene ? march->scene->amplitude : noise), does, failed, what);
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
    const PetscInt64 seed =
        MpmParticlesSeed(march->layout->seed, march->scheme->table->nstate + a); /* after those of the state */
    PetscInt range[2] = {0, 0}, bad;

    PetscCall(MpmParticlesGet(march->particles, MpmFieldCell[a], &cell));
    PetscCall(MpmParticlesGet(march->particles, MpmFieldXi[a], &xi));
    for (PetscInt p = 0; p < march->particles->count; p++) way[p] = noise * (2 * MpmHash(seed, id[p]) - 1);
    bad = MpmAdvance(&march->layout->grid[a], grid->axis[a].first, march->particles->count, way, cell, xi, range);
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &xi));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &cell));
    if (bad < march->particles->count) failed = PetscMin(failed, id[bad]);
  }
  PetscCall(PetscFree(way));
  PetscCall(CheckNoise(march, noise, failed, "moves", " by a cell or more, or out of the domain"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses noise that turns a particle inside out before the first step. */
static PetscErrorCode CheckVolumes(MpmMarch *march, PetscReal noise, const PetscInt64 id[])
{
  const MpmTable *t      = march->scheme->table;
  const PetscInt  dim    = t->dim;
  PetscInt64      failed = PETSC_MAX_INT;
  PetscReal      *F[MPM_MAX_DIM * MPM_MAX_DIM];

  PetscFunctionBegin;
  for (PetscInt c = 0; c < dim * dim; c++)
    PetscCall(MpmParticlesGet(march->particles, t->fields[t->stretch + c], &F[c]));
  for (PetscInt p = 0; p < march->particles->count; p++) {
    PetscReal of[MPM_MAX_DIM * MPM_MAX_DIM];

    for (PetscInt c = 0; c < dim * dim; c++) of[c] = F[c][p];
    if (!(MpmDeterminant(dim, of) > 0)) failed = PetscMin(failed, id[p]);
  }
  for (PetscInt c = 0; c < dim * dim; c++)
    PetscCall(MpmParticlesRestore(march->particles, t->fields[t->stretch + c], &F[c]));
  PetscCall(CheckNoise(march, noise, failed, "turns", " inside out"));
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
  if (noise > 0) PetscCall(CheckVolumes(march, noise, id));
  if (noise > 0) PetscCall(Displace(march, noise, id));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  if (noise > 0) PetscCall(MpmMarchRebase(march));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the norms of the state ---- */

/* The rest of way over a period, in [-period / 2, period / 2]. Most ways are there already, and remainder is slow. */
static PetscReal Shortest(PetscReal way, PetscInt period)
{
  return fabs(way) > period / 2.0 ? remainder(way, period) : way;
}

/*
   The ways of the particles from the uniform motion along each axis, in cells: the shortest ones in periodic
   directions.
*/
static void Ways(const MpmMarchArrays *at, PetscReal *const way[])
{
  const MpmMarch *march = at->march;

  for (PetscInt p = 0; p < march->particles->count; p++) {
    PetscReal X[MPM_MAX_DIM];

    MpmLayoutRest(march->layout, at->id[p], X);
    for (PetscInt a = 0; a < march->grid->dim; a++) {
      const MpmDirection *direction = &march->layout->grid[a];
      const PetscReal     went      = march->velocity[a] * MpmMarchElapsed(march);
      const PetscReal     from_rest = (march->grid->axis[a].first + at->cell[a][p] - X[a]) + at->xi[a][p] - went;

      way[a][p] = direction->ends[0] == MPM_PERIODIC ? Shortest(from_rest, direction->cells) : from_rest;
    }
  }
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
static PetscErrorCode FieldSquares(const MpmMarchArrays *at, PetscInt r, PetscReal left[], PetscReal *sum)
{
  const MpmTable *t       = at->march->scheme->table;
  const PetscBool stretch = t->field[r] == MPM_STRETCHED ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal unit    = stretch ? UnitOf(at->march, t->component[r]) : 1;
  const PetscReal start   = Start(at->march, NULL, r, NULL);
  const PetscInt  count   = at->march->particles->count;

  PetscFunctionBegin;
  if (IsNumber(t, r)) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt p = 0; p < count; p++) left[p] = (at->particle[r][p] - start) / unit;
  PetscCall(Squares(at->march, count, left, stretch ? PETSC_FALSE : PETSC_TRUE, sum));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the squares of the node registers that particles are sent to, each without its mean, at this rank's nodes. */
static PetscErrorCode SeenSquares(const MpmMarchArrays *at, PetscReal *sum)
{
  const MpmMarch *march                 = at->march;
  const MpmTable *t                     = march->scheme->table;
  PetscBool       taken[MPM_MAX_FIELDS] = {PETSC_FALSE};
  PetscReal      *values;

  PetscFunctionBegin;
  PetscCall(PetscMalloc1(MpmGridNodes(march->grid), &values));
  for (const MpmOp *op = t->ops; op < t->ops + t->nops; op++) {
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

    if (traits.dst != MPM_ON_NODES || traits.src != MPM_ON_PARTICLES || taken[op->dst]) continue;
    taken[op->dst] = PETSC_TRUE;
    PetscCall(MpmGridCopy(march->grid, PETSC_TRUE, 1, values, at->node[op->dst]));
    PetscCall(Squares(march, MpmGridNodes(march->grid), values, PETSC_TRUE, sum));
  }
  PetscCall(PetscFree(values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds m v^2 / 2 of this rank's particles, and moment times that of an affine part, in units of rho0 c^2. */
static void KineticEnergy(const MpmMarchArrays *at, PetscReal moment, PetscReal *sum)
{
  const MpmTable  *t    = at->march->scheme->table;
  const PetscReal *mass = at->weight[MPM_MASS];

  for (PetscInt r = 0; r < t->nstate; r++) {
    const PetscReal part = t->field[r] == MPM_NONE ? moment : 1, *q = at->particle[r];
    PetscReal       kinetic = 0;

    if (t->field[r] == MPM_STRETCHED || part == 0) continue;
#pragma omp simd reduction(+ : kinetic)
    for (PetscInt p = 0; p < at->march->particles->count; p++) kinetic += (mass ? mass[p] : 1) * q[p] * q[p] / 2;
    *sum += part * kinetic;
  }
}

/* Adds the energy of this rank's particles in the gravity, in units of rho0 c^2. */
static void GravityEnergy(const MpmMarchArrays *at, PetscReal *sum)
{
  const MpmMarch  *march = at->march;
  const PetscReal *mass  = at->weight[MPM_MASS];

  for (PetscInt a = 0; a < march->grid->dim && march->scene; a++) {
    const PetscReal gravity = march->scene->gravity[a] * march->cell_width / PetscSqr(march->scene->wave_speed);

    for (PetscInt p = 0; p < march->particles->count && gravity != 0; p++)
      *sum -= (mass ? mass[p] : 1) * gravity * (march->grid->axis[a].first + at->cell[a][p] + at->xi[a][p]);
  }
}

/* Adds the energy of this rank's particles in colliders that push them, in units of rho0 c^2. */
static void PushEnergy(const MpmMarchArrays *at, PetscReal *sum)
{
  const MpmMarch     *march     = at->march;
  const MpmColliders *colliders = march->layout->colliders;
  const PetscReal    *mass      = at->weight[MPM_MASS];
  const PetscInt      dim       = march->grid->dim;

  for (PetscInt p = 0; p < march->particles->count && MpmCollidersStiffness(colliders) > 0; p++) {
    PetscReal x[MPM_MAX_DIM];

    for (PetscInt a = 0; a < dim; a++) x[a] = march->grid->axis[a].first + at->cell[a][p] + at->xi[a][p];
    *sum += (mass ? mass[p] : 1) * MpmCollidersPush(colliders, dim, x, MpmMarchTime(march, march->step), NULL);
  }
}

/* Adds the strain energy of this rank's particles, in units of rho0 c^2. */
static void StrainEnergy(const MpmMarchArrays *at, PetscReal psi[], PetscReal *sum)
{
  const MpmTable  *t         = at->march->scheme->table;
  const PetscReal *stiffness = at->weight[MPM_STIFFNESS], *volume = at->weight[MPM_VOLUME];
  const PetscInt   count  = at->march->particles->count;
  PetscReal        energy = 0;

  MpmMaterialEnergy(&t->material, t->dim, count, (const PetscReal *const *)at->particle + t->stretch, psi);
#pragma omp simd reduction(+ : energy)
  for (PetscInt p = 0; p < count; p++) energy += (stiffness ? stiffness[p] : 1) * (volume ? volume[p] : 1) * psi[p];
  *sum += at->march->scheme->space.stiffness * energy;
}

/*
   The volume of a particle at rest, in the scene's unit. The cells are filled in the state that the scene starts from.
*/
static PetscReal VolumeAtRest(const MpmMarch *march)
{
  PetscReal volume = 1;

  for (PetscInt a = 0; a < march->grid->dim; a++)
    volume *= march->cell_width / (march->layout->ppc[a] * march->scheme->space.stretch[a]);
  return volume;
}

PetscErrorCode MpmFiniteEnergy(const MpmMarch *march, PetscReal psi[], PetscReal *energy)
{
  MpmMarchArrays at = {.march = march};

  PetscFunctionBegin;
  *energy = 0;
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &at));
  KineticEnergy(&at, march->scheme->basis->moment, energy);
  StrainEnergy(&at, psi, energy);
  PetscCall(MpmMarchRestoreArrays(march, &at));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, energy, 1, MPIU_REAL, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFiniteNorms(const MpmMarch *march, MpmNorms *norms)
{
  const PetscInt  count   = march->particles->count;
  const PetscReal speed   = march->scene ? march->scene->wave_speed : 1;
  PetscReal       sums[3] = {0, 0, 0}, *way[MPM_MAX_DIM];
  MpmMarchArrays  at      = {.march = march};

  PetscFunctionBegin;
  for (PetscInt a = 0; a < march->grid->dim; a++) PetscCall(PetscMalloc1(count, &way[a]));
  PetscCall(MpmMarchGetArrays(march, march->particles->step, &at));
  Ways(&at, way);
  for (PetscInt a = 0; a < march->grid->dim; a++) PetscCall(Squares(march, count, way[a], PETSC_TRUE, &sums[0]));
  /* the memory of the first way then serves for one number of each particle */
  for (PetscInt r = 0; r < march->scheme->table->nstate; r++) PetscCall(FieldSquares(&at, r, way[0], &sums[0]));
  PetscCall(SeenSquares(&at, &sums[2]));
  KineticEnergy(&at, 0, &sums[1]);
  GravityEnergy(&at, &sums[1]);
  PushEnergy(&at, &sums[1]);
  StrainEnergy(&at, way[0], &sums[1]);
  PetscCall(MpmMarchRestoreArrays(march, &at));
  for (PetscInt a = 0; a < march->grid->dim; a++) PetscCall(PetscFree(way[a]));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, sums, 3, MPIU_REAL, MPI_SUM, PetscObjectComm((PetscObject)march->grid->da)));
  norms->state  = sqrt(sums[0] / (PetscReal)march->particles->total);
  norms->grid   = sqrt(sums[2] / (PetscReal)MpmLayoutNodes(march->layout));
  norms->energy = sums[1] * VolumeAtRest(march) * speed * speed;
  PetscFunctionReturn(PETSC_SUCCESS);
}
