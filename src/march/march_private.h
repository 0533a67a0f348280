/* The march as its own files see it, and those that read its state. */
#pragma once
#include "base/float_check.h"
#include "march/grid.h"
#include "march/nodal_solve.h"
#include "march/particles.h"
#include "march/passes.h"
#include <mpmstab/march.h>

typedef struct MpmRowPlan_       MpmRowPlan;       /* a pass compiled for more than one dimension (march/rows.h) */
typedef struct MpmImplicitSolve_ MpmImplicitSolve; /* march/implicit_solve.h */
typedef struct MpmWatch_ MpmWatch; /* what passes find out about particles that move each by itself (march/finite.h) */
typedef struct MpmRelax_ MpmRelax; /* the increments of a step (march/relax.h) */
typedef struct MpmCloudPlan_ MpmCloudPlan; /* and for particles that share no coordinate (march/clouds.h) */

/*
   A row: the particles from begin on, up to where the next row begins, lie on a line along x. alike: they rest as those
   of the row before do, but for whole cells along x.
*/
typedef struct {
  PetscInt  begin;
  PetscBool alike;
} MpmRow;

/*S
   MpmMarch_ - the state of a run.

   The state is the particle fields times 2^exponent. An unstable run is divided by powers of two, which changes no
   digit, so that it can be followed for any number of steps.
S*/
struct MpmMarch_ {
  const MpmScene   *scene; /* units, exact solution and output; NULL: random data, which have none of these */
  const MpmLayout  *layout;
  const MpmScheme  *scheme;
  PetscReal         cell_width;                     /* 1 without a scene */
  PetscReal         courant, velocity[MPM_MAX_DIM]; /* at finite deformation: of a step, and of the start over c */
  PetscReal         elapsed;                        /* where steps differ: the sum of their Courant numbers */
  MpmGrid          *grid;
  MpmParticles     *particles;
  MpmSchedule       schedule;
  MpmRowPlan       *plans;  /* in more than one dimension: of the passes, and of the start after them */
  MpmRow           *row;    /* the rows of the particles, and where the last one ends; nrows are there */
  MpmCloudPlan     *clouds; /* the same where particles share no coordinate, or NULL; bundles: memory for them */
  PetscReal        *bundles;
  PetscInt          nnodes, slack, nrows;
  PetscInt          fullest; /* the largest number of particles that this rank has had */
  Vec               node[MPM_MAX_FIELDS], spare[MPM_MAX_FIELDS], inverse_mass; /* local vectors */
  MpmNodalSolve    *nodal_solve;                                               /* NULL: the table has no SOLVE */
  MpmImplicitSolve *implicit[MPM_MAX_STIFF]; /* of the tables of K that the table has */
  PetscInt64        step, migrations;
  PetscInt          exponent;
  MpmWatch         *watch;                   /* NULL where particles do not move each by itself */
  MpmRelax         *relax;                   /* NULL where steps are not relaxed */
  char              failure[512];            /* what has happened to a particle, or to a solve; empty: nothing */
  PetscReal        *scratch;                 /* MPM_BLOCK numbers for each scratch register of the particles */
  PetscReal         squares[MPM_MAX_FIELDS]; /* this rank's sums of squares at the last sampled step */
  PetscLogEvent     pass_event, sum_event, migrate_event;
  MpmFloatCheck     float_check;
};

/*
   Not collective. A lower bound of the bytes that the particles and nodes of a march take on all ranks together. With
   output it includes those of the run's output.
*/
PetscReal MpmMarchBytes(const MpmScene *scene, PetscBool output);

/* Collective. The largest number of particles that a rank has had, over the mean. */
PetscErrorCode MpmMarchLoad(const MpmMarch *march, PetscReal *load);

/* Collective. Sets the particle fields to random numbers in [-amplitude, amplitude) and sums them to the nodes. */
PetscErrorCode MpmMarchFillRandom(MpmMarch *march, PetscReal amplitude);

