/*
   The maps of a basis whose particles have weights at NODES nodes in a row. The file of a basis defines NODES, includes
   this header, and then defines

     static inline PetscInt First(PetscReal xi);
     static inline void Values(PetscReal xi, PetscReal phi[NODES]);
     static inline void Slopes(PetscReal xi, PetscReal slope[NODES]);
     static inline void Curves(PetscReal xi, PetscReal curve[NODES]);

   First is the first of the nodes, counted from the cell's left node. Slopes gives h dphi/dx, and Curves h^2 d2phi/dx2.
   Hats have no Curves, and say so by NO_CURVES. Functions that depend on the width of a particle take half of it, in
   cells, as their second argument, and say so by WIDE. Functions that differ near walls (ends.h) say so by NEAR_WALLS.

   In a uniform layout, moving or not, all runs of a block have the same length. A loop over runs of a known length has
   no branch and no gather, and the compiler vectorises it. Elsewhere sums stay in registers while particles have the
   same nodes, and move on when the nodes do: a sum in memory would wait for the one before it to be stored.
*/
#pragma once
#include "scheme/kernels.h"

_Static_assert(NODES <= MPM_MOST_NODES,
               "a basis has more nodes a direction than MPM_MOST_NODES, which arrays are made for");

/* Where a particle is in its cell, half of its width, its first node, and the first and last node of the direction. */
typedef struct {
  PetscReal       xi, half_width;
  PetscInt        first;
  const PetscInt *wall;
} Place;

/* Sets the weights of a particle's nodes, and returns the number that a gather divides by. */
typedef PetscReal (*Weights)(Place at, PetscReal weight[NODES]);

static inline PetscInt First(PetscReal xi);

#ifdef NEAR_WALLS
static inline PetscReal Phi(Place at, PetscReal weight[NODES]);
static inline PetscReal Gradient(Place at, PetscReal weight[NODES]);
static inline PetscReal Moment(Place at, PetscReal weight[NODES]);
static inline PetscReal Fitted(Place at, PetscReal weight[NODES]);
#define GATHERED Fitted
#define WALL_NODES
#else
#ifdef WIDE
#define PLACE PetscReal xi, PetscReal half_width
#define AT_PLACE at.xi, at.half_width
#else
#define PLACE PetscReal xi
#define AT_PLACE at.xi
#endif
static inline void Values(PLACE, PetscReal phi[NODES]);
static inline void Slopes(PLACE, PetscReal slope[NODES]);
#define GATHERED Moment
#define WALL_NODES .wall_nodes = 1,

static inline PetscReal Phi(Place at, PetscReal weight[NODES])
{
  Values(AT_PLACE, weight);
  return 1;
}

static inline PetscReal Gradient(Place at, PetscReal weight[NODES])
{
  Slopes(AT_PLACE, weight);
  return 1;
}

/* The weights are phi (x_i - x_p) / h; returns sum_i phi (x_i - x_p)^2 / h^2. */
static inline PetscReal Moment(Place at, PetscReal weight[NODES])
{
  PetscReal sum = 0;

  Values(AT_PLACE, weight);
  for (int d = 0; d < NODES; d++) {
    const PetscReal distance = First(at.xi) + d - at.xi;

    weight[d] *= distance;
    sum += weight[d] * distance;
  }
  return sum;
}

/* The weights of a gather by Moment, divided: phi (x_i - x_p) h / D. */
static inline PetscReal Fitted(Place at, PetscReal weight[NODES])
{
  const PetscReal sum = Moment(at, weight);

  for (int d = 0; d < NODES; d++) weight[d] /= sum;
  return 1;
}
#endif

#ifndef NO_CURVES
static inline void Curves(PLACE, PetscReal curve[NODES]);

static inline PetscReal Curve(Place at, PetscReal weight[NODES])
{
  Curves(AT_PLACE, weight);
  return 1;
}

/* The slopes of Fitted: of phi r h / D, where r = x_i - x_p has the slope -1 and D that of sum_i phi r^2. */
static inline PetscReal FittedSlopes(Place at, PetscReal weight[NODES])
{
  PetscReal phi[NODES], slope[NODES], D = 0, D_slope = 0;

  Values(AT_PLACE, phi);
  Slopes(AT_PLACE, slope);
  for (int d = 0; d < NODES; d++) {
    const PetscReal r = First(at.xi) + d - at.xi;

    D += phi[d] * r * r;
    D_slope += slope[d] * r * r;
  }
  for (int d = 0; d < NODES; d++) {
    const PetscReal r = First(at.xi) + d - at.xi;

    weight[d] = (slope[d] * r - phi[d]) / D - phi[d] * r * D_slope / (D * D);
  }
  return 1;
}
#endif

