/* plane: the half space behind a plane through a point. d = (x - point) . normal */
#include "scheme/collider/shapes.h"

static PetscReal Distance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  for (PetscInt a = 0; a < dim; a++) normal[a] = body->value[1][a];
  return Dot(dim, x, normal) - Dot(dim, body->value[0], normal);
}

const MpmColliderShape MpmColliderPlane = {.name     = "plane",
                                           .summary  = "the half space behind a plane; normal points away from it",
                                           .key      = {"point", "normal"},
                                           .holds    = {MPM_KEY_PLACE, MPM_KEY_DIRECTION},
                                           .distance = Distance};
