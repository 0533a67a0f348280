#include "program/steps_matrix.h"

PetscErrorCode MpmMatricesOfSlab(const MpmSlab *slab, PetscInt degree, MpmMatrices *m)
{
  MpmRegisters registers;

  PetscFunctionBegin;
  PetscCall(MpmRegistersOf(slab, &registers));
  PetscCall(MpmMatricesCreate(&registers, slab->step.courant, degree, m));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatricesStep(MpmMatrices *m, const MpmSlab *slab, PetscInt64 step)
{
  MpmMaps         maps = {.slab = slab, .step = step};
  MpmStepProgram *program;

  PetscFunctionBegin;
  PetscCall(MpmStepProgramCreate(&m->registers, slab->step.courant, &program));
  PetscCall(MpmStepProgramAppendStep(program, &maps, PETSC_TRUE));
  PetscCall(MpmMatricesRun(m, program, step));
  PetscCall(MpmStepProgramDestroy(&program));
  PetscCall(MpmMapsDestroy(&maps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepsMatrix(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                              PetscInt first, PetscInt steps, Mat *matrix)
{
  MpmRegisters    registers;
  MpmStepProgram *program;
  MpmSlab         slab;

  PetscFunctionBegin;
  PetscCall(MpmSlabOf(comm, layout, scheme, step, &slab));
  PetscCall(MpmRegistersOf(&slab, &registers));
  PetscCall(MpmStepProgramCreate(&registers, step->courant, &program));
  for (PetscInt k = 0; k < steps; k++) {
    MpmMaps   maps = {.slab = &slab, .step = first + k};
    PetscReal numbers;

    PetscCall(MpmStepProgramAppendStep(program, &maps, k > 0 ? PETSC_TRUE : PETSC_FALSE));
    PetscCall(MpmMapsCount(&maps, &numbers));
    program->nonzeros += numbers;
    PetscCall(MpmMapsDestroy(&maps));
  }
  PetscCall(MpmStepProgramMatrix(program, NULL, matrix));
  PetscCall(MpmStepProgramDestroy(&program));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmStepsNonzeros(const MpmLayout *layout, const MpmScheme *scheme)
{
  const MpmTable *table                        = scheme->table;
  PetscBool       seen[MPM_OP_KINDS][MPM_AXES] = {{PETSC_FALSE}};
  PetscReal       nodes = 1, maps = 0;

  for (PetscInt o = 0; o < table->nops; o++) {
    const MpmOpTraits traits = MpmOpTraitsOf(table->ops[o].kind);

    if (traits.dst == traits.src || seen[table->ops[o].kind][table->ops[o].axis]) continue;
    seen[table->ops[o].kind][table->ops[o].axis] = PETSC_TRUE;
    maps += MpmLayoutIsPeriodic(layout) ? 1 : 1 + layout->dim;
  }
  for (PetscInt a = 0; a < layout->dim; a++) nodes *= (PetscReal)MpmMapReach(scheme->basis);
  return maps * nodes * (PetscReal)layout->particles;
}
