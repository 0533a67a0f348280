/* A bar in C and C++, with a period of length 1: a step of MPM as it is in many codes (update stress last, hat functions). */
#include <math.h>
#include <string.h>

#ifndef COURANT /* cells that a wave moves in a step */
#define COURANT 0.5
#endif

enum { CELLS = 16, PARTICLES = 2 * CELLS };

typedef struct {
  double x, v, stress;
} Particle;

static Particle p[PARTICLES];
static double   h = 1.0 / CELLS, dt = COURANT / CELLS; /* density and stiffness are 1 */

static void start(double amplitude)
{
  for (int i = 0; i < PARTICLES; i++) {
    p[i].x      = (i + 0.5) * h / 2;
    p[i].v      = amplitude * sin(2 * 3.141592653589793 * p[i].x);
    p[i].stress = 0;
  }
}

static void advance(double step)
{
  const double volume      = h / 2;
  double       mass[CELLS] = {0}, momentum[CELLS] = {0}, force[CELLS] = {0};

  for (int i = 0; i < PARTICLES; i++) {
    const double cell = floor(p[i].x / h), s = p[i].x / h - cell;
    const int    a = ((int)cell + CELLS) % CELLS, b = (a + 1) % CELLS;

    mass[a] += (1 - s) * volume, momentum[a] += (1 - s) * volume * p[i].v, force[a] += volume * p[i].stress / h;
    mass[b] += s * volume, momentum[b] += s * volume * p[i].v, force[b] -= volume * p[i].stress / h;
  }
  for (int i = 0; i < PARTICLES; i++) {
    const double cell = floor(p[i].x / h), s = p[i].x / h - cell;
    const int    a = ((int)cell + CELLS) % CELLS, b = (a + 1) % CELLS;
    const double va = (momentum[a] + step * force[a]) / mass[a], vb = (momentum[b] + step * force[b]) / mass[b];

    p[i].v += step * ((1 - s) * force[a] / mass[a] + s * force[b] / mass[b]);
    p[i].stress += step * (vb - va) / h;
    p[i].x += step * ((1 - s) * va + s * vb);
    p[i].x -= floor(p[i].x);
  }
}
