/* The maps of bundles and of runs beside the rows of numbers of MpmMapRow: they are the same maps. */
#include "check.h"
#include "base/hash.h"
#include "scheme/bundles.h"
#include "scheme/lines.h"
#include "scheme/maps.h"

#define CELLS 6 /* along a direction, with nodes of 2 more cells on either side */
#define ACROSS (CELLS + 5)
#define MOST (ACROSS * ACROSS * ACROSS)
#define FIELDS 8
#define KINDS 3
#define WIDTH 0.25
#define NEAR 1e-13

static const MpmOpKind kinds[1 + KINDS] = {MPM_P2G, MPM_DIV, MPM_P2G_AFFINE, MPM_DIV_MLS};

/* The places of a cloud of particles along each direction. */
typedef struct {
  PetscInt  dim, cell[MPM_MAX_DIM][MPM_CLOUD];
  PetscReal xi[MPM_MAX_DIM][MPM_CLOUD], weight[MPM_MAX_DIM][1 + KINDS][MPM_MOST_NODES * MPM_CLOUD];
  MpmCloud  cloud;
} Cloud;

static void Place(const MpmBasis *basis, PetscInt dim, Cloud *c)
{
  PetscInt stride = 1;

  c->dim   = dim;
  c->cloud = (MpmCloud){.n = MPM_CLOUD, .dim = dim, .nodes = basis->nodes};
  for (PetscInt p = 0; p < MPM_CLOUD; p++) c->cloud.first[p] = 0;
  for (PetscInt a = 0; a < dim; a++, stride *= ACROSS) {
    MpmBlock block;

    for (PetscInt p = 0; p < MPM_CLOUD; p++) {
      c->cell[a][p] = 2 + (PetscInt)(CELLS * MpmHash(3 + a, p));
      c->xi[a][p]   = MpmHash(6 + a, p);
    }
    MpmBlockPlace(basis, MPM_CLOUD, c->cell[a], c->xi[a], WIDTH, MpmNoWalls, &block);
    for (PetscInt p = 0; p < MPM_CLOUD; p++) c->cloud.first[p] += stride * block.first[p];
    for (PetscInt k = 0; k <= KINDS; k++) {
      basis->weights[kinds[k]](&block, MPM_CLOUD, c->weight[a][k]);
      c->cloud.weight[a][k] = c->weight[a][k];
    }
    c->cloud.stride[a] = stride;
  }
}

/* Visits the nodes of a particle: returns the weight of the i-th, with the kind of a product along its direction. */
static PetscReal Weight(const MpmBasis *basis, const Cloud *c, PetscInt p, PetscInt product, PetscInt i, PetscInt *node)
{
  const PetscInt reach = MpmMapReach(basis), kind = product ? 1 + (product - 1) / c->dim : 0;
  PetscReal      weight = 1, row[MPM_MAX_REACH];

  *node = 0;
  for (PetscInt a = 0, stride = 1; a < c->dim; a++, stride *= ACROSS, i /= reach) {
    const PetscBool along = product && (product - 1) % c->dim == a ? PETSC_TRUE : PETSC_FALSE;

    MpmMapRow(basis, kinds[along ? kind : 0], c->xi[a][p], WIDTH, MpmNoWalls, row);
    weight *= row[i % reach];
    *node += stride * (c->cell[a][p] - basis->reach_left + i % reach);
  }
  return weight;
}

/* Both maps of a bundle, with so many of the kinds and fields. */
static void CheckBundle(const MpmBasis *basis, Cloud *c, PetscInt n, PetscInt width)
{
  static PetscReal node[MOST * FIELDS], sums[MOST * FIELDS], expected[MOST * FIELDS];
  static PetscReal product[MPM_MOST_PRODUCTS * MPM_CLOUD * FIELDS];
  const PetscInt   products = MPM_PRODUCTS(c->dim, n), nodes = c->dim == 2 ? ACROSS * ACROSS : MOST;
  PetscReal        off     = 0;
  PetscInt         stencil = 1;

  c->cloud.kinds = n;
  for (PetscInt a = 0; a < c->dim; a++) stencil *= MpmMapReach(basis);
  for (PetscInt i = 0; i < nodes * width; i++) {
    node[i] = MpmHash(20, i) - 0.5;
    sums[i] = expected[i] = 1;
  }
  MpmBundleMapFind(PETSC_FALSE, c->dim, basis->nodes, n, width)(&c->cloud, node, product);
  for (PetscInt p = 0; p < MPM_CLOUD; p++) {
    for (PetscInt k = 0; k < products; k++) {
      PetscReal found[FIELDS] = {0};

      for (PetscInt i = 0; i < stencil; i++) {
        PetscInt        at;
        const PetscReal w = Weight(basis, c, p, k, i, &at);

        for (PetscInt l = 0; l < width && w != 0; l++) {
          found[l] += w * node[width * at + l];
          expected[width * at + l] += w * (MpmHash(21, width * (MPM_CLOUD * k + p) + l) - 0.5);
        }
      }
      for (PetscInt l = 0; l < width; l++)
        off = PetscMax(off, PetscAbsReal(found[l] - product[width * (MPM_CLOUD * k + p) + l]));
    }
  }
  CHECK(off < NEAR, "%s, dim %d, %d kinds, %d fields: a gather is off by %g", basis->name, (int)c->dim, (int)n,
        (int)width, (double)off);
  for (PetscInt i = 0; i < products * MPM_CLOUD * width; i++) product[i] = MpmHash(21, i) - 0.5;
  MpmBundleMapFind(PETSC_TRUE, c->dim, basis->nodes, n, width)(&c->cloud, sums, product);
  off = 0;
  for (PetscInt i = 0; i < nodes * width; i++) off = PetscMax(off, PetscAbsReal(sums[i] - expected[i]));
  CHECK(off < NEAR * MPM_CLOUD, "%s, dim %d, %d kinds, %d fields: a spread is off by %g", basis->name, (int)c->dim,
        (int)n, (int)width, (double)off);
}

