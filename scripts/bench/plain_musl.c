/*
   Modified update stress last in plain C: as usl, but the new velocity goes to the nodes before its gradient is taken.
*/
#include "plain_momentum.h"

static void Velocity(const Scene *scene)
{
  const double *restrict x = scene->x, *restrict ai = scene->node[1];
  double *restrict v = scene->u, *restrict vi = scene->node[0];

  Zero(scene, vi);
  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES], a = 0;
    const long i = Weights(x[p], phi);

    for (int n = 0; n < NODES; n++) a += phi[n] * ai[i + n];
    v[p] += a;
    for (int n = 0; n < NODES; n++) vi[i + n] += phi[n] * v[p];
  }
  Complete(scene, vi);
}

static void Stress(const Scene *scene)
{
  const double *restrict vi = scene->node[0];
  double *restrict x = scene->x, *restrict s = scene->s;

  for (long p = 0; p < scene->particles; p++) {
    double     slope[NODES], vx = 0;
    const long i = Slopes(x[p], slope);

    for (int n = 0; n < NODES; n++) vx += slope[n] * vi[i + n];
    s[p] += COURANT * vx;
    if (scene->drift != 0) x[p] = Moved(scene, x[p]);
  }
}

void March(const Scene *scene)
{
  for (long step = 0; step < scene->steps; step++) {
    ToNodes(scene);
    Velocity(scene);
    Stress(scene);
  }
}

double Energy(const Scene *scene)
{
  return Squares(scene);
}
