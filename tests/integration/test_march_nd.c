/*
   The march in two and three dimensions. What the assembled operator says, A q = march(q), must hold for every
   formulation, transfer and basis. Results by particle id on all ranks equal those on one rank. A scene that does not
   vary along y is the one-dimensional one, and a scene with its axes exchanged is the same scene.
*/
#include "gather.h"
#include "march/diagnostics.h"
#include "operators.h"

static PetscErrorCode AllAgree(size_t n, const char *const options[])
{
  PetscFunctionBegin;
  for (size_t i = 0; i < n; i++) PetscCall(CheckOperator(options[i], 1e-13));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Every scheme in a plane, at rest, jittered, drifting in both directions and along one. */
static PetscErrorCode SchemesAgree(void)
{
  static const char *const schemes[] = {
      "-formulation gas1",
      "-formulation gas2 -basis quadratic",
      "-formulation elastic",
      "-formulation usl -basis quadratic",
      "-formulation usl -transfer apic -gradient mls -basis quadratic",
      "-formulation usl -transfer apic -basis gimp",
      "-formulation usl -poisson 0.5 -transfer apic -gradient mls -basis cubic",
      "-formulation usf -transfer pic -basis cubic",
      "-formulation musl -transfer blend",
      "-formulation musl -transfer xpic -basis gimp -poisson 0",
      "-formulation usavg -basis cubic -gradient mls",
  };
  static const char *const rests[] = {
      "-dim 2 -cells 6,7",
      "-dim 2 -cells 7,6 -jitter 0.8 -ppc 1,2",
      "-dim 2 -cells 6,7 -ppc 1 -drift 1/2,-1/3 -courant 0.1",
      "-dim 2 -cells 7,6 -ppc 1 -drift 0,1/2 -courant 0.1",
  };

  PetscFunctionBegin;
  for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(schemes); s++) {
    for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) {
      char options[512];

      PetscCall(PetscSNPrintf(options, sizeof options, "%s %s", schemes[s], rests[r]));
      PetscCall(CheckOperator(options, 1e-13));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Walls of every kind, which meet in corners, two materials, and boxes of particles. */
static const char *const walls[] = {
    "-dim 2 -cells 6,7 -formulation gas2 -boundary fixed,periodic",
    "-dim 2 -cells 7,6 -formulation elastic -boundary fixed,fixed",
    "-dim 2 -cells 6,7 -formulation usl -basis quadratic -boundary fixed,fixed_reaction -jitter 0.5",
    "-dim 2 -cells 6,7 -formulation musl -basis cubic -boundary symmetry,free-fixed",
    "-dim 2 -cells 7,6 -formulation usf -transfer apic -basis gimp -boundary fixed_reaction-symmetry,fixed",
    "-dim 2 -cells 6 -formulation usavg -transfer xpic -basis quadratic -boundary periodic,symmetry-fixed_reaction",
    "-dim 2 -cells 8 -formulation usl -fill 2,5,1,6 -boundary free,free -material two -inclusion 3,5,2,4 "
    "-density_ratio 3 -stiffness_ratio 7 -transfer apic",
    "-dim 2 -cells 7 -formulation musl -basis quadratic -gradient mls -drift 1/2,0 -courant 0.1 -boundary "
    "periodic,symmetry",
    "-dim 2 -cells 6 -formulation usl -boundary free -offset 0",
};

static const char *const boxes[] = {
    "-dim 3 -cells 4,3,5 -formulation usl -basis quadratic -courant 0.3",
    "-dim 3 -cells 3,4,3 -ppc 1 -formulation usl -transfer apic -gradient mls -basis quadratic -jitter 0.7",
    "-dim 3 -cells 3,4,3 -ppc 1 -formulation musl -drift 1/2,-1/2,1/3 -courant 0.1",
    "-dim 3 -cells 4,3,3 -ppc 1 -formulation gas2 -drift 0,0,1/3 -courant 0.1",
    "-dim 3 -cells 4 -ppc 1,1,2 -formulation elastic -boundary fixed,periodic,fixed",
    "-dim 3 -cells 4 -ppc 1 -formulation usl -boundary fixed,symmetry,free-fixed_reaction -basis cubic -poisson 0.5",
};

/*
   A run gives the same state by particle id on all ranks and on one, loses no particle, and conserves mass and
   momentum.
*/
static PetscErrorCode EqualsOneRank(const char options[])
{
  PetscReal    changes[2];
  MpmScene    *scene;
  MpmMarch    *march, *alone;
  MpmConserved start;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(MpmConservedSum(march, &start));
  CHECK(start.particles == scene->layout.particles, "%s: %d particles", options, (int)start.particles);
  for (PetscInt64 step = 0; step < check_request.steps; step++) PetscCall(MpmMarchStep(march));
  PetscCall(MpmConservedCheck(march, &start, changes));
  CHECK(changes[0] <= 1e-13 && !(changes[1] > 1e-13), "%s: mass changes by %g, momentum by %g", options, changes[0],
        changes[1]);
  if (MpmLayoutIsPeriodic(&scene->layout) && scene->scheme.formulation->conserved != MPM_NONE)
    CHECK(changes[1] <= 1e-13, "%s: no momentum", options);
  CHECK((march->migrations > 0) == MpmSceneDrifts(scene), "%s: %d migrations", options, (int)march->migrations);
  PetscCall(MarchScene(PETSC_COMM_SELF, scene, &alone));
  for (PetscInt f = 0; scene->scheme.table->fields[f]; f++) {
    const PetscInt64 n = scene->layout.particles;
    PetscReal       *many, *one;

    PetscCall(GatherField(march, scene->scheme.table->fields[f], &many));
    PetscCall(GatherField(alone, scene->scheme.table->fields[f], &one));
    CHECK(LargestNumber(n, one) > 0, "%s: nothing there", options);
    CHECK(LargestDifference(n, many, one) <= 1e-13 * LargestNumber(n, one), "%s: field %s differs by %g", options,
          scene->scheme.table->fields[f], LargestDifference(n, many, one));
    PetscCall(PetscFree(many));
    PetscCall(PetscFree(one));
  }
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmMarchDestroy(&alone));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode RanksAgree(void)
{
  static const char *const runs[] = {
      "-dim 2 -cells 24 -formulation usl -basis quadratic -initial random -steps 30 -courant 0.2",
      "-dim 2 -cells 26,24 -formulation usl -drift 1/3,-1/4 -initial random -steps 60 -courant 0.02",
      "-dim 2 -cells 24,7 -formulation usl -transfer apic -basis cubic -drift 0,3/4 -initial random -steps 20 -courant "
      "0.02",
      "-dim 2 -cells 24,25 -formulation musl -jitter 0.9 -basis gimp -boundary fixed,symmetry-free -initial random "
      "-steps 20 -courant 0.1",
      "-dim 2 -cells 24,25 -formulation gas2 -jitter 0.9 -drift 7/3,1/2 -initial random -steps 20 -courant 0.05",
      "-dim 2 -cells 30 -formulation usl -drift 61/3,-20/3 -initial random -steps 10 -courant 0.02",
      "-dim 2 -cells 24 -formulation elastic -boundary fixed,periodic -initial random -steps 20 -courant 0.1",
      "-dim 3 -cells 12,13,12 -ppc 1 -formulation usl -transfer apic -gradient mls -basis quadratic -drift "
      "1/3,-1/4,1/5 "
      "-initial random -steps 20 -courant 0.02",
      "-dim 3 -cells 12 -ppc 1,2,1 -formulation usf -boundary fixed,symmetry,periodic -initial random -steps 10 "
      "-courant 0.2",
      "-dim 2 -cells 15,14 -formulation usl -basis quadratic -initial random -steps 30 -fill 0,6,0,4 -boundary "
      "fixed,free "
      "-courant 0.3",
      "-dim 2 -cells 15,14 -formulation musl -initial random -steps 60 -fill 5,9,5,14 -drift 1/3,-1/5 -courant 0.1 "
      "-balance particles",
      "-dim 3 -cells 9,8,7 -ppc 1 -formulation usl -initial random -steps 10 -fill 0,9,0,3,0,2 -jitter 0.7 -courant "
      "0.1",
  };

  PetscFunctionBegin;
  for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(runs); r++) PetscCall(EqualsOneRank(runs[r]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets a register of every particle to a hash of a part of its id. */
static PetscErrorCode SetField(MpmMarch *march, const char name[], PetscInt64 (*part)(const MpmLayout *, PetscInt64))
{
  const PetscInt64 *id;
  PetscReal        *q;

  PetscFunctionBegin;
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  PetscCall(MpmParticlesGet(march->particles, name, &q));
  for (PetscInt p = 0; p < march->particles->count; p++) q[p] = part ? MpmHash(7, part(march->layout, id[p])) - 0.5 : 0;
  PetscCall(MpmParticlesRestore(march->particles, name, &q));
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscInt64 Column(const MpmLayout *layout, PetscInt64 id)
{
  return id % layout->row[0];
}
/*
   A state that does not vary along y: v_x and s_xx go on as v and s do in one dimension.
*/
static PetscErrorCode UniformEqualsLine(const char options[])
{
  char      line[512], plane[512];
  MpmScene *scene[2];
  MpmMarch *march[2];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(line, sizeof line, "-dim 1 -cells 20 %s", options));
  PetscCall(PetscSNPrintf(plane, sizeof plane, "-dim 2 -cells 20,12 %s", options));
  PetscCall(CheckScene(line, &scene[0]));
  PetscCall(CheckScene(plane, &scene[1]));
  for (int i = 0; i < 2; i++) {
    PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene[i], &march[i]));
    for (PetscInt f = 0; scene[i]->scheme.table->fields[f]; f++)
      PetscCall(SetField(march[i], scene[i]->scheme.table->fields[f], NULL));
    PetscCall(SetField(march[i], scene[i]->scheme.table->fields[0], Column));
    PetscCall(MpmMarchStart(march[i]));
    for (int step = 0; step < 30; step++) PetscCall(MpmMarchStep(march[i]));
  }
  for (int f = 0; f < 2; f++) {
    PetscReal *one, *many, largest = 0, most;

    PetscCall(GatherField(march[0], f ? "s" : "v", &one));
    PetscCall(GatherField(march[1], f ? "s_xx" : "v_x", &many));
    most = LargestNumber(scene[0]->layout.particles, one);
    for (PetscInt64 id = 0; id < scene[1]->layout.particles; id++)
      largest = PetscMax(largest, fabs(many[id] - one[Column(&scene[1]->layout, id)]));
    CHECK(most > 0.01 && largest <= 1e-13 * most, "%s: field %d differs by %g of %g", options, f, largest, most);
    PetscCall(PetscFree(one));
    PetscCall(PetscFree(many));
  }
  for (int i = 0; i < 2; i++) {
    PetscCall(MpmMarchDestroy(&march[i]));
    PetscCall(MpmSceneDestroy(&scene[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The particle of the scene with exchanged axes that is where particle id is. */
static PetscInt64 Exchanged(const MpmLayout *layout, PetscInt64 id)
{
  return id / layout->row[0] + layout->row[1] * (id % layout->row[0]);
}

static PetscInt64 Itself(const MpmLayout *layout, PetscInt64 id)
{
  (void)layout;
  return id;
}

/* A scene and the one with its axes exchanged: v_x starts with the same numbers as v_y there. */
static PetscErrorCode AxesExchange(const char xy[], const char yx[])
{
  const char *const options[]   = {xy, yx};
  const char *const fields[][2] = {{"v_x", "v_y"}, {"v_y", "v_x"}, {"s_xx", "s_yy"}, {"s_xy", "s_xy"}};
  MpmScene         *scene[2];
  MpmMarch         *march[2];

  PetscFunctionBegin;
  for (int i = 0; i < 2; i++) {
    PetscCall(CheckScene(options[i], &scene[i]));
    PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene[i], &march[i]));
    for (PetscInt f = 0; scene[i]->scheme.table->fields[f]; f++)
      PetscCall(SetField(march[i], scene[i]->scheme.table->fields[f], NULL));
    PetscCall(SetField(march[i], fields[0][i], i ? Exchanged : Itself));
    PetscCall(MpmMarchStart(march[i]));
    for (int step = 0; step < 20; step++) PetscCall(MpmMarchStep(march[i]));
  }
  for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(fields); f++) {
    PetscReal *one, *other, largest = 0, most;

    PetscCall(GatherField(march[0], fields[f][0], &one));
    PetscCall(GatherField(march[1], fields[f][1], &other));
    most = LargestNumber(scene[0]->layout.particles, one);
    for (PetscInt64 id = 0; id < scene[0]->layout.particles; id++)
      largest = PetscMax(largest, fabs(one[id] - other[Exchanged(&scene[0]->layout, id)]));
    CHECK(most > 1e-3 && largest <= 1e-13 * most, "%s: %s differs by %g of %g", xy, fields[f][0], largest, most);
    PetscCall(PetscFree(one));
    PetscCall(PetscFree(other));
  }
  for (int i = 0; i < 2; i++) {
    PetscCall(MpmMarchDestroy(&march[i]));
    PetscCall(MpmSceneDestroy(&scene[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  if (size == 1) {
    PetscCall(SchemesAgree());
    PetscCall(AllAgree(PETSC_STATIC_ARRAY_LENGTH(walls), walls));
    PetscCall(AllAgree(PETSC_STATIC_ARRAY_LENGTH(boxes), boxes));
  }
  PetscCall(RanksAgree());
  PetscCall(UniformEqualsLine("-formulation usl -basis quadratic -courant 0.3"));
  PetscCall(UniformEqualsLine("-formulation musl -transfer apic -gradient mls -basis cubic -courant 0.3"));
  PetscCall(UniformEqualsLine("-formulation usf -drift 1/3 -courant 0.1"));
  PetscCall(AxesExchange("-dim 2 -cells 12,16 -ppc 1,2 -formulation usl -basis quadratic -boundary fixed,periodic "
                         "-drift 0,1/3 -courant 0.2",
                         "-dim 2 -cells 16,12 -ppc 2,1 -formulation usl -basis quadratic -boundary periodic,fixed "
                         "-drift 1/3,0 -courant 0.2"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
