/* Programs, the interpreter, and registers as vectors. */
#include "base/hash.h"
#include "program/program.h"
#include "linalg/singular.h"

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
  for (PetscInt l = 0; l < p->n; l++) PetscCall(MpmLineRelease(&p->line[l]));
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
  if (line->nsolve)
    PetscCall(algebra->solve(registers, line, back));
  else if (line->accumulates)
    PetscCall(algebra->add(registers, line, back));
  else if (!line->map && !line->op && line->dst == line->src)
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

/*
   ---- registers as vectors ----

   The product of a program with what it takes, without a matrix. A sparse matrix of a map is small: a particle has
   weights at the nodes around it alone. The matrix of a step couples every particle to all those that share a node with
   it, and in three dimensions it would be hundreds of times larger.
*/

PetscErrorCode MpmRegisterVector(const MpmRegisters *r, PetscInt place, Vec *vector)
{
  PetscFunctionBegin;
  PetscCall(VecCreate(r->comm, vector));
  PetscCall(VecSetSizes(*vector, r->rows[place], PETSC_DETERMINE));
  PetscCall(VecSetType(*vector, VECSTANDARD));
  PetscCall(VecSet(*vector, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmVectorsCreate(const MpmRegisters *r, MpmVectors **vectors)
{
  MpmVectors *v;

  PetscFunctionBegin;
  PetscCall(PetscNew(vectors));
  v  = *vectors;
  *v = (MpmVectors){.registers = *r, .users = 1};
  PetscCall(PetscCalloc1(r->n[0] + r->n[1], &v->slot));
  for (PetscInt s = 0; s < 4; s++) PetscCall(MpmRegisterVector(r, s / 2, &v->scratch[s / 2][s % 2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmVectorsDestroy(MpmVectors **vectors)
{
  MpmVectors *v = *vectors;

  PetscFunctionBegin;
  *vectors = NULL;
  if (!v || --v->users) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt s = 0; s < v->registers.n[0] + v->registers.n[1]; s++) PetscCall(VecDestroy(&v->slot[s]));
  for (PetscInt s = 0; s < 4; s++) PetscCall(VecDestroy(&v->scratch[s / 2][s % 2]));
  PetscCall(PetscFree(v->slot));
  PetscCall(PetscFree(v));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- the algebra ---- */

static PetscErrorCode Zero(void *registers, PetscInt dst)
{
  const MpmVectors *v = registers;

  PetscFunctionBegin;
  if (v->slot[dst]) PetscCall(VecSet(v->slot[dst], 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Scale(void *registers, const MpmLine *line)
{
  const MpmVectors *v     = registers;
  const PetscReal   value = MpmLineValue(line, v->courant);
  const Vec         dst   = v->slot[line->dst];

  PetscFunctionBegin;
  if (!dst) PetscFunctionReturn(PETSC_SUCCESS);
  if (line->left && value != 0) PetscCall(VecPointwiseMult(dst, dst, line->left));
  if (value != 1) PetscCall(VecScale(dst, value)); /* by 0: sets it, whatever it holds */
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Add(void *registers, const MpmLine *line, PetscBool back)
{
  MpmVectors     *v    = registers;
  const PetscInt  from = back ? line->dst : line->src, to = back ? line->src : line->dst;
  const PetscInt  at_from = MpmRegisterPlace(&v->registers, from), at_to = MpmRegisterPlace(&v->registers, to);
  const Vec       before = back ? line->left : line->right, after = back ? line->right : line->left;
  const PetscReal value = MpmLineValue(line, v->courant);
  Vec             x     = v->slot[from];

  PetscFunctionBegin;
  if (!x) PetscFunctionReturn(PETSC_SUCCESS);
  if (!v->slot[to]) PetscCall(MpmRegisterVector(&v->registers, at_to, &v->slot[to]));
  if (before) {
    PetscCall(VecPointwiseMult(v->scratch[at_from][0], before, x));
    x = v->scratch[at_from][0];
  }
  if (line->map) {
    PetscCall(line->transposed == back ? MatMult(line->map, x, v->scratch[at_to][1])
                                       : MatMultTranspose(line->map, x, v->scratch[at_to][1]));
    x = v->scratch[at_to][1];
  }
  if (after) {
    PetscCall(VecPointwiseMult(v->scratch[at_to][1], after, x));
    x = v->scratch[at_to][1];
  }
  PetscCall(x == v->slot[to] ? VecScale(x, 1 + value) : VecAXPY(v->slot[to], value, x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies the numbers of one vector to registers or, with back, the registers to the vector. */
static PetscErrorCode Copy(MpmVectors *v, PetscInt n, const PetscInt reg[], PetscBool back, Vec together)
{
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(VecGetArray(together, &x));
  for (PetscInt f = 0; f < n; f++) {
    const PetscInt place = MpmRegisterPlace(&v->registers, reg[f]);
    PetscReal     *q;

    if (!v->slot[reg[f]]) PetscCall(MpmRegisterVector(&v->registers, place, &v->slot[reg[f]]));
    PetscCall(VecGetArray(v->slot[reg[f]], &q));
    for (PetscInt p = 0; p < v->registers.rows[place]; p++)
      if (back)
        x[n * p + f] = q[p];
      else
        q[p] = x[n * p + f];
    PetscCall(VecRestoreArray(v->slot[reg[f]], &q));
  }
  PetscCall(VecRestoreArray(together, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Solve(void *registers, const MpmLine *line, PetscBool back)
{
  MpmVectors *v = registers;
  PetscInt    reg[MPM_MAX_DIM];
  Vec         together, solution;
  Mat         matrix;

  PetscFunctionBegin;
  for (PetscInt c = 0; c < line->nsolve; c++) reg[c] = line->dst + c;
  PetscCall(KSPGetOperators(line->solve, &matrix, NULL));
  PetscCall(MatCreateVecs(matrix, &together, &solution));
  PetscCall(Copy(v, line->nsolve, reg, PETSC_TRUE, together));
  PetscCall(back ? KSPSolveTranspose(line->solve, together, solution) : KSPSolve(line->solve, together, solution));
  PetscCall(Copy(v, line->nsolve, reg, PETSC_FALSE, solution));
  PetscCall(VecDestroy(&together));
  PetscCall(VecDestroy(&solution));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const MpmAlgebra MpmVectorAlgebra = {.zero = Zero, .scale = Scale, .add = Add, .solve = Solve};

/* ---- the matrix ---- */

typedef struct {
  MpmStepProgram *program;
  MpmVectors     *vectors;
} Context;

static PetscErrorCode Play(Mat matrix, PetscBool back, Vec x, Vec y)
{
  const MpmRegisters *r;
  Context            *c;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &c));
  r                   = &c->program->registers;
  c->vectors->courant = c->program->courant;
  for (PetscInt s = 0; s < r->n[0] + r->n[1]; s++) PetscCall(Zero(c->vectors, s));
  PetscCall(Copy(c->vectors, back ? r->nout : r->nin, back ? r->out : r->in, PETSC_FALSE, x));
  PetscCall(MpmStepProgramRun(c->program, &MpmVectorAlgebra, c->vectors, back));
  PetscCall(Copy(c->vectors, back ? r->nin : r->nout, back ? r->in : r->out, PETSC_TRUE, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Forwards(Mat matrix, Vec x, Vec y)
{
  PetscFunctionBegin;
  PetscCall(Play(matrix, PETSC_FALSE, x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Backwards(Mat matrix, Vec x, Vec y)
{
  PetscFunctionBegin;
  PetscCall(Play(matrix, PETSC_TRUE, x, y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says how many numbers the maps have; nothing else is known. */
static PetscErrorCode GetInfo(Mat matrix, MatInfoType type, MatInfo *info)
{
  Context *c;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &c));
  PetscCheck(type == MAT_GLOBAL_SUM && c->program->nonzeros > 0, PETSC_COMM_SELF, PETSC_ERR_SUP,
             "of an operator without a matrix, no such counts");
  *info = (MatInfo){.nz_used = c->program->nonzeros};
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Mat matrix)
{
  Context *c;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &c));
  PetscCall(MpmStepProgramDestroy(&c->program));
  PetscCall(MpmVectorsDestroy(&c->vectors));
  PetscCall(PetscFree(c));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepProgramMatrix(MpmStepProgram *program, MpmVectors *vectors, Mat *matrix)
{
  const MpmRegisters *r       = &program->registers;
  const PetscInt      rows    = r->nout * r->rows[MpmRegisterPlace(r, r->out[0])];
  const PetscInt      columns = r->nin * r->rows[MpmRegisterPlace(r, r->in[0])];
  Context            *c;

  PetscFunctionBegin;
  PetscCall(PetscNew(&c));
  c->program = program;
  c->vectors = vectors;
  program->users++;
  if (vectors)
    vectors->users++;
  else
    PetscCall(MpmVectorsCreate(r, &c->vectors));
  PetscCall(MatCreateShell(r->comm, rows, columns, PETSC_DETERMINE, PETSC_DETERMINE, c, matrix));
  PetscCall(MatShellSetOperation(*matrix, MATOP_MULT, (void (*)(void))Forwards));
  PetscCall(MatShellSetOperation(*matrix, MATOP_MULT_TRANSPOSE, (void (*)(void))Backwards));
  PetscCall(MatShellSetOperation(*matrix, MATOP_NORM, (void (*)(void))MpmNormBelow));
  PetscCall(MatShellSetOperation(*matrix, MATOP_GETINFO, (void (*)(void))GetInfo));
  PetscCall(MatShellSetOperation(*matrix, MATOP_DESTROY, (void (*)(void))Destroy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatrixProgram(Mat matrix, const MpmStepProgram **program)
{
  Context *c;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &c));
  *program = c->program;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmMatrixCopy(Mat matrix, Mat *copy)
{
  Context *c;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &c));
  PetscCall(MpmStepProgramMatrix(c->program, c->vectors, copy));
  PetscFunctionReturn(PETSC_SUCCESS);
}
