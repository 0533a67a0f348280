/* Computes wavenumber and null-space share of eigenvectors. */
#include "operator/assemble.h"
#include "analysis/modes.h"
#include <complex.h> /* before fftw3.h, which then uses C's complex numbers */
#include <fftw3.h>
#include <math.h>
#include <slepcsvd.h>

#define SEEN 1e-8  /* relative to the mode; a nodal trace below it is rounding */
#define RANK 1e-10 /* singular values below this, relative to the largest, count as 0 */
#define ITERATIONS 2000

/* The work space of the loop over modes. */
typedef struct {
  const MpmOperator *op;
  PetscInt           cells;
  Mat                transposed; /* P2G transposed */
  KSP                lsqr;
  Vec                x[2], field, rest, nodes, on_first;
  VecScatter         to_first;
  fftw_plan          plan; /* on rank 0 */
  double            *trace;
  fftw_complex      *spectrum;
} Lens;

static PetscErrorCode LensCreate(const MpmOperator *op, const MpmEigen *eigen, Lens *l)
{
  PetscMPIInt rank;
  PC          pc;

  PetscFunctionBegin;
  *l = (Lens){.op = op};
  PetscCall(MatGetSize(op->p2g, &l->cells, NULL));
  PetscCall(MatCreateVecs(eigen->A, &l->x[0], &l->x[1]));
  PetscCall(MatCreateVecs(op->p2g, &l->field, &l->nodes));
  PetscCall(VecDuplicate(l->field, &l->rest));
  PetscCall(VecScatterCreateToZero(l->nodes, &l->to_first, &l->on_first));
  PetscCall(MatTranspose(op->p2g, MAT_INITIAL_MATRIX, &l->transposed));
  PetscCall(KSPCreate(PetscObjectComm((PetscObject)op->p2g), &l->lsqr));
  PetscCall(KSPSetOperators(l->lsqr, l->transposed, l->transposed));
  PetscCall(KSPSetType(l->lsqr, KSPLSQR));
  PetscCall(KSPGetPC(l->lsqr, &pc));
  PetscCall(PCSetType(pc, PCNONE));
  PetscCall(KSPSetTolerances(l->lsqr, 1e-10, 1e-14, PETSC_CURRENT, ITERATIONS));
  PetscCallMPI(MPI_Comm_rank(PetscObjectComm((PetscObject)op->p2g), &rank));
  if (rank == 0) {
    l->trace    = fftw_alloc_real((size_t)l->cells);
    l->spectrum = fftw_alloc_complex((size_t)l->cells / 2 + 1);
    l->plan     = fftw_plan_dft_r2c_1d((int)l->cells, l->trace, l->spectrum, FFTW_ESTIMATE);
    PetscCheck(l->plan, PETSC_COMM_SELF, PETSC_ERR_LIB, "FFTW has no plan for %" PetscInt_FMT, l->cells);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LensDestroy(Lens *l)
{
  PetscFunctionBegin;
  if (l->plan) fftw_destroy_plan(l->plan);
  fftw_free(l->trace);
  fftw_free(l->spectrum);
  PetscCall(VecScatterDestroy(&l->to_first));
  PetscCall(VecDestroy(&l->on_first));
  PetscCall(VecDestroy(&l->nodes));
  PetscCall(VecDestroy(&l->field));
  PetscCall(VecDestroy(&l->rest));
  PetscCall(VecDestroy(&l->x[0]));
  PetscCall(VecDestroy(&l->x[1]));
  PetscCall(KSPDestroy(&l->lsqr));
  PetscCall(MatDestroy(&l->transposed));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds the power of the real nodal trace at each phase 0 .. cells/2. For complex modes it is called for both parts. */
static PetscErrorCode AddPower(Lens *l, PetscReal power[])
{
  const PetscReal *g;

  PetscFunctionBegin;
  PetscCall(VecScatterBegin(l->to_first, l->nodes, l->on_first, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(l->to_first, l->nodes, l->on_first, INSERT_VALUES, SCATTER_FORWARD));
  if (!l->plan) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(l->on_first, &g));
  PetscCall(PetscArraycpy(l->trace, g, l->cells));
  PetscCall(VecRestoreArrayRead(l->on_first, &g));
  fftw_execute(l->plan);
  for (PetscInt m = 0; m <= l->cells / 2; m++)
    power[m] += PetscSqr(creal(l->spectrum[m])) + PetscSqr(cimag(l->spectrum[m]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   Computes the norm of a field's part in the null space of P2G: it is the residual of the field's least-squares fit by
   P2G^T z.
*/
static PetscErrorCode NullNorm(Lens *l, PetscReal *norm)
{
  PetscReal          whole;
  KSPConvergedReason reason;

  PetscFunctionBegin;
  PetscCall(VecNorm(l->field, NORM_2, &whole));
  *norm = 0;
  if (whole == 0) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(KSPSolve(l->lsqr, l->field, l->nodes));
  PetscCall(KSPGetConvergedReason(l->lsqr, &reason));
  PetscCall(MatMult(l->transposed, l->nodes, l->rest));
  PetscCall(VecAXPY(l->rest, -1, l->field));
  PetscCall(VecNorm(l->rest, NORM_2, norm));
  if (reason < 0) *norm = NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Examines one mode of norm 1, which is in l->x. */
static PetscErrorCode Look(Lens *l, PetscReal power[], PetscReal *beta, PetscReal *null_share)
{
  PetscReal share = 0, norm, total = 0;
  PetscInt  largest = 0;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(power, l->cells / 2 + 1));
  for (int part = 0; part < 2; part++) {
    for (PetscInt f = 0; f < l->op->fields; f++) {
      PetscCall(VecStrideGather(l->x[part], f, l->field, INSERT_VALUES));
      PetscCall(MatMult(l->op->p2g, l->field, l->nodes));
      PetscCall(AddPower(l, power));
      PetscCall(NullNorm(l, &norm));
      share += norm * norm;
    }
  }
  *null_share = sqrt(share);
  for (PetscInt m = 0; m <= l->cells / 2; m++) {
    total += power[m];
    if (power[m] > power[largest] * (1 + SEEN)) largest = m;
  }
  *beta = total > SEEN * SEEN * l->cells ? 2 * PETSC_PI * largest / l->cells : NAN;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModesCreate(const MpmOperator *op, const MpmEigen *eigen, MpmModes *modes)
{
  PetscReal *power;
  Lens       lens;

  PetscFunctionBegin;
  modes->n = eigen->n;
  PetscCall(PetscMalloc2(eigen->n, &modes->beta, eigen->n, &modes->null_share));
  PetscCall(LensCreate(op, eigen, &lens));
  PetscCall(PetscMalloc1(lens.cells / 2 + 1, &power));
  for (PetscInt j = 0; j < eigen->n; j++) {
    PetscCall(MpmEigenVector(eigen, j, lens.x[0], lens.x[1]));
    PetscCall(MpmOperatorToState(op, lens.x[0], lens.x[1]));
    PetscCall(VecSetBlockSize(lens.x[0], op->fields));
    PetscCall(VecSetBlockSize(lens.x[1], op->fields));
    PetscCall(Look(&lens, power, &modes->beta[j], &modes->null_share[j]));
  }
  PetscCall(PetscFree(power));
  PetscCall(LensDestroy(&lens));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModesDestroy(MpmModes *modes)
{
  PetscFunctionBegin;
  PetscCall(PetscFree2(modes->beta, modes->null_share));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The nullity of a map is its number of columns minus its rank. */
static PetscErrorCode Nullity(Mat map, PetscInt *nullity)
{
  PetscInt  found, rank    = 0, columns;
  PetscReal sigma, largest = 0;
  SVD       svd;

  PetscFunctionBegin;
  PetscCall(MatGetSize(map, NULL, &columns));
  PetscCall(SVDCreate(PetscObjectComm((PetscObject)map), &svd));
  PetscCall(SVDSetOperators(svd, map, NULL));
  PetscCall(SVDSetType(svd, SVDLAPACK));
  PetscCall(SVDSolve(svd));
  PetscCall(SVDGetConverged(svd, &found));
  for (PetscInt i = 0; i < found; i++) {
    PetscCall(SVDGetSingularTriplet(svd, i, &sigma, NULL, NULL));
    largest = PetscMax(largest, sigma);
    if (sigma > RANK * largest) rank++;
  }
  PetscCall(SVDDestroy(&svd));
  *nullity = columns - rank;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModesNullity(const MpmOperator *op, PetscInt *nullity)
{
  const MpmTable *table = op->scheme->table;
  MpmRegisters    registers;
  PetscInt        unseen = 0;
  Mat             map;

  PetscFunctionBegin;
  *nullity = 0;
  PetscCall(MpmRegistersCreate(PetscObjectComm((PetscObject)op->A), op->layout, op->scheme, &op->step, &registers));
  for (PetscInt f = 0; f < table->nstate; f++) {
    const MpmOp *seen = MpmTableSeenBy(table, f);

    if (table->filtered[f]) continue;
    if (!seen) { /* no node feels any of this field */
      *nullity += (PetscInt)op->layout->particles;
      continue;
    }
    PetscCall(MpmRegistersMap(&registers, seen->kind, seen->axis, table->parity[seen->dst], 0, &map));
    PetscCall(Nullity(map, &unseen));
    PetscCall(MatDestroy(&map));
    *nullity += unseen;
  }
  PetscCall(MpmRegistersDestroy(&registers));
  PetscFunctionReturn(PETSC_SUCCESS);
}
