/*
   The ends of a domain, and the mirror images of nodes beyond them; the maps between particles and nodes as rows of
   numbers.
*/
#include "scheme/maps.h"

const char *const MpmEndNames[]     = {"periodic", "fixed", "fixed_reaction", "free", "symmetry", NULL};
const char *const MpmEndSummaries[] = {
    "no ends (as in the slides)",
    "velocity 0 at the wall node, and no increment for particles; gas is reflected (Sulsky, Chen and Schreyer 1994)",
    "the same, but particles get the wall's reaction as their increment (Uintah's 1-D code)",
    "nothing imposed: no stress (a bar's end)",
    "a slipping wall: the velocity normal to it is 0, as with fixed; in one dimension the same as fixed",
    NULL};

#define FAR (PETSC_MAX_INT / 4) /* nodes, of any grid and of any place in it */

const PetscInt MpmNoWalls[2] = {-FAR, FAR};

void MpmDirectionWalls(const MpmDirection *direction, PetscInt node, PetscInt wall[2])
{
  const PetscBool periodic = direction->ends[0] == MPM_PERIODIC ? PETSC_TRUE : PETSC_FALSE;

  wall[0] = periodic ? MpmNoWalls[0] : -node;
  wall[1] = periodic ? MpmNoWalls[1] : direction->nodes - 1 - node;
}

void MpmDirectionMirror(const MpmDirection *direction, MpmParity parity, PetscReal sign[2])
{
  for (int end = 0; end < 2; end++) sign[end] = MpmEndIsOdd(direction->ends[end], parity) ? -1 : 1;
}

PetscInt MpmDirectionImage(const MpmDirection *direction, PetscInt node, MpmParity parity, PetscReal *sign)
{
  const PetscInt last = direction->nodes - 1;
  PetscReal      mirror[2];

  *sign = 1;
  if (direction->ends[0] == MPM_PERIODIC) {
    node %= direction->cells;
    return node < 0 ? node + direction->cells : node;
  }
  MpmDirectionMirror(direction, parity, mirror);
  while (node < 0 || node > last) { /* an image beyond the other wall has an image itself */
    *sign *= mirror[node > last];
    node = node < 0 ? -node : 2 * last - node;
  }
  return node;
}

void MpmMapRow(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal half_width, const PetscInt wall[2],
               PetscReal row[])
{
  const PetscInt reach = MpmMapReach(basis), cell = 0;
  PetscReal      weight[MPM_MOST_NODES];
  MpmBlock       block;

  MpmBlockPlace(basis, 1, &cell, &xi, half_width, wall, &block);
  basis->weights[kind](&block, 1, weight);
  for (PetscInt d = 0; d < reach; d++) row[d] = 0;
  for (PetscInt d = 0; d < basis->nodes; d++) row[basis->reach_left + block.first[0] + d] = weight[d];
}

void MpmNodesSeen(const MpmDirection *direction, const MpmBasis *basis, PetscInt cell, MpmParity parity, PetscBool drop,
                  PetscInt node[], PetscReal sign[])
{
  const PetscInt last = direction->nodes - 1;

  for (PetscInt d = 0; d < MpmMapReach(basis); d++) {
    node[d] = MpmDirectionImage(direction, cell - basis->reach_left + d, parity, &sign[d]);
    if (!drop || direction->ends[0] == MPM_PERIODIC) continue;
    if ((node[d] == 0 && MpmEndImposes(direction->ends[0], parity)) ||
        (node[d] == last && MpmEndImposes(direction->ends[1], parity)))
      sign[d] = 0;
  }
}
