/*
   An adapter for your code in C. Fill in the five places, then:

     cc -O2 -fPIC -shared -o libmine.so mine.c -lm
     mpmstab spectrum -plugin ./libmine.so

   The four functions at the end are those of mpmstab/plugin.h.
*/
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* FILL 1: the state of a particle: all that a step changes and a later step reads; and the number of particles. */
typedef struct { double x[2], v[2], stress[3]; } Particle;
enum { PARTICLES = 8 };

/* FILL 2: the same fields in the same order. One is the place. Where you know it, add the size of a usual change: "scale": 20. */
static const char fields[] = "{\"name\": \"x\", \"size\": 2, \"place\": true}, {\"name\": \"v\", \"size\": 2}, "
                             "{\"name\": \"stress\", \"size\": 3}";

/* FILL 3: the number of directions, the width of a cell, and the period of each direction (null: it has no period). */
static const char grid[] = "\"dim\": 2, \"cell_width\": 0.1, \"periodic\": [null, null]";

/* FILL 4: a parameter that mpmstab may set, with the value of your code. */
static double dt = 1e-4;

/* FILL 5: the particles at the start, and one step, which keeps nothing but the particles. Return 0 from both. */
static int start(Particle p[]) { (void)p; return 1; }
static int advance(Particle p[]) { (void)p; return 1; }

const char *mpmstab_describe(const double **state)
{
  static Particle base[PARTICLES];
  static char     text[4096];

  if (start(base)) return NULL;
  *state = (const double *)base;
  snprintf(text, sizeof text,
           "{\"protocol\": 1, \"name\": \"mine\", %s, \"particles\": %d, \"fields\": [%s], "
           "\"parameters\": {\"dt\": %.17g}, \"steps\": 1}",
           grid, PARTICLES, fields, dt);
  return text;
}

int mpmstab_set(const char name[], double value)
{
  if (strcmp(name, "dt")) return 1;
  dt = value;
  return 0;
}

int mpmstab_step(int steps, int64_t particles, double state[])
{
  if (particles != PARTICLES) return 1;
  for (int n = 0; n < steps; n++)
    if (advance((Particle *)state)) return 1;
  return 0;
}

const char *mpmstab_error(void)
{
  return "FILL 5: the start and one step of your code";
}
