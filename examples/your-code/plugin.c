/* The bar as a plugin in C: mpmstab spectrum -plugin ./libbar.so */
#include "bar.h"
#include <mpmstab/plugin.h>
#include <stdio.h>

const char *mpmstab_describe(const double **state)
{
  static double base[3 * PARTICLES];
  static char   text[512];

  start(0);
  memcpy(base, p, sizeof base);
  *state = base;
  (void)snprintf(text, sizeof text,
                 "{\"protocol\": 1, \"name\": \"bar\", \"dim\": 1, \"cell_width\": %.17g, \"periodic\": [1.0], "
                 "\"particles\": %d, \"fields\": [{\"name\": \"x\", \"size\": 1, \"place\": true}, "
                 "{\"name\": \"v\", \"size\": 1, \"scale\": 1}, {\"name\": \"stress\", \"size\": 1, \"scale\": 1}], "
                 "\"parameters\": {\"dt\": %.17g}, \"steps\": 1}",
                 h, PARTICLES, dt);
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
  memcpy(p, state, sizeof p);
  for (int n = 0; n < steps; n++) advance(dt);
  memcpy(state, p, sizeof p);
  return 0;
}
