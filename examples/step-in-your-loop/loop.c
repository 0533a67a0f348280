/* The step of a loop in C, from mpmstab_dt.h. loop [SHARE [LAYOUT.csv]]: steps of this share of the bound. */
#include "block.h"
#include <mpmstab_dt.h>

int main(int argc, char **argv)
{
  const double      share = argc > 1 ? atof(argv[1]) : 0.95;
  mpmstab_dt_layout at;
  double            dt = 0, moved = HUGE_VAL, first, energy = 0;

  start();
  if (argc > 2) { /* x, y, volume, mass: what mpmstab reads of a layout */
    FILE *file = fopen(argv[2], "w");

    if (!file) return 1;
    fprintf(file, "x,y,volume,mass\n");
    for (int k = 0; k < particles; k++)
      fprintf(file, "%.17g,%.17g,%.17g,%.17g\n", p[k].x[0], p[k].x[1], p[k].volume, p[k].mass);
    fclose(file);
  }

  /* once, before the loop */
  mpmstab_dt_init(&at, 2, MPMSTAB_DT_QUADRATIC, h, GRID, GRID, 1);
  at.particles = particles;
  at.x         = mpmstab_dt_numbers(p[0].x, sizeof(double), sizeof p[0]);
  at.volume    = mpmstab_dt_numbers(&p[0].volume, sizeof(double), sizeof p[0]);
  at.mass      = mpmstab_dt_numbers(&p[0].mass, sizeof(double), sizeof p[0]);
  at.young     = mpmstab_dt_numbers(&young, sizeof(double), 0);
  at.poisson   = mpmstab_dt_numbers(&poisson, sizeof(double), 0);
  at.mls       = 1;
  at.factor    = MPMSTAB_DT_MLS_MPM;
  at.work      = malloc(mpmstab_dt_bytes(&at));

  first = kinetic_energy();
  for (int n = 0; n < 2000 && energy < 1e6 * first; n++) {
    /* in the loop: a new certificate when the fastest particle may have moved a tenth of a cell */
    if (moved > 0.1 * h) {
      dt = share * mpmstab_dt_step(&at, MPMSTAB_DT_LANCZOS), moved = 0;
      if (at.error) {
        fprintf(stderr, "particle %ld has %s\n", at.particle, at.error);
        return 1;
      }
      if (!n) printf("largest step %.10g s\n", dt / share);
    }
    p2g(dt);
    move_grid();
    g2p(dt);
    moved += dt * fastest();
    energy = kinetic_energy();
  }
  printf("kinetic energy over that of the start %.3g\n", energy / first);
  free(at.work);
  return energy <= first ? 0 : 3;
}
