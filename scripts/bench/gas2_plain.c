/*
   The yardstick: Formulation 2 as one would write it straight, three sweeps over the particles, nothing
   clever.

     gas2_plain PARTICLES PPC STEPS DRIFT      prints ns per particle and step, and the energy, so that
   nothing is left out
*/
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

  if (!a) exit(1);
  return a;
}

int main(int argc, char **argv)
{
  if (argc != 5) return 2;
  const long   np = atol(argv[1]), ppc = atol(argv[2]), steps = atol(argv[3]), nc = np / ppc;
  const double drift = atof(argv[4]), k = 0.5;
  double *x = Array(np), *u = Array(np), *r = Array(np), *ui = Array(nc + 1), *ri = Array(nc + 1), *m = Array(nc + 1);

  for (long p = 0; p < np; p++) {
    x[p] = (double)(p / ppc) + ((double)(p % ppc) + 0.5) / (double)ppc;
    u[p] = sin(2 * acos(-1) * x[p] / (double)nc);
  }
  for (long p = 0; p < np; p++) {
    const long   i  = (long)x[p];
    const double xi = x[p] - (double)i;

    m[i] += 1 - xi;
    m[i + 1] += xi;
  }
  m[0] += m[nc];
  const double start = Now();
  for (long step = 0; step < steps; step++) {
    for (long i = 0; i <= nc; i++) ri[i] = 0;
    if (drift != 0) {
      for (long i = 0; i <= nc; i++) m[i] = 0;
      for (long p = 0; p < np; p++) {
        const long   i  = (long)x[p];
        const double xi = x[p] - (double)i;

        ri[i] += (1 - xi) * r[p];
        ri[i + 1] += xi * r[p];
        m[i] += 1 - xi;
        m[i + 1] += xi;
      }
      m[0] += m[nc];
    } else {
      for (long p = 0; p < np; p++) {
        const long   i  = (long)x[p];
        const double xi = x[p] - (double)i;

        ri[i] += (1 - xi) * r[p];
        ri[i + 1] += xi * r[p];
      }
    }
    ri[0] += ri[nc];
    for (long i = 0; i < nc; i++) ri[i] /= m[i];
    ri[nc] = ri[0];
    for (long i = 0; i <= nc; i++) ui[i] = 0;
    for (long p = 0; p < np; p++) {
      const long   i  = (long)x[p];
      const double xi = x[p] - (double)i;

      u[p] += k * (ri[i + 1] - ri[i]);
      ui[i] += (1 - xi) * u[p];
      ui[i + 1] += xi * u[p];
    }
    ui[0] += ui[nc];
    for (long i = 0; i < nc; i++) ui[i] /= m[i];
    ui[nc] = ui[0];
    if (drift != 0) {
      for (long p = 0; p < np; p++) {
        const long   i = (long)x[p];
        const double y = x[p] + drift;

        r[p] += k * (ui[i + 1] - ui[i]);
        x[p] = y >= (double)nc ? y - (double)nc : y;
      }
    } else {
      for (long p = 0; p < np; p++) {
        const long i = (long)x[p];

        r[p] += k * (ui[i + 1] - ui[i]);
      }
    }
  }
  const double seconds = Now() - start;
  double       energy  = 0;

  for (long p = 0; p < np; p++) energy += (u[p] * u[p] + r[p] * r[p]) / (double)(2 * np);
  printf("{\"ns_per_particle_step\": %.6g, \"energy\": %.17g}\n", 1e9 * seconds / (double)np / (double)steps, energy);
  return 0;
}
