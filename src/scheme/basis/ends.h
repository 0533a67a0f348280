/*
   The maps of B-splines that have other functions next to walls. These functions are sums of the uniform splines. So
   the weights of a particle are those of the uniform splines, altered where it is near a wall. The file of a basis
   defines NODES, includes this header, and then defines

     static inline PetscInt  First(PetscReal xi);
     static inline PetscReal Offset(void);
     static inline void      Values(PetscReal xi, PetscReal phi[NODES]);
     static inline void      Slopes(PetscReal xi, PetscReal slope[NODES]);
     static inline void      Alter(PetscInt before, PetscInt step, PetscReal w[]);
     static inline void      Shift(PetscInt before, PetscInt step, PetscReal r[]);

   First is the first of the particle's nodes, counted from the cell's left node. Node i of the uniform splines is at
   (i + Offset) h. Values and Slopes are of uniform splines. Alter turns values or slopes of uniform splines, w[0],
   w[step], w[2 step] ..., into those of the basis at one wall, and Shift moves the nodes' places. before is the number of
   nodes between the wall's node and w[0], and step leads away from the wall: 1 at the left, -1 at the right.
*/
#pragma once
#include "scheme/kernels.h"

_Static_assert(NODES <= MPM_MOST_NODES,
               "a basis has more nodes a direction than MPM_MOST_NODES, which arrays are made for");

static inline PetscInt  First(PetscReal xi);
static inline PetscReal Offset(void);
static inline void      Values(PetscReal xi, PetscReal phi[NODES]);
static inline void      Slopes(PetscReal xi, PetscReal slope[NODES]);
static inline void      Alter(PetscInt before, PetscInt step, PetscReal w[]);
static inline void      Shift(PetscInt before, PetscInt step, PetscReal r[]);

/* Below this, D = sum_i phi (x_i - x_p)^2 / h^2 is rounding: the particle is on a wall whose node has all of its weight. */
#define NO_SPREAD 1e-8

/* Sets the weights of the nodes of particle p. */
typedef void (*Weights)(const MpmBlock *b, PetscInt p, PetscReal weight[NODES]);

/* Alters values or slopes at the walls that are near. */
static inline void AlterNear(const MpmBlock *b, PetscInt p, PetscReal weight[NODES])
{
  Alter(b->first[p] - b->wall[0], 1, weight);
  Alter(b->wall[1] - (b->first[p] + NODES - 1), -1, weight + NODES - 1);
}

static inline void Phi(const MpmBlock *b, PetscInt p, PetscReal weight[NODES])
{
  Values(b->xi[p], weight);
  AlterNear(b, p, weight);
}

static inline void Gradient(const MpmBlock *b, PetscInt p, PetscReal weight[NODES])
{
  Slopes(b->xi[p], weight);
  AlterNear(b, p, weight);
}

/* Sets r[d] = (x_i - x_p) / h. */
static inline void Distances(const MpmBlock *b, PetscInt p, PetscReal r[NODES])
{
  for (int d = 0; d < NODES; d++) r[d] = First(b->xi[p]) + d + Offset() - b->xi[p];
  Shift(b->first[p] - b->wall[0], 1, r);
  Shift(b->wall[1] - (b->first[p] + NODES - 1), -1, r + NODES - 1);
}

/* The weights are phi (x_i - x_p) / h. */
static inline void Moment(const MpmBlock *b, PetscInt p, PetscReal weight[NODES])
{
  PetscReal r[NODES];

  Distances(b, p, r);
  Phi(b, p, weight);
  for (int d = 0; d < NODES; d++) weight[d] *= r[d];
}

/* The weights are phi (x_i - x_p) h / D. At a wall they go over into the slopes, as D goes to 0. */
static inline void Fitted(const MpmBlock *b, PetscInt p, PetscReal weight[NODES])
{
  PetscReal r[NODES], sum = 0;

  Distances(b, p, r);
  Moment(b, p, weight);
  for (int d = 0; d < NODES; d++) sum += weight[d] * r[d];
  if (sum < NO_SPREAD)
    Gradient(b, p, weight);
  else
    for (int d = 0; d < NODES; d++) weight[d] /= sum;
}

/* Adds a sum_p weight particle[p] to the nodes; particle NULL: of ones. */
static inline void Scatter(Weights weights, const MpmBlock *b, PetscReal a, const PetscReal *restrict particle,
                           PetscReal *restrict node)
{
  for (PetscInt p = 0; p < b->n; p++) {
    const PetscReal q = particle ? a * particle[p] : a;
    PetscReal       weight[NODES];

    weights(b, p, weight);
    for (int d = 0; d < NODES; d++) node[b->first[p] + d] += weight[d] * q;
  }
}

static inline void Gather(Weights weights, const MpmBlock *b, PetscReal a, PetscReal *restrict particle,
                          const PetscReal *restrict node)
{
  for (PetscInt p = 0; p < b->n; p++) {
    PetscReal weight[NODES], sum = 0;

    weights(b, p, weight);
    for (int d = 0; d < NODES; d++) sum += weight[d] * node[b->first[p] + d];
    particle[p] += a * sum;
  }
}

static inline void WeightsOfEach(Weights weights, const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  for (PetscInt p = 0; p < b->n; p++) {
    PetscReal of_particle[NODES];

    weights(b, p, of_particle);
    for (int d = 0; d < NODES; d++) weight[d * stride + p] = of_particle[d];
  }
}

static void PhiWeights(const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  WeightsOfEach(Phi, b, stride, weight);
}

static void GradientWeights(const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  WeightsOfEach(Gradient, b, stride, weight);
}

static void MomentWeights(const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  WeightsOfEach(Moment, b, stride, weight);
}

static void FittedWeights(const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  WeightsOfEach(Fitted, b, stride, weight);
}

static void FirstNodes(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                       PetscInt *restrict first)
{
  for (PetscInt p = 0; p < n; p++) first[p] = cell[p] + First(xi[p]);
}

static void P2G_(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Phi, b, a, particle, node);
}

static void P2GMass(const MpmBlock *b, const PetscReal *restrict particle, PetscReal *restrict node,
                    PetscReal *restrict mass)
{
  Scatter(Phi, b, 1, particle, node);
  Scatter(Phi, b, 1, NULL, mass);
}

static void P2GAffine(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Moment, b, a, particle, node);
}

static void Div(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Gradient, b, a, particle, node);
}

static void DivMls(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Fitted, b, a, particle, node);
}

static void G2P_(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Phi, b, a, particle, node);
}

static void Grad(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Gradient, b, a, particle, node);
}

/* GRAD_MLS is the same map. */
static void G2PAffine(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Fitted, b, a, particle, node);
}

#define KERNELS                                                                                                        \
  .nodes = NODES, .first_nodes = FirstNodes, .p2g_mass = P2GMass,                                                      \
  .weights = {[MPM_P2G]        = PhiWeights,                                                                           \
              [MPM_P2G_AFFINE] = MomentWeights,                                                                        \
              [MPM_DIV]        = GradientWeights,                                                                      \
              [MPM_DIV_MLS]    = FittedWeights},                                                                          \
  .kernel  = {[MPM_P2G] = P2G_,      [MPM_P2G_AFFINE] = P2GAffine, [MPM_DIV] = Div,   [MPM_DIV_MLS] = DivMls,          \
              [MPM_G2P] = G2P_,      [MPM_G2P_AFFINE] = G2PAffine, [MPM_GRAD] = Grad, [MPM_GRAD_MLS] = G2PAffine,      \
              [MPM_G2P_SLOPE] = Grad}
