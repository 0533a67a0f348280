/*
   The contact conditions. y is the velocity relative to the body, y_n = y . n its part along the outward normal, and t
   = y - y_n n the rest.

     sticky      P(y) = 0
     slip        P(y) = t', on both sides of the surface
     separating  P(y) = y where y_n >= 0: there is no adhesion; else t'

   Coulomb's friction of coefficient mu takes from t what the impulse |y_n| along n allows: t' = t max(0, 1 - mu |y_n| /
   |t|). Without friction t' = t, so that sticky and slip are orthogonal projections.

     penalty     has no P: nodes do not feel the body, and particles inside it are pushed out
*/
#include "scheme/collider/shapes.h"

static void Sticky(PetscReal friction, PetscInt dim, const PetscReal normal[], PetscReal y[], PetscReal slope[])
{
  (void)friction, (void)normal;
  for (PetscInt a = 0; a < dim; a++) y[a] = 0;
  for (PetscInt i = 0; i < dim * dim; i++) slope[i] = 0;
}

/*
   dt' = (1 - q) dt + q e (e . dt) - mu sign(y_n) e (n . dy), with e = t / |t|, q = mu |y_n| / |t| and dt = dy - n (n .
   dy)
*/
static void Slip(PetscReal friction, PetscInt dim, const PetscReal normal[], PetscReal y[], PetscReal slope[])
{
  const PetscReal yn = Dot(dim, normal, y), least = friction * fabs(yn);
  PetscReal       e[MPM_MAX_DIM], size, q;

  for (PetscInt a = 0; a < dim; a++) y[a] -= yn * normal[a];
  size = sqrt(Dot(dim, y, y));
  if (friction > 0 && size <= least) {
    Sticky(friction, dim, normal, y, slope);
    return;
  }
  q = friction > 0 ? least / size : 0;
  for (PetscInt a = 0; a < dim; a++) {
    e[a] = size > 0 ? y[a] / size : 0;
    y[a] *= 1 - q;
  }
  for (PetscInt i = 0; i < dim * dim; i++) {
    const PetscInt a = i / dim, c = i % dim;

    slope[i] =
        (1 - q) * ((a == c) - normal[a] * normal[c]) + q * e[a] * e[c] - friction * copysign(1, yn) * e[a] * normal[c];
  }
}

static void Separating(PetscReal friction, PetscInt dim, const PetscReal normal[], PetscReal y[], PetscReal slope[])
{
  if (Dot(dim, normal, y) < 0)
    Slip(friction, dim, normal, y, slope);
  else
    for (PetscInt i = 0; i < dim * dim; i++) slope[i] = i % (dim + 1) == 0;
}

static const MpmContact
    sticky     = {.name = "sticky", .summary = "nodes move with the collider", .linear = PETSC_TRUE, .project = Sticky},
    slip       = {.name = "slip",
                  .summary =
                      "nodes keep their velocity along the surface, with friction a part of it, and lose that across it",
                  .rubs    = PETSC_TRUE,
                  .linear  = PETSC_TRUE,
                  .project = Slip},
    separating = {.name    = "separating",
                  .summary = "as slip where nodes move into the collider; nodes that leave it are free",
                  .rubs    = PETSC_TRUE,
                  .project = Separating},
    penalty    = {.name    = "penalty",
                  .summary = "particles inside are pushed out with the acceleration stiffness times depth",
                  .pushes  = PETSC_TRUE};

const MpmContact *const MpmContacts[] = {&sticky, &slip, &separating, &penalty, NULL};
