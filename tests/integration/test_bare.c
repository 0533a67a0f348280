/*
   Formulations that are not in the list. One has no closed form, exact solution or energy, and a field that no node
   feels; every task must accept it. Others have a wrong closed form, which must be found out.
*/
#include "check.h"
#include "analysis/run.h"
#include "analysis/spectrum.h"
#include "report/results.h"
#include "task/task.h"
#include <mpmstab/critical.h>
#include <slepcsys.h>

enum { V, S, D }; /* velocity, stress, and a displacement that nothing reads */
enum { V_I, A_I };

static const MpmOp ops[] = {P2G(V_I, V),          IMPOSE(V_I), MINUS_DIV(A_I, S, COURANT), REACT(A_I, V_I),
                            ADD(V_I, A_I),        IMPOSE(V_I), G2P(V, A_I, ONE),           GRAD(S, V_I, COURANT),
                            G2P(D, V_I, COURANT), DRIFT};

static const MpmFormulation bare = {.name            = "bare",
                                    .summary         = "usl with a displacement, and nothing known of it",
                                    .reference       = "none",
                                    .particle_fields = {"v", "s", "d"},
                                    .node_fields     = {"v_i", "a_i"},
                                    .nops            = PETSC_STATIC_ARRAY_LENGTH(ops),
                                    .ops             = ops,
                                    .staggered       = MPM_NONE,
                                    .affine          = MPM_NONE,
                                    .conserved       = MPM_NONE,
                                    .free_ends       = PETSC_TRUE,
                                    .materials       = PETSC_TRUE};

/* Makes a scene of usl and replaces its formulation. */
static PetscErrorCode SceneOf(const char options[], const MpmFormulation *f, MpmScene **scene)
{
  PetscFunctionBegin;
  PetscCall(CheckScene(options, scene));
  (*scene)->scheme.formulation = f;
  PetscCall(MpmTableDestroy(&(*scene)->scheme.table));
  PetscCall(MpmTableCreate(f, (*scene)->scheme.transfer, &(*scene)->scheme.numbers, &(*scene)->scheme.space,
                           &(*scene)->scheme.table));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckCritical(const char options[], PetscReal limit)
{
  MpmScene       *scene;
  MpmCriticalCase of;
  MpmCritical     c;

  PetscFunctionBegin;
  PetscCall(SceneOf(options, &bare, &scene));
  of = MpmCriticalCaseOf(scene, check_request.tolerance);
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &c));
  CHECK(isnan(c.closed), "%s: closed form %g", options, c.closed);
  CHECK(fabs(c.courant / limit - 1) <= 1e-5, "%s: %.9g, not %.9g", options, c.courant, limit);
  PetscCall(MpmCriticalReport(scene, &check_request, &c, NULL, NULL, 0));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckBare(void)
{
  MpmScene      *scene;
  MpmSpectrum   *spectrum;
  MpmRun        *run;
  PetscInt       missed = 0;
  MpmPredictions predictions;
  json_t        *result;

  PetscFunctionBegin;
  PetscCall(CheckCritical("-formulation usl -initial random", 0.755928946)); /* 1 / sqrt(1 + 4 q) with q = 3/16 */
  PetscCall(CheckCritical("-formulation usl -initial random -drift 1/8", 0.755702));
  PetscCall(CheckCritical("-formulation usl -initial random -boundary fixed,free -cells 8", 0.761155));
  PetscCall(SceneOf("-formulation usl -initial random -cells 16 -courant 0.9 -steps 400 -powers 10", &bare, &scene));
  PetscCall(MpmPredict(scene, &predictions));
  CHECK(isnan(predictions.published) && isnan(predictions.corrected), "predictions of nothing");
  PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &spectrum));
  CHECK(spectrum->finding.verdict == MPM_UNSTABLE, "spectrum: %s", MpmVerdictNames[spectrum->finding.verdict]);
  PetscCall(MpmResultOfScene(scene, &check_request, &result));
  MpmSpectrumReport(result, scene, &check_request, spectrum, NULL);
  PetscCall(MpmResultEnd(&check_request, 0, &result));
  PetscCall(MpmRunCreate(scene, &check_request, NULL, 0, &run));
  CHECK(!run->has_errors && isnan(run->energy_final), "errors, or an energy of %g", run->energy_final);
  CHECK(run->verdict == MPM_UNSTABLE && fabs(run->growth.per_step / spectrum->growth - 1) < 1e-3,
        "run: %s, growth %.9g, spectrum %.9g", MpmVerdictNames[run->verdict], run->growth.per_step, spectrum->growth);
  PetscCall(MpmTaskRun(scene, &check_request, 0, &missed));
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSpectrumDestroy(&spectrum));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* usl's own closed forms, and wrong ones: a limit that is too large or too small, an abs(G) that is slightly off. */
static PetscReal TooLarge(const MpmCellSymbols *cell)
{
  return 1.5 * MpmFormulationFind("usl")->limit(cell);
}

static PetscReal TooSmall(const MpmCellSymbols *cell)
{
  return 0.5 * MpmFormulationFind("usl")->limit(cell);
}

static PetscReal Off(const MpmCellSymbols *cell, PetscReal courant)
{
  return 0.99 * MpmFormulationFind("usl")->corrected(cell, courant);
}

static PetscErrorCode CheckLimitOf(PetscReal (*limit)(const MpmCellSymbols *), PetscBool disputed)
{
  MpmFormulation  usl = *MpmFormulationFind("usl");
  MpmScene       *scene;
  MpmCriticalCase of;
  MpmCritical     c;

  PetscFunctionBegin;
  if (limit) usl.limit = limit;
  PetscCall(SceneOf("-formulation usl -initial random", &usl, &scene));
  of = MpmCriticalCaseOf(scene, check_request.tolerance);
  PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &c));
  CHECK(c.disputed == disputed && isnan(c.courant) == disputed, "limit %g, closed form %g, %s", c.stable_at, c.closed,
        c.disputed ? "disputed" : "not disputed");
  CHECK(c.asked.verdict == (disputed ? MPM_UNDECIDED : MPM_STABLE), "%s", MpmVerdictNames[c.asked.verdict]);
  CHECK(disputed == (strstr(c.asked.evidence, "closed form") != NULL), "%s", c.asked.evidence);
  PetscCall(MpmCriticalReport(scene, &check_request, &c, NULL, NULL, 0));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckCorrectedOf(PetscReal (*corrected)(const MpmCellSymbols *, PetscReal), MpmVerdict verdict)
{
  MpmFormulation usl = *MpmFormulationFind("usl");
  MpmScene      *scene;
  MpmSpectrum   *spectrum;

  PetscFunctionBegin;
  if (corrected) usl.corrected = corrected;
  PetscCall(SceneOf("-formulation usl -initial random -cells 8", &usl, &scene));
  PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &spectrum));
  CHECK(spectrum->finding.verdict == verdict, "%s, %s", MpmVerdictNames[spectrum->finding.verdict],
        spectrum->finding.evidence);
  PetscCall(MpmSpectrumDestroy(&spectrum));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCheck(freopen("/dev/null", "w", stdout), PETSC_COMM_SELF, PETSC_ERR_FILE_OPEN, "/dev/null");
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(CheckBare());
  PetscCall(CheckLimitOf(NULL, PETSC_FALSE));
  PetscCall(CheckLimitOf(TooLarge, PETSC_TRUE));
  PetscCall(CheckLimitOf(TooSmall, PETSC_TRUE));
  PetscCall(CheckCorrectedOf(NULL, MPM_STABLE));
  PetscCall(CheckCorrectedOf(Off, MPM_UNDECIDED));
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
