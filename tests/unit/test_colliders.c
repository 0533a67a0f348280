/*
   Shapes and contact conditions of colliders, at random places and velocities in one to three dimensions: the normal is the
   gradient of the distance and has length 1, the slope of a condition is its derivative, a body at rest never raises the
   velocity, and without friction sticky and slip are projections.
*/
#include "check.h"
#include <mpmstab/collider.h>
#include <math.h>
#include <stdlib.h>

#define TRIES 400
#define STEP 1e-5

static PetscReal Random(void)
{
  static PetscInt64 state = 1;

  state = (PetscInt64)(((unsigned long long)state * 6364136223846793005ull + 1442695040888963407ull) >> 1);
  return (PetscReal)(state % 1000003) / 1000003 - 0.5;
}

static PetscReal Size(PetscInt dim, const PetscReal v[])
{
  PetscReal sum = 0;

  for (PetscInt a = 0; a < dim; a++) sum += v[a] * v[a];
  return sqrt(sum);
}

/* A body with random numbers that are allowed. */
static MpmCollider Body(const MpmColliderShape *shape, PetscInt dim)
{
  MpmCollider body = {.shape = shape, .contact = MpmContacts[0]};

  for (PetscInt k = 0; shape->key[k]; k++) {
    for (PetscInt a = 0; a < dim; a++) body.value[k][a] = 2 * Random();
    for (PetscInt a = 0; a < dim && shape->holds[k] >= MPM_KEY_SIZES; a++) body.value[k][a] = 1 + Random();
  }
  if (shape->holds[1] == MPM_KEY_DIRECTION) {
    const PetscReal size = Size(dim, body.value[1]);

    for (PetscInt a = 0; a < dim; a++) body.value[1][a] /= size;
  }
  return body;
}

static void CheckShape(const MpmColliderShape *shape, PetscInt dim)
{
  for (int i = 0; i < TRIES; i++) {
    const MpmCollider body = Body(shape, dim);
    PetscReal         x[MPM_MAX_DIM], normal[MPM_MAX_DIM], other[MPM_MAX_DIM], found = 0;

    for (PetscInt a = 0; a < dim; a++) x[a] = 4 * Random();
    (void)shape->distance(&body, dim, x, normal);
    CHECK(fabs(Size(dim, normal) - 1) < 1e-12, "%s: a normal of length %.17g", shape->name, Size(dim, normal));
    for (PetscInt a = 0; a < dim; a++) {
      PetscReal d[2];

      for (int side = 0; side < 2; side++) {
        PetscReal at[MPM_MAX_DIM];

        for (PetscInt c = 0; c < dim; c++) at[c] = x[c] + (c == a ? (side ? STEP : -STEP) : 0);
        d[side] = shape->distance(&body, dim, at, other);
      }
      found = PetscMax(found, fabs((d[1] - d[0]) / (2 * STEP) - normal[a]));
    }
    CHECK(found < 1e-6, "%s, dim %d: the normal is off by %.3g", shape->name, (int)dim, found);
  }
}

static void CheckContact(const MpmContact *contact, PetscInt dim)
{
  for (int i = 0; i < TRIES; i++) {
    const PetscReal friction = i % 2 && contact->rubs ? 1 + Random() : 0;
    PetscReal       normal[MPM_MAX_DIM], v[MPM_MAX_DIM], y[MPM_MAX_DIM], again[MPM_MAX_DIM], slope[9], other[9], size,
        worst = 0;

    for (PetscInt a = 0; a < dim; a++) {
      normal[a] = Random();
      v[a] = y[a] = Random();
    }
    size = Size(dim, normal);
    for (PetscInt a = 0; a < dim; a++) normal[a] /= size;
    contact->project(friction, dim, normal, y, slope);
    CHECK(Size(dim, y) <= Size(dim, v) * (1 + 1e-15), "%s: |v| rises from %.17g to %.17g", contact->name, Size(dim, v),
          Size(dim, y));
    for (PetscInt a = 0; a < dim; a++) again[a] = y[a];
    contact->project(friction, dim, normal, again, other);
    for (PetscInt a = 0; a < dim; a++) CHECK(fabs(again[a] - y[a]) < 1e-14, "%s: acts a second time", contact->name);
    for (PetscInt c = 0; c < dim; c++) {
      PetscReal end[2][MPM_MAX_DIM];

      for (int side = 0; side < 2; side++) {
        for (PetscInt a = 0; a < dim; a++) end[side][a] = v[a] + (a == c ? (side ? STEP : -STEP) : 0);
        contact->project(friction, dim, normal, end[side], other);
      }
      for (PetscInt a = 0; a < dim; a++)
        worst = PetscMax(worst, fabs((end[1][a] - end[0][a]) / (2 * STEP) - slope[dim * a + c]));
    }
    CHECK(worst < 1e-5, "%s, dim %d, friction %g: the slope is off by %.3g", contact->name, (int)dim, friction, worst);
  }
}

