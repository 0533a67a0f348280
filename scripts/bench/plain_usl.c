/*
   Update stress last in plain C: velocity and force go to the nodes; increments and the gradient of the new velocity go
   back.
*/
#include "plain_momentum.h"

static void OnNodes(const Scene *scene)
{
  const double *restrict ai = scene->node[1];
  double *restrict vi       = scene->node[0];

  for (long i = 0; i < scene->cells + 3; i++) vi[i] += ai[i];
}

static void ToParticles(const Scene *scene)
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
    s[p] += COURANT * vx;
    if (scene->drift != 0) x[p] = Moved(scene, x[p]);
  }
}

void March(const Scene *scene)
{
  for (long step = 0; step < scene->steps; step++) {
    ToNodes(scene);
    OnNodes(scene);
    ToParticles(scene);
  }
}

double Energy(const Scene *scene)
{
  return Squares(scene);
}
