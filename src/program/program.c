#include "program/program.h"

#define OF_NONZERO 12 /* bytes */

PetscErrorCode MpmStepProgramCreate(const MpmRegisters *registers, PetscReal courant, MpmStepProgram **program)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(program));
  **program = (MpmStepProgram){.registers = *registers, .courant = courant, .users = 1};
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepProgramDestroy(MpmStepProgram **program)
{
  MpmStepProgram *p = *program;

  PetscFunctionBegin;
  *program = NULL;
  if (!p || --p->users) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt l = 0; l < p->n; l++) {
    PetscCall(MatDestroy(&p->line[l].map));
    PetscCall(VecDestroy(&p->line[l].left));
    PetscCall(VecDestroy(&p->line[l].right));
    PetscCall(KSPDestroy(&p->line[l].solve));
  }
  PetscCall(PetscFree(p->line));
  PetscCall(PetscFree(p));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepProgramAppend(MpmStepProgram *p, MpmLine line)
{
  PetscFunctionBegin;
  if (p->n == p->room) {
    p->room = PetscMax(64, 2 * p->room);
    PetscCall(PetscRealloc(sizeof(*p->line) * (size_t)p->room, &p->line));
  }
  if (line.map) PetscCall(PetscObjectReference((PetscObject)line.map));
  if (line.left) PetscCall(PetscObjectReference((PetscObject)line.left));
  if (line.right) PetscCall(PetscObjectReference((PetscObject)line.right));
  if (line.solve) PetscCall(PetscObjectReference((PetscObject)line.solve));
  p->line[p->n++] = line;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmLineValue(const MpmLine *line, PetscReal courant)
{
  const MpmOp op = {.factor = line->factor, .coefficient = line->power};

  return MpmOpValue(&op, courant);
}

PetscErrorCode MpmLineRun(const MpmLine *line, const MpmAlgebra *algebra, void *registers, PetscBool back)
{
  PetscFunctionBegin;
  if (line->solve)
    PetscCall(algebra->solve(registers, line, back));
  else if (line->accumulates)
    PetscCall(algebra->add(registers, line, back));
  else if (!line->map && line->dst == line->src)
    PetscCall(algebra->scale(registers, line));
  else {
    if (!back) PetscCall(algebra->zero(registers, line->dst));
    PetscCall(algebra->add(registers, line, back));
    if (back) PetscCall(algebra->zero(registers, line->dst));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepProgramRun(const MpmStepProgram *p, const MpmAlgebra *algebra, void *registers, PetscBool back)
{
  PetscFunctionBegin;
  for (PetscInt l = 0; l < p->n; l++)
    PetscCall(MpmLineRun(&p->line[back ? p->n - 1 - l : l], algebra, registers, back));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a line before l has the same object, which then is there once. */
static PetscBool IsSeen(const MpmStepProgram *p, PetscInt l, const void *object)
{
  for (PetscInt i = 0; i < l; i++)
    if (p->line[i].map == object || p->line[i].left == object || p->line[i].right == object) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmStepProgramBytes(const MpmStepProgram *p, PetscReal *bytes)
{
  PetscFunctionBegin;
  *bytes = 0;
  for (PetscInt l = 0; l < p->n; l++) {
    const MpmLine *line    = &p->line[l];
    const Vec      side[2] = {line->left, line->right};
    MatInfo        info;

    if (line->map && !IsSeen(p, l, line->map)) {
      PetscCall(MatGetInfo(line->map, MAT_GLOBAL_SUM, &info));
      *bytes += OF_NONZERO * info.nz_used;
    }
    for (int i = 0; i < 2; i++) {
      PetscInt n;

      if (!side[i] || IsSeen(p, l, side[i])) continue;
      PetscCall(VecGetSize(side[i], &n));
      *bytes += sizeof(PetscReal) * n;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