/* A loop is vectorised only if the compiler knows its weights and the length of its runs, without a call. */
#define INLINE static inline __attribute__((always_inline))

/*
   Sums what the particles of each run give to their nodes: given[d][j] is what run j gives to its node d. Sums the
   masses too unless mass is NULL.
*/
INLINE void ScatterRuns(Weights weights, const PetscInt length, const MpmBlock *b, PetscReal a,
                        const PetscReal *restrict particle, PetscReal *restrict node, PetscReal *restrict mass)
{
  const PetscInt count = (b->end - b->begin) / length, at = b->first[b->begin];
  const PetscReal *restrict q = particle + b->begin, *restrict xi = b->xi + b->begin;
  PetscReal given[NODES][MPM_BLOCK], given_mass[NODES][MPM_BLOCK];

  for (PetscInt j = 0; j < count; j++) {
    PetscReal sum[NODES] = {0}, sum_mass[NODES] = {0};

    for (PetscInt i = 0; i < length; i++) {
      PetscReal weight[NODES];

      (void)weights((Place){xi[length * j + i], b->half_width, at + j, b->wall}, weight);
      for (int d = 0; d < NODES; d++) {
        sum[d] += weight[d] * (a * q[length * j + i]);
        sum_mass[d] += weight[d];
      }
    }
    for (int d = 0; d < NODES; d++) {
      given[d][j] = sum[d];
      if (mass) given_mass[d][j] = sum_mass[d];
    }
  }
  for (int d = 0; d < NODES; d++) {
    for (PetscInt j = 0; j < count; j++) node[at + j + d] += given[d][j];
    if (!mass) continue;
    for (PetscInt j = 0; j < count; j++) mass[at + j + d] += given_mass[d][j];
  }
}

INLINE void GatherRuns(Weights weights, const PetscInt length, const MpmBlock *b, PetscReal a,
                       PetscReal *restrict particle, const PetscReal *restrict node)
{
  const PetscInt count = (b->end - b->begin) / length, at = b->first[b->begin];
  const PetscReal *restrict xi = b->xi + b->begin;
  PetscReal *restrict q        = particle + b->begin;

  for (PetscInt j = 0; j < count; j++) {
    for (PetscInt i = 0; i < length; i++) {
      PetscReal       weight[NODES], sum = 0;
      const PetscReal divisor = weights((Place){xi[length * j + i], b->half_width, at + j, b->wall}, weight);

      for (int d = 0; d < NODES; d++) sum += weight[d] * node[at + j + d];
      q[length * j + i] += a / divisor * sum;
    }
  }
}

/*
   Adds the sums for nodes at, at + 1, ... to these nodes, before particles whose first node is next. Where next is
   at + 1 only the first sum is added, and the others are kept for the particles that follow.
*/
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

INLINE void SumEach(PetscInt n, const PetscInt *restrict first, PetscReal given[NODES][MPM_BLOCK],
                    PetscReal *restrict node)
{
  PetscReal sum[NODES] = {0};

  for (PetscInt p = 0; p < n; p++) {
    if (p > 0 && first[p] != first[p - 1]) Carry(first[p - 1], first[p], sum, node);
    for (int d = 0; d < NODES; d++) sum[d] += given[d][p];
  }
  for (int d = 0; d < NODES; d++) node[first[n - 1] + d] += sum[d];
}

/* For particles [begin, end), which may have any nodes. */
INLINE void ScatterEach(Weights weights, PetscInt begin, PetscInt end, const MpmBlock *b, PetscReal a,
                        const PetscReal *restrict particle, PetscReal *restrict node, PetscReal *restrict mass)
{
  PetscReal given[NODES][MPM_BLOCK], given_mass[NODES][MPM_BLOCK];

  if (begin == end) return;
  for (PetscInt p = begin; p < end; p++) {
    PetscReal weight[NODES];

    (void)weights((Place){b->xi[p], b->half_width, b->first[p], b->wall}, weight);
    for (int d = 0; d < NODES; d++) {
      given[d][p - begin] = weight[d] * (a * particle[p]);
      if (mass) given_mass[d][p - begin] = weight[d];
    }
  }
  SumEach(end - begin, b->first + begin, given, node);
  if (mass) SumEach(end - begin, b->first + begin, given_mass, mass);
}

INLINE void GatherEach(Weights weights, PetscInt begin, PetscInt end, const MpmBlock *b, PetscReal a,
                       PetscReal *restrict particle, const PetscReal *restrict node)
{
  for (PetscInt p = begin; p < end; p++) {
    PetscReal       weight[NODES], sum = 0;
    const PetscReal divisor = weights((Place){b->xi[p], b->half_width, b->first[p], b->wall}, weight);

    for (int d = 0; d < NODES; d++) sum += weight[d] * node[b->first[p] + d];
    particle[p] += a / divisor * sum;
  }
}

