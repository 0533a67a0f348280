/* The maps of docs/theory.md, section 2 for each basis: identities that any basis must satisfy, and ties at nodes. */
#include "scheme/kernels.h"
#include "check.h"
#include "scene/layout.h"

#define CELLS 20
#define N 97  /* particles, in no order */
#define PAD 8 /* nodes beyond the cells, to either side */

typedef struct {
  PetscInt  cell[N];
  PetscReal xi[N], q[N], node[CELLS + 2 * PAD], mass[CELLS + 2 * PAD];
} Cloud;

/* Places a block of particles. It holds until the next call. */
static const MpmBlock *At(const MpmBasis *basis, PetscInt n, const PetscInt cell[], const PetscReal xi[],
                          PetscReal width)
{
  static MpmBlock block;

  MpmBlockPlace(basis, n, cell, xi, width, MpmNoWalls, &block);
  return &block;
}

/* Runs a map of a kind: adds a times what particles give to nodes, or what they get from nodes. */
static void Map(const MpmBasis *basis, MpmOpKind kind, const MpmBlock *block, PetscReal a, PetscReal q[],
                PetscReal node[])
{
  static PetscReal weight[MPM_MOST_NODES * MPM_BLOCK];

  basis->weights[kind](block, MPM_BLOCK, weight);
  if (MpmOpTraitsOf(kind).dst == MPM_ON_NODES)
    MpmWeightsSpread(block, basis->nodes, MPM_BLOCK, weight, a, q, node);
  else
    MpmWeightsGather(block, basis->nodes, MPM_BLOCK, weight, a, q, node);
}

/* P2G, and the masses. */
static void MapMass(const MpmBasis *basis, const MpmBlock *block, PetscReal q[], PetscReal node[], PetscReal mass[])
{
  PetscReal ones[MPM_BLOCK];

  for (PetscInt p = 0; p < block->n; p++) ones[p] = 1;
  Map(basis, MPM_P2G, block, 1, q, node);
  Map(basis, MPM_P2G, block, 1, ones, mass);
}

static void Scatter(Cloud *c)
{
  for (PetscInt p = 0; p < N; p++) {
    c->cell[p] = (PetscInt)(CELLS * MpmHash(3, p));
    c->xi[p]   = p % 10 ? MpmHash(4, p) : 0; /* some sit on a node */
    c->q[p]    = MpmHash(5, p) - 0.5;
  }
  memset(c->node, 0, sizeof c->node);
  memset(c->mass, 0, sizeof c->mass);
}

static void CheckConstants(const MpmBasis *basis, PetscReal width)
{
  Cloud     c;
  PetscReal total = 0, sum = 0;

  Scatter(&c);
  MapMass(basis, At(basis, N, c.cell, c.xi, width), c.q, c.node + PAD, c.mass + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) {
    total += c.mass[i];
    sum += c.node[i];
  }
  CHECK_NEAR(total, N, 1e-12); /* partition of unity: a particle gives all of its mass to the nodes */
  for (PetscInt p = 0; p < N; p++) sum -= c.q[p];
  CHECK_NEAR(sum, 0, 1e-13);

  Scatter(&c);
  for (PetscInt p = 0; p < N; p++) c.q[p] = 1;
  MapMass(basis, At(basis, N, c.cell, c.xi, width), c.q, c.node + PAD, c.mass + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) CHECK_NEAR(c.node[i], c.mass[i], 1e-14);
}

static void CheckAffine(const MpmBasis *basis, PetscReal width)
{
  Cloud c;

  /* G2P reproduces 3 + 2x, and GRAD gives 2, with a = 1 and h = 1. Both add a times this to what was there. */
  Scatter(&c);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) c.node[i] = 3 + 2.0 * (i - PAD);
  Map(basis, MPM_G2P, At(basis, N, c.cell, c.xi, width), 0.5, c.q, c.node + PAD);
  for (PetscInt p = 0; p < N; p++)
    CHECK_NEAR(c.q[p], MpmHash(5, p) - 0.5 + 0.5 * (3 + 2 * (c.cell[p] + c.xi[p])), 1e-13);
  Scatter(&c);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) c.node[i] = 3 + 2.0 * (i - PAD);
  Map(basis, MPM_GRAD, At(basis, N, c.cell, c.xi, width), 0.5, c.q, c.node + PAD);
  for (PetscInt p = 0; p < N; p++) CHECK_NEAR(c.q[p], MpmHash(5, p) - 0.5 + 0.5 * 2, 1e-13);
}

