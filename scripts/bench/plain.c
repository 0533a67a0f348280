/* What the plain C schemes share: arguments, layout, initial data, clock, and the ends of a periodic grid. */
#include "plain.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double Now(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double *Array(long n)
{
  double *a = calloc((size_t)n, sizeof *a);

  if (!a) {
    fprintf(stderr, "no memory for %ld numbers\n", n);
    exit(1);
  }
  return a;
}

void Zero(const Scene *scene, double node[])
{
  for (long i = 0; i < scene->cells + 3; i++) node[i] = 0;
}

void Fold(const Scene *scene, double node[])
{
  const long n = scene->cells;

  node[n] += node[0];
  node[1] += node[n + 1];
  node[2] += node[n + 2];
}

void Spread(const Scene *scene, double node[])
{
  const long n = scene->cells;

  node[0]     = node[n];
  node[n + 1] = node[1];
  node[n + 2] = node[2];
}

void Complete(const Scene *scene, double node[])
{
  Fold(scene, node);
  for (long i = 1; i <= scene->cells; i++) node[i] /= scene->mass[i];
  Spread(scene, node);
}

double Squares(const Scene *scene)
{
  double sum = 0;

  for (long p = 0; p < scene->particles; p++) sum += scene->u[p] * scene->u[p] + scene->s[p] * scene->s[p];
  return sum / (double)(2 * scene->particles);
}

/* Sets a wave of 32 cells. With a drift of 1/100 or 3/10 of a cell per step these particles never meet a node. */
static void Begin(Scene *scene)
{
  for (long p = 0; p < scene->particles; p++) {
    const double x = (double)(p / PPC) + ((double)(p % PPC) + 0.51) / PPC;
    double       phi[NODES];
    const long   first = Weights(x, phi);

    scene->x[p] = x;
    scene->u[p] = sin(2 * acos(-1) * (double)(scene->cells / 32) * x / (double)scene->cells);
    for (int n = 0; n < NODES; n++) scene->mass[first + n] += phi[n];
  }
  Fold(scene, scene->mass);
}

int main(int argc, char **argv)
{
  if (argc != 4) {
    fprintf(stderr, "usage: %s PARTICLES STEPS DRIFT\n", argv[0]);
    return 2;
  }
  Scene scene = {.particles = atol(argv[1]), .steps = atol(argv[2]), .drift = atof(argv[3])};

  scene.cells = scene.particles / PPC;
  scene.x     = Array(scene.particles);
  scene.u     = Array(scene.particles);
  scene.s     = Array(scene.particles);
  scene.mass  = Array(scene.cells + 3);
  for (int n = 0; n < 4; n++) scene.node[n] = Array(scene.cells + 3);
  Begin(&scene);
  const double start = Now();
  March(&scene);
  const double seconds = Now() - start;
  printf("{\"ns_per_particle_step\": %.6g, \"energy\": %.17g}\n",
         1e9 * seconds / (double)scene.particles / (double)scene.steps, Energy(&scene));
  return 0;
}
