/*
   A plan on the sparse matrices of a layout, as three programs: M takes the nodal unknowns through a step, Z makes them
   of the state, and B makes of them what a step adds to the state. M and Z are assembled; B is applied to vectors.
*/
#include "operator/nodal.h"
#include "program/program.h"
#include <math.h>

/* map - the plan's maps, nodes x nodes */
typedef struct {
  MpmNodalPlan *plan;
  MpmSlab       sizes;
  MpmMaps       maps;
  Mat          *map;
} Nodal;

static PetscErrorCode MapOf(Nodal *x, const MpmNodalMap *map, Mat *matrix)
{
  Mat P, W;

  PetscFunctionBegin;
  PetscCall(MpmMapsGet(&x->maps, &map->to_nodes, &P));
  if (map->product) {
    PetscCall(MpmMapsGet(&x->maps, &map->to_particles, &W));
    PetscCall(MatMatMult(P, W, MAT_INITIAL_MATRIX, PETSC_DETERMINE, matrix));
  } else {
    PetscCall(PetscObjectReference((PetscObject)P));
    *matrix = P;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- programs ---- */

/*
   A program whose registers are those of the state and, after them, the plan's slots, with the first lines of the plan.
*/
static PetscErrorCode Begin(const Nodal *x, PetscInt lines, MpmStepProgram **program)
{
  const MpmNodalPlan *plan = x->plan;
  const MpmRegisters  r    = {
          .comm = x->sizes.comm, .rows = {x->sizes.particles, x->sizes.nodes}, .n = {plan->nstate, plan->nslots}};

  PetscFunctionBegin;
  PetscCall(MpmStepProgramCreate(&r, x->sizes.step.courant, program));
  for (PetscInt l = 0; l < lines; l++) {
    MpmLine line = plan->program->line[l];

    line.dst += plan->nstate;
    line.src += plan->nstate;
    line.map = line.key == MPM_NONE ? NULL : x->map[line.key];
    PetscCall(MpmStepProgramAppend(*program, line));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A program from n registers, from first on, to nout others. */
static void FromTo(MpmStepProgram *program, PetscInt first, PetscInt n, PetscInt to, PetscInt nout)
{
  MpmRegisters *r = &program->registers;

  r->nin  = n;
  r->nout = nout;
  for (PetscInt i = 0; i < n; i++) r->in[i] = first + i;
  for (PetscInt i = 0; i < nout; i++) r->out[i] = to + i;
}

/* Appends dst += op src, an operation of the table between particles and nodes. */
static PetscErrorCode Append(Nodal *x, const MpmOp *op, PetscInt power, PetscInt dst, PetscInt src,
                             MpmStepProgram *program)
{
  MpmLine line = {.dst = dst, .src = src, .power = power, .factor = op->factor, .accumulates = PETSC_TRUE};

  PetscFunctionBegin;
  PetscCall(MpmMapsGet(&x->maps, op, &line.map));
  PetscCall(MpmStepProgramAppend(program, line));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* M: what the slots of the images hold after the step. Z: the images of the state. B: what a step adds to the state. */
static PetscErrorCode CreateMatrices(Nodal *x, MpmReduced *r)
{
  const MpmNodalPlan *plan = x->plan;
  const PetscInt      n = plan->nstate, images = plan->nimages;
  MpmStepProgram     *M, *Z, *B;

  PetscFunctionBegin;
  PetscCall(Begin(x, plan->program->n, &M));
  FromTo(M, n, images, n, images);
  for (PetscInt g = 0; g < images; g++) M->registers.out[g] = n + plan->next[g];
  PetscCall(MpmStepProgramAssemble(M, PETSC_TRUE, &r->M));
  PetscCall(MpmStepProgramDestroy(&M));
  PetscCall(Begin(x, 0, &Z));
  FromTo(Z, 0, n, n, images);
  for (PetscInt g = 0; g < images; g++)
    for (const MpmOp *op = plan->image[g].term; op < plan->image[g].term + plan->image[g].n; op++)
      PetscCall(Append(x, op, 0, n + g, op->src, Z));
  PetscCall(MpmStepProgramAssemble(Z, PETSC_FALSE, &r->Z));
  PetscCall(MpmStepProgramDestroy(&Z));
  PetscCall(Begin(x, plan->nlines_sent, &B));
  FromTo(B, n, images, 0, n);
  for (const MpmNodalSent *s = plan->sent; s < plan->sent + plan->nsent; s++)
    PetscCall(Append(x, &s->op, s->op.coefficient, s->op.dst, n + s->slot, B));
  PetscCall(MpmStepProgramMatrix(B, NULL, &r->B));
  PetscCall(MpmStepProgramDestroy(&B));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- what a step multiplies by a number ---- */

/*
   Counts the numbers that C and C' have, of so many particles and nodes. too_many: they have too many different ones.
*/
static void Count(const MpmNodalPlan *plan, PetscInt64 particles, PetscInt64 nodes, MpmReduced *r, PetscBool *too_many)
{
  *too_many = PETSC_FALSE;
  for (PetscInt i = 0; i < plan->nstate + plan->nimages; i++) {
    const PetscInt  g = i - plan->nstate;
    const PetscReal c = g < 0 ? plan->kept[i] : plan->image[g].c;
    PetscInt        k = 0;

    while (k < r->nkept && r->number[k] != c) k++;
    if (k == MPM_REDUCED_KEPT) {
      *too_many = PETSC_TRUE;
      return;
    }
    if (k == r->nkept) r->number[r->nkept++] = c;
    if (g < 0)
      r->count[k] += (PetscInt)particles;
    else
      r->count_small[k] += (PetscInt)nodes;
  }
}

static PetscErrorCode Diagonal(MPI_Comm comm, PetscInt count, const PetscReal number[], PetscInt n, Vec *diagonal)
{
  PetscReal *d;

  PetscFunctionBegin;
  PetscCall(MpmRegisterVector(&(MpmRegisters){.comm = comm, .rows = {count * n}}, 0, diagonal));
  PetscCall(VecGetArrayWrite(*diagonal, &d));
  for (PetscInt i = 0; i < count * n; i++) d[i] = number[i % count];
  PetscCall(VecRestoreArrayWrite(*diagonal, &d));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalMatrixUnknowns(const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                      PetscInt64 *unknowns)
{
  const PetscInt64 nodes = MpmLayoutNodes(layout);
  MpmReduced       r     = {.nkept = 0};
  MpmNodalPlan    *plan;
  const char      *why;
  PetscBool        too_many;

  PetscFunctionBegin;
  *unknowns = 0;
  if (MpmStepDrifts(step)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmNodalPlanCreate(scheme->table, &why, &plan));
  if (plan && plan->nstate * layout->particles <= PETSC_MAX_INT && plan->nimages * nodes <= PETSC_MAX_INT) {
    Count(plan, layout->particles, nodes, &r, &too_many);
    *unknowns = plan->nimages * nodes < plan->nstate * layout->particles && !too_many ? plan->nimages * nodes : 0;
    for (PetscInt k = 0; k < r.nkept; k++)
      if (r.count_small[k] > r.count[k]) *unknowns = 0;
  }
  PetscCall(MpmNodalPlanDestroy(&plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- all of it ---- */

static PetscErrorCode Balance(Vec unit, MpmReduced *r)
{
  Vec inverse;

  PetscFunctionBegin;
  PetscCall(MpmReciprocals(unit, &inverse));
  PetscCall(MatDiagonalScale(r->B, unit, NULL));
  PetscCall(MatDiagonalScale(r->Z, NULL, inverse));
  PetscCall(VecDestroy(&inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The same of the unknowns of nodes where masses differ: all images are sums over particles divided by the nodal mass
   m, and with powers of two next to its root they have the size of the particles' balanced numbers. Without it rounding
   of the heavy nodes' numbers spoils the light ones'.
*/
static PetscErrorCode BalanceNodes(const Nodal *x, MpmReduced *r)
{
  const PetscInt   images = x->plan->nimages;
  const PetscReal *mass;
  PetscReal       *d;
  Vec              unit, inverse;

  PetscFunctionBegin;
  PetscCall(VecDuplicate(r->kept_small, &unit));
  PetscCall(VecGetArrayRead(x->maps.masses, &mass));
  PetscCall(VecGetArrayWrite(unit, &d));
  for (PetscInt i = 0; i < images * x->sizes.nodes; i++)
    d[i] = mass[i / images] > 0 ? exp2(rint(log2(mass[i / images]) / 2)) : 1;
  PetscCall(VecRestoreArrayWrite(unit, &d));
  PetscCall(VecRestoreArrayRead(x->maps.masses, &mass));
  PetscCall(MpmReciprocals(unit, &inverse));
  PetscCall(MatDiagonalScale(r->M, unit, inverse));
  PetscCall(MatDiagonalScale(r->Z, unit, NULL));
  PetscCall(MatDiagonalScale(r->B, NULL, inverse));
  PetscCall(VecDestroy(&unit));
  PetscCall(VecDestroy(&inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalMatrixCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme,
                                    const MpmStep *step, Vec unit, MpmReduced **nodal)
{
  PetscReal   c[MPM_MAX_IMAGES];
  PetscBool   too_many;
  MpmReduced *r;
  Nodal       x;

  PetscFunctionBegin;
  PetscCall(PetscNew(nodal));
  r = *nodal;
  PetscCall(MpmNodalPlanCreate(scheme->table, NULL, &x.plan));
  PetscCall(MpmSlabOf(comm, layout, scheme, step, &x.sizes));
  x.maps = (MpmMaps){.slab = &x.sizes};
  PetscCall(PetscCalloc1(PetscMax(1, x.plan->nmaps), &x.map));
  for (PetscInt m = 0; m < x.plan->nmaps; m++) PetscCall(MapOf(&x, &x.plan->map[m], &x.map[m]));
  Count(x.plan, layout->particles, MpmLayoutNodes(layout), r, &too_many);
  for (PetscInt g = 0; g < x.plan->nimages; g++) c[g] = x.plan->image[g].c;
  PetscCall(Diagonal(comm, x.plan->nstate, x.plan->kept, x.sizes.particles, &r->kept));
  PetscCall(Diagonal(comm, x.plan->nimages, c, x.sizes.nodes, &r->kept_small));
  PetscCall(CreateMatrices(&x, r));
  if (unit) PetscCall(Balance(unit, r));
  if (layout->varies[MPM_MASS]) PetscCall(BalanceNodes(&x, r));
  for (PetscInt m = 0; m < x.plan->nmaps; m++) PetscCall(MatDestroy(&x.map[m]));
  PetscCall(PetscFree(x.map));
  PetscCall(MpmMapsDestroy(&x.maps));
  PetscCall(MpmNodalPlanDestroy(&x.plan));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmNodalMatrixOf(const MpmOperator *op, MpmReduced **nodal)
{
  PetscInt64 unknowns = 0;

  PetscFunctionBegin;
  *nodal = NULL;
  if (op->layout) PetscCall(MpmNodalMatrixUnknowns(op->layout, op->scheme, &op->step, &unknowns));
  if (!unknowns || op->exponent) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(
      MpmNodalMatrixCreate(PetscObjectComm((PetscObject)op->A), op->layout, op->scheme, &op->step, op->unit, nodal));
  PetscCall(MpmReducedCheck(op->balanced, *nodal));
  if (!((*nodal)->mismatch <= MPM_REDUCED_AGREES)) PetscCall(MpmReducedDestroy(nodal));
  PetscFunctionReturn(PETSC_SUCCESS);
}
