/*
   Results by particle id on all ranks equal those on one rank, to rounding. No particle is lost, and what the schemes
   conserve is conserved. Every rank makes the run on one rank for itself.
*/
#include "gather.h"

static PetscErrorCode EqualsOneRank(const MpmScene *scene, const MpmMarch *march, const char options[])
{
  MpmMarch *alone;

  PetscFunctionBegin;
  PetscCall(MarchScene(PETSC_COMM_SELF, scene, &alone));
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    PetscReal *many, *one;

    PetscCall(GatherField(march, scene->scheme.table->fields[f], &many));
    PetscCall(GatherField(alone, scene->scheme.table->fields[f], &one));
    CHECK(LargestNumber(scene->layout.particles, one) > 0, "%s: nothing there", options);
    CHECK(LargestDifference(scene->layout.particles, many, one) <= 1e-12 * LargestNumber(scene->layout.particles, one),
          "%s: field %s differs by %g", options, scene->scheme.table->fields[f],
          LargestDifference(scene->layout.particles, many, one));
    PetscCall(PetscFree(many));
    PetscCall(PetscFree(one));
  }
  PetscCall(MpmMarchDestroy(&alone));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that every particle is on exactly one rank, in a cell that the rank may use and in order, and that the nodes
   have the mass of all of them.
*/
static PetscErrorCode CheckPlaces(const MpmMarch *march, const char options[])
{
  const MpmParticles *particles = march->particles;
  const PetscInt     *cell;
  PetscReal          *inverse, mass = 0;
  PetscInt64          total = particles->count;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(particles, MpmFieldCell[0], &cell));
  for (PetscInt p = 1; p < particles->count; p++)
    CHECK(cell[p] >= cell[p - 1], "%s: particle %d out of order", options, p);
  PetscCall(MpmParticlesRestore(particles, MpmFieldCell[0], &cell));
  PetscCall(MpmGridGetArray(march->grid, march->inverse_mass, &inverse));
  for (PetscInt i = 0; i < march->grid->axis[0].nodes; i++) mass += inverse[i] > 0 ? 1 / inverse[i] : 0;
  PetscCall(MpmGridRestoreArray(march->grid, march->inverse_mass, &inverse));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &total, 1, MPIU_INT64, MPI_SUM, PETSC_COMM_WORLD));
  PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &mass, 1, MPIU_REAL, MPI_SUM, PETSC_COMM_WORLD));
  CHECK(total == march->layout->particles, "%s: %lld particles", options, (long long)total);
  CHECK_NEAR(mass, (PetscReal)march->layout->particles, 1e-11 * march->layout->particles);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks conservation at rest. With as many particles in each cell, sum_p GRAD telescopes and sum_p G2P LAP vanishes,
   so the sums of gas u and r and of the bar's w stay what they were. Momentum always stays, except with walls.
