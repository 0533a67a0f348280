/* What momentum schemes share: velocity and force to the nodes, and their end, but for musl's. */
#pragma once
#include "plain.h"

static inline void ToNodes(const Scene *scene)
{
  const double *restrict x = scene->x, *restrict v = scene->u, *restrict s = scene->s;
  double *restrict vi = scene->node[0], *restrict ai = scene->node[1], *restrict m = scene->mass;
  const double drift = scene->drift;

  Zero(scene, vi);
  Zero(scene, ai);
  if (drift != 0) Zero(scene, m);
  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES], slope[NODES];
    const long i = Weights(x[p], phi);

    (void)Slopes(x[p], slope);
    for (int n = 0; n < NODES; n++) {
      vi[i + n] += phi[n] * v[p];
      ai[i + n] -= COURANT * slope[n] * s[p];
      if (drift != 0) m[i + n] += phi[n];
    }
  }
  if (drift != 0) Fold(scene, m);
  Complete(scene, vi);
  Complete(scene, ai);
}

/* Increments and the gradient of the new velocity, times k of it, to the particles, which move. */
static inline void ToParticles(const Scene *scene, double k)
{
  double *restrict x = scene->x, *restrict v = scene->u, *restrict s = scene->s;
  const double *restrict vi = scene->node[0], *restrict ai = scene->node[1];

  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES], slope[NODES], a = 0, vx = 0;
    const long i = Weights(x[p], phi);

    (void)Slopes(x[p], slope);
    for (int n = 0; n < NODES; n++) {
      a += phi[n] * ai[i + n];
      vx += slope[n] * vi[i + n];
    }
    v[p] += a;
    s[p] += k * vx;
    if (scene->drift != 0) x[p] = Moved(scene, x[p]);
  }
}
