/* The march as its own files see it, and those that read its state. */
#pragma once
#include "base/float_check.h"
#include "march/grid.h"
#include "march/particles.h"
#include "march/passes.h"
#include <mpmstab/march.h>

typedef struct MpmMarchEngine_   MpmMarchEngine;
typedef struct MpmRowPlan_       MpmRowPlan;       /* a pass compiled for rows of particles (march/rows.h) */
typedef struct MpmNodalSolve_    MpmNodalSolve;    /* march/nodal_solve.h */
typedef struct MpmImplicitSolve_ MpmImplicitSolve; /* march/implicit_solve.h */
typedef struct MpmSolving_       MpmSolving;       /* a nonlinear system (march/finite.h) */
typedef struct MpmWatch_ MpmWatch; /* what passes find out about particles that move each by itself (march/finite.h) */
typedef struct MpmHalve_ MpmHalve; /* steps that are taken in parts (march/adapt.h) */
typedef struct MpmRelax_ MpmRelax; /* the increments of a step (march/adapt.h) */
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
  const MpmMarchEngine *engine;
  const MpmScene       *scene; /* units, exact solution and output; NULL: random data, which have none of these */
  const MpmLayout      *layout;
  const MpmScheme      *scheme;
  PetscReal             cell_width;                     /* 1 without a scene */
  PetscReal             courant, velocity[MPM_MAX_DIM]; /* at finite deformation: of a step, and of the start over c */
  PetscReal             elapsed;                        /* where steps differ: the sum of their Courant numbers */
  PetscReal             within;                         /* the sum of those of the parts of this step so far */
  MpmGrid              *grid;
  MpmParticles         *particles;
  MpmSchedule           schedule;
  MpmRowPlan           *plans;  /* of the fast march: of the passes, of the start after them, and of each K */
  MpmRow               *row;    /* the rows of the particles, and where the last one ends; nrows are there */
  MpmCloudPlan         *clouds; /* the same where particles share no coordinate, or NULL; bundles: memory for them */
  PetscReal            *bundles;
  PetscInt              nnodes, slack, nrows;
  PetscInt              fullest; /* the largest number of particles that this rank has had */
  Vec                   node[MPM_MAX_FIELDS], spare[MPM_MAX_FIELDS], inverse_mass; /* local vectors */
  MpmNodalSolve        *nodal_solve;                                               /* NULL: the table has no SOLVE */
  MpmImplicitSolve     *implicit[MPM_MAX_STIFF]; /* of the tables of K that the table has */
  const MpmSolving     *solving;                 /* the nonlinear system whose pass is run, or NULL */
  MpmHalve             *halve;                   /* NULL where steps are not halved */
  PetscInt64            step, migrations;
  PetscInt              exponent;
  MpmWatch             *watch;        /* NULL where particles do not move each by itself */
  MpmRelax             *relax;        /* NULL where steps are not relaxed */
  char                  failure[512]; /* what has happened to a particle, or to a solve; empty: nothing */
  PetscReal            *scratch;      /* MPM_BLOCK numbers for each scratch register of the particles */
  PetscLogEvent         pass_event, sum_event, migrate_event, watch_event, certificate_event;
  MpmFloatCheck         float_check;
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

  if (!MpmMarchIsPaced(march)) return (PetscReal)step * scene->dt + MpmSceneTimeStep(scene, march->within);
  return MpmSceneTimeStep(scene, march->elapsed + (PetscReal)(step - march->step) * march->courant);
}

/*
   MpmMarchSetCourant - sets the Courant number of the next steps, of a march whose steps differ. What nodes hold is
   still that of the step before; the pass before the first step, schedule.start, renews it.

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
   MpmMarchEngine_ - how a march is run: the plain one, or one that is faster.

   compile   - what it makes for a Courant number, or NULL; placed: when places have changed, or NULL; destroy: of these
   start     - what comes before the first step: nodes get what particles give them
   step      - all operations of a table. After each DRIFT or ADVANCE it calls MpmMarchMoved. A failure of the march
               ends it.
   stiffness - image = K solved, with table i of the K, at the places of a step

   Collective.
S*/
struct MpmMarchEngine_ {
  PetscErrorCode (*compile)(MpmMarch *march);
  PetscErrorCode (*placed)(MpmMarch *march);
  PetscErrorCode (*start)(MpmMarch *march);
  PetscErrorCode (*step)(MpmMarch *march);
  PetscErrorCode (*stiffness)(MpmMarch *march, PetscInt64 step, PetscInt i);
  PetscErrorCode (*destroy)(MpmMarch *march);
};
extern const MpmMarchEngine MpmPlainMarch, MpmFastMarch;

/* Collective. What comes before the first step. It is called again when the state or the Courant number was set. */
PetscErrorCode MpmMarchStart(MpmMarch *march);

