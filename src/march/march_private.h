/* March: the explicit loop, as its own files and those that read its state know it. */
#pragma once
#include "base/float_check.h"
#include "march/grid.h"
#include "march/nodal_solve.h"
#include "march/particles.h"
#include "march/passes.h"
#include <mpmstab/march.h>

/*S
   MpmMarch_ - a scene in motion.

   The state is particle fields times 2^exponent: an unstable run is rescaled by powers of two, which changes
   no digit, so that it can be followed for any number of steps.
*/
struct MpmMarch_ {
  const MpmScene *scene;
  MpmGrid        *grid;
  MpmParticles   *particles;
  MpmSchedule     schedule;
  PetscInt        nnodes, slack;
  Vec             node[MPM_MAX_FIELDS], spare[MPM_MAX_FIELDS], inverse_mass; /* local vectors */
  MpmNodalSolve  *nodal_solve;                                               /* NULL: the table has no SOLVE */
  PetscInt64      step, migrations;
  PetscInt        exponent;
  PetscReal       squares[MPM_MAX_FIELDS]; /* this rank's sums of squares at the last sampled step */
  PetscLogEvent   pass_event, sum_event, migrate_event;
  MpmFloatCheck   float_check;
};

/* Not collective. The least number of bytes that particles and nodes of a march take, and its output if it has one, on all ranks together. */
PetscReal MpmMarchBytes(const MpmScene *scene, PetscBool output);

/*
   Collective. Sums the particles' fields to the nodes as a step finds them; to be called when the fields were changed
   before the first step.
*/
PetscErrorCode MpmMarchStart(MpmMarch *march);

/* Collective. Random particle fields in [-amplitude, amplitude], from the scene's seed, before the first step. */
PetscErrorCode MpmMarchFillRandom(MpmMarch *march, PetscReal amplitude);

/*
   Collective. A pass and those joined to it, with halo sums and the last one's node operations. The
   particles' step moves on with DRIFT; migration is the caller's.
*/
PetscErrorCode MpmMarchRunPasses(MpmMarch *march, PetscInt n, const MpmPass passes[], PetscBool sample);

/* Not collective. Divides the state by 2^shift and adds shift to the exponent. */
PetscErrorCode MpmMarchRescale(MpmMarch *march, PetscInt shift);

/* Collective. P2G of one particle field at the current places into a local vector, ghosts included. */
PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, Vec node);

/*
   Collective. The same where the particles will be after the next DRIFT, while they stay; inverse_mass, a local vector,
   becomes that of the nodes there. Under drift there must be slack in the ghost layer.
*/
PetscErrorCode MpmMarchProjectNext(MpmMarch *march, PetscInt field, Vec inverse_mass, Vec node);
