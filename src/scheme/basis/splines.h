/*
   The weights of B-splines of uniform knots: quadratic ones where a particle has NODES = 3 of them, cubic ones where it
   has 4. A file includes this header after nodes.h. With KNOTS_ON_NODES the splines of a cell are those of open knot
   vectors, whose knots are the ends of cells; else splines are centred on the nodes. Then a particle has quadratic
   splines at its nearest node, which is its cell's left or right one, and at that node's neighbours.
*/
#pragma once
#include <mpmstab/compat.h>

static inline PetscInt First(PetscReal xi)
{
#ifdef KNOTS_ON_NODES
  (void)xi;
  return 0;
#else
  return NODES == 3 && xi >= 0.5 ? 0 : -1;
#endif
}

#if NODES == 3
/* The distance from the middle of the second of three splines, abs(d) <= 1/2. */
static inline PetscReal FromMiddle(PetscReal xi)
{
#ifdef KNOTS_ON_NODES
  return xi - 0.5;
#else
  return xi < 0.5 ? xi : xi - 1;
#endif
}

static inline void Values(PetscReal xi, PetscReal phi[3])
{
  const PetscReal d = FromMiddle(xi);

  phi[0] = 0.5 * (0.5 - d) * (0.5 - d);
  phi[1] = 0.75 - d * d;
  phi[2] = 0.5 * (0.5 + d) * (0.5 + d);
}

static inline void Slopes(PetscReal xi, PetscReal slope[3])
{
  const PetscReal d = FromMiddle(xi);

  slope[0] = d - 0.5;
  slope[1] = -2 * d;
  slope[2] = d + 0.5;
}

#ifndef NO_CURVES
static inline void Curves(PetscReal xi, PetscReal curve[3])
{
  (void)xi;
  curve[0] = curve[2] = 1;
  curve[1]            = -2;
}
#endif
#else
/* xi is the distance from the middle of the second of four splines. */
static inline void Values(PetscReal xi, PetscReal phi[4])
{
  const PetscReal eta = 1 - xi;

  phi[0] = eta * eta * eta / 6;
  phi[1] = 2.0 / 3 - xi * xi + xi * xi * xi / 2;
  phi[2] = 2.0 / 3 - eta * eta + eta * eta * eta / 2;
  phi[3] = xi * xi * xi / 6;
}

static inline void Slopes(PetscReal xi, PetscReal slope[4])
{
  const PetscReal eta = 1 - xi;

  slope[0] = -eta * eta / 2;
  slope[1] = -2 * xi + 1.5 * xi * xi;
  slope[2] = 2 * eta - 1.5 * eta * eta;
  slope[3] = xi * xi / 2;
}

#ifndef NO_CURVES
static inline void Curves(PetscReal xi, PetscReal curve[4])
{
  const PetscReal eta = 1 - xi;

  curve[0] = eta;
  curve[1] = 3 * xi - 2;
  curve[2] = 3 * eta - 2;
  curve[3] = xi;
}
#endif
#endif
