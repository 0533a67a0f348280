/* The maps between particles and nodes as rows of numbers, from their kernels. */
#include "scheme/maps.h"

void MpmMapRow(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal half_width, const PetscInt wall[2],
               PetscReal row[])
{
  const MpmKernel kernel = basis->kernel[kind];
  const PetscInt  reach = MpmMapReach(basis), cell = 0;
  PetscReal       unit[MPM_MAX_REACH] = {0}, particle = 1;
  MpmBlock        block;

  MpmBlockPlace(basis, 1, &cell, &xi, half_width, wall, &block);
  if (MpmOpTraitsOf(kind).dst == MPM_ON_NODES) {
    kernel(&block, 1, &particle, unit + basis->reach_left);
    for (PetscInt d = 0; d < reach; d++) row[d] = unit[d];
    return;
  }
  for (PetscInt d = 0; d < reach; d++) {
    row[d]  = 0;
    unit[d] = 1;
    kernel(&block, 1, &row[d], unit + basis->reach_left);
    unit[d] = 0;
  }
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