/*
   Collective. The particles have moved: they migrate if need be. summed: nodes have what particles give to the next
   step.
*/
PetscErrorCode MpmMarchMoved(MpmMarch *march, PetscBool summed);

/*
   Collective. MpmParticlesRebase, and what the engine knows of the places made anew: whoever sends particles away calls
   this.
*/
PetscErrorCode MpmMarchRebase(MpmMarch *march);

/* The node field that stands for the nodal masses. */
#define MPM_MASSES MPM_MAX_FIELDS

/*S
   MpmMarchArrays - the particles and nodes of a march while it works on them.

   id          - of particles that move each by itself
   within      - particles move in the middle of the step
   step        - that of the places; whole[after], part[after]: the drift since rest there, and a step later
   scratch, all - scratch registers: of all particles one after another or, for MPM_BLOCK each, of those at work
   node, sum   - node fields, and the arrays that are summed to: sum[MPM_MASSES] are the inverse nodal masses, the fast
                 march sets the others
S*/
typedef struct {
  const MpmMarch   *march;
  const MpmRowPlan *plan;
  PetscBool         within, all;
  PetscInt         *cell[MPM_MAX_DIM], whole[2][MPM_MAX_DIM];
  PetscInt64       *id, step;
  PetscReal        *xi[MPM_MAX_DIM], part[2][MPM_MAX_DIM];
  PetscReal        *particle[MPM_MAX_FIELDS], *weight[MPM_PROPERTIES];
  PetscReal        *node[MPM_MAX_FIELDS], *sum[MPM_MAX_FIELDS + 1], *scratch;
} MpmMarchArrays;

/* Not collective. A particle register from particle begin on. */
static inline PetscReal *MpmMarchRegister(const MpmMarchArrays *arrays, PetscInt r, PetscInt begin)
{
  const PetscInt scratch = r - MpmTableHeld(arrays->march->scheme->table);

  if (scratch < 0) return arrays->particle[r] + begin;
  return arrays->all ? arrays->scratch + scratch * arrays->march->particles->count + begin
                     : arrays->scratch + scratch * MPM_BLOCK;
}

/*
   Not collective. Runs an operation on particles alone, or one that moves them, on n particles from begin on (finite.c).
   Its factor is all that multiplies it. after: they have been advanced.
*/
void MpmMarchOnParticles(const MpmMarchArrays *arrays, const MpmOp *op, PetscInt begin, PetscInt n, PetscBool after);

/* Not collective. The arrays with the particles at the places of a step; a march gets them once at a time. */
PetscErrorCode MpmMarchGetArrays(const MpmMarch *march, PetscInt64 step, MpmMarchArrays *arrays);
PetscErrorCode MpmMarchRestoreArrays(const MpmMarch *march, MpmMarchArrays *arrays);

/*
   Not collective. Moves n particles from their resting places along an axis on to those of the step, or after it. Along
   an axis without drift they stay exactly where they are, also those just left of a wall.
*/
void MpmMarchPlaces(const MpmMarchArrays *arrays, PetscInt axis, PetscInt n, const PetscInt cell0[],
                    const PetscReal xi0[], PetscInt after, PetscInt cell[], PetscReal xi[]);

/* What a march does on nodes alone (march_nodes.c). */

/*
   MpmNodesSum - completes what this rank's particles gave to n node fields: adds what images beyond walls got, sums
   over ranks, divides by the masses, and sets ghosts and images. parity[f]: that of sums[f]. Fields become 0 where
   there is no mass. With with_mass the masses were summed too, and become their inverses.

   Collective.
*/
PetscErrorCode MpmNodesSum(const MpmMarch *march, PetscInt n, PetscReal *const sums[], const MpmParity *const parity[],
                           PetscBool with_mass, PetscReal mass[]);

/* Collective. Sets ghosts to the values that their owners have, and images beyond walls. */
PetscErrorCode MpmNodesRefresh(const MpmMarch *march, const MpmParity parity[], PetscReal field[]);

/*
   Collective. An operation between node fields, of which the factor is all that multiplies it, at this rank's nodes and
   all but depth of the ghosts. step is that of the particles' places.
*/
PetscErrorCode MpmNodesRun(const MpmMarchArrays *arrays, const MpmOp *op, PetscInt depth, PetscInt64 step,
                           PetscReal *const field[]);

/* Not collective. Divides the state by 2^shift and adds shift to the exponent. */
PetscErrorCode MpmMarchRescale(MpmMarch *march, PetscInt shift);

/*
   Collective. P2G of one particle field with the particles at the places of a step, the present one or, while they stay,
   the next: into a local vector with its ghosts. inverse_mass: NULL, or a local vector that is set for these places.
   Under drift, the ghost layer must have slack for the next step.
*/
PetscErrorCode MpmMarchProject(MpmMarch *march, PetscInt field, PetscInt64 step, Vec inverse_mass, Vec node);
