/* sphere: a ball, with dim 2 a disc. d = |x - center| - radius. In its center the normal is along x. */
#include "scheme/collider/shapes.h"

static PetscReal Distance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  PetscReal r;

  for (PetscInt a = 0; a < dim; a++) normal[a] = x[a] - body->value[0][a];
  r = sqrt(Dot(dim, normal, normal));
  for (PetscInt a = 0; a < dim; a++) normal[a] = r > 0 ? normal[a] / r : a == 0;
  return r - body->value[1][0];
}

static void Extent(const MpmCollider *body, PetscInt dim, PetscReal lo[], PetscReal hi[])
{
  for (PetscInt a = 0; a < dim; a++) {
    lo[a] = body->value[0][a] - body->value[1][0];
    hi[a] = body->value[0][a] + body->value[1][0];
  }
}

const MpmColliderShape MpmColliderSphere = {.name     = "sphere",
                                            .summary  = "a ball; with dim 2 a disc",
                                            .key      = {"center", "radius"},
                                            .holds    = {MPM_KEY_PLACE, MPM_KEY_SIZE},
                                            .distance = Distance,
                                            .extent   = Extent};
