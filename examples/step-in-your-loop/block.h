/*
   MLS-MPM in two dimensions: a block of rubber with particles anywhere in it, all of which tremble. Small strain, quadratic
   splines, apic, stress last. Nothing here is of mpmstab; a step is p2g, move_grid and g2p.
*/
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { GRID = 24, MOST = 400 };

typedef struct {
  double x[2], v[2], C[2][2], stress[2][2], volume, mass;
} Particle;

static const double h = 0.01, young = 1e6, poisson = 0.3, density = 1000;
static Particle     p[MOST];
static int          particles = MOST;
static double       mass[GRID][GRID], momentum[GRID][GRID][2];

static double any(void)
{
  return rand() / (RAND_MAX + 1.0);
}

static void start(void)
{
  srand(1);
  for (int k = 0; k < particles; k++) {
    for (int a = 0; a < 2; a++) p[k].x[a] = h * (7 + 10 * any());
    p[k].volume = h * h / 4;
    p[k].mass   = density * p[k].volume;
    for (int a = 0; a < 2; a++) p[k].v[a] = 1e-3 * (any() - 0.5);
  }
}

/* The nine nodes of a particle: the first one, weights, and how far the first one is. */
static void weigh(const Particle *q, int first[2], double w[2][3], double arm[2])
{
  for (int a = 0; a < 2; a++) {
    const double t = q->x[a] / h, f = t - floor(t - 0.5);

    first[a] = (int)floor(t - 0.5), arm[a] = -f * h;
    w[a][0] = (1.5 - f) * (1.5 - f) / 2, w[a][1] = 0.75 - (f - 1) * (f - 1), w[a][2] = (f - 0.5) * (f - 0.5) / 2;
  }
}

static void p2g(double dt)
{
  memset(mass, 0, sizeof mass), memset(momentum, 0, sizeof momentum);
  for (int k = 0; k < particles; k++) {
    int    first[2];
    double w[2][3], arm[2];

    weigh(&p[k], first, w, arm);
    for (int n = 0; n < 9; n++) {
      const int    i = n % 3, j = n / 3;
      const double weight = w[0][i] * w[1][j], r[2] = {arm[0] + i * h, arm[1] + j * h};

      mass[first[0] + i][first[1] + j] += weight * p[k].mass;
      for (int a = 0; a < 2; a++) {
        const double affine = p[k].v[a] + p[k].C[a][0] * r[0] + p[k].C[a][1] * r[1];
        const double force  = -p[k].volume * 4 / (h * h) * (p[k].stress[a][0] * r[0] + p[k].stress[a][1] * r[1]);

        momentum[first[0] + i][first[1] + j][a] += weight * (p[k].mass * affine + dt * force);
      }
    }
  }
}

static void move_grid(void)
{
  for (int i = 0; i < GRID; i++)
    for (int j = 0; j < GRID; j++)
      for (int a = 0; a < 2; a++)
        if (mass[i][j] > 0) momentum[i][j][a] /= mass[i][j]; /* now a velocity */
}

static void g2p(double dt)
{
  const double mu = young / (2 * (1 + poisson)), lambda = 2 * mu * poisson / (1 - 2 * poisson);

  for (int k = 0; k < particles; k++) {
    int    first[2];
    double w[2][3], arm[2];

    weigh(&p[k], first, w, arm);
    memset(p[k].v, 0, sizeof p[k].v), memset(p[k].C, 0, sizeof p[k].C);
    for (int n = 0; n < 9; n++)
      for (int a = 0; a < 2; a++) {
        const int    i = n % 3, j = n / 3;
        const double v = w[0][i] * w[1][j] * momentum[first[0] + i][first[1] + j][a];

        p[k].v[a] += v;
        p[k].C[a][0] += 4 / (h * h) * v * (arm[0] + i * h);
        p[k].C[a][1] += 4 / (h * h) * v * (arm[1] + j * h);
      }
    for (int a = 0; a < 2; a++) {
      p[k].x[a] += dt * p[k].v[a];
      for (int b = 0; b < 2; b++)
        p[k].stress[a][b] +=
            dt * (mu * (p[k].C[a][b] + p[k].C[b][a]) + (a == b ? lambda * (p[k].C[0][0] + p[k].C[1][1]) : 0));
    }
  }
}

static double fastest(void)
{
  double most = 0;

  for (int k = 0; k < particles; k++) most = fmax(most, hypot(p[k].v[0], p[k].v[1]));
  return most;
}

static double kinetic_energy(void)
{
  double sum = 0;

  for (int k = 0; k < particles; k++) sum += p[k].mass * (p[k].v[0] * p[k].v[0] + p[k].v[1] * p[k].v[1]) / 2;
  return sum;
}
