/*
   The weights of a basis whose particles have weights at NODES nodes in a row. The file of a basis defines NODES,
   includes this header, and then defines

     static inline PetscInt First(PetscReal xi);
     static inline void Values(PetscReal xi, PetscReal phi[NODES]);
     static inline void Slopes(PetscReal xi, PetscReal slope[NODES]);
     static inline void Curves(PetscReal xi, PetscReal curve[NODES]);

   First is the first of the nodes, counted from the cell's left node. Slopes gives h dphi/dx, and Curves h^2 d2phi/dx2.
   Hats have no Curves, and say so by NO_CURVES. Functions that depend on the width of a particle take half of it, in
   cells, as their second argument, and say so by WIDE.

   Splines may have other functions next to walls, sums of the uniform ones. Then the weights of a particle are those of
   the uniform splines, altered where it is near a wall. Node i of the uniform splines is at (i + OFFSET) h. The file
   defines OFFSET, which says that walls are near, and after this header

     static inline void Alter(PetscInt before, PetscInt step, PetscReal w[]);
     static inline void Shift(PetscInt before, PetscInt step, PetscReal r[]);

   Alter turns values or slopes of uniform splines, w[0], w[step], w[2 step] ..., into those of the basis at one wall,
   and Shift moves the nodes' places. before is the number of nodes between the wall's node and w[0], and step leads
   away from the wall: 1 at the left, -1 at the right. Such bases have no Curves.
*/
#pragma once
#include <mpmstab/basis.h>

_Static_assert(NODES <= MPM_MOST_NODES,
               "a basis has more nodes a direction than MPM_MOST_NODES, which arrays are made for");

/* Where a particle is in its cell, half of its width, its first node, and the first and last node of the direction. */
typedef struct {
  PetscReal       xi, half_width;
  PetscInt        first;
  const PetscInt *wall;
} Place;

/* Sets the weights of a particle's nodes. */
typedef void (*Weights)(Place at, PetscReal weight[NODES]);

#ifdef WIDE
#define PLACE PetscReal xi, PetscReal half_width
#define AT_PLACE at.xi, at.half_width
#else
#define PLACE PetscReal xi
#define AT_PLACE at.xi
#endif
static inline PetscInt First(PetscReal xi);
static inline void     Values(PLACE, PetscReal phi[NODES]);
static inline void     Slopes(PLACE, PetscReal slope[NODES]);

/* Calls Alter or Shift at the walls that are near. */
#ifdef OFFSET
#define NO_CURVES
#define WALL_NODES
#define NEAR(Change, at, w)                                                                                            \
  Change((at).first - (at).wall[0], 1, w);                                                                             \
  Change((at).wall[1] - ((at).first + NODES - 1), -1, (w) + NODES - 1)
static inline void Alter(PetscInt before, PetscInt step, PetscReal w[]);
static inline void Shift(PetscInt before, PetscInt step, PetscReal r[]);
#else
#define OFFSET 0
#define WALL_NODES .wall_nodes = 1,
#define NEAR(Change, at, w)
#endif

static inline void Phi(Place at, PetscReal weight[NODES])
{
  Values(AT_PLACE, weight);
  NEAR(Alter, at, weight);
}

static inline void Gradient(Place at, PetscReal weight[NODES])
{
  Slopes(AT_PLACE, weight);
  NEAR(Alter, at, weight);
}

/* The weights are phi (x_i - x_p) / h; returns D = sum_i phi (x_i - x_p)^2 / h^2. */
static inline PetscReal Moments(Place at, PetscReal weight[NODES])
{
  PetscReal r[NODES], sum = 0;

  for (int d = 0; d < NODES; d++) r[d] = First(at.xi) + d + OFFSET - at.xi;
  NEAR(Shift, at, r);
  Phi(at, weight);
  for (int d = 0; d < NODES; d++) {
    weight[d] *= r[d];
    sum += weight[d] * r[d];
  }
  return sum;
}

static inline void Moment(Place at, PetscReal weight[NODES])
{
  (void)Moments(at, weight);
}

/* Below this D is rounding: the particle is on a wall whose node has all of its weight. Inside D is never so small. */
#define NO_SPREAD 1e-8

/* The weights are phi (x_i - x_p) h / D. At a wall they go over into the slopes, as D goes to 0. */
static inline void Fitted(Place at, PetscReal weight[NODES])
{
  const PetscReal sum = Moments(at, weight);

#ifdef NO_CURVES
  if (sum < NO_SPREAD) {
    Gradient(at, weight);
    return;
  }
#endif
  for (int d = 0; d < NODES; d++) weight[d] /= sum;
}

#ifndef NO_CURVES
static inline void Curves(PLACE, PetscReal curve[NODES]);

static inline void Curve(Place at, PetscReal weight[NODES])
{
  Curves(AT_PLACE, weight);
}

/* The slopes of Fitted: of phi r h / D, where r = x_i - x_p has the slope -1 and D that of sum_i phi r^2. */
static inline void FittedSlopes(Place at, PetscReal weight[NODES])
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
}
#endif

/* A loop is vectorised only if the compiler knows its weights, without a call. */
#define INLINE static inline __attribute__((always_inline))

INLINE void WeightsOfEach(Weights weights, const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)
{
  for (PetscInt p = 0; p < b->n; p++) {
    PetscReal of_particle[NODES];

    weights((Place){b->xi[p], b->half_width, b->first[p], b->wall}, of_particle);
    for (int d = 0; d < NODES; d++) weight[d * stride + p] = of_particle[d];
  }
}

#define DEFINE_WEIGHTS(OfBlock, OfParticle)                                                                            \
  static void OfBlock(const MpmBlock *b, PetscInt stride, PetscReal *restrict weight)                                  \
  {                                                                                                                    \
    WeightsOfEach(OfParticle, b, stride, weight);                                                                      \
  }
DEFINE_WEIGHTS(PhiWeights, Phi)
DEFINE_WEIGHTS(GradientWeights, Gradient)
DEFINE_WEIGHTS(MomentWeights, Moment)

static void FirstNodes(PetscInt n, const PetscInt *restrict cell, const PetscReal *restrict xi,
                       PetscInt *restrict first)
{
  for (PetscInt p = 0; p < n; p++) first[p] = cell[p] + First(xi[p]);
}

#ifndef FITTED_WEIGHTS
#define FITTED_WEIGHTS FittedWeights
DEFINE_WEIGHTS(FittedWeights, Fitted)
#endif

#ifdef NO_CURVES
#define CURVE_WEIGHTS
#else
DEFINE_WEIGHTS(CurveWeights, Curve)
DEFINE_WEIGHTS(FittedSlopeWeights, FittedSlopes)
#define CURVE_WEIGHTS [MPM_CURVE] = CurveWeights, [MPM_CURVE_MLS] = FittedSlopeWeights,
#endif

#define KERNELS                                                                                                        \
  .nodes = NODES, WALL_NODES.first_nodes = FirstNodes,                                                                 \
  .weights = {                                                                                                         \
      CURVE_WEIGHTS[MPM_P2G] = PhiWeights, [MPM_P2G_AFFINE] = MomentWeights, [MPM_DIV] = GradientWeights,              \
      [MPM_DIV_MLS] = FITTED_WEIGHTS,      [MPM_G2P] = PhiWeights,           [MPM_G2P_AFFINE] = FITTED_WEIGHTS,        \
      [MPM_GRAD] = GradientWeights,        [MPM_GRAD_MLS] = FITTED_WEIGHTS,  [MPM_G2P_SLOPE] = GradientWeights}
