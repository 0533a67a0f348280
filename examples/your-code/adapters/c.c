/*
   An adapter for your code in C or C++. Fill in the five places, then:

     cc -O2 -fPIC -shared -o libmine.so mine.c -lm
     mpmstab spectrum -plugin ./libmine.so

   mpmstab chooses the particles: 10 cells each way with 2 particles each way, or those of -program_scene. The functions at the end are
   those of mpmstab/plugin.h.
*/
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* FILL 1: the state of a particle: all that a step changes and a later step reads, and what else differs from particle to particle. */
typedef struct { double x[2], v[2], stress[3], volume, mass; } Particle;

/* FILL 2: the same fields in the same order, with how many numbers each has. One of them is the place. */
static const char fields[] = "{\"name\": \"x\", \"size\": 2, \"place\": true}, {\"name\": \"v\", \"size\": 2}, "
                             "{\"name\": \"stress\", \"size\": 3}, {\"name\": \"volume\", \"size\": 1}, "
                             "{\"name\": \"mass\", \"size\": 1}";

/* FILL 3: the number of directions, and the width of a cell. */
enum { DIM = 2 };
static const double cell_width = 0.1;

/* FILL 4: a parameter that mpmstab may set, with the value of your code. */
static double dt = 1e-4;

static double period[DIM]; /* mpmstab fills in: of the grid in each direction, 0 where there is none */

/* FILL 5: a particle at rest, and one step of n particles, which keeps nothing but them. Return 0 from both. */
static int rest(Particle *p, const double place[], double volume, double mass) { (void)p, (void)place, (void)volume, (void)mass; return 1; }
static int advance(Particle p[], int64_t n) { (void)p, (void)n; return 1; }

#ifdef __cplusplus
extern "C" {
#endif
const char *mpmstab_describe(const double **state)
{
  static char text[4096];

  *state = NULL;
  snprintf(text, sizeof text,
           "{\"protocol\": 1, \"name\": \"mine\", \"dim\": %d, \"cell_width\": %.17g, \"scenes\": true, \"fields\": [%s], "
           "\"parameters\": {\"dt\": %.17g}}",
           DIM, cell_width, fields, dt);
  return text;
}

int mpmstab_scene(const char message[], int64_t particles, const double periods[], const double given[], double state[])
{
  (void)message;
  memcpy(period, periods, sizeof period);
  for (int64_t i = 0; i < particles; i++, given += DIM + 2)
    if (rest((Particle *)state + i, given, given[DIM], given[DIM + 1])) return 1;
  return 0;
}

int mpmstab_set(const char name[], double value)
{
  if (strcmp(name, "dt")) return 1;
  dt = value;
  return 0;
}

int mpmstab_step(int steps, int64_t particles, double state[])
{
  for (int n = 0; n < steps; n++)
    if (advance((Particle *)state, particles)) return 1;
  return 0;
}

const char *mpmstab_error(void)
{
  return "FILL 5: a particle at rest and one step of your code";
}
#ifdef __cplusplus
}
#endif
