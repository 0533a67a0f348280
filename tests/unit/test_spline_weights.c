/*
   Splines next to walls, between two walls and next to one: partition of unity, linear reproduction, maps that are
   adjoint. Open splines against the recursion of de Boor; modified ones against mirrored ones whose node beyond the wall
   continues the last two in a straight line.
*/
#include "scheme/maps.h"
#include "check.h"

#define MOST_CELLS 7
#define MOST_NODES (MOST_CELLS + 3)
#define PLACES 33 /* in a cell, its left end among them */

/* The weights of all nodes of a direction for one kind of map, of a particle at xi in a cell. */
static void AllWeights(const MpmBasis *basis, const MpmDirection *direction, MpmOpKind kind, PetscInt cell,
                       PetscReal xi, PetscReal weight[MOST_NODES])
{
  PetscReal row[MPM_MAX_REACH];
  PetscInt  wall[2];

  MpmDirectionWalls(direction, cell, wall);
  MpmMapRow(basis, kind, xi, 0.25, wall, row);
  for (PetscInt i = 0; i < MOST_NODES; i++) weight[i] = 0;
  for (PetscInt d = 0; d < MpmMapReach(basis); d++) {
    const PetscInt node = cell - basis->reach_left + d;

    if (node >= 0 && node < direction->nodes)
      weight[node] = row[d];
    else
      CHECK(row[d] == 0, "%s: weight %g beyond a wall", basis->name, row[d]);
  }
}

/* Knot i of the open knot vector. */
static PetscReal Knot(PetscInt i, PetscInt degree, PetscInt cells)
{
  return PetscMin(PetscMax(i - degree, 0), cells);
}

/* de Boor's recursion for function i of a degree; the knots are those of the spline of degree full. */
static PetscReal Boor(PetscInt i, PetscInt degree, PetscInt full, PetscInt cells, PetscReal x)
{
  const PetscReal a = Knot(i, full, cells), b = Knot(i + degree, full, cells), c = Knot(i + 1, full, cells),
                  d = Knot(i + degree + 1, full, cells);
  PetscReal sum     = 0;

  if (degree == 0) return x >= a && x < d ? 1 : 0;
  if (b > a) sum += (x - a) / (b - a) * Boor(i, degree - 1, full, cells, x);
  if (d > c) sum += (d - x) / (d - c) * Boor(i + 1, degree - 1, full, cells, x);
  return sum;
}

static PetscReal BoorSlope(PetscInt i, PetscInt degree, PetscInt cells, PetscReal x)
{
  const PetscReal a = Knot(i, degree, cells), b = Knot(i + degree, degree, cells), c = Knot(i + 1, degree, cells),
                  d = Knot(i + degree + 1, degree, cells);

  return (b > a ? degree / (b - a) * Boor(i, degree - 1, degree, cells, x) : 0) -
         (d > c ? degree / (d - c) * Boor(i + 1, degree - 1, degree, cells, x) : 0);
}

/* The mean of a function's inner knots. */
static PetscReal Greville(PetscInt i, PetscInt degree, PetscInt cells)
{
  PetscReal sum = 0;

  for (PetscInt k = 1; k <= degree; k++) sum += Knot(i + k, degree, cells);
  return sum / degree;
}

static void CheckOpen(PetscInt degree, const MpmDirection *d, PetscReal x, const PetscReal phi[],
                      const PetscReal slope[])
{
  for (PetscInt i = 0; i < d->nodes; i++) {
    CHECK_NEAR(phi[i], Boor(i, degree, degree, d->cells, x), 1e-14);
    CHECK_NEAR(slope[i], BoorSlope(i, degree, d->cells, x), 1e-14);
  }
}

/* The mirrored basis with its weights beyond the walls given to the last two nodes. */
static void CheckModified(const MpmBasis *mirrored, const MpmDirection *direction, MpmOpKind kind, PetscInt cell,
                          PetscReal xi, const PetscReal weight[])
{
  PetscReal row[MPM_MAX_REACH], expected[MOST_NODES] = {0};

  MpmMapRow(mirrored, kind, xi, 0.25, MpmNoWalls, row);
  for (PetscInt d = 0; d < MpmMapReach(mirrored); d++) {
    const PetscInt node = cell - mirrored->reach_left + d, last = direction->nodes - 1;
    const PetscInt wall = node < 0 ? 0 : last, inner = node < 0 ? 1 : last - 1;

    if (node >= 0 && node <= last)
      expected[node] += row[d];
    else {
      expected[wall] += 2 * row[d];
      expected[inner] -= row[d];
    }
  }
  for (PetscInt i = 0; i < direction->nodes; i++) CHECK_NEAR(weight[i], expected[i], 1e-15);
}

