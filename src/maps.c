/* Operations between particles and nodes: their kernels, and those kernels' numbers. */
#include <mpmstab/maps.h>

MpmKernel MpmMapKernel(const MpmBasis *basis, MpmOpKind kind)
{
  switch (kind) {
  case MPM_P2G:
    return basis->p2g;
  case MPM_G2P:
    return basis->g2p;
  case MPM_GRAD:
    return basis->grad;
  default:
    return NULL;
  }
}

void MpmMapRow(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal row[])
{
  const MpmKernel kernel = MpmMapKernel(basis, kind);
  const PetscInt  reach = MpmMapReach(basis), cell = 0;
  PetscReal       unit[MPM_MAX_REACH] = {0}, particle = 1;

  if (MpmOpTraitsOf(kind).dst == MPM_ON_NODES) {
    kernel(1, &cell, &xi, 1, &particle, unit + basis->reach_left);
    for (PetscInt d = 0; d < reach; d++) row[d] = unit[d];
    return;
  }
  for (PetscInt d = 0; d < reach; d++) {
    row[d]  = 0;
    unit[d] = 1;
    kernel(1, &cell, &xi, 1, &row[d], unit + basis->reach_left);
    unit[d] = 0;
  }
}
