/*
   Node operations that run chunk by chunk behind the particles give the same as operations that run one after the
   other.
*/
#include "check.h"
#include "march/march_nodes.h"

#define GHOST 5
#define NODES 200
#define ROOM (NODES + 2 * GHOST)
#define FIELDS 3

static void Fill(PetscReal node[FIELDS][ROOM])
{
  for (PetscInt f = 0; f < FIELDS; f++)
    for (PetscInt i = 0; i < ROOM; i++) node[f][i] = MpmHash(40 + f, i) - 0.5;
}

/* Runs a pass in chunks of so many nodes; with 0, the operations wait until all nodes are complete. */
static PetscErrorCode Run(const MpmPass *pass, PetscInt chunk, PetscReal node[FIELDS][ROOM])
{
  MpmGrid      grid                   = {.dim = 1, .ghost = GHOST, .axis = {{.nodes = NODES}}};
  MpmMarch     march                  = {.grid = &grid};
  MpmNodesDone done[MPM_MAX_PASS_OPS] = {{0, 0}};
  PetscReal   *field[MPM_MAX_FIELDS]  = {NULL};
  PetscInt     next                   = 0;

  PetscFunctionBegin;
  Fill(node);
  for (PetscInt f = 0; f < FIELDS; f++) field[f] = node[f] + GHOST;
  for (PetscInt hi = GHOST; chunk && hi <= NODES - GHOST; hi += chunk)
    MpmMarchFollowNodes(pass, field, GHOST, hi, done);
  if (chunk && chunk < 50)
    for (PetscInt o = 0; o < pass->nnode_ops; o++)
      CHECK(done[o].hi > NODES / 2, "operation %d has not followed: to %d", o, done[o].hi);
  PetscCall(MpmMarchNodeOps(&march, 0, pass, field, NULL, NULL, done, &next));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Follows(const MpmPass *pass)
{
  static const PetscInt chunks[] = {1, 2, 3, 7, 49, 100, 190};
  PetscReal             after[FIELDS][ROOM], following[FIELDS][ROOM];

  PetscFunctionBegin;
  PetscCall(Run(pass, 0, after));
  for (PetscInt c = 0; c < 7; c++) {
    PetscCall(Run(pass, chunks[c], following));
    for (PetscInt f = 0; f < FIELDS; f++)
      for (PetscInt i = 0; i < ROOM; i++)
        CHECK(following[f][i] == after[f][i], "chunks of %d: field %d, node %d: %g, not %g", chunks[c], f, i - GHOST,
              following[f][i], after[f][i]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  /*
     a pass like elastic's; an ADD to what LAP reads; a LAP of what another has changed, and a COPY over what it reads
  */
  const MpmPass elastic = {.nnode_ops = 2,
                           .node_op   = {{MPM_LAP, 0.3, 2, 0, 1, 0}, {MPM_COPY, 1, 1, 2, 1, 0, PETSC_TRUE}}};
  const MpmPass behind  = {.nnode_ops = 2,
                           .node_op   = {{MPM_LAP, 0.3, 2, 0, 1, 0}, {MPM_COPY, 0.7, 0, 2, 1, 0, PETSC_TRUE}}};
  const MpmPass chain   = {.nnode_ops = 4,
                           .node_op   = {{MPM_LAP, 0.3, 1, 0, 1, 0},
                                         {MPM_LAP, 0.2, 2, 1, 2, 0},
                                         {MPM_COPY, 0.5, 0, 2, 2, 0},
                                         {MPM_COPY, 2, 1, 0, 2, 0, PETSC_TRUE}}};

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(Follows(&elastic));
  PetscCall(Follows(&behind));
  PetscCall(Follows(&chain));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
