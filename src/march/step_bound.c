/*
   Bounds of the largest eigenvalue lambda of M^-1 K, K = sum_p V_p E_p B_p^T C B_p, for the particles of a march.

   Split of the masses. Let theta_ip >= 0 and sum_p theta_ip = 1 at each node and component. Then K = sum_p K_p and
   M = sum_p theta_p M, so lambda <= max_p lambda_p, with lambda_p the largest eigenvalue of

     V_p E_p C^(1/2) [sum_i B_i B_i^T / (m_i theta_ip)] C^(1/2)

   of order d (d + 1) / 2. theta_ip = S_ip m_p / m_i makes each particle a lone one. theta_ip ~ u_p sqrt(V_p) abs(grad
   S_ip) takes one sum at each node. u = sqrt(V) is the bound 'particle', and u <- u lambda makes a better one in most
   layouts.

   Lanczos. k products with M^(-1/2) K M^(-1/2) from a random vector of norm 1 have coefficients alpha, beta. p_j is the
   polynomial with p_j(A) v_1 = v_(j+1). The part g of v_1 along the top eigenvector has abs(g p_k(lambda)) <= 1, and
   abs(g) < delta has a probability of at most delta sqrt(2 n / pi). So lambda <= the largest t with
   p_k(t) = sqrt(2 n / pi) / chance, but for that chance.

   Damping and viscosity take h = k e from a velocity, e at most the loss. Nothing grows in a step with flip where
   k^2 lambda + 2 h <= 4 (docs/floors.md).

   Source: docs/theory.md, section 4; van Dorsselaer, Hochstenbach and van der Vorst 1999 for the second.
*/
#include <mpmstab/step_bound.h>
#include "base/hash.h"
#include "march/stencils.h"
#include "scheme/bundles.h"
#include <math.h>

#define BISECTIONS 200
#define INVARIANT 1e-14 /* a beta so small beside alpha ends the products */
#define SWEEPS 40       /* of rotations */
#define SAME 1e-9       /* relative difference of particles that decide alike */
#define LANES 4         /* of the bundle of a velocity */

/* What a pass over the particles needs. */
typedef struct {
  MpmMarch        *march;
  MpmStencils      at;
  PetscInt         dim, components, own;
  const PetscReal *mass, *volume;
  PetscReal       *inverse, *sum[MPM_MAX_DIM]; /* local arrays of the nodes */
  PetscReal       *weight, *value, *stiffness; /* u, lambda and modulus of each particle */
  PetscReal        lambda, *lames; /* Lame's lambda over lambda + 2 mu; lames: of each particle, where they differ */
  PetscBool        loses; /* a particle has a slope at a node without mass: DIV is then not the adjoint of GRAD */
} Pass;

const char *MpmStepBoundWhyNot(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step)
{
  const MpmSpace    *space = &scheme->space;
  const MpmTransfer *t     = scheme->transfer;

  if (!scheme->formulation->step_bound) return "no bound is known for this formulation";
  if (scheme->formulation->step_bound(&scheme->numbers, scheme->transfer) == 0)
    return "no bound is known for this formulation with this transfer";
  if (isinf(scheme->formulation->step_bound(&scheme->numbers, scheme->transfer))) return "no step grows";
  if (space->local != 0) return "no bound is known with local damping";
  if ((space->collides || MpmSpaceIsDamped(space)) &&
      (!scheme->formulation->leftmost || t->filter || t->affine || t->sharpen ||
       scheme->formulation->step_bound(&scheme->numbers, t) != 2)) /* docs/floors.md has the theorem */
    return space->collides ? "with colliders no bound is proved for this scheme"
                           : "with damping or viscosity no bound is proved for this scheme";
  if (MpmSpaceIsPrestressed(space) || space->displaced) return "no bound is known about a prestressed state";
  if (MpmStepDrifts(step)) return "the bounds are of particles at rest";
  for (PetscInt a = 0; a < layout->dim; a++)
    for (int end = 0; end < 2; end++)
      if (layout->grid[a].ends[end] == MPM_FIXED_REACTION) return "no bound is known at walls that react";
  return NULL;
}

/* ---- passes over the particles ---- */

#define INLINE static inline __attribute__((always_inline))

static PetscReal Of(const PetscReal property[], PetscInt p)
{
  return property ? property[p] : 1;
}

/* Lame's moduli of a particle over lambda + 2 mu. */
typedef struct {
  PetscReal lambda, mu;
} Lame;

static Lame LameOf(const Pass *s, PetscInt p)
{
  const PetscReal lambda = s->lames ? s->lames[p] : s->lambda;

  return (Lame){lambda, (1 - lambda) / 2};
}

