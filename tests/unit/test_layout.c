/* The hash, and the places of particles that follow from it: THEORY.md, section 1. */
#include "check.h"
#include "scene/layout.h"

static PetscErrorCode Test(int argc, char **argv)
{
  MpmScene *scene;
  PetscInt  cell;
  PetscReal xi;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  /* the first numbers of splitmix64 with seed 0 and 1234567, as its authors publish them */
  CHECK_NEAR(MpmHash(0, 0), (PetscReal)(0xE220A8397B1DCDAFu >> 11) * 0x1p-53, 0);
  CHECK_NEAR(MpmHash(0, 1), (PetscReal)(0x6E789E6AA1B965F4u >> 11) * 0x1p-53, 0);
  CHECK_NEAR(MpmHash(1234567, 0), (PetscReal)(6457827717110365317u >> 11) * 0x1p-53, 0);
  CHECK_NEAR(MpmHash(1234567, 2), (PetscReal)(9817491932198370423u >> 11) * 0x1p-53, 0);

  PetscCall(CheckScene("-cells 8 -ppc 2", &scene));
  MpmLayoutPlace(&scene->layout, 5, &cell, &xi);
  CHECK(cell == 2, "cell %d", cell);
  CHECK_NEAR(xi, 0.75, 0);
  PetscCall(MpmSceneDestroy(&scene));

  /* jitter: x = n + (j + offset + jitter (r - 1/2)) / ppc, which may leave the cell on either side */
  PetscCall(CheckScene("-cells 64 -ppc 3 -offset 0.1 -jitter 0.8 -seed 7", &scene));
  for (PetscInt64 g = 0; g < scene->layout.particles; g++) {
    const PetscReal x = g / 3 + (g % 3 + 0.1 + 0.8 * (MpmHash(7, g) - 0.5)) / 3;

    MpmLayoutPlace(&scene->layout, g, &cell, &xi);
    CHECK(xi >= 0 && xi < 1, "xi %.17g", xi);
    CHECK_NEAR(cell + xi, x, 1e-14);
  }
  MpmLayoutPlace(&scene->layout, 0, &cell, &xi);
  CHECK(MpmHash(7, 0) > 0.375 || cell == -1, "the first particle of this seed would lie left of the domain");
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