/* Not collective. Whether steps differ, because the run chooses them (analysis/pace.h). */
static inline PetscBool MpmMarchIsPaced(const MpmMarch *march)
{
  return march->scene && march->scene->safety > 0 ? PETSC_TRUE : PETSC_FALSE;
}

/* Not collective. The time of the march in units of h / c. */
static inline PetscReal MpmMarchElapsed(const MpmMarch *march)
{
  return MpmMarchIsPaced(march) ? march->elapsed : march->courant * (PetscReal)march->step;
}

/* Not collective. The time of a step in the scene's unit. Where steps differ it is the last one or the next. */
static inline PetscReal MpmMarchTime(const MpmMarch *march, PetscInt64 step)
{
  const MpmScene *scene = march->scene;

  if (!MpmMarchIsPaced(march)) return (PetscReal)step * scene->dt;
  return MpmSceneTimeStep(scene, march->elapsed + (PetscReal)(step - march->step) * march->courant);
}

/*
   MpmMarchSetCourant - sets the Courant number of the next steps, of a march whose steps differ. What nodes hold is still that of
   the step before; the pass before the first step, schedule.start, renews it.

   Not collective.
*/
PetscErrorCode MpmMarchSetCourant(MpmMarch *march, PetscReal courant);

/* Not collective. Whether particles move relative to the grid. */
static inline PetscBool MpmMarchDrifts(const MpmMarch *march)
{
  return MpmParticlesMove(march->particles);
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
   MpmNodeVectors - the node fields that passes sum to and read, as n local vectors.

   spare         - spare[f]: a second array for a field that is summed while it is read, or NULL
   parity        - parity[f]: what the field is beyond the ends of each direction
   inverse_mass  - passes that sum masses set it, and others read it
S*/
typedef struct {
  PetscInt n;
  Vec     *node, *spare, inverse_mass;
  const MpmParity (*parity)[MPM_MAX_DIM];
} MpmNodeVectors;

/*
   MpmMarchRunPasses - runs n passes, of which the others are joined to the first, with halo sums and the node
   operations of the last.

   Collective. DRIFT moves the step of the particles on. The caller migrates particles. MpmMarchRunPassesOn does the
   same on any node fields, with particles at the places of any step, which it moves on.
*/
PetscErrorCode MpmMarchRunPasses(MpmMarch *march, PetscInt n, const MpmPass passes[], PetscBool sample);
PetscErrorCode MpmMarchRunPassesOn(MpmMarch *march, const MpmNodeVectors *nodes, PetscInt64 *step, PetscInt n,
                                   const MpmPass passes[], PetscBool sample);

/* Collective. As MpmMarchRunPassesOn, for one pass in two or three dimensions. */
PetscErrorCode MpmMarchRunRows(MpmMarch *march, const MpmNodeVectors *nodes, PetscInt64 *step, const MpmPass *pass,
                               PetscBool sample);

/* Not collective. The passes that have plans: those of the schedule, its start, and that of each solve. NULL after the last. */
const MpmPass *MpmMarchPass(const MpmMarch *march, PetscInt number);

/* Not collective. Finds the rows of the particles, if passes go through rows. It is called when places have changed. */
PetscErrorCode MpmRowsFind(MpmMarch *march);

/* Not collective. Divides the state by 2^shift and adds shift to the exponent. */
PetscErrorCode MpmMarchRescale(MpmMarch *march, PetscInt shift);

/* Not collective. The array of a property of this rank's particles where it varies, else NULL; and its return. */
PetscErrorCode MpmMarchGetProperty(const MpmMarch *march, MpmProperty property, const PetscReal **values);
PetscErrorCode MpmMarchRestoreProperty(const MpmMarch *march, MpmProperty property, const PetscReal **values);

/* Collective. P2G of one particle field at the present places, into a local vector with its ghosts. */
PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, Vec node);

/*
   Collective. P2G of one particle field at the places after the next DRIFT, while the particles stay. Sets
   inverse_mass, a local vector, for these places. Under drift, the ghost layer must have slack.
*/
PetscErrorCode MpmMarchProjectNext(MpmMarch *march, PetscInt field, Vec inverse_mass, Vec node);
