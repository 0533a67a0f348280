/*
   The operator of a step or of a period, its comparison with the march, and the operator in variables whose squares add
   up to the energy 1/2 sum m v^2 + V s^2 / E. Solvers and the energy norm use the latter.
*/
#include "base/power_of_two.h"
#include "operator/tangent.h"
#include "scene/layout.h"
#include "scene/material.h"
#include <mpmstab/operator.h>
#include <math.h>

#define RESCALE_AT 200 /* powers of two */
#define PERIODS 3      /* over which the march is compared */
#define LARGEST 3e8    /* nonzeros */
#define OF_NONZERO 50  /* bytes: for the registers during assembly, and later for the solver's factors */
#define OF_MAP 14      /* bytes: of a number of a map */
#define VECTORS 100    /* of the solver */
#define SWEEPS 40      /* each halves the distance to balance, on a scale of logarithms */
#define CLOSE 0.25     /* change of a logarithm to base 2 below which a sweep is the last */
#define GAIN 4         /* the norm must become so many times smaller, else the matrix stays as it is */

/* Divides the registers by a power of two when they would leave the range of doubles, and adds to its exponent. */
static PetscErrorCode Rescale(const MpmMatrices *m, PetscInt *exponent)
{
  PetscReal norm, largest = 0;
  PetscInt  shift;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < m->registers.nout; f++) {
    if (!m->reg[f]) continue;
    PetscCall(MatNorm(m->reg[f], NORM_INFINITY, &norm));
    largest = PetscMax(largest, norm);
  }
  shift = MpmPowerToTakeOut(largest, RESCALE_AT);
  if (!shift) PetscFunctionReturn(PETSC_SUCCESS);
  for (PetscInt f = 0; f < m->registers.nout; f++)
    if (m->reg[f]) PetscCall(MatScale(m->reg[f], scalbn(1, -(int)shift)));
  *exponent += shift;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether operation o is a sum over particles. */
static PetscBool IsSum(const MpmTable *table, PetscInt o)
{
  MpmOpTraits traits;

  if (o < 0) return PETSC_FALSE;
  traits = MpmOpTraitsOf(table->ops[o].kind);
  return traits.dst == MPM_ON_NODES && traits.src == MPM_ON_PARTICLES ? PETSC_TRUE : PETSC_FALSE;
}

