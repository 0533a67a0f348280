/* The list of the shapes, and what the bodies of a scene do together. */
#include "scheme/collider/shapes.h"

#define ON_SURFACE 1e-9 /* cells: nodes nearer to a surface are on it, and inside */

extern const MpmColliderShape MpmColliderPlane, MpmColliderSphere, MpmColliderBox, MpmColliderCone, MpmColliderCylinder,
    MpmColliderDistance;

const MpmColliderShape *const MpmColliderShapes[] = {&MpmColliderPlane,
                                                     &MpmColliderSphere,
                                                     &MpmColliderBox,
                                                     &MpmColliderCone,
                                                     &MpmColliderCylinder,
                                                     &MpmColliderDistance,
                                                     NULL};

PetscBool MpmCollidersAreLinear(const MpmColliders *colliders)
{
  for (const MpmCollider *body = colliders->body; body < colliders->body + colliders->n; body++)
    if (!body->contact->linear || body->friction > 0 || MpmColliderMoves(body)) return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscBool MpmColliderMoves(const MpmCollider *body)
{
  for (PetscInt k = 0; k < body->ntimes; k++)
    if (Dot(MPM_MAX_DIM, body->velocity[k], body->velocity[k]) > 0) return PETSC_TRUE;
  return PETSC_FALSE;
}

void MpmColliderMotion(const MpmCollider *body, PetscInt dim, PetscReal time, PetscReal way[], PetscReal velocity[])
{
  const PetscInt n = body->ntimes;
  PetscInt       k = 0;
  PetscReal      part;

  for (PetscInt a = 0; a < dim; a++) way[a] = velocity[a] = 0;
  if (!n) return;
  for (; k + 1 < n && time > body->time[k + 1]; k++)
    for (PetscInt a = 0; a < dim; a++)
      way[a] +=
          body->pace * (body->time[k + 1] - body->time[k]) * (body->velocity[k][a] + body->velocity[k + 1][a]) / 2;
  part = k + 1 < n ? (time - body->time[k]) / (body->time[k + 1] - body->time[k]) : 0;
  for (PetscInt a = 0; a < dim; a++) {
    velocity[a] = body->velocity[k][a] + (part > 0 ? part * (body->velocity[k + 1][a] - body->velocity[k][a]) : 0);
    way[a] += body->pace * (time - body->time[k]) * (body->velocity[k][a] + velocity[a]) / 2;
  }
}

PetscReal MpmCollidersStiffness(const MpmColliders *colliders)
{
  PetscReal sum = 0;

  for (PetscInt i = 0; colliders && i < colliders->n; i++) sum += colliders->body[i].stiffness;
  return sum;
}

PetscReal MpmCollidersPush(const MpmColliders *colliders, PetscInt dim, const PetscReal x[], PetscReal time,
                           PetscReal push[])
{
  PetscReal energy = 0;

  for (const MpmCollider *body = colliders->body; body < colliders->body + colliders->n; body++) {
    PetscReal from[MPM_MAX_DIM], normal[MPM_MAX_DIM], way[MPM_MAX_DIM], velocity[MPM_MAX_DIM], depth;

    if (!body->contact->pushes) continue;
    MpmColliderMotion(body, dim, time, way, velocity);
    for (PetscInt a = 0; a < dim; a++) from[a] = x[a] - way[a];
    depth = -body->shape->distance(body, dim, from, normal);
    if (depth <= 0) continue;
    for (PetscInt a = 0; push && a < dim; a++) push[a] += body->stiffness * depth * normal[a];
    energy += body->stiffness * depth * depth / 2;
  }
  return energy;
}

PetscBool MpmCollidersProject(const MpmColliders *colliders, PetscInt dim, const PetscReal x[], PetscReal time,
                              PetscReal v[], PetscReal slope[])
{
  PetscBool inside = PETSC_FALSE;

  for (const MpmCollider *body = colliders->body; body < colliders->body + colliders->n; body++) {
    PetscReal from[MPM_MAX_DIM], normal[MPM_MAX_DIM], own[MPM_MAX_DIM * MPM_MAX_DIM], before[MPM_MAX_DIM * MPM_MAX_DIM];
    PetscReal way[MPM_MAX_DIM], velocity[MPM_MAX_DIM];

    MpmColliderMotion(body, dim, time, way, velocity);
    if (body->contact->pushes) continue;
    for (PetscInt a = 0; a < dim; a++) from[a] = x[a] - way[a];
    if (body->shape->distance(body, dim, from, normal) > ON_SURFACE) continue;
    for (PetscInt i = 0; i < dim * dim; i++) before[i] = inside ? slope[i] : i % (dim + 1) == 0;
    for (PetscInt a = 0; a < dim; a++) v[a] -= velocity[a];
    body->contact->project(body->friction, dim, normal, v, own);
    for (PetscInt a = 0; a < dim; a++) v[a] += velocity[a];
    for (PetscInt i = 0; i < dim * dim; i++) {
      slope[i] = 0;
      for (PetscInt c = 0; c < dim; c++) slope[i] += own[i / dim * dim + c] * before[c * dim + i % dim];
    }
    inside = PETSC_TRUE;
  }
  return inside;
}
