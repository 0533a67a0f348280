/* Particles in a DMSwarm of type BASIC, with own places and owners: DMSWARM_PIC does not support one dimension. */
#include "base/large_pages.h"
#include "march/particles.h"
#include <math.h>

const char *const MpmFieldCell[] = {"cell", "cell_y", "cell_z"}, *const MpmFieldXi[] = {"xi", "xi_y", "xi_z"};

PetscErrorCode MpmParticlesWhere(const MpmParticles *particles, PetscInt axis, PetscInt64 step, PetscInt *whole,
                                 PetscReal *part)
{
  PetscInt64 cells;

  PetscFunctionBegin;
  MpmFractionMultiple(&particles->drift[axis], step, &cells, part);
  *whole = (PetscInt)(cells - particles->rebased[axis]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesGet(const MpmParticles *particles, const char name[], void *array)
{
  PetscFunctionBegin;
  PetscCall(DMSwarmGetField(particles->swarm, name, NULL, NULL, (void **)array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesRestore(const MpmParticles *particles, const char name[], void *array)
{
  PetscFunctionBegin;
  PetscCall(DMSwarmRestoreField(particles->swarm, name, NULL, NULL, (void **)array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CreateSwarm(const MpmGrid *grid, MpmParticles *particles)
{
  PetscMPIInt size;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)grid->da), &size));
  particles->parallel = size > 1 ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(DMCreate(PetscObjectComm((PetscObject)grid->da), &particles->swarm));
  PetscCall(DMSetType(particles->swarm, DMSWARM));
  PetscCall(DMSetDimension(particles->swarm, grid->dim));
  PetscCall(DMSwarmSetType(particles->swarm, DMSWARM_BASIC));
  PetscCall(DMSwarmInitializeFieldRegister(particles->swarm));
  for (PetscInt a = 0; a < grid->dim; a++) {
    PetscCall(DMSwarmRegisterPetscDatatypeField(particles->swarm, MpmFieldCell[a], 1, PETSC_INT));
    PetscCall(DMSwarmRegisterPetscDatatypeField(particles->swarm, MpmFieldXi[a], 1, PETSC_REAL));
  }
  for (PetscInt f = 0; f < MpmTableHeld(particles->table); f++)
    PetscCall(DMSwarmRegisterPetscDatatypeField(particles->swarm, particles->table->names[f], 1, PETSC_REAL));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (particles->layout->varies[w])
      PetscCall(DMSwarmRegisterPetscDatatypeField(particles->swarm, MpmPropertyNames[w], 1, PETSC_REAL));
  PetscCall(DMSwarmFinalizeFieldRegister(particles->swarm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscInt MpmParticlesRoom(const MpmParticles *particles)
{
  return particles->parallel ? particles->count / 64 + 256 : 0;
}

/* A seed for each field, so that random fields are independent. */
static PetscInt64 FieldSeed(PetscInt64 seed, PetscInt field)
{
  return (PetscInt64)(0x1p52 * MpmHash(seed + 1, -2 - field));
}

PetscErrorCode MpmParticlesFillRandom(PetscInt64 seed, PetscReal amplitude, MpmParticles *particles)
{
  const PetscInt64 *id;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt f = 0; particles->table->fields[f]; f++) {
    const PetscInt64 of_field = FieldSeed(seed, f);
    PetscReal       *q;

    PetscCall(MpmParticlesGet(particles, particles->table->fields[f], &q));
    for (PetscInt p = 0; p < particles->count; p++) q[p] = amplitude * (2 * MpmHash(of_field, id[p]) - 1);
    PetscCall(MpmParticlesRestore(particles, particles->table->fields[f], &q));
  }
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets the fields to the exact solution at the start; a staggered field starts half a step earlier. */
static PetscErrorCode FillExact(const MpmScene *scene, PetscReal amplitude, MpmParticles *particles)
{
  const MpmProfile  profile = MpmSceneProfile(scene, amplitude);
  const PetscInt64 *id;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt f = 0; particles->table->fields[f]; f++) {
    PetscReal *q;

    PetscCall(MpmParticlesGet(particles, particles->table->fields[f], &q));
    for (PetscInt p = 0; p < particles->count; p++) {
      PetscReal X[MPM_MAX_DIM];

      MpmParticlesLagrangian(particles, id[p], scene->cell_width, X);
      q[p] = MpmSceneExact(scene, &profile, f, X, 0);
    }
    PetscCall(MpmParticlesRestore(particles, particles->table->fields[f], &q));
  }
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles that are held start at rest: what they get by G2P is 0. */
static PetscErrorCode Hold(MpmParticles *particles)
{
  const MpmTable  *table = particles->table;
  const PetscReal *mobility;
  PetscReal       *q;

  PetscFunctionBegin;
  if (!particles->layout->varies[MPM_MOBILITY]) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmParticlesGet(particles, MpmPropertyNames[MPM_MOBILITY], &mobility));
  for (PetscInt o = 0; o < table->nops; o++) {
    if (MpmOpTraitsOf(table->ops[o].kind).weight != MPM_MOBILITY || table->ops[o].dst >= table->nstate) continue;
    PetscCall(MpmParticlesGet(particles, table->fields[table->ops[o].dst], &q));
    for (PetscInt p = 0; p < particles->count; p++) q[p] *= mobility[p];
    PetscCall(MpmParticlesRestore(particles, table->fields[table->ops[o].dst], &q));
  }
  PetscCall(MpmParticlesRestore(particles, MpmPropertyNames[MPM_MOBILITY], &mobility));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesFill(const MpmScene *scene, PetscInt exponent, MpmParticles *particles)
{
  const PetscReal amplitude = scalbn(scene->amplitude, -(int)exponent);

  PetscFunctionBegin;
  if (scene->initial == MPM_INITIAL_RANDOM)
    PetscCall(MpmParticlesFillRandom(particles->layout->seed, amplitude, particles));
  else if (scene->initial != MPM_INITIAL_EIGENMODE)
    PetscCall(FillExact(scene, amplitude, particles));
  PetscCall(Hold(particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesWeigh(MpmParticles *particles)
{
  const PetscInt64 *id;
  PetscReal        *weight;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, DMSwarmField_pid, &id));
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++) {
    if (!particles->layout->varies[w]) continue;
    PetscCall(MpmParticlesGet(particles, MpmPropertyNames[w], &weight));
    for (PetscInt p = 0; p < particles->count; p++)
      weight[p] = MpmMaterialProperty(particles->layout, (MpmProperty)w, id[p]);
    PetscCall(MpmParticlesRestore(particles, MpmPropertyNames[w], &weight));
  }
  PetscCall(MpmParticlesRestore(particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Every pass goes through all of these arrays. */
static PetscErrorCode UseLargePages(MpmParticles *particles)
{
  const char *name[2 * MPM_MAX_DIM + MPM_MAX_FIELDS + MPM_PROPERTIES];
  PetscInt    n = 0;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < particles->layout->dim; a++) {
    name[n++] = MpmFieldCell[a];
    name[n++] = MpmFieldXi[a];
  }
  for (PetscInt f = 0; f < MpmTableHeld(particles->table); f++) name[n++] = particles->table->names[f];
  for (PetscInt w = 0; w < MPM_PROPERTIES; w++)
    if (particles->layout->varies[w]) name[n++] = MpmPropertyNames[w];
  for (PetscInt i = 0; i < n; i++) {
    PetscDataType type;
    size_t        size;
    void         *array;

    PetscCall(DMSwarmGetField(particles->swarm, name[i], NULL, &type, &array));
    PetscCall(PetscDataTypeGetSize(type, &size));
    MpmLargePages(array, size * (size_t)particles->count);
    PetscCall(DMSwarmRestoreField(particles->swarm, name[i], NULL, &type, &array));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesCreate(const MpmLayout *layout, const MpmTable *table, const MpmFraction *drift,
                                  const MpmGrid *grid, MpmParticles **particles)
{
  PetscInt size;

  PetscFunctionBegin;
  PetscCall(PetscNew(particles));
  (*particles)->layout = layout;
  (*particles)->table  = table;
  (*particles)->total  = layout->particles;
  (*particles)->own    = MpmTableIsFinite(table);
  if (!(*particles)->own) PetscCall(PetscArraycpy((*particles)->drift, drift, MPM_MAX_DIM));
  PetscCall(CreateSwarm(grid, *particles));
  PetscCall(MpmParticlesPlace(grid, *particles));
  PetscCall(DMSwarmGetSize((*particles)->swarm, &size));
  PetscCheck(size == (*particles)->total, PetscObjectComm((PetscObject)grid->da), PETSC_ERR_PLIB,
             "%" PetscInt_FMT " particles placed of %" PetscInt64_FMT, size, (*particles)->total);
  PetscCall(UseLargePages(*particles));
  PetscCall(MpmParticlesWeigh(*particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmParticlesDestroy(MpmParticles **particles)
{
  PetscFunctionBegin;
  PetscCall(DMDestroy(&(*particles)->swarm));
  PetscCall(PetscFree(*particles));
  PetscFunctionReturn(PETSC_SUCCESS);
}
