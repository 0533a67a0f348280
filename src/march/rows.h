/*
   Passes by rows: the particles of a row lie on a line along x. So the maps act on lines of nodes (scheme/lines.h), and
   operations that act on the same line share it. In one dimension the line is the node field itself.
*/
#pragma once
#include "march/march_private.h"

#define MPM_MOST_KINDS 6 /* of weights: those of the operations that go to nodes */
#define MPM_MOST_ACROSS (MPM_MOST_KINDS * MPM_MOST_KINDS)

/*
   A map between particles and a line. Maps from one line with the same weights share the result; shared counts those
   that follow and use it too. particle is MPM_NONE for the nodal masses. weights: the number in the plan of the kind of
   weights along x.
*/
typedef struct {
  PetscReal   a;
  PetscInt    particle, shared, weights;
  MpmProperty weight;
} MpmRowMap;

/*
   A line of a node field. The nodes of rows across it have the weights across[number] of the plan. Its maps are
   map[begin] to map[end - 1] of the plan.
*/
typedef struct {
  PetscInt node, across, begin, end;
} MpmRowLine;

/* The numbers of the kinds of weights that rows of nodes have along y and along z. */
typedef struct {
  PetscInt y, z;
} MpmRowAcross;

typedef enum {
  MPM_ROW_SCALE,
  MPM_ROW_ADD,
  MPM_ROW_FINITE,
  MPM_ROW_GATHER,
  MPM_ROW_SPREAD,
  MPM_ROW_DRIFT
} MpmRowStepKind;

/*
   A step of a plan. Gathers and spreads have lines [begin, end); the others a particle field and a number a. An
   addition adds a times the particle field other. Operations of finite deformation have their kind: after ADVANCE the
   particles are at new places.
*/
typedef struct {
  MpmRowStepKind kind;
  MpmOpKind      finite;
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

/* Not collective. Finds the rows of the particles, if passes go through rows. It is called when places have changed. */
PetscErrorCode MpmRowsFind(MpmMarch *march);

/* Not collective. Takes all particles through the pass. */
void MpmRowsRun(const MpmMarchArrays *arrays);

/* Not collective. A particle field from particle begin on. Scratch fields live for one row, or for one cloud. */
static inline PetscReal *MpmRowsField(const MpmMarchArrays *arrays, PetscInt field, PetscInt begin)
{
  const PetscInt held = MpmTableHeld(arrays->march->scheme->table);

  return field < held ? arrays->particle[field] + begin : arrays->march->scratch + (field - held) * MPM_BLOCK;
}

/*
   Not collective. Runs a step of particles alone, which scales, adds or is of finite deformation, on n particles from
   begin on. after: they have been advanced. Steps with nodes are left to the engine.
*/
void MpmRowsOnParticles(const MpmMarchArrays *arrays, const MpmRowStep *step, PetscInt begin, PetscInt n,
                        PetscBool after);
