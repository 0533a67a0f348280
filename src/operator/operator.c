/* The operator of a step or a period, and the proof that it is what the march does. */
#include "operator/assemble.h"
#include "scene/layout.h"
#include "march/march_private.h"
#include <mpmstab/operator.h>
#include <math.h>

#define RESCALE_AT 200 /* powers of two */
#define PERIODS 3      /* that the march is compared over */
#define LARGEST 3e8    /* nonzeros */
#define OF_NONZERO 50  /* bytes: registers while it is assembled, then the factors of its shifts */

/* Keeps the registers in range; they are what they hold times 2^exponent. */
static PetscErrorCode Rescale(MpmRegisters *r, PetscInt *exponent)
{
  PetscReal norm, largest = 0;
  PetscInt  shift;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < r->fields; f++) {
    PetscCall(MatNorm(r->particle[f], NORM_INFINITY, &norm));
    largest = PetscMax(largest, norm);
  }
  if (!isnormal(largest) || PetscAbsInt(ilogb(largest)) < RESCALE_AT) PetscFunctionReturn(PETSC_SUCCESS);
  shift = ilogb(largest);
  for (PetscInt f = 0; f < r->fields; f++) PetscCall(MatScale(r->particle[f], scalbn(1, -(int)shift)));
  *exponent += shift;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* A P2G and what follows it carry a number over the reach of the basis, a stencil over its halo. */