/* The friction of a node that slides: t' = t (1 - mu |v_n| / |t|). A second body acts on what the first one leaves. */
static void CheckNumbers(void)
{
  MpmColliders    bodies = {.n    = 1,
                            .body = {{.shape    = MpmColliderShapes[0],
                                      .contact  = MpmContacts[2],
                                      .value    = {{0, 0}, {0, 1}},
                                      .friction = 0.5,
                                      .ntimes   = 1,
                                      .velocity = {{0, 0.1}},
                                      .pace     = 20}}};
  PetscReal       v[2]   = {1, -0.3}, slope[4];
  const PetscReal x[2]   = {0, 0.5};

  CHECK(!MpmCollidersProject(&bodies, 2, x, 0.2, v, slope), "the body is not there yet");
  CHECK(MpmCollidersProject(&bodies, 2, x, 0.3, v, slope), "the body is there");
  CHECK_NEAR(v[0], 1 - 0.5 * 0.4, 1e-15);
  CHECK_NEAR(v[1], 0.1, 1e-15);
  CHECK(!MpmCollidersAreLinear(&bodies), "separating is not linear");
  bodies.n       = 2;
  bodies.body[1] = (MpmCollider){.shape = MpmColliderShapes[0], .contact = MpmContacts[1], .value = {{1, 0}, {-1, 0}}};
  CHECK(MpmCollidersProject(&bodies, 2, (PetscReal[2]){2, -1}, 0, v, slope), "both are there");
  CHECK_NEAR(v[0], 0, 1e-15);
  CHECK_NEAR(slope[0], 0, 1e-15);
}

/* What a body of contact penalty gives a particle is against the gradient of its energy. Nodes do not feel it. */
static void CheckPush(const MpmColliderShape *shape, PetscInt dim)
{
  MpmColliders bodies = {.n = 1};
  PetscInt     pushed = 0;

  for (int i = 0; i < TRIES; i++) {
    PetscReal x[MPM_MAX_DIM], push[MPM_MAX_DIM] = {0}, v[MPM_MAX_DIM] = {1}, slope[9], worst = 0;

    bodies.body[0]           = Body(shape, dim);
    bodies.body[0].stiffness = 3;
    for (PetscInt c = 0; MpmContacts[c]; c++)
      if (MpmContacts[c]->pushes) bodies.body[0].contact = MpmContacts[c];
    for (PetscInt a = 0; a < dim; a++) x[a] = 2 * Random();
    pushed += MpmCollidersPush(&bodies, dim, x, 0, push) > 0;
    for (PetscInt a = 0; a < dim; a++) {
      PetscReal energy[2];

      for (int side = 0; side < 2; side++) {
        PetscReal at[MPM_MAX_DIM];

        for (PetscInt c = 0; c < dim; c++) at[c] = x[c] + (c == a ? (side ? STEP : -STEP) : 0);
        energy[side] = MpmCollidersPush(&bodies, dim, at, 0, NULL);
      }
      worst = PetscMax(worst, fabs((energy[1] - energy[0]) / (2 * STEP) + push[a]));
    }
    CHECK(worst < 1e-5, "%s, dim %d: the push is off by %.3g", shape->name, (int)dim, worst);
    CHECK(!MpmCollidersProject(&bodies, dim, x, 0, v, slope), "nodes feel a body that pushes particles");
  }
  CHECK(pushed > TRIES / 100, "%s, dim %d: %d particles were inside", shape->name, (int)dim, (int)pushed);
}

/* A velocity that rises, falls and stays: the way is its integral. */
static void CheckMotion(void)
{
  const MpmCollider body = {.ntimes = 3, .time = {0, 1, 1.5}, .velocity = {{0, 1}, {1, 1}, {-0.5, 1}}, .pace = 2};
  PetscReal         way[2], velocity[2];

  MpmColliderMotion(&body, 2, 1.25, way, velocity);
  CHECK_NEAR(velocity[0], 0.25, 1e-15);
  CHECK_NEAR(way[0], 2 * (0.5 + 0.25 * 0.625), 1e-15);
  MpmColliderMotion(&body, 2, 3, way, velocity);
  CHECK_NEAR(velocity[0], -0.5, 1e-15);
  CHECK_NEAR(way[0], 2 * (0.5 + 0.125 - 0.75), 1e-15);
  CHECK_NEAR(way[1], 2 * 3, 1e-15);
  CHECK(MpmColliderMoves(&body), "it moves");
}

