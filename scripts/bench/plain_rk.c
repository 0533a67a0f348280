/*
   rk4 in plain C, with its stages on particles: each stage is a sweep from the force and velocity of the nodes to v and s of
   the stage and on to new nodes. FIVE makes it kg5.
*/
#include "plain_momentum.h"

#ifdef FIVE
static const double part[] = {1. / 4, 1. / 6, 3. / 8, 1. / 2};
#else
static const double part[] = {1. / 4, 1. / 3, 1. / 2};
#endif
#define STAGES ((int)(sizeof part / sizeof *part))

/* From nodes w, b of one stage to nodes vi, ai of the next, by v + c S b and s + c k G w of the particles. */
static void Stage(const Scene *scene, double c, const double *restrict w, const double *restrict b, double *restrict vi,
                  double *restrict ai)
{
  const double *restrict x = scene->x, *restrict v = scene->u, *restrict s = scene->s;

  Zero(scene, vi);
  Zero(scene, ai);
  for (long p = 0; p < scene->particles; p++) {
    double     phi[NODES], slope[NODES], velocity = v[p], stress = s[p];
    const long i = Weights(x[p], phi);

    (void)Slopes(x[p], slope);
    for (int n = 0; n < NODES; n++) {
      velocity += c * phi[n] * b[i + n];
      stress += c * COURANT * slope[n] * w[i + n];
    }
    for (int n = 0; n < NODES; n++) {
      vi[i + n] += phi[n] * velocity;
      ai[i + n] -= COURANT * slope[n] * stress;
    }
  }
  Complete(scene, vi);
  Complete(scene, ai);
}

void March(const Scene *scene)
{
  double *const *node = scene->node;

  for (long step = 0; step < scene->steps; step++) {
    ToNodes(scene);
    for (int j = 0; j < STAGES; j++) {
      const int from = 2 * (j % 2), to = 2 - from;

      Stage(scene, part[j], node[from], node[from + 1], node[to], node[to + 1]);
    }
    const int last = 2 * (STAGES % 2);
    Scene     end  = *scene;

    end.node[0] = node[last];
    end.node[1] = node[last + 1];
    ToParticles(&end, COURANT);
  }
}

double Energy(const Scene *scene)
{
  return Squares(scene);
}
