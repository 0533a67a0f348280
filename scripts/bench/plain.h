/*
   The yardsticks: each scheme as one would write it straight, sweep after sweep over the particles, nothing clever.

     SCHEME PARTICLES STEPS DRIFT      prints ns per particle and step, and the energy, so that nothing is left out

   Two particles a cell on a periodic grid, places in cells. A scheme's file has March and Energy; QUADRATIC chooses
   quadratic B-splines instead of hats when it is compiled.
*/
#pragma once
#include <stddef.h>

#define PPC 2
#define COURANT 0.01 /* rounding must not grow into the energy within a thousand steps of gas1 */

typedef struct {
  long    particles, cells, steps;
  double  drift;
  double *x, *u, *s;      /* places, the first and the second field of the particles */
  double *mass, *node[4]; /* of the nodes: one more before the first, two more after the last */
} Scene;

/* All steps of a scheme: what is timed. */
void March(const Scene *scene);

/* With the energy's unit: 1/2 the integral over a domain of length 1. */
double Energy(const Scene *scene);

/* Half the mean of the squares of both fields: the energy of all schemes but the bar's. */
double Squares(const Scene *scene);

/* The first node that a particle sees (as an index of a node array), and what it sees of it and of those after it. */
#ifdef QUADRATIC
#define NODES 3
static inline long Weights(double x, double phi[])
{
  const long   i = (long)(x + 0.5); /* the nearest node */
  const double d = x - (double)i;

  phi[0] = 0.5 * (0.5 - d) * (0.5 - d);
  phi[1] = 0.75 - d * d;
  phi[2] = 0.5 * (0.5 + d) * (0.5 + d);
  return i;
}

static inline long Slopes(double x, double slope[])
{
  const long   i = (long)(x + 0.5);
  const double d = x - (double)i;

  slope[0] = d - 0.5;
  slope[1] = -2 * d;
  slope[2] = d + 0.5;
  return i;
}
#else
#define NODES 2
static inline long Weights(double x, double phi[])
{
  const long   i  = (long)x;
  const double xi = x - (double)i;

  phi[0] = 1 - xi;
  phi[1] = xi;
  return i + 1;
}

static inline long Slopes(double x, double slope[])
{
  slope[0] = -1;
  slope[1] = 1;
  return (long)x + 1;
}
#endif

static inline double Moved(const Scene *scene, double x)
{
  const double y = x + scene->drift;

  return y >= (double)scene->cells ? y - (double)scene->cells : y;
}

/* Zeros a node array; adds up what is one node of a periodic grid; gives all of them its value. */
void Zero(const Scene *scene, double node[]);
void Fold(const Scene *scene, double node[]);
void Spread(const Scene *scene, double node[]);

/* Fold, divide by the masses, Spread. */
void Complete(const Scene *scene, double node[]);