/*
   Refuses an operator that would be too large. In a step, each sum over particles carries a number over the reach of
   the basis in every direction, and each stencil over its halo. Sums that begin before one of them is read carry it at
   the same time.
*/
static PetscErrorCode CheckMatrix(MPI_Comm comm, const MpmOperator *op)
{
  const MpmLayout *layout = op->layout;
  const MpmBasis  *basis  = op->scheme->basis;
  const MpmTable  *table  = op->scheme->table;
  PetscReal        cells = 0, nonzeros = (PetscReal)op->order * op->fields * MpmLayoutPpc(layout);
  char             size[MPM_SIZE_TEXT];

  PetscFunctionBegin;
  MpmLayoutSizeText(layout, sizeof size, size);
  for (PetscInt o = 0; o < table->nops; o++) {
    const MpmOpTraits traits = MpmOpTraitsOf(table->ops[o].kind);

    if (traits.dst == MPM_ON_NODES && traits.src == MPM_ON_PARTICLES && (table->dim == 1 || !IsSum(table, o - 1)))
      cells += basis->reach_left + basis->reach_right;
    cells += traits.halo;
    if (table->ops[o].kind == MPM_SOLVE || table->ops[o].kind == MPM_IMPLICIT) cells = INFINITY;
  }
  for (PetscInt a = 0; a < layout->dim; a++) nonzeros *= PetscMin(2 * cells * op->period + 1, layout->grid[a].cells);
  MpmCheckInput(nonzeros <= LARGEST,
                "%s and a period of %" PetscInt_FMT
                " steps: the operator would hold about %.2g numbers; allowed: at most %.2g, so fewer cells or a drift "
                "with a smaller denominator ('mpmstab run' and 'symbol' need no operator)",
                size, op->period, nonzeros, LARGEST);
  PetscCall(MpmLayoutCheckMemory(comm, layout, OF_NONZERO * nonzeros, "the spectrum"));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Refuses an operator without a matrix whose maps and vectors would be too large. */
static PetscErrorCode CheckMaps(MPI_Comm comm, const MpmOperator *op)
{
  const PetscReal maps = op->period * MpmStepsNonzeros(op->layout, op->scheme);
  char            what[128];

  PetscFunctionBegin;
  PetscCall(PetscSNPrintf(what, sizeof what,
                          "the spectrum, of %" PetscInt_FMT " unknowns and a period of %" PetscInt_FMT " steps,",
                          op->order, op->period));
  PetscCall(MpmLayoutCheckMemory(comm, op->layout, OF_MAP * maps + VECTORS * sizeof(PetscScalar) * (PetscReal)op->order,
                                 what));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The matrix of some steps. exponent: NULL, or that of the power of two that is taken out. */
static PetscErrorCode Steps(MPI_Comm comm, const MpmOperator *op, PetscInt first, PetscInt steps, PetscInt *exponent,
                            Mat *A)
{
  MpmMatrices registers;
  MpmSlab     slab;

  PetscFunctionBegin;
  PetscCall(MpmSlabOf(comm, op->layout, op->scheme, &op->step, &slab));
  PetscCall(MpmMatricesOfSlab(&slab, 0, &registers));
  for (PetscInt step = first; step < first + steps; step++) {
    PetscCall(MpmMatricesStep(&registers, &slab, step));
    if (exponent) PetscCall(Rescale(&registers, exponent));
  }
  PetscCall(MpmMatricesGather(&registers, PETSC_FALSE, A));
  PetscCall(MpmMatricesDestroy(&registers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The operator as a matrix. */
static PetscErrorCode Assemble(MPI_Comm comm, MpmOperator *op)
{
  static PetscClassId  id; /* registered once, because some tasks assemble thousands */
  static PetscLogEvent event;

  PetscFunctionBegin;
  PetscCall(CheckMatrix(comm, op));
  if (!id) {
    PetscCall(PetscClassIdRegister("MpmOperator", &id));
    PetscCall(PetscLogEventRegister("MpmAssemble", id, &event));
  }
  PetscCall(PetscLogEventBegin(event, 0, 0, 0, 0));
  PetscCall(Steps(comm, op, 0, op->period, &op->exponent, &op->A));
  PetscCall(PetscObjectSetName((PetscObject)op->A, "A"));
  PetscCall(PetscLogEventEnd(event, 0, 0, 0, 0));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorStep(const MpmOperator *op, PetscInt step, Mat *A, PetscInt *exponent)
{
  MPI_Comm comm = PetscObjectComm((PetscObject)op->A);

  PetscFunctionBegin;
  *exponent = 0;
  if (op->parts == 1) {
    PetscCall(PetscObjectReference((PetscObject)op->A));
    *A        = op->A;
    *exponent = op->exponent;
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  PetscCall(op->assembled ? Steps(comm, op, step, 1, NULL, A)
                          : MpmStepsMatrix(comm, op->layout, op->scheme, &op->step, step, 1, A));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether a register is a component of a stress. */
static PetscBool IsStress(const MpmScheme *scheme, PetscInt r)
{
  const MpmFormulation *formulation = scheme->formulation;
  const PetscInt        field       = scheme->table->field[r];

  for (PetscInt t = 0; t < formulation->nenergy; t++) {
    const MpmEnergyTerm *term = &formulation->energy[t];

    if (term->place == MPM_ON_PARTICLES && term->field == field) return term->stress;
  }
  return PETSC_FALSE;
}

/* sqrt(m) for a velocity, sqrt(V / E) for a stress. */
static PetscReal RootOf(const MpmOperator *op, PetscInt r, PetscInt64 id)
{
  return sqrt(IsStress(op->scheme, r)
                  ? MpmMaterialProperty(op->layout, MPM_VOLUME, id) / MpmMaterialProperty(op->layout, MPM_STIFFNESS, id)
                  : MpmMaterialProperty(op->layout, MPM_MASS, id));
}

static PetscBool IsAlike(const MpmOperator *op)
{
  const PetscBool *varies = op->layout ? op->layout->varies : NULL;

  return !varies || (!varies[MPM_MASS] && !varies[MPM_STIFFNESS]) ? PETSC_TRUE : PETSC_FALSE;
}

/* The diagonal of D: the roots, or with powers the powers of two next to them. */
static PetscErrorCode Roots(const MpmOperator *op, PetscBool powers, Mat A, Vec *unit)
{
  PetscInt   begin, end;
  PetscReal *d;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(A, NULL, unit));
  PetscCall(VecGetOwnershipRange(*unit, &begin, &end));
  PetscCall(VecGetArray(*unit, &d));
  for (PetscInt row = begin; row < end; row++) {
    const PetscReal root = RootOf(op, row % op->fields, row / op->fields);

    d[row - begin] = powers ? exp2(rint(log2(root))) : root;
  }
  PetscCall(VecRestoreArray(*unit, &d));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Computes D A D^-1, unit the diagonal of D. */
static PetscErrorCode Scale(const MpmOperator *op, Mat A, Vec unit, Mat *scaled)
{
  Vec inverse;

  PetscFunctionBegin;
  PetscCall(MpmReciprocals(unit, &inverse));
  PetscCall(op->assembled ? MatDuplicate(A, MAT_COPY_VALUES, scaled) : MpmMatrixCopy(A, scaled));
  PetscCall(MatDiagonalScale(*scaled, unit, inverse));
  PetscCall(VecDestroy(&inverse));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets balanced and unit from A. */
static PetscErrorCode Balance(MpmOperator *op)
{
  PetscFunctionBegin;
  if (IsAlike(op)) {
    PetscCall(PetscObjectReference((PetscObject)op->A));
    op->balanced = op->A;
  } else {
    PetscCall(Roots(op, PETSC_TRUE, op->A, &op->unit));
    PetscCall(Scale(op, op->A, op->unit, &op->balanced));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets nonzeros and bytes from A. */
static PetscErrorCode Count(MpmOperator *op)
{
  MatInfo info;

  PetscFunctionBegin;
  PetscCall(MatGetInfo(op->A, MAT_GLOBAL_SUM, &info));
  op->nonzeros = info.nz_used;
  op->bytes    = info.nz_used * (sizeof(PetscScalar) + sizeof(PetscInt)) + 2.0 * op->order * sizeof(PetscInt);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorCreate(MPI_Comm comm, const MpmLayout *layout, const MpmScheme *scheme, const MpmStep *step,
                                 MpmOperator **op)
{
  const PetscReal begin = MPI_Wtime();
  MpmOperator    *o;
  MpmSlab         slab;
  char            size[MPM_SIZE_TEXT];

  PetscFunctionBegin;
  PetscCall(MpmTableRequireLinear(scheme->table));
  PetscCall(PetscNew(op));
  o         = *op;
  o->layout = layout;
  o->scheme = scheme;
  o->step   = *step;
  o->fields = scheme->table->nstate;
  MpmLayoutSizeText(layout, sizeof size, size);
  MpmCheckInput(o->fields * layout->particles <= PETSC_MAX_INT / 2,
                "%s: too many unknowns, %" PetscInt64_FMT "; allowed: at most %d", size, o->fields * layout->particles,
                PETSC_MAX_INT / 2);
  o->order     = (PetscInt)(o->fields * layout->particles);
  o->assembled = layout->dim == 1 || o->order <= MPM_MATRIX_ORDER ? PETSC_TRUE : PETSC_FALSE;
  PetscCall(MpmStepPeriod(step, &o->period));
  o->parts = o->period;
  if (o->assembled)
    PetscCall(Assemble(comm, o));
  else {
    PetscCall(CheckMaps(comm, o));
    PetscCall(MpmStepsMatrix(comm, layout, scheme, step, 0, o->period, &o->A));
  }
  PetscCall(MpmSlabOf(comm, layout, scheme, step, &slab));
  PetscCall(MpmMapsEven(&slab, 0, &o->p2g));
  PetscCall(Balance(o));
  PetscCall(Count(o));
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

/* The particle fields of a march as a state vector, in units of 2^exponent. */
static PetscErrorCode StateOf(const MpmMarch *march, PetscInt exponent, Vec state)
{
  const MpmTable *table = march->scheme->table;

  PetscFunctionBegin;
  for (PetscInt f = 0; f < table->nstate; f++)
    PetscCall(MpmMarchPut(march, table->fields[f], PETSC_FALSE, 0, table->nstate, f, state));
  PetscCall(VecAssemblyBegin(state));
  PetscCall(VecAssemblyEnd(state));
  PetscCall(VecScale(state, scalbn(1, (int)(march->exponent - exponent))));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorMismatch(const MpmOperator *op, PetscReal *mismatch)
{
  MpmMarch *march;
  Vec       before, after, predicted;

  PetscFunctionBegin;
  *mismatch = 0;
  PetscCall(MpmMarchCreateRandom(PetscObjectComm((PetscObject)op->A), op->layout, op->scheme, &op->step, 1, &march));
  PetscCall(MatCreateVecs(op->A, &before, &after));
  PetscCall(VecDuplicate(after, &predicted));
  for (PetscInt n = 0; n < PERIODS; n++) {
    PetscInt  start = march->exponent;
    PetscReal norm, image, difference;

    PetscCall(StateOf(march, start, before));
    for (PetscInt step = 0; step < op->period; step++) PetscCall(MpmMarchStep(march));
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

PetscErrorCode MpmOperatorWeigh(const MpmOperator *op, Mat A, Mat *weighed)
{
  Vec unit;

  PetscFunctionBegin;
  if (IsAlike(op)) {
    PetscCall(PetscObjectReference((PetscObject)A));
    *weighed = A;
  } else {
    PetscCall(Roots(op, PETSC_FALSE, A, &unit));
    PetscCall(Scale(op, A, unit, weighed));
    PetscCall(VecDestroy(&unit));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorWeights(const MpmOperator *op, Vec *weights)
{
  PetscFunctionBegin;
  *weights = NULL;
  if (IsAlike(op)) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Roots(op, PETSC_FALSE, op->A, weights));
  PetscCall(VecPointwiseDivide(*weights, *weights, op->unit));
  PetscFunctionReturn(PETSC_SUCCESS);
}

const char *MpmOperatorNorm(const MpmOperator *op)
{
  const MpmFormulation *f       = op->scheme ? op->scheme->formulation : NULL;
  PetscInt              squares = 0;

  if (!f) return "Euclidean, of the matrix's own unknowns";
  for (PetscInt t = 0; t < MpmSchemeEnergyTerms(op->scheme); t++) squares += f->energy[t].place == MPM_ON_PARTICLES;
  if (squares == op->fields) return "the energy's, of the particles";
  return IsAlike(op) ? "Euclidean over particles and fields, no energy"
                     : "over particles and fields, velocities weighted as in the energy, no energy";
}

PetscErrorCode MpmOperatorToState(const MpmOperator *op, Vec re, Vec im)
{
  PetscReal norm[2];

  PetscFunctionBegin;
  if (!op->unit) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecPointwiseDivide(re, re, op->unit));
  PetscCall(VecPointwiseDivide(im, im, op->unit));
  PetscCall(VecNorm(re, NORM_2, &norm[0]));
  PetscCall(VecNorm(im, NORM_2, &norm[1]));
  PetscCall(VecScale(re, 1 / hypot(norm[0], norm[1])));
  PetscCall(VecScale(im, 1 / hypot(norm[0], norm[1])));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   ---- the operator of a matrix that was given: of a file, or of a code that was probed ----

   Its units are anybody's, so it is balanced: rows and columns are scaled by powers of two until both have about the
   same size.
*/

/* The abs of the numbers of a matrix, 0 on the diagonal. */
static PetscErrorCode Sizes(Mat A, Mat *sizes)
{
  PetscInt begin, end;

  PetscFunctionBegin;
  PetscCall(MatDuplicate(A, MAT_SHARE_NONZERO_PATTERN, sizes));
  PetscCall(MatGetOwnershipRange(A, &begin, &end));
  for (PetscInt row = begin; row < end; row++) {
    PetscInt           n;
    const PetscInt    *columns;
    const PetscScalar *values;

    PetscCall(MatGetRow(A, row, &n, &columns, &values));
    for (PetscInt i = 0; i < n; i++)
      PetscCall(MatSetValue(*sizes, row, columns[i], columns[i] == row ? 0 : fabs(values[i]), INSERT_VALUES));
    PetscCall(MatRestoreRow(A, row, &n, &columns, &values));
  }
  PetscCall(MatAssemblyBegin(*sizes, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(*sizes, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Finds the diagonal of D: powers of two, so that scaling rounds nothing. With D = diag(d), row i of D A D^-1 has the
   sum r_i = d_i sum_j abs(a_ij) / d_j, and its column the sum c_i = sum_j d_j abs(a_ji) / d_i. In a sweep each d_i is
   multiplied by (c_i / r_i)^(1/4): all are moved at once, and so half as far as one alone would be. change: the largest,
   of the logarithm to base 2.
*/
static PetscErrorCode FindScale(Mat A, Vec d)
{
  const PetscScalar *r, *c;
  PetscReal          change = INFINITY;
  PetscScalar       *scale;
  PetscInt           n;
  Mat                sizes;
  Vec                inverse, rows, columns;

  PetscFunctionBegin;
  PetscCall(Sizes(A, &sizes));
  PetscCall(VecDuplicate(d, &rows));
  PetscCall(VecDuplicate(d, &columns));
  PetscCall(VecGetLocalSize(d, &n));
  PetscCall(VecSet(d, 1));
  for (PetscInt sweep = 0; sweep < SWEEPS && change > CLOSE; sweep++) {
    PetscCall(MpmReciprocals(d, &inverse));
    PetscCall(MatMult(sizes, inverse, rows));
    PetscCall(MatMultTranspose(sizes, d, columns));
    PetscCall(VecDestroy(&inverse));
    PetscCall(VecGetArrayRead(rows, &r));
    PetscCall(VecGetArrayRead(columns, &c));
    PetscCall(VecGetArray(d, &scale));
    change = 0;
    for (PetscInt i = 0; i < n; i++) {
      PetscReal by = c[i] / scale[i] / (r[i] * scale[i]);

      if (!isnormal(by)) continue; /* nothing in the row or in the column, so that no scale balances them */
      by = sqrt(sqrt(by));
      scale[i] *= by;
      change = PetscMax(change, fabs(log2(by)));
    }
    PetscCall(VecRestoreArray(d, &scale));
    PetscCall(VecRestoreArrayRead(rows, &r));
    PetscCall(VecRestoreArrayRead(columns, &c));
    PetscCallMPI(MPI_Allreduce(MPI_IN_PLACE, &change, 1, MPIU_REAL, MPI_MAX, PetscObjectComm((PetscObject)A)));
  }
  PetscCall(VecGetArray(d, &scale));
  for (PetscInt i = 0; i < n; i++) scale[i] = exp2(rint(log2(scale[i])));
  PetscCall(VecRestoreArray(d, &scale));
  PetscCall(VecDestroy(&rows));
  PetscCall(VecDestroy(&columns));
  PetscCall(MatDestroy(&sizes));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode BalanceGiven(MpmOperator *op)
{
  PetscReal before, after;

  PetscFunctionBegin;
  PetscCall(MatCreateVecs(op->A, NULL, &op->unit));
  PetscCall(FindScale(op->A, op->unit));
  PetscCall(Scale(op, op->A, op->unit, &op->balanced));
  PetscCall(MatNorm(op->A, NORM_INFINITY, &before));
  PetscCall(MatNorm(op->balanced, NORM_INFINITY, &after));
  if (GAIN * after < before) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecDestroy(&op->unit));
  PetscCall(MatDestroy(&op->balanced));
  PetscCall(PetscObjectReference((PetscObject)op->A));
  op->balanced = op->A;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmOperatorFromMatrix(Mat A, PetscInt period, MpmOperator **op)
{
  const PetscReal begin = MPI_Wtime();
  MpmOperator    *o;
  PetscBool       shell;

  PetscFunctionBegin;
  PetscCall(PetscNew(op));
  o = *op;
  PetscCall(PetscObjectTypeCompare((PetscObject)A, MATSHELL, &shell));
  PetscCall(PetscObjectReference((PetscObject)A));
  o->A         = A;
  o->fields    = 1;
  o->parts     = 1;
  o->period    = period;
  o->assembled = shell ? PETSC_FALSE : PETSC_TRUE;
  o->nonzeros = o->bytes = NAN;
  PetscCall(MatGetSize(A, &o->order, NULL));
  PetscCall(PetscObjectSetName((PetscObject)A, "A"));
  if (shell) {
    PetscCall(PetscObjectReference((PetscObject)A));
    o->balanced = A;
  } else {
    PetscCall(BalanceGiven(o));
    PetscCall(Count(o));
  }
  o->assemble_s = MPI_Wtime() - begin;
  PetscFunctionReturn(PETSC_SUCCESS);
}