*/
static PetscErrorCode CheckConservation(const MpmScene *scene, const MpmMarch *march, const char options[])
{
  MpmMarch *start;

  PetscFunctionBegin;
  if (!MpmSceneIsPeriodic(scene)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmMarchCreate(PETSC_COMM_SELF, scene, &start));
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    PetscReal *first, *last, before = 0, after = 0;

    const PetscBool momentum = !strcmp(scene->scheme.table->fields[f], "v") ? PETSC_TRUE : PETSC_FALSE;

    if (!momentum && (MpmSceneDrifts(scene) || scene->layout.jitter != 0 || scene->scheme.transfer->filter)) continue;
    if (scene->scheme.formulation->staggered != MPM_NONE && scene->scheme.formulation->wave == &MpmWaveSecondOrder &&
        f != scene->scheme.formulation->staggered)
      continue; /* the bar's displacement changes with its momentum */
    PetscCall(GatherField(start, scene->scheme.table->fields[f], &first));
    PetscCall(GatherField(march, scene->scheme.table->fields[f], &last));
    for (PetscInt64 p = 0; p < scene->layout.particles; p++) {
      before += first[p];
      after += last[p];
    }
    CHECK(fabs(after - before) <= 1e-13 * scene->layout.particles * LargestNumber(scene->layout.particles, last),
          "%s: field %s: sum %.17g became %.17g", options, scene->scheme.table->fields[f], before, after);
    PetscCall(PetscFree(first));
    PetscCall(PetscFree(last));
  }
  PetscCall(MpmMarchDestroy(&start));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Holds(const char formulation[], const char rest[], PetscBool migrates)
{
  char      options[512];
  MpmScene *scene;
  MpmMarch *march;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -initial random %s", formulation, rest));
  PetscCall(CheckScene(options, &scene));
  PetscCall(MarchScene(PETSC_COMM_WORLD, scene, &march));
  CHECK((march->migrations > 0) == migrates, "%s: %lld migrations", options, (long long)march->migrations);
  PetscCall(EqualsOneRank(scene, march, options));
  PetscCall(CheckPlaces(march, options));
  PetscCall(CheckConservation(scene, march, options));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Where cells are alike, the places of the first row serve all rows. The result must be the same when each row's own places
   are read.
*/
static PetscErrorCode CheckAlike(const char rest[], PetscBool expected)
{
  char      options[512];
  MpmScene *scene;
  MpmMarch *alike, *read;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-initial random -cells 1111 -courant 0.05 %s", rest));
  PetscCall(CheckScene(options, &scene));
  PetscCall(MarchScene(PETSC_COMM_WORLD, scene, &alike));
  if (MpmRanksOf(PETSC_COMM_WORLD) ==
      1) /* with more, rows may be few, or begin at other cells of a pattern of counts */
    CHECK(alike->nrows > 2 && alike->row[1].alike == expected, "%s: %d rows", options, (int)alike->nrows);
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &read));
  for (PetscInt64 step = 0; step < check_request.steps; step++) {
    for (PetscInt r = 0; r < read->nrows; r++) read->row[r].alike = PETSC_FALSE;
    PetscCall(MpmMarchStep(read));
  }
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    PetscReal *a, *b;

    PetscCall(GatherField(alike, scene->scheme.table->fields[f], &a));
    PetscCall(GatherField(read, scene->scheme.table->fields[f], &b));
    CHECK(LargestDifference(scene->layout.particles, a, b) <= 1e-13 * LargestNumber(scene->layout.particles, b),
          "%s: field %s differs by %g", options, scene->scheme.table->fields[f],
          LargestDifference(scene->layout.particles, a, b));
    PetscCall(PetscFree(a));
    PetscCall(PetscFree(b));
  }
  PetscCall(MpmMarchDestroy(&alike));
  PetscCall(MpmMarchDestroy(&read));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Rescaling by a power of two must not change a digit of later results. */
static PetscErrorCode CheckRescale(void)
{
  MpmScene  *scene;
  MpmMarch  *plain, *scaled;
  PetscReal *a, *b;

  PetscFunctionBegin;
  PetscCall(CheckScene("-formulation elastic -initial random -cells 30 -steps 20 -drift 1/9", &scene));
  PetscCall(MarchScene(PETSC_COMM_WORLD, scene, &plain));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &scaled));
  for (PetscInt64 step = 0; step < check_request.steps; step++) {
    if (step % 3 == 1) PetscCall(MpmMarchRescale(scaled, step % 2 ? 37 : -90));
    PetscCall(MpmMarchStep(scaled));
  }
  PetscCall(GatherField(plain, "u", &a));
  PetscCall(GatherField(scaled, "u", &b));
  CHECK(LargestDifference(scene->layout.particles, a, b) == 0, "rescaling changed u by %g",
        LargestDifference(scene->layout.particles, a, b));
  PetscCall(PetscFree(a));
  PetscCall(PetscFree(b));
  PetscCall(MpmMarchDestroy(&plain));
  PetscCall(MpmMarchDestroy(&scaled));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that only the fields that the table names are registered. A gas has no displacement rate, and a bar no
   density.