/* Undivided P2G is the adjoint of G2P: sum_i (P q)_i f_i = sum_p q_p (G f)_p. */
static void CheckAdjoint(const MpmBasis *basis, PetscReal width)
{
  Cloud     a, b;
  PetscReal left = 0, right = 0;

  Scatter(&a);
  Scatter(&b);
  Map(basis, MPM_P2G, At(basis, N, a.cell, a.xi, width), 1, a.q, a.node + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) b.node[i] = MpmHash(6, i);
  memset(b.q, 0, sizeof b.q);
  Map(basis, MPM_G2P, At(basis, N, b.cell, b.xi, width), 1, b.q, b.node + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) left += a.node[i] * b.node[i];
  for (PetscInt p = 0; p < N; p++) right += a.q[p] * b.q[p];
  CHECK_NEAR(left, right, 1e-12);

  /* the sum is the same with and without masses */
  Scatter(&b);
  MapMass(basis, At(basis, N, b.cell, b.xi, width), b.q, b.node + PAD, b.mass + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) CHECK_NEAR(a.node[i], b.node[i], 1e-14);
}

/*
   GRAD and DIV are adjoint. The first moment vanishes: sum_i phi_ip (x_i - x_p) = 0. The affine part of 3 + 2x is 2
   (per cell), and the sum over the nodes of what P2G_AFFINE gives them for it is 0.
*/
static void CheckMoments(const MpmBasis *basis, PetscReal width)
{
  Cloud     a, b;
  PetscReal left = 0, right = 0, sum = 0;

  Scatter(&a);
  Scatter(&b);
  Map(basis, MPM_DIV, At(basis, N, a.cell, a.xi, width), 0.5, a.q, a.node + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) b.node[i] = MpmHash(6, i);
  memset(b.q, 0, sizeof b.q);
  Map(basis, MPM_GRAD, At(basis, N, b.cell, b.xi, width), 0.5, b.q, b.node + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) left += a.node[i] * b.node[i];
  for (PetscInt p = 0; p < N; p++) right += a.q[p] * b.q[p];
  CHECK_NEAR(left, right, 1e-12);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) sum += a.node[i];
  CHECK_NEAR(sum, 0, 1e-12); /* the gradients of all functions sum to 0 */

  Scatter(&a);
  Map(basis, MPM_P2G_AFFINE, At(basis, N, a.cell, a.xi, width), 1, a.q, a.node + PAD);
  for (PetscInt p = 0; p < N; p++) { /* phi by its definition, from G2P of a nodal field that is 1 at one node */
    for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) {
      PetscReal unit[CELLS + 2 * PAD] = {0}, phi = 0;

      unit[i] = 1;
      Map(basis, MPM_G2P, At(basis, 1, &a.cell[p], &a.xi[p], width), 1, &phi, unit + PAD);
      a.node[i] -= phi * a.q[p] * (i - PAD - a.cell[p] - a.xi[p]);
    }
  }
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) CHECK_NEAR(a.node[i], 0, 1e-13);

  Scatter(&a);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) a.node[i] = 3 + 2.0 * (i - PAD);
  Map(basis, MPM_G2P_AFFINE, At(basis, N, a.cell, a.xi, width), 0.5, a.q, a.node + PAD);
  for (PetscInt p = 0; p < N; p++) CHECK_NEAR(a.q[p], MpmHash(5, p) - 0.5 + 0.5 * 2, 1e-12);
}

