/* Operations between particles and nodes: their kernels, and those kernels' numbers. */
#include "scheme/maps.h"

void MpmMapRow(const MpmBasis *basis, MpmOpKind kind, PetscReal xi, PetscReal width, PetscReal row[])
{
  const MpmKernel kernel = basis->kernel[kind];
  const PetscInt  reach = MpmMapReach(basis), cell = 0;
  PetscReal       unit[MPM_MAX_REACH] = {0}, particle = 1;
  MpmBlock        block;

  MpmBlockPlace(basis, 1, &cell, &xi, width, &block);
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

PetscInt MpmNodeImage(const MpmScene *scene, PetscInt node, PetscBool odd, PetscReal *sign)
{
  const PetscInt last = scene->nodes - 1;
  PetscReal      mirror[2];

  *sign = 1;
  if (MpmSceneIsPeriodic(scene)) {
    node %= scene->cells;
    return node < 0 ? node + scene->cells : node;
  }
  if (node >= 0 && node <= last) return node;
  MpmSceneMirror(scene, odd, mirror);
  *sign = mirror[node > last];
  return node < 0 ? -node : 2 * last - node;
}

void MpmNodesSeen(const MpmScene *scene, PetscInt cell, PetscBool odd, PetscBool drop, PetscInt node[],
                  PetscReal sign[])
{
  for (PetscInt d = 0; d < MpmMapReach(scene->basis); d++) {
    node[d] = MpmNodeImage(scene, cell - scene->basis->reach_left + d, odd, &sign[d]);
    if (!drop || !odd) continue;
    if ((node[d] == 0 && scene->ends[0] == MPM_FIXED) || (node[d] == scene->nodes - 1 && scene->ends[1] == MPM_FIXED))
      sign[d] = 0;
  }
}
