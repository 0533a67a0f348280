/* Searches in the Courant number: rounding of a defective eigenvalue 1 must not pass for growth that fades with it. */
#include "check.h"
#include "analysis/search.h"
#include <math.h>

#define TOLERANCE 1e-6
#define THRESHOLD 2.0

/* Rounding, of a size that BLAS libraries make of the same matrix, and beyond the threshold growth. */
static PetscErrorCode Steep(void *context, PetscReal courant, PetscReal *growth)
{
  PetscFunctionBegin;
  *growth = 1 + *(PetscReal *)context;
  if (courant > THRESHOLD) *growth += courant - THRESHOLD;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth that fades with a power of the Courant number. */
static PetscErrorCode Fading(void *context, PetscReal courant, PetscReal *growth)
{
  PetscFunctionBegin;
  *growth = 1 + TOLERANCE * pow(courant / THRESHOLD, *(PetscReal *)context);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscReal rounding[] = {0, 1e-8, 5e-8, 2e-7}, power[] = {1, 2, 4};

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(rounding); i++) {
    MpmCritical c = {.threshold = PETSC_TRUE};

    PetscCall(MpmSearchScan(Steep, &rounding[i], TOLERANCE, 0, 1e-7, &c));
    CHECK(c.threshold && fabs(c.stable_at - THRESHOLD) < 1e-5, "rounding %g: limit %g, threshold %d",
          (double)rounding[i], (double)c.stable_at, (int)c.threshold);
  }
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(power); i++) {
    MpmCritical c = {.threshold = PETSC_TRUE};

    PetscCall(MpmSearchScan(Fading, &power[i], TOLERANCE, 0, 1e-7, &c));
    CHECK(!c.threshold && fabs(c.fading - power[i]) < 1e-3, "power %g: fades as %g, threshold %d", (double)power[i],
          (double)c.fading, (int)c.threshold);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
