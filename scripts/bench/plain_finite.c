/*
   Update stress last at finite strain in two or three dimensions (DIM), in plain C: usl with flip, neo-Hookean with
   lambda = mu, on quadratic splines (NODES is 3).

     PROGRAM CELLS STEPS DRIFT AMPLITUDE      prints ns per particle and step, and the energy, so that nothing is left out

   There are CELLS cells and two particles in each direction of a periodic grid of length 1. They start with one wave of
   velocity AMPLITUDE c0 along the first direction, and DRIFT cells a step in every direction besides. An array of structs
   for particles, sorted by cell every SORTED steps, and one for nodes; two sweeps over the particles a step, and the
   weights anew in each: as one writes it.
*/
#include "plain_nd.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define COURANT 0.1
#define SORTED 8
#define MU (1.0 / 3) /* in units of rho0 c0^2, so that lambda + 2 mu is 1 */
#define LAMBDA (1.0 / 3)

typedef struct {
  double x[DIM], v[DIM], f[DIM][DIM]; /* the place in cells, the velocity in c0, the deformation gradient */
} Particle;

typedef struct {
  double mass, v[DIM], a[DIM];
} Node;

static Particle *particle, *sorted;
static Node     *node;
static long     *bin; /* where the particles of a cell begin */

static inline long Weights(const double x[], double phi[][NODES], double slope[][NODES])
{
  long first = 0;

  for (int a = 0; a < DIM; a++) first += (Along(x[a], phi[a], slope[a]) + 1) * stride[a]; /* node 0 is at 1 */
  return first;
}

static inline double Volume(double f[DIM][DIM])
{
#if DIM == 2
  return f[0][0] * f[1][1] - f[0][1] * f[1][0];
#else
  return f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) - f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0]) +
         f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
#endif
}

/* The Kirchhoff stress mu (F F^T - I) + lambda ln J I. */
static inline void Stress(double f[DIM][DIM], double tau[DIM][DIM])
{
  const double pressure = LAMBDA * log(Volume(f));

  for (int a = 0; a < DIM; a++)
    for (int b = 0; b < DIM; b++) {
      tau[a][b] = a == b ? pressure - MU : 0;
      for (int c = 0; c < DIM; c++) tau[a][b] += MU * f[a][c] * f[b][c];
    }
}

static void ToNodes(void)
{
  memset(node, 0, (size_t)nodes * sizeof *node);
  for (long p = 0; p < particles; p++) {
    Particle  *q = &particle[p];
    double     phi[DIM][NODES], slope[DIM][NODES], g[DIM], tau[DIM][DIM];
    const long first = Weights(q->x, phi, slope);

    Stress(q->f, tau);
    FOR_NODES(i)
    {
      const double w = At(i, phi);
      Node        *n = node + Of(first, i);

      Slope(i, phi, slope, g);
      n->mass += w;
      for (int a = 0; a < DIM; a++) {
        double force = 0;

        for (int b = 0; b < DIM; b++) force += g[b] * tau[a][b];
        n->v[a] += w * q->v[a];
        n->a[a] -= COURANT * force;
      }
    }
  }
}

static void OnNodes(void)
{
  for (long n = 0; n < nodes; n++) {
    const double inverse = node[n].mass > 0 ? 1 / node[n].mass : 0;

    for (int a = 0; a < DIM; a++) {
      node[n].a[a] *= inverse;
      node[n].v[a] = node[n].v[a] * inverse + node[n].a[a];
    }
  }
}

/* F <- (I + k L) F */
static inline void Stretch(double l[DIM][DIM], double f[DIM][DIM])
{
  double next[DIM][DIM];

  for (int a = 0; a < DIM; a++)
    for (int b = 0; b < DIM; b++) {
      next[a][b] = f[a][b];
      for (int c = 0; c < DIM; c++) next[a][b] += COURANT * l[a][c] * f[c][b];
    }
  memcpy(f, next, sizeof next);
}

