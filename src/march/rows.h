/*
   Passes in more than one dimension. Particles go through a pass row by row: those of a row lie on a line along x. So
   the maps act on lines of nodes (scheme/lines.h), and operations that act on the same line share it.
*/
#pragma once
#include "march/march_private.h"

#define MPM_MOST_KINDS 6 /* kinds of weights: those of the operations that go to nodes */
#define MPM_MOST_ACROSS (MPM_MOST_KINDS * MPM_MOST_KINDS)

/* The node field that stands for the nodal masses. */
#define MPM_MASSES MPM_MAX_FIELDS

/*
   A map between particles and a line. Maps of one kernel from one line share its result; shared counts those that
   follow and use it too. particle is MPM_NONE for the nodal masses. weights: the kind of operation to nodes that has the
   map's weights along x.
*/
typedef struct {
  MpmKernel   kernel;
  MpmOpKind   weights;
  PetscReal   a;
  PetscInt    particle, shared;
  MpmProperty weight;
} MpmRowMap;

/*
   A line of a node field. The nodes of rows across it have the weights across[number] of the plan. Its maps are
   map[begin] to map[end - 1] of the plan.
*/
typedef struct {
  PetscInt node, across, begin, end;
} MpmRowLine;

/* The kinds of operation to nodes whose weights rows of nodes have along y and along z. */
typedef struct {
  MpmOpKind y, z;
} MpmRowAcross;

typedef enum {
  MPM_ROW_SCALE,
  MPM_ROW_ADD,
  MPM_ROW_FINITE,
  MPM_ROW_GATHER,
  MPM_ROW_SPREAD,
  MPM_ROW_DRIFT,
  MPM_ROW_SAMPLE
} MpmRowStepKind;

/*
   A step of a plan. Gathers and spreads have lines [begin, end); the others a particle field and a number a. An addition
   adds a times the particle field other. Operations of finite deformation have their kind in a pass: after ADVANCE the
   particles are at new places.
*/
typedef struct {
  MpmRowStepKind kind;
  MpmPassOpKind  finite;
  PetscInt       begin, end, particle, other;
  PetscReal      a;
} MpmRowStep;

/*S
   MpmRowPlan - a pass compiled for rows. Maps have the weights of kind[0] to kind[nkinds - 1] along the directions; the
   first is MPM_P2G. across: the pairs of kinds that the lines have across them.
S*/
struct MpmRowPlan_ {
  PetscInt     nsteps, nlines, nmaps, nkinds, nacross;
  MpmRowStep   step[2 * MPM_MAX_PASS_OPS];
  MpmRowLine   line[2 * MPM_MAX_PASS_OPS];
  MpmRowMap    map[2 * MPM_MAX_PASS_OPS];
  MpmOpKind    kind[MPM_OP_KINDS];
  MpmRowAcross across[MPM_MOST_ACROSS];
};

/* Not collective. Compiles a pass. */
void MpmRowPlanCompile(const MpmPass *pass, const MpmBasis *basis, PetscInt dim, MpmRowPlan *plan);

/* The particles and nodes that a pass goes over. sum[MPM_MASSES] are the nodal masses. */
typedef struct {
  const MpmMarch   *march;
  const MpmRowPlan *plan;
  PetscBool         sample;
  PetscInt         *cell[MPM_MAX_DIM], whole[2][MPM_MAX_DIM];
  PetscInt64       *id, step; /* id: of particles that move each by itself; step: that of the places before DRIFT */
  PetscReal        *xi[MPM_MAX_DIM], part[2][MPM_MAX_DIM], *squares;
  PetscReal        *particle[MPM_MAX_FIELDS], *weight[MPM_PROPERTIES];
  PetscReal        *node[MPM_MAX_FIELDS], *sum[MPM_MAX_FIELDS + 1];
} MpmRowArrays;

/* Not collective. Takes all particles through the pass. */
void MpmRowsRun(const MpmRowArrays *arrays);

/*
   Not collective. Moves n particles from their resting places along an axis on to those of the pass, before DRIFT or
   after it. Along an axis without drift they stay exactly where they are, also those just left of a wall.
*/
void MpmRowsMove(const MpmRowArrays *arrays, PetscInt axis, PetscInt n, const PetscInt cell0[], const PetscReal xi0[],
                 PetscInt after, PetscInt cell[], PetscReal xi[]);

/* Not collective. A particle field from particle begin on. Scratch fields live for one row, or for one cloud. */
static inline PetscReal *MpmRowsField(const MpmRowArrays *arrays, PetscInt field, PetscInt begin)
{
  const PetscInt nstate = arrays->march->scheme->table->nstate;

  return field < nstate ? arrays->particle[field] + begin : arrays->march->scratch + (field - nstate) * MPM_BLOCK;
}

/*
   Collective. The node operations after a pass, in more than one dimension: from number *next on, which becomes that of the
   first IMPLICIT there, or their number. step is that of the particles' places.
*/
PetscErrorCode MpmRowsNodeOps(const MpmMarch *march, const MpmPass *pass, PetscInt64 step, const MpmRowArrays *arrays,
                              PetscReal *const field[], PetscInt *next);
