/* The hash, and the places of particles that follow from it: docs/theory.md, section 1. */
#include "check.h"
#include "scene/layout.h"

/* In three dimensions: the ids of a box of particles, their places, and jitter of its own in each direction. */
static PetscErrorCode CheckDimensions(void)
{
  MpmScene  *scene;
  MpmLayout *l;
  PetscInt   cell[MPM_MAX_DIM];
  PetscReal  xi[MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(CheckScene("-dim 3 -cells 4,3,2 -ppc 2,1,3 -offset 1/2,0,1/4 -fill 1,3,0,2,0,1 -formulation usl", &scene));
  l = &scene->layout;
  CHECK(l->sites == 8 * 3 * 6 && l->particles == 4 * 2 * 3, "%d sites, %d particles", (int)l->sites, (int)l->particles);
  CHECK(MpmLayoutPpc(l) == 6 && MpmLayoutCells(l) == 24, "a cell has %d", (int)MpmLayoutPpc(l));
  for (PetscInt64 id = 0; id < l->particles; id++) {
    const PetscReal x = 1 + (id % 4 + 0.5) / 2, y = id / 4 % 2, z = ((PetscReal)(id / 8) + 0.25) / 3;

    MpmLayoutPlace(l, id, cell, xi);
    CHECK_NEAR(cell[0] + xi[0], x, 1e-15);
    CHECK_NEAR(cell[1] + xi[1], y, 1e-15);
    CHECK_NEAR(cell[2] + xi[2], z, 1e-15);
  }
  PetscCall(MpmSceneDestroy(&scene));

  /* the first direction has the jitter of one dimension; the second another one, and neither has a mean */
  PetscCall(CheckScene("-dim 2 -cells 8 -ppc 2 -jitter 0.5 -seed 7 -formulation usl", &scene));
  l = &scene->layout;
  {
    PetscReal mean[2] = {0, 0}, both = 0;

    for (PetscInt64 id = 0; id < l->particles; id++) {
      const PetscReal x = (id % 16 + 0.5 + 0.5 * (MpmHash(7, id) - 0.5)) / 2;
      PetscReal       y;

      MpmLayoutPlace(l, id, cell, xi);
      CHECK_NEAR(cell[0] + xi[0], x, 1e-14);
      y = 2 * (cell[1] + xi[1]) - (PetscReal)(id / 16) - 0.5;
      CHECK(fabs(y) <= 0.25, "particle %d is moved by %g spacings", (int)id, y);
      mean[0] += MpmHash(7, id) - 0.5;
      mean[1] += y / 0.5;
      both += (MpmHash(7, id) - 0.5) * y / 0.5;
    }
    CHECK(fabs(mean[1]) / 256 < 0.06 && fabs(both) / 256 < 0.02, "mean %g, covariance %g", mean[1] / 256, both / 256);
  }
  PetscCall(MpmSceneDestroy(&scene));

  /* lengths follow from the width of a cell where none is given */
  PetscCall(CheckScene("-dim 2 -cells 8,4 -formulation usl", &scene));
  CHECK_NEAR(scene->length[1], 0.5, 1e-15);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
  PetscCall(CheckDimensions());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
