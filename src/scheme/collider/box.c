/*
   box: a box along the axes. With q_a = |x_a - center_a| - size_a / 2 the distance is max_a q_a inside, and |max(q, 0)|
   outside. Inside the normal is that of the nearest face.
*/
#include "scheme/collider/shapes.h"

static PetscReal Distance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  PetscReal out[MPM_MAX_DIM], deepest = -INFINITY, r;
  PetscInt  face = 0;

  for (PetscInt a = 0; a < dim; a++) {
    const PetscReal from = x[a] - body->value[0][a], q = fabs(from) - body->value[1][a] / 2;

    normal[a] = 0;
    out[a]    = copysign(PetscMax(q, 0), from);
    if (q > deepest) {
      deepest = q;
      face    = a;
    }
  }
  r = sqrt(Dot(dim, out, out));
  for (PetscInt a = 0; a < dim && r > 0; a++) normal[a] = out[a] / r;
  if (r > 0) return r;
  normal[face] = x[face] < body->value[0][face] ? -1 : 1;
  return deepest;
}

static void Extent(const MpmCollider *body, PetscInt dim, PetscReal lo[], PetscReal hi[])
{
  for (PetscInt a = 0; a < dim; a++) {
    lo[a] = body->value[0][a] - body->value[1][a] / 2;
    hi[a] = body->value[0][a] + body->value[1][a] / 2;
  }
}

const MpmColliderShape MpmColliderBox = {.name     = "box",
                                         .summary  = "a box along the axes",
                                         .key      = {"center", "size"},
                                         .holds    = {MPM_KEY_PLACE, MPM_KEY_SIZES},
                                         .distance = Distance,
                                         .extent   = Extent};
