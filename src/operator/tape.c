/*
   Playing a tape. With the state in its registers, and 0 in all others,

     forwards   dst += f l * M (r * src)        dst = f l * dst
     backwards  src += f r * M^T (l * dst)      dst = f l * dst
*/
#include "operator/tape.h"
#include "operator/shell.h"

#define OF_NONZERO 12 /* bytes */

static PetscErrorCode Vector(MPI_Comm comm, PetscInt n, Vec *vector)
{
  PetscFunctionBegin;
  PetscCall(VecCreate(comm, vector));
  PetscCall(VecSetSizes(*vector, n, PETSC_DETERMINE));
  PetscCall(VecSetType(*vector, VECSTANDARD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTapeWorkCreate(MPI_Comm comm, PetscInt particles, PetscInt nodes, PetscInt nparticles,
                                 PetscInt nnodes, PetscInt nstate, const PetscInt state[], MpmTapeWork **work)
{
  MpmTapeWork *w;

  PetscFunctionBegin;
  PetscCheck(nparticles + nnodes <= MPM_MAX_SLOTS, PETSC_COMM_SELF, PETSC_ERR_PLIB, "too many registers for a tape");
  PetscCall(PetscNew(work));
  w  = *work;
  *w = (MpmTapeWork){.comm       = comm,
                     .particles  = particles,
                     .nodes      = nodes,
                     .nparticles = nparticles,
                     .nnodes     = nnodes,
                     .nstate     = nstate,
                     .users      = 1};
  PetscCall(PetscArraycpy(w->state, state, nstate));
  for (PetscInt s = 0; s < nparticles + nnodes; s++)
    PetscCall(Vector(comm, s < nparticles ? particles : nodes, &w->slot[s]));
  for (PetscInt s = 0; s < 4; s++) PetscCall(Vector(comm, s < 2 ? particles : nodes, &w->scratch[s / 2][s % 2]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTapeWorkDestroy(MpmTapeWork **work)
{
  MpmTapeWork *w = *work;

  PetscFunctionBegin;
  *work = NULL;
  if (!w || --w->users) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt s = 0; s < MPM_MAX_SLOTS; s++) PetscCall(VecDestroy(&w->slot[s]));
  for (PetscInt s = 0; s < 4; s++) PetscCall(VecDestroy(&w->scratch[s / 2][s % 2]));
  PetscCall(PetscFree(w));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTapeCreate(MpmTapeWork *work, MpmTape **tape)
{
  PetscFunctionBegin;
  PetscCall(PetscNew(tape));
  (*tape)->work = work;
  work->users++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTapeDestroy(MpmTape **tape)
{
  MpmTape *t = *tape;

  PetscFunctionBegin;
  if (!t) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt l = 0; l < t->n; l++) {
    PetscCall(MatDestroy(&t->line[l].map));
    PetscCall(VecDestroy(&t->line[l].left));
    PetscCall(VecDestroy(&t->line[l].right));
  }
  PetscCall(PetscFree(t->line));
  PetscCall(MpmTapeWorkDestroy(&t->work));
  PetscCall(PetscFree(*tape));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTapeAppend(MpmTape *t, MpmTapeLine line)
{
  PetscFunctionBegin;
  if (t->n == t->room) {
    t->room = PetscMax(64, 2 * t->room);
    PetscCall(PetscRealloc(sizeof(*t->line) * (size_t)t->room, &t->line));
  }
  if (line.map) PetscCall(PetscObjectReference((PetscObject)line.map));
  if (line.left) PetscCall(PetscObjectReference((PetscObject)line.left));
  if (line.right) PetscCall(PetscObjectReference((PetscObject)line.right));
  t->line[t->n++] = line;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- playing ---- */

static PetscErrorCode Multiply(const MpmTapeLine *line, Vec dst)
{
  PetscFunctionBegin;
  if (line->factor == 0) {
    PetscCall(VecSet(dst, 0));
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (line->left) PetscCall(VecPointwiseMult(dst, dst, line->left));
  if (line->factor != 1) PetscCall(VecScale(dst, line->factor));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the line's image of a register to the other; back: its transpose. */
static PetscErrorCode Add(MpmTapeWork *w, const MpmTapeLine *line, PetscBool back)
{
  const PetscInt from = back ? line->dst : line->src, to = back ? line->src : line->dst;
  const Vec      before = back ? line->left : line->right, after = back ? line->right : line->left;
  const int      at_from = from >= w->nparticles, at_to = to >= w->nparticles;
  Vec            in = w->slot[from];

  PetscFunctionBegin;
  if (before) {
    PetscCall(VecPointwiseMult(w->scratch[at_from][0], before, in));
    in = w->scratch[at_from][0];
  }
  if (line->map) {
    PetscCall(line->to_nodes == back ? MatMult(line->map, in, w->scratch[at_to][1])
                                     : MatMultTranspose(line->map, in, w->scratch[at_to][1]));
    in = w->scratch[at_to][1];
  }
  if (after) {
    PetscCall(VecPointwiseMult(w->scratch[at_to][1], after, in));
    in = w->scratch[at_to][1];
  }
  PetscCall(VecAXPY(w->slot[to], line->factor, in));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies a state to its registers or, with back, the registers to the state. */
static PetscErrorCode CopyState(const MpmTapeWork *w, PetscBool back, Vec state)
{
  PetscReal *x;

  PetscFunctionBegin;
  PetscCall(VecGetArray(state, &x));
  for (PetscInt f = 0; f < w->nstate; f++) {
    PetscReal *q;

    PetscCall(VecGetArray(w->slot[w->state[f]], &q));
    for (PetscInt p = 0; p < w->particles; p++)
      if (back)
        x[w->nstate * p + f] = q[p];
      else
        q[p] = x[w->nstate * p + f];
    PetscCall(VecRestoreArray(w->slot[w->state[f]], &q));
  }
  PetscCall(VecRestoreArray(state, &x));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Play(Mat matrix, PetscBool back, Vec x, Vec y)
{
  MpmTape     *t;
  MpmTapeWork *w;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &t));
  w = t->work;
  for (PetscInt s = 0; s < w->nparticles + w->nnodes; s++) PetscCall(VecSet(w->slot[s], 0));
  PetscCall(VecCopy(x, y));
  PetscCall(CopyState(w, PETSC_FALSE, y));
  for (PetscInt l = 0; l < t->n; l++) {
    const MpmTapeLine *line = &t->line[back ? t->n - 1 - l : l];

    if (line->multiplies)
      PetscCall(Multiply(line, w->slot[line->dst]));
    else
      PetscCall(Add(w, line, back));
  }
  PetscCall(CopyState(w, PETSC_TRUE, y));
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

static PetscErrorCode Destroy(Mat matrix)
{
  MpmTape *t;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(matrix, &t));
  PetscCall(MpmTapeDestroy(&t));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmTapeMatrix(MpmTape **tape, Mat *matrix)
{
  const MpmTapeWork *w     = (*tape)->work;
  const PetscInt     state = w->nstate * w->particles;

  PetscFunctionBegin;
  PetscCall(MatCreateShell(w->comm, state, state, PETSC_DETERMINE, PETSC_DETERMINE, *tape, matrix));
  *tape = NULL;
  PetscCall(MatShellSetOperation(*matrix, MATOP_MULT, (void (*)(void))Forwards));
  PetscCall(MatShellSetOperation(*matrix, MATOP_MULT_TRANSPOSE, (void (*)(void))Backwards));
  PetscCall(MatShellSetOperation(*matrix, MATOP_NORM, (void (*)(void))MpmShellNorm));
  PetscCall(MatShellSetOperation(*matrix, MATOP_DESTROY, (void (*)(void))Destroy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a line before l has the same object, which then is there once. */
static PetscBool IsSeen(const MpmTape *t, PetscInt l, const void *object)
{
  for (PetscInt i = 0; i < l; i++)
    if (t->line[i].map == object || t->line[i].left == object || t->line[i].right == object) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmTapeBytes(Mat shell, PetscReal *bytes)
{
  MpmTape *t;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &t));
  *bytes = 0;
  for (PetscInt l = 0; l < t->n; l++) {
    const MpmTapeLine *line    = &t->line[l];
    const Vec          side[2] = {line->left, line->right};
    MatInfo            info;

    if (line->map && !IsSeen(t, l, line->map)) {
      PetscCall(MatGetInfo(line->map, MAT_GLOBAL_SUM, &info));
      *bytes += OF_NONZERO * info.nz_used;
    }
    for (int i = 0; i < 2; i++) {
      PetscInt n;

      if (!side[i] || IsSeen(t, l, side[i])) continue;
      PetscCall(VecGetSize(side[i], &n));
      *bytes += sizeof(PetscReal) * n;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}
