/*
   The slides' elastic bar in plain C: both fields go to the nodes, the Laplacian is taken there, and increments go
   back. The second field is w = v h / c.
*/
#include "plain.h"

static void ToNodes(const Scene *scene)
{
  const double *restrict x = scene->x, *restrict u = scene->s, *restrict w = scene->u;
  double *restrict ui = scene->node[0], *restrict wi = scene->node[1], *restrict m = scene->mass;
  const double drift = scene->drift;

  Zero(scene, ui);
  Zero(scene, wi);
  if (drift != 0) Zero(scene, m);
  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES];
    const long i = Weights(x[p], phi);

    for (int n = 0; n < NODES; n++) {
      ui[i + n] += phi[n] * u[p];
      wi[i + n] += phi[n] * w[p];
      if (drift != 0) m[i + n] += phi[n];
    }
  }
  if (drift != 0) Fold(scene, m);
  Complete(scene, ui);
  Complete(scene, wi);
}

static void OnNodes(const Scene *scene)
{
  const double *restrict ui = scene->node[0];
  double *restrict wi = scene->node[1], *restrict ai = scene->node[2];

  for (long i = 1; i <= scene->cells; i++) {
    ai[i] = COURANT * (ui[i + 1] - 2 * ui[i] + ui[i - 1]);
    wi[i] += ai[i];
  }
  Spread(scene, ai);
  Spread(scene, wi);
}

static void ToParticles(const Scene *scene)
{
  double *restrict x = scene->x, *restrict u = scene->s, *restrict w = scene->u;
  const double *restrict wi = scene->node[1], *restrict ai = scene->node[2];

  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES], a = 0, v = 0;
    const long i = Weights(x[p], phi);

    for (int n = 0; n < NODES; n++) {
      a += phi[n] * ai[i + n];
      v += phi[n] * wi[i + n];
    }
    w[p] += a;
    u[p] += COURANT * v;
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

/*
   Here w is in units of the initial data, whose size is 1, and u in units of h. The potential energy is that of the
   nodal displacement.
*/
double Energy(const Scene *scene)
{
  const double *ui    = scene->node[0];
  double        speed = 0, strain = 0;

  ToNodes(scene);
  for (long p = 0; p < scene->particles; p++) speed += scene->u[p] * scene->u[p];
  for (long i = 1; i <= scene->cells; i++) strain += (ui[i + 1] - ui[i]) * (ui[i + 1] - ui[i]);
  return speed / (double)(2 * scene->particles) + strain / (double)(2 * scene->cells);
}
