/* Formulation 1 of the slides in plain C: both fields go to the nodes, then both gradients go back. */
#include "plain.h"

static void ToNodes(const Scene *scene)
{
  const double *restrict x = scene->x, *restrict u = scene->u, *restrict r = scene->s;
  double *restrict ui = scene->node[0], *restrict ri = scene->node[1], *restrict m = scene->mass;
  const double drift = scene->drift;

  Zero(scene, ui);
  Zero(scene, ri);
  if (drift != 0) Zero(scene, m);
  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES];
    const long i = Weights(x[p], phi);

    for (int n = 0; n < NODES; n++) {
      ui[i + n] += phi[n] * u[p];
      ri[i + n] += phi[n] * r[p];
      if (drift != 0) m[i + n] += phi[n];
    }
  }
  if (drift != 0) Fold(scene, m);
  Complete(scene, ui);
  Complete(scene, ri);
}

static void ToParticles(const Scene *scene)
{
  double *restrict x = scene->x, *restrict u = scene->u, *restrict r = scene->s;
  const double *restrict ui = scene->node[0], *restrict ri = scene->node[1];

  for (long p = 0; p < scene->particles; p++) {
    double     slope[NODES], ux = 0, rx = 0;
    const long i = Slopes(x[p], slope);

    for (int n = 0; n < NODES; n++) {
      ux += slope[n] * ui[i + n];
      rx += slope[n] * ri[i + n];
    }
    u[p] += COURANT * rx;
    r[p] += COURANT * ux;
    if (scene->drift != 0) x[p] = Moved(scene, x[p]);
  }
}

void March(const Scene *scene)
{
  for (long step = 0; step < scene->steps; step++) {
    ToNodes(scene);
    ToParticles(scene);
  }
}

double Energy(const Scene *scene)
{
  return Squares(scene);
}