static void ToParticles(void)
{
  for (long p = 0; p < particles; p++) {
    Particle  *q = &particle[p];
    double     phi[DIM][NODES], slope[DIM][NODES], g[DIM], v[DIM] = {0}, change[DIM] = {0}, l[DIM][DIM] = {{0}};
    const long first = Weights(q->x, phi, slope);

    FOR_NODES(i)
    {
      const double w = At(i, phi);
      const Node  *n = node + Of(first, i);

      Slope(i, phi, slope, g);
      for (int a = 0; a < DIM; a++) {
        v[a] += w * n->v[a];
        change[a] += w * n->a[a];
        for (int b = 0; b < DIM; b++) l[a][b] += g[b] * n->v[a];
      }
    }
    Stretch(l, q->f);
    for (int a = 0; a < DIM; a++) {
      q->v[a] += change[a];
      q->x[a] += COURANT * v[a];
      if (q->x[a] >= (double)cells) q->x[a] -= (double)cells;
      if (q->x[a] < 0) q->x[a] += (double)cells;
    }
  }
}

static inline long Cell(const double x[])
{
  long cell = 0;

  for (int a = DIM - 1; a >= 0; a--) cell = cell * cells + (long)x[a];
  return cell;
}

/* By counting. */
static void Sort(void)
{
  const long of = DIM == 2 ? cells * cells : cells * cells * cells;
  Particle  *swap;

  memset(bin, 0, (size_t)(of + 1) * sizeof *bin);
  for (long p = 0; p < particles; p++) bin[Cell(particle[p].x) + 1]++;
  for (long c = 0; c < of; c++) bin[c + 1] += bin[c];
  for (long p = 0; p < particles; p++) sorted[bin[Cell(particle[p].x)]++] = particle[p];
  swap     = particle;
  particle = sorted;
  sorted   = swap;
}

/* Kinetic and strain energy of a domain of volume 1, in units of rho0 c0^2. */
static double Energy(void)
{
  double sum = 0;

  for (long p = 0; p < particles; p++) {
    Particle    *q         = &particle[p];
    const double logarithm = log(Volume(q->f));

    sum += LAMBDA / 2 * logarithm * logarithm - MU * logarithm - MU / 2 * DIM;
    for (int a = 0; a < DIM; a++) {
      sum += q->v[a] * q->v[a] / 2;
      for (int b = 0; b < DIM; b++) sum += MU / 2 * q->f[a][b] * q->f[a][b];
    }
  }
  return sum / (double)particles;
}

static void Begin(double drift, double amplitude)
{
  const double turn = 2 * acos(-1) / (double)cells;

  for (long p = 0; p < particles; p++) {
    Place(p, 0, particle[p].x);
    for (int a = 0; a < DIM; a++) {
      particle[p].v[a]    = drift / COURANT;
      particle[p].f[a][a] = 1;
    }
    particle[p].v[0] += amplitude * sin(turn * particle[p].x[0]);
  }
}

int main(int argc, char **argv)
{
  if (argc != 5) {
    fprintf(stderr, "usage: %s CELLS STEPS DRIFT AMPLITUDE\n", argv[0]);
    return 2;
  }
  const long steps = atol(argv[2]);

  SetSize(atol(argv[1]));
  particle = calloc((size_t)particles, sizeof *particle);
  sorted   = calloc((size_t)particles, sizeof *sorted);
  node     = calloc((size_t)nodes, sizeof *node);
  bin      = calloc((size_t)particles + 1, sizeof *bin);
  if (!particle || !sorted || !node || !bin) {
    fprintf(stderr, "no memory for %ld particles\n", particles);
    return 1;
  }
  Begin(atof(argv[3]), atof(argv[4]));
  const double start = Now();
  for (long step = 0; step < steps; step++) {
    if (step % SORTED == 0) Sort();
    ToNodes();
    Ends(1, (double *)node, sizeof(Node) / sizeof(double));
    OnNodes();
    Ends(0, (double *)node, sizeof(Node) / sizeof(double));
    ToParticles();
  }
  const double seconds = Now() - start;
  printf("{\"ns_per_particle_step\": %.6g, \"energy\": %.17g}\n", 1e9 * seconds / (double)particles / (double)steps,
         Energy());
  return 0;
}
