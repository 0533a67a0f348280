/*
   The maps of a basis whose particles see four nodes, those at -1, 0, 1 and 2 from their cell's left node. A basis
   includes this after it has defined

     static inline void Values(PetscReal xi, PetscReal width, PetscReal phi[4]);
     static inline void Slopes(PetscReal xi, PetscReal width, PetscReal slope[4]);    h dphi/dx
*/
#pragma once
#include <mpmstab/basis.h>

static inline void Values(PetscReal xi, PetscReal width, PetscReal phi[4]);
static inline void Slopes(PetscReal xi, PetscReal width, PetscReal slope[4]);

/* phi (x_i - x_p) / h; returns sum_i phi (x_i - x_p)^2 / h^2. */
static inline PetscReal Moments(PetscReal xi, PetscReal width, PetscReal moment[4])
{
  PetscReal sum = 0;

  Values(xi, width, moment);
  for (int d = 0; d < 4; d++) {
    const PetscReal distance = d - 1 - xi;

    moment[d] *= distance;
    sum += moment[d] * distance;
  }
  return sum;
}

static inline void Scatter(PetscReal q, const PetscReal weight[4], PetscReal *restrict node)
{
  for (int d = 0; d < 4; d++) node[d - 1] += weight[d] * q;
}

static inline PetscReal Gather(const PetscReal weight[4], const PetscReal *restrict node)
{
  PetscReal sum = 0;

  for (int d = 0; d < 4; d++) sum += weight[d] * node[d - 1];
  return sum;
}

static void P2G_(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                 PetscReal *restrict particle, PetscReal *restrict node)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal phi[4];

    Values(xi[p], width, phi);
    Scatter(a * particle[p], phi, node + cell[p]);
  }
}

static void P2GMass(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                    const PetscReal *restrict particle, PetscReal *restrict node, PetscReal *restrict mass)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal phi[4];

    Values(xi[p], width, phi);
    Scatter(particle[p], phi, node + cell[p]);
    Scatter(1, phi, mass + cell[p]);
  }
}

static void P2GAffine(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                      PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal moment[4];

    (void)Moments(xi[p], width, moment);
    Scatter(a * particle[p], moment, node + cell[p]);
  }
}

static void Div(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                PetscReal *restrict particle, PetscReal *restrict node)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal slope[4];

    Slopes(xi[p], width, slope);
    Scatter(a * particle[p], slope, node + cell[p]);
  }
}

static void G2P_(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                 PetscReal *restrict particle, PetscReal *restrict node)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal phi[4];

    Values(xi[p], width, phi);
    particle[p] += a * Gather(phi, node + cell[p]);
  }
}

static void G2PAffine(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                      PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal       moment[4];
    const PetscReal D = Moments(xi[p], width, moment);

    particle[p] += a / D * Gather(moment, node + cell[p]);
  }
}

static void Grad(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                 PetscReal *restrict particle, PetscReal *restrict node)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal slope[4];

    Slopes(xi[p], width, slope);
    particle[p] += a * Gather(slope, node + cell[p]);
  }
}

#define FOUR_NODES                                                                                                     \
  .reach_left = 1, .reach_right = 2, .p2g_mass = P2GMass,                                                              \
  .kernel = {[MPM_P2G] = P2G_, [MPM_P2G_AFFINE] = P2GAffine, [MPM_DIV] = Div,                                          \
             [MPM_G2P] = G2P_, [MPM_G2P_AFFINE] = G2PAffine, [MPM_GRAD] = Grad}
