/*
   Formulation 2 of the slides in plain C: the nodal density changes the velocity, then the new velocity changes the
   density.
*/
#include "plain.h"

static void DensityToNodes(const Scene *scene)
{
  const double *restrict x = scene->x, *restrict r = scene->s;
  double *restrict ri = scene->node[1], *restrict m = scene->mass;
  const double drift = scene->drift;

  Zero(scene, ri);
  if (drift != 0) Zero(scene, m);
  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES];
    const long i = Weights(x[p], phi);

    for (int n = 0; n < NODES; n++) {
      ri[i + n] += phi[n] * r[p];
      if (drift != 0) m[i + n] += phi[n];
    }
  }
  if (drift != 0) Fold(scene, m);
  Complete(scene, ri);
}

static void Velocity(const Scene *scene)
{
  const double *restrict x = scene->x, *restrict ri = scene->node[1];
  double *restrict u = scene->u, *restrict ui = scene->node[0];

  Zero(scene, ui);
  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES], slope[NODES], rx = 0;
    const long i = Weights(x[p], phi);

    (void)Slopes(x[p], slope);
    for (int n = 0; n < NODES; n++) rx += slope[n] * ri[i + n];
    u[p] += COURANT * rx;
    for (int n = 0; n < NODES; n++) ui[i + n] += phi[n] * u[p];
  }
  Complete(scene, ui);
}

static void Density(const Scene *scene)
{
  const double *restrict ui = scene->node[0];
  double *restrict x = scene->x, *restrict r = scene->s;

  for (long p = 0; p < scene->particles; p++) {
    double     slope[NODES], ux = 0;
    const long i = Slopes(x[p], slope);

    for (int n = 0; n < NODES; n++) ux += slope[n] * ui[i + n];
    r[p] += COURANT * ux;
    if (scene->drift != 0) x[p] = Moved(scene, x[p]);
  }
}

void March(const Scene *scene)
{
  for (long step = 0; step < scene->steps; step++) {
    DensityToNodes(scene);
    Velocity(scene);
    Density(scene);
  }
}

double Energy(const Scene *scene)
{
  return Squares(scene);
}
