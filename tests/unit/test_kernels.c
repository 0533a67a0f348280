/* The maps of THEORY.md, section 2 for each basis: identities that any basis must satisfy, and ties at nodes. */
#include "check.h"
#include <mpmstab/layout.h>

#define CELLS 20
#define N 97  /* particles, in no order */
#define PAD 4 /* nodes beyond the cells, to either side */

typedef struct {
  PetscInt  cell[N];
  PetscReal xi[N], q[N], node[CELLS + 2 * PAD], mass[CELLS + 2 * PAD];
} Cloud;

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

static void CheckConstants(const MpmBasis *basis)
{
  Cloud     c;
  PetscReal total = 0, sum = 0;

  Scatter(&c);
  basis->p2g_mass(N, c.cell, c.xi, c.q, c.node + PAD, c.mass + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) {
    total += c.mass[i];
    sum += c.node[i];
  }
  CHECK_NEAR(total, N, 1e-12); /* partition of unity: every particle gives its whole mass */
  for (PetscInt p = 0; p < N; p++) sum -= c.q[p];
  CHECK_NEAR(sum, 0, 1e-13);

  Scatter(&c);
  for (PetscInt p = 0; p < N; p++) c.q[p] = 1;
  basis->p2g_mass(N, c.cell, c.xi, c.q, c.node + PAD, c.mass + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) CHECK_NEAR(c.node[i], c.mass[i], 1e-14);
}

static void CheckAffine(const MpmBasis *basis)
{
  Cloud c;

  /* G2P reproduces 3 + 2x, GRAD gives 2 with a = 1 and h = 1; both add to what was there, times a */
  Scatter(&c);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) c.node[i] = 3 + 2.0 * (i - PAD);
  basis->g2p(N, c.cell, c.xi, 0.5, c.q, c.node + PAD);
  for (PetscInt p = 0; p < N; p++)
    CHECK_NEAR(c.q[p], MpmHash(5, p) - 0.5 + 0.5 * (3 + 2 * (c.cell[p] + c.xi[p])), 1e-13);
  Scatter(&c);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) c.node[i] = 3 + 2.0 * (i - PAD);
  basis->grad(N, c.cell, c.xi, 0.5, c.q, c.node + PAD);
  for (PetscInt p = 0; p < N; p++) CHECK_NEAR(c.q[p], MpmHash(5, p) - 0.5 + 0.5 * 2, 1e-13);
}

/* Undivided P2G is the adjoint of G2P: sum_i (P q)_i f_i = sum_p q_p (G f)_p. */
static void CheckAdjoint(const MpmBasis *basis)
{
  Cloud     a, b;
  PetscReal left = 0, right = 0;

  Scatter(&a);
  Scatter(&b);
  basis->p2g(N, a.cell, a.xi, 1, a.q, a.node + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) b.node[i] = MpmHash(6, i);
  memset(b.q, 0, sizeof b.q);
  basis->g2p(N, b.cell, b.xi, 1, b.q, b.node + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) left += a.node[i] * b.node[i];
  for (PetscInt p = 0; p < N; p++) right += a.q[p] * b.q[p];
  CHECK_NEAR(left, right, 1e-12);

  /* with and without masses it is the same sum */
  Scatter(&b);
  basis->p2g_mass(N, b.cell, b.xi, b.q, b.node + PAD, b.mass + PAD);
  for (PetscInt i = 0; i < CELLS + 2 * PAD; i++) CHECK_NEAR(a.node[i], b.node[i], 1e-14);
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
  const PetscReal f[5]   = {1, 4, 9, 16, 26};
  PetscReal       out[5] = {7, 7, 7, 7, 7};

  MpmNodeLaplacian(1, 4, 0.5, f, out);
  CHECK(out[0] == 7 && out[1] == 1 && out[2] == 1 && out[3] == 1.5 && out[4] == 7, "%g %g %g", out[1], out[2], out[3]);
  MpmNodeAdd(0, 2, f, out);
  CHECK(out[0] == 8 && out[1] == 5 && out[2] == 1, "%g %g %g", out[0], out[1], out[2]);
  CHECK_NEAR(MpmSumSquares(4, f), 1 + 16 + 81 + 256, 0);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt b = 0; MpmBases[b]; b++) {
    CheckConstants(MpmBases[b]);
    CheckAffine(MpmBases[b]);
    CheckAdjoint(MpmBases[b]);
  }
  CheckPlace();
  CheckNodes();
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
