/* Every momentum scheme, with every transfer and basis, conserves momentum to rounding; a loss is noticed. */
#include "check.h"
#include "march/diagnostics.h"

static PetscErrorCode Change(const char options[], PetscReal changes[2])
{
  MpmScene    *scene;
  MpmMarch    *march;
  MpmConserved start;

  PetscFunctionBegin;
  PetscCall(CheckScene(options, &scene));
  PetscCall(MpmMarchCreate(PETSC_COMM_WORLD, scene, &march));
  PetscCall(MpmConservedSum(march, &start));
  for (PetscInt64 step = 0; step < check_request.steps; step++) PetscCall(MpmMarchStep(march));
  PetscCall(MpmMarchRescale(march, 5));
  PetscCall(MpmConservedCheck(march, &start, changes));
  PetscCall(MpmMarchDestroy(&march));
  PetscCall(MpmSceneDestroy(&scene));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Test(int argc, char **argv)
{
  static const char *const rests[] = {"-drift 0.37 -jitter 0.9", "-boundary free -counts 1,4,0,2",
                                      "-material two -density_ratio 50 -stiffness_ratio 7 -drift -1/3 -jitter 0.3"};
  char                     options[512];
  PetscReal                changes[2];
  PetscBool                turn = PETSC_FALSE;

  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  for (PetscInt f = 0; MpmFormulations[f]; f++)
    for (PetscInt t = 0; MpmTransfers[t]; t++)
      for (PetscInt b = 0; MpmBases[b]; b++)
        for (size_t r = 0; r < PETSC_STATIC_ARRAY_LENGTH(rests); r++) {
          if (MpmFormulations[f]->conserved == MPM_NONE || (MpmBases[b]->wide && strstr(rests[r], "counts"))) continue;
          PetscCall(CheckHasTurn(f + t + b + (PetscInt)r, &turn));
          if (!turn) continue;
          PetscCall(PetscSNPrintf(options, sizeof options,
                                  "-formulation %s -transfer %s -basis %s -cells 24 -initial random -steps 50 "
                                  "-courant 0.1 %s",
                                  MpmFormulations[f]->name, MpmTransfers[t]->name, MpmBases[b]->name, rests[r]));
          PetscCall(Change(options, changes));
          CHECK(changes[0] <= 1e-13 && changes[1] <= 1e-11, "%s: mass %g, momentum %g", options, changes[0],
                changes[1]);
        }
  /* even without a wall momentum changes here: the first particle reaches a node when steps of 1/8 make up a cell */
  PetscCall(Change("-formulation usl -cells 14 -ppc 1 -fill 0,8 -drift 1/8 -initial random -steps 8", changes));
  CHECK(changes[1] > 1e-6, "force on a node without mass: momentum changes by %g", changes[1]);
  PetscCall(Change("-formulation usl -boundary fixed,free -initial random -steps 8", changes));
  CHECK(isnan(changes[1]), "a wall acts on the bar: %g", changes[1]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
