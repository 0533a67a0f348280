/*
   The maps of a basis whose particles see NODES nodes in a row. A basis includes this after it has defined NODES and

     static inline PetscInt First(PetscReal xi);                                      the first of them, from the cell's
                                                                                      left node
     static inline void Values(PetscReal xi, PetscReal width, PetscReal phi[NODES]);
     static inline void Slopes(PetscReal xi, PetscReal width, PetscReal slope[NODES]);    h dphi/dx

   Sums stay in registers while particles see the same nodes, and all but the first are carried on when they see
   the next ones: a sum in memory would wait for the one before it to be stored.
*/
#pragma once
#include <mpmstab/basis.h>

static inline PetscInt First(PetscReal xi);
static inline void     Values(PetscReal xi, PetscReal width, PetscReal phi[NODES]);
static inline void     Slopes(PetscReal xi, PetscReal width, PetscReal slope[NODES]);

/* Weights of a particle's nodes; returns what a gather divides by. */
typedef PetscReal (*Weights)(PetscReal xi, PetscReal width, PetscReal weight[NODES]);

static inline PetscReal Phi(PetscReal xi, PetscReal width, PetscReal weight[NODES])
{
  Values(xi, width, weight);
  return 1;
}

static inline PetscReal Gradient(PetscReal xi, PetscReal width, PetscReal weight[NODES])
{
  Slopes(xi, width, weight);
  return 1;
}

/* phi (x_i - x_p) / h; returns sum_i phi (x_i - x_p)^2 / h^2. */
static inline PetscReal Moment(PetscReal xi, PetscReal width, PetscReal weight[NODES])
{
  PetscReal sum = 0;

  Values(xi, width, weight);
  for (int d = 0; d < NODES; d++) {
    const PetscReal distance = First(xi) + d - xi;

    weight[d] *= distance;
    sum += weight[d] * distance;
  }
  return sum;
}

/* Gives what has been summed for nodes at, at + 1, ... to the nodes that are not among those from next on. */
static inline void Carry(PetscInt at, PetscInt next, PetscReal sum[NODES], PetscReal *restrict node)
{
  if (next == at + 1) {
    node[at] += sum[0];
    for (int d = 0; d < NODES - 1; d++) sum[d] = sum[d + 1];
    sum[NODES - 1] = 0;
  } else {
    for (int d = 0; d < NODES; d++) {
      node[at + d] += sum[d];
      sum[d] = 0;
    }
  }
}

/* The compiler knows which weights: they are inlined. */
static inline void Scatter(Weights weights, PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                           PetscReal width, PetscReal a, const PetscReal *restrict particle, PetscReal *restrict node)
{
  PetscReal sum[NODES] = {0};
  PetscInt  at         = 0;

  for (PetscInt p = 0; p < n; p++) {
    const PetscInt first = cell[p] + First(xi[p]);
    PetscReal      weight[NODES];

    (void)weights(xi[p], width, weight);
    if (p > 0 && first != at) Carry(at, first, sum, node);
    at = first;
    for (int d = 0; d < NODES; d++) sum[d] += weight[d] * (a * particle[p]);
  }
  for (int d = 0; d < NODES && n; d++) node[at + d] += sum[d];
}

static inline void Gather(Weights weights, PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                          PetscReal width, PetscReal a, PetscReal *restrict particle, const PetscReal *restrict node)
{
  for (PetscInt p = 0; p < n; p++) {
    const PetscInt  first = cell[p] + First(xi[p]);
    PetscReal       weight[NODES], sum = 0;
    const PetscReal divisor = weights(xi[p], width, weight);

    for (int d = 0; d < NODES; d++) sum += weight[d] * node[first + d];
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
  PetscReal sum[NODES] = {0}, of_mass[NODES] = {0};
  PetscInt  at = 0;

  for (PetscInt p = 0; p < n; p++) {
    const PetscInt first = cell[p] + First(xi[p]);
    PetscReal      phi[NODES];

    Values(xi[p], width, phi);
    if (p > 0 && first != at) {
      Carry(at, first, sum, node);
      Carry(at, first, of_mass, mass);
    }
    at = first;
    for (int d = 0; d < NODES; d++) {
      sum[d] += phi[d] * particle[p];
      of_mass[d] += phi[d];
    }
  }
  for (int d = 0; d < NODES && n; d++) {
    node[at + d] += sum[d];
    mass[at + d] += of_mass[d];
  }
}

#define KERNELS                                                                                                        \
  .p2g_mass = P2GMass, .kernel = {[MPM_P2G] = P2G_, [MPM_P2G_AFFINE] = P2GAffine, [MPM_DIV] = Div,                     \
                                  [MPM_G2P] = G2P_, [MPM_G2P_AFFINE] = G2PAffine, [MPM_GRAD] = Grad}