/* A ball whose signed distance is known at nodes that are so far apart, between -2 and 2. */
static void Sample(const MpmCollider *ball, PetscInt dim, PetscReal spacing, MpmDistance *grid)
{
  PetscInt all = 1;

  for (PetscInt a = 0; a < dim; a++) {
    grid->n[a]       = (PetscInt)lrint(4 / spacing) + 1;
    grid->origin[a]  = -2;
    grid->spacing[a] = spacing;
    all *= grid->n[a];
  }
  grid->value = malloc((size_t)all * sizeof(PetscReal));
  for (PetscInt at = 0; at < all; at++) {
    PetscReal x[MPM_MAX_DIM], normal[MPM_MAX_DIM];

    for (PetscInt a = dim - 1, rest = at; a >= 0; rest /= grid->n[a--]) x[a] = -2 + spacing * (rest % grid->n[a]);
    grid->value[at] = ball->shape->distance(ball, dim, x, normal);
  }
}

/* A signed distance on a grid has the ball's distance to order 2, its normal to order 1, and its extent to order 2. */
static void CheckDistance(const MpmColliderShape *sphere, const MpmColliderShape *shape, PetscInt dim)
{
  const MpmCollider ball        = {.shape = sphere, .value = {{0.11, -0.07, 0.05}, {1.1}}};
  PetscReal         worst[3][3] = {{0}}, lo[2][MPM_MAX_DIM], hi[2][MPM_MAX_DIM];

  for (int level = 0; level < 3; level++) {
    MpmDistance       grid = {.value = NULL};
    const MpmCollider body = {.shape = shape, .grid = &grid};

    Sample(&ball, dim, 0.2 / (1 << level), &grid);
    for (int i = 0; i < 20 * TRIES; i++) {
      PetscReal x[MPM_MAX_DIM], n[2][MPM_MAX_DIM], d[2];

      for (PetscInt a = 0; a < dim; a++) x[a] = 3.6 * Random();
      d[0] = sphere->distance(&ball, dim, x, n[0]);
      d[1] = shape->distance(&body, dim, x, n[1]);
      if (d[0] < -0.6 || d[0] > 0.6) continue;
      worst[0][level] = PetscMax(worst[0][level], fabs(d[1] - d[0]));
      for (PetscInt a = 0; a < dim; a++) worst[1][level] = PetscMax(worst[1][level], fabs(n[1][a] - n[0][a]));
    }
    sphere->extent(&ball, dim, lo[0], hi[0]);
    shape->extent(&body, dim, lo[1], hi[1]);
    for (PetscInt a = 0; a < dim; a++)
      worst[2][level] = PetscMax(worst[2][level], PetscMax(fabs(lo[1][a] - lo[0][a]), fabs(hi[1][a] - hi[0][a])));
    free(grid.value);
  }
  for (int level = 0; level < 2; level++) {
    const PetscReal *d = worst[0] + level, *n = worst[1] + level, *e = worst[2] + level;

    if (dim == 1) CHECK(d[0] < 1e-12 && n[0] < 1e-12 && e[0] < 1e-12, "it is linear, and off by %g", d[0]);
    if (dim == 1) continue;
    CHECK(d[0] / d[1] > 3.2 && d[0] / d[1] < 5, "dim %d: the distance is off by %g, then %g", (int)dim, d[0], d[1]);
    CHECK(n[0] / n[1] > 1.6 && n[0] / n[1] < 2.6, "dim %d: the normal is off by %g, then %g", (int)dim, n[0], n[1]);
    CHECK(e[0] < 0.25 * 0.04 / (1 << 2 * level), "dim %d: the extent is off by %g", (int)dim, e[0]);
  }
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc, (void)argv;
  for (PetscInt dim = 1; dim <= MPM_MAX_DIM; dim++) {
    for (PetscInt s = 0; MpmColliderShapes[s]; s++) {
      if (MpmColliderShapes[s]->holds[0] == MPM_KEY_FILE)
        CheckDistance(MpmColliderShapes[1], MpmColliderShapes[s], dim);
      else
        CheckShape(MpmColliderShapes[s], dim);
    }
    for (PetscInt c = 0; MpmContacts[c]; c++)
      if (!MpmContacts[c]->pushes) CheckContact(MpmContacts[c], dim);
    for (PetscInt s = 0; MpmColliderShapes[s]; s++)
      if (MpmColliderShapes[s]->holds[0] != MPM_KEY_FILE) CheckPush(MpmColliderShapes[s], dim);
  }
  CheckNumbers();
  CheckMotion();
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