/* The norms of the slopes at the i-th nodes for a component. */
static void Norms(const Pass *s, PetscInt i, PetscInt c, PetscReal norm[])
{
  const PetscReal *g = s->at.g + (i * s->at.components + c) * s->dim * MPM_STENCILS;

  for (PetscInt q = 0; q < MPM_STENCILS; q++) norm[q] = 0;
  for (PetscInt b = 0; b < s->dim; b++) {
#pragma omp simd
    for (PetscInt q = 0; q < MPM_STENCILS; q++) norm[q] += PetscSqr(g[b * MPM_STENCILS + q]);
  }
#pragma omp simd
  for (PetscInt q = 0; q < MPM_STENCILS; q++) norm[q] = sqrt(norm[q]);
}

/*
   The sums over particles of u sqrt(V) abs(grad S), over the masses of the nodes. Without walls all components have the
   same.
*/
static PetscErrorCode Sum(Pass *s)
{
  const MpmGrid     *grid = s->march->grid;
  const MpmGridBox   box  = MpmGridBoxOf(grid, grid->ghost);
  const MpmStencils *c    = &s->at;
  PetscReal          norm[MPM_STENCILS], share[MPM_STENCILS];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < s->components; k++) PetscCall(MpmGridZero(grid, s->sum[k]));
  while (MpmStencilsNext(&s->at)) {
    for (PetscInt q = 0; q < c->n; q++) share[q] = s->weight[c->begin + q] * sqrt(Of(s->volume, c->begin + q));
    for (PetscInt i = 0; i < c->nodes; i++)
      for (PetscInt k = 0; k < s->components; k++) {
        if (k < c->components) Norms(s, i, k, norm);
        for (PetscInt q = 0; q < c->n; q++) s->sum[k][c->node[i * MPM_STENCILS + q]] += share[q] * norm[q];
      }
  }
  PetscCall(MpmGridSum(grid, s->components, s->sum));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscInt row = MpmGridRow(grid, &box, r);

    for (PetscInt k = 0; k < s->components; k++)
      for (PetscInt i = row + box.lo[0]; i < row + box.hi[0]; i++) s->sum[k][i] *= s->inverse[i];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- bounds by particles ---- */

/* The largest eigenvalue of a symmetric matrix, by Jacobi's rotations. */
static PetscReal Largest(PetscInt n, PetscReal A[MPM_MAX_STRESS][MPM_MAX_STRESS])
{
  PetscReal largest = 0;

  for (PetscInt sweep = 0, turned = 1; turned && sweep < SWEEPS; sweep++) {
    turned = 0;
    for (PetscInt p = 0; p < n; p++)
      for (PetscInt q = p + 1; q < n; q++) {
        const PetscReal beside = A[p][q], gap = (A[q][q] - A[p][p]) / 2, size = A[p][p] + A[q][q];
        PetscReal       t, c;

        if (!(fabs(beside) > PETSC_MACHINE_EPSILON / 8 * fabs(size))) continue;
        turned = 1;
        t      = beside / (gap + copysign(sqrt(gap * gap + beside * beside), gap));
        c      = 1 / sqrt(1 + t * t);
        for (PetscInt r = 0; r < n; r++) {
          const PetscReal x = A[r][p], y = A[r][q];

          A[r][p] = c * (x - t * y);
          A[r][q] = c * (t * x + y);
        }
        for (PetscInt r = 0; r < n; r++) {
          const PetscReal x = A[p][r], y = A[q][r];

          A[p][r] = c * (x - t * y);
          A[q][r] = c * (t * x + y);
        }
      }
  }
  for (PetscInt p = 0; p < n; p++) largest = fmax(largest, A[p][p]);
  return largest;
}

/*
   Adds times b b^T to a matrix, b = C^(1/2) of the strain g e_c, symmetric. Strains have the components 00, 11, 22 and
   then those beside the diagonal times sqrt(2), so that C is 2 mu and on 1, the strain without shape, 2 mu + d lambda.
*/
static void Add(PetscInt dim, Lame m, PetscInt c, const PetscReal g[], PetscReal times,
                PetscReal A[MPM_MAX_STRESS][MPM_MAX_STRESS])
{
  const PetscInt  n     = dim * (dim + 1) / 2;
  const PetscReal shear = sqrt(2 * m.mu), more = (sqrt(2 * m.mu + dim * m.lambda) - shear) / dim;
  PetscReal       b[MPM_MAX_STRESS] = {0};

  for (PetscInt a = 0; a < dim; a++) b[a] = more * g[c];
  b[c] += shear * g[c];
  for (PetscInt a = 0; a < dim; a++)
    if (a != c) b[dim + a + c - 1] = shear * g[a] * M_SQRT1_2;
  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) A[i][j] += times * b[i] * b[j];
}

