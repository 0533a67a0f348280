/*
   Schemes about a stretched state. An independent program linearised a nonlinear step by hand and against complex steps;
   its growth is compared with the symbol, the spectrum of the ring and marches from random data. The closed forms are
   compared with the symbol, and A q with march(q).
*/
#include "analysis/run.h"
#include "analysis/spectrum.h"
#include "check.h"
#include "oracle.h"
#include "symbols.h"
#include "symbol/predict.h"
#include <slepcsys.h>

#define LEAST 1.02          /* growth per step; slower rows would need long runs */
#define LEAST_ON_RANKS 1.15 /* the same, where steps wait for messages */
#define TIMES 1e90          /* by which a state grows in a run */

static PetscInt marched;

static PetscErrorCode CheckRow(const char row[], const char options[], PetscReal growth)
{
  MpmScene         *scene;
  MpmSymbol        *symbol;
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckSymbol(PETSC_COMM_WORLD, scene, 16, PETSC_FALSE, &symbol));
  /* A defective eigenvalue at 1 is split by rounding; the independent program says the same of its own numbers. */
  CHECK_NEAR(growth < 1 + 1e-7 ? PetscMax(1, symbol->growth) : symbol->growth, growth, growth < 1 + 1e-7 ? 1e-7 : 1e-8);
  if (fabs(symbol->growth - growth) > 1e-7) fprintf(stderr, "%s\n", row);
  if (growth > (size > 1 ? LEAST_ON_RANKS : LEAST) && scene->step.drift[0].value == 0) {
    MpmRun *run;

    PetscCall(MpmRunRandom(scene, (PetscInt64)ceil(log(TIMES) / log(growth)), 1e-6, &run));
    if (run->growth.measured) marched++;
    CHECK(!run->growth.measured || fabs(log(run->growth.per_step) / log(growth) - 1) <= 0.01, "%s: measured %.9g", row,
          (double)run->growth.per_step);
    PetscCall(MpmRunDestroy(&run));
  }
  PetscCall(MpmSymbolDestroy(&symbol));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The operator of a scene: A q = march(q), and its eigenvalues are those of the symbol. */
