/*
   Stability maps: each point is the symbol of the scene with the point's numbers, to the last bit and on any number of
   ranks. A drift by a whole cell has no effect. At rest the map turns unstable where the formulas say.
*/
#include "check.h"
#include "symbols.h"
#include "symbol/predict.h"
#include <mpmstab/critical.h>
#include "analysis/stability_map.h"

static PetscErrorCode MapOf(const char options[], MpmScene **scene, MpmStabilityMap **map)
{
  PetscFunctionBegin;
  PetscCall(CheckSceneOf("map", options, scene));
  PetscCall(MpmStabilityMapCreate(*scene, &check_request, map));
  PetscCall(MpmStabilityMapLimits(*map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Close(MpmScene **scene, MpmStabilityMap **map)
{
  PetscFunctionBegin;
  PetscCall(MpmStabilityMapDestroy(map));
  PetscCall(MpmSceneDestroy(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* texts: the text that a user would write for each of the point's two numbers. */
static PetscErrorCode CheckPoint(const char scheme[], const char axes[], PetscInt i, PetscInt j, const char texts[])
{
  char             options[512];
  MpmScene        *scene, *alone;
  MpmStabilityMap *map;
  MpmSymbol       *symbol;
  PetscInt         point;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(options, sizeof options, "%s %s", scheme, axes));
  PetscCall(MapOf(options, &scene, &map));
  PetscCall(PetscSNPrintf(options, sizeof options, "%s %s", scheme, texts));
  PetscCall(CheckScene(options, &alone));
  PetscCall(CheckSymbol(PETSC_COMM_SELF, alone, check_request.phases[0], PETSC_FALSE, &symbol));
  point = i * map->points[1] + j;
  CHECK(map->growth[point] == symbol->growth, "%s %s: %.17g, the symbol %.17g", scheme, texts, map->growth[point],
        symbol->growth);
  for (PetscInt a = 0; a < scene->layout.dim; a++)
    CHECK(map->beta[a][point] == symbol->beta_at_max[a], "%s %s: at %g, the symbol at %g", scheme, texts,
          map->beta[a][point], symbol->beta_at_max[a]);
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&alone));
  PetscCall(Close(&scene, &map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckPoints(void)
{
  PetscFunctionBegin;
  PetscCall(CheckPoint("-cells 16", "-map_points 4,3 -map_courant 0.1,0.4", 1, 1, "-courant 0.2 -drift 1/4"));
  PetscCall(CheckPoint("-formulation musl -basis quadratic -cells 12", "-map_points 2,4 -map_drift -1/3,1/7", 0, 2,
                       "-courant 0.05 -drift -1/63"));
  PetscCall(CheckPoint("-formulation usl -transfer apic -cells 12 -drift 1/3",
                       "-map_axes offset,courant -map_points 5,3 -map_offset 0.1,0.5 -map_courant 0.5,0.7", 3, 1,
                       "-offset 0.4 -courant 0.6 -drift 1/3"));
  PetscCall(CheckPoint("-formulation usf -basis gimp -cells 12 -courant 1.1",
                       "-map_axes ppc,offset -map_ppc 2,6 -map_points 5,3", 1, 1, "-ppc 3 -offset 1/4 -courant 1.1"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* In two and three dimensions; a drift that is turned by 45 degrees has its components rounded to 1/240. */
static PetscErrorCode CheckSpace(void)
{
  PetscFunctionBegin;
  PetscCall(CheckPoint("-dim 2 -formulation usl -transfer apic -basis quadratic -gradient mls -cells 4",
                       "-map_axes courant,poisson -map_points 3,3 -map_courant 1/2,3/2 -map_poisson 0,1/2", 1, 1,
                       "-courant 1 -poisson 0.25"));
  PetscCall(CheckPoint("-dim 2 -formulation musl -cells 4", /* a fluid has fewer fields */
                       "-map_axes poisson,courant -map_points 3,3 -map_courant 1/2,3/2 -map_poisson 0,1/2", 2, 2,
                       "-courant 1.5 -poisson 0.5"));
  for (int i = 0; i < 3; i++)
    PetscCall(CheckPoint("-dim 2 -formulation usf -cells 4 -ppc 1 -drift 1/8,0",
                         "-map_axes drift_angle,courant -map_points 3,2 -map_courant 0.3,0.6", i, 1,
                         i == 0   ? "-courant 0.6"
                         : i == 1 ? "-courant 0.6 -drift 7/80,7/80"
                                  : "-courant 0.6 -drift 0,1/8"));
  PetscCall(CheckPoint("-dim 3 -cells 3 -ppc 1 -drift 0,0,1/2 -courant 0.4",
                       "-map_axes drift_angle,drift -map_points 2,2 -map_drift 1/4,1/2", 1, 0, "-drift 0,1/4,1/2"));
  PetscCall(CheckPoint("-dim 2 -formulation usl -cells 4 -ppc 1 -drift 0,1/8", "-map_points 2,3", 0, 1,
                       "-courant 0.05 -drift 0,1/4"));
  PetscCall(CheckPoint("-dim 2 -formulation usl -cells 4 -ppc 1", "-map_points 2,3", 0, 1, "-courant 0.05 -drift 1/4"));
  PetscCall(CheckPoint("-dim 2 -formulation usf -basis gimp -cells 4 -courant 1.1",
                       "-map_axes ppc,offset -map_ppc 1,2 -map_points 2,3", 1, 1, "-ppc 2 -offset 1/4 -courant 1.1"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The limit of usl with flip on hats is 1 / sqrt(1 + 4 q) = 0.756 at any Poisson's ratio. */
static PetscErrorCode CheckPoisson(void)
{
  MpmScene        *scene;
  MpmStabilityMap *map;

  PetscFunctionBegin;
  PetscCall(MapOf("-dim 2 -formulation usl -cells 8 -map_axes courant,poisson -map_points 4,3 -map_courant 0.7,0.85",
                  &scene, &map));
  for (PetscInt j = 0; j < 3; j++) {
    CHECK_NEAR(map->limits[j], 1 / sqrt(1.75), 1e-9);
    for (PetscInt i = 0; i < 4; i++)
      CHECK((map->verdict[3 * i + j] == MPM_UNSTABLE) == (map->at[0][i] > map->limits[j]), "nu %g, k = %g: %.12g",
            map->at[1][j], map->at[0][i], map->growth[3 * i + j]);
  }
  PetscCall(Close(&scene, &map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   gas2 at rest is stable up to 2 / abs(mu) where C1 = C2, and a drift of a whole cell changes nothing. With a drift of
   half a cell every step takes a particle to the place of the next one; e stays 0, and growth begins at 1.837 (by hand,
   from the operator over two steps). With other drifts it grows at any Courant number.
*/
static PetscErrorCode CheckGas2(void)
{
  MpmScene        *scene;
  MpmStabilityMap *map;
  PetscInt         turn = 0;

  PetscFunctionBegin;
  PetscCall(MapOf("-cells 16 -map_courant 0.25,3 -map_drift 0,1 -map_points 12,5", &scene, &map));
  for (PetscInt i = 0; i < 12; i++) {
    const PetscReal *row = map->growth + 5 * i;

    turn += map->verdict[5 * i] == MPM_STABLE;
    CHECK(row[0] == row[4], "drift 0 grows by %.17g, drift 1 by %.17g", row[0], row[4]);
    CHECK((map->verdict[5 * i + 2] == MPM_STABLE) == (map->at[0][i] < 1.837), "k = %g, drift 1/2: %.9g", map->at[0][i],
          row[2]);
    for (int j = 1; j < 4; j += 2)
      CHECK(map->verdict[5 * i + j] == MPM_UNSTABLE, "k = %g, drift %g: %.9g", map->at[0][i], map->at[1][j], row[j]);
  }
  CHECK(turn == 8 && map->at[0][7] == 2, "%d Courant numbers are stable at rest, the last %g", (int)turn,
        map->at[0][turn - 1]);
  CHECK_NEAR(map->limits[0], 2, 1e-8);
  CHECK(isnan(map->limits[1]) && isnan(map->limits[4]), "formulas for particles that drift");
  CHECK_NEAR(map->published_limit, M_SQRT1_2, 1e-15);
  CHECK(map->unstable == 60 - 3 * turn + 1 && map->undecided == 0, "%d unstable, %d undecided", (int)map->unstable,
        (int)map->undecided);
  CHECK(map->finding.growth == map->growth[map->worst] && map->worst / 5 == 11, "worst point %d", (int)map->worst);
  PetscCall(Close(&scene, &map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The limit of usf on hats is 1 / sqrt(1 - 4 q) if q <= 1/8, else 4 sqrt(q), with q = mean of xi (1 - xi) (docs/theory.md,
   section 4).
*/
static PetscErrorCode CheckOffsets(void)
{
  MpmScene        *scene;
  MpmStabilityMap *map;

  PetscFunctionBegin;
  PetscCall(MapOf("-formulation usf -cells 64 -ppc 1 -map_axes courant,offset -map_points 40,6 -map_courant 0.05,2 "
                  "-map_offset 0,1/2",
                  &scene, &map));
  for (PetscInt j = 0; j < 6; j++) {
    const PetscReal xi = map->at[1][j], q = xi * (1 - xi), limit = q <= 0.125 ? 1 / sqrt(1 - 4 * q) : 4 * sqrt(q);

    CHECK_NEAR(map->limits[j], limit, 1e-8);
    for (PetscInt i = 0; i < 40; i++) {
      if (fabs(map->at[0][i] - limit) < 1e-3 * limit) continue; /* growth begins between two of the phases computed */
      CHECK((map->verdict[6 * i + j] == MPM_UNSTABLE) == (map->at[0][i] > limit), "xi %g, k = %g: %.12g", xi,
            map->at[0][i], map->growth[6 * i + j]);
    }
  }
  CHECK(isnan(map->published_limit), "the slides have no usf");
  PetscCall(Close(&scene, &map));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckPoints());
  PetscCall(CheckSpace());
  PetscCall(CheckPoisson());
  PetscCall(CheckGas2());
  PetscCall(CheckOffsets());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
