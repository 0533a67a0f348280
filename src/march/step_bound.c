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
#include "march/slopes.h"
#include "scheme/kernels.h"
#include <math.h>

#define BISECTIONS 200
#define INVARIANT 1e-14 /* a beta so small beside alpha ends the products */
#define SWEEPS 40       /* of rotations */
#define SAME 1e-9       /* relative difference of particles that decide alike */

/* What a pass over the particles needs. at: of the particle that is visited. */
typedef struct {
  MpmMarch        *march;
  MpmSlopes        slopes;
  PetscInt         dim, components, own, n, *node;
  PetscInt         whole[MPM_MAX_DIM], *cell[MPM_MAX_DIM];
  PetscReal        part[MPM_MAX_DIM], *xi[MPM_MAX_DIM], *shape, *slope;
  const PetscReal *mass, *volume, *stiffness;
  PetscReal       *inverse, *sum[MPM_MAX_DIM], *field[MPM_MAX_DIM]; /* local arrays of the nodes */
  PetscReal       *weight, *value;                                  /* u and lambda of each particle */
  PetscReal        lambda, mu;
} Pass;

static const MpmParity vectors[MPM_MAX_DIM][MPM_MAX_DIM] = {{MPM_NORMAL, MPM_TANGENTIAL, MPM_TANGENTIAL},
                                                            {MPM_TANGENTIAL, MPM_NORMAL, MPM_TANGENTIAL},
                                                            {MPM_TANGENTIAL, MPM_TANGENTIAL, MPM_NORMAL}};

