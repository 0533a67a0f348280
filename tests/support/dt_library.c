/* include/mpmstab_dt.h as a function that other languages can call. moduli: lambda and mu, or with young 1 Young and Poisson. */
#include <mpmstab_dt.h>
#include <stdlib.h>

/* Answers: the step, omega2, omega2_least, the particle. Returns what is wrong, or NULL. */
const char *dt_step(int dim, int basis, int mls, const double *h, const double *origin, const long *nodes,
                    const int *periodic, const unsigned char *fixed, long particles, const double *x,
                    const double *volume, const double *mass, const double *moduli, int young, double factor,
                    int sweeps, int products, double chance, unsigned long long seed, int bound, double *mode,
                    double *answers)
{
  mpmstab_dt_layout at;

  mpmstab_dt_init(&at, dim, basis, 1, nodes[0], nodes[1], nodes[2]);
  for (int a = 0; a < dim; a++) at.h[a] = h[a], at.origin[a] = origin[a], at.periodic[a] = periodic[a];
  at.mls = mls, at.fixed = fixed, at.particles = particles, at.factor = factor, at.sweeps = sweeps;
  at.products = products, at.chance = chance, at.seed = seed, at.mode = mode;
  at.x                              = mpmstab_dt_numbers(x, sizeof(double), sizeof(double) * (size_t)dim);
  at.volume                         = mpmstab_dt_numbers(volume, sizeof(double), sizeof(double));
  at.mass                           = mpmstab_dt_numbers(mass, sizeof(double), sizeof(double));
  *(young ? &at.young : &at.lambda) = mpmstab_dt_numbers(moduli, sizeof(double), 2 * sizeof(double));
  *(young ? &at.poisson : &at.mu)   = mpmstab_dt_numbers(moduli + 1, sizeof(double), 2 * sizeof(double));
  at.work                           = malloc(mpmstab_dt_bytes(&at));
  answers[0]                        = mpmstab_dt_step(&at, bound);
  answers[1] = at.omega2, answers[2] = at.omega2_least, answers[3] = (double)at.particle;
  free(at.work);
  return at.error;
}
