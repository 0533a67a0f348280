/*
   Bounds of the largest eigenvalue lambda of M^-1 K, K = sum_p V_p E_p B_p^T C B_p, for the particles of a march.

   Split of the masses. Let theta_ip >= 0 and sum_p theta_ip = 1 at each node and component. Then K = sum_p K_p and
   M = sum_p theta_p M, so lambda <= max_p lambda_p, with lambda_p the largest eigenvalue of

     V_p E_p C^(1/2) [sum_i B_i B_i^T / (m_i theta_ip)] C^(1/2)

   of order d (d + 1) / 2. theta_ip = S_ip m_p / m_i makes each particle a lone one. theta_ip ~ u_p sqrt(V_p) abs(grad S_ip)
   takes one sum at each node. u = sqrt(V) is the bound 'particle', and u <- u lambda makes a better one in most layouts.

   Lanczos. k products with M^(-1/2) K M^(-1/2) from a random vector of norm 1 have coefficients alpha, beta. p_j is the
   polynomial with p_j(A) v_1 = v_(j+1). The part g of v_1 along the top eigenvector has abs(g p_k(lambda)) <= 1, and
   abs(g) < delta has a probability of at most delta sqrt(2 n / pi). So lambda <= the largest t with
   p_k(t) = sqrt(2 n / pi) / chance, but for that chance.

   Source: docs/theory.md, section 4; van Dorsselaer, Hochstenbach and van der Vorst 1999 for the second.
*/
#include <mpmstab/step_bound.h>
#include "base/hash.h"
#include "march/march_private.h"
#include "march/stencils.h"
#include "scheme/kernels.h"
#include <math.h>

#define BISECTIONS 200
#define INVARIANT 1e-14 /* a beta so small beside alpha ends the products */
#define SWEEPS 40       /* of rotations */
#define SAME 1e-9       /* relative difference of particles that decide alike */

/* What a pass over the particles needs. */
typedef struct {
  MpmMarch        *march;
  MpmStencils      at;
  PetscInt         dim, components, own;
  const PetscReal *mass, *volume;
  PetscReal       *inverse, *sum[MPM_MAX_DIM], *field[MPM_MAX_DIM]; /* local arrays of the nodes */
  PetscReal       *weight, *value, *stiffness;                      /* u, lambda and modulus of each particle */
  PetscReal        lambda, mu, *times;
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
  if (space->collides && (!scheme->formulation->leftmost || t->filter || t->affine || t->sharpen ||
                          scheme->formulation->step_bound(&scheme->numbers, t) != 2))
    return "with colliders no bound is proved for this scheme"; /* docs/floors.md has the theorem */
  if (MpmSpaceIsPrestressed(space) || space->displaced) return "no bound is known about a prestressed state";
  if (MpmSpaceIsDamped(space)) return "no bound is known with damping or viscosity";
  if (MpmStepDrifts(step)) return "the bounds are of particles at rest";
  for (PetscInt a = 0; a < layout->dim; a++)
    for (int end = 0; end < 2; end++)
      if (layout->grid[a].ends[end] == MPM_FIXED_REACTION) return "no bound is known at walls that react";
  return NULL;
}

/* ---- passes over the particles ---- */

