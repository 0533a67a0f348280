/*
   Update stress last in two or three dimensions (DIM), in plain C: usl with flip, nu = 0.3, on splines with weights at
   NODES nodes in each direction: 2 for hats, 3 for quadratic and 4 for cubic splines.

     PROGRAM CELLS STEPS DRIFT JITTER      prints ns per particle and step, and the energy, so that nothing is left out

   There are CELLS cells and two particles in each direction of a periodic grid of length 1. They move by DRIFT cells a
   step in every direction, and rest within JITTER spacings of regular places. An array of structs for particles and one
   for nodes, two sweeps over the particles a step, and the weights anew in each: as one writes it.

   With AFFINE it is apic with the weights of MLS-MPM in place of slopes, in that method's own form: stress and affine
   velocity are one matrix, and each sweep knows one vector a node. It needs NODES > 2, where D does not depend on the place.

   With VERLET half of the strain comes before the force, in a sweep of its own. With RK it is rk4 with its stages on
   particles, and with FIVE too kg5: each stage is one more sweep, from the nodes to v and s of the stage and on to others. With
   IMPLICIT it is the midpoint rule at k = 5: conjugate gradients in the nodal masses, a sweep for each product.
*/
#include "plain_nd.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef IMPLICIT
#define COURANT 5.0
#else
#define COURANT 0.01
#endif
#define NU 0.3
#define STRESSES (DIM * (DIM + 1) / 2)
#define INVERSE_D (NODES == 3 ? 4.0 : 3.0) /* of sum_i phi_ip (x_i - x_p)^2, in cells */

typedef struct {
  double x[DIM], v[DIM], s[STRESSES]; /* the place in cells; stresses in the order 00 01 02 11 12 22 */
#ifdef AFFINE
  double c[DIM][DIM];
#endif
} Particle;

typedef struct {
  double v[DIM];
#ifndef AFFINE
  double a[DIM];
#endif
} Node;

#if DIM == 2
static const int component[DIM][DIM] = {{0, 1}, {1, 2}};
#else
static const int component[DIM][DIM] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
#endif

static double    drift;
static Particle *particle;
static Node     *node;
static double   *mass; /* and, when a step needs it, its inverse */

/* The index of the first node that a particle sees, and the weights; with them slopes, or places from the particle. */
static inline long Weights(const double x[], double phi[][NODES], double slope[][NODES])
{
  long first = 0;

  for (int a = 0; a < DIM; a++) {
    const long i = Along(x[a], phi[a], slope[a]);

#ifdef AFFINE
    for (int d = 0; d < NODES; d++) slope[a][d] = (double)(i + d) - x[a];
#endif
    first += (i + 1) * stride[a]; /* node 0 is at 1 */
  }
  return first;
}

/* The gradient of the weight of one node, or weight times its place from the particle. */
static inline void Gradient(const int i[], double phi[][NODES], double slope[][NODES], double g[])
{
#ifdef AFFINE
  for (int a = 0; a < DIM; a++) g[a] = At(i, phi) * slope[a][i[a]];
#else
  Slope(i, phi, slope, g);
#endif
}

#define ENDS(fold) Ends(fold, (double *)node, sizeof(Node) / sizeof(double))

static void InvertMasses(void)
{
  Ends(1, mass, 1);
  Ends(0, mass, 1);
  for (long n = 0; n < nodes; n++) mass[n] = mass[n] > 0 ? 1 / mass[n] : 0;
}

/* Adds to stresses what a gradient of velocity makes of them in a time of k. */
static inline void Strain(double k, double gradient[DIM][DIM], double stress[])
{
  const double lambda = NU / (1 - NU), mu = (1 - 2 * NU) / (2 * (1 - NU));
  double       trace = 0;

  for (int a = 0; a < DIM; a++) trace += gradient[a][a];
  for (int a = 0; a < DIM; a++)
    for (int b = a; b < DIM; b++)
      stress[component[a][b]] += k * (mu * (gradient[a][b] + gradient[b][a]) + (a == b ? lambda * trace : 0));
}

#if !defined AFFINE && !defined VERLET && !defined IMPLICIT
/* Adds velocity and force of a particle to a node. */
static inline void GiveTo(Node *n, double w, const double g[], const double v[], const double s[])
{
  for (int a = 0; a < DIM; a++) {
    double force = 0;

    for (int b = 0; b < DIM; b++) force += g[b] * s[component[a][b]];
    n->v[a] += w * v[a];
    n->a[a] -= COURANT * force;
  }
}
#endif

