/*
   Colliders: the signed distances of shapes, the contact conditions, and what the bodies of a scene do together.

   plane     the half space behind a plane through a point: d = (x - point) . normal
   sphere    a ball, with dim 2 a disc: d = |x - center| - radius. In its center the normal is along x.
   box       along the axes. With q_a = |x_a - center_a| - size_a / 2 the distance is max_a q_a inside, and |max(q, 0)|
             outside. Inside the normal is that of the nearest face.
   cylinder  a round bar with flat ends, from the middle of one end to that of the other; with dim 2 a rectangle of the
             width 2 radius, at any angle. With z and r the places along and across the axis, the distances from the
             ends and from the side are q_z = |z - l / 2| - l / 2 and q_r = r - radius, and those of the box in z and
             r follow.
   cone      from its tip on, around an axis, with an angle between axis and surface; with dim 2 a wedge. It has no end.
             With z = q . axis and r = |q - z axis|, q = x - tip, the distance from the nearest line of the surface is
             r cos a - z sin a, and that from the tip |q|, where the tip is nearest. On the axis the normal is against
             it, which favours no side.
   distance  a body whose signed distance d is known at the nodes of a grid of its own. Between the nodes d is linear
             along each direction, so off by spacing^2 / 8 times its second derivatives, and its normal, the gradient of
             that over its length, by spacing / 2 times them. Beyond the grid at x, with c its nearest point, it is
             d(c) + |x - c| where d(c) > 0; else d(c) with the normal at c: a body that reaches the grid's edge, as the
             ground does, goes on.
*/
#include <mpmstab/collider.h>
#include <math.h>

#define ON_SURFACE 1e-9 /* cells: nodes nearer to a surface are on it, and inside */

static PetscReal Dot(PetscInt dim, const PetscReal a[], const PetscReal b[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < dim; i++) sum += a[i] * b[i];
  return sum;
}

/* ---- shapes ---- */

static PetscReal PlaneDistance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  for (PetscInt a = 0; a < dim; a++) normal[a] = body->value[1][a];
  return Dot(dim, x, normal) - Dot(dim, body->value[0], normal);
}

static const MpmColliderShape plane = {.name     = "plane",
                                       .summary  = "the half space behind a plane; normal points away from it",
                                       .key      = {"point", "normal"},
                                       .holds    = {MPM_KEY_PLACE, MPM_KEY_DIRECTION},
                                       .distance = PlaneDistance};

static PetscReal SphereDistance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  PetscReal r;

  for (PetscInt a = 0; a < dim; a++) normal[a] = x[a] - body->value[0][a];
  r = sqrt(Dot(dim, normal, normal));
  for (PetscInt a = 0; a < dim; a++) normal[a] = r > 0 ? normal[a] / r : a == 0;
  return r - body->value[1][0];
}

static void SphereExtent(const MpmCollider *body, PetscInt dim, PetscReal lo[], PetscReal hi[])
{
  for (PetscInt a = 0; a < dim; a++) {
    lo[a] = body->value[0][a] - body->value[1][0];
    hi[a] = body->value[0][a] + body->value[1][0];
  }
}

static const MpmColliderShape sphere = {.name     = "sphere",
                                        .summary  = "a ball; with dim 2 a disc",
                                        .key      = {"center", "radius"},
                                        .holds    = {MPM_KEY_PLACE, MPM_KEY_SIZE},
                                        .distance = SphereDistance,
                                        .extent   = SphereExtent};

/*
   The distance from a body within n faces at right angles to one another: q[k] is that of face k, whose unit normal
   e[k] is outward. Inside the nearest face counts.
*/
static PetscReal FromFaces(PetscInt dim, PetscInt n, const PetscReal q[], PetscReal e[][MPM_MAX_DIM],
                           PetscReal normal[])
{
  PetscReal square = 0, out;
  PetscInt  face   = 0;

  for (PetscInt k = 0; k < n; k++) {
    square += PetscSqr(PetscMax(q[k], 0));
    if (q[k] > q[face]) face = k;
  }
  out = sqrt(square);
  for (PetscInt a = 0; a < dim; a++) {
    normal[a] = out > 0 ? 0 : e[face][a];
    for (PetscInt k = 0; k < n && out > 0; k++) normal[a] += PetscMax(q[k], 0) / out * e[k][a];
  }
  return out > 0 ? out : q[face];
}

