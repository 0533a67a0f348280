/*
   A nonlinear step of MPM as plain loops over complex numbers, in one to three dimensions on a periodic grid. With a tiny
   imaginary part in the state the imaginary part of what a step makes of it is the tangent, without cancellation
   (complex step; Squire and Trapp 1998). It shares no code with the program: its basis functions, its weights and its
   order of operations are written out again.

   Lengths are in cells, the material at rest has the density 1 and the speed of P waves 1.
*/
#pragma once
#include <complex.h>
#include <math.h>
#include <string.h>

#define NL_DIM 3
#define NL_PARTICLES 2048
#define NL_NODES 512
#define NL_REACH 4

typedef double complex Number;
typedef enum { NL_HAT, NL_QUADRATIC, NL_CUBIC, NL_GIMP } NlBasis;
typedef enum { NL_USL, NL_USF, NL_MUSL } NlScheme;
typedef enum { NL_FLIP, NL_PIC, NL_APIC } NlTransfer;
typedef enum { NL_NEO, NL_SVK, NL_TAIT } NlLaw;

typedef struct {
  Number x[NL_DIM], v[NL_DIM], F[NL_DIM][NL_DIM], C[NL_DIM][NL_DIM];
} NlParticle;

/* mass, V0: of a particle. half_width: of gimp. lambda, mu, exponent: of the material. */
typedef struct {
  int        dim, cells[NL_DIM], count;
  NlBasis    basis;
  NlScheme   scheme;
  NlTransfer transfer;
  NlLaw      law;
  int        mls, projected;
  double     dt, mass, V0, half_width[NL_DIM], lambda, mu, exponent;
} NlRun;

/* The weights of a particle: the nodes along each direction, and of each node phi, the weights of GRAD and those of C. */
typedef struct {
  int    first[NL_DIM];
  Number phi[NL_DIM][NL_REACH], slope[NL_DIM][NL_REACH], arm[NL_DIM][NL_REACH], r[NL_DIM][NL_REACH];
} NlWeights;

/* The basis function at r = x - x_i, and its slope. l is half of the width of a gimp particle. Branches are taken on the real part. */
static inline void NlFunction(const NlRun *run, double l, Number r, Number *phi, Number *slope)
{
  const double sign = creal(r) < 0 ? -1 : 1;
  const Number d    = sign * r;
  const double at   = creal(d);

  *phi = *slope = 0;
  switch (run->basis) {
  case NL_HAT:
    if (at < 1) *phi = 1 - d, *slope = -1;
    break;
  case NL_QUADRATIC:
    if (at < 0.5)
      *phi = 0.75 - d * d, *slope = -2 * d;
    else if (at < 1.5)
      *phi = (1.5 - d) * (1.5 - d) / 2, *slope = d - 1.5;
    break;
  case NL_CUBIC:
    if (at < 1)
      *phi = 2. / 3 - d * d + d * d * d / 2, *slope = -2 * d + 1.5 * d * d;
    else if (at < 2)
      *phi = (2 - d) * (2 - d) * (2 - d) / 6, *slope = -(2 - d) * (2 - d) / 2;
    break;
  case NL_GIMP:
    if (at < l)
      *phi = 1 - (d * d + l * l) / (2 * l), *slope = -d / l;
    else if (at < 1 - l)
      *phi = 1 - d, *slope = -1;
    else if (at < 1 + l)
      *phi = (1 + l - d) * (1 + l - d) / (4 * l), *slope = -(1 + l - d) / (2 * l);
  }
  *slope *= sign;
}

static inline void NlWeigh(const NlRun *run, const NlParticle *p, NlWeights *w)
{
  for (int a = 0; a < run->dim; a++) {
    Number D = 0;

    w->first[a] = (int)floor(creal(p->x[a])) - 1;
    for (int n = 0; n < NL_REACH; n++) {
      w->r[a][n] = w->first[a] + n - p->x[a];
      NlFunction(run, run->half_width[a], -w->r[a][n], &w->phi[a][n], &w->slope[a][n]);
      D += w->phi[a][n] * w->r[a][n] * w->r[a][n];
    }
    for (int n = 0; n < NL_REACH; n++) {
      w->arm[a][n] = run->basis == NL_HAT ? w->slope[a][n] : w->phi[a][n] * w->r[a][n] / D;
      if (run->mls) w->slope[a][n] = w->arm[a][n];
    }
  }
}

