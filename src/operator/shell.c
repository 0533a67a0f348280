/*
   The operator without its matrix. The product A x takes the operations of the table one after the other, and A^T y
   takes their transposes in the opposite order: where an operation makes dst = a M src, its transpose adds a M^T dst to
   src and sets dst to 0.

   A sparse matrix of the maps is small: a particle has weights at the nodes around it alone. The matrix of a step
   couples every particle to all those that share a node with it, and in three dimensions it would be hundreds of times
   larger.
*/
#include "base/hash.h"
#include "operator/shell.h"
#include <math.h>

#define NORM_VECTORS 4

/*
   work: for the results of maps, on particles and on nodes. shells: how many matrices hold this. nonzeros: of all maps,
   on all ranks.
*/
typedef struct {
  MpmRegisters sizes;
  PetscInt     first, steps, shells;
  MpmStepMaps *maps;
  PetscReal    nonzeros;
  Vec          particle[MPM_MAX_FIELDS], node[MPM_MAX_FIELDS], work[2];
} Shell;

static PetscErrorCode SetWall(const Shell *s, const MpmOp *op, PetscReal a, PetscBool transpose)
{
  const MpmRegisters *r    = &s->sizes;
  const PetscInt      wall = op->side ? r->layout->grid[op->axis].nodes - 1 : 0;
  PetscReal          *dst, *src;

  PetscFunctionBegin;
  PetscCall(VecGetArray(s->node[op->dst], &dst));
  src = dst;
  if (op->src != op->dst) PetscCall(VecGetArray(s->node[op->src], &src));
  for (PetscInt i = 0; i < r->nodes; i++) {
    PetscInt        stride;
    const PetscReal d = dst[i];

    if (MpmNodeAlong(r->layout, r->node0 + i, op->axis, &stride) != wall) continue;
    if (transpose) {
      dst[i] = 0;
      src[i] += a * d;
    } else
      dst[i] = a * src[i];
  }
  if (op->src != op->dst) PetscCall(VecRestoreArray(s->node[op->src], &src));
  PetscCall(VecRestoreArray(s->node[op->dst], &dst));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Applies an operation of step k of the shell to the registers, or its transpose. */
static PetscErrorCode ApplyOp(Shell *s, const MpmOp *op, PetscInt k, PetscBool transpose)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscBool   to     = traits.dst == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE,
                  from     = traits.src == MPM_ON_NODES ? PETSC_TRUE : PETSC_FALSE;
  const PetscReal a        = MpmOpValue(op, s->sizes.step.courant);
  Vec             dst, src;
  Mat             map;

  PetscFunctionBegin;
  if (traits.dst == MPM_NOWHERE) PetscFunctionReturn(PETSC_SUCCESS);
  dst = to ? s->node[op->dst] : s->particle[op->dst];
  src = from ? s->node[op->src] : s->particle[op->src];
  if (op->kind == MPM_WALL)
    PetscCall(SetWall(s, op, a, transpose));
  else if (op->kind == MPM_SCALE)
    PetscCall(VecScale(dst, a));
  else if (op->kind == MPM_ADD && op->dst == op->src)
    PetscCall(VecScale(dst, 1 + a));
  else if (op->kind == MPM_ADD)
    PetscCall(transpose ? VecAXPY(src, a, dst) : VecAXPY(dst, a, src));
  else {
    PetscCall(MpmStepMapsGet(&s->maps[k], &s->sizes, op, s->first + k, &map));
    if (transpose) {
      PetscCall(MatMultTranspose(map, dst, s->work[from]));
      if (!op->accumulates) PetscCall(VecSet(dst, 0));
      PetscCall(VecAXPY(src, a, s->work[from]));
    } else {
      PetscCall(MatMult(map, src, s->work[to]));
      PetscCall(VecAXPBY(dst, a, op->accumulates ? 1 : 0, s->work[to]));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Copies a state to its registers or, with back, the registers to the state. */
static PetscErrorCode CopyState(const Shell *s, PetscBool back, PetscReal state[])
{
  const PetscInt fields = s->sizes.fields;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < fields; f++) {
    PetscReal *q;

    PetscCall(VecGetArray(s->particle[f], &q));
    for (PetscInt p = 0; p < s->sizes.particles; p++)
      if (back)
        state[fields * p + f] = q[p];
      else
        q[p] = state[fields * p + f];
    PetscCall(VecRestoreArray(s->particle[f], &q));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Product(Mat shell, Vec x, Vec y, PetscBool transpose)
{
  const MpmTable *table;
  Shell          *s;
  PetscReal      *state;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &s));
  table = s->sizes.scheme->table;
  PetscCall(VecCopy(x, y));
  PetscCall(VecGetArray(y, &state));
  PetscCall(CopyState(s, PETSC_FALSE, state));
  for (PetscInt k = 0; k < s->steps; k++) {
    const PetscInt step = transpose ? s->steps - 1 - k : k;

    for (PetscInt f = table->nstate; f < table->nparticles; f++) PetscCall(VecSet(s->particle[f], 0));
    for (PetscInt n = 0; n < table->nnodes; n++) PetscCall(VecSet(s->node[n], 0));
    for (PetscInt o = 0; o < table->nops; o++)
      PetscCall(ApplyOp(s, &table->ops[transpose ? table->nops - 1 - o : o], step, transpose));
  }
  PetscCall(CopyState(s, PETSC_TRUE, state));
  PetscCall(VecRestoreArray(y, &state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Multiply(Mat shell, Vec x, Vec y)
{
  PetscFunctionBegin;
  PetscCall(Product(shell, x, y, PETSC_FALSE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode MultiplyTranspose(Mat shell, Vec x, Vec y)
{
  PetscFunctionBegin;
  PetscCall(Product(shell, x, y, PETSC_TRUE));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmShellNorm(Mat shell, NormType type, PetscReal *norm)
{
  Vec x, y;

  PetscFunctionBegin;
  PetscCheck(type == NORM_INFINITY, PETSC_COMM_SELF, PETSC_ERR_SUP, "of an operator without a matrix, no such norm");
  PetscCall(MatCreateVecs(shell, &x, &y));
  *norm = 0;
  for (PetscInt v = 0; v < NORM_VECTORS; v++) {
    PetscInt   begin, end;
    PetscReal *sign, largest;

    PetscCall(VecGetOwnershipRange(x, &begin, &end));
    PetscCall(VecGetArrayWrite(x, &sign));
    for (PetscInt i = begin; i < end; i++) sign[i - begin] = MpmHash(v, i) < 0.5 ? -1 : 1;
    PetscCall(VecRestoreArrayWrite(x, &sign));
    PetscCall(MatMult(shell, x, y));
    PetscCall(VecNorm(y, NORM_INFINITY, &largest));
    if (!(largest <= *norm)) *norm = largest; /* NaN is the largest */
  }
  PetscCall(VecDestroy(&x));
  PetscCall(VecDestroy(&y));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Says how many numbers the maps have; nothing else is known. */
static PetscErrorCode GetInfo(Mat shell, MatInfoType type, MatInfo *info)
{
  Shell *s;

  PetscFunctionBegin;
  PetscCheck(type == MAT_GLOBAL_SUM, PETSC_COMM_SELF, PETSC_ERR_SUP, "of an operator without a matrix, no such counts");
  PetscCall(MatShellGetContext(shell, &s));
  *info = (MatInfo){.nz_used = s->nonzeros};
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Destroy(Mat shell)
{
  Shell *s;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &s));
  if (--s->shells) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt k = 0; k < s->steps; k++) PetscCall(MpmStepMapsDestroy(&s->maps[k]));
  for (PetscInt f = 0; f < MPM_MAX_FIELDS; f++) {
    PetscCall(VecDestroy(&s->particle[f]));
    PetscCall(VecDestroy(&s->node[f]));
  }
  PetscCall(VecDestroy(&s->work[0]));
  PetscCall(VecDestroy(&s->work[1]));
  PetscCall(MpmRegistersDestroy(&s->sizes));
  PetscCall(PetscFree(s->maps));
  PetscCall(PetscFree(s));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A matrix for what a shell holds. */
static PetscErrorCode Wrap(Shell *s, Mat *shell)
{
  PetscFunctionBegin;
  PetscCall(MatCreateShell(s->sizes.comm, s->sizes.state, s->sizes.state, PETSC_DETERMINE, PETSC_DETERMINE, s, shell));
  PetscCall(MatShellSetOperation(*shell, MATOP_MULT, (void (*)(void))Multiply));
  PetscCall(MatShellSetOperation(*shell, MATOP_MULT_TRANSPOSE, (void (*)(void))MultiplyTranspose));
  PetscCall(MatShellSetOperation(*shell, MATOP_NORM, (void (*)(void))MpmShellNorm));
  PetscCall(MatShellSetOperation(*shell, MATOP_GETINFO, (void (*)(void))GetInfo));
  PetscCall(MatShellSetOperation(*shell, MATOP_DESTROY, (void (*)(void))Destroy));
  s->shells++;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmShellCopy(Mat shell, Mat *copy)
{
  Shell *s;

  PetscFunctionBegin;
  PetscCall(MatShellGetContext(shell, &s));
  PetscCall(Wrap(s, copy));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Makes the maps of all steps, and counts their numbers. */
static PetscErrorCode MakeMaps(Shell *s)
{
  const MpmTable *table = s->sizes.scheme->table;

  PetscFunctionBegin;
  for (PetscInt k = 0; k < s->steps; k++) {
    for (PetscInt o = 0; o < table->nops; o++) {
      const MpmOp      *op     = &table->ops[o];
      const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
      Mat               map;

      if (traits.dst == MPM_NOWHERE || op->kind == MPM_WALL) continue;
      if (traits.dst == MPM_ON_PARTICLES && traits.src == MPM_ON_PARTICLES) continue;
      PetscCall(MpmStepMapsGet(&s->maps[k], &s->sizes, op, s->first + k, &map));
    }
    for (PetscInt m = 0; m < MPM_OP_KINDS * MPM_MAX_DIM * MPM_PARITIES; m++) {
      const Mat map = (&s->maps[k].map[0][0][0])[m];
      MatInfo   info;

      if (!map) continue;
      PetscCall(MatGetInfo(map, MAT_GLOBAL_SUM, &info));
      s->nonzeros += info.nz_used;
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Vector(const MpmRegisters *r, PetscInt n, Vec *vector)
{
  PetscFunctionBegin;
  PetscCall(VecCreate(r->comm, vector));
  PetscCall(VecSetSizes(*vector, n, PETSC_DETERMINE));
  PetscCall(VecSetType(*vector, VECSTANDARD));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmShellCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                              PetscInt first, PetscInt steps, Mat *shell)
{
  Shell *s;

  PetscFunctionBegin;
  PetscCall(PetscNew(&s));
  s->first = first;
  s->steps = steps;
  PetscCall(MpmRegistersSizes(comm, layout, scheme, step, &s->sizes));
  PetscCall(PetscCalloc1(steps, &s->maps));
  for (PetscInt f = 0; f < scheme->table->nparticles; f++)
    PetscCall(Vector(&s->sizes, s->sizes.particles, &s->particle[f]));
  for (PetscInt n = 0; n < scheme->table->nnodes; n++) PetscCall(Vector(&s->sizes, s->sizes.nodes, &s->node[n]));
  PetscCall(Vector(&s->sizes, s->sizes.particles, &s->work[0]));
  PetscCall(Vector(&s->sizes, s->sizes.nodes, &s->work[1]));
  PetscCall(MakeMaps(s));
  PetscCall(Wrap(s, shell));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscReal MpmShellNonzeros(const MpmLayout *layout, const MpmScheme *scheme)
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
