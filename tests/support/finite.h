/*
   A second step at finite deformation, by plain loops over the operations of a table: with basis functions of its own,
   in complex numbers, one particle after another. What the march does is compared with it. A derivative of a step by a
   complex step is possible, because branches look at real parts alone.

   Arrays are by the ids of particles: x[dim * id + a] in cells, q[r * n + id] of particle register r. Nodes are those of
   the grid, x fastest.
*/
#pragma once
#include "check.h"
#include <complex.h>
#include <stdlib.h>

typedef struct {
  const MpmScene *scene;
  PetscInt        n, nodes; /* particles, and nodes of the grid */
  double complex *x, *q, *node, *mass;
} Finite;

/* ---- basis functions of d = x - x_i in cells, and their slopes ---- */

static inline void FiniteHat(double complex d, double complex f[2])
{
  const double at = creal(d);

  f[0] = f[1] = 0;
  if (at >= 0 && at < 1) {
    f[0] = 1 - d;
    f[1] = -1;
  } else if (at >= -1 && at < 0) {
    f[0] = 1 + d;
    f[1] = 1;
  }
}

/* The B-spline of a degree by the recursion of de Boor, on knots that are apart by 1 and centred on 0. */
static inline double complex FiniteSpline(int degree, double complex d)
{
  const double half = (degree + 1) / 2.0;

  if (degree == 0) return creal(d) >= -0.5 && creal(d) < 0.5 ? 1 : 0;
  return ((half + d) * FiniteSpline(degree - 1, d + 0.5) + (half - d) * FiniteSpline(degree - 1, d - 0.5)) / degree;
}

/* uGIMP: the hat, averaged over the particle's width 2 w. H is the integral of the hat. */
static inline double complex FiniteHatIntegral(double complex d)
{
  const double at = creal(d);

  if (at <= -1) return 0;
  if (at >= 1) return 1;
  return at < 0 ? (1 + d) * (1 + d) / 2 : 1 - (1 - d) * (1 - d) / 2;
}

static inline double complex FiniteHatValue(double complex d)
{
  const double at = creal(d);

  return fabs(at) >= 1 ? 0 : at < 0 ? 1 + d : 1 - d;
}

static inline void FiniteFunction(const MpmScene *s, PetscInt axis, double complex d, double complex f[2])
{
  const char  *name   = s->scheme.basis->name;
  const double w      = s->layout.half_width[axis];
  const int    degree = !strcmp(name, "cubic") ? 3 : 2;

  if (!strcmp(name, "linear")) {
    FiniteHat(d, f);
    return;
  }
  if (!strcmp(name, "gimp")) {
    f[0] = (FiniteHatIntegral(d + w) - FiniteHatIntegral(d - w)) / (2 * w);
    f[1] = (FiniteHatValue(d + w) - FiniteHatValue(d - w)) / (2 * w);
    return;
  }
  f[0] = FiniteSpline(degree, d);
  f[1] = FiniteSpline(degree - 1, d + 0.5) - FiniteSpline(degree - 1, d - 0.5);
}

#define FINITE_REACH 6 /* nodes along a direction that may be in reach */

/* The weights of a kind of operation along one direction, of the nodes floor(x) - 2 and those after it. */
static inline void FiniteWeights(const MpmScene *s, PetscInt axis, double complex x, MpmOpKind kind,
                                 double complex w[FINITE_REACH])
{
  const PetscInt  first = (PetscInt)floor(creal(x)) - 2;
  const PetscBool hat   = s->scheme.basis->hat;
  double complex  D     = 0;

  for (int j = 0; j < FINITE_REACH; j++) {
    double complex f[2], r = first + j - x;

    FiniteFunction(s, axis, -r, f);
    D += f[0] * r * r;
    w[j] = f[0];
    if (kind == MPM_P2G_AFFINE || kind == MPM_DIV_MLS || kind == MPM_G2P_AFFINE) w[j] = f[0] * r;
    if (kind == MPM_DIV || kind == MPM_G2P_SLOPE || (hat && (kind == MPM_DIV_MLS || kind == MPM_G2P_AFFINE)))
      w[j] = f[1];
  }
  for (int j = 0; j < FINITE_REACH && !hat && (kind == MPM_DIV_MLS || kind == MPM_G2P_AFFINE); j++) w[j] /= D;
}

/* ---- materials ---- */

static inline double complex FiniteDet(PetscInt dim, const double complex F[])
{
  if (dim == 1) return F[0];
  if (dim == 2) return F[0] * F[3] - F[1] * F[2];
  return F[0] * (F[4] * F[8] - F[5] * F[7]) - F[1] * (F[3] * F[8] - F[5] * F[6]) + F[2] * (F[3] * F[7] - F[4] * F[6]);
}

