/*
   distance: a body whose signed distance d is known at the nodes of a grid of its own. Between the nodes d is linear
   along each direction, so off by spacing^2 / 8 times its second derivatives, and its normal, the gradient of that over
   its length, by spacing / 2 times them. Beyond the grid at x, with c its nearest point, it is d(c) + |x - c| where
   d(c) > 0; else d(c) with the normal at c: a body that reaches the grid's edge, as the ground does, goes on.
*/
#include "scheme/collider/shapes.h"

/*
   The nearest point of the grid in spacings of it: node i and the part f of the way to the next. Returns the place's
   way from it.
*/
static PetscReal Find(const MpmDistance *grid, PetscInt dim, const PetscReal x[], PetscInt i[], PetscReal f[],
                      PetscReal way[])
{
  for (PetscInt a = 0; a < dim; a++) {
    const PetscReal q = (x[a] - grid->origin[a]) / grid->spacing[a], c = PetscMin(PetscMax(q, 0), grid->n[a] - 1);

    i[a]   = PetscMin((PetscInt)c, grid->n[a] - 2);
    f[a]   = c - i[a];
    way[a] = (q - c) * grid->spacing[a];
  }
  return sqrt(Dot(dim, way, way));
}

static PetscReal Distance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  const MpmDistance *grid = body->grid;
  PetscInt           i[MPM_MAX_DIM];
  PetscReal          f[MPM_MAX_DIM], way[MPM_MAX_DIM], d = 0, size;
  const PetscReal    out = Find(grid, dim, x, i, f, way);

  for (PetscInt a = 0; a < dim; a++) normal[a] = 0;
  for (PetscInt corner = 0; corner < 1 << dim; corner++) {
    PetscInt  at                      = 0;
    PetscReal weight[1 + MPM_MAX_DIM] = {1, 1, 1, 1}; /* of the value, and of its slopes */

    for (PetscInt a = 0; a < dim; a++) {
      const PetscBool right = corner >> a & 1 ? PETSC_TRUE : PETSC_FALSE;

      at = at * grid->n[a] + i[a] + right;
      for (PetscInt k = 0; k <= dim; k++)
        weight[k] *= k == a + 1 ? (right ? 1 : -1) / grid->spacing[a] : right ? f[a] : 1 - f[a];
    }
    d += weight[0] * grid->value[at];
    for (PetscInt a = 0; a < dim; a++) normal[a] += weight[1 + a] * grid->value[at];
  }
  for (PetscInt a = 0; a < dim && d > 0 && out > 0; a++)
    if (way[a] != 0) normal[a] = way[a] / out;
  size = sqrt(Dot(dim, normal, normal));
  for (PetscInt a = 0; a < dim; a++) normal[a] = size > 0 ? normal[a] / size : a == 0;
  return d > 0 ? d + out : d;
}

/*
   The outermost places on lines between nodes at which d is 0. A body that reaches the grid's edge goes on without an
   end.
*/
static void Extent(const MpmCollider *body, PetscInt dim, PetscReal lo[], PetscReal hi[])
{
  const MpmDistance *grid = body->grid;
  PetscInt           all  = 1;

  for (PetscInt a = 0; a < dim; a++) {
    lo[a] = PETSC_MAX_REAL;
    hi[a] = -PETSC_MAX_REAL;
    all *= grid->n[a];
  }
  for (PetscInt at = 0; at < all; at++) {
    if (grid->value[at] > 0) continue;
    for (PetscInt a = dim - 1, stride = 1; a >= 0; stride *= grid->n[a--]) {
      const PetscInt i = at / stride % grid->n[a];

      for (PetscInt side = -1; side <= 1; side += 2) {
        const PetscBool edge = i + side < 0 || i + side == grid->n[a] ? PETSC_TRUE : PETSC_FALSE;
        const PetscReal d = grid->value[at], next = edge ? d : grid->value[at + side * stride];
        const PetscReal part = next > 0 ? d / (d - next) : edge ? INFINITY : 0;
        const PetscReal x    = grid->origin[a] + grid->spacing[a] * (i + side * part);

        lo[a] = PetscMin(lo[a], x);
        hi[a] = PetscMax(hi[a], x);
      }
    }
  }
}

const MpmColliderShape MpmColliderDistance = {.name     = "distance",
                                              .summary  = "a signed distance on a grid, in an HDF5 file",
                                              .key      = {"path"},
                                              .holds    = {MPM_KEY_FILE},
                                              .distance = Distance,
                                              .extent   = Extent};
