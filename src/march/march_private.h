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
  const MpmScene  *scene; /* units, exact solution and output; NULL: random data, which have none of these */
  const MpmLayout *layout;
  const MpmScheme *scheme;
  PetscReal        cell_width; /* 1 without a scene */
  MpmGrid         *grid;
  MpmParticles    *particles;
  MpmSchedule      schedule;
  PetscInt         nnodes, slack;
  Vec              node[MPM_MAX_FIELDS], spare[MPM_MAX_FIELDS], inverse_mass; /* local vectors */
  MpmNodalSolve   *nodal_solve;                                               /* NULL: the table has no SOLVE */
  PetscInt64       step, migrations;
  PetscInt         exponent;
  PetscReal       *scratch;                 /* MPM_BLOCK numbers for each scratch register of the particles */
  PetscReal        squares[MPM_MAX_FIELDS]; /* this rank's sums of squares at the last sampled step */
  PetscLogEvent    pass_event, sum_event, migrate_event;
  MpmFloatCheck    float_check;
};

/* Not collective. The least number of bytes that particles, nodes and output of a march take, on all ranks together. */
PetscReal MpmMarchBytes(const MpmScene *scene);

/* Not collective. Whether the particles move against the grid. */
static inline PetscBool MpmMarchDrifts(const MpmMarch *march)
{
  return march->particles->drift.value != 0 ? PETSC_TRUE : PETSC_FALSE;
}

/*
   MpmMarchCreateRandom - a march without a scene: every particle field starts with random numbers in
   [-amplitude, amplitude), hashed from the layout's seed.

   Collective. layout and scheme must outlive the march. There is no exact solution to compare with, and a cell's width
   is 1.
*/
PetscErrorCode MpmMarchCreateRandom(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme,
                                    const MpmStep *step, PetscReal amplitude, MpmMarch **march);

/*S
   MpmNodeVectors - the node fields that passes sum to and read: local vectors, n of them. spare[f] is the second array
   of a field that is summed while it is read, or NULL. antisymmetric says for each field whether it is 0 at fixed ends.
   inverse_mass is set by a pass that sums masses, and read by others.
S*/
typedef struct {
  PetscInt         n;
  Vec             *node, *spare, inverse_mass;
  const PetscBool *antisymmetric;
} MpmNodeVectors;

/*
   MpmMarchRunPasses - a pass and those joined to it, with halo sums and the last one's node operations.

   Collective. The particles' step moves on with DRIFT; migration is the caller's. MpmMarchRunPassesOn does the same on
   any node fields, with particles at the places of any step, which it moves on.
*/
PetscErrorCode MpmMarchRunPasses(MpmMarch *march, PetscInt n, const MpmPass passes[], PetscBool sample);
PetscErrorCode MpmMarchRunPassesOn(MpmMarch *march, const MpmNodeVectors *nodes, PetscInt64 *step, PetscInt n,
                                   const MpmPass passes[], PetscBool sample);

/* Not collective. Divides the state by 2^shift and adds shift to the exponent. */
PetscErrorCode MpmMarchRescale(MpmMarch *march, PetscInt shift);

/* Collective. P2G of one particle field at the current places into a local vector, ghosts included. */
PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, Vec node);

/*
   Collective. The same where the particles will be after the next DRIFT, while they stay; inverse_mass, a local vector,
   becomes that of the nodes there. Under drift there must be slack in the ghost layer.
*/
PetscErrorCode MpmMarchProjectNext(MpmMarch *march, PetscInt field, Vec inverse_mass, Vec node);
