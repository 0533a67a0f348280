/* The list of the shapes, and what the bodies of a scene do together. */
#include "scheme/collider/shapes.h"

#define ON_SURFACE 1e-9 /* cells: nodes nearer to a surface are on it, and inside */

extern const MpmColliderShape MpmColliderPlane, MpmColliderSphere, MpmColliderBox;

const MpmColliderShape *const MpmColliderShapes[] = {&MpmColliderPlane, &MpmColliderSphere, &MpmColliderBox, NULL};

PetscBool MpmCollidersAreLinear(const MpmColliders *colliders)
{
  for (const MpmCollider *body = colliders->body; body < colliders->body + colliders->n; body++)
    if (!body->contact->linear || body->friction > 0 || Dot(MPM_MAX_DIM, body->velocity, body->velocity) > 0)
      return PETSC_FALSE;
  return PETSC_TRUE;
}

PetscBool MpmCollidersProject(const MpmColliders *colliders, PetscInt dim, const PetscReal x[], PetscReal time,
                              PetscReal v[], PetscReal slope[])
{
  PetscBool inside = PETSC_FALSE;

  for (const MpmCollider *body = colliders->body; body < colliders->body + colliders->n; body++) {
    PetscReal from[MPM_MAX_DIM], normal[MPM_MAX_DIM], own[MPM_MAX_DIM * MPM_MAX_DIM], before[MPM_MAX_DIM * MPM_MAX_DIM];

    for (PetscInt a = 0; a < dim; a++) from[a] = x[a] - body->pace[a] * time;
    if (body->shape->distance(body, dim, from, normal) > ON_SURFACE) continue;
    for (PetscInt i = 0; i < dim * dim; i++) before[i] = inside ? slope[i] : i % (dim + 1) == 0;
    for (PetscInt a = 0; a < dim; a++) v[a] -= body->velocity[a];
    body->contact->project(body->friction, dim, normal, v, own);
    for (PetscInt a = 0; a < dim; a++) v[a] += body->velocity[a];
    for (PetscInt i = 0; i < dim * dim; i++) {
      slope[i] = 0;
      for (PetscInt c = 0; c < dim; c++) slope[i] += own[i / dim * dim + c] * before[c * dim + i % dim];
    }
    inside = PETSC_TRUE;
  }
  return inside;
}