/*
   For every basis phi is continuous, and the integral of its slope. The slope is continuous too, except for the hat,
   where the value at the node is that of the cell at the right.
*/
static void CheckContinuity(const MpmBasis *basis)
{
  const PetscInt  n    = 4000;
  const PetscReal step = 1.0 / n, width = 0.25;
  PetscReal       unit[2 * PAD + 1] = {0}, before = 0, slope_before = 0, integral = 0;

  unit[PAD] = 1;
  for (PetscInt i = 0; i <= 6 * n; i++) { /* from -3 to 3 cells of node 0 */
    const PetscInt  cell = i / n - 3;
    const PetscReal xi   = (PetscReal)(i % n) / n;
    PetscReal       phi = 0, slope = 0;

    Map(basis, MPM_G2P, At(basis, 1, &cell, &xi, width), 1, &phi, unit + PAD);
    Map(basis, MPM_GRAD, At(basis, 1, &cell, &xi, width), 1, &slope, unit + PAD);
    CHECK(fabs(phi - before) <= 1.01 * step, "%s: phi jumps from %g to %g at %g", basis->name, before, phi, cell + xi);
    if (!basis->hat)
      CHECK(fabs(slope - slope_before) <= 4.1 * step, "%s: slope jumps from %g to %g at %g", basis->name, slope_before,
            slope, cell + xi);
    integral += (basis->hat ? slope_before : (slope + slope_before) / 2) * step;
    CHECK(fabs(integral - phi) <= 1e-6, "%s: slopes sum to %g, phi is %g at %g", basis->name, integral, phi, cell + xi);
    before       = phi;
    slope_before = slope;
  }
}

#define ROWS MPM_BLOCK /* particles */

/* Checks particles in the order of their cells: all maps at once give the same as one particle at a time. */
static void CheckRuns(const MpmBasis *basis, const PetscInt counts[], PetscInt ncounts, PetscInt skip, PetscReal width)
{
  static const MpmOpKind kinds[] = {MPM_P2G, MPM_P2G_AFFINE, MPM_DIV, MPM_G2P, MPM_G2P_AFFINE, MPM_GRAD};
  PetscInt               cell[ROWS], p = 0;
  PetscReal              xi[ROWS], q[2][ROWS], node[2][ROWS + 2 * PAD], mass[2][ROWS + 2 * PAD] = {{0}};

  for (PetscInt c = 0; p < ROWS; c++) {
    const PetscInt count = counts[c % ncounts];

    for (PetscInt j = c ? 0 : skip; j < count && p < ROWS; j++, p++) { /* skip: of the first cell's particles */
      cell[p] = c;
      xi[p]   = (j + MpmHash(7, p)) / count;
    }
  }
  for (PetscInt k = 0; k < 6; k++) {
    for (PetscInt i = 0; i < ROWS; i++) q[0][i] = q[1][i] = MpmHash(8, i) - 0.5;
    for (PetscInt i = 0; i < ROWS + 2 * PAD; i++) node[0][i] = node[1][i] = MpmHash(9, i) - 0.5;
    Map(basis, kinds[k], At(basis, ROWS, cell, xi, width), 0.5, q[0], node[0] + PAD);
    for (p = 0; p < ROWS; p++)
      Map(basis, kinds[k], At(basis, 1, &cell[p], &xi[p], width), 0.5, &q[1][p], node[1] + PAD);
    for (PetscInt i = 0; i < ROWS + 2 * PAD; i++) CHECK_NEAR(node[0][i], node[1][i], 1e-14);
    for (p = 0; p < ROWS; p++) CHECK_NEAR(q[0][p], q[1][p], 1e-14 * fmax(1, fabs(q[1][p])));
  }
  MapMass(basis, At(basis, ROWS, cell, xi, width), q[0], node[0] + PAD, mass[0] + PAD);
  for (p = 0; p < ROWS; p++)
    MapMass(basis, At(basis, 1, &cell[p], &xi[p], width), &q[0][p], node[1] + PAD, mass[1] + PAD);
  for (PetscInt i = 0; i < ROWS + 2 * PAD; i++) {
    CHECK_NEAR(node[0][i], node[1][i], 1e-13 * fmax(1, fabs(node[1][i])));
    CHECK_NEAR(mass[0][i], mass[1][i], 1e-14 * fmax(1, fabs(mass[1][i])));
  }
}