static PetscErrorCode CreateArray(const MpmGrid *grid, PetscReal **array)
{
  const MpmGridAxis *last = &grid->axis[grid->dim - 1];

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(last->stride * (last->nodes + 2 * grid->ghost), array));
  *array += grid->origin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode DestroyArray(const MpmGrid *grid, PetscReal **array)
{
  PetscFunctionBegin;
  if (*array) *array -= grid->origin;
  PetscCall(PetscFree(*array));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscReal Of(const PetscReal property[], PetscInt p)
{
  return property ? property[p] : 1;
}

/* The norms of the slopes of node i for a component. */
static void Norms(const Pass *s, PetscInt i, PetscInt c, PetscReal norm[])
{
  const PetscReal *g = s->at.g + (i * s->at.comps + c) * s->dim * MPM_STENCILS;

  PetscReal square[MPM_STENCILS];

  for (PetscInt q = 0; q < MPM_STENCILS; q++) square[q] = g[q] * g[q];
  for (PetscInt b = 1; b < s->dim; b++)
    for (PetscInt q = 0; q < MPM_STENCILS; q++) square[q] += g[b * MPM_STENCILS + q] * g[b * MPM_STENCILS + q];
  for (PetscInt q = 0; q < MPM_STENCILS; q++) norm[q] = sqrt(square[q]);
}

/*
   The sums over particles of u sqrt(V) abs(grad S), over the masses of the nodes. With masses these are summed, too. Without
   walls all components have the same.
*/
static PetscErrorCode Sum(Pass *s, PetscBool masses)
{
  const MpmGrid   *grid = s->march->grid;
  const MpmGridBox box  = MpmGridBoxOf(grid, grid->ghost);
  PetscReal        norm[MPM_STENCILS], share[MPM_STENCILS], *array[1 + MPM_MAX_DIM];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < s->components; k++) PetscCall(MpmGridZero(grid, array[k] = s->sum[k]));
  array[s->components] = s->inverse;
  while (MpmStencilsNext(&s->at)) {
    const MpmStencils *c = &s->at;

    for (PetscInt q = 0; q < c->n; q++) share[q] = s->weight[c->begin + q] * sqrt(Of(s->volume, c->begin + q));
    for (PetscInt i = 0; i < c->nodes; i++) {
      for (PetscInt k = 0; k < s->components; k++) {
        if (k < c->comps) Norms(s, i, k, norm);
        for (PetscInt q = 0; q < c->n; q++) s->sum[k][MpmStencilsNode(c, i, q)] += share[q] * norm[q];
      }
      for (PetscInt q = 0; q < c->n && masses; q++)
        s->inverse[MpmStencilsNode(c, i, q)] += Of(s->mass, c->begin + q) * c->S[i * MPM_STENCILS + q];
    }
  }
  PetscCall(MpmGridSum(grid, s->components + (masses ? 1 : 0), array));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    const PetscInt row = MpmGridRow(grid, &box, r);

    for (PetscInt i = row + box.lo[0]; i < row + box.hi[0]; i++) {
      if (masses) s->inverse[i] = s->inverse[i] > 0 ? 1 / s->inverse[i] : 0;
      for (PetscInt k = 0; k < s->components; k++) s->sum[k][i] *= s->inverse[i];
    }
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
   Adds times b b^T to a matrix, b = C^(1/2) of the strain g e_c, symmetric. Strains have the components 00, 11, 22 and then
   those beside the diagonal times sqrt(2), so that C is 2 mu and on 1, the strain without shape, 2 mu + d lambda.
*/
static void Add(const Pass *s, PetscInt c, const PetscReal g[], PetscReal times,
                PetscReal A[MPM_MAX_STRESS][MPM_MAX_STRESS])
{
  const PetscInt  dim = s->dim, n = dim * (dim + 1) / 2;
  const PetscReal shear = sqrt(2 * s->mu), more = (sqrt(2 * s->mu + dim * s->lambda) - shear) / dim;
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
static PetscReal Isotropic(const Pass *s, PetscReal G[MPM_MAX_STRESS][MPM_MAX_STRESS])
{
  PetscReal axis[MPM_MAX_DIM], T[MPM_MAX_STRESS][MPM_MAX_STRESS];

  (void)Largest(s->dim, G);
  for (PetscInt a = 0; a < s->dim; a++) axis[a] = sqrt(fmax(G[a][a], 0));
  for (PetscInt a = 0; a < s->dim; a++)
    for (PetscInt b = 0; b < s->dim; b++)
      T[a][b] = s->lambda * axis[a] * axis[b] + (a == b ? 2 * s->mu * axis[a] * axis[a] : 0);
  return Largest(s->dim, T);
}

/*
   lambda of the particles away from walls. times[i MPM_STENCILS + q] is what the square of the slope at a node counts. The matrix
   of Isotropic has the trace of G, as lambda + 2 mu is 1, and squares of its eigenvalues whose sum is 4 mu (mu + lambda) tr G^2 +
   lambda^2 (tr G)^2. These bound its largest one (Wolkowicz and Styan 1980). A bound below least suffices.
*/
static void ValuesInside(Pass *s, const PetscReal times[], const PetscReal factor[], PetscReal least)
{
  const MpmStencils *c                                         = &s->at;
  const PetscInt     dim                                       = s->dim;
  PetscReal          G[MPM_MAX_DIM][MPM_MAX_DIM][MPM_STENCILS] = {{{0}}};

  for (PetscInt i = 0; i < c->nodes; i++)
    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = a; b < dim; b++) {
        const PetscReal *at = c->g + (i * dim + a) * MPM_STENCILS, *other = c->g + (i * dim + b) * MPM_STENCILS;

        for (PetscInt q = 0; q < MPM_STENCILS; q++) G[a][b][q] += times[i * MPM_STENCILS + q] * at[q] * other[q];
      }
  for (PetscInt q = 0; q < c->n; q++) {
    PetscReal A[MPM_MAX_STRESS][MPM_MAX_STRESS], trace = 0, square = 0, *value = s->value + c->begin + q;

    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++) {
        A[a][b] = G[PetscMin(a, b)][PetscMax(a, b)][q];
        square += A[a][b] * A[a][b];
        trace += a == b ? A[a][a] : 0;
      }
    square = 4 * s->mu * (s->mu + s->lambda) * square + s->lambda * s->lambda * trace * trace;
    square = fmax(square - trace * trace / dim, 0) * (dim - 1) / dim;
    *value = factor[q] * (trace / dim + sqrt(square));
    if (*value > least || isnan(*value)) *value = factor[q] * Isotropic(s, A);
  }
}