const char *MpmStepBoundWhyNot(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step)
{
  const MpmSpace    *space = &scheme->space;
  const MpmTransfer *t     = scheme->transfer;

  if (!scheme->formulation->step_bound) return "no bound is known for this formulation";
  if (scheme->formulation->step_bound(&scheme->numbers, scheme->transfer) == 0)
    return "no bound is known for this formulation with this transfer";
  if (isinf(scheme->formulation->step_bound(&scheme->numbers, scheme->transfer))) return "no step grows";
  if (layout->colliders && (!scheme->formulation->leftmost || t->filter || t->affine || t->sharpen ||
                            scheme->formulation->step_bound(&scheme->numbers, t) != 2))
    return "with colliders no bound is proved for this scheme"; /* docs/floors.md has the theorem */
  if (MpmSpaceIsPrestressed(space) || space->displaced) return "no bound is known about a prestressed state";
  if (space->finite) return "no bound is known with kinematics finite";
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

static void Visit(Pass *s, PetscInt p)
{
  PetscInt  in[MPM_MAX_DIM];
  PetscReal at[MPM_MAX_DIM];

  for (PetscInt a = 0; a < s->dim; a++)
    MpmPlaceBlock(1, &s->cell[a][p], &s->xi[a][p], s->whole[a], s->part[a], &in[a], &at[a]);
  s->n = MpmSlopesAt(&s->slopes, PETSC_TRUE, in, at, s->node, s->shape, s->slope);
}

static PetscReal Of(const PetscReal property[], PetscInt p)
{
  return property ? property[p] : 1;
}

/* The gradient of node i's weight for a component, and its norm. */
static const PetscReal *Gradient(const Pass *s, PetscInt i, PetscInt c, PetscReal *norm)
{
  const PetscReal *g = s->slope + (i * s->dim + c) * s->dim;

  *norm = s->dim == 1 ? fabs(g[0]) : s->dim == 2 ? hypot(g[0], g[1]) : sqrt(g[0] * g[0] + g[1] * g[1] + g[2] * g[2]);
  return g;
}

static PetscErrorCode SumMasses(Pass *s)
{
  const MpmGrid   *grid = s->march->grid;
  const MpmGridBox box  = MpmGridBoxOf(grid, grid->ghost);

  PetscFunctionBegin;
  for (PetscInt p = 0; p < s->march->particles->count; p++) {
    Visit(s, p);
    for (PetscInt i = 0; i < s->n; i++) s->inverse[s->node[i]] += Of(s->mass, p) * s->shape[i];
  }
  PetscCall(MpmGridSum(grid, 1, &s->inverse));
  for (PetscInt r = 0; r < MpmGridRows(&box); r++) {
    PetscReal *m = s->inverse + MpmGridRow(grid, &box, r);

    for (PetscInt i = box.lo[0]; i < box.hi[0]; i++) m[i] = m[i] > 0 ? 1 / m[i] : 0;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a particle has a slope at a node without mass. DIV is then not the adjoint of GRAD. */
static PetscErrorCode Loses(Pass *s, PetscBool *loses)
{
  *loses = PETSC_FALSE;

  PetscFunctionBegin;
  for (PetscInt p = 0; p < s->march->particles->count && !*loses; p++) {
    Visit(s, p);
    for (PetscInt i = 0; i < s->n; i++)
      for (PetscInt c = 0; c < s->dim; c++) {
        PetscReal norm;

        (void)Gradient(s, i, c, &norm);
        if (norm > 0 && s->inverse[s->node[i]] == 0) *loses = PETSC_TRUE;
      }
  }
  PetscCallMPI(
      MPI_Allreduce(MPI_IN_PLACE, loses, 1, MPIU_BOOL, MPI_LOR, PetscObjectComm((PetscObject)s->march->grid->da)));
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
        t      = beside / (gap + copysign(hypot(gap, beside), gap));
        c      = 1 / hypot(1, t);
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

/* lambda of a particle that is alone. */
static PetscReal Lone(const Pass *s, PetscInt p)
{
  PetscReal A[MPM_MAX_STRESS][MPM_MAX_STRESS] = {{0}};

  for (PetscInt i = 0; i < s->n; i++)
    for (PetscInt c = 0; c < s->dim; c++) {
      PetscReal        norm;
      const PetscReal *g = Gradient(s, i, c, &norm);

      if (norm == 0 || s->inverse[s->node[i]] == 0) continue;
      if (!(s->shape[i] > 0)) return INFINITY;
      Add(s, c, g, 1 / s->shape[i], A);
    }
  return Of(s->stiffness, p) * Of(s->volume, p) / Of(s->mass, p) * Largest(s->dim * (s->dim + 1) / 2, A);
}

/* lambda of a particle with the split that the sums at the nodes are of. */
static PetscReal Shared(const Pass *s, PetscInt p)
{
  PetscReal A[MPM_MAX_STRESS][MPM_MAX_STRESS] = {{0}};

  for (PetscInt i = 0; i < s->n; i++)
    for (PetscInt c = 0; c < s->dim; c++) {
      const PetscInt   node = s->node[i];
      PetscReal        norm;
      const PetscReal *g = Gradient(s, i, c, &norm);

      if (norm > 0) Add(s, c, g, s->sum[s->components == 1 ? 0 : c][node] * s->inverse[node] / norm, A);
    }
  return Of(s->stiffness, p) * sqrt(Of(s->volume, p)) / s->weight[p] * Largest(s->dim * (s->dim + 1) / 2, A);
}

/* The sums over particles of u sqrt(V) abs(grad S). Without walls all components have the same. */
static PetscErrorCode SumSlopes(Pass *s)
{
  PetscFunctionBegin;
  for (PetscInt c = 0; c < s->components; c++) PetscCall(MpmGridZero(s->march->grid, s->sum[c]));
  for (PetscInt p = 0; p < s->march->particles->count; p++) {
    Visit(s, p);
    for (PetscInt i = 0; i < s->n; i++)
      for (PetscInt c = 0; c < s->components; c++) {
        PetscReal norm;

        (void)Gradient(s, i, c, &norm);
        s->sum[c][s->node[i]] += s->weight[p] * sqrt(Of(s->volume, p)) * norm;
      }
  }
  PetscCall(MpmGridSum(s->march->grid, s->components, s->sum));
  PetscFunctionReturn(PETSC_SUCCESS);
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
    MpmPlaceBlock(1, &s->cell[a][mine], &s->xi[a][mine], s->whole[a], s->part[a], &in, &xi);
    at->place[a] = in + march->grid->axis[a].first + xi;
  }
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, at->place, (PetscMPIInt)s->dim, MPIU_REAL, MPI_MAX, comm));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode FindByParticle(Pass *s, MpmStepBounds *b)
{
  const PetscInt count = s->march->particles->count;
  PetscReal      most;
  MpmDecider     at = {.value = NULL};

  PetscFunctionBegin;
  for (PetscInt p = 0; p < count; p++) {
    Visit(s, p);
    s->value[p] = Lone(s, p);
  }
  PetscCall(Decide(s, &most, &b->lone_at));
  b->lone = b->factor / sqrt(most);
  for (PetscInt p = 0; p < count; p++) s->weight[p] = sqrt(Of(s->volume, p));
  for (PetscInt sweep = 0; sweep <= b->sweeps; sweep++) {
    PetscCall(SumSlopes(s));
    for (PetscInt p = 0; p < count; p++) {
      Visit(s, p);
      s->value[p] = Shared(s, p);
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

/* What a particle's stress, made by the velocities of the nodes, gives to them. */
static void Product(Pass *s, PetscInt p)
{
  const PetscInt dim                         = s->dim;
  PetscReal      L[MPM_MAX_DIM][MPM_MAX_DIM] = {{0}}, stress[MPM_MAX_DIM][MPM_MAX_DIM], trace = 0;

  for (PetscInt i = 0; i < s->n; i++)
    for (PetscInt c = 0; c < dim; c++)
      for (PetscInt b = 0; b < dim; b++) L[c][b] += s->slope[(i * dim + c) * dim + b] * s->field[c][s->node[i]];
  for (PetscInt c = 0; c < dim; c++) trace += L[c][c];
  for (PetscInt c = 0; c < dim; c++)
    for (PetscInt b = 0; b < dim; b++)
      stress[c][b] =
          Of(s->stiffness, p) * Of(s->volume, p) * (s->mu * (L[c][b] + L[b][c]) + (c == b ? s->lambda * trace : 0));
  for (PetscInt i = 0; i < s->n; i++)
    for (PetscInt c = 0; c < dim; c++)
      for (PetscInt b = 0; b < dim; b++) s->sum[c][s->node[i]] += s->slope[(i * dim + c) * dim + b] * stress[c][b];
}

/* y = M^(-1/2) K M^(-1/2) x */
static PetscErrorCode Multiply(Pass *s, PetscReal x[], PetscReal y[])
{
  PetscFunctionBegin;
  PetscCall(Exchange(s, PETSC_FALSE, x, s->field));
  PetscCall(MpmGridSum(s->march->grid, s->dim, s->field));
  for (PetscInt c = 0; c < s->dim; c++) PetscCall(MpmGridZero(s->march->grid, s->sum[c]));
  for (PetscInt p = 0; p < s->march->particles->count; p++) {
    Visit(s, p);
    Product(s, p);
  }
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

static PetscErrorCode Begin(MpmMarch *march, Pass *s)
{
  const MpmSpace     *space     = &march->scheme->space;
  const MpmParticles *particles = march->particles;
  const PetscReal     nu        = space->dim > 1 ? space->poisson : 0;

  PetscFunctionBegin;
  *s = (Pass){.march      = march,
              .dim        = space->dim,
              .components = MpmLayoutIsPeriodic(march->layout) ? 1 : space->dim,
              .own        = space->dim * MpmGridNodes(march->grid),
              .lambda     = nu / (1 - nu),
              .mu         = (1 - 2 * nu) / (2 * (1 - nu)),
              .slopes     = {.layout = march->layout,
                             .basis  = march->scheme->basis,
                             .grid   = march->grid,
                             .kind   = space->gradient == MPM_GRADIENT_MLS ? MPM_DIV_MLS : MPM_DIV,
                             .parity = vectors}};
  PetscCall(PetscMalloc3(MpmSlopesMost(&s->slopes), &s->node, MpmSlopesMost(&s->slopes), &s->shape,
                         MpmSlopesMost(&s->slopes) * s->dim * s->dim, &s->slope));
  PetscCall(PetscMalloc2(particles->count, &s->weight, particles->count, &s->value));
  PetscCall(CreateArray(march->grid, &s->inverse));
  PetscCall(MpmMarchGetProperty(march, MPM_MASS, &s->mass));
  PetscCall(MpmMarchGetProperty(march, MPM_VOLUME, &s->volume));
  PetscCall(MpmMarchGetProperty(march, MPM_STIFFNESS, &s->stiffness));
  for (PetscInt a = 0; a < s->dim; a++) {
    PetscCall(CreateArray(march->grid, &s->sum[a]));
    PetscCall(CreateArray(march->grid, &s->field[a]));
    PetscCall(MpmParticlesGet(particles, MpmFieldCell[a], &s->cell[a]));
    PetscCall(MpmParticlesGet(particles, MpmFieldXi[a], &s->xi[a]));
    PetscCall(MpmParticlesWhere(particles, a, particles->step, &s->whole[a], &s->part[a]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode End(Pass *s)
{
  const MpmMarch *march = s->march;

  PetscFunctionBegin;
  for (PetscInt a = s->dim - 1; a >= 0; a--) {
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldXi[a], &s->xi[a]));
    PetscCall(MpmParticlesRestore(march->particles, MpmFieldCell[a], &s->cell[a]));
    PetscCall(DestroyArray(march->grid, &s->field[a]));
    PetscCall(DestroyArray(march->grid, &s->sum[a]));
  }
  PetscCall(MpmMarchRestoreProperty(march, MPM_STIFFNESS, &s->stiffness));
  PetscCall(MpmMarchRestoreProperty(march, MPM_VOLUME, &s->volume));
  PetscCall(MpmMarchRestoreProperty(march, MPM_MASS, &s->mass));
  PetscCall(DestroyArray(march->grid, &s->inverse));
  PetscCall(PetscFree2(s->weight, s->value));
  PetscCall(PetscFree3(s->node, s->shape, s->slope));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepBoundsFind(MpmMarch *march, MpmStepBounds *b)
{
  const MpmFormulation *formulation = march->scheme->formulation;
  const MpmStep         rest        = {.courant = 1};
  Pass                  s;
  PetscBool             loses;

  PetscFunctionBegin;
  b->why_not = MpmStepBoundWhyNot(march->layout, march->scheme, &rest);
  if (b->why_not) PetscFunctionReturn(PETSC_SUCCESS);
  b->factor = formulation->step_bound(&march->scheme->numbers, march->scheme->transfer);
  PetscCall(Begin(march, &s));
  PetscCall(SumMasses(&s));
  PetscCall(Loses(&s, &loses));
  if (loses)
    b->why_not = "a particle exactly on a node has a slope at a node without mass";
  else {
    PetscCall(FindByParticle(&s, b));
    PetscCall(FindByLanczos(&s, b));
  }
  PetscCall(End(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}