/* tau = mu (F F^T - I) + lambda ln J I, or -J p I; components in the order 00 01 02 11 12 22. */
static inline void FiniteStress(const MpmMaterialNumbers *m, PetscInt dim, const double complex F[],
                                double complex tau[])
{
  const double complex J         = FiniteDet(dim, F);
  double complex       isotropic = m->lambda * clog(J);

  if (m->law == &MpmLawGas) isotropic = -1;
  if (m->law == &MpmLawTait) isotropic = -J * (cpow(J, -m->exponent) - 1) / m->exponent;
  if (m->law == &MpmLawPolytropic) isotropic = -J * cpow(J, -m->exponent) / m->exponent;
  for (PetscInt a = 0, c = 0; a < dim; a++)
    for (PetscInt b = a; b < dim; b++, c++) {
      tau[c] = a == b ? isotropic : 0;
      if (m->law != &MpmLawNeo) continue;
      for (PetscInt e = 0; e < dim; e++) tau[c] += m->mu * F[dim * a + e] * F[dim * b + e];
      if (a == b) tau[c] -= m->mu;
    }
}

/* ---- operations ---- */

/* The register of a field at a node of the unbounded grid: its place in the grid, and the sign of the image's value. */
static inline PetscInt FiniteNode(const MpmLayout *l, const PetscInt at[], const MpmParity parity[], double *sign)
{
  PetscInt place = 0;

  *sign = 1;
  for (PetscInt a = l->dim - 1; a >= 0; a--) {
    PetscReal one;

    place = place * l->grid[a].nodes + MpmDirectionImage(&l->grid[a], at[a], parity[a], &one);
    *sign *= one;
  }
  return place;
}

/* Adds a map between register p of particle id and register f of the nodes; mass: the nodes are the masses. */
static inline void FiniteMap(Finite *s, const MpmOp *op, PetscInt id, PetscBool to_nodes, const MpmParity parity[],
                             double complex factor, double complex *particle, double complex node[])
{
  const MpmLayout *l       = &s->scene->layout;
  PetscInt         stencil = 1, first[MPM_MAX_DIM];
  double complex   w[MPM_MAX_DIM][FINITE_REACH], sum = 0;

  for (PetscInt a = 0; a < l->dim; a++) {
    const double complex x = s->x[l->dim * id + a];

    stencil *= FINITE_REACH;
    first[a] = (PetscInt)floor(creal(x)) - 2;
    FiniteWeights(s->scene, a, x, a == op->axis ? op->kind : MPM_P2G, w[a]);
  }
  for (PetscInt j = 0; j < stencil; j++) {
    PetscInt       at[MPM_MAX_DIM], rest = j, place;
    double         sign;
    double complex weight = 1;

    for (PetscInt a = 0; a < l->dim; a++, rest /= FINITE_REACH) {
      at[a] = first[a] + rest % FINITE_REACH;
      weight *= w[a][rest % FINITE_REACH];
    }
    if (weight == 0) continue;
    place = FiniteNode(l, at, parity, &sign);
    if (to_nodes)
      node[place] += sign * weight * factor * *particle;
    else
      sum += sign * weight * node[place];
  }
  if (!to_nodes) *particle += factor * sum;
}

static inline void FiniteMasses(Finite *s)
{
  static const MpmParity even[MPM_MAX_DIM] = {MPM_EVEN, MPM_EVEN, MPM_EVEN};
  const MpmOp            p2g               = {.kind = MPM_P2G};
  double complex         one               = 1;

  memset(s->mass, 0, sizeof *s->mass * (size_t)s->nodes);
  for (PetscInt id = 0; id < s->n; id++) FiniteMap(s, &p2g, id, PETSC_TRUE, even, 1, &one, s->mass);
}

static inline void FiniteToNodes(Finite *s, const MpmOp *op, double a)
{
  double complex *sum = calloc((size_t)s->nodes, sizeof *sum), *node = s->node + op->dst * s->nodes;

  for (PetscInt id = 0; id < s->n; id++)
    FiniteMap(s, op, id, PETSC_TRUE, s->scene->scheme.table->parity[op->dst], a, &s->q[op->src * s->n + id], sum);
  for (PetscInt i = 0; i < s->nodes; i++)
    node[i] = (op->accumulates ? node[i] : 0) + (creal(s->mass[i]) > 0 ? sum[i] / s->mass[i] : 0);
  free(sum);
}