*/
static PetscErrorCode CheckFields(const char formulation[], const char other[])
{
  char           options[64];
  MpmScene      *scene;
  MpmMarch      *march;
  void          *field;
  PetscErrorCode found;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s", formulation));
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(PetscPushErrorHandler(PetscReturnErrorHandler, NULL));
  found = DMSwarmGetField(march->particles->swarm, other, NULL, NULL, &field);
  PetscCall(PetscPopErrorHandler());
  CHECK(found, "%s has a field %s", formulation, other);
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt f = 0; MpmFormulations[f]; f++) {
    const char *name = MpmFormulations[f]->name;

    PetscCall(Holds(name, "-cells 61 -steps 40", PETSC_FALSE));
    PetscCall(Holds(name, "-cells 61 -steps 40 -jitter 0.9 -ppc 3", PETSC_FALSE));
    PetscCall(Holds(name, "-cells 61 -steps 300 -drift 0.3 -courant 0.05", PETSC_TRUE));
    PetscCall(Holds(name, "-cells 61 -steps 200 -drift -5/7 -courant 0.05 -jitter 0.6", PETSC_TRUE));
    PetscCall(Holds(name, "-cells 61 -steps 40 -drift 55.5 -courant 0.05", PETSC_TRUE));
    PetscCall(Holds(name, "-cells 61 -steps 40 -drift -1000000 -courant 0.05", PETSC_TRUE));
    PetscCall(Holds(name, "-cells 61 -steps 40 -velocity 0.1 -courant 0.05", PETSC_FALSE));
    PetscCall(Holds(name, "-cells 61 -steps 30 -boundary fixed -basis quadratic -jitter 0.8", PETSC_FALSE));
    PetscCall(Holds(name, "-cells 61 -steps 300 -drift 0.3 -courant 0.05 -basis cubic -transfer xpic -xpic_order 4",
                    PETSC_TRUE));
    PetscCall(Holds(name, "-cells 61 -steps 30 -drift 1/9 -courant 0.1 -basis gimp -transfer pic", PETSC_FALSE));
    PetscCall(Holds(name, "-cells 900 -steps 20 -transfer nullspace -ppc 3", PETSC_FALSE));
  }
  PetscCall(Holds("musl", "-cells 61 -steps 200 -drift 0.3 -courant 0.05 -basis quadratic -transfer apic", PETSC_TRUE));
  /* ranks of different numbers of cells, some without particles, at rest and where particles move from rank to rank */
  PetscCall(Holds("usl", "-cells 61 -steps 50 -boundary fixed,free -fill 0,7.5 -courant 0.3", PETSC_FALSE));
  PetscCall(Holds("gas2", "-cells 60 -steps 50 -fill 8,31 -jitter 0.8 -balance particles", PETSC_FALSE));
  PetscCall(Holds("musl", "-cells 61 -steps 400 -fill 20,28 -drift -1/3 -courant 0.1 -balance particles", PETSC_TRUE));
  PetscCall(Holds("usf", "-cells 61 -steps 50 -boundary fixed_reaction,free -fill 0,55.5 -transfer blend -courant 0.3",
                  PETSC_FALSE));
  PetscCall(Holds("usl", "-cells 900 -steps 50 -boundary free -basis cubic -transfer apic -jitter 0.5", PETSC_FALSE));
  PetscCall(CheckAlike("-formulation gas2 -steps 50", PETSC_TRUE));
  PetscCall(CheckAlike("-formulation usl -ppc 3 -steps 400 -drift 0.3 -basis quadratic", PETSC_TRUE));
  PetscCall(CheckAlike("-formulation musl -ppc 5 -steps 50 -drift -1/7 -basis cubic -transfer apic", PETSC_TRUE));
  PetscCall(CheckAlike("-formulation elastic -ppc 1 -steps 400 -drift -5/7 -basis gimp", PETSC_TRUE));
  PetscCall(
      CheckAlike("-formulation usl -ppc 4 -steps 50 -material two -density_ratio 4 -stiffness_ratio 2", PETSC_TRUE));
  PetscCall(CheckAlike("-formulation musl -ppc 129 -cells 40 -steps 20", PETSC_FALSE));
  PetscCall(CheckAlike("-formulation usl -ppc 2 -steps 20 -boundary fixed,free -basis quadratic", PETSC_TRUE));
  PetscCall(CheckAlike("-formulation usl -ppc 4 -steps 50 -jitter 0.1", PETSC_FALSE));
  PetscCall(CheckAlike("-formulation gas2 -counts 2,2,2,3 -steps 50", PETSC_TRUE));
  PetscCall(CheckRescale());
  PetscCall(CheckFields("gas1", "w"));
  PetscCall(CheckFields("gas2", "w"));
  PetscCall(CheckFields("elastic", "r"));
  PetscCall(CheckFields("usl", "c")); /* only apic has an affine part */
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
