/* Compiled passes: there are as few as the algorithms allow, and they do nothing that a scene does not need. */
#include "check.h"
#include "march/passes.h"

/* The passes of a step in which particles move, or whose masses are summed. */
static PetscInt CountMoves(const MpmSchedule *s)
{
  PetscInt n = 0;

  for (PetscInt p = 0; p < s->npasses; p++)
    for (PetscInt o = 0; o < s->pass[p].nops; o++) n += MpmOpTraitsOf(s->pass[p].op[o].kind).dst == MPM_NOWHERE;
  return n;
}

static PetscInt CountMasses(const MpmSchedule *s)
{
  PetscInt n = 0;

  for (PetscInt p = 0; p < s->npasses; p++) n += s->pass[p].mass != MPM_NONE;
  return n;
}

static PetscErrorCode Compiles(const char name[], const char more[], PetscInt passes, PetscInt spares, PetscInt halo)
{
  char        options[256];
  MpmScene   *scene;
  MpmSchedule s     = {.npasses = 0};
  PetscInt    spare = 0;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s %s", name, more));
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmScheduleCompile(scene->scheme.table, 0.5, PETSC_FALSE, PETSC_TRUE, &s));
  CHECK(s.npasses == passes, "%s at rest: %d passes", name, s.npasses);
  CHECK(s.halo == halo, "%s: halo %d", name, s.halo);
  CHECK(CountMoves(&s) == 0 && CountMasses(&s) == 0, "%s at rest moves or weighs", name);
  CHECK(s.start.mass != MPM_NONE, "%s: masses are never summed", name);
  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) spare += s.spare[n];
  CHECK(spare == spares, "%s: %d spare arrays", name, spare);

  PetscCall(MpmScheduleCompile(scene->scheme.table, 0.5, PETSC_TRUE, PETSC_TRUE, &s));
  CHECK(s.npasses == passes, "%s drifting: %d passes", name, s.npasses);
  CHECK(CountMoves(&s) == 1 && CountMasses(&s) == 1, "%s drifting", name);

  PetscCall(MpmScheduleCompile(scene->scheme.table, 0.5, PETSC_TRUE, PETSC_FALSE, &s));
  CHECK(s.npasses == passes + 1, "%s migrating in each step: %d passes", name, s.npasses);
  CHECK(s.pass[passes - 1].rebase && !s.pass[passes].rebase, "%s migrates in the wrong pass", name);
  PetscCall(MpmScheduleDestroy(&s));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that what the nodes hold already is not summed again. The second P2G of musl is the first of the next step, as
   long as particles do not move.
*/
static PetscErrorCode SumsOnce(const char options[], PetscInt sums)
{
  MpmScene   *scene;
  MpmSchedule s      = {.npasses = 0};
  PetscInt    summed = 0;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmScheduleCompile(scene->scheme.table, 0.5, MpmSceneDrifts(scene), PETSC_TRUE, &s));
  for (PetscInt p = 0; p < s.npasses; p++)
    for (PetscInt o = 0; o < s.pass[p].nops; o++) summed += MpmOpIsSum(&s.pass[p].op[o]);
  CHECK(summed == sums, "%s: %d sums a step, not %d", options, summed, sums);
  PetscCall(MpmScheduleDestroy(&s));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks that particles take values from nodes as often as they need, and in so many passes: with apic and pic the new
   velocity once, not the old one and then its change. A blend takes the share of pic of the new one.
*/
static PetscErrorCode TakesOnce(const char options[], PetscInt passes, PetscInt gathers)
{
  MpmScene   *scene;
  MpmSchedule s     = {.npasses = 0};
  PetscInt    taken = 0;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmScheduleCompile(scene->scheme.table, 0.5, MpmSceneDrifts(scene), PETSC_TRUE, &s));
  for (PetscInt p = 0; p < s.npasses; p++)
    for (PetscInt o = 0; o < s.pass[p].nops; o++) taken += MpmOpIsGather(&s.pass[p].op[o]);
  CHECK(s.npasses == passes, "%s: %d passes, not %d", options, s.npasses, passes);
  CHECK(taken == gathers, "%s: %d gathers a step, not %d", options, taken, gathers);
  PetscCall(MpmScheduleDestroy(&s));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks the bound on the state's largest number after one step. The bounds are found from the tables by hand, for k =
   1/2.
