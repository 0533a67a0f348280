/*
   The cells of each rank: no other cut of a line has a smaller maximum of particles, if ranges may be short, and every
   range has enough cells.
*/
#include "check.h"
#include "march/partition.h"

/* The smallest maximum of particles over all ways to cut cells [lo, n) into ranges. */
static PetscInt64 SmallestMaximum(const MpmLayout *layout, PetscInt lo, PetscInt ranges)
{
  const PetscInt n    = layout->grid[0].cells;
  PetscInt64     best = INT64_MAX;

  if (ranges == 1)
    return lo == n ? best : MpmLayoutParticlesBefore(layout, 0, n) - MpmLayoutParticlesBefore(layout, 0, lo);
  for (PetscInt cut = lo + 1; cut <= n; cut++) {
    const PetscInt64 here = MpmLayoutParticlesBefore(layout, 0, cut) - MpmLayoutParticlesBefore(layout, 0, lo);

    best = PetscMin(best, PetscMax(here, SmallestMaximum(layout, cut, ranges - 1)));
  }
  return best;
}

/* Checks starts and smallest of a partition, and returns the particles of its fullest rank. */
static PetscInt64 CheckRanges(const MpmLayout *layout, const MpmPartition *p, PetscInt least, const char options[])
{
  PetscInt64 most     = 1;
  PetscInt   smallest = PETSC_MAX_INT;

  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscInt64 along = 0;

    CHECK(p->starts[a][0] == 0 && p->starts[a][p->ranks[a]] == layout->grid[a].cells, "%s", options);
    for (PetscInt r = 0; r < p->ranks[a]; r++) {
      const PetscInt *s = &p->starts[a][r];

      smallest = PetscMin(smallest, s[1] - s[0]);
      along    = PetscMax(along, MpmLayoutParticlesBefore(layout, a, s[1]) - MpmLayoutParticlesBefore(layout, a, s[0]));
    }
    most *= along;
  }
  CHECK(smallest == p->smallest && smallest >= least, "%s: a range has %d cells of %d", options, (int)smallest,
        (int)least);
  return most;
}

static PetscErrorCode CheckLine(const char rest[])
{
  char         options[256];
  MpmScene    *scene;
  MpmPartition p;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-balance particles %s", rest));
  PetscCall(CheckScene(options, &scene));
  for (PetscMPIInt size = 1; size <= 4; size++) {
    for (PetscInt least = 1; least <= 4; least++) {
      PetscInt64 most;

      PetscCall(MpmPartitionCreate(&scene->layout, size, least, PETSC_FALSE, &p));
      most = CheckRanges(&scene->layout, &p, least, options);
      if (least == 1)
        CHECK(most == SmallestMaximum(&scene->layout, 0, size), "%s, %d ranks: %d particles", options, size, (int)most);
      CHECK_NEAR(p.load, (PetscReal)most * size / (PetscReal)scene->layout.particles, 1e-14);
      PetscCall(MpmPartitionDestroy(&p));
    }
  }
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks the numbers of ranks along the directions, and the load, of a scene on 4 ranks. */
static PetscErrorCode CheckBox(const char options[], PetscInt x, PetscInt y, PetscInt z, PetscReal load)
{
  MpmScene    *scene;
  MpmPartition p;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmPartitionCreate(&scene->layout, 4, 2, MpmSceneDrifts(scene), &p));
  (void)CheckRanges(&scene->layout, &p, 2, options);
  CHECK(p.ranks[0] == x && p.ranks[1] == y && p.ranks[2] == z, "%s: %d x %d x %d ranks", options, (int)p.ranks[0],
        (int)p.ranks[1], (int)p.ranks[2]);
  CHECK_NEAR(p.load, load, 1e-14);
  PetscCall(MpmPartitionDestroy(&p));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckLine("-cells 17"));
  PetscCall(CheckLine("-cells 18 -counts 1,9,0,2,0"));
  PetscCall(CheckLine("-cells 20 -counts 30,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1,1"));
  PetscCall(CheckLine("-cells 21 -fill 3,7"));
  PetscCall(CheckLine("-cells 19 -fill 0.5,18"));
  /* a full box, and one whose particles are in a corner: equal ranges leave two ranks without any */
  PetscCall(CheckBox("-dim 2 -formulation usl -cells 16,16", 1, 4, 1, 1));
  PetscCall(CheckBox("-dim 2 -formulation usl -cells 16,16 -fill 0,8,0,8 -balance cells", 1, 4, 1, 2));
  PetscCall(CheckBox("-dim 2 -formulation usl -cells 16,16 -fill 0,8,0,8", 1, 4, 1, 1));
  /* three cells wide, so that only the long direction can be shared evenly */
  PetscCall(CheckBox("-dim 2 -formulation usl -ppc 1 -cells 16,16 -fill 0,3,0,16 -balance particles", 1, 4, 1, 1));
  PetscCall(CheckBox("-dim 3 -formulation usl -cells 8 -fill 0,8,0,8,0,4", 1, 2, 2, 1));
  PetscCall(CheckBox("-dim 2 -formulation usl -cells 60 -fill 0,20,0,20 -balance cells -ranks 2,2", 2, 2, 1, 4));
  PetscCall(CheckBox("-dim 2 -formulation usl -cells 16,16 -ranks 2,2", 2, 2, 1, 1));
  PetscCall(CheckBox("-dim 2 -formulation usl -cells 16,16 -fill 0,8,0,8 -ranks 4,1", 4, 1, 1, 1));
  PetscCall(CheckBox("-dim 3 -formulation usl -cells 8 -ranks 2,1,2", 2, 1, 2, 1));
  /* up to 1.25 times the mean, and where particles move, cells are shared equally */
  PetscCall(CheckBox("-cells 40 -fill 0,32", 4, 1, 1, 1.25));
  PetscCall(CheckBox("-cells 40 -fill 0,31", 4, 1, 1, 4. * 16 / 62));
  PetscCall(CheckBox("-cells 16 -fill 0,8 -drift 1/8", 4, 1, 1, 2));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
