/*
   Update stress last in two or three dimensions (DIM), in plain C: usl with flip, nu = 0.3, on quadratic B-splines.

     PROGRAM CELLS STEPS      prints ns per particle and step, and the energy, so that nothing is left out

   There are CELLS cells and two particles in each direction of a periodic grid of length 1. An array of structs for
   particles and one for nodes, two sweeps over the particles a step, and the weights anew in each: as one writes it.
*/
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define PPC 2
#define COURANT 0.01
#define NU 0.3
#define STRESSES (DIM * (DIM + 1) / 2)

typedef struct {
  double x[DIM], v[DIM], s[STRESSES]; /* the place in cells; stresses in the order 00 01 02 11 12 22 */
} Particle;

typedef struct {
  double v[DIM], a[DIM];
} Node;

/* Nodes have indices -1 to cells + 1 in each direction; stride is the distance along each. */
static long      cells, across, nodes, particles, stride[DIM];
static Particle *particle;
static Node     *node;
static double   *inverse; /* of the masses, which stay as they are */

#if DIM == 2
static const int component[DIM][DIM] = {{0, 1}, {1, 2}};
#define FOR_NODES(i)                                                                                                   \
  for (int i[3] = {0, 0, 0}; i[1] < 3; i[1]++)                                                                         \
    for (i[0] = 0; i[0] < 3; i[0]++)
#else
static const int component[DIM][DIM] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
#define FOR_NODES(i)                                                                                                   \
  for (int i[3] = {0, 0, 0}; i[2] < 3; i[2]++)                                                                         \
    for (i[1] = 0; i[1] < 3; i[1]++)                                                                                   \
      for (i[0] = 0; i[0] < 3; i[0]++)
#endif

