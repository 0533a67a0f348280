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

/* Weights of a particle's four nodes; returns what a gather divides by. */
typedef PetscReal (*Weights)(PetscReal xi, PetscReal width, PetscReal weight[4]);

static inline PetscReal Phi(PetscReal xi, PetscReal width, PetscReal weight[4])
{
  Values(xi, width, weight);
  return 1;
}

static inline PetscReal Gradient(PetscReal xi, PetscReal width, PetscReal weight[4])
{
  Slopes(xi, width, weight);
  return 1;
}

/* phi (x_i - x_p) / h; returns sum_i phi (x_i - x_p)^2 / h^2. */
static inline PetscReal Moment(PetscReal xi, PetscReal width, PetscReal weight[4])
{
  PetscReal sum = 0;

  Values(xi, width, weight);
  for (int d = 0; d < 4; d++) {
    const PetscReal distance = d - 1 - xi;

    weight[d] *= distance;
    sum += weight[d] * distance;
  }
  return sum;
}

/* The compiler knows which weights: they are inlined. */
static inline void Scatter(Weights weights, PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                           PetscReal width, PetscReal a, const PetscReal *restrict particle, PetscReal *restrict node)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal weight[4];

    (void)weights(xi[p], width, weight);
    for (int d = 0; d < 4; d++) node[cell[p] + d - 1] += weight[d] * (a * particle[p]);
  }
}

static inline void Gather(Weights weights, PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                          PetscReal width, PetscReal a, PetscReal *restrict particle, const PetscReal *restrict node)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal       weight[4], sum = 0;
    const PetscReal divisor = weights(xi[p], width, weight);

    for (int d = 0; d < 4; d++) sum += weight[d] * node[cell[p] + d - 1];
    particle[p] += a / divisor * sum;
  }
}

static void P2G_(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                 PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Phi, n, cell, xi, width, a, particle, node);
}

static void P2GAffine(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                      PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Moment, n, cell, xi, width, a, particle, node);
}

static void Div(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Gradient, n, cell, xi, width, a, particle, node);
}

static void G2P_(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                 PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Phi, n, cell, xi, width, a, particle, node);
}

static void G2PAffine(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                      PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Moment, n, cell, xi, width, a, particle, node);
}

static void Grad(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width, PetscReal a,
                 PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Gradient, n, cell, xi, width, a, particle, node);
}

static void P2GMass(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi, PetscReal width,
                    const PetscReal *restrict particle, PetscReal *restrict node, PetscReal *restrict mass)
{
  for (PetscInt p = 0; p < n; p++) {
    PetscReal phi[4];

    Values(xi[p], width, phi);
    for (int d = 0; d < 4; d++) {
      node[cell[p] + d - 1] += phi[d] * particle[p];
      mass[cell[p] + d - 1] += phi[d];
    }
  }
}

#define FOUR_NODES                                                                                                     \
  .reach_left = 1, .reach_right = 2, .p2g_mass = P2GMass,                                                              \
  .kernel = {[MPM_P2G] = P2G_, [MPM_P2G_AFFINE] = P2GAffine, [MPM_DIV] = Div,                                          \
             [MPM_G2P] = G2P_, [MPM_G2P_AFFINE] = G2PAffine, [MPM_GRAD] = Grad}