/* Runs of so many particles beside each by itself. first: of the particles in a cell, the one that a row begins with. */
static void CheckRuns(const MpmBasis *basis, PetscInt length, PetscInt first, MpmOpKind gather, MpmOpKind spread)
{
  enum { N = 23, NODES = N + 12 };
  const PetscReal factor[MPM_MOST_TARGETS] = {0.7, -0.2, 1.1};
  PetscInt        cell[N];
  PetscReal      *to[MPM_MOST_TARGETS];
  PetscReal       xi[N], weight[MPM_LONGEST_RUN * MPM_MOST_RUN_NODES], q[1 + MPM_MOST_TARGETS][N], node[2][NODES];
  PetscReal       each[MPM_MOST_NODES * N];
  MpmBlock        block;
  MpmRuns         runs;

  for (PetscInt p = 0; p < N; p++) {
    cell[p] = 4 + (first + p) / length;
    xi[p]   = ((first + p) % length + 0.51) / length;
    q[0][p] = MpmHash(8, p);
  }
  for (PetscInt i = 0; i < NODES; i++) node[0][i] = node[1][i] = MpmHash(9, i);
  MpmBlockPlace(basis, N, cell, xi, WIDTH, MpmNoWalls, &block);
  CHECK(MpmRunsFind(basis, &block, &runs), "%s: runs of %d are not found", basis->name, (int)length);
  MpmRunsWeights(basis, spread, &block, &runs, weight);
  basis->weights[gather](&block, N, each);
  MpmWeightsGather(&block, basis->nodes, N, each, 0.7, q[0], node[0]);
  for (PetscInt n = 1; n <= MPM_MOST_TARGETS; n++) {
    for (PetscInt t = 0; t < n; t++) {
      to[t] = q[1 + t];
      for (PetscInt p = 0; p < N; p++) to[t][p] = MpmHash(8, p);
    }
    MpmRunsGather(&block, &runs, basis->nodes, weight, n, factor, to, node[1]);
    for (PetscInt t = 0; t < n; t++)
      for (PetscInt p = 0; p < N; p++)
        CHECK_NEAR(MpmHash(8, p) + factor[t] / 0.7 * (q[0][p] - MpmHash(8, p)), to[t][p], NEAR);
  }
  basis->weights[spread](&block, N, each);
  MpmWeightsSpread(&block, basis->nodes, N, each, 0.3, q[0], node[0]);
  MpmRunsSpread(&block, &runs, basis->nodes, weight, 0.3, q[0], node[1]);
  for (PetscInt i = 0; i < NODES; i++) CHECK_NEAR(node[0][i], node[1][i], NEAR);
  xi[N - 1] += 1e-3;
  CHECK(!MpmRunsFind(basis, &block, &runs), "%s: runs of which one differs", basis->name);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static Cloud cloud;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (const MpmBasis *const *b = MpmBases; *b; b++) {
    const PetscBool hat = (*b)->hat; /* whose weights of mls are slopes, which MpmLineKind says */

    for (PetscInt dim = 2; dim <= 3; dim++) {
      Place(*b, dim, &cloud);
      for (PetscInt n = 0; n <= (hat ? 2 : KINDS); n++)
        for (PetscInt width = 4; width <= MpmBundleWidth(FIELDS); width += 4) CheckBundle(*b, &cloud, n, width);
    }
    if ((*b)->nodes > MPM_MOST_RUN_NODES) continue; /* has no runs */
    for (PetscInt length = 1; length <= MPM_LONGEST_RUN; length++) {
      for (PetscInt first = 0; first < length; first++) {
        CheckRuns(*b, length, first, MPM_G2P, MPM_P2G);
        CheckRuns(*b, length, first, MPM_GRAD, MPM_DIV);
        CheckRuns(*b, length, first, MPM_GRAD_MLS, MpmLineKind(*b, MPM_GRAD_MLS));
      }
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