static void CheckAllRuns(const MpmBasis *basis)
{
  static const PetscInt counts[][4] = {{1}, {2}, {3}, {4}, {5}, {2, 2, 2, 0}, {2, 0, 2, 2}, {1, 2}, {4, 4, 4, 3}, {17}};
  static const PetscInt ncounts[]   = {1, 1, 1, 1, 1, 4, 4, 2, 4, 1};

  for (PetscInt c = 0; c < 10; c++)
    for (PetscInt skip = 0; skip < counts[c][0]; skip++) CheckRuns(basis, counts[c], ncounts[c], skip, 0.2);
}

/* Checks two particles in the first cell, none in the next, and two in each later one. */
static void CheckGap(const MpmBasis *basis)
{
  PetscInt  cell[128];
  PetscReal xi[128], q[128], node[80] = {0}, sum = 0;

  for (PetscInt p = 0; p < 128; p++) {
    cell[p] = p / 2 + (p > 1);
    xi[p]   = p % 2 ? 0.75 : 0.25;
    q[p]    = 1;
    sum -= cell[p] + xi[p];
  }
  Map(basis, MPM_P2G, At(basis, 128, cell, xi, 0.25), 1, q, node + PAD);
  for (PetscInt i = 0; i < 80; i++) sum += (i - PAD) * node[i];
  CHECK_NEAR(sum, 0, 1e-11); /* linear reproduction: the sum is that of the places */
}

static void CheckPlace(void)
{
  const PetscInt  cell0[] = {0, 0, 5, 5, 7, 7};
  const PetscReal xi0[]   = {0, 0.75, 0.7, 0.25, 0.1, 1.0 / 3};
  const PetscReal part[]  = {0, 0.25, 0.3, 0.75, 0.95, 2.0 / 3};
  const PetscInt  cells[] = {0, 1, 6, 6, 8, 8};
  const PetscReal xis[]   = {0, 0, 0, 0, 0.05, 0};

  for (PetscInt p = 0; p < 6; p++) {
    PetscInt  cell;
    PetscReal xi;

    MpmPlaceBlock(1, &cell0[p], &xi0[p], 0, part[p], &cell, &xi);
    CHECK(cell == cells[p], "case %d: cell %d", p, cell);
    CHECK_NEAR(xi, xis[p], 1e-16 + (p == 4 ? 1e-15 : 0));
    CHECK(xi >= 0, "xi %g", xi);
    MpmPlaceBlock(1, &cell0[p], &xi0[p], -3, part[p], &cell, &xi);
    CHECK(cell == cells[p] - 3, "case %d: cell %d after -3", p, cell);
  }
}

static void CheckNodes(void)
{
  const PetscReal f[4]   = {1, 4, 9, 16};
  PetscReal       out[4] = {7, 1, 1, 1.5};

  MpmNodeAdd(0, 2, 2, f, out);
  CHECK(out[0] == 9 && out[1] == 9 && out[2] == 1, "%g %g %g", out[0], out[1], out[2]);
  MpmNodeCopy(1, 3, -1, f, out);
  CHECK(out[0] == 9 && out[1] == -4 && out[2] == -9 && out[3] == 1.5, "%g %g %g", out[0], out[1], out[2]);
  CHECK_NEAR(MpmSumSquares(4, f), 1 + 16 + 81 + 256, 0);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt b = 0; MpmBases[b]; b++) {
    CheckContinuity(MpmBases[b]);
    CheckAllRuns(MpmBases[b]);
    CheckGap(MpmBases[b]);
    for (PetscReal width = 0.5; width > 0.01; width /= 3) {
      CheckConstants(MpmBases[b], width);
      CheckAffine(MpmBases[b], width);
      CheckAdjoint(MpmBases[b], width);
      CheckMoments(MpmBases[b], width);
    }
  }
  CheckPlace();
  CheckNodes();
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
