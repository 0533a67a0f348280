/*
   The nodal operator of particles anywhere. A product of maps, P W, is made particle by particle:

     (P W)_ij = sum_p conj(P_pi) W_pj / m_i

   In units in which a node's value is multiplied by the root of its mass m it is conj(P_pi) W_pj / sqrt(m_i m_j), which
   has entries of order 1 however little mass a node has.
*/
#include "analysis/cluster.h"
#include "linalg/matrix_polynomial.h"
#include "scheme/maps.h"
#include <math.h>

#define ROUNDING 1e-14 /* what a field has besides others is rounding below this part of it */
#define MOST_WEIGHTS (MPM_MAX_REACH * MPM_MAX_REACH * MPM_MAX_REACH)

/*
   all, kept, number, root - the nodes, those with mass, their numbers among these, MPM_NONE for the others, and the
                             roots of their masses by that number
   begin, node, weight     - the nodes of particle p, by number, from begin[p] on, and there the weights of a kind of map
                             along an axis over the roots of the masses; NULL until they are asked for
   rank, basis, field      - of a lone particle; see below
*/
typedef struct {
  const MpmCluster *c;
  PetscInt          all, kept, rank, *number, *begin, *node;
  PetscReal        *root, *basis, *field[2];
  double complex   *weight[MPM_OP_KINDS][MPM_MAX_DIM];
} Work;

PetscErrorCode MpmClusterCreate(PetscInt most, MpmCluster *c)
{
  PetscFunctionBegin;
  PetscCall(PetscMalloc2(c->plan->dim * most, &c->cell, c->plan->dim * most, &c->xi));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmClusterDestroy(MpmCluster *c)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(c->cell, c->xi));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* How often the nodes along a direction have begun again at node i. */
static PetscInt Turns(const MpmCluster *c, PetscInt axis, PetscInt i)
{
  return (PetscInt)floor((PetscReal)i / (PetscReal)c->nodes[axis]);
}

/* The nodes of particle p and its weights there, of a kind of map along an axis. Returns how many there are. */
static PetscInt Weights(const MpmCluster *c, PetscInt p, MpmOpKind kind, PetscInt axis, PetscInt node[],
                        double complex weight[])
{
  const MpmBasis *basis = c->of->scheme->basis;
  PetscInt        n = 1, stride = 1;

  node[0]   = 0;
  weight[0] = 1;
  for (PetscInt a = 0; a < c->plan->dim; a++) {
    const PetscInt at = p * c->plan->dim + a, first = c->cell[at] - basis->reach_left - c->first[a];
    PetscReal      row[MPM_MAX_REACH];
    PetscInt       along[MPM_MAX_REACH], kept = 0;
    double complex there[MPM_MAX_REACH];

    MpmMapRow(basis, a == axis ? kind : MPM_G2P, c->xi[at], c->of->layout->half_width[a], MpmNoWalls, row);
    for (PetscInt d = 0; d < MpmMapReach(basis); d++) {
      const PetscInt       turns = Turns(c, a, first + d), i = first + d - turns * c->nodes[a];
      const double complex w = row[d] * (turns && c->beta[a] != 0 ? cexp(I * (c->beta[a] * (PetscReal)turns)) : 1);
      PetscInt             k = 0;

      if (turns != 0 && !c->wraps[a]) continue;
      while (k < kept && along[k] != i) k++;
      there[k] = k < kept ? there[k] + w : w;
      along[k] = i;
      kept     = PetscMax(kept, k + 1);
    }
    for (PetscInt d = kept - 1; d >= 0; d--) /* the first n products are read last */
      for (PetscInt i = 0; i < n; i++) {
        node[d * n + i]   = node[i] + stride * along[d];
        weight[d * n + i] = weight[i] * there[d];
      }
    n *= kept;
    stride *= c->nodes[a];
  }
  return n;
}