/*
   lambda of particles: alone, or with the split that the sums at the nodes are of. Of a split, those are not
   found that are below least.
*/
static void Values(Pass *s, PetscBool lone, PetscReal least)
{
  const MpmStencils *c     = &s->at;
  PetscReal         *times = s->times, factor[MPM_STENCILS] = {0}, norm[MPM_STENCILS];
  PetscReal          A[MPM_STENCILS][MPM_MAX_STRESS][MPM_MAX_STRESS] = {{{0}}};
  PetscBool          endless[MPM_STENCILS]                           = {PETSC_FALSE};

  for (PetscInt q = 0; q < c->n; q++) {
    const PetscInt p = c->begin + q;

    factor[q] = s->stiffness[p] * (lone ? Of(s->volume, p) / Of(s->mass, p) : sqrt(Of(s->volume, p)) / s->weight[p]);
  }
  for (PetscInt i = 0; i < c->nodes; i++)
    for (PetscInt k = 0; k < c->comps; k++) {
      const PetscReal *S = c->S + i * MPM_STENCILS, *sum = s->sum[s->components == 1 ? 0 : k];
      PetscReal       *at = times + i * MPM_STENCILS, g[MPM_MAX_DIM];

      Norms(s, i, k, norm);
      for (PetscInt q = 0; q < MPM_STENCILS; q++) at[q] = q < c->n ? sum[MpmStencilsNode(c, i, q)] : 0;
      for (PetscInt q = 0; q < MPM_STENCILS; q++) at[q] = norm[q] > 0 ? at[q] / norm[q] : 0;
      for (PetscInt q = 0; q < c->n && (lone || c->comps > 1); q++) {
        if (norm[q] > 0 && s->inverse[MpmStencilsNode(c, i, q)] == 0) s->loses = PETSC_TRUE;
        if (at[q] == 0) continue;
        if (lone && !(S[q] > 0)) endless[q] = PETSC_TRUE;
        if (lone) at[q] = endless[q] ? 0 : 1 / S[q];
        if (c->comps == 1) continue;
        for (PetscInt b = 0; b < s->dim; b++) g[b] = c->g[((i * c->comps + k) * s->dim + b) * MPM_STENCILS + q];
        Add(s, k, g, at[q], A[q]);
      }
    }
  if (c->comps == 1) ValuesInside(s, times, factor, least);
  for (PetscInt q = 0; q < c->n; q++) {
    if (c->comps > 1) s->value[c->begin + q] = factor[q] * Largest(s->dim * (s->dim + 1) / 2, A[q]);
    if (endless[q]) s->value[c->begin + q] = INFINITY;
  }
}

/* The largest value of all particles, and where it is: the one with the least id of several that are alike but for rounding. */
static PetscErrorCode Decide(Pass *s, PetscReal *most, MpmDecider *at)
{
  const MpmMarch   *march = s->march;
  const MPI_Comm    comm  = PetscObjectComm((PetscObject)march->grid->da);
  const PetscInt64 *id;
  PetscInt          mine = MPM_NONE;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  *most = 0;
  for (PetscInt p = 0; p < march->particles->count; p++) *most = fmax(*most, s->value[p]);
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
    MpmPlaceBlock(1, &s->at.cell[a][mine], &s->at.xi[a][mine], s->at.whole[a], s->at.part[a], &in, &xi);
    at->place[a] = in + march->grid->axis[a].first + xi;
    if (march->grid->axis[a].periodic) /* particles may be in a rank's ghost cells */
      at->place[a] -= march->grid->axis[a].cells * floor(at->place[a] / march->grid->axis[a].cells);
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, at->place, (PetscMPIInt)s->dim, MPIU_REAL, MPI_MAX, comm));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
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
    if (sweep) PetscCall(Sum(s, PETSC_FALSE));
    most = 0;
    while (MpmStencilsNext(&s->at)) {
      Values(s, PETSC_FALSE, b->sweeps ? 0 : most * (1 - 2 * SAME));
      for (PetscInt q = 0; q < s->at.n; q++) most = fmax(most, s->value[s->at.begin + q]);
    }
    PetscCall(Decide(s, &most, sweep ? &at : &b->particle_at));
    if (!sweep) b->particle = b->swept = b->factor / sqrt(most);
    b->swept = fmax(b->swept, b->factor / sqrt(most));
    for (PetscInt p = 0; p < count; p++) s->weight[p] *= s->value[p] / most;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the certificate ---- */