static PetscErrorCode CheckSize(MPI_Comm comm, const MpmOperator *op)
{
  const MpmScene *scene = op->scene;
  const MpmTable *table = scene->table;
  PetscReal       cells = 0, nonzeros;

  PetscFunctionBegin;
  for (PetscInt o = 0; o < table->nops; o++) {
    const MpmOpTraits traits = MpmOpTraitsOf(table->ops[o].kind);

    if (traits.dst == MPM_ON_NODES && traits.src == MPM_ON_PARTICLES)
      cells += scene->basis->reach_left + scene->basis->reach_right;
    cells += traits.halo;
    if (table->ops[o].kind == MPM_SOLVE) cells = scene->cells;
  }
  nonzeros = (PetscReal)op->order * op->fields * scene->ppc * PetscMin(2 * cells * op->period + 1, scene->cells);
  MpmCheckInput(nonzeros <= LARGEST,
                "cells %" PetscInt_FMT " with ppc %" PetscInt_FMT " and a period of %" PetscInt_FMT
                " steps: the operator would hold about %.2g numbers; allowed: at most %.2g, so fewer cells or a drift "
                "with a smaller denominator ('mpmstab run' and 'symbol' need no operator)",
                scene->cells, scene->ppc, op->period, nonzeros, LARGEST);
  PetscCall(MpmSceneCheckMemory(comm, scene, OF_NONZERO * nonzeros, "the spectrum"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Assemble(MPI_Comm comm, MpmOperator *op)
{
  static PetscClassId  id; /* registered once: some tasks assemble thousands */
  static PetscLogEvent event;
  MpmRegisters         registers;

  PetscFunctionBegin;
  if (!id) {
    PetscCall(PetscClassIdRegister("MpmOperator", &id));
    PetscCall(PetscLogEventRegister("MpmAssemble", id, &event));
  }
  PetscCall(PetscLogEventBegin(event, 0, 0, 0, 0));
  PetscCall(MpmRegistersCreate(comm, op->scene, &registers));
  for (PetscInt step = 0; step < op->period; step++) {
    PetscCall(MpmRegistersStep(&registers, step));
    PetscCall(Rescale(&registers, &op->exponent));
  }
  PetscCall(MpmRegistersGather(&registers, &op->A));
  PetscCall(MpmRegistersMap(&registers, MPM_P2G, PETSC_FALSE, 0, &op->p2g));
  PetscCall(MpmRegistersDestroy(&registers));
  PetscCall(PetscObjectSetName((PetscObject)op->A, "A"));
  PetscCall(PetscLogEventEnd(event, 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorStep(const MpmOperator *op, PetscInt step, Mat *A, PetscInt *exponent)
{
  MpmRegisters registers;

  PetscFunctionBegin;
  *exponent = 0;
  if (op->period == 1) {
    PetscCall(PetscObjectReference((PetscObject)op->A));
    *A        = op->A;
    *exponent = op->exponent;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(MpmRegistersCreate(PetscObjectComm((PetscObject)op->A), op->scene, &registers));
  PetscCall(MpmRegistersStep(&registers, step));
  PetscCall(MpmRegistersGather(&registers, A));
  PetscCall(MpmRegistersDestroy(&registers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorCreate(MPI_Comm comm, const MpmScene *scene, MpmOperator **op)
{
  const PetscReal begin = MPI_Wtime();
  MpmOperator    *o;
  MatInfo         info;

  PetscFunctionBegin;
  PetscCall(PetscNew(op));
  o         = *op;
  o->scene  = scene;
  o->fields = scene->table->nstate;
  MpmCheckInput(o->fields * scene->particles <= PETSC_MAX_INT / 2,
                "cells %" PetscInt_FMT " with ppc %" PetscInt_FMT ": too many unknowns; allowed: at most %d",
                scene->cells, scene->ppc, PETSC_MAX_INT / 2);
  o->order = (PetscInt)(o->fields * scene->particles);
  PetscCall(MpmLayoutPeriod(scene, &o->period));
  PetscCall(CheckSize(comm, o));
  PetscCall(Assemble(comm, o));
  PetscCall(MpmOperatorBalance(o));
  PetscCall(MatGetInfo(o->A, MAT_GLOBAL_SUM, &info));
  o->nonzeros   = info.nz_used;
  o->bytes      = info.nz_used * (sizeof(PetscScalar) + sizeof(PetscInt)) + 2.0 * o->order * sizeof(PetscInt);
  o->assemble_s = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorDestroy(MpmOperator **op)
{
  PetscFunctionBegin;
  if (!*op) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatDestroy(&(*op)->A));
  PetscCall(MatDestroy(&(*op)->balanced));
  PetscCall(VecDestroy(&(*op)->unit));
  PetscCall(MatDestroy(&(*op)->p2g));
  PetscCall(PetscFree(*op));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The march's particle fields as a state, in units of 2^exponent. */
static PetscErrorCode StateOf(const MpmMarch *march, PetscInt exponent, Vec state)
{
  const char *const *names = march->scene->table->fields;
  const PetscInt     n = march->particles->count, fields = march->scene->table->nstate;
  const PetscInt64  *id;
  PetscInt          *rows;
  PetscReal         *values;

  PetscFunctionBegin;
  PetscCall(PetscMalloc2(n, &rows, n, &values));
  PetscCall(MpmParticlesGet(march->particles, DMSwarmField_pid, &id));
  for (PetscInt f = 0; names[f]; f++) {
    const PetscReal *q;

    PetscCall(MpmParticlesGet(march->particles, names[f], &q));
    for (PetscInt p = 0; p < n; p++) {
      rows[p]   = (PetscInt)(fields * id[p] + f);
      values[p] = scalbn(q[p], (int)(march->exponent - exponent));
    }
    PetscCall(VecSetValues(state, n, rows, values, INSERT_VALUES));
    PetscCall(MpmParticlesRestore(march->particles, names[f], &q));
  }
  PetscCall(MpmParticlesRestore(march->particles, DMSwarmField_pid, &id));
  PetscCall(PetscFree2(rows, values));
  PetscCall(VecAssemblyBegin(state));
  PetscCall(VecAssemblyEnd(state));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorMismatch(const MpmOperator *op, PetscReal *mismatch)
{
  MpmMarch *march;
  Vec       before, after, predicted;

  PetscFunctionBegin;
  *mismatch = 0;
  PetscCall(MpmMarchCreate(PetscObjectComm((PetscObject)op->A), op->scene, &march));
  PetscCall(MpmMarchFillRandom(march, 1));
  PetscCall(MatCreateVecs(op->A, &before, &after));
  PetscCall(VecDuplicate(after, &predicted));
  for (PetscInt n = 0; n < PERIODS; n++) {
    PetscInt  start = march->exponent;
    PetscReal norm, image, difference;

    PetscCall(StateOf(march, start, before));
    for (PetscInt step = 0; step < op->period; step++) PetscCall(MpmMarchStep(march, PETSC_FALSE));
    PetscCall(StateOf(march, start + op->exponent, after));
    PetscCall(MatMult(op->A, before, predicted));
    PetscCall(VecNorm(predicted, NORM_2, &image));
    PetscCall(VecAXPY(predicted, -1, after));
    PetscCall(VecNorm(predicted, NORM_2, &difference));
    PetscCall(VecNorm(before, NORM_2, &norm));
    norm       = PetscMax(norm, scalbn(image, (int)op->exponent));
    difference = scalbn(difference, (int)op->exponent) / norm;
    if (!(difference <= *mismatch)) *mismatch = difference; /* NaN is the largest */
    if (isnormal(norm)) PetscCall(MpmMarchRescale(march, ilogb(norm)));
  }
  PetscCall(VecDestroy(&before));
  PetscCall(VecDestroy(&after));
  PetscCall(VecDestroy(&predicted));
  PetscCall(MpmMarchDestroy(&march));
  PetscFunctionReturn(PETSC_SUCCESS);
}
