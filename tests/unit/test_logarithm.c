/* The logarithm of materials beside that of the C library in long double, from the least volume to the largest. */
#include "check.h"
#include "base/hash.h"
#include "scheme/material/logarithm.h"

#define COUNT 200000
#define ULPS 1.5

/* 1 + x is near 1, from 2 to 2^1000, or from 2^-50 to 1. */
static PetscReal Draw(PetscInt i)
{
  const PetscReal share = MpmHash(1, i), number = 2 * MpmHash(2, i) - 1;

  if (i % 4 == 0) return number * exp2(-60 * share);
  if (i % 4 == 1) return number * 0.9;
  if (i % 4 == 2) return exp2(1000 * share) * (1 + MpmHash(2, i));
  return exp2(-50 * share) * (1 + MpmHash(2, i)) / 2 - 1;
}

static PetscErrorCode Test(int argc, char **argv)
{
  static PetscReal x[COUNT], found[COUNT];
  PetscReal        none[3] = {-1, -1.5, -INFINITY};

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt i = 0; i < COUNT; i++) x[i] = found[i] = Draw(i);
  LogarithmOfOnePlus(COUNT, found);
  for (PetscInt i = 0; i < COUNT; i++) {
    const long double expected = log1pl((long double)x[i]);
    const PetscReal   unit     = nextafter(fabs((double)expected), INFINITY) - fabs((double)expected);

    CHECK(fabsl(found[i] - expected) <= ULPS * unit, "log(1 + %.17g) is off by %.3Lg units", x[i],
          fabsl(found[i] - expected) / unit);
  }
  LogarithmOfOnePlus(3, none);
  for (PetscInt i = 0; i < 3; i++) CHECK(isnan(none[i]), "a volume that is not positive has the logarithm %g", none[i]);
  found[0] = 0;
  LogarithmOfOnePlus(1, found);
  CHECK(found[0] == 0, "log 1 is %g", found[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