/* What every map must do to constants and to the places of the nodes, at x. */
static void CheckMaps(const MpmBasis *basis, const MpmDirection *direction, PetscInt cell, PetscReal xi,
                      const PetscReal place[])
{
  static const struct {
    MpmOpKind kind;
    PetscReal constant, slope; /* of sum_i w_i and of sum_i w_i (x_i - x_p) */
  } maps[] = {{MPM_G2P, 1, 0}, {MPM_GRAD, 0, 1}, {MPM_GRAD_MLS, 0, 1}, {MPM_G2P_AFFINE, 0, 1}};
  static const MpmOpKind adjoint[][2] = {{MPM_G2P, MPM_P2G}, {MPM_GRAD, MPM_DIV}, {MPM_GRAD_MLS, MPM_DIV_MLS}};
  PetscReal              phi[MOST_NODES], w[MOST_NODES];

  for (int m = 0; m < 4; m++) {
    PetscReal constant = 0, slope = 0;

    AllWeights(basis, direction, maps[m].kind, cell, xi, w);
    for (PetscInt i = 0; i < direction->nodes; i++) {
      constant += w[i];
      slope += w[i] * (place[i] - cell - xi);
    }
    CHECK_NEAR(constant, maps[m].constant, 1e-11);
    CHECK_NEAR(slope, maps[m].slope, 1e-11);
  }
  for (int m = 0; m < 3; m++) {
    AllWeights(basis, direction, adjoint[m][0], cell, xi, phi);
    AllWeights(basis, direction, adjoint[m][1], cell, xi, w);
    for (PetscInt i = 0; i < direction->nodes; i++) CHECK_NEAR(phi[i], w[i], 1e-11);
  }
  AllWeights(basis, direction, MPM_G2P, cell, xi, phi);
  AllWeights(basis, direction, MPM_P2G_AFFINE, cell, xi, w);
  for (PetscInt i = 0; i < direction->nodes; i++) CHECK_NEAR(w[i], phi[i] * (place[i] - cell - xi), 1e-14);
}

static void CheckBasis(const MpmBasis *mirrored, PetscInt degree, MpmSplineEnds ends, PetscInt cells)
{
  const MpmBasis    *basis     = MpmBasisWithEnds(mirrored, ends);
  const MpmDirection direction = {.cells = cells, .nodes = cells + basis->wall_nodes, .ends = {MPM_FREE, MPM_FIXED}};
  PetscReal          place[MOST_NODES], phi[MOST_NODES], slope[MOST_NODES];

  CHECK(direction.nodes == (ends == MPM_SPLINES_OPEN ? cells + degree : cells + 1), "%d nodes", (int)direction.nodes);
  for (PetscInt i = 0; i < direction.nodes; i++) place[i] = ends == MPM_SPLINES_OPEN ? Greville(i, degree, cells) : i;
  for (PetscInt n = 0; n < cells * PLACES; n++) {
    const PetscInt  cell = n / PLACES;
    const PetscReal xi   = (PetscReal)(n % PLACES) / PLACES;

    CheckMaps(basis, &direction, cell, xi, place);
    AllWeights(basis, &direction, MPM_G2P, cell, xi, phi);
    AllWeights(basis, &direction, MPM_GRAD, cell, xi, slope);
    if (n == 0) CHECK_NEAR(phi[0], 1, 1e-15); /* the function of the wall's node is 1 there */
    if (ends == MPM_SPLINES_OPEN)
      CheckOpen(degree, &direction, cell + xi, phi, slope);
    else {
      CheckModified(mirrored, &direction, MPM_G2P, cell, xi, phi);
      CheckModified(mirrored, &direction, MPM_GRAD, cell, xi, slope);
    }
  }
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt degree = 2; degree <= 3; degree++)
    for (PetscInt cells = degree; cells <= MOST_CELLS; cells++)
      for (int ends = MPM_SPLINES_MODIFIED; ends <= MPM_SPLINES_OPEN; ends++)
        CheckBasis(MpmBasisFind(degree == 2 ? "quadratic" : "cubic"), degree, (MpmSplineEnds)ends, cells);
  CHECK(!MpmBasisWithEnds(MpmBasisFind("gimp"), MPM_SPLINES_OPEN), "gimp has open ends");
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
