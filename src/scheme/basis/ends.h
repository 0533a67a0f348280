/*
   The weights of B-splines that have other functions next to walls. These functions are sums of the uniform splines. So
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
#define NO_CURVES
#define NEAR_WALLS
#include "scheme/basis/nodes.h"

static inline PetscReal Offset(void);
static inline void      Values(PetscReal xi, PetscReal phi[NODES]);
static inline void      Slopes(PetscReal xi, PetscReal slope[NODES]);
static inline void      Alter(PetscInt before, PetscInt step, PetscReal w[]);
static inline void      Shift(PetscInt before, PetscInt step, PetscReal r[]);

/* Below this, D = sum_i phi (x_i - x_p)^2 / h^2 is rounding: the particle is on a wall whose node has all of its weight. */
#define NO_SPREAD 1e-8

/* Calls Alter or Shift at the walls that are near. */
#define NEAR(Change, at, w)                                                                                            \
  Change((at).first - (at).wall[0], 1, w);                                                                             \
  Change((at).wall[1] - ((at).first + NODES - 1), -1, (w) + NODES - 1)

static inline void Phi(Place at, PetscReal weight[NODES])
{
  Values(at.xi, weight);
  NEAR(Alter, at, weight);
}

static inline void Gradient(Place at, PetscReal weight[NODES])
{
  Slopes(at.xi, weight);
  NEAR(Alter, at, weight);
}

/* The weights are phi (x_i - x_p) / h; returns sum_i phi (x_i - x_p)^2 / h^2. */
static inline PetscReal Moments(Place at, PetscReal weight[NODES])
{
  PetscReal r[NODES], sum = 0;

  for (int d = 0; d < NODES; d++) r[d] = First(at.xi) + d + Offset() - at.xi;
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

/* The weights are phi (x_i - x_p) h / D. At a wall they go over into the slopes, as D goes to 0. */
static inline void Fitted(Place at, PetscReal weight[NODES])
{
  const PetscReal sum = Moments(at, weight);

  if (sum < NO_SPREAD) {
    Gradient(at, weight);
    return;
  }
  for (int d = 0; d < NODES; d++) weight[d] /= sum;
}