/* With masses it sums the masses too: of particles that have moved. */
static inline __attribute__((always_inline)) void SumToNodes(const int masses)
{
  memset(node, 0, (size_t)nodes * sizeof *node);
  if (masses) memset(mass, 0, (size_t)nodes * sizeof *mass);
  for (long p = 0; p < particles; p++) {
    const Particle *q = &particle[p];
    double          phi[DIM][NODES], slope[DIM][NODES], g[DIM];
    const long      first = Weights(q->x, phi, slope);
#ifdef AFFINE
    double affine[DIM][DIM];

    for (int a = 0; a < DIM; a++)
      for (int b = 0; b < DIM; b++) affine[a][b] = q->c[a][b] - COURANT * INVERSE_D * q->s[component[a][b]];
#endif

    FOR_NODES(i)
    {
      const double w = At(i, phi);
      const long   k = Of(first, i);
      Node        *n = node + k;

      Gradient(i, phi, slope, g);
#ifdef AFFINE
      for (int a = 0; a < DIM; a++) {
        double momentum = w * q->v[a];

        for (int b = 0; b < DIM; b++) momentum += g[b] * affine[a][b];
        n->v[a] += momentum;
      }
#elif defined VERLET || defined IMPLICIT
      for (int a = 0; a < DIM; a++) n->v[a] += w * q->v[a];
#else
      GiveTo(n, w, g, q->v, q->s);
#endif
      if (masses) mass[k] += w;
    }
  }
}

static void ToNodes(int masses)
{
  if (masses)
    SumToNodes(1);
  else
    SumToNodes(0);
}

/* Divides by the masses; adds times the force to the velocity. */
static void OnNodes(double times)
{
  (void)times; /* with AFFINE there is no force beside the velocity */
  for (long n = 0; n < nodes; n++) {
    for (int a = 0; a < DIM; a++) {
      node[n].v[a] *= mass[n];
#ifndef AFFINE
      node[n].a[a] *= mass[n];
      node[n].v[a] += times * node[n].a[a];
#endif
    }
  }
}

/* Where a particle is a step on, in the periodic grid. */
static inline void Move(double x[])
{
  for (int a = 0; a < DIM; a++) {
    x[a] += drift;
    if (x[a] >= (double)cells) x[a] -= (double)cells;
  }
}

/* The particles take what the nodes have: increments, and the strain of the velocity in a time of k. They move. */
static void ToParticles(double k)
{
  for (long p = 0; p < particles; p++) {
    Particle  *q = &particle[p];
    double     phi[DIM][NODES], slope[DIM][NODES], g[DIM], value[DIM] = {0}, gradient[DIM][DIM] = {{0}};
    const long first = Weights(q->x, phi, slope);

    FOR_NODES(i)
    {
      const double w = At(i, phi);
      const Node  *n = node + Of(first, i);

      Gradient(i, phi, slope, g);
      for (int a = 0; a < DIM; a++) {
#ifdef AFFINE
        value[a] += w * n->v[a];
#else
        value[a] += w * n->a[a];
#endif
        for (int b = 0; b < DIM; b++) gradient[a][b] += g[b] * n->v[a];
      }
    }
    for (int a = 0; a < DIM; a++) {
#ifdef AFFINE
      q->v[a] = value[a];
      for (int b = 0; b < DIM; b++) q->c[a][b] = gradient[a][b] *= INVERSE_D;
#else
      q->v[a] += value[a];
#endif
    }
    Strain(k, gradient, q->s);
    if (drift != 0) Move(q->x);
  }
}

#if defined VERLET || defined RK || defined IMPLICIT
static Node                                *before; /* the nodes that a sweep between ToNodes and ToParticles reads */

/* Nodes to sum to, beside those before. */
static void Turn(void)
{
  Node *const kept = node;

  node   = before;
  before = kept;
  memset(node, 0, (size_t)nodes * sizeof *node);
}
#endif

#ifdef VERLET
/* Half of the strain of the nodal velocity, and then the force. */
static void Between(void)
{
  Turn();
  for (long p = 0; p < particles; p++) {
    Particle  *q = &particle[p];
    double     phi[DIM][NODES], slope[DIM][NODES], g[DIM], gradient[DIM][DIM] = {{0}};
    const long first = Weights(q->x, phi, slope);

    FOR_NODES(i)
    {
      const Node *n = before + Of(first, i);

      Gradient(i, phi, slope, g);
      for (int a = 0; a < DIM; a++)
        for (int b = 0; b < DIM; b++) gradient[a][b] += g[b] * n->v[a];
    }
    Strain(COURANT / 2, gradient, q->s);
    FOR_NODES(i)
    {
      Node *n = node + Of(first, i);

      Gradient(i, phi, slope, g);
      for (int a = 0; a < DIM; a++)
        for (int b = 0; b < DIM; b++) n->a[a] -= COURANT * g[b] * q->s[component[a][b]];
    }
  }
  ENDS(1);
  OnNodes(1);
  ENDS(0);
  for (long n = 0; n < nodes; n++)
    for (int a = 0; a < DIM; a++) node[n].v[a] += before[n].v[a];
}
#endif