/*
   The largest eigenvalue of C sym(. G) for all components' G. In the axes of G strains along them have the matrix
   2 mu G + lambda sqrt(G) sqrt(G)^T, and a shear has mu (G_a + G_b), which is no more (include/mpmstab_dt.h).
*/
static PetscReal Isotropic(PetscInt dim, Lame m, PetscReal G[MPM_MAX_STRESS][MPM_MAX_STRESS])
{
  PetscReal axis[MPM_MAX_DIM], T[MPM_MAX_STRESS][MPM_MAX_STRESS];

  (void)Largest(dim, G);
  for (PetscInt a = 0; a < dim; a++) axis[a] = sqrt(fmax(G[a][a], 0));
  for (PetscInt a = 0; a < dim; a++)
    for (PetscInt b = 0; b < dim; b++)
      T[a][b] = m.lambda * axis[a] * axis[b] + (a == b ? 2 * m.mu * axis[a] * axis[a] : 0);
  return Largest(dim, T);
}

/*
   What multiplies g g^T at the i-th nodes, for a component: 1 / S of a lone particle, or what the sum there is over
   abs(g). endless: a particle has a slope, and no weight.
*/
static void Times(Pass *s, PetscBool lone, PetscInt i, PetscInt k, PetscReal times[], PetscBool endless[])
{
  const PetscReal *S = s->at.S + i * MPM_STENCILS, *sum = s->sum[s->components == 1 ? 0 : k];
  const PetscInt  *node = s->at.node + i * MPM_STENCILS;
  PetscReal        norm[MPM_STENCILS];

  Norms(s, i, k, norm);
  if (lone)
    for (PetscInt q = 0; q < MPM_STENCILS; q++) {
      times[q] = S[q] > 0 ? 1 / S[q] : 0;
      if (norm[q] > 0 && !(S[q] > 0)) endless[q] = PETSC_TRUE;
    }
  else {
    for (PetscInt q = 0; q < MPM_STENCILS; q++) times[q] = sum[node[q]];
#pragma omp simd
    for (PetscInt q = 0; q < MPM_STENCILS; q++) times[q] = norm[q] > 0 ? times[q] / norm[q] : 0;
  }
  for (PetscInt q = 0; q < s->at.n && (lone || !s->at.inside); q++)
    if (norm[q] > 0 && s->inverse[node[q]] == 0) s->loses = PETSC_TRUE;
}

/*
   lambda of particles inside. The matrix of Isotropic has the trace of G, as lambda + 2 mu is 1, and squares of its
   eigenvalues whose sum is 4 mu (mu + lambda) tr G^2 + lambda^2 (tr G)^2. These bound its largest one (Wolkowicz and
   Styan 1980). A bound below least suffices.
*/
INLINE void ValuesInside(const PetscInt dim, Pass *s, PetscBool lone, const PetscReal factor[], PetscReal least)
{
  const MpmStencils *c                                         = &s->at;
  PetscReal          G[MPM_MAX_DIM][MPM_MAX_DIM][MPM_STENCILS] = {{{0}}}, times[MPM_STENCILS];
  PetscBool          endless[MPM_STENCILS]                     = {PETSC_FALSE};

  for (PetscInt i = 0; i < c->nodes; i++) {
    const PetscReal *g = c->g + i * dim * MPM_STENCILS;

    Times(s, lone, i, 0, times, endless);
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = a; b < dim; b++) {
#pragma omp simd
        for (PetscInt q = 0; q < MPM_STENCILS; q++)
          G[a][b][q] += times[q] * g[a * MPM_STENCILS + q] * g[b * MPM_STENCILS + q];
      }
  }
  for (PetscInt q = 0; q < c->n; q++) {
    const Lame m = LameOf(s, c->begin + q);
    PetscReal  A[MPM_MAX_STRESS][MPM_MAX_STRESS], square = 0, trace = 0, *value = s->value + c->begin + q;

    for (PetscInt a = 0; a < dim; a++) {
      trace += G[a][a][q];
      for (PetscInt b = 0; b < dim; b++) {
        A[a][b] = G[PetscMin(a, b)][PetscMax(a, b)][q];
        square += A[a][b] * A[a][b];
      }
    }
    square = 4 * m.mu * (m.mu + m.lambda) * square + m.lambda * m.lambda * trace * trace;
    square = fmax(square - trace * trace / dim, 0) * (dim - 1) / dim;
    *value = factor[q] * (trace / dim + sqrt(square));
    if (*value > least || isnan(*value)) *value = factor[q] * Isotropic(dim, m, A);
    if (endless[q]) *value = INFINITY;
  }
}

/* lambda of particles at walls. */
static void ValuesAtWall(Pass *s, PetscBool lone, const PetscReal factor[])
{
  const MpmStencils *c = &s->at;
  PetscReal          times[MPM_STENCILS], A[MPM_STENCILS][MPM_MAX_STRESS][MPM_MAX_STRESS] = {{{0}}};
  PetscBool          endless[MPM_STENCILS] = {PETSC_FALSE};

  for (PetscInt i = 0; i < c->nodes; i++)
    for (PetscInt k = 0; k < s->dim; k++) {
      Times(s, lone, i, k, times, endless);
      for (PetscInt q = 0; q < c->n; q++) {
        PetscReal g[MPM_MAX_DIM];

        if (times[q] == 0) continue;
        for (PetscInt b = 0; b < s->dim; b++) g[b] = c->g[((i * s->dim + k) * s->dim + b) * MPM_STENCILS + q];
        Add(s->dim, LameOf(s, c->begin + q), k, g, times[q], A[q]);
      }
    }
  for (PetscInt q = 0; q < c->n; q++)
    s->value[c->begin + q] = endless[q] ? INFINITY : factor[q] * Largest(s->dim * (s->dim + 1) / 2, A[q]);
}

