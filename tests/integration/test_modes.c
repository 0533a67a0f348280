/*
   Modes: the wavenumber of a mode is a phase whose symbol has its eigenvalue, its share in the null space of P2G is
   right, and an eigenvector from a file grows at its own rate when it is marched.
*/
#include "check.h"
#include "analysis/spectrum.h"
#include "task/task.h"

#define FILE_NAME "test_modes.h5"

static PetscErrorCode Solved(const char options[], MpmScene **scene, MpmSpectrum **s, MpmModes *modes)
{
  PetscFunctionBegin;
  PetscCall(CheckScene(options, scene));
  check_request.measure = PETSC_FALSE;
  PetscCall(MpmSpectrumCreate(*scene, &check_request, 0, s));
  PetscCall(MpmModesCreate((*s)->op, (*s)->eigen, (*s)->eigen->n, modes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Closed(MpmScene **scene, MpmSpectrum **s, MpmModes *modes)
{
  PetscFunctionBegin;
  PetscCall(MpmModesDestroy(modes));
  PetscCall(MpmSpectrumDestroy(s));
  PetscCall(MpmSceneDestroy(scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Checks eigenvalues that only the phases +-beta share. */
static PetscErrorCode CheckWavenumbers(const char options[], PetscInt first)
{
  MpmScene    *scene;
  MpmSpectrum *s;
  MpmModes     modes;
  PetscReal   *factors;
  PetscMPIInt  rank;

  PetscFunctionBegin;
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(Solved(options, &scene, &s, &modes));
  PetscCall(MpmSymbolGatherFactors(PETSC_COMM_WORLD, s->symbol, s->op->exponent, &factors));
  for (PetscInt j = 0; j < first && rank == 0; j++) {
    const PetscInt m       = (PetscInt)lrint(modes.beta[j] * s->symbol->phases[0] / (2 * PETSC_PI));
    PetscReal      nearest = PETSC_MAX_REAL;

    for (PetscInt i = 0; i < s->symbol->size; i++) {
      const PetscReal *f = factors + 2 * (s->symbol->size * m + i);

      nearest = PetscMin(nearest, hypot(f[0] - s->eigen->re[j], fabs(f[1]) - fabs(s->eigen->im[j])));
    }
    CHECK(nearest <= 1e-9, "%s: mode %d is not of beta %g", options, (int)j + 1, modes.beta[j]);
  }
  PetscCall(PetscFree(factors));
  PetscCall(Closed(&scene, &s, &modes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Checks null-space shares at rest. One particle a cell at the nodes has no null space, so no mode has a share. With
   two particles a cell an eigenvalue other than 1 has no part in the null space of P2G exactly when P2G G2P keeps the
   complement of the null space; random data have half of their square in it.
*/
static PetscErrorCode CheckShares(void)
{
  MpmScene    *scene;
  MpmSpectrum *s;
  MpmModes     modes;
  PetscReal    invisible = 0;

  PetscFunctionBegin;
  PetscCall(Solved("-cells 12 -ppc 1 -offset 0", &scene, &s, &modes));
  for (PetscInt j = 0; j < modes.n; j++)
    CHECK(modes.null_share[j] <= 1e-7, "mode %d: share %.3g without a null space", (int)j + 1, modes.null_share[j]);
  PetscCall(Closed(&scene, &s, &modes));
  PetscCall(Solved("-cells 16 -ppc 2 -courant 2.05", &scene, &s, &modes));
  for (PetscInt j = 0; j < modes.n; j++) {
    CHECK(modes.null_share[j] >= 0 && modes.null_share[j] <= 1 + 1e-9, "mode %d: share %.12g", (int)j + 1,
          modes.null_share[j]);
    if (modes.null_share[j] > 1 - 1e-9) invisible++;
    /* u_p += k GRAD r_i is only half in the null space, so the grid feels what changes */
    if (hypot(s->eigen->re[j] - 1, s->eigen->im[j]) > 1e-3)
      CHECK(modes.null_share[j] < 0.95, "mode %d: share %.12g", (int)j + 1, modes.null_share[j]);
  }
  CHECK(invisible >= 1, "%g modes in the null space of P2G", invisible);
  PetscCall(Closed(&scene, &s, &modes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Writes a mode by the spectrum and reads it by a run. The measured growth must be that of the mode, not the largest.
*/
static PetscErrorCode CheckGrows(const char options[], PetscInt mode)
{
  char         text[512];
  MpmScene    *scene;
  MpmSpectrum *s;
  MpmModes     modes;
  MpmRun      *run;
  PetscReal    growth;

  PetscFunctionBegin;
  PetscCall(Solved(options, &scene, &s, &modes));
  PetscCall(PetscStrncpy(check_request.output, FILE_NAME, sizeof check_request.output));
  PetscCall(MpmSpectrumWriteFiles(s));
  growth = exp(log(hypot(s->eigen->re[mode - 1], s->eigen->im[mode - 1])) / s->op->period);
  PetscCall(Closed(&scene, &s, &modes));
  PetscCall(PetscSNPrintf(text, sizeof text,
                          "%s -initial eigenmode -mode_file " FILE_NAME " -mode %" PetscInt_FMT " -steps 1200", options,
                          mode));
  PetscCall(CheckScene(text, &scene));
  PetscCall(MpmRunFilesCreate(scene, &check_request, 0, &run));
  CHECK_NEAR(run->growth.per_step, growth, 1e-4 * (growth - 1));
  CHECK_NEAR(run->eigenmode, growth, 1e-12);
  CHECK(growth > 1.001, "%s: mode %d does not grow", options, (int)mode);
  PetscCall(MpmRunDestroy(&run));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscMPIInt rank;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  PetscCallMPI(MPI_Comm_rank(PETSC_COMM_WORLD, &rank));
  PetscCall(CheckWavenumbers("-cells 16 -courant 0.1 -drift 1/8", 30));
  PetscCall(CheckWavenumbers("-formulation elastic -cells 15 -courant 1.45 -ppc 3", 6));
  PetscCall(CheckShares());
  PetscCall(CheckGrows("-cells 16 -courant 0.1 -drift 1/8", 1));
  PetscCall(CheckGrows("-cells 16 -courant 0.1 -drift 1/8", 5));
  PetscCall(CheckGrows("-cells 24 -courant 0.5 -jitter 0.4", 3));
  PetscCall(CheckGrows("-dim 2 -cells 6,8 -formulation usl -courant 0.9", 1));
  PetscCall(CheckGrows("-dim 2 -cells 19,20 -formulation usl -courant 0.9", 1)); /* of an operator without a matrix */
  PetscCall(CheckGrows("-dim 3 -cells 4,3,4 -ppc 1 -formulation usl -courant 1.1", 1));
  if (rank == 0) (void)remove(FILE_NAME);
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