*/
static PetscErrorCode Bounds(const char options[], PetscReal bound)
{
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  CHECK_NEAR(MpmScheduleBound(scene->scheme.table, MpmBases[0], 0.5, 2, 2, 1), bound, 1e-14);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks the bytes moved per particle and step. They are counted by hand for two particles a cell: 12 for cell and
   place, 16 for each field that changes, and those of the nodes as noted below.
*/
static PetscErrorCode Moves(const char options[], PetscBool alike, PetscReal bytes)
{
  MpmScene   *scene;
  MpmSchedule s = {.npasses = 0};

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmScheduleCompile(scene->scheme.table, 0.5, MpmSceneDrifts(scene), PETSC_TRUE, &s));
  CHECK_NEAR(MpmScheduleBytes(scene->scheme.table, &scene->layout, &s, 2, alike), bytes, 0);
  PetscCall(MpmScheduleDestroy(&s));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(Compiles("gas1", "", 1, 2, 0));
  PetscCall(Compiles("gas2", "", 2, 0, 0));
  PetscCall(Compiles("elastic", "", 1, 1, 1));
  PetscCall(Compiles("usl", "", 1, 2, 0));
  PetscCall(Compiles("usf", "", 2, 0, 0));
  PetscCall(Compiles("musl", "", 2, 0, 0));
  PetscCall(Compiles("usl", "-transfer pic", 1, 1, 0));
  PetscCall(Compiles("usl", "-transfer xpic -xpic_order 4", 4, 1, 0));
  PetscCall(SumsOnce("-formulation musl", 2));
  PetscCall(SumsOnce("-formulation musl -drift 1/8", 3));
  PetscCall(SumsOnce("-formulation musl -boundary fixed,fixed -cells 16", 3)); /* a wall changes what nodes hold */
  PetscCall(TakesOnce("-formulation usl -transfer pic", 1, 2));
  PetscCall(TakesOnce("-formulation usl -transfer blend", 1, 3));
  PetscCall(TakesOnce("-formulation usl -transfer apic -gradient mls -dim 2", 1, 2 + 4 + 6));
  PetscCall(TakesOnce("-formulation usl -transfer apic -gradient mls -dim 2 -boundary fixed", 1, 2 + 4 + 6));
  PetscCall(TakesOnce("-formulation usl -transfer apic -gradient mls -dim 3 -poisson 0.3", 1, 3 + 9 + 15));
  PetscCall(
      TakesOnce("-formulation usl -transfer pic -boundary fixed_reaction", 2, 3)); /* they take the reaction too */
  PetscCall(TakesOnce("-formulation usf -transfer blend", 2, 3));
  PetscCall(Bounds("-formulation gas1", 2));
  PetscCall(Bounds("-formulation gas2", 3));
  PetscCall(Bounds("-formulation elastic", 3)); /* w: 1 + 4k; u: 1 + k (1 + 4k) */
  PetscCall(Bounds("-formulation usl", 4));     /* a: 4k; v: 1 + 4k; s: 1 + 2k (1 + 4k) */
  /* each of two passes reads one node field and changes the other, and reads the mass; under drift one changes it too */
  PetscCall(Moves("-formulation gas2", PETSC_FALSE, 2 * 12 + 32 + 2 * (24 + 8) / 2));
  PetscCall(Moves("-formulation gas2", PETSC_TRUE, 32 + 2 * (24 + 8) / 2));
  PetscCall(Moves("-formulation gas2 -drift 1/8", PETSC_TRUE, 32 + (2 * (24 + 8) + 8) / 2));
  /* the old node fields are kept beside the new ones */
  PetscCall(Moves("-formulation gas1", PETSC_TRUE, 32 + (48 + 8) / 2));
  /* u, w and the old w, a, mass; LAP and ADD are sweeps */
  PetscCall(Moves("-formulation elastic", PETSC_TRUE, 32 + (16 + 24 + 8 + 8 + 2 * 24) / 2));
  PetscCall(Moves("-formulation usl -material two -density_ratio 4 -stiffness_ratio 2", PETSC_FALSE,
                  12 + 32 + 16 + (48 + 8 + 24) / 2));
  /* v, s, v_i and the old v_i, a_i and the old a_i, mass; ADD */
  PetscCall(Moves("-formulation usl -boundary fixed", PETSC_TRUE, 32 + (24 + 24 + 8 + 24) / 2));
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