/* Goes through this rank's own nodes: from a vector of theirs to a local array that is 0 elsewhere, or back. */
static PetscErrorCode Exchange(const Pass *s, PetscBool back, PetscReal vector[], PetscReal *const array[])
{
  const MpmGrid   *grid = s->march->grid;
  const MpmGridBox box  = MpmGridBoxOf(grid, 0);
  PetscInt         n    = 0;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < s->dim; c++) {
    if (!back) PetscCall(MpmGridZero(grid, array[c]));
    for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
      const PetscInt row = MpmGridRow(grid, &box, r);

      for (PetscInt i = row; i < row + box.hi[0]; i++, n++)
        if (back)
          vector[n] = array[c][i] * sqrt(s->inverse[i]);
        else
          array[c][i] = vector[n] * sqrt(s->inverse[i]);
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* What the stresses of particles, made by the velocities of the nodes, give to them. */
static inline __attribute__((always_inline)) void Product(const PetscInt dim, Pass *s)
{
  const MpmStencils *c                                = &s->at;
  PetscReal L[MPM_MAX_DIM][MPM_MAX_DIM][MPM_STENCILS] = {{{0}}}, stress[MPM_MAX_DIM][MPM_MAX_DIM][MPM_STENCILS],
            v[MPM_STENCILS];

  for (PetscInt i = 0; i < c->nodes; i++)
    for (PetscInt k = 0; k < dim; k++) {
      const PetscReal *g = c->g + (i * c->comps + k % c->comps) * dim * MPM_STENCILS;

      for (PetscInt q = 0; q < MPM_STENCILS; q++) v[q] = s->field[k][MpmStencilsNode(c, i, q)];
      for (PetscInt b = 0; b < dim; b++)
        for (PetscInt q = 0; q < MPM_STENCILS; q++) L[k][b][q] += g[b * MPM_STENCILS + q] * v[q];
    }
  for (PetscInt q = 0; q < c->n; q++) {
    const PetscReal modulus = s->stiffness[c->begin + q] * Of(s->volume, c->begin + q);
    PetscReal       trace   = 0;

    for (PetscInt k = 0; k < dim; k++) trace += L[k][k][q];
    for (PetscInt k = 0; k < dim; k++)
      for (PetscInt b = 0; b < dim; b++)
        stress[k][b][q] = modulus * (s->mu * (L[k][b][q] + L[b][k][q]) + (k == b ? s->lambda * trace : 0));
  }
  for (PetscInt i = 0; i < c->nodes; i++)
    for (PetscInt k = 0; k < dim; k++) {
      const PetscReal *g = c->g + (i * c->comps + k % c->comps) * dim * MPM_STENCILS;

      for (PetscInt q = 0; q < MPM_STENCILS; q++) v[q] = 0;
      for (PetscInt b = 0; b < dim; b++)
        for (PetscInt q = 0; q < MPM_STENCILS; q++) v[q] += g[b * MPM_STENCILS + q] * stress[k][b][q];
      for (PetscInt q = 0; q < c->n; q++) s->sum[k][MpmStencilsNode(c, i, q)] += v[q];
    }
}

/* y = M^(-1/2) K M^(-1/2) x */
static PetscErrorCode Multiply(Pass *s, PetscReal x[], PetscReal y[])
{
  PetscFunctionBegin;
  PetscCall(Exchange(s, PETSC_FALSE, x, s->field));
  PetscCall(MpmGridSum(s->march->grid, s->dim, s->field));
  for (PetscInt c = 0; c < s->dim; c++) PetscCall(MpmGridZero(s->march->grid, s->sum[c]));
  while (MpmStencilsNext(&s->at)) s->dim == 1 ? Product(1, s) : s->dim == 2 ? Product(2, s) : Product(3, s);
  PetscCall(MpmGridSum(s->march->grid, s->dim, s->sum));
  PetscCall(Exchange(s, PETSC_TRUE, y, s->sum));
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

/* log p_k(t) by the ratios of p_j to p_(j-1); -infinite below the largest Ritz value, where one of them is not positive. */
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

/* The largest t with log p_k(t) = log_value; -infinite: the largest Ritz value. */
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

  PetscFunctionBegin;
  PetscCall(PetscCalloc3(s->own, &x, s->own, &y, s->own, &before));
  PetscCall(Random(s, b->seed, x, &n));
  PetscCall(Dot(s, x, x, &norm));
  for (PetscInt i = 0; i < s->own; i++) x[i] /= sqrt(norm);
  while (k < MPM_STEP_BOUND_PRODUCTS) {
    PetscCall(Multiply(s, x, y));
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
  if (beta[k - 1] == 0) beta[k - 1] = PETSC_MACHINE_EPSILON * alpha[0];
  b->nodes    = n;
  b->products = k;
  b->lanczos  = b->factor / sqrt(Invert(k, alpha, beta, 0.5 * log(2 * (PetscReal)n / PETSC_PI) - log(b->chance)));
  b->estimate = b->factor / sqrt(Invert(k, alpha, beta, -INFINITY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- all of them ---- */

/* lambda / (lambda + 2 mu) at rest is nu / (1 - nu). */
static PetscReal LambdaOf(const MpmSpace *space)
{
  if (space->dim == 1) return 0;
  if (space->finite) return space->material.law->solid ? space->material.lambda : 1;
  return space->poisson / (1 - space->poisson);
}

static PetscErrorCode Begin(MpmMarch *march, const MpmStepBounds *b, Pass *s)
{
  const MpmSpace  *space = &march->scheme->space;
  const PetscInt   count = march->particles->count;
  const PetscReal *stiffness;

  PetscFunctionBegin;
  *s = (Pass){.march      = march,
              .dim        = space->dim,
              .components = MpmLayoutIsPeriodic(march->layout) ? 1 : space->dim,
              .own        = space->dim * MpmGridNodes(march->grid),
              .lambda     = LambdaOf(space),
              .mu         = (1 - LambdaOf(space)) / 2};
  PetscCall(MpmStencilsCreate(march, &s->at));
  PetscCall(PetscMalloc4(count, &s->weight, count, &s->value, count, &s->stiffness,
                         MPM_STENCILS * MpmSlopesMost(&s->at.slopes), &s->times));
  PetscCall(CreateArray(march->grid, &s->inverse));
  PetscCall(MpmMarchGetProperty(march, MPM_MASS, &s->mass));
  PetscCall(MpmMarchGetProperty(march, MPM_VOLUME, &s->volume));
  PetscCall(MpmMarchGetProperty(march, MPM_STIFFNESS, &stiffness));
  for (PetscInt p = 0; p < count; p++) {
    s->stiffness[p] = (b->moduli ? b->moduli[p] : 1) * Of(stiffness, p);
    s->weight[p]    = sqrt(Of(s->volume, p));
  }
  PetscCall(MpmMarchRestoreProperty(march, MPM_STIFFNESS, &stiffness));
  for (PetscInt a = 0; a < s->dim; a++) {
    PetscCall(CreateArray(march->grid, &s->sum[a]));
    PetscCall(CreateArray(march->grid, &s->field[a]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode End(Pass *s)
{
  const MpmMarch *march = s->march;

  PetscFunctionBegin;
  for (PetscInt a = 0; a < s->dim; a++) {
    PetscCall(DestroyArray(march->grid, &s->field[a]));
    PetscCall(DestroyArray(march->grid, &s->sum[a]));
  }
  PetscCall(MpmMarchRestoreProperty(march, MPM_VOLUME, &s->volume));
  PetscCall(MpmMarchRestoreProperty(march, MPM_MASS, &s->mass));
  PetscCall(DestroyArray(march->grid, &s->inverse));
  PetscCall(PetscFree4(s->weight, s->value, s->stiffness, s->times));
  PetscCall(MpmStencilsDestroy(&s->at));
  PetscFunctionReturn(PETSC_SUCCESS);
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
  PetscCall(Begin(march, b, &s));
  PetscCall(Sum(&s, PETSC_TRUE));
  if (b->kinds & MPM_BOUND_LONE) PetscCall(FindLone(&s, b));
  if (b->kinds & MPM_BOUND_PARTICLE) PetscCall(FindByParticle(&s, b));
  if (b->kinds & MPM_BOUND_LANCZOS) PetscCall(FindByLanczos(&s, b));
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, &s.loses, 1, MPIU_BOOL, MPI_LOR, PetscObjectComm((PetscObject)march->grid->da)));
  if (s.loses) b->why_not = "a particle exactly on a node has a slope at a node without mass";
  PetscCall(End(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}