/*
   lambda of particles: alone, or with the split that the sums at the nodes are of. Of a split, those are not
   found that are below least.
*/
static void Values(Pass *s, PetscBool lone, PetscReal least)
{
  const MpmStencils *c                    = &s->at;
  PetscReal          factor[MPM_STENCILS] = {0};

  for (PetscInt q = 0; q < c->n; q++) {
    const PetscInt p = c->begin + q;

    factor[q] = s->stiffness[p] * (lone ? Of(s->volume, p) / Of(s->mass, p) : sqrt(Of(s->volume, p)) / s->weight[p]);
  }
  if (c->components == 1)
    s->dim == 1   ? ValuesInside(1, s, lone, factor, least)
    : s->dim == 2 ? ValuesInside(2, s, lone, factor, least)
                  : ValuesInside(3, s, lone, factor, least);
  else
    ValuesAtWall(s, lone, factor);
}

/*
   The largest value of all particles, and where it is: the one with the least id of several that are alike but for
   rounding.
*/
static PetscErrorCode Decide(Pass *s, PetscReal *most, MpmDecider *at)
{
  const MpmMarch   *march = s->march;
  const MPI_Comm    comm  = PetscObjectComm((PetscObject)march->grid->da);
  const PetscInt64 *id    = s->at.at.id;
  PetscInt          mine  = MPM_NONE;

  PetscFunctionBegin;
  *most = 0;
  for (PetscInt p = 0; p < march->particles->count; p++)
    if (s->value[p] > *most) *most = s->value[p]; /* fmax is a call here */
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, most, 1, MPIU_REAL, MPI_MAX, comm));
  for (PetscInt p = 0; at->value && p < march->particles->count; p++) at->value[id[p]] = s->value[p];
  at->id = PETSC_MAX_INT;
  for (PetscInt p = 0; p < march->particles->count; p++)
    if (s->value[p] >= *most * (1 - SAME) && id[p] < at->id) {
      at->id = id[p];
      mine   = p;
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &at->id, 1, MPIU_INT64, MPI_MIN, comm));
  for (PetscInt a = 0; a < s->dim; a++) {
    PetscInt  in;
    PetscReal xi;

    at->place[a] = -INFINITY;
    if (mine == MPM_NONE || id[mine] != at->id) continue;
    MpmMarchPlaces(&s->at.at, a, 1, &s->at.at.cell[a][mine], &s->at.at.xi[a][mine], 0, &in, &xi);
    at->place[a] = in + march->grid->axis[a].first + xi;
    if (march->grid->axis[a].periodic) /* particles may be in a rank's ghost cells */
      at->place[a] -= march->grid->axis[a].cells * floor(at->place[a] / march->grid->axis[a].cells);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, at->place, (PetscMPIInt)s->dim, MPIU_REAL, MPI_MAX, comm));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindLone(Pass *s, MpmStepBounds *b)
{
  PetscReal most;

  PetscFunctionBegin;
  while (MpmStencilsNext(&s->at)) Values(s, PETSC_TRUE, 0);
  PetscCall(Decide(s, &most, &b->lone_at));
  b->lone = b->factor / sqrt(most);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Without sweeps, a particle that cannot decide needs no number of its own. */
static PetscErrorCode FindByParticle(Pass *s, MpmStepBounds *b)
{
  const PetscInt count = s->march->particles->count;
  PetscReal      most;
  MpmDecider     at = {.value = NULL};

  PetscFunctionBegin;
  for (PetscInt sweep = 0; sweep <= b->sweeps; sweep++) {
    PetscCall(Sum(s));
    most = 0;
    while (MpmStencilsNext(&s->at)) {
      Values(s, PETSC_FALSE, b->sweeps || b->particle_at.value ? 0 : most * (1 - 2 * SAME));
      for (PetscInt q = 0; q < s->at.n; q++)
        if (s->value[s->at.begin + q] > most) most = s->value[s->at.begin + q];
    }
    PetscCall(Decide(s, &most, sweep ? &at : &b->particle_at));
    if (!sweep) b->particle = b->swept = b->factor / sqrt(most);
    b->swept = fmax(b->swept, b->factor / sqrt(most));
    for (PetscInt p = 0; p < count; p++) s->weight[p] *= s->value[p] / most;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the certificate ---- */

/*
   Products with K: as a pass of the fast march, with the velocity and the force of a node as bundles
   (scheme/bundles.h).

   node, force - of all local nodes; product: of a cloud's particles, L_kb of lane k at product 1 + b, and then the
                 stress
   scale       - M^(-1/2) of each of this rank's unknowns, 0 where a wall fixes it; scaled: M^(-1/2) x
   gather, spread - the maps. In one dimension there is a second direction, without an extent
*/
typedef struct {
  PetscReal   *node, *force, product[LANES * MPM_CLOUD * (1 + MPM_MAX_DIM)], *scale, *scaled;
  PetscReal    weight[MPM_MAX_DIM][2][MPM_MOST_NODES * MPM_CLOUD];
  MpmBundleMap gather, spread;
  MpmCloud     cloud;
} Products;

/* The nodes and weights of n particles from begin on. */
static void PlaceCloud(Pass *s, PetscInt begin, PetscInt n, Products *k)
{
  const MpmMarch *march = s->march;
  const MpmBasis *basis = march->scheme->basis;

  k->cloud.n = n;
  for (PetscInt p = 0; p < n; p++) k->cloud.first[p] = 0;
  for (PetscInt a = 0; a < s->dim; a++) {
    PetscInt  cell[MPM_CLOUD], wall[2];
    PetscReal xi[MPM_CLOUD];
    MpmBlock  block;

    MpmMarchPlaces(&s->at.at, a, n, s->at.at.cell[a] + begin, s->at.at.xi[a] + begin, 0, cell, xi);
    MpmDirectionWalls(&march->layout->grid[a], march->grid->axis[a].first, wall);
    MpmBlockPlace(basis, n, cell, xi, march->layout->half_width[a], wall, &block);
    basis->weights[MPM_P2G](&block, MPM_CLOUD, k->weight[a][0]);
    basis->weights[s->at.slopes.kind](&block, MPM_CLOUD, k->weight[a][1]);
    for (PetscInt p = 0; p < n; p++) k->cloud.first[p] += march->grid->axis[a].stride * block.first[p];
  }
}

/* The stresses of particles, made of the slopes of their velocities. */
INLINE void Stress(const PetscInt dim, const Pass *s, PetscInt begin, PetscInt n, PetscReal product[])
{
  for (PetscInt p = 0; p < n; p++) {
    const PetscReal modulus = s->stiffness[begin + p] * Of(s->volume, begin + p);
    const Lame      m       = LameOf(s, begin + p);
    PetscReal      *at[1 + MPM_MAX_DIM], L[MPM_MAX_DIM][MPM_MAX_DIM], trace = 0;

    for (PetscInt c = 0; c <= MPM_MAX_DIM; c++) at[c] = product + LANES * (MPM_CLOUD * c + p);
    for (PetscInt k = 0; k < LANES; k++) at[0][k] = 0;
    for (PetscInt k = 0; k < dim; k++) {
      for (PetscInt b = 0; b < dim; b++) L[k][b] = at[1 + b][k];
      trace += L[k][k];
    }
    for (PetscInt k = 0; k < dim; k++)
      for (PetscInt b = 0; b < dim; b++)
        at[1 + b][k] = modulus * (m.mu * (L[k][b] + L[b][k]) + (k == b ? m.lambda * trace : 0));
  }
}

static PetscErrorCode CreateProducts(Pass *s, Products *k)
{
  const MpmGrid   *grid  = s->march->grid;
  const PetscInt   nodes = s->march->scheme->basis->nodes, size = LANES * MpmGridSize(grid), dim = PetscMax(s->dim, 2);
  const MpmGridBox box = MpmGridBoxOf(grid, 0);
  PetscInt         n   = 0;

  PetscFunctionBegin;
  *k = (Products){.gather = MpmBundleMapFind(PETSC_FALSE, dim, nodes, 1, LANES),
                  .spread = MpmBundleMapFind(PETSC_TRUE, dim, nodes, 1, LANES),
                  .cloud  = {.dim = dim, .nodes = nodes, .kinds = 1}};
  for (PetscInt a = 0; a < MPM_MAX_DIM; a++) {
    k->cloud.stride[a] = a < s->dim ? grid->axis[a].stride : 0;
    for (PetscInt kind = 0; kind < 2; kind++) k->cloud.weight[a][kind] = k->weight[a][kind];
    for (PetscInt p = 0; p < MPM_CLOUD; p++) k->weight[a][0][p] = 1;
  }
  PetscCall(PetscCalloc4(size, &k->node, size, &k->force, s->own, &k->scale, s->own, &k->scaled));
  for (PetscInt c = 0; c < s->dim; c++)
    for (PetscInt r = 0; r < MpmGridRows(&box); r++)
      for (PetscInt i = 0; i < box.hi[0]; i++, n++) {
        const PetscInt at[MPM_MAX_DIM] = {grid->axis[0].first + i, grid->axis[1].first + r % box.hi[1],
                                          grid->axis[2].first + r / box.hi[1]};

        k->scale[n] = MpmSlopesFix(&s->at.slopes, c, at) ? 0 : sqrt(s->inverse[MpmGridRow(grid, &box, r) + i]);
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* y = M^(-1/2) K M^(-1/2) x */
static PetscErrorCode Multiply(Pass *s, Products *k, const PetscReal x[], PetscReal y[])
{
  const MpmGrid      *grid      = s->march->grid;
  const MpmDirection *direction = s->march->layout->grid;
  const PetscInt      size = MpmGridSize(grid), own = MpmGridNodes(grid), count = s->march->particles->count;

  PetscFunctionBegin;
  for (PetscInt i = 0; i < s->own; i++) k->scaled[i] = k->scale[i] * x[i];
  for (PetscInt c = 0; c < s->dim; c++) PetscCall(MpmGridCopy(grid, PETSC_FALSE, 1, k->scaled + c * own, s->sum[c]));
  PetscCall(MpmGridSum(grid, s->dim, s->sum));
  for (PetscInt c = 0; c < s->dim; c++) {
    MpmGridImages(grid, direction, s->at.slopes.parity[c], PETSC_FALSE, s->sum[c]);
    for (PetscInt i = 0; i < size; i++) k->node[LANES * i + c] = s->sum[c][i - grid->origin];
  }
  PetscCall(PetscArrayzero(k->force, LANES * size));
  for (PetscInt begin = 0; begin < count; begin += MPM_CLOUD) {
    const PetscInt n = PetscMin(MPM_CLOUD, count - begin);

    PlaceCloud(s, begin, n, k);
    k->gather(&k->cloud, k->node + LANES * grid->origin, k->product);
    s->dim == 1   ? Stress(1, s, begin, n, k->product)
    : s->dim == 2 ? Stress(2, s, begin, n, k->product)
                  : Stress(3, s, begin, n, k->product);
    k->spread(&k->cloud, k->force + LANES * grid->origin, k->product);
  }
  for (PetscInt c = 0; c < s->dim; c++) {
    for (PetscInt i = 0; i < size; i++) s->sum[c][i - grid->origin] = k->force[LANES * i + c];
    MpmGridImages(grid, direction, s->at.slopes.parity[c], PETSC_TRUE, s->sum[c]);
  }
  PetscCall(MpmGridSum(grid, s->dim, s->sum));
  for (PetscInt c = 0; c < s->dim; c++) PetscCall(MpmGridCopy(grid, PETSC_TRUE, 1, y + c * own, s->sum[c]));
  for (PetscInt i = 0; i < s->own; i++) y[i] *= k->scale[i];
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Dot(const Pass *s, const PetscReal x[], const PetscReal y[], PetscReal *dot)
{
  PetscFunctionBegin;
  *dot = 0;
  for (PetscInt i = 0; i < s->own; i++) *dot += x[i] * y[i];
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, dot, 1, MPIU_REAL, MPI_SUM, PetscObjectComm((PetscObject)s->march->grid->da)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Normal random numbers by the numbers of the nodes, at those with mass. n: how many in all. */
static PetscErrorCode Random(const Pass *s, PetscInt64 seed, PetscReal x[], PetscInt64 *n)
{
  const MpmGrid   *grid = s->march->grid;
  const MpmGridBox box  = MpmGridBoxOf(grid, 0);
  PetscInt         at   = 0;

  PetscFunctionBegin;
  *n = 0;
  for (PetscInt c = 0; c < s->dim; c++)
    for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
      const PetscInt rows[MPM_MAX_DIM] = {0, box.hi[1] > 0 ? r % box.hi[1] : 0, box.hi[1] > 0 ? r / box.hi[1] : 0};

      for (PetscInt i = 0; i < box.hi[0]; i++, at++) {
        PetscInt64 number = 0;

        for (PetscInt a = s->dim - 1; a >= 0; a--)
          number = number * grid->axis[a].all + grid->axis[a].first + (a ? rows[a] : i);
        number = 2 * (number * s->dim + c);
        x[at]  = 0;
        if (s->inverse[MpmGridRow(grid, &box, r) + i] == 0) continue;
        x[at] = sqrt(-2 * log1p(-MpmHash(seed, number))) * cos(2 * PETSC_PI * MpmHash(seed, number + 1));
        ++*n;
      }
    }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, n, 1, MPIU_INT64, MPI_SUM, PetscObjectComm((PetscObject)grid->da)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   log p_k(t) by the ratios of p_j to p_(j-1); -infinite below the largest Ritz value, where one of them is not
   positive.
*/
static PetscReal LogPolynomial(PetscInt k, const PetscReal alpha[], const PetscReal beta[], PetscReal t)
{
  PetscReal sum = 0, ratio = INFINITY;

  for (PetscInt j = 0; j < k; j++) {
    const PetscReal above = t - alpha[j] - (j ? beta[j - 1] / ratio : 0);

    if (!(above > 0)) return -INFINITY;
    ratio = above / beta[j];
    sum += log(ratio);
  }
  return sum;
}

/* The largest t with log p_k(t) = log_value. */
static PetscReal Invert(PetscInt k, const PetscReal alpha[], const PetscReal beta[], PetscReal log_value)
{
  PetscReal lo = 0, hi = 0;

  for (PetscInt j = 0; j < k; j++) hi = fmax(hi, alpha[j] + beta[j]);
  while (hi > 0 && !(LogPolynomial(k, alpha, beta, hi) > log_value)) hi *= 2;
  for (PetscInt i = 0; i < BISECTIONS && lo < hi; i++) {
    const PetscReal middle = lo + (hi - lo) / 2;

    if (LogPolynomial(k, alpha, beta, middle) > log_value)
      hi = middle;
    else
      lo = middle;
    if (middle == lo && middle == hi) break;
  }
  return hi;
}

static PetscErrorCode FindByLanczos(Pass *s, MpmStepBounds *b)
{
  PetscReal  alpha[MPM_STEP_BOUND_PRODUCTS], beta[MPM_STEP_BOUND_PRODUCTS], *x, *y, *before, norm;
  PetscInt64 n;
  PetscInt   k = 0;
  Products   products;

  PetscFunctionBegin;
  PetscCall(CreateProducts(s, &products));
  PetscCall(PetscCalloc3(s->own, &x, s->own, &y, s->own, &before));
  PetscCall(Random(s, b->seed, x, &n));
  PetscCall(Dot(s, x, x, &norm));
  for (PetscInt i = 0; i < s->own; i++) x[i] /= sqrt(norm);
  while (k < MPM_STEP_BOUND_PRODUCTS) {
    PetscCall(Multiply(s, &products, x, y));
    for (PetscInt i = 0; i < s->own && k; i++) y[i] -= beta[k - 1] * before[i];
    PetscCall(Dot(s, x, y, &alpha[k]));
    for (PetscInt i = 0; i < s->own; i++) y[i] -= alpha[k] * x[i];
    PetscCall(Dot(s, y, y, &norm));
    beta[k++] = sqrt(norm);
    if (!(beta[k - 1] > INVARIANT * alpha[0])) break;
    for (PetscInt i = 0; i < s->own; i++) {
      before[i] = x[i];
      x[i]      = y[i] / beta[k - 1];
    }
  }
  PetscCall(PetscFree3(x, y, before));
  PetscCall(PetscFree4(products.node, products.force, products.scale, products.scaled));
  if (beta[k - 1] == 0) beta[k - 1] = PETSC_MACHINE_EPSILON * alpha[0];
  b->nodes    = n;
  b->products = k;
  b->lanczos  = b->factor / sqrt(Invert(k, alpha, beta, 0.5 * log(2 * (PetscReal)n / PETSC_PI) - log(b->chance)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- all of them ---- */

/* lambda / (lambda + 2 mu) at rest is nu / (1 - nu); material: that at finite deformation. */
static PetscReal LambdaOf(const MpmSpace *space, const MpmMaterialNumbers *material)
{
  if (space->dim == 1) return 0;
  if (space->finite) return material->law->solid ? material->lambda : 1;
  return space->poisson / (1 - space->poisson);
}

/* Lambda of each particle, where they are of several materials, or Poisson's ratio varies. */
static PetscErrorCode FindLames(Pass *s)
{
  const MpmTable  *t     = s->march->scheme->table;
  const PetscInt   count = s->march->particles->count;
  const PetscReal *own   = s->at.at.weight[MPM_LAMBDA];

  PetscFunctionBegin;
  if (!t->material.several && !own) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(count, &s->lames));
  for (PetscInt p = 0; p < count; p++)
    s->lames[p] = own ? own[p] / s->at.at.weight[MPM_STIFFNESS][p]
                      : LambdaOf(&s->march->scheme->space,
                                 MpmMaterialAt(&t->material, s->dim,
                                               (const PetscReal *const *)s->at.at.particle + t->stretch, p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What K is made of: the moduli of now; or of all particles the squares of tr D, or those of D. */
typedef enum { OF_MODULI, OF_VOLUME, OF_RATE } Form;

static PetscErrorCode Begin(MpmMarch *march, const MpmStepBounds *b, Form form, Pass *s)
{
  const MpmSpace *space  = &march->scheme->space;
  const PetscInt  count  = march->particles->count;
  const PetscReal lambda = form == OF_MODULI ? LambdaOf(space, &space->material) : form == OF_VOLUME ? 1 : 0;

  PetscFunctionBegin;
  *s = (Pass){.march      = march,
              .dim        = space->dim,
              .components = MpmLayoutIsPeriodic(march->layout) ? 1 : space->dim,
              .own        = space->dim * MpmGridNodes(march->grid),
              .lambda     = lambda};
  PetscCall(MpmStencilsCreate(march, march->particles->step, &s->at));
  if (form == OF_MODULI) PetscCall(FindLames(s));
  PetscCall(PetscMalloc3(count, &s->weight, count, &s->value, count, &s->stiffness));
  s->mass    = s->at.at.weight[MPM_MASS];
  s->volume  = s->at.at.weight[MPM_VOLUME];
  s->inverse = s->at.at.sum[MPM_MASSES];
  for (PetscInt p = 0; p < count; p++) {
    s->stiffness[p] = form == OF_MODULI ? (b->moduli ? b->moduli[p] : 1) * Of(s->at.at.weight[MPM_STIFFNESS], p) : 1;
    s->weight[p]    = sqrt(Of(s->volume, p));
  }
  for (PetscInt a = 0; a < s->dim; a++) {
    PetscCall(PetscCalloc1(MpmGridSize(march->grid), &s->sum[a]));
    s->sum[a] += march->grid->origin;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode End(Pass *s)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < s->dim; a++) {
    s->sum[a] -= s->march->grid->origin;
    PetscCall(PetscFree(s->sum[a]));
  }
  PetscCall(PetscFree3(s->weight, s->value, s->stiffness));
  PetscCall(PetscFree(s->lames));
  PetscCall(MpmStencilsDestroy(&s->at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Bounds of the largest eigenvalues of M^-1 sum_p V_p (tr D)^2 and of M^-1 sum_p V_p D : D, where the loss depends on
   them.
*/
static PetscErrorCode FindForms(MpmMarch *march, MpmStepBounds *b)
{
  const PetscReal none[2] = {0, 0};

  PetscFunctionBegin;
  for (Form form = OF_VOLUME; form <= OF_RATE; form++) {
    const PetscReal *only = form == OF_VOLUME ? (const PetscReal[2]){1, 0} : (const PetscReal[2]){0, 1};
    MpmStepBounds    of   = {.factor = 1, .chance = b->chance, .seed = b->seed};
    Pass             s;

    b->form[form - OF_VOLUME] = 0;
    if (MpmStepLoss(&march->scheme->space, only, 1) == MpmStepLoss(&march->scheme->space, none, 1)) continue;
    PetscCall(Begin(march, b, form, &s));
    if (b->kinds & MPM_BOUND_LANCZOS)
      PetscCall(FindByLanczos(&s, &of));
    else
      PetscCall(FindByParticle(&s, &of));
    PetscCall(End(&s));
    b->form[form - OF_VOLUME] = 1 / PetscSqr(b->kinds & MPM_BOUND_LANCZOS ? of.lanczos : of.particle);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmStepLoss(const MpmSpace *space, const PetscReal form[2], PetscReal artificial)
{
  const MpmMaterialNumbers *m    = &space->material;
  const PetscReal           own  = m->viscosity * PetscMax(1, m->plastic[MPM_FLOW_INDEX]);
  const PetscBool           acts = m->artificial[0] > 0 || m->artificial[1] > 0 ? PETSC_TRUE : PETSC_FALSE;

  return space->damping + (PetscMax(space->viscous[0], 0) + (acts ? artificial : 0)) * form[0] +
         2 * (space->viscous[1] + own) * form[1];
}

PetscReal MpmStepWithLoss(PetscReal limit, PetscReal loss)
{
  return loss > 0 ? 2 / (loss / 2 + hypot(loss / 2, 2 / limit)) : limit;
}

PetscErrorCode MpmStepBoundsFind(MpmMarch *march, MpmStepBounds *b)
{
  const MpmFormulation *formulation = march->scheme->formulation;
  const MpmStep         rest        = {.courant = 1};
  Pass                  s;

  PetscFunctionBegin;
  b->why_not = MpmStepBoundWhyNot(march->layout, march->scheme, &rest);
  if (b->why_not) PetscFunctionReturn(PETSC_SUCCESS);
  b->factor = formulation->step_bound(&march->scheme->numbers, march->scheme->transfer);
  if (b->kinds & MPM_BOUND_LOSS && MpmSpaceIsDamped(&march->scheme->space)) PetscCall(FindForms(march, b));
  PetscCall(Begin(march, b, OF_MODULI, &s));
  if (b->kinds & MPM_BOUND_LONE) PetscCall(FindLone(&s, b));
  PetscCall(PetscLogEventBegin(march->watch_event, 0, 0, 0, 0));
  if (b->kinds & MPM_BOUND_PARTICLE) PetscCall(FindByParticle(&s, b));
  PetscCall(PetscLogEventEnd(march->watch_event, 0, 0, 0, 0));
  PetscCall(PetscLogEventBegin(march->certificate_event, 0, 0, 0, 0));
  if (b->kinds & MPM_BOUND_LANCZOS) PetscCall(FindByLanczos(&s, b));
  PetscCall(PetscLogEventEnd(march->certificate_event, 0, 0, 0, 0));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, &s.loses, 1, MPIU_BOOL, MPI_LOR, PetscObjectComm((PetscObject)march->grid->da)));
  if (s.loses) b->why_not = "a particle exactly on a node has a slope at a node without mass";
  PetscCall(End(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}
