/*
   Ensembles: Wilson's interval by hand, one layout against the task spectrum, an earlier count of unstable bars,
   undecided layouts, and the totals against the layouts' own numbers.
*/
#include "check.h"
#include "analysis/ensemble.h"
#include "analysis/spectrum.h"

static PetscErrorCode EnsembleOf(const char options[], MpmScene **scene, MpmEnsemble **e)
{
  PetscFunctionBegin;
  PetscCall(CheckSceneOf("ensemble", options, scene));
  PetscCall(MpmEnsembleCreate(*scene, &check_request, e));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Close(MpmScene **scene, MpmEnsemble **e)
{
  PetscFunctionBegin;
  PetscCall(MpmEnsembleDestroy(e));
  PetscCall(MpmSceneDestroy(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks against numbers by hand, with z = 1.96. The interval of 0 of n ends at z^2 / (n + z^2); that of n - x of n
   mirrors that of x of n.
*/
static void CheckWilson(void)
{
  static const struct {
    PetscInt  hits, trials;
    PetscReal lo, hi;
  } known[] = {{0, 10, 0, 0.2775},       {5, 10, 0.2366, 0.7634},  {10, 10, 0.7225, 1},
               {11, 40, 0.1611, 0.4283}, {29, 40, 0.5717, 0.8389}, {0, 1000000, 0, 3.8415e-6}};
  PetscReal interval[2];

  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(known); i++) {
    MpmWilson(known[i].hits, known[i].trials, interval);
    CHECK_NEAR(interval[0], known[i].lo, known[i].trials > 100 ? 1e-10 : 5e-5);
    CHECK_NEAR(interval[1], known[i].hi, known[i].trials > 100 ? 1e-10 : 5e-5);
  }
}

/*
   Compares one layout with the task spectrum for its seed. A layout that does not grow has a defective 1, which
   rounding splits.
*/
static PetscErrorCode CheckOne(const char options[], MpmVerdict verdict)
{
  char         alone[256];
  MpmScene    *scene, *same;
  MpmEnsemble *e;
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(alone, sizeof alone, "%s -layouts 1", options));
  PetscCall(EnsembleOf(alone, &scene, &e));
  PetscCall(CheckScene(options, &same));
  check_request.measure = PETSC_FALSE;
  PetscCall(MpmSpectrumCreate(same, &check_request, 0, &s));
  if (verdict != MPM_UNDECIDED) /* a verdict that rounding decides differs on more ranks */
    CHECK_NEAR(e->growth_max, s->growth, s->growth > 1 + 1e-6 ? 1e-10 : 1e-7);
  CHECK(e->finding.verdict == verdict && s->finding.verdict == verdict, "%s: %s, spectrum %s", options,
        MpmVerdictNames[e->finding.verdict], MpmVerdictNames[s->finding.verdict]);
  CHECK(e->growth_min == e->growth_max && e->growth_median == e->growth_max && e->worst_seed == scene->layout.seed,
        "%s: one layout is its own smallest and largest", options);
  if (verdict == MPM_UNSTABLE) /* the solvers' residuals are rounding, and differ from solver to solver */
    CHECK(fabs(log(e->finding.uncertainty / s->finding.uncertainty)) < log(4), "%s: uncertainty %.3g, spectrum %.3g",
          options, e->finding.uncertainty, s->finding.uncertainty);
  PetscCall(MpmSpectrumDestroy(&s));
  PetscCall(MpmSceneDestroy(&same));
  PetscCall(Close(&scene, &e));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Of 40 bars 11 grow, as was counted before this task existed. The totals follow from the layouts' numbers. */
static PetscErrorCode CheckCount(void)
{
  MpmScene    *scene;
  MpmEnsemble *e;
  PetscInt     unstable = 0, below = 0, above = 0;

  PetscFunctionBegin;
  PetscCall(EnsembleOf("-formulation elastic -jitter 0.4 -courant 1 -layouts 40", &scene, &e));
  for (PetscInt i = 0; i < 40; i++) {
    unstable += e->growth[i] > 1 + 1e-6;
    below += e->growth[i] < e->growth_median;
    above += e->growth[i] > e->growth_median;
    CHECK(e->verdict[i] == (e->growth[i] > 1 + 1e-6 ? MPM_UNSTABLE : MPM_STABLE), "seed %d: %s", (int)i + 1,
          MpmVerdictNames[e->verdict[i]]);
    CHECK(e->growth[i] >= e->growth_min && e->growth[i] <= e->growth_max, "seed %d: %.17g", (int)i + 1, e->growth[i]);
  }
  CHECK(unstable == 11 && e->unstable == 11 && e->undecided == 0, "%d and %d unstable", (int)unstable,
        (int)e->unstable);
  CHECK(below <= 20 && above <= 20, "%d below the median, %d above", (int)below, (int)above); /* many are 1 */
  CHECK(e->growth[e->worst_seed - 1] == e->growth_max, "worst seed %d", (int)e->worst_seed);
  CHECK_NEAR(e->share, 0.275, 1e-15);
  CHECK_NEAR(e->interval[0], 0.1611, 5e-5);
  CHECK(e->finding.verdict == MPM_UNSTABLE && e->finding.growth == e->growth_max, "%.17g", e->finding.growth);
  PetscCall(Close(&scene, &e));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckVerdicts(void)
{
  MpmScene    *scene;
  MpmEnsemble *e;

  PetscFunctionBegin;
  PetscCall(EnsembleOf("-formulation musl -basis quadratic -cells 16 -jitter 0.4 -layouts 10", &scene, &e));
  CHECK(e->finding.verdict == MPM_STABLE && e->share == 0 && e->interval[0] == 0, "%d unstable", (int)e->unstable);
  CHECK_NEAR(e->interval[1], 0.2775, 5e-5);
  PetscCall(Close(&scene, &e));
  /* digits are lost within the period: no layout is known to be unstable, and all of them may be */
  PetscCall(
      EnsembleOf("-formulation elastic -cells 4 -ppc 1 -courant 1.2 -drift 1/300 -jitter 0.1 -layouts 2", &scene, &e));
  CHECK(e->finding.verdict == MPM_UNDECIDED && e->undecided == 2 && e->share == 0, "%d unstable, %d undecided",
        (int)e->unstable, (int)e->undecided);
  CHECK(e->interval[0] == 0 && e->interval[1] == 1, "[%g, %g]", e->interval[0], e->interval[1]);
  PetscCall(Close(&scene, &e));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  CheckWilson();
  PetscCall(CheckOne("-formulation elastic -jitter 0.4 -courant 1 -seed 3", MPM_UNSTABLE));
  PetscCall(CheckOne("-formulation elastic -jitter 0.4 -courant 1 -seed 2", MPM_STABLE));
  PetscCall(CheckOne("-cells 16 -jitter 0.4 -drift 1/8 -seed 11", MPM_UNSTABLE));
  PetscCall(CheckOne("-formulation usl -cells 16 -boundary fixed,free -jitter 0.4 -courant 1.2", MPM_UNSTABLE));
  PetscCall(CheckOne("-formulation elastic -cells 6 -ppc 1 -courant 1.2 -drift 1/300 -jitter 0.1", MPM_UNDECIDED));
  PetscCall(CheckOne("-dim 2 -formulation usl -cells 3 -jitter 0.8 -courant 0.9", MPM_UNSTABLE));
  PetscCall(CheckOne("-dim 2 -formulation usl -cells 3 -jitter 0.8 -courant 0.4 -boundary fixed,symmetry", MPM_STABLE));
  PetscCall(CheckCount());
  PetscCall(CheckVerdicts());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