/* Node n of a particle's: its number on the grid, and its weights. grad and arm are along each direction. */
static inline int NlNode(const NlRun *run, const NlWeights *w, int n, Number *phi, Number grad[], Number arm[],
                         Number r[])
{
  int at = 0, stride = 1, i[NL_DIM];

  for (int a = 0; a < run->dim; a++, n /= NL_REACH) {
    i[a] = n % NL_REACH;
    r[a] = w->r[a][i[a]];
    at += stride * ((w->first[a] + i[a] + 4 * run->cells[a]) % run->cells[a]);
    stride *= run->cells[a];
  }
  *phi = 1;
  for (int a = 0; a < run->dim; a++) {
    *phi *= w->phi[a][i[a]];
    grad[a] = arm[a] = 1;
    for (int b = 0; b < run->dim; b++) {
      grad[a] *= a == b ? w->slope[b][i[b]] : w->phi[b][i[b]];
      arm[a] *= a == b ? w->arm[b][i[b]] : w->phi[b][i[b]];
    }
  }
  return at;
}

static inline int NlAround(const NlRun *run)
{
  return run->dim == 1 ? NL_REACH : run->dim == 2 ? NL_REACH * NL_REACH : NL_REACH * NL_REACH * NL_REACH;
}

static inline Number NlDeterminant(int dim, Number F[NL_DIM][NL_DIM])
{
  if (dim == 1) return F[0][0];
  if (dim == 2) return F[0][0] * F[1][1] - F[0][1] * F[1][0];
  return F[0][0] * (F[1][1] * F[2][2] - F[1][2] * F[2][1]) - F[0][1] * (F[1][0] * F[2][2] - F[1][2] * F[2][0]) +
         F[0][2] * (F[1][0] * F[2][1] - F[1][1] * F[2][0]);
}

/* The Kirchhoff stress tau = J sigma. */
static inline void NlStress(const NlRun *run, Number F[NL_DIM][NL_DIM], Number tau[NL_DIM][NL_DIM])
{
  const int    dim = run->dim;
  const Number J   = NlDeterminant(dim, F);
  Number       E[NL_DIM][NL_DIM], trace = 0;

  for (int a = 0; a < dim; a++)
    for (int b = 0; b < dim; b++) {
      E[a][b] = a == b ? -0.5 : 0;
      for (int c = 0; c < dim; c++) E[a][b] += F[c][a] * F[c][b] / 2;
      trace += a == b ? E[a][b] : 0;
    }
  for (int a = 0; a < dim; a++)
    for (int b = 0; b < dim; b++) {
      tau[a][b] = 0;
      if (run->law == NL_TAIT) {
        tau[a][b] = a == b ? J * (1 - cexp(-run->exponent * clog(J))) / run->exponent : 0;
        continue;
      }
      for (int c = 0; c < dim; c++) {
        if (run->law == NL_NEO) tau[a][b] += run->mu * F[a][c] * F[b][c];
        for (int d = 0; d < dim && run->law == NL_SVK; d++)
          tau[a][b] += F[a][c] * (2 * run->mu * E[c][d] + (c == d ? run->lambda * trace : 0)) * F[b][d];
      }
      if (run->law == NL_NEO && a == b) tau[a][b] += run->lambda * clog(J) - run->mu;
    }
}

/* The velocity of the grid, from particles with weights w. */
static inline void NlVelocity(const NlRun *run, const NlParticle p[], const NlWeights w[], Number m[],
                              Number v[][NL_DIM])
{
  memset(m, 0, sizeof(*m) * NL_NODES);
  memset(v, 0, sizeof(*v) * NL_NODES);
  for (int q = 0; q < run->count; q++)
    for (int n = 0; n < NlAround(run); n++) {
      Number    phi, grad[NL_DIM], arm[NL_DIM], r[NL_DIM];
      const int i = NlNode(run, &w[q], n, &phi, grad, arm, r);

      m[i] += phi * run->mass;
      for (int a = 0; a < run->dim; a++) {
        v[i][a] += phi * run->mass * p[q].v[a];
        for (int b = 0; b < run->dim && run->transfer == NL_APIC; b++) v[i][a] += phi * run->mass * p[q].C[a][b] * r[b];
      }
    }
  for (int i = 0; i < NL_NODES; i++)
    for (int a = 0; a < run->dim && creal(m[i]) > 0; a++) v[i][a] /= m[i];
}

