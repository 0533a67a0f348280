/* The maps between particles and nodes as rows of numbers, from their weights. */
#include "scheme/maps.h"

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
