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

void March(const Scene *scene)
{
  for (long step = 0; step < scene->steps; step++) {
    ToNodes(scene);
    OnNodes(scene);
    ToParticles(scene, COURANT);
  }
}

double Energy(const Scene *scene)
{
  return Squares(scene);
}
