/*
   cone: from its tip on, around an axis, with an angle between axis and surface; with dim 2 a wedge. It has no end.
   With z = q . axis and r = |q - z axis|, q = x - tip, the distance from the nearest line of the surface is r cos a - z
   sin a, and that from the tip |q|, where the tip is nearest. On the axis the normal is against it, which favours no
   side.
*/
#include "scheme/collider/shapes.h"

static PetscReal Distance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  const PetscReal *axis = body->value[1], sine = dim > 1 ? sin(body->value[2][0]) : 1, cosine = sqrt(1 - sine * sine);
  PetscReal        q[MPM_MAX_DIM], z, r, far;

  for (PetscInt a = 0; a < dim; a++) q[a] = x[a] - body->value[0][a];
  z   = Dot(dim, q, axis);
  far = sqrt(Dot(dim, q, q));
  for (PetscInt a = 0; a < dim; a++) normal[a] = q[a] - z * axis[a];
  r = dim > 1 ? sqrt(Dot(dim, normal, normal)) : 0;
  if (z * cosine + r * sine < 0) {
    for (PetscInt a = 0; a < dim; a++) normal[a] = q[a] / far;
    return far;
  }
  for (PetscInt a = 0; a < dim; a++) normal[a] = r > 0 ? cosine * normal[a] / r - sine * axis[a] : -axis[a];
  return r * cosine - z * sine;
}

const MpmColliderShape MpmColliderCone = {
    .name     = "cone",
    .summary  = "a cone around axis, from its tip on; angle: from axis to surface; with dim 2 a wedge",
    .key      = {"tip", "axis", "angle"},
    .holds    = {MPM_KEY_PLACE, MPM_KEY_DIRECTION, MPM_KEY_ANGLE},
    .distance = Distance};