INLINE void Scatter(Weights weights, const MpmBlock *b, PetscReal a, const PetscReal *restrict particle,
                    PetscReal *restrict node, PetscReal *restrict mass)
{
  ScatterEach(weights, 0, b->begin, b, a, particle, node, mass);
  if (b->length == 1) ScatterRuns(weights, 1, b, a, particle, node, mass);
  if (b->length == 2) ScatterRuns(weights, 2, b, a, particle, node, mass);
  if (b->length == 3) ScatterRuns(weights, 3, b, a, particle, node, mass);
  if (b->length == 4) ScatterRuns(weights, 4, b, a, particle, node, mass);
  ScatterEach(weights, b->end, b->n, b, a, particle, node, mass);
}

INLINE void Gather(Weights weights, const MpmBlock *b, PetscReal a, PetscReal *restrict particle,
                   const PetscReal *restrict node)
{
  GatherEach(weights, 0, b->begin, b, a, particle, node);
  if (b->length == 1) GatherRuns(weights, 1, b, a, particle, node);
  if (b->length == 2) GatherRuns(weights, 2, b, a, particle, node);
  if (b->length == 3) GatherRuns(weights, 3, b, a, particle, node);
  if (b->length == 4) GatherRuns(weights, 4, b, a, particle, node);
  GatherEach(weights, b->end, b->n, b, a, particle, node);
}

INLINE void WeightsOfEach(Weights weights, const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  for (PetscInt p = 0; p < b->n; p++) {
    PetscReal of_particle[NODES];

    (void)weights((Place){b->xi[p], b->half_width, b->first[p], b->wall}, of_particle);
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

static void FirstNodes(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                       PetscInt *restrict first)
{
  for (PetscInt p = 0; p < n; p++) first[p] = cell[p] + First(xi[p]);
}

static void P2G_(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Phi, b, a, particle, node, NULL);
}

static void P2GMass(const MpmBlock *b, const PetscReal *restrict particle, PetscReal *restrict node,
                    PetscReal *restrict mass)
{
  Scatter(Phi, b, 1, particle, node, mass);
}

static void P2GAffine(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Moment, b, a, particle, node, NULL);
}

static void Div(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Gradient, b, a, particle, node, NULL);
}

static void G2P_(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Phi, b, a, particle, node);
}

static void Grad(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(Gradient, b, a, particle, node);
}

/* GRAD_MLS is the same map as G2P_AFFINE. */
#ifndef G2P_AFFINE
#define G2P_AFFINE G2PAffine
#define DIV_MLS DivMls
#define MLS_WEIGHTS FittedWeights
static void G2PAffine(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Gather(GATHERED, b, a, particle, node);
}

static void DivMls(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Fitted, b, a, particle, node, NULL);
}

static void FittedWeights(const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  WeightsOfEach(Fitted, b, stride, weight);
}
#endif

#ifdef NO_CURVES
#define CURVES
#define CURVE_WEIGHTS
#else
static void CurveForce(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(Curve, b, a, particle, node, NULL);
}

static void CurveForceMls(const MpmBlock *b, PetscReal a, PetscReal *restrict particle, PetscReal *restrict node)
{
  Scatter(FittedSlopes, b, a, particle, node, NULL);
}

static void CurveWeights(const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  WeightsOfEach(Curve, b, stride, weight);
}

static void FittedSlopeWeights(const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  WeightsOfEach(FittedSlopes, b, stride, weight);
}
#define CURVES [MPM_CURVE] = CurveForce, [MPM_CURVE_MLS] = CurveForceMls,
#define CURVE_WEIGHTS [MPM_CURVE] = CurveWeights, [MPM_CURVE_MLS] = FittedSlopeWeights,
#endif

#define KERNELS                                                                                                        \
  .nodes = NODES, WALL_NODES.first_nodes = FirstNodes, .p2g_mass = P2GMass,                                            \
  .weights = {CURVE_WEIGHTS[MPM_P2G] = PhiWeights, [MPM_P2G_AFFINE] = MomentWeights, [MPM_DIV] = GradientWeights,      \
              [MPM_DIV_MLS] = MLS_WEIGHTS},                                                                            \
  .kernel  = {CURVES[MPM_P2G] = P2G_, [MPM_P2G_AFFINE] = P2GAffine,  [MPM_DIV] = Div,   [MPM_DIV_MLS] = DIV_MLS,       \
              [MPM_G2P] = G2P_,       [MPM_G2P_AFFINE] = G2P_AFFINE, [MPM_GRAD] = Grad, [MPM_GRAD_MLS] = G2P_AFFINE,   \
              [MPM_G2P_SLOPE] = Grad}
