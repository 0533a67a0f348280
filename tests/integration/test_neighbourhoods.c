/*
   Neighbourhoods: the closed form of a lone particle against known numbers and against the assembled operator of one
   particle; random layouts without voids against the assembled operator of the same layout, those with one particle
   left against its closed form, and all of them against the bound; and the worst of several.
*/
#include "check.h"
#include "analysis/lone.h"
#include "analysis/neighbourhoods.h"
#include "linalg/dense.h"
#include "scene/layout.h"
#include <mpmstab/operator.h>

static PetscErrorCode LoneOf(const char options[], MpmNeighbourhood *lone)
{
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmLoneFind(&scene->layout, &scene->scheme, scene->step.courant, lone));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* 2 sqrt(D / chi) and sqrt(2 D / chi), with D = 1/4 and 1/3; hats fall to 0 at a face; usf and musl have none on splines. */
static PetscErrorCode CheckNumbers(void)
{
  static const struct {
    const char *options;
    PetscReal   courant;
  } known[] = {
      {"-dim 2 -formulation usl -transfer apic -gradient mls -basis quadratic", 0.83666002653407556},
      {"-dim 3 -formulation usl -transfer apic -gradient mls -basis quadratic", 0.73379938570534287},
      {"-dim 2 -formulation usl -transfer apic -gradient mls -basis quadratic -poisson 0.5", 0.70710678118654752},
      {"-dim 3 -formulation musl -transfer apic -gradient mls -basis quadratic -poisson 0.5", 0.57735026918962576},
      {"-formulation usavg -transfer apic -gradient mls -basis cubic", 1.1547005383792515},
      {"-dim 2 -formulation usl -transfer flip -gradient mls -basis quadratic", 0.59160797830996160},
      {"-dim 3 -formulation usl -transfer pic -gradient mls -basis quadratic -poisson 0.5", 0.40824829046386302},
      {"-formulation usl -transfer nullspace -basis quadratic", 0.57735026918962576},
      {"-formulation usl", 0},
      {"-dim 3 -formulation usl -transfer apic", 0},
      {"-formulation usf -transfer apic", 0},
      {"-formulation usf -basis quadratic", INFINITY},
      {"-dim 2 -formulation musl -transfer pic -basis gimp", INFINITY},
  };
  MpmNeighbourhood lone;

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(known); i++) {
    PetscCall(LoneOf(known[i].options, &lone));
    CHECK(lone.closed &&
              (lone.courant == known[i].courant || fabs(lone.courant - known[i].courant) <= 2e-9 * known[i].courant),
          "%s: %.12g, not %.12g", known[i].options, lone.courant, known[i].courant);
  }
  PetscCall(LoneOf("-formulation usl -transfer apic -basis quadratic", &lone));
  CHECK(!lone.closed, "a closed form for apic with the gradient of quadratic splines");
  PetscCall(LoneOf("-formulation usl -transfer fmpm -basis quadratic", &lone));
  CHECK(!lone.closed, "a closed form for fmpm, whose stress is of another nodal velocity");
  PetscCall(LoneOf("-formulation musl", &lone));
  CHECK(!lone.closed, "a closed form for musl on hats, which has a limit on a node");
  PetscCall(LoneOf("-formulation gas2", &lone));
  CHECK(!lone.closed, "a closed form for a gas");
  PetscCall(LoneOf("-formulation usl -basis quadratic -courant 0.9", &lone));
  CHECK(fabs(lone.growth - 3.86) < 1e-8 && lone.approached && fabs(lone.place[0] - 0.5) < 1e-9, "growth %.12g at %.12g",
        lone.growth, lone.place[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Growth of one particle at a place, by all eigenvalues of its assembled operator. */
static PetscErrorCode AssembledGrowth(const char options[], PetscReal place, PetscReal courant, PetscReal *growth)
{
  char         all[256];
  MpmScene    *scene;
  MpmOperator *op;
  PetscReal    value[2];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof all, "%s -cells 6 -ppc 1 -fill 2,3 -offset %.17g -courant %.17g", options, place,
                          courant));
  PetscCall(CheckScene(all, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmDenseLargest(op->balanced, value));
  *growth = MpmGrowthPerStep(hypot(value[0], value[1]), op->exponent, 1);
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Below the closed form no place grows. Next to its own place there is growth just above it. */
static PetscErrorCode CheckAssembled(void)
{
  static const char *const cases[] = {
      "-formulation usl -basis quadratic",
      "-formulation usl -basis cubic -transfer pic",
      "-formulation usl -basis gimp -transfer blend",
      "-formulation usl -basis gimp -gradient mls -transfer apic",
      "-formulation musl -basis cubic -gradient mls -transfer apic",
      "-dim 2 -formulation usl -basis quadratic -poisson 0.2",
      "-formulation usl -basis quadratic -gradient mls -transfer aflip",
      "-formulation usl -basis cubic -gradient mls -transfer tpic",
      "-formulation usf -basis gimp -gradient mls -transfer asflip",
      "-dim 2 -formulation usavg -basis gimp -gradient mls -transfer apic",
  };

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(cases); i++) {
    char             options[256];
    MpmNeighbourhood lone;
    PetscReal        growth;

    PetscCall(PetscSNPrintf(options, sizeof options, "%s -ppc 1", cases[i]));
    PetscCall(LoneOf(options, &lone));
    for (int n = 0; n < 3; n++) {
      PetscCall(AssembledGrowth(cases[i], MpmHash(11, 3 * (PetscInt64)i + n), lone.courant * (1 - 1e-6), &growth));
      CHECK(growth <= 1 + 1e-6, "%s: growth %.9g below %.9g", cases[i], growth, lone.courant);
    }
    PetscCall(AssembledGrowth(cases[i], isnan(lone.place[0]) ? 0.3 : fabs(lone.place[0] - 1e-5),
                              lone.courant * (1 + 5e-5), &growth));
    CHECK(growth > 1 + 5e-5, "%s: growth %.9g beside %g, above %.9g", cases[i], growth, lone.place[0], lone.courant);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Without voids the layout is that of a jittered scene. dgeev and the nodal operator leave rounding of defective pairs. */
static PetscErrorCode CheckFull(const char options[], const char box[])
{
  char             all[256];
  MpmScene        *scene;
  MpmOperator     *op;
  MpmRandomLayouts asked   = {.n = 1, .seed = 5};
  MpmNeighbourhood layouts = {.kind = MPM_AT_RANDOM};
  MpmCriticalCase  of;
  PetscReal        value[2];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(all, sizeof all, "%s %s -ppc 1 -jitter 0.8 -seed 5 -courant 1.7", options, box));
  PetscCall(CheckScene(all, &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmRandomLayoutsFind(&of, &asked, &layouts));
  PetscCall(MpmOperatorCreate(PETSC_COMM_SELF, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmDenseLargest(op->balanced, value));
  CHECK_NEAR(layouts.growth / MpmGrowthPerStep(hypot(value[0], value[1]), op->exponent, 1), 1, 1e-6);
  CHECK(layouts.unstable == (layouts.growth > 1 + 1e-6) && layouts.worst_seed == 5, "%s: %d unstable", options,
        (int)layouts.unstable);
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckNoVoids(void)
{
  static const char *const transfers[] = {"flip", "pic", "xpic", "apic", "tpic", "aflip", "fmpm"};

  PetscFunctionBegin;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (size_t t = 0; t < PETSC_STATIC_ARRAY_LENGTH(transfers); t++) {
      char options[128];

      if (MpmTransferFind(transfers[t])->affine && !MpmFormulationHas(MpmFormulations[f], MPM_DIV)) continue;
      if (MpmFormulationHas(MpmFormulations[f], MPM_IMPLICIT)) continue; /* random layouts need the nodes' operator */
      PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -transfer %s -basis %s",
                              MpmFormulations[f]->name, transfers[t], MpmBases[(f + (PetscInt)t) % 4]->name));
      PetscCall(CheckFull(options, "-cells 24"));
    }
  PetscCall(CheckFull("-dim 2 -formulation usl -transfer apic -gradient mls -basis quadratic", "-cells 6"));
  PetscCall(CheckFull("-dim 2 -formulation elastic", "-cells 6"));
  PetscCall(CheckFull("-dim 2 -formulation gas2 -basis gimp", "-cells 6"));
  PetscCall(CheckFull("-dim 3 -formulation musl -poisson 0.5", "-cells 3"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Layouts in which one particle is left: on hats usl multiplies its stress by 1 - k^2 / (xi (1 - xi)). */
static PetscErrorCode CheckOneLeft(void)
{
  const PetscReal voids = 0.95;
  MpmScene       *scene;
  MpmCriticalCase of;
  PetscInt        found = 0;

  PetscFunctionBegin;
  PetscCall(CheckScene("-formulation usl -cells 24 -ppc 1 -jitter 1 -courant 0.6", &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  for (PetscInt64 seed = 0; seed < 20; seed++) {
    MpmLayout        layout  = scene->layout;
    MpmRandomLayouts asked   = {.n = 1, .seed = seed, .voids = voids, .limits = PETSC_TRUE};
    MpmNeighbourhood layouts = {.kind = MPM_AT_RANDOM};
    PetscInt         left    = 0, cell;
    PetscReal        xi      = NAN;

    layout.seed = seed;
    for (PetscInt64 id = 0; id < layout.particles; id++) {
      if (MpmLayoutIsVoid(&layout, id, voids)) continue;
      MpmLayoutPlace(&layout, id, &cell, &xi);
      left++;
    }
    if (left != 1) continue;
    found++;
    PetscCall(MpmRandomLayoutsFind(&of, &asked, &layouts));
    CHECK_NEAR(layouts.growth, fmax(1, fabs(1 - 0.36 / (xi * (1 - xi)))), 1e-7); /* 1 is defective */
    CHECK(fabs(layouts.courant / sqrt(2 * xi * (1 - xi)) - 1) < 1e-6, "limit %.9g at %g", layouts.courant, xi);
  }
  CHECK(found > 3, "%d layouts of 20 have one particle left", (int)found);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* No layout is below the bound of MLS-MPM; gas1 grows at every Courant number; a scheme that never grows has no limit. */
static PetscErrorCode CheckLimits(void)
{
  MpmScene        *scene;
  MpmCriticalCase  of;
  MpmRandomLayouts asked   = {.n = 6, .seed = 1, .voids = 0.8, .limits = PETSC_TRUE};
  MpmNeighbourhood layouts = {.kind = MPM_AT_RANDOM};

  PetscFunctionBegin;
  PetscCall(CheckScene("-dim 2 -ppc 1 -formulation usl -transfer apic -gradient mls -basis quadratic", &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmRandomLayoutsFind(&of, &asked, &layouts));
  CHECK(layouts.courant > sqrt(0.7) * (1 - 1e-6) && layouts.courant < 1, "limit %.9g", layouts.courant);
  CHECK(layouts.unstable == 0 && layouts.undecided == 0, "%d unstable", (int)layouts.unstable);
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(CheckScene("-formulation gas1", &scene));
  of = MpmCriticalCaseOf(scene, 1e-6);
  PetscCall(MpmRandomLayoutsFind(&of, &asked, &layouts));
  CHECK(layouts.courant == 0 && layouts.unstable == 6, "gas1: limit %.9g", layouts.courant);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The worst of several; a scene with walls, drift and jitter has the neighbourhoods of its lattice at rest. */
static PetscErrorCode CheckWorst(void)
{
  const MpmNeighbourhood bulk = {.courant = 0.3, .growth = 1, .verdict = MPM_STABLE};
  MpmNeighbourhoods      all;
  MpmScene              *scene;
  MpmRequest             request = {.tolerance = 1e-6};

  PetscFunctionBegin;
  request.neighbourhood[MPM_IN_BULK] = request.neighbourhood[MPM_ALONE] = PETSC_TRUE;
  PetscCall(CheckScene("-formulation usl -basis quadratic -boundary fixed,free -spline_ends open -jitter 0.3 "
                       "-courant 0.8",
                       &scene));
  PetscCall(MpmNeighbourhoodsFind(scene, &request, &bulk, PETSC_TRUE, &all));
  CHECK(all.n == 2 && all.courant == 0.3 && all.least == 0 && all.fastest == 1, "worst limit %g", all.courant);
  CHECK(all.finding.verdict == MPM_UNSTABLE && fabs(all.finding.growth - 2.84) < 1e-8, "growth %.9g",
        all.finding.growth);
  PetscCall(MpmSceneDestroy(&scene));
  PetscCall(CheckScene("-formulation usl -counts 1,2", &scene));
  PetscCall(MpmNeighbourhoodsFind(scene, &request, &bulk, PETSC_TRUE, &all));
  CHECK(all.of[1].why_not && isnan(all.courant) && all.finding.verdict == MPM_UNDECIDED, "counts: %g", all.courant);
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(CheckNumbers());
  PetscCall(CheckAssembled());
  PetscCall(CheckNoVoids());
  PetscCall(CheckOneLeft());
  PetscCall(CheckLimits());
  PetscCall(CheckWorst());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
