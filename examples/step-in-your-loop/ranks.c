/* The step of a loop with MPI: the least of all ranks, each with its own particles. ranks [SHARE]. */
#include "block.h"
#include <mpi.h>
#include <mpmstab_dt.h>

int main(int argc, char **argv)
{
  const double      share = argc > 1 ? atof(argv[1]) : 0.95;
  mpmstab_dt_layout at;
  double            dt = 0, moved = HUGE_VAL, fast, first, energy = 0;
  int               rank, size, n = 0;

  MPI_Init(&argc, &argv);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &size);
  start();
  for (int k = 0; k < MOST; k++) /* a rank owns the particles of a strip of the box */
    if ((int)(p[k].x[0] / (GRID * h) * size) == rank) p[n++] = p[k];
  particles = n;

  mpmstab_dt_init(&at, 2, MPMSTAB_DT_QUADRATIC, h, GRID, GRID, 1);
  at.particles = particles;
  at.x         = mpmstab_dt_numbers(p[0].x, sizeof(double), sizeof p[0]);
  at.volume    = mpmstab_dt_numbers(&p[0].volume, sizeof(double), sizeof p[0]);
  at.mass      = mpmstab_dt_numbers(&p[0].mass, sizeof(double), sizeof p[0]);
  at.young     = mpmstab_dt_numbers(&young, sizeof(double), 0);
  at.poisson   = mpmstab_dt_numbers(&poisson, sizeof(double), 0);
  at.mls       = 1;
  at.factor    = MPMSTAB_DT_MLS_MPM;
  at.chance    = 1e-6 / size; /* that none of the ranks is wrong */
  at.work      = malloc(mpmstab_dt_bytes(&at));

  first = kinetic_energy();
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  for (int step = 0; step < 2000 && energy < 1e6 * first; step++) {
    if (moved > 0.1 * h) {
      dt = mpmstab_dt_step(&at, MPMSTAB_DT_LANCZOS), moved = 0; /* HUGE_VAL on a rank without particles */
      MPI_Allreduce(MPI_IN_PLACE, &dt, 1, MPI_DOUBLE, MPI_MIN, MPI_COMM_WORLD);
      if (!rank && !step) printf("largest step %.10g s\n", dt);
      dt *= share;
    }
    p2g(dt);
    MPI_Allreduce(MPI_IN_PLACE, mass, GRID * GRID, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    MPI_Allreduce(MPI_IN_PLACE, momentum, 2 * GRID * GRID, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    move_grid();
    g2p(dt);
    fast = fastest(), energy = kinetic_energy();
    MPI_Allreduce(MPI_IN_PLACE, &fast, 1, MPI_DOUBLE, MPI_MAX, MPI_COMM_WORLD);
    MPI_Allreduce(MPI_IN_PLACE, &energy, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
    moved += dt * fast;
  }
  if (!rank) printf("kinetic energy over that of the start %.3g\n", energy / first);
  free(at.work);
  MPI_Finalize();
  return energy <= first ? 0 : 3;
}
