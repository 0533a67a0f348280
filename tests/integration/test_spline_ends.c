/*
   Splines next to walls. A q = march(q) for every scheme between walls, in one, two and three dimensions, and the
   largest Courant numbers of a bar, which an independent program found from its own matrices.
*/
#include "check.h"
#include <mpmstab/critical.h>
#include <mpmstab/operator.h>
#include <slepcsys.h>

static const char *const bases[] = {"quadratic", "cubic"};

static PetscErrorCode Agrees(const char options[])
{
  MpmScene    *scene;
  MpmOperator *op;
  PetscReal    mismatch;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmOperatorCreate(PETSC_COMM_WORLD, &scene->layout, &scene->scheme, &scene->step, &op));
  PetscCall(MpmOperatorMismatch(op, &mismatch));
  CHECK(mismatch <= (MpmTableSolves(scene->scheme.table) ? 1e-12 : 1e-14), "%s: %.3g", options, mismatch);
  PetscCall(MpmOperatorDestroy(&op));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static int ranks;

/* All schemes with a layout: on one rank every basis with both kinds of ends, on more one in five of them. */
static PetscErrorCode AllAgree(const char rest[])
{
  char options[512];

  PetscFunctionBegin;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++)
      for (PetscInt b = 0; b < 4; b++) {
        const PetscBool differences = MpmFormulationHas(MpmFormulations[f], MPM_LAP), open = b % 2;
        const PetscBool gradient = MpmFormulationHas(MpmFormulations[f], MPM_GRAD);

        if (MpmTransfers[t]->affine && MpmFormulations[f]->affine == MPM_NONE) continue;
        if (strstr(rest, "free") && !MpmFormulations[f]->free_ends) continue;
        if (open && differences) continue;
        if (ranks > 1 && (f + t + b) % 5) continue;
        PetscCall(PetscSNPrintf(options, sizeof options, "-formulation %s -transfer %s -basis %s -spline_ends %s %s %s",
                                MpmFormulations[f]->name, MpmTransfers[t]->name, bases[b / 2],
                                open ? "open" : "modified", gradient && (f + t) % 2 ? "-gradient mls" : "", rest));
        PetscCall(Agrees(options));
      }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode CheckLimits(void)
{
  static const struct {
    const char *formulation, *basis, *ends;
    PetscReal   courant;
  } limits[] = {
      {"usl", "quadratic", "mirror", 1.3518},  {"usl", "quadratic", "modified", 1.0336},
      {"usl", "quadratic", "open", 0.6750},    {"usl", "cubic", "mirror", 1.4861},
      {"usl", "cubic", "modified", 1.0971},    {"usl", "cubic", "open", 0.5324},
      {"musl", "quadratic", "mirror", 2.4069}, {"musl", "quadratic", "modified", 2.1376},
      {"musl", "quadratic", "open", 1.5592},   {"musl", "cubic", "mirror", 2.7158},
      {"musl", "cubic", "modified", 2.3602},   {"musl", "cubic", "open", 1.4329},
  };
  char        options[256];
  MpmScene   *scene;
  MpmCritical c;

  PetscFunctionBegin;
  for (size_t i = 0; i < PETSC_STATIC_ARRAY_LENGTH(limits); i += (size_t)(4 * ranks - 3)) {
    MpmCriticalCase of;

    PetscCall(PetscSNPrintf(options, sizeof options,
                            "-formulation %s -transfer flip -basis %s -spline_ends %s -cells 16 -boundary fixed,free",
                            limits[i].formulation, limits[i].basis, limits[i].ends));
    PetscCall(CheckScene(options, &scene));
    of = MpmCriticalCaseOf(scene, check_request.tolerance);
    PetscCall(MpmCriticalFind(&of, PETSC_FALSE, &c));
    CHECK(fabs(c.courant - limits[i].courant) < 6e-5, "%s: %.8g", options, c.courant);
    PetscCall(MpmSceneDestroy(&scene));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(SlepcInitializeNoArguments());
  PetscCallMPI(MPI_Comm_size(PETSC_COMM_WORLD, &ranks));
  PetscCall(AllAgree("-cells 12 -boundary fixed -courant 0.4 -ppc 3 -jitter 0.6"));
  PetscCall(AllAgree("-cells 9 -boundary free,fixed -courant 0.3 -ppc 2 -offset 0"));
  PetscCall(AllAgree("-dim 2 -cells 3,9 -ppc 1,2 -boundary periodic,fixed -courant 0.2"));
  PetscCall(
      Agrees("-dim 2 -cells 9,3 -ppc 2 -boundary fixed-free,symmetry-fixed_reaction -formulation usl -courant 0.3 "
             "-basis quadratic -spline_ends open"));
  PetscCall(Agrees("-dim 3 -cells 3,3,9 -ppc 1 -offset 0.25 -boundary fixed-free,free,symmetry-fixed -formulation usl "
                   "-transfer apic -gradient mls -courant 0.3 -basis cubic -spline_ends open"));
  PetscCall(
      Agrees("-dim 3 -cells 3,9,3 -ppc 1 -offset 0.25 -boundary free,free,periodic -formulation musl -transfer apic "
             "-gradient mls -courant 0.3 -basis quadratic -spline_ends modified -material two -density_ratio 5"));
  PetscCall(CheckLimits());
  PetscCall(SlepcFinalize());
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