static PetscErrorCode CheckScheme(const char options[], const MpmScene *scene)
{
  MpmSpectrum *s;

  PetscFunctionBegin;
  PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &s));
  CHECK(s->step_mismatch <= 1e-14 * s->op->period, "%s: A q and march(q) differ by %.3g", options, s->step_mismatch);
  CHECK(!s->symbol || fabs(s->symbol->growth - s->growth) <= 1e-6, "%s: symbol %.12g, spectrum %.12g", options,
        s->symbol->growth, s->growth);
  PetscCall(MpmSpectrumDestroy(&s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRing(const char options[])
{
  MpmScene *scene;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(CheckScheme(options, scene));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckRings(void)
{
  static const char *const rings[] = {
      "-formulation usl -basis quadratic -prestress 0.6 -courant 0.5 -cells 12",
      "-formulation usf -basis cubic -gradient mls -transfer apic -prestress -0.7 -offset 0.3 -cells 12 -drift 1/8",
      "-formulation musl -basis gimp -prestress 0.3 -offset 0.1 -move projected -cells 9 -boundary fixed",
      "-formulation usavg -basis quadratic -transfer xpic -prestress 0.5 -offset 0.4 -cells 10 -boundary "
      "fixed_reaction",
      "-formulation musl -basis linear -material svk -stretch 0.65 -cells 8",
      "-dim 2 -formulation usf -basis quadratic -offset 0.3 -ppc 1 -transfer pic -prestress 0.3,-0.1,0.2 -cells 4,6",
      "-dim 2 -formulation musl -basis cubic -gradient mls -transfer apic -prestress 0.4,0.1 -move projected -offset "
      "0.2 "
      "-drift 0,1/2 -ppc 1 -cells 4,6",
      "-dim 2 -formulation usavg -basis gimp -offset 0.1 -ppc 2,1 -prestress 0.2,0.3 -cells 3,6 -boundary "
      "fixed,symmetry",
      "-dim 2 -formulation usl -basis quadratic -ppc 1 -offset 0.2 -poisson 0.5 -material tait -stretch 0.95 -cells "
      "4,6",
      "-dim 3 -formulation usl -basis linear -ppc 1 -prestress 0.1,0.05,-0.1,0.2,0.1,0.15 -cells 2,2,6"};

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(rings); i++) PetscCall(CheckRing(rings[i]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The pressure of an isothermal gas times its volume does not depend on the stretch. So no node feels the stress of its 14
   particles. Of their velocities the map to 7 nodes leaves out 7. Linear functions have no curvature, and then no node feels
   the places either, which are no unknowns: a velocity stays as it is, and all 28 eigenvalues are 1. With quadratic
   functions forces depend on places, by a map of rank 6: forces have no sum. Of eigenvalues at 1 there are then one more
   than unseen ones: the mean velocity.
*/
static PetscErrorCode CheckIsothermal(const char formulation[])
{
  PetscFunctionBegin;
  for (int quadratic = 0; quadratic < 2; quadratic++) {
    MpmScene    *scene;
    MpmSpectrum *s;
    char         options[160];

    (void)snprintf(options, sizeof options,
                   "-formulation %s -basis %s -material gas -stretch 0.9 -courant 0.4 -cells 7", formulation,
                   quadratic ? "quadratic" : "linear");
    PetscCall(CheckScene(options, &scene));
    PetscCall(CheckScheme(options, scene));
    PetscCall(MpmSpectrumCreate(scene, &check_request, 0, &s));
    CHECK(s->nullity == (quadratic ? 29 : 21) && s->at_one == (quadratic ? 30 : 28), "%s: %d unseen, %d at one",
          options, (int)s->nullity, (int)s->at_one);
    /* rounding splits the pair of a velocity and its places at 1, which is defective, by about 1e-8 */
    CHECK(fabs(s->growth - 1) < 1e-7 && s->symbol_mismatch < 1e-7, "%s: growth %.17g, %.3g beside the symbol's set",
          options, s->growth, s->symbol_mismatch);
    PetscCall(MpmSpectrumDestroy(&s));
    PetscCall(MpmSceneDestroy(&scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   A jittered layout is no equilibrium, so that scenes with one are refused. Its maps are those of any layout: here the scene
   is given a prestress afterwards, and A q is march(q) too.
*/
static PetscErrorCode CheckClouds(void)
{
  MpmScene  *scene;
  MpmScheme *scheme;
  MpmSpace  *space;

  PetscFunctionBegin;
  PetscCall(CheckScene(
      "-dim 2 -formulation usf -basis quadratic -gradient mls -transfer apic -jitter 0.5 -ppc 1 -cells 4,6", &scene));
  scheme = &scene->scheme;
  space  = &scheme->space;
  *space = (MpmSpace){.dim       = 2,
                      .gradient  = space->gradient,
                      .poisson   = 0.3,
                      .prestress = {0.3, 0.2, -0.1},
                      .lambda    = 0.3,
                      .mu        = 0.2,
                      .squares   = {1, 1},
                      .curved    = PETSC_TRUE,
                      .displaced = PETSC_TRUE};
  PetscCall(MpmTableDestroy(&scheme->table));
  PetscCall(MpmTableCreate(scheme->formulation, scheme->transfer, &scheme->numbers, space, &scheme->table));
  PetscCall(CheckScheme("jitter", scene));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckClosedForm(const char options[])
{
  MpmComparison comparison;
  PetscReal     growth = NAN;

  PetscFunctionBegin;
  PetscCall(CompareClosedForm(options, 24, &comparison, &growth));
  CHECK(comparison.corrected <= 5e-8, "%s: closed form off by %.3g at beta %.3g", options, comparison.corrected,
        comparison.corrected_beta[0]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckClosedForms(void)
{
  static const char *const schemes[] = {"usl",
                                        "usf",
                                        "musl",
                                        "usavg",
                                        "musl -move projected",
                                        "usavg -move projected",
                                        "verlet",
                                        "verlet -share 0.3 -move_share 1/2",
                                        "rk",
                                        "rk -move_share 0.8",
                                        "rk -rk_on nodes -rk kg5 -move_share 0.8"};
  static const char *const kinds[]   = {"-basis quadratic -offset 0.3", "-basis cubic -transfer pic -ppc 3",
                                        "-basis quadratic -transfer apic -gradient mls",
                                        "-basis gimp -offset 0.35 -transfer blend",
                                        "-basis cubic -transfer xpic -gradient mls -ppc 1 -offset 0.2"};
  static const char *const states[]  = {"-prestress 1.3", "-prestress -0.6 -courant 0.8"};
  char                     options[512];

  PetscFunctionBegin;
  for (size_t f = 0; f < PETSC_STATIC_ARRAY_LENGTH(schemes); f++)
    for (size_t k = 0; k < PETSC_STATIC_ARRAY_LENGTH(kinds); k++)
      for (size_t s = 0; s < PETSC_STATIC_ARRAY_LENGTH(states); s++) {
        PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s %s %s", schemes[f], kinds[k], states[s]));
        PetscCall(CheckClosedForm(options));
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  const PetscMPIInt size = MpmRanksOf(PETSC_COMM_WORLD);

  PetscFunctionBegin;
  PetscCheck(argc > 1, PETSC_COMM_WORLD, PETSC_ERR_USER, "prestress FILE");
  PetscCall(SlepcInitializeNoArguments());
  PetscCall(OracleGrowthNonlinear(argv[1], 43, CheckRow));
  CHECK(marched >= (size > 1 ? 3 : 10), "%d rows measured by marches", (int)marched);
  PetscCall(CheckRings());
  for (int f = 0; f < 4; f++) PetscCall(CheckIsothermal((const char *const[]){"usl", "musl", "usf", "usavg"}[f]));
  PetscCall(CheckClouds());
  if (size == 1) PetscCall(CheckClosedForms()); /* nothing in it is shared by ranks */
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
