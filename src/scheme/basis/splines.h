/* The B-splines of uniform knots that a place has weights at, from the left. */
#pragma once
#include <mpmstab/compat.h>

/* d: the distance from the middle of the second of three quadratic splines, abs(d) <= 1/2. */
static inline void QuadraticValues(PetscReal d, PetscReal phi[3])
{
  phi[0] = 0.5 * (0.5 - d) * (0.5 - d);
  phi[1] = 0.75 - d * d;
  phi[2] = 0.5 * (0.5 + d) * (0.5 + d);
}

static inline void QuadraticSlopes(PetscReal d, PetscReal slope[3])
{
  slope[0] = d - 0.5;
  slope[1] = -2 * d;
  slope[2] = d + 0.5;
}

static inline void QuadraticCurves(PetscReal curve[3])
{
  curve[0] = 1;
  curve[1] = -2;
  curve[2] = 1;
}

/* xi: the distance from the middle of the second of four cubic splines, 0 <= xi <= 1. */
static inline void CubicValues(PetscReal xi, PetscReal phi[4])
{
  const PetscReal eta = 1 - xi;

  phi[0] = eta * eta * eta / 6;
  phi[1] = 2.0 / 3 - xi * xi + xi * xi * xi / 2;
  phi[2] = 2.0 / 3 - eta * eta + eta * eta * eta / 2;
  phi[3] = xi * xi * xi / 6;
}

static inline void CubicSlopes(PetscReal xi, PetscReal slope[4])
{
  const PetscReal eta = 1 - xi;

  slope[0] = -eta * eta / 2;
  slope[1] = -2 * xi + 1.5 * xi * xi;
  slope[2] = 2 * eta - 1.5 * eta * eta;
  slope[3] = xi * xi / 2;
}

static inline void CubicCurves(PetscReal xi, PetscReal curve[4])
{
  const PetscReal eta = 1 - xi;

  curve[0] = eta;
  curve[1] = 3 * xi - 2;
  curve[2] = 3 * eta - 2;
  curve[3] = xi;
}