/* F <- (I + dt L) F, with L the gradient of the grid's velocity. */
static inline void NlStretch(const NlRun *run, NlParticle p[], const NlWeights w[], Number v[][NL_DIM])
{
  for (int q = 0; q < run->count; q++) {
    Number L[NL_DIM][NL_DIM] = {{0}}, F[NL_DIM][NL_DIM];

    for (int n = 0; n < NlAround(run); n++) {
      Number    phi, grad[NL_DIM], arm[NL_DIM], r[NL_DIM];
      const int i = NlNode(run, &w[q], n, &phi, grad, arm, r);

      for (int a = 0; a < run->dim; a++)
        for (int b = 0; b < run->dim; b++) L[a][b] += grad[b] * v[i][a];
    }
    memcpy(F, p[q].F, sizeof F);
    for (int a = 0; a < run->dim; a++)
      for (int b = 0; b < run->dim; b++)
        for (int c = 0; c < run->dim; c++) p[q].F[a][b] += run->dt * L[a][c] * F[c][b];
  }
}

static inline void NlAcceleration(const NlRun *run, NlParticle p[], const NlWeights w[], const Number m[],
                                  Number a[][NL_DIM])
{
  memset(a, 0, sizeof(*a) * NL_NODES);
  for (int q = 0; q < run->count; q++) {
    Number tau[NL_DIM][NL_DIM];

    NlStress(run, p[q].F, tau);
    for (int n = 0; n < NlAround(run); n++) {
      Number    phi, grad[NL_DIM], arm[NL_DIM], r[NL_DIM];
      const int i = NlNode(run, &w[q], n, &phi, grad, arm, r);

      for (int b = 0; b < run->dim; b++)
        for (int c = 0; c < run->dim; c++) a[i][b] -= run->V0 * tau[b][c] * grad[c];
    }
  }
  for (int i = 0; i < NL_NODES; i++)
    for (int b = 0; b < run->dim && creal(m[i]) > 0; b++) a[i][b] /= m[i];
}

/* The particles take what the grid has, u the new velocity and a the acceleration. */
static inline void NlTake(const NlRun *run, NlParticle p[], const NlWeights w[], Number u[][NL_DIM],
                          Number acceleration[][NL_DIM])
{
  for (int q = 0; q < run->count; q++) {
    if (run->transfer != NL_FLIP) memset(p[q].v, 0, sizeof p[q].v);
    memset(p[q].C, 0, sizeof p[q].C);
    for (int n = 0; n < NlAround(run); n++) {
      Number    phi, grad[NL_DIM], arm[NL_DIM], r[NL_DIM];
      const int i = NlNode(run, &w[q], n, &phi, grad, arm, r);

      for (int a = 0; a < run->dim; a++) {
        p[q].v[a] += run->transfer == NL_FLIP ? run->dt * phi * acceleration[i][a] : phi * u[i][a];
        for (int b = 0; b < run->dim; b++) p[q].C[a][b] += arm[b] * u[i][a];
      }
    }
  }
}

static inline void NlMove(const NlRun *run, NlParticle p[], const NlWeights w[], Number u[][NL_DIM])
{
  for (int q = 0; q < run->count; q++)
    for (int n = 0; n < NlAround(run); n++) {
      Number    phi, grad[NL_DIM], arm[NL_DIM], r[NL_DIM];
      const int i = NlNode(run, &w[q], n, &phi, grad, arm, r);

      for (int a = 0; a < run->dim; a++) p[q].x[a] += run->dt * phi * u[i][a];
    }
}

/* One step. All weights of a step are those of the places at its start. */
static inline void NlStep(const NlRun *run, NlParticle p[])
{
  static Number    m[NL_NODES], u[NL_NODES][NL_DIM], a[NL_NODES][NL_DIM];
  static NlWeights w[NL_PARTICLES];

  for (int q = 0; q < run->count; q++) NlWeigh(run, &p[q], &w[q]);
  NlVelocity(run, p, w, m, u);
  if (run->scheme == NL_USF) NlStretch(run, p, w, u);
  NlAcceleration(run, p, w, m, a);
  for (int i = 0; i < NL_NODES; i++)
    for (int b = 0; b < run->dim; b++) u[i][b] += run->dt * a[i][b];
  NlTake(run, p, w, u, a);
  if (!run->projected) NlMove(run, p, w, u);
  if (run->scheme == NL_USL) NlStretch(run, p, w, u);
  if (run->scheme != NL_MUSL) return;
  NlVelocity(run, p, w, m, u);
  NlStretch(run, p, w, u);
  if (run->projected) NlMove(run, p, w, u);
}
