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

/*
   A step of a plan: maps of lines [begin, end), to nodes where it spreads and else from them; or without lines an
   operation on particles alone, or that moves them.
*/
typedef struct {
  PetscInt  begin, end;
  PetscBool spreads;
  MpmOp     op;
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
void MpmRowPlanCompile(const MpmPass *pass, const MpmBasis *basis, const MpmLayout *layout, MpmRowPlan *plan);

/* Not collective. Finds the rows of the particles, if passes go through rows. It is called when places have changed. */
PetscErrorCode MpmRowsFind(MpmMarch *march);

/* Not collective. Takes all particles through the pass. */
void MpmRowsRun(const MpmMarchArrays *arrays);