#ifdef RK
#ifdef FIVE
static const double part[] = {1. / 4, 1. / 6, 3. / 8, 1. / 2};
#else
static const double part[] = {1. / 4, 1. / 3, 1. / 2};
#endif

static void Stage(double c)
{
  Turn();
  for (long p = 0; p < particles; p++) {
    const Particle *q = &particle[p];
    double          phi[DIM][NODES], slope[DIM][NODES], g[DIM], v[DIM], s[STRESSES], gradient[DIM][DIM] = {{0}};
    const long      first = Weights(q->x, phi, slope);

    memcpy(v, q->v, sizeof v);
    memcpy(s, q->s, sizeof s);
    FOR_NODES(i)
    {
      const Node  *n = before + Of(first, i);
      const double w = At(i, phi);

      Gradient(i, phi, slope, g);
      for (int a = 0; a < DIM; a++) {
        v[a] += c * w * n->a[a];
        for (int b = 0; b < DIM; b++) gradient[a][b] += g[b] * n->v[a];
      }
    }
    Strain(c * COURANT, gradient, s);
    FOR_NODES(i)
    {
      Gradient(i, phi, slope, g);
      GiveTo(node + Of(first, i), At(i, phi), g, v, s);
    }
  }
  ENDS(1);
  OnNodes(0);
  ENDS(0);
}

static void Between(void)
{
  for (size_t j = 0; j < sizeof part / sizeof *part; j++) Stage(part[j]);
}
#endif

#ifdef IMPLICIT
#define RESIDUAL 1e-12
typedef double Vector[DIM];
static Vector *velocity, *increment, *residual, *direction, *product; /* of all nodes; images have no weight in sums */
static double *weight;

/* node.a = - k DIV (the strain of node.v in a time of k / 2, and with stresses those of the particles), on all nodes. */
static void Force(int stresses)
{
  ENDS(0);
  Turn();
  for (long p = 0; p < particles; p++) {
    const Particle *q = &particle[p];
    double          phi[DIM][NODES], slope[DIM][NODES], g[DIM], s[STRESSES] = {0}, gradient[DIM][DIM] = {{0}};
    const long      first = Weights(q->x, phi, slope);

    if (stresses) memcpy(s, q->s, sizeof s);
    FOR_NODES(i)
    {
      const Node *n = before + Of(first, i);

      Gradient(i, phi, slope, g);
      for (int a = 0; a < DIM; a++)
        for (int b = 0; b < DIM; b++) gradient[a][b] += g[b] * n->v[a];
    }
    Strain(COURANT / 2, gradient, s);
    FOR_NODES(i)
    {
      Node *n = node + Of(first, i);

      Gradient(i, phi, slope, g);
      for (int a = 0; a < DIM; a++)
        for (int b = 0; b < DIM; b++) n->a[a] -= COURANT * g[b] * s[component[a][b]];
    }
  }
  ENDS(1);
  OnNodes(0);
}

static double Dot(Vector x[], Vector y[])
{
  double sum = 0;

  for (long n = 0; n < nodes; n++)
    for (int a = 0; a < DIM; a++) sum += weight[n] * x[n][a] * y[n][a];
  return sum;
}

/* The masses of the nodes, 0 of their images. */
static void SetWeights(void)
{
  for (long n = 0; n < nodes; n++) {
    weight[n] = mass[n] > 0 ? 1 / mass[n] : 0;
    for (int a = 0; a < DIM; a++)
      if (n / stride[a] % across < 1 || n / stride[a] % across > cells) weight[n] = 0;
  }
}

