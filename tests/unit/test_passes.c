/* Compiled passes: as few as the algorithms allow, with nothing a scene does not need. */
#include "check.h"
#include <mpmstab/passes.h>

static PetscInt CountKind(const MpmSchedule *s, MpmPassOpKind kind)
{
  PetscInt n = 0;

  for (PetscInt p = 0; p < s->npasses; p++)
    for (PetscInt o = 0; o < s->pass[p].nops; o++) n += s->pass[p].op[o].kind == kind;
  return n;
}

static PetscErrorCode Compiles(const char name[], PetscInt passes, PetscInt spares, PetscInt halo)
{
  const MpmFormulation *f = MpmFormulationFind(name);
  MpmSchedule           s;
  PetscInt              spare = 0;

  PetscFunctionBegin;
  PetscCall(MpmScheduleCompile(f, MpmBases[0], 0.5, PETSC_FALSE, PETSC_TRUE, &s));
  CHECK(s.npasses == passes, "%s at rest: %d passes", name, s.npasses);
  CHECK(s.halo == halo, "%s: halo %d", name, s.halo);
  CHECK(CountKind(&s, MPM_PASS_DRIFT) == 0 && CountKind(&s, MPM_PASS_MASS) == 0, "%s at rest moves or weighs", name);
  CHECK(s.start.sums_mass, "%s: masses are never summed", name);
  CHECK(CountKind(&s, MPM_PASS_SAMPLE) == MpmFormulationParticleFields(f), "%s: fields sampled", name);
  for (PetscInt n = 0; n < MPM_MAX_FIELDS; n++) spare += s.spare[n];
  CHECK(spare == spares, "%s: %d spare arrays", name, spare);

  PetscCall(MpmScheduleCompile(f, MpmBases[0], 0.5, PETSC_TRUE, PETSC_TRUE, &s));
  CHECK(s.npasses == passes, "%s drifting: %d passes", name, s.npasses);
  CHECK(CountKind(&s, MPM_PASS_DRIFT) == 1 && CountKind(&s, MPM_PASS_MASS) == 1, "%s drifting", name);

  PetscCall(MpmScheduleCompile(f, MpmBases[0], 0.5, PETSC_TRUE, PETSC_FALSE, &s));
  CHECK(s.npasses == passes + 1, "%s migrating in each step: %d passes", name, s.npasses);
  CHECK(s.pass[passes - 1].rebase && !s.pass[passes].rebase, "%s migrates in the wrong pass", name);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* One step bounds the state's largest number: follow the tables by hand for k = 1/2. */
static void CheckBounds(void)
{
  CHECK_NEAR(MpmScheduleBound(MpmFormulationFind("gas1"), MpmBases[0], 0.5), 2, 0);
  CHECK_NEAR(MpmScheduleBound(MpmFormulationFind("gas2"), MpmBases[0], 0.5), 3, 0);
  CHECK_NEAR(MpmScheduleBound(MpmFormulationFind("elastic"), MpmBases[0], 0.5), 3,
             0); /* w: 1 + 4k; u: 1 + k (1 + 4k) */
}

static PetscErrorCode Test(int argc, char **argv)
{
  PetscFunctionBegin;
  (void)argc;
  (void)argv;
  PetscCall(Compiles("gas1", 1, 2, 0));
  PetscCall(Compiles("gas2", 2, 0, 0));
  PetscCall(Compiles("elastic", 1, 1, 1));
  CheckBounds();
  PetscFunctionReturn(PETSC_SUCCESS);
}

CHECK_MAIN(Test)
