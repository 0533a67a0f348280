/* A tape as a sparse matrix: registers are matrices, whose rows are particles or nodes and whose columns are the state. */
#include "operator/assemble.h"
#include "operator/tape.h"

/* The rows of the identity for field f of the state. */
static PetscErrorCode Identity(const MpmTapeWork *w, PetscInt f, Mat *matrix)
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(MatCreateAIJ(w->comm, w->particles, w->nstate * w->particles, PETSC_DETERMINE, PETSC_DETERMINE, 1, NULL, 0,
                         NULL, matrix));
  PetscCall(MatGetOwnershipRange(*matrix, &begin, &end));
  for (PetscInt p = begin; p < end; p++) PetscCall(MatSetValue(*matrix, p, w->nstate * p + f, 1, INSERT_VALUES));
  PetscCall(MatAssemblyBegin(*matrix, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*matrix, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A line as matrices. NULL is a register that is 0. */
static PetscErrorCode Play(const MpmTapeLine *line, Mat reg[])
{
  Mat x, y;

  PetscFunctionBegin;
  if (line->multiplies && line->factor == 0) PetscCall(MatDestroy(&reg[line->dst]));
  if (!reg[line->src]) PetscFunctionReturn(PETSC_SUCCESS);
  if (line->multiplies) {
    if (line->left) PetscCall(MatDiagonalScale(reg[line->dst], line->left, NULL));
    PetscCall(MatScale(reg[line->dst], line->factor));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatDuplicate(reg[line->src], MAT_COPY_VALUES, &x));
  if (line->right) PetscCall(MatDiagonalScale(x, line->right, NULL));
  if (line->map) {
    PetscCall(line->to_nodes ? MatTransposeMatMult(line->map, x, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &y)
                             : MatMatMult(line->map, x, MAT_INITIAL_MATRIX, PETSC_DETERMINE, &y));
    PetscCall(MatDestroy(&x));
    x = y;
  }
  if (line->left) PetscCall(MatDiagonalScale(x, line->left, NULL));
  if (!reg[line->dst]) {
    PetscCall(MatScale(x, line->factor));
    reg[line->dst] = x;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MatAXPY(reg[line->dst], line->factor, x, DIFFERENT_NONZERO_PATTERN));
  PetscCall(MatDestroy(&x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTapeAssemble(Mat shell, Mat *matrix)
{
  MpmTape           *tape;
  const MpmTapeWork *w;
  Mat                reg[MPM_MAX_SLOTS] = {NULL}, part[MPM_MAX_SLOTS];

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &tape));
  w = tape->work;
  for (PetscInt f = 0; f < w->nstate; f++) PetscCall(Identity(w, f, &reg[w->state[f]]));
  for (PetscInt l = 0; l < tape->n; l++) PetscCall(Play(&tape->line[l], reg));
  for (PetscInt f = 0; f < w->nstate; f++) part[f] = reg[w->state[f]];
  PetscCall(MpmInterleave(w->comm, w->nstate, part, w->particles, w->nstate * w->particles, PETSC_TRUE, matrix));
  for (PetscInt s = 0; s < MPM_MAX_SLOTS; s++) PetscCall(MatDestroy(&reg[s]));
  PetscFunctionReturn(PETSC_SUCCESS);
}