/* (1 + k^2 / 4 M^-1 K) increment = node.a */
static void Solve(void)
{
  double square, first;

  for (long n = 0; n < nodes; n++) {
    memcpy(residual[n], node[n].a, sizeof(Vector));
    memcpy(direction[n], node[n].a, sizeof(Vector));
    memset(increment[n], 0, sizeof(Vector));
  }
  square = first = Dot(residual, residual);
  while (square > RESIDUAL * RESIDUAL * first) {
    double step, last = square;

    for (long n = 0; n < nodes; n++) memcpy(node[n].v, direction[n], sizeof(Vector));
    Force(0);
    for (long n = 0; n < nodes; n++)
      for (int a = 0; a < DIM; a++) product[n][a] = direction[n][a] - node[n].a[a] / 2;
    step = square / Dot(direction, product);
    for (long n = 0; n < nodes; n++)
      for (int a = 0; a < DIM; a++) {
        increment[n][a] += step * direction[n][a];
        residual[n][a] -= step * product[n][a];
      }
    square = Dot(residual, residual);
    for (long n = 0; n < nodes; n++)
      for (int a = 0; a < DIM; a++) direction[n][a] = residual[n][a] + square / last * direction[n][a];
  }
}

/* The increment of the velocity, and the velocity in the middle of the step. */
static void Between(void)
{
  for (long n = 0; n < nodes; n++) memcpy(velocity[n], node[n].v, sizeof(Vector));
  SetWeights();
  Force(1);
  Solve();
  for (long n = 0; n < nodes; n++)
    for (int a = 0; a < DIM; a++) {
      node[n].a[a] = increment[n][a];
      node[n].v[a] = velocity[n][a] + increment[n][a] / 2;
    }
  ENDS(0);
}
#endif

/* One step. */
static void Step(void)
{
  ToNodes(drift != 0);
  if (drift != 0) InvertMasses();
  ENDS(1);
#if defined VERLET || defined RK || defined IMPLICIT
  OnNodes(0);
  ENDS(0);
  Between();
#else
  OnNodes(1);
  ENDS(0);
#endif
#ifdef VERLET
  ToParticles(COURANT / 2);
#else
  ToParticles(COURANT);
#endif
}

/* The energy of a domain of volume 1: half the mean of v.v + s : C^-1 : s. */
static double Energy(void)
{
  const double lambda = NU / (1 - NU), mu = (1 - 2 * NU) / (2 * (1 - NU));
  double       sum = 0;

  for (long p = 0; p < particles; p++) {
    double squares = 0, trace = 0;

    for (int a = 0; a < DIM; a++) {
      sum += particle[p].v[a] * particle[p].v[a];
      trace += particle[p].s[component[a][a]];
      for (int b = 0; b < DIM; b++) squares += particle[p].s[component[a][b]] * particle[p].s[component[a][b]];
    }
    sum += squares / (2 * mu) - lambda / (2 * mu * (DIM * lambda + 2 * mu)) * trace * trace;
  }
  return sum / (double)(2 * particles);
}

/* One wave along the first direction, in the order of cells. */
static void Begin(double jitter)
{
  const double turn = 2 * acos(-1) / (double)cells;

  for (long p = 0; p < particles; p++) {
    Place(p, jitter, particle[p].x);
    particle[p].v[0] = sin(turn * particle[p].x[0]);
#ifdef AFFINE
    particle[p].c[0][0] = turn * cos(turn * particle[p].x[0]);
#endif
  }
}

int main(int argc, char **argv)
{
  if (argc != 5) {
    fprintf(stderr, "usage: %s CELLS STEPS DRIFT JITTER\n", argv[0]);
    return 2;
  }
  const long steps = atol(argv[2]);

  SetSize(atol(argv[1]));
  drift    = atof(argv[3]);
  particle = calloc((size_t)particles, sizeof *particle);
  node     = calloc((size_t)nodes, sizeof *node);
  mass     = calloc((size_t)nodes, sizeof *mass);
#if defined VERLET || defined RK || defined IMPLICIT
  before = calloc((size_t)nodes, sizeof *before);
  if (!before) return 1;
#endif
#ifdef IMPLICIT
  velocity  = calloc((size_t)nodes, sizeof *velocity);
  increment = calloc((size_t)nodes, sizeof *increment);
  residual  = calloc((size_t)nodes, sizeof *residual);
  direction = calloc((size_t)nodes, sizeof *direction);
  product   = calloc((size_t)nodes, sizeof *product);
  weight    = calloc((size_t)nodes, sizeof *weight);
  if (!velocity || !increment || !residual || !direction || !product || !weight) return 1;
#endif
  if (!particle || !node || !mass) {
    fprintf(stderr, "no memory for %ld particles\n", particles);
    return 1;
  }
  Begin(atof(argv[4]));
  ToNodes(1);
  InvertMasses();
  const double start = Now();
  for (long step = 0; step < steps; step++) Step();
  const double seconds = Now() - start;
  printf("{\"ns_per_particle_step\": %.6g, \"energy\": %.17g}\n", 1e9 * seconds / (double)particles / (double)steps,
         Energy());
  return 0;
}
