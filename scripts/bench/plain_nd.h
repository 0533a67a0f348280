/*
   What the plain loops in two or three dimensions (DIM) share: the grid, periodic and of as many cells in each direction,
   regular or jittered places, and weights at NODES nodes in each direction.
*/
#pragma once
#include <math.h>
#include <stdint.h>
#include <time.h>

#define PPC 2

/* Nodes have indices -1 to cells + 1 in each direction; stride is the distance along each. */
static long cells, across, nodes, particles, stride[DIM];

#if DIM == 2
#define FOR_NODES(i)                                                                                                   \
  for (int i[3] = {0, 0, 0}; i[1] < NODES; i[1]++)                                                                     \
    for (i[0] = 0; i[0] < NODES; i[0]++)
#else
#define FOR_NODES(i)                                                                                                   \
  for (int i[3] = {0, 0, 0}; i[2] < NODES; i[2]++)                                                                     \
    for (i[1] = 0; i[1] < NODES; i[1]++)                                                                               \
      for (i[0] = 0; i[0] < NODES; i[0]++)
#endif

static double Now(void)
{
  struct timespec t;

  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static void SetSize(long number_of_cells)
{
  cells     = number_of_cells;
  across    = cells + 3;
  nodes     = 1;
  particles = 1;
  for (int a = 0; a < DIM; a++) {
    stride[a] = nodes;
    nodes *= across;
    particles *= cells * PPC;
  }
}

/* The weights and slopes along a direction; returns the first node. */
static inline long Along(double x, double phi[NODES], double slope[NODES])
{
#if NODES == 2
  const long i = (long)x;

  phi[0]   = 1 - (x - (double)i);
  phi[1]   = x - (double)i;
  slope[0] = -1;
  slope[1] = 1;
  return i;
#elif NODES == 3
  const long   i = (long)(x + 0.5); /* the nearest node */
  const double d = x - (double)i;

  phi[0]   = 0.5 * (0.5 - d) * (0.5 - d);
  phi[1]   = 0.75 - d * d;
  phi[2]   = 0.5 * (0.5 + d) * (0.5 + d);
  slope[0] = d - 0.5;
  slope[1] = -2 * d;
  slope[2] = d + 0.5;
  return i - 1;
#else
  const long   i = (long)x;
  const double d = x - (double)i, e = 1 - d;

  phi[0]   = e * e * e / 6;
  phi[1]   = 2.0 / 3 - d * d + d * d * d / 2;
  phi[2]   = 2.0 / 3 - e * e + e * e * e / 2;
  phi[3]   = d * d * d / 6;
  slope[0] = -e * e / 2;
  slope[1] = -2 * d + 1.5 * d * d;
  slope[2] = 2 * e - 1.5 * e * e;
  slope[3] = d * d / 2;
  return i - 1;
#endif
}

/* The weight of one node. */
static inline double At(const int i[], double phi[][NODES])
{
#if DIM == 2
  return phi[0][i[0]] * phi[1][i[1]];
#else
  return phi[0][i[0]] * phi[1][i[1]] * phi[2][i[2]];
#endif
}

/* Its gradient. */
static inline void Slope(const int i[], double phi[][NODES], double slope[][NODES], double g[])
{
#if DIM == 2
  g[0] = slope[0][i[0]] * phi[1][i[1]];
  g[1] = phi[0][i[0]] * slope[1][i[1]];
#else
  g[0] = slope[0][i[0]] * phi[1][i[1]] * phi[2][i[2]];
  g[1] = phi[0][i[0]] * slope[1][i[1]] * phi[2][i[2]];
  g[2] = phi[0][i[0]] * phi[1][i[1]] * slope[2][i[2]];
#endif
}

static inline long Of(long first, const int i[])
{
#if DIM == 2
  return first + i[0] + i[1] * stride[1];
#else
  return first + i[0] + i[1] * stride[1] + i[2] * stride[2];
#endif
}

/* Adds up what is one node of a periodic grid (fold), or gives all of them its value: one direction after another. */
static void Ends(int fold, double *values, long length)
{
  for (int a = 0; a < DIM; a++) {
    for (long n = 0; n < nodes; n++) {
      const long i    = n / stride[a] % across;
      double    *here = values + n * length, *own = here + (i == 0 ? cells : -cells) * stride[a] * length;

      if (i != 0 && i <= cells) continue; /* 1 to cells are its own */
      for (long c = 0; c < length; c++) {
        if (fold)
          own[c] += here[c];
        else
          here[c] = own[c];
      }
    }
  }
}

/* Random numbers in [0, 1): those of docs/theory.md, section 1, so that jittered particles are where mpmstab has them. */
static double Hash(uint64_t seed, uint64_t id)
{
  uint64_t z = seed + (id + 1) * 0x9E3779B97F4A7C15u;

  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
  return (double)((z ^ (z >> 31)) >> 11) * 0x1p-53;
}

/* Where particle p rests. Particles are in the order of cells. */
static void Place(long p, double jitter, double x[DIM])
{
  const int of_cell = DIM == 2 ? PPC * PPC : PPC * PPC * PPC;
  long      cell = p / of_cell, site = p % of_cell, number = 0, row = 1;

  for (int a = 0; a < DIM; a++, row *= cells * PPC, cell /= cells, site /= PPC)
    number += row * (cell % cells * PPC + site % PPC);
  cell = p / of_cell;
  site = p % of_cell;
  for (int a = 0; a < DIM; a++, cell /= cells, site /= PPC) {
    const uint64_t seed  = a ? (uint64_t)(0x1p52 * Hash(2, (uint64_t)(-66 - a))) : 1;
    const double   shift = jitter * (Hash(seed, (uint64_t)number) - 0.5);

    x[a] = fmod((double)(cell % cells + cells) + ((double)(site % PPC) + 0.51 + shift) / PPC, (double)cells);
  }
}
