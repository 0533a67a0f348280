/*
   cylinder: a round bar with flat ends, from the middle of one end to that of the other; with dim 2 a rectangle of the
   width 2 radius, at any angle. With z and r the places along and across the axis, the distances from the ends and from
   the side are q_z = |z - l / 2| - l / 2 and q_r = r - radius, and those of the box in z and r follow from them.
*/
#include "scheme/collider/shapes.h"

/* A direction across an axis of length 1; 0 in one dimension. */
static void Across(PetscInt dim, const PetscReal axis[], PetscReal e[])
{
  PetscInt  least = 0;
  PetscReal size;

  for (PetscInt a = 1; a < dim; a++)
    if (fabs(axis[a]) < fabs(axis[least])) least = a;
  for (PetscInt a = 0; a < dim; a++) e[a] = (a == least) - axis[least] * axis[a];
  size = sqrt(Dot(dim, e, e));
  for (PetscInt a = 0; a < dim && size > 0; a++) e[a] /= size;
}

static PetscReal Distance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  PetscReal axis[MPM_MAX_DIM], e[MPM_MAX_DIM], from[MPM_MAX_DIM], q[2], out, length, z, r, side;

  for (PetscInt a = 0; a < dim; a++) {
    axis[a] = body->value[1][a] - body->value[0][a];
    from[a] = x[a] - (body->value[0][a] + body->value[1][a]) / 2;
  }
  length = sqrt(Dot(dim, axis, axis));
  for (PetscInt a = 0; a < dim; a++) axis[a] /= length;
  z = Dot(dim, from, axis);
  for (PetscInt a = 0; a < dim; a++) e[a] = from[a] - z * axis[a];
  r = sqrt(Dot(dim, e, e));
  if (r > 0)
    for (PetscInt a = 0; a < dim; a++) e[a] /= r;
  else
    Across(dim, axis, e);
  side = copysign(1, z);
  q[0] = fabs(z) - length / 2;
  q[1] = dim > 1 ? r - body->value[2][0] : -INFINITY;
  out  = hypot(PetscMax(q[0], 0), PetscMax(q[1], 0));
  for (PetscInt a = 0; a < dim; a++)
    normal[a] = out > 0       ? (PetscMax(q[0], 0) * side * axis[a] + PetscMax(q[1], 0) * e[a]) / out
                : q[0] > q[1] ? side * axis[a]
                              : e[a];
  return out > 0 ? out : PetscMax(q[0], q[1]);
}

static void Extent(const MpmCollider *body, PetscInt dim, PetscReal lo[], PetscReal hi[])
{
  PetscReal squares = 0;

  for (PetscInt a = 0; a < dim; a++) squares += PetscSqr(body->value[1][a] - body->value[0][a]);
  for (PetscInt a = 0; a < dim; a++) {
    const PetscReal along = body->value[1][a] - body->value[0][a];
    const PetscReal wide  = dim > 1 ? body->value[2][0] * sqrt(PetscMax(0, 1 - along * along / squares)) : 0;

    lo[a] = PetscMin(body->value[0][a], body->value[1][a]) - wide;
    hi[a] = PetscMax(body->value[0][a], body->value[1][a]) + wide;
  }
}

const MpmColliderShape MpmColliderCylinder = {.name = "cylinder",
                                              .summary =
                                                  "a round bar with flat ends; with dim 2 a rectangle at any angle",
                                              .key      = {"from", "to", "radius"},
                                              .holds    = {MPM_KEY_PLACE, MPM_KEY_PLACE, MPM_KEY_SIZE},
                                              .distance = Distance,
                                              .extent   = Extent};
