/* The hook in C: hook [amplitude [hook]]. It writes A.mtx before the first step and prints the state after 50 steps. */
#include "bar.h"
#include <mpmstab_probe.h>

int main(int argc, char **argv)
{
  mpmstab_hook hook = {{1.0}, NULL};

  start(argc > 1 ? atof(argv[1]) : 0);
  mpmstab_place(&hook, "x", &p[0].x, MPMSTAB_DOUBLE, 1, sizeof p[0], PARTICLES);
  mpmstab_field(&hook, "v", &p[0].v, MPMSTAB_DOUBLE, 1, sizeof p[0], PARTICLES, 1);
  mpmstab_field(&hook, "stress", &p[0].stress, MPMSTAB_DOUBLE, 1, sizeof p[0], PARTICLES, 1);
  if (argc < 3) /* a third word leaves the hook out */
    while (!mpmstab_probe(&hook, "A.mtx", h)) advance(dt);
  for (int n = 0; n < 50; n++) advance(dt);
  for (int i = 0; i < PARTICLES; i++) printf("%a %a %a\n", p[i].x, p[i].v, p[i].stress);
  return 0;
}
