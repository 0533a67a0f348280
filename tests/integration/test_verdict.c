/*
   Verdicts of runs whose stability is known: short, oscillating, emerging. A run that is too short to tell must be
   undecided, and it must never have the opposite verdict. Further cases are runs that leave the range of doubles.
*/
#include "check.h"
#include "analysis/run.h"

static PetscErrorCode RunOf(const char options[], MpmScene **scene, MpmRun **run)
{
  PetscFunctionBegin;
  PetscCall(CheckScene(options, scene));
  PetscCall(MpmRunCreate(*scene, &check_request, NULL, 0, run));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Verdict(const char options[], MpmVerdict truth, PetscBool may_be_undecided)
{
  MpmScene *scene;
  MpmRun   *run;

  PetscFunctionBegin;
  PetscCall(RunOf(options, &scene, &run));
  CHECK(run->verdict == truth || (may_be_undecided && run->verdict == MPM_UNDECIDED), "%s: %s, growth %g %s", options,
        MpmVerdictNames[run->verdict], run->growth.per_step, MpmGrowthKindNames[run->growth.kind]);
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRange(void)
{
  MpmScene *scene;
  MpmRun   *run;

  PetscFunctionBegin;
  /* rescaling follows it: 1.5625 per step leaves 1e308 after about 1600 steps */
  PetscCall(RunOf("-courant 2.05 -initial random -steps 4000", &scene, &run));
  CHECK(run->blew_up_at_step > 1500 && run->blew_up_at_step < 1700, "left at step %d", (int)run->blew_up_at_step);
  CHECK(!run->lost && run->steps == 4000, "stopped at step %d", (int)run->steps);
  CHECK_NEAR(run->growth.per_step, 1.5625, 1e-6);
  CHECK(isnan(run->energy_final) && isinf(run->energy_ratio), "energy %g", run->energy_final);
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  /* one step grows too much for any rescaling */
  PetscCall(RunOf("-courant 1e300 -initial random", &scene, &run));
  CHECK(run->lost && run->steps == 1 && run->blew_up_at_step == 1 && run->verdict == MPM_UNSTABLE, "steps %d",
        (int)run->steps);
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  /* amplitudes and units far from 1 must change nothing */
  PetscCall(RunOf("-formulation elastic -amplitude 1e-200 -wave_speed 1e7 -length 1e-50", &scene, &run));
  CHECK_NEAR(run->energy_ratio, 0.9901, 2e-4);
  CHECK(run->verdict == MPM_STABLE && run->error[0].l2 < 2e-3, "%s, error %g", MpmVerdictNames[run->verdict],
        run->error[0].l2);
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(Verdict("-formulation gas1", MPM_UNSTABLE, PETSC_FALSE));
  PetscCall(Verdict("-formulation gas1 -initial random", MPM_UNSTABLE, PETSC_FALSE));
  PetscCall(Verdict("-formulation gas1 -initial random -courant 0.02 -steps 1000", MPM_UNSTABLE, PETSC_TRUE));
  PetscCall(Verdict("-formulation gas1 -mode 2 -steps 50", MPM_UNSTABLE, PETSC_TRUE));
  PetscCall(Verdict("-formulation gas1 -courant 0.9 -steps 150", MPM_UNSTABLE, PETSC_TRUE)); /* emerging */
  PetscCall(Verdict("-initial random -courant 2.05", MPM_UNSTABLE, PETSC_FALSE));
  PetscCall(Verdict("-initial random -cells 16 -courant 0.1 -drift 1/8 -steps 400", MPM_UNSTABLE, PETSC_FALSE));
  PetscCall(Verdict("-initial random -cells 16 -courant 0.1 -drift 1/2 -steps 400", MPM_STABLE, PETSC_FALSE));
  for (int seed = 1; seed <= 20; seed++) {
    char options[128];

    PetscCall(PetscSNPrintf(options, sizeof options, "-initial random -courant %g -seed %d -steps %d", 0.09 * seed,
                            seed, 100 + 40 * (seed % 7)));
    PetscCall(Verdict(options, MPM_STABLE, PETSC_TRUE));
    PetscCall(PetscStrlcat(options, " -formulation elastic", sizeof options));
    PetscCall(Verdict(options, seed <= 15 ? MPM_STABLE : MPM_UNSTABLE, PETSC_TRUE)); /* limit 1.396 */
  }
  PetscCall(CheckRange());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