static PetscReal BoxDistance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  PetscReal q[MPM_MAX_DIM], e[MPM_MAX_DIM][MPM_MAX_DIM] = {{0}};

  for (PetscInt a = 0; a < dim; a++) {
    const PetscReal from = x[a] - body->value[0][a];

    q[a]    = fabs(from) - body->value[1][a] / 2;
    e[a][a] = copysign(1, from);
  }
  return FromFaces(dim, dim, q, e, normal);
}

static void BoxExtent(const MpmCollider *body, PetscInt dim, PetscReal lo[], PetscReal hi[])
{
  for (PetscInt a = 0; a < dim; a++) {
    lo[a] = body->value[0][a] - body->value[1][a] / 2;
    hi[a] = body->value[0][a] + body->value[1][a] / 2;
  }
}

static const MpmColliderShape box = {.name     = "box",
                                     .summary  = "a box along the axes",
                                     .key      = {"center", "size"},
                                     .holds    = {MPM_KEY_PLACE, MPM_KEY_SIZES},
                                     .distance = BoxDistance,
                                     .extent   = BoxExtent};

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

static PetscReal CylinderDistance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
{
  PetscReal axis[MPM_MAX_DIM], from[MPM_MAX_DIM], e[2][MPM_MAX_DIM], q[2], length, z, r; /* the side, and an end */

  for (PetscInt a = 0; a < dim; a++) {
    axis[a] = body->value[1][a] - body->value[0][a];
    from[a] = x[a] - (body->value[0][a] + body->value[1][a]) / 2;
  }
  length = sqrt(Dot(dim, axis, axis));
  for (PetscInt a = 0; a < dim; a++) axis[a] /= length;
  z = Dot(dim, from, axis);
  for (PetscInt a = 0; a < dim; a++) {
    e[0][a] = from[a] - z * axis[a];
    e[1][a] = copysign(1, z) * axis[a];
  }
  r = sqrt(Dot(dim, e[0], e[0]));
  for (PetscInt a = 0; a < dim && r > 0; a++) e[0][a] /= r;
  if (!(r > 0)) Across(dim, axis, e[0]);
  q[0] = dim > 1 ? r - body->value[2][0] : -INFINITY;
  q[1] = fabs(z) - length / 2;
  return FromFaces(dim, 2, q, e, normal);
}

static void CylinderExtent(const MpmCollider *body, PetscInt dim, PetscReal lo[], PetscReal hi[])
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

static const MpmColliderShape cylinder = {.name     = "cylinder",
                                          .summary  = "a round bar with flat ends; with dim 2 a rectangle at any angle",
                                          .key      = {"from", "to", "radius"},
                                          .holds    = {MPM_KEY_PLACE, MPM_KEY_PLACE, MPM_KEY_SIZE},
                                          .distance = CylinderDistance,
                                          .extent   = CylinderExtent};

static PetscReal ConeDistance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
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

static const MpmColliderShape cone = {
    .name     = "cone",
    .summary  = "a cone around axis, from its tip on; angle: from axis to surface; with dim 2 a wedge",
    .key      = {"tip", "axis", "angle"},
    .holds    = {MPM_KEY_PLACE, MPM_KEY_DIRECTION, MPM_KEY_ANGLE},
    .distance = ConeDistance};

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

static PetscReal GridDistance(const MpmCollider *body, PetscInt dim, const PetscReal x[], PetscReal normal[])
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
static void GridExtent(const MpmCollider *body, PetscInt dim, PetscReal lo[], PetscReal hi[])
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

static const MpmColliderShape distance = {.name     = "distance",
                                          .summary  = "a signed distance on a grid, in an HDF5 file",
                                          .key      = {"path"},
                                          .holds    = {MPM_KEY_FILE},
                                          .distance = GridDistance,
                                          .extent   = GridExtent};

const MpmColliderShape *const MpmColliderShapes[] = {&plane, &sphere, &box, &cone, &cylinder, &distance, NULL};

/* ---- contact conditions ---- */

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

/* ---- bodies ---- */

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
