/*
   Mach numbers: the drift that follows is the exact fraction M k. Maps keep it within its rounding. Refined growth is
   that of closed forms at rest, and of many phases under drift.
*/
#include "check.h"
#include "symbols.h"
#include "analysis/critical_mach.h"
#include "analysis/stability_map.h"

/* Both scenes have the same drift, and so the same symbol. */
static PetscErrorCode CheckDrift(const char mach[], const char drift[])
{
  MpmScene  *scene[2];
  MpmSymbol *symbol[2];

  PetscFunctionBegin;
  PetscCall(CheckScene(mach, &scene[0]));
  PetscCall(CheckScene(drift, &scene[1]));
  for (PetscInt a = 0; a < scene[0]->layout.dim; a++) {
    const MpmFraction *f = &scene[0]->step.drift[a], *g = &scene[1]->step.drift[a];

    CHECK(f->den > 0 && f->num == g->num && f->den == g->den && f->value == g->value, "%s: %lld/%lld, not %lld/%lld",
          mach, (long long)f->num, (long long)f->den, (long long)g->num, (long long)g->den);
  }
  for (int i = 0; i < 2; i++) PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene[i], 6, PETSC_FALSE, &symbol[i]));
  CHECK(symbol[0]->growth == symbol[1]->growth, "%s: %.17g and %.17g", mach, symbol[0]->growth, symbol[1]->growth);
  for (int i = 0; i < 2; i++) {
    PetscCall(MpmSymbolDestroy(&symbol[i]));
    PetscCall(MpmSceneDestroy(&scene[i]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckDrifts(void)
{
  PetscFunctionBegin;
  PetscCall(CheckDrift("-cells 6 -mach 0.1", "-cells 6 -drift 1/20"));
  PetscCall(CheckDrift("-cells 6 -mach 1/7 -courant 0.3", "-cells 6 -drift 3/70 -courant 0.3"));
  PetscCall(CheckDrift("-cells 6 -mach -0.25 -courant 1/3", "-cells 6 -drift -1/12 -courant 1/3"));
  PetscCall(CheckDrift("-cells 10 -mach 0.1 -wave_speed 3 -dt 0.01 -length 4", /* k = 0.01 3 10 / 4 */
                       "-cells 10 -drift 3/400 -wave_speed 3 -dt 0.01 -length 4"));
  PetscCall(CheckDrift("-cells 6 -mach 0.1 -formulation usl -density 1 -sound_speed 20 -dt 0.01 -cell_width 0.5",
                       "-cells 6 -drift 1/25 -formulation usl -courant 0.4"));
  PetscCall(CheckDrift("-cells 6 -mach 0", "-cells 6"));
  PetscCall(CheckDrift("-dim 2 -formulation usl -cells 6 -mach 0.1,0.2 -courant 0.4",
                       "-dim 2 -formulation usl -cells 6 -drift 1/25,2/25 -courant 0.4"));
  PetscCall(CheckDrift("-dim 3 -cells 6 -ppc 1 -mach 1/4", "-dim 3 -cells 6 -ppc 1 -drift 1/8"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Map(const char options[], MpmScene **scene, MpmStabilityMap **map)
{
  PetscFunctionBegin;
  PetscCall(CheckSceneOf("map", options, scene));
  PetscCall(MpmStabilityMapCreate(*scene, &check_request, map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The point of a map over k and M: its drift is the fraction that is expected, near M k, and its growth that drift's. */
static PetscErrorCode CheckPoint(const MpmStabilityMap *map, PetscInt point, const char drift[])
{
  const PetscReal mach = map->at[1][point % map->points[1]], courant = map->at[0][point / map->points[1]];
  char            options[128];
  MpmScene       *scene;
  MpmSymbol      *symbol;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "-formulation usl -basis gimp -cells 8 -courant %.17g -drift %s",
                          courant, drift));
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckSymbol(PETSC_COMM_SELF, scene, 8, PETSC_FALSE, &symbol));
  CHECK(map->drift[0][point] == scene->step.drift[0].value, "drift %.17g, not %s", map->drift[0][point], drift);
  CHECK_NEAR(map->drift[0][point], mach * courant, 1.0 / 240 / 240);
  CHECK(map->growth[point] == symbol->growth, "%s: growth %.17g, not %.17g", drift, map->growth[point], symbol->growth);
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckMaps(void)
{
  MpmScene        *scene;
  MpmStabilityMap *map;

  PetscFunctionBegin;
  PetscCall(
      Map("-formulation usl -basis gimp -cells 8 -map_axes courant,mach -map_courant 0.5,0.7 -map_mach 1/1000,0.1 "
          "-map_points 3,3",
          &scene, &map));
  PetscCall(CheckPoint(map, 0, "1/2000"));
  PetscCall(CheckPoint(map, 2, "1/20"));
  PetscCall(CheckPoint(map, 3, "1/1667")); /* 3/5000 */
  PetscCall(CheckPoint(map, 7, "7/198"));  /* 0.7 (1/1000 + 1/10) / 2 = 0.03535 */
  PetscCall(MpmStabilityMapDestroy(&map));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(Map("-dim 2 -formulation usl -cells 2 -ppc 1 -mach 0.1,0.3 -map_axes courant,offset -map_courant 0.4,0.8 "
                "-map_points 2,2",
                &scene, &map));
  CHECK(map->drift[0][0] == 1.0 / 25 && map->drift[1][0] == 3.0 / 25, "drift %g, %g", map->drift[0][0],
        map->drift[1][0]);
  CHECK(map->drift[0][2] == 2.0 / 25 && map->drift[1][2] == 6.0 / 25, "drift %g, %g", map->drift[0][2],
        map->drift[1][2]);
  PetscCall(MpmStabilityMapDestroy(&map));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Refined(const char options[], MpmRefined *refined)
{
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmRefinedGrowth(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, PETSC_FALSE, refined));
  CHECK(refined->settled, "%s: %.12g still moves", options, refined->growth);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of so many phases none grows more than refined growth says, and one grows about as much. */
static PetscErrorCode CheckPhases(const char options[], PetscInt phases)
{
  MpmRefined refined;
  MpmScene  *scene;
  MpmSymbol *symbol;

  PetscFunctionBegin;
  PetscCall(Refined(options, &refined));
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, phases, PETSC_FALSE, &symbol));
  CHECK(refined.growth >= symbol->growth - 1e-13, "%s: %.12g, the symbol %.12g", options, refined.growth,
        symbol->growth);
  CHECK_NEAR(refined.growth - 1, symbol->growth - 1, 2e-3 * (symbol->growth - 1));
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* At rest gas1 grows by sqrt(1 + k^2), at beta = pi / 2; gas2 does not grow. */
static PetscErrorCode CheckRefined(void)
{
  MpmRefined refined;

  PetscFunctionBegin;
  PetscCall(Refined("-formulation gas1 -courant 0.3", &refined));
  CHECK_NEAR(refined.growth, sqrt(1.09), 1e-13);
  CHECK_NEAR(refined.beta[0], PETSC_PI / 2, 1e-6);
  PetscCall(Refined("-formulation gas2 -courant 0.3", &refined));
  CHECK_NEAR(refined.growth, 1, 1e-7);
  PetscCall(CheckPhases("-formulation usl -basis gimp -mach 0.1", 2048));
  PetscCall(CheckPhases("-formulation musl -mach 1/100", 2048));
  PetscCall(CheckPhases("-formulation musl -basis quadratic -mach 0.1 -courant 0.25", 2048));
  PetscCall(CheckPhases("-formulation usf -basis quadratic -mach 1 -courant 0.25", 2048));
  PetscCall(CheckPhases("-dim 2 -formulation gas1 -ppc 1 -courant 0.3", 128));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Critical(const char options[], MpmScene **scene, MpmCriticalMach *found)
{
  MpmCriticalCase of;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, scene));
  of = MpmCriticalCaseOf(*scene, 1e-6);
  PetscCall(MpmCriticalMachCreate(&of, &check_request.mach, found));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A point that grows is above the limit at its own drift, which is found by following eigenvalues. */
static PetscErrorCode CheckGrows(const MpmScene *scene, const MpmMachPoint *p)
{
  MpmCriticalCase of = MpmCriticalCaseOf(scene, 1e-6);
  MpmCritical     limit;

  PetscFunctionBegin;
  MpmMachDrift(&check_request.mach, &p->part, of.step.drift);
  PetscCall(MpmCriticalFind(&of, PETSC_TRUE, &limit));
  CHECK(p->verdict == MPM_UNSTABLE && p->courant > limit.unstable_at,
        "k = %.6g: growth %.12g, the limit at its drift %.6g", p->courant, p->growth, limit.unstable_at);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   All points have the Mach number that was asked for. The first at which usl with flip grows is above the limit at
   its drift. With pic none grows up to its limit at rest, sqrt(1 - 2 q) with q = 3/16. gas1
   grows at all of them.
*/
static PetscErrorCode CheckCritical(void)
{
  MpmScene       *scene;
  MpmCriticalMach found;

  PetscFunctionBegin;
  PetscCall(Critical("-formulation usl -mach 1/4", &scene, &found));
  for (PetscInt i = 0; i < found.n; i++) {
    CHECK_NEAR(found.points[i].courant / 4, found.points[i].part.value, 1e-15);
    CHECK(!i || found.points[i].courant > found.points[i - 1].courant, "points %d and %d", (int)i - 1, (int)i);
  }
  CHECK(found.stable > 0 && found.stable < found.n, "no first window: %d of %d", (int)found.stable, (int)found.n);
  PetscCall(CheckGrows(scene, &found.points[found.stable]));
  PetscCall(MpmCriticalMachDestroy(&found));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(Critical("-formulation usl -transfer pic -mach -0.1", &scene, &found));
  CHECK_NEAR(found.rest, sqrt(0.625), 1e-6);
  CHECK(found.points[found.stable - 1].courant < found.rest && found.points[found.stable].courant > found.rest,
        "pic grows at %.6g", found.points[found.stable].courant);
  PetscCall(MpmCriticalMachDestroy(&found));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(Critical("-formulation gas1 -mach 1/2", &scene, &found));
  CHECK(found.stable == 0 && found.unstable == found.n, "gas1: %d of %d grow", (int)found.unstable, (int)found.n);
  PetscCall(MpmCriticalMachDestroy(&found));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   What a theorem says of the layouts that the scene's own drift meets: usl is told of rk, with the number that rk gives
   of itself, and apic on hats that the theorem does not hold there.
*/
static PetscErrorCode CheckTheorem(void)
{
  MpmScene       *scene;
  MpmCriticalMach found;
  PetscReal       cured;

  PetscFunctionBegin;
  PetscCall(Critical("-formulation usl -mach 1/4 -basis quadratic", &scene, &found));
  CHECK(found.theorem.cure && found.theorem.quiet == 0 && !found.theorem.no_theorem, "usl is not told of rk");
  cured = found.theorem.cured;
  PetscCall(MpmCriticalMachDestroy(&found));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(Critical("-formulation rk -mach 1/4 -basis quadratic", &scene, &found));
  CHECK(cured > 2 && found.theorem.quiet == cured, "rk is quiet up to %.12g, usl is told %.12g", found.theorem.quiet,
        cured);
  PetscCall(MpmCriticalMachDestroy(&found));
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(Critical("-formulation implicit -mach 1/4 -transfer apic", &scene, &found));
  CHECK(found.theorem.quiet == 0 && found.theorem.no_theorem && found.asked.verdict == MPM_UNSTABLE,
        "implicit with apic on hats: quiet up to %.6g", found.theorem.quiet);
  PetscCall(MpmCriticalMachDestroy(&found));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckDrifts());
  PetscCall(CheckMaps());
  PetscCall(CheckRefined());
  PetscCall(CheckCritical());
  PetscCall(CheckTheorem());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
