/* Lowering: a table is turned into lines once, and nobody asks its operations for their kind after that. */
#include "program/program.h"
#include <mpmstab/errors.h>

PetscErrorCode MpmRegistersOf(const MpmSlab *slab, MpmRegisters *r)
{
  const MpmTable *table = slab->scheme->table;

  PetscFunctionBegin;
  *r = (MpmRegisters){.comm = slab->comm,
                      .rows = {slab->particles, slab->nodes},
                      .n    = {table->nparticles, table->nnodes},
                      .nin  = table->nstate,
                      .nout = table->nstate};
  for (PetscInt f = 0; f < table->nstate; f++) r->in[f] = r->out[f] = f;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmCollision(const MpmSlab *slab, const MpmOp *op, PetscReal time, const Vec u[], Vec *adds,
                            Vec slope[MPM_MAX_DIM])
{
  const PetscInt dim = slab->layout->dim;
  PetscReal     *to[MPM_MAX_DIM], *add, v[MPM_MAX_DIM] = {0}, x[MPM_MAX_DIM], J[MPM_MAX_DIM * MPM_MAX_DIM];

  PetscFunctionBegin;
  PetscCall(MpmRegisterVector(&(MpmRegisters){.comm = slab->comm, .rows = {0, slab->nodes}}, 1, adds));
  PetscCall(VecGetArray(*adds, &add));
  for (PetscInt d = 0; d < dim; d++) {
    PetscCall(VecDuplicate(*adds, &slope[d]));
    PetscCall(VecGetArray(slope[d], &to[d]));
  }
  for (PetscInt i = 0; i < slab->nodes; i++) {
    PetscReal before;
    PetscInt  stride;

    for (PetscInt d = 0; d < dim; d++) {
      x[d] = MpmNodeAlong(slab->layout, slab->node0 + i, d, &stride);
      v[d] = 0;
      if (u) PetscCall(VecGetValues(u[d], 1, &(PetscInt){slab->node0 + i}, &v[d]));
    }
    before = v[op->axis];
    if (!MpmCollidersProject(slab->layout->colliders, dim, x, time, v, J)) continue;
    add[i] = v[op->axis] - before;
    for (PetscInt d = 0; d < dim; d++) to[d][i] = J[dim * op->axis + d] - (d == op->axis);
  }
  for (PetscInt d = 0; d < dim; d++) PetscCall(VecRestoreArray(slope[d], &to[d]));
  PetscCall(VecRestoreArray(*adds, &add));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The nodes of a wall lose their values, and take a times what register src has there; the others keep theirs.
   Colliders that are linear: dst += (P - 1) u along one axis.
*/
PetscInt MpmLinesOfOp(const MpmOp *op, PetscInt dim, PetscInt nodes, MpmLine line[MPM_MAX_DIM])
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscBool   bare   = op->kind == MPM_ADD || op->kind == MPM_SCALE || op->kind == MPM_COPY;
  MpmLine           one    = {.dst         = op->dst + (traits.dst == MPM_ON_NODES ? nodes : 0),
                              .src         = op->src + (traits.src == MPM_ON_NODES ? nodes : 0),
                              .power       = op->coefficient,
                              .factor      = op->factor,
                              .accumulates = op->kind == MPM_ADD ? PETSC_TRUE : op->accumulates,
                              .op          = bare ? NULL : op};

  if (traits.dst == MPM_NOWHERE || (op->kind == MPM_IMPLICIT && op->axis)) return 0;
  if (op->kind == MPM_IMPLICIT) one.nsolve = dim;
  if (op->kind == MPM_SCALE) one.src = one.dst;
  if (op->kind == MPM_SCALE || op->kind == MPM_IMPLICIT) one.accumulates = PETSC_FALSE;
  if (op->kind == MPM_WALL) one.accumulates = PETSC_TRUE;
  line[0] = line[1] = one;
  if (op->kind == MPM_WALL) {
    line[0].src    = one.dst;
    line[0].factor = -1;
    line[0].power  = 0;
    return op->factor == 0 ? 1 : 2;
  }
  for (PetscInt d = 0; d < dim && op->kind == MPM_COLLIDE; d++) {
    line[d]     = one;
    line[d].src = one.src - op->axis + d;
  }
  return op->kind == MPM_COLLIDE ? dim : 1;
}

/* 1 + a K, from the vector that is solved for to itself: K's lines, to which the vector is added. */
static PetscErrorCode System(const MpmRegisters *all, PetscReal courant, MpmMaps *maps, const MpmOp *op, Mat *matrix)
{
  const MpmTable *k = MpmTableStiffness(maps->slab->scheme->table, op);
  MpmRegisters    r = *all;
  MpmStepProgram *program;

  PetscFunctionBegin;
  r.nin = r.nout = k->dim;
  for (PetscInt c = 0; c < k->dim; c++) {
    r.in[c]  = r.n[0] + k->solved + c;
    r.out[c] = r.n[0] + k->image + c;
  }
  PetscCall(MpmStepProgramCreate(&r, courant, &program));
  PetscCall(MpmStepProgramAppendTable(program, k, maps));
  for (PetscInt c = 0; c < k->dim; c++) {
    PetscCall(MpmStepProgramAppend(
        program, (MpmLine){.dst = r.out[c], .src = r.out[c], .power = op->coefficient, .factor = op->factor}));
    PetscCall(MpmStepProgramAppend(program,
                                   (MpmLine){.dst = r.out[c], .src = r.in[c], .factor = 1, .accumulates = PETSC_TRUE}));
  }
  PetscCall(MpmStepProgramAssemble(program, PETSC_TRUE, matrix));
  PetscCall(MpmStepProgramDestroy(&program));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmFactorised(Mat matrix, KSP *solve)
{
  PC  pc;
  int ranks;

  PetscFunctionBegin;
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)matrix), solve));
  PetscCall(KSPSetOperators(*solve, matrix, matrix));
  PetscCall(KSPSetType(*solve, KSPPREONLY));
  PetscCall(KSPGetPC(*solve, &pc));
  PetscCall(PCSetType(pc, PCLU));
  PetscCallMPI(MPI_Comm_size(PetscObjectComm((PetscObject)matrix), &ranks));
  if (ranks > 1) PetscCall(PCFactorSetMatSolverType(pc, MATSOLVERMUMPS));
  PetscCall(KSPSetUp(*solve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Collide(const MpmSlab *slab, PetscInt nodes, MpmLine *line)
{
  const PetscInt component = line->src - nodes - line->op->src + line->op->axis;
  Vec            adds, slope[MPM_MAX_DIM];

  PetscFunctionBegin;
  MpmCheckInput(
      MpmCollidersAreLinear(slab->layout->colliders),
      "colliders: a step with friction, contact separating or a body that moves is not linear; allowed: sticky, "
      "or slip without friction, at rest; 'mpmstab run', or with kinematics finite its tangent at a state "
      "(at_step)");
  PetscCall(MpmCollision(slab, line->op, 0, NULL, &adds, slope));
  PetscCall(VecDestroy(&adds));
  for (PetscInt d = 0; d < slab->layout->dim; d++) {
    if (d == component)
      line->left = slope[d];
    else
      PetscCall(VecDestroy(&slope[d]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The line of IMPLICIT solves by LU, which serves all right sides and the transpose. */
PetscErrorCode MpmLineBind(const MpmStepProgram *p, MpmMaps *maps, MpmLine *line)
{
  Mat matrix;

  PetscFunctionBegin;
  if (!line->op) PetscFunctionReturn(PETSC_SUCCESS);
  if (line->nsolve) {
    PetscCall(System(&p->registers, p->courant, maps, line->op, &matrix));
    PetscCall(MpmFactorised(matrix, &line->solve));
    PetscCall(MatDestroy(&matrix));
  } else if (line->op->kind == MPM_COLLIDE)
    PetscCall(Collide(maps->slab, p->registers.n[0], line));
  else {
    PetscCall(MpmMapsGet(maps, line->op, &line->map));
    PetscCall(PetscObjectReference((PetscObject)line->map));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmLineRelease(MpmLine *line)
{
  PetscFunctionBegin;
  PetscCall(MatDestroy(&line->map));
  PetscCall(VecDestroy(&line->left));
  PetscCall(VecDestroy(&line->right));
  PetscCall(KSPDestroy(&line->solve));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepProgramAppendTable(MpmStepProgram *p, const MpmTable *table, MpmMaps *maps)
{
  PetscFunctionBegin;
  for (PetscInt o = 0; o < table->nops; o++) {
    MpmLine        line[MPM_MAX_DIM];
    const PetscInt n = MpmLinesOfOp(&table->ops[o], table->dim, p->registers.n[0], line);

    for (PetscInt i = 0; i < n; i++) {
      if (maps) PetscCall(MpmLineBind(p, maps, &line[i]));
      PetscCall(MpmStepProgramAppend(p, line[i]));
      PetscCall(MpmLineRelease(&line[i]));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStepProgramAppendStep(MpmStepProgram *p, MpmMaps *maps, PetscBool again)
{
  const MpmTable *table = maps->slab->scheme->table;

  PetscFunctionBegin;
  for (PetscInt r = table->nstate; r < p->registers.n[0] + table->nnodes && again; r++)
    PetscCall(MpmStepProgramAppend(p, (MpmLine){.dst = r, .src = r}));
  PetscCall(MpmStepProgramAppendTable(p, table, maps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- steps ---- */

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