static double Now(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The first node that a particle sees, and the weights and slopes along each direction. */
static inline Node *Weights(const double x[], double phi[][3], double slope[][3])
{
  Node *first = node;

  for (int a = 0; a < DIM; a++) {
    const long   i = (long)(x[a] + 0.5); /* the nearest node */
    const double d = x[a] - (double)i;

    phi[a][0]   = 0.5 * (0.5 - d) * (0.5 - d);
    phi[a][1]   = 0.75 - d * d;
    phi[a][2]   = 0.5 * (0.5 + d) * (0.5 + d);
    slope[a][0] = d - 0.5;
    slope[a][1] = -2 * d;
    slope[a][2] = d + 0.5;
    first += i * stride[a]; /* node 0 is at 1 */
  }
  return first;
}

/* The weight of one node, and its gradient. */
static inline double At(const int i[], double phi[][3], double slope[][3], double g[])
{
#if DIM == 2
  g[0] = slope[0][i[0]] * phi[1][i[1]];
  g[1] = phi[0][i[0]] * slope[1][i[1]];
  return phi[0][i[0]] * phi[1][i[1]];
#else
  g[0] = slope[0][i[0]] * phi[1][i[1]] * phi[2][i[2]];
  g[1] = phi[0][i[0]] * slope[1][i[1]] * phi[2][i[2]];
  g[2] = phi[0][i[0]] * phi[1][i[1]] * slope[2][i[2]];
  return phi[0][i[0]] * phi[1][i[1]] * phi[2][i[2]];
#endif
}

static inline Node *Of(Node *first, const int i[])
{
#if DIM == 2
  return first + i[0] + i[1] * stride[1];
#else
  return first + i[0] + i[1] * stride[1] + i[2] * stride[2];
#endif
}

static void Add(Node *to, const Node *from)
{
  for (int a = 0; a < DIM; a++) {
    to->v[a] += from->v[a];
    to->a[a] += from->a[a];
  }
}

/* Adds up what is one node of a periodic grid (fold), or gives all of them its value: one direction after another. */
static void Ends(int fold)
{
  for (int a = 0; a < DIM; a++) {
    for (long n = 0; n < nodes; n++) {
      const long i   = n / stride[a] % across;
      Node      *own = node + n + (i == 0 ? cells : -cells) * stride[a];

      if (i != 0 && i <= cells) continue; /* 1 to cells are its own */
      if (fold)
        Add(own, node + n);
      else
        node[n] = *own;
    }
  }
}

static void Masses(void)
{
  for (long p = 0; p < particles; p++) {
    double phi[DIM][3], slope[DIM][3], g[DIM];
    Node  *first = Weights(particle[p].x, phi, slope);

    FOR_NODES(i) Of(first, i)->v[0] += At(i, phi, slope, g);
  }
  Ends(1);
  Ends(0);
  for (long n = 0; n < nodes; n++) inverse[n] = 1 / node[n].v[0];
}

static void ToNodes(void)
{
  for (long n = 0; n < nodes; n++)
    for (int a = 0; a < DIM; a++) node[n].v[a] = node[n].a[a] = 0;
  for (long p = 0; p < particles; p++) {
    const Particle *q = &particle[p];
    double          phi[DIM][3], slope[DIM][3], g[DIM];
    Node           *first = Weights(q->x, phi, slope);

    FOR_NODES(i)
    {
      const double w = At(i, phi, slope, g);
      Node        *n = Of(first, i);

      for (int a = 0; a < DIM; a++) {
        double force = 0;

        for (int b = 0; b < DIM; b++) force += g[b] * q->s[component[a][b]];
        n->v[a] += w * q->v[a];
        n->a[a] -= COURANT * force;
      }
    }
  }
}

static void OnNodes(void)
{
  for (long n = 0; n < nodes; n++) {
    for (int a = 0; a < DIM; a++) {
      node[n].v[a] *= inverse[n];
      node[n].a[a] *= inverse[n];
      node[n].v[a] += node[n].a[a];
    }
  }
}

static void ToParticles(void)
{
  const double lambda = NU / (1 - NU), mu = (1 - 2 * NU) / (2 * (1 - NU));

  for (long p = 0; p < particles; p++) {
    Particle *q = &particle[p];
    double    phi[DIM][3], slope[DIM][3], g[DIM], acceleration[DIM] = {0}, gradient[DIM][DIM] = {{0}}, trace = 0;
    Node     *first = Weights(q->x, phi, slope);

    FOR_NODES(i)
    {
      const double w = At(i, phi, slope, g);
      const Node  *n = Of(first, i);

      for (int a = 0; a < DIM; a++) {
        acceleration[a] += w * n->a[a];
        for (int b = 0; b < DIM; b++) gradient[a][b] += g[b] * n->v[a];
      }
    }
    for (int a = 0; a < DIM; a++) trace += gradient[a][a];
    for (int a = 0; a < DIM; a++) {
      q->v[a] += acceleration[a];
      for (int b = a; b < DIM; b++)
        q->s[component[a][b]] += COURANT * (mu * (gradient[a][b] + gradient[b][a]) + (a == b ? lambda * trace : 0));
    }
  }
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
static void Begin(void)
{
  const double turn    = 2 * acos(-1) / (double)cells;
  const int    of_cell = DIM == 2 ? PPC * PPC : PPC * PPC * PPC;

  for (long p = 0; p < particles; p++) {
    long cell = p / of_cell, site = p % of_cell;

    for (int a = 0; a < DIM; a++) {
      particle[p].x[a] = (double)(cell % cells) + ((double)(site % PPC) + 0.51) / PPC;
      cell /= cells;
      site /= PPC;
    }
    particle[p].v[0] = sin(turn * particle[p].x[0]);
  }
}

int main(int argc, char **argv)
{
  if (argc != 3) {
    fprintf(stderr, "usage: %s CELLS STEPS\n", argv[0]);
    return 2;
  }
  const long steps = atol(argv[2]);

  cells     = atol(argv[1]);
  across    = cells + 3;
  nodes     = 1;
  particles = 1;
  for (int a = 0; a < DIM; a++) {
    stride[a] = nodes;
    nodes *= across;
    particles *= cells * PPC;
  }
  particle = calloc((size_t)particles, sizeof *particle);
  node     = calloc((size_t)nodes, sizeof *node);
  inverse  = calloc((size_t)nodes, sizeof *inverse);
  if (!particle || !node || !inverse) {
    fprintf(stderr, "no memory for %ld particles\n", particles);
    return 1;
  }
  Begin();
  Masses();
  const double start = Now();
  for (long step = 0; step < steps; step++) {
    ToNodes();
    Ends(1);
    OnNodes();
    Ends(0);
    ToParticles();
  }
  const double seconds = Now() - start;
  printf("{\"ns_per_particle_step\": %.6g, \"energy\": %.17g}\n", 1e9 * seconds / (double)particles / (double)steps,
         Energy());
  return 0;
}
