/* Operations between particles and nodes: their kernels, and those kernels' numbers. */
#include <mpmstab/maps.h>

void MpmMapRow(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal width, PetscReal row[])
{
  const MpmKernel kernel = basis->kernel[kind];
  const PetscInt  reach = MpmMapReach(basis), cell = 0;
  PetscReal       unit[MPM_MAX_REACH] = {0}, particle = 1;

  if (MpmOpTraitsOf(kind).dst == MPM_ON_NODES) {
    kernel(1, &cell, &xi, width, 1, &particle, unit + basis->reach_left);
    for (PetscInt d = 0; d < reach; d++) row[d] = unit[d];
    return;
  }
  for (PetscInt d = 0; d < reach; d++) {
    row[d]  = 0;
    unit[d] = 1;
    kernel(1, &cell, &xi, width, 1, &row[d], unit + basis->reach_left);
    unit[d] = 0;
  }
}