static inline void FiniteOnNodes(Finite *s, const MpmOp *op, double a)
{
  const MpmLayout *l    = &s->scene->layout;
  double complex  *from = s->node + op->src * s->nodes, *to = s->node + op->dst * s->nodes;

  for (PetscInt i = 0; i < s->nodes; i++) {
    PetscInt rest = i, at[MPM_MAX_DIM] = {0};

    for (PetscInt d = 0; d < l->dim; d++) {
      at[d] = rest % l->grid[d].nodes;
      rest /= l->grid[d].nodes;
    }
    if (op->kind == MPM_WALL && at[op->axis] != (op->side ? l->grid[op->axis].nodes - 1 : 0)) continue;
    to[i] = (op->accumulates ? to[i] : 0) + (a == 0 ? 0 : a * from[i]);
  }
}

/* F <- F + L F + a L (L F) */
static inline void FiniteStretch(Finite *s, const MpmOp *op, double twice, PetscInt id)
{
  const PetscInt dim     = s->scene->layout.dim;
  const double   part[2] = {1, twice};
  double complex F[9];

  for (PetscInt c = 0; c < dim * dim; c++) F[c] = s->q[(op->dst + c) * s->n + id];
  for (int power = 0; power < 2; power++) {
    double complex LF[9] = {0};

    for (PetscInt a = 0; a < dim; a++)
      for (PetscInt b = 0; b < dim; b++)
        for (PetscInt c = 0; c < dim; c++)
          LF[dim * a + b] += s->q[(op->src + dim * a + c) * s->n + id] * F[dim * c + b];
    for (PetscInt c = 0; c < dim * dim; c++) {
      s->q[(op->dst + c) * s->n + id] += part[power] * LF[c];
      F[c] = LF[c];
    }
  }
}

static inline void FiniteOnParticles(Finite *s, const MpmOp *op, double a)
{
  const MpmScene *scene = s->scene;
  const PetscInt  dim = scene->layout.dim, n = s->n;
  const double    unit = scene->cell_width / (scene->wave_speed * scene->wave_speed);

  for (PetscInt id = 0; id < n; id++) {
    double complex F[9], tau[6];

    if (op->kind == MPM_STRESS) {
      for (PetscInt c = 0; c < dim * dim; c++) F[c] = s->q[(op->src + c) * n + id];
      FiniteStress(&scene->scheme.table->material, dim, F, tau);
      for (PetscInt c = 0; c < dim * (dim + 1) / 2; c++) s->q[(op->dst + c) * n + id] = tau[c];
    } else if (op->kind == MPM_LOAD)
      for (PetscInt c = 0; c < dim; c++) s->q[(op->dst + c) * n + id] = unit * scene->gravity[c];
    else if (op->kind == MPM_STRETCH)
      FiniteStretch(s, op, a, id);
    else if (op->kind == MPM_ADVANCE)
      for (PetscInt c = 0; c < dim; c++) s->x[dim * id + c] += s->q[(op->src + c) * n + id];
    else if (op->kind == MPM_ADD && op->dst != op->src)
      s->q[op->dst * n + id] += a * s->q[op->src * n + id];
    else
      s->q[op->dst * n + id] *= op->kind == MPM_ADD ? 1 + a : a;
  }
}

/* ---- a step ---- */

static inline PetscErrorCode FiniteCreate(const MpmScene *scene, Finite *s)
{
  const MpmTable *t = scene->scheme.table;

  PetscFunctionBegin;
  *s       = (Finite){.scene = scene, .n = (PetscInt)scene->layout.particles};
  s->nodes = (PetscInt)MpmLayoutNodes(&scene->layout);
  PetscCall(PetscCalloc4(t->dim * s->n, &s->x, t->nparticles * s->n, &s->q, t->nnodes * s->nodes, &s->node, s->nodes,
                         &s->mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static inline PetscErrorCode FiniteDestroy(Finite *s)
{
  PetscFunctionBegin;
  PetscCall(PetscFree4(s->x, s->q, s->node, s->mass));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Takes one step. Tables with a SOLVE are not for it. */
static inline void FiniteStep(Finite *s)
{
  const MpmTable *t = s->scene->scheme.table;

  FiniteMasses(s);
  for (const MpmOp *op = t->ops; op < t->ops + t->nops; op++) {
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
    const double      a      = MpmOpValue(op, s->scene->step.courant);

    if (traits.dst == MPM_ON_NODES && traits.src == MPM_ON_PARTICLES)
      FiniteToNodes(s, op, a);
    else if (traits.dst == MPM_ON_NODES)
      FiniteOnNodes(s, op, a);
    else if (traits.src == MPM_ON_NODES)
      for (PetscInt id = 0; id < s->n; id++)
        FiniteMap(s, op, id, PETSC_FALSE, t->parity[op->src], a, &s->q[op->dst * s->n + id],
                  s->node + op->src * s->nodes);
    else
      FiniteOnParticles(s, op, a);
  }
}
