/*
   Verlet in plain C: half of the strain of the nodal velocity before the force, and half of that of the new one after it.
*/
#include "plain_momentum.h"

static void Velocity(const Scene *scene)
{
  const double *restrict x = scene->x, *restrict v = scene->u;
  double *restrict vi = scene->node[0], *restrict m = scene->mass;

  Zero(scene, vi);
  if (scene->drift != 0) Zero(scene, m);
  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES];
    const long i = Weights(x[p], phi);

    for (int n = 0; n < NODES; n++) {
      vi[i + n] += phi[n] * v[p];
      if (scene->drift != 0) m[i + n] += phi[n];
    }
  }
  if (scene->drift != 0) Fold(scene, m);
  Complete(scene, vi);
}

static void Force(const Scene *scene)
{
  const double *restrict x = scene->x;
  double *restrict s = scene->s, *restrict vi = scene->node[0], *restrict ai = scene->node[1];

  Zero(scene, ai);
  for (long p = 0; p < scene->particles; p++) {
    double     slope[NODES], vx = 0;
    const long i = Slopes(x[p], slope);

    for (int n = 0; n < NODES; n++) vx += slope[n] * vi[i + n];
    s[p] += COURANT / 2 * vx;
    for (int n = 0; n < NODES; n++) ai[i + n] -= COURANT * slope[n] * s[p];
  }
  Complete(scene, ai);
  for (long i = 0; i < scene->cells + 3; i++) vi[i] += ai[i];
}

void March(const Scene *scene)
{
  for (long step = 0; step < scene->steps; step++) {
    Velocity(scene);
    Force(scene);
    ToParticles(scene, COURANT / 2);
  }
}

double Energy(const Scene *scene)
{
  return Squares(scene);
}