/* Masses of nodes, which are sums of weights without phases, and the nodes of each particle. */
static PetscErrorCode WorkCreate(const MpmCluster *c, Work *w)
{
  MpmCluster     still = *c;
  PetscInt       node[MOST_WEIGHTS], most = 0;
  double complex phi[MOST_WEIGHTS];

  PetscFunctionBegin;
  *w = (Work){.c = c, .all = 1};
  for (PetscInt a = 0; a < c->plan->dim; a++) {
    still.beta[a] = 0;
    w->all *= c->nodes[a];
  }
  PetscCall(PetscMalloc3(w->all, &w->number, w->all, &w->root, c->n + 1, &w->begin));
  PetscCall(PetscArrayzero(w->root, w->all));
  for (PetscInt p = 0; p < c->n; p++) {
    const PetscInt n = Weights(&still, p, MPM_P2G, 0, node, phi);

    most += n;
    for (PetscInt i = 0; i < n; i++) w->root[node[i]] += creal(phi[i]);
  }
  for (PetscInt i = 0; i < w->all; i++) {
    w->number[i] = w->root[i] > 0 ? w->kept : MPM_NONE;
    if (w->root[i] > 0) w->root[w->kept++] = sqrt(w->root[i]);
  }
  PetscCall(PetscMalloc1(most, &w->node));
  w->begin[0] = 0;
  for (PetscInt p = 0, at = 0; p < c->n; w->begin[++p] = at) {
    const PetscInt n = Weights(&still, p, MPM_P2G, 0, node, phi);

    for (PetscInt i = 0; i < n; i++)
      if (w->number[node[i]] != MPM_NONE) w->node[at++] = w->number[node[i]];
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode WorkDestroy(Work *w)
{
  PetscFunctionBegin;
  for (PetscInt kind = 0; kind < MPM_OP_KINDS; kind++)
    for (PetscInt a = 0; a < MPM_MAX_DIM; a++) PetscCall(PetscFree(w->weight[kind][a]));
  PetscCall(PetscFree(w->node));
  PetscCall(PetscFree3(w->number, w->root, w->begin));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Most maps of a plan have the same few operations, so their weights are computed once. */
static PetscErrorCode Scaled(Work *w, const MpmOp *op, const double complex **weight)
{
  double complex **known = &w->weight[op->kind][op->axis], there[MOST_WEIGHTS];
  PetscInt         node[MOST_WEIGHTS];

  PetscFunctionBegin;
  *weight = *known;
  if (*known) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscMalloc1(w->begin[w->c->n], known));
  for (PetscInt p = 0, at = 0; p < w->c->n; p++) {
    const PetscInt n = Weights(w->c, p, op->kind, op->axis, node, there);

    for (PetscInt i = 0; i < n; i++) {
      const PetscInt number = w->number[node[i]];

      if (number != MPM_NONE) (*known)[at++] = there[i] / w->root[number];
    }
  }
  *weight = *known;
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddProduct(Work *w, const MpmNodalMap *map, double complex matrix[])
{
  const double complex *P, *W;

  PetscFunctionBegin;
  PetscCall(Scaled(w, &map->to_nodes, &P));
  PetscCall(Scaled(w, &map->to_particles, &W));
  for (PetscInt p = 0; p < w->c->n; p++)
    for (PetscInt j = w->begin[p]; j < w->begin[p + 1]; j++)
      for (PetscInt i = w->begin[p]; i < w->begin[p + 1]; i++)
        matrix[w->node[j] * w->kept + w->node[i]] += conj(P[i]) * W[j];
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The second difference along an axis, between nodes with mass. */
static void AddStencil(const Work *w, const MpmOp *op, double complex matrix[])
{
  const MpmCluster *c      = w->c;
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  PetscInt          stride = 1;

  for (PetscInt a = 0; a < op->axis; a++) stride *= c->nodes[a];
  for (PetscInt i = 0; i < w->all; i++)
    for (PetscInt d = -1; d <= 1; d++) {
      const PetscInt along = i / stride % c->nodes[op->axis], turns = Turns(c, op->axis, along + d);
      const PetscInt other = i + stride * (d - turns * c->nodes[op->axis]);

      if ((turns != 0 && !c->wraps[op->axis]) || w->number[i] == MPM_NONE || w->number[other] == MPM_NONE) continue;
      matrix[w->number[other] * w->kept + w->number[i]] += traits.stencil[d + 1] * w->root[w->number[i]] /
                                                           w->root[w->number[other]] *
                                                           cexp(I * c->beta[op->axis] * (PetscReal)turns);
    }
}

static PetscErrorCode MapOf(void *context, const MpmNodalMap *map, double complex matrix[])
{
  Work *w = context;

  PetscFunctionBegin;
  PetscCheck(map->product || map->to_nodes.kind == MPM_LAP, PETSC_COMM_SELF, PETSC_ERR_SUP, "SOLVE in a cluster");
  if (map->product)
    PetscCall(AddProduct(w, map, matrix));
  else
    AddStencil(w, &map->to_nodes, matrix);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- a lone particle ---- */

/*
   What a particle without a neighbour gives to nodes, and what it reads of them, are few fields of the nodes: a product
   of its weights, and one for each gradient or distance. All other fields of the nodes stay what they are.
*/
static PetscBool IsLone(const MpmCluster *c)
{
  for (PetscInt a = 0; a < c->plan->dim; a++)
    if (c->wraps[a]) return PETSC_FALSE;
  for (PetscInt m = 0; m < c->plan->nmaps; m++)
    if (!c->plan->map[m].product) return PETSC_FALSE;
  return c->n == 1 ? PETSC_TRUE : PETSC_FALSE;
}

static PetscReal Dot(PetscInt n, const PetscReal a[], const PetscReal b[])
{
  PetscReal sum = 0;

  for (PetscInt i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* Adds what a field has besides the orthonormal fields of a basis to the basis. */
static void Widen(PetscInt n, const PetscReal field[], PetscInt *rank, PetscReal basis[])
{
  PetscReal *rest = basis + *rank * n, norm;

  if (*rank == n) return;
  for (PetscInt i = 0; i < n; i++) rest[i] = field[i];
  for (PetscInt twice = 0; twice < 2; twice++)
    for (PetscInt r = 0; r < *rank; r++) {
      const PetscReal share = Dot(n, basis + r * n, rest);

      for (PetscInt i = 0; i < n; i++) rest[i] -= share * basis[r * n + i];
    }
  norm = sqrt(Dot(n, rest, rest));
  if (norm <= ROUNDING * sqrt(Dot(n, field, field))) return;
  for (PetscInt i = 0; i < n; i++) rest[i] /= norm;
  ++*rank;
}

/* The fields of a product of maps: field[0] is what it gives to nodes and field[1] what it reads of them. */
static PetscErrorCode FieldsOf(Work *w, const MpmNodalMap *map)
{
  PetscFunctionBegin;
  for (int i = 0; i < 2; i++) {
    const double complex *weight;

    PetscCall(Scaled(w, i ? &map->to_particles : &map->to_nodes, &weight));
    for (PetscInt k = 0; k < w->kept; k++) w->field[i][w->node[k]] = creal(weight[k]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A basis of all fields, of rank fields. */
static PetscErrorCode FindBasis(Work *w)
{
  const MpmNodalPlan *plan = w->c->plan;

  PetscFunctionBegin;
  for (PetscInt m = 0; m < plan->nmaps; m++) {
    PetscCall(FieldsOf(w, &plan->map[m]));
    for (int i = 0; i < 2; i++) Widen(w->kept, w->field[i], &w->rank, w->basis);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix of a map on these fields alone: rank x rank. */
static PetscErrorCode LoneMapOf(void *context, const MpmNodalMap *map, double complex matrix[])
{
  Work          *w    = context;
  const PetscInt rank = w->rank;

  PetscFunctionBegin;
  PetscCall(FieldsOf(w, map));
  for (PetscInt c = 0; c < rank; c++) {
    const PetscReal part = Dot(w->kept, w->basis + c * w->kept, w->field[1]);

    for (PetscInt r = 0; r < rank; r++) matrix[c * rank + r] = part * Dot(w->kept, w->basis + r * w->kept, w->field[0]);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the operator ---- */

PetscErrorCode MpmClusterOperator(const MpmCluster *c, PetscInt *n, double complex *coefficient[], PetscReal *unseen)
{
  const MpmNodalPlan *plan = c->plan;
  const PetscBool     lone = IsLone(c);
  Work                w;

  PetscFunctionBegin;
  PetscCall(WorkCreate(c, &w));
  PetscCall(PetscMalloc3(lone ? w.kept * w.kept : 0, &w.basis, w.kept, &w.field[0], w.kept, &w.field[1]));
  if (lone) PetscCall(FindBasis(&w));
  *n      = plan->nimages * (lone ? w.rank : w.kept);
  *unseen = 0;
  for (PetscInt g = 0; g < plan->nimages && *n < plan->nimages * PetscMax(1, w.kept); g++)
    *unseen = PetscMax(*unseen, PetscAbsReal(plan->image[g].c));
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscMalloc1(*n * *n, &coefficient[j]));
  PetscCall(MpmNodalRun(plan, *n / plan->nimages, lone ? LoneMapOf : MapOf, &w, coefficient));
  PetscCall(PetscFree3(w.basis, w.field[0], w.field[1]));
  PetscCall(WorkDestroy(&w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmClusterCrossing(MpmCluster *cluster, PetscReal *courant)
{
  const MpmNodalPlan *plan = cluster->plan;
  double complex     *c[64];
  PetscInt            n;
  PetscReal           unseen;

  PetscFunctionBegin;
  PetscCall(MpmClusterOperator(cluster, &n, c, &unseen));
  for (PetscInt i = 0; i < n; i++) c[0][i * n + i] += 1;
  PetscCall(MpmPolynomialSingular(n, plan->degree, c, courant));
  *courant = pow(*courant, 1.0 / plan->stride);
  if (*courant > MPM_CRITICAL_TO) *courant = INFINITY; /* where there is none, rounding makes one of 1e7 and more */
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscFree(c[j]));
  cluster->count++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The polynomial at x, which takes the place of its first coefficient; returns the largest sum of abs in a row. */
static PetscReal Evaluate(PetscInt n, PetscInt degree, PetscReal x, double complex *const c[])
{
  PetscReal norm = 0;

  for (PetscInt row = 0; row < n; row++) {
    PetscReal sum = 0;

    for (PetscInt i = row; i < n * n; i += n) {
      double complex value = 0;

      for (PetscInt j = degree; j >= 0; j--) value = value * x + c[j][i];
      c[0][i] = value;
      sum += cabs(value);
    }
    norm = PetscMax(norm, sum);
  }
  return norm;
}

PetscErrorCode MpmClusterGrowth(MpmCluster *cluster, PetscReal courant, PetscReal *growth, PetscReal *rounding)
{
  const MpmNodalPlan *plan = cluster->plan;
  double complex     *c[64];
  PetscInt            n;
  PetscReal           norm, unseen;

  PetscFunctionBegin;
  PetscCall(MpmClusterOperator(cluster, &n, c, &unseen));
  norm      = Evaluate(n, plan->degree, pow(courant, plan->stride), c);
  *rounding = MpmDefectiveErrorOf(MpmOperatorErrorOf(norm, 0, 0), 0, 1);
  PetscCall(MpmPolynomialRadius(n, c[0], growth));
  if (unseen > *growth) *growth = unseen;
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscFree(c[j]));
  cluster->count++;
  PetscFunctionReturn(PETSC_SUCCESS);
}
