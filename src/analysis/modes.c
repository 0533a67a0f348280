/*
   Computes wavenumber, polarisation and null-space share of eigenvectors, and those of uniform layouts from the symbol.
*/
#include "analysis/modes.h"
#include "linalg/dense.h"
#include "linalg/small_eigen.h"
#include "program/program.h"
#include "program/maps.h"
#include "scene/layout.h"
#include "symbol/bloch.h"
#include <mpmstab/errors.h>
#include <complex.h> /* before fftw3.h, which then uses C's complex numbers */
#include <fftw3.h>
#include <math.h>
#include <petscksp.h>

#define SEEN 1e-8  /* relative to the mode; a nodal trace below it is rounding */
#define RANK 1e-10 /* singular values below this, relative to the largest, count as 0 */
#define ITERATIONS 2000
#define ALIKE 1e-6 /* relative difference of squares of velocities that may be rounding */

/*
   The work space of the loop over modes. nodes_along: the number of nodes in each direction; half: the number of phases
   of direction 0, which go up to pi alone; vector: the first register of a vector, or MPM_NONE; kept: the Fourier
   components of its nodal trace, for each part of the mode and each component.
*/
typedef struct {
  const MpmOperator *op;
  PetscInt           count, phases, dim, nodes_along[MPM_MAX_DIM], half, vector;
  Mat                transposed; /* P2G transposed */
  KSP                lsqr;
  Vec                x[2], field, rest, nodes, on_first;
  VecScatter         to_first;
  fftw_plan          plan; /* on rank 0 */
  double            *trace;
  fftw_complex      *spectrum, *kept;
} Lens;

PetscInt MpmModesVectorOf(const MpmScheme *scheme)
{
  const MpmTable *table = scheme->table;

  for (PetscInt r = 0; r < table->nstate; r++)
    if (table->field[r] >= 0 && scheme->formulation->particle_ranks[table->field[r]] == MPM_VECTOR) return r;
  return MPM_NONE;
}

/* FFTW's last direction is the one whose nodes follow one another. */
static PetscErrorCode PlanCreate(Lens *l)
{
  int n[MPM_MAX_DIM];

  PetscFunctionBegin;
  for (PetscInt a = 0; a < l->dim; a++) n[l->dim - 1 - a] = (int)l->nodes_along[a];
  l->trace    = fftw_alloc_real((size_t)l->count);
  l->spectrum = fftw_alloc_complex((size_t)l->phases);
  if (l->vector != MPM_NONE) l->kept = fftw_alloc_complex((size_t)(2 * l->dim * l->phases));
  l->plan = fftw_plan_dft_r2c((int)l->dim, n, l->trace, l->spectrum, FFTW_ESTIMATE);
  PetscCheck(l->plan, PETSC_COMM_SELF, PETSC_ERR_LIB, "FFTW has no plan for %" PetscInt_FMT, l->count);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LensCreate(const MpmOperator *op, const MpmEigen *eigen, Lens *l)
{
  PC pc;

  PetscFunctionBegin;
  *l = (Lens){.op = op, .dim = op->layout->dim, .vector = MPM_NONE};
  if (l->dim > 1) l->vector = MpmModesVectorOf(op->scheme); /* in one dimension there is no polarisation */
  PetscCall(MatGetSize(op->p2g, &l->count, NULL));
  for (PetscInt a = 0; a < l->dim; a++) l->nodes_along[a] = op->layout->grid[a].nodes;
  l->half   = l->nodes_along[0] / 2 + 1;
  l->phases = l->count / l->nodes_along[0] * l->half;
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
  if (MpmRankOf(PetscObjectComm((PetscObject)op->p2g)) == 0) PetscCall(PlanCreate(l));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode LensDestroy(Lens *l)
{
  PetscFunctionBegin;
  if (l->plan) fftw_destroy_plan(l->plan);
  fftw_free(l->trace);
  fftw_free(l->spectrum);
  fftw_free(l->kept);
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

/*
   Adds the power of the real nodal trace of a register at each phase, and keeps its components if it is one of the
   vector's. For complex modes it is called for both parts.
*/
static PetscErrorCode AddPower(Lens *l, int part, PetscInt r, PetscReal power[])
{
  const PetscReal *g;

  PetscFunctionBegin;
  PetscCall(VecScatterBegin(l->to_first, l->nodes, l->on_first, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(l->to_first, l->nodes, l->on_first, INSERT_VALUES, SCATTER_FORWARD));
  if (!l->plan) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(VecGetArrayRead(l->on_first, &g));
  PetscCall(PetscArraycpy(l->trace, g, l->count));
  PetscCall(VecRestoreArrayRead(l->on_first, &g));
  fftw_execute(l->plan);
  for (PetscInt m = 0; m < l->phases; m++)
    power[m] += PetscSqr(creal(l->spectrum[m])) + PetscSqr(cimag(l->spectrum[m]));
  if (l->vector != MPM_NONE && r >= l->vector && r < l->vector + l->dim)
    PetscCall(PetscArraycpy(l->kept + (part * l->dim + r - l->vector) * l->phases, l->spectrum, l->phases));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The phase of a Fourier component in each direction: up to pi in the first, and in [0, 2 pi) in the others. */
static void PhaseOf(const Lens *l, PetscInt m, PetscReal beta[])
{
  beta[0] = 2 * PETSC_PI * (m % l->half) / l->nodes_along[0];
  m /= l->half;
  for (PetscInt a = 1; a < l->dim; a++) {
    beta[a] = 2 * PETSC_PI * (m % l->nodes_along[a]) / l->nodes_along[a];
    m /= l->nodes_along[a];
  }
}

/*
   The share of the vector's Fourier component that is along beta. Phases above pi are negative ones. A phase of pi is
   both, and the sign that gives the largest share is taken.
*/
static PetscReal ShareAlong(const Lens *l, PetscInt m, const PetscReal beta[])
{
  PetscReal share = 0;

  for (PetscInt signs = 0; signs < 1 << l->dim; signs++) {
    PetscReal length = 0, along = 0, all = 0;

    for (int part = 0; part < 2; part++) {
      double complex sum = 0;

      length = 0;
      for (PetscInt a = 0; a < l->dim; a++) {
        const double complex v = l->kept[(part * l->dim + a) * l->phases + m];
        const PetscReal      b = beta[a] > PETSC_PI * (1 + SEEN) ? beta[a] - 2 * PETSC_PI : beta[a];
        const PetscBool turn = signs >> a & 1 && fabs(beta[a] - PETSC_PI) <= PETSC_PI * SEEN ? PETSC_TRUE : PETSC_FALSE;

        sum += v * (turn ? -b : b);
        length += b * b;
        all += PetscSqr(cabs(v));
      }
      along += PetscSqr(cabs(sum));
    }
    share = PetscMax(share, length * all > 0 ? along / (length * all) : NAN);
  }
  return share;
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

/* Examines mode j, of norm 1, which is in l->x. */
static PetscErrorCode Look(Lens *l, PetscReal power[], MpmModes *modes, PetscInt j)
{
  PetscReal share = 0, norm, total = 0;
  PetscInt  largest = 0;

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(power, l->phases));
  for (int part = 0; part < 2; part++) {
    for (PetscInt f = 0; f < l->op->fields; f++) {
      PetscCall(VecStrideGather(l->x[part], f, l->field, INSERT_VALUES));
      PetscCall(MatMult(l->op->p2g, l->field, l->nodes));
      PetscCall(AddPower(l, part, f, power));
      PetscCall(NullNorm(l, &norm));
      share += norm * norm;
    }
  }
  modes->null_share[j] = sqrt(share);
  for (PetscInt m = 0; m < l->phases; m++) {
    total += power[m];
    if (power[m] > power[largest] * (1 + SEEN)) largest = m;
  }
  PhaseOf(l, largest, modes->beta + l->dim * j);
  for (PetscInt a = 0; a < l->dim && !(total > SEEN * SEEN * l->count); a++) modes->beta[l->dim * j + a] = NAN;
  modes->p_share[j] = NAN;
  if (l->kept && MpmLayoutIsPeriodic(l->op->layout) && !isnan(modes->beta[l->dim * j]))
    modes->p_share[j] = ShareAlong(l, largest, modes->beta + l->dim * j);
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModesCreate(const MpmOperator *op, const MpmEigen *eigen, PetscInt count, MpmModes *modes)
{
  PetscReal *power;
  Lens       lens;

  PetscFunctionBegin;
  modes->n   = PetscMin(count, eigen->n);
  modes->dim = op->layout->dim;
  PetscCall(PetscMalloc3(modes->dim * modes->n, &modes->beta, modes->n, &modes->p_share, modes->n, &modes->null_share));
  PetscCall(LensCreate(op, eigen, &lens));
  PetscCall(PetscMalloc1(lens.phases, &power));
  for (PetscInt j = 0; j < modes->n; j++) {
    PetscCall(MpmEigenVector(eigen, j, lens.x[0], lens.x[1]));
    PetscCall(MpmOperatorToState(op, lens.x[0], lens.x[1]));
    PetscCall(VecSetBlockSize(lens.x[0], op->fields));
    PetscCall(VecSetBlockSize(lens.x[1], op->fields));
    PetscCall(Look(&lens, power, modes, j));
  }
  PetscCall(PetscFree(power));
  PetscCall(LensDestroy(&lens));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModesVelocities(const MpmOperator *op, const MpmEigen *eigen, PetscReal v[], PetscInt64 *fastest)
{
  const PetscInt   dim = op->layout->dim, vector = MpmModesVectorOf(op->scheme);
  const PetscInt64 n       = op->layout->particles;
  PetscReal        largest = 0;
  const PetscReal *state;
  Vec              x[2], all;
  VecScatter       to_all;

  PetscFunctionBegin;
  *fastest = MPM_NONE;
  if (vector == MPM_NONE || eigen->n < 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MatCreateVecs(eigen->A, &x[0], &x[1]));
  PetscCall(MpmEigenVector(eigen, 0, x[0], x[1]));
  PetscCall(MpmOperatorToState(op, x[0], x[1]));
  PetscCall(VecScatterCreateToAll(x[0], &to_all, &all));
  PetscCall(VecScatterBegin(to_all, x[0], all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecScatterEnd(to_all, x[0], all, INSERT_VALUES, SCATTER_FORWARD));
  PetscCall(VecGetArrayRead(all, &state));
  for (PetscInt64 id = 0; id < n; id++) {
    PetscReal square = 0;

    for (PetscInt a = 0; a < dim; a++) {
      v[a * n + id] = state[id * op->fields + vector + a];
      square += PetscSqr(v[a * n + id]);
    }
    if (!(square > largest * (1 + ALIKE))) continue;
    largest  = square;
    *fastest = id;
  }
  for (PetscInt64 i = 0; i < dim * n; i++) v[i] /= sqrt(largest);
  PetscCall(VecRestoreArrayRead(all, &state));
  PetscCall(VecScatterDestroy(&to_all));
  PetscCall(VecDestroy(&all));
  PetscCall(VecDestroy(&x[0]));
  PetscCall(VecDestroy(&x[1]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModesDestroy(MpmModes *modes)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(modes->beta, modes->p_share, modes->null_share));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Whether an operation is an earlier one again, as the second P2G of musl. */
static PetscBool IsRepeated(const MpmTable *table, PetscInt o)
{
  const MpmOp *op = &table->ops[o];

  for (const MpmOp *before = table->ops; before < op; before++)
    if (before->kind == op->kind && before->axis == op->axis && before->dst == op->dst && before->src == op->src)
      return PETSC_TRUE;
  return PETSC_FALSE;
}

/*
   Makes the map of all components of a field, registers [first, first + n), to the nodes: the program of the sums that
   read them. It is NULL where no node feels the field. That is so too where all factors are 0, as of the stress of an
   isothermal gas that is stretched: in one dimension its force does not depend on the stretch.
*/
static PetscErrorCode MapOfField(MpmMaps *maps, PetscInt first, PetscInt n, Mat *map)
{
  const MpmTable *table = maps->slab->scheme->table;
  MpmRegisters    r;
  MpmStepProgram *program;

  PetscFunctionBegin;
  PetscCall(MpmRegistersOf(maps->slab, &r));
  r.nin  = n;
  r.nout = 0;
  for (PetscInt i = 0; i < n; i++) r.in[i] = first + i;
  PetscCall(MpmStepProgramCreate(&r, 1, &program));
  for (PetscInt o = 0; o < table->nops; o++) {
    const MpmOp      *op     = &table->ops[o];
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
    MpmLine           line = {.dst = r.n[0] + op->dst, .src = op->src, .factor = op->factor, .accumulates = PETSC_TRUE};
    PetscInt          out  = 0;

    if (traits.dst != MPM_ON_NODES || traits.src != MPM_ON_PARTICLES || op->src < first || op->src >= first + n)
      continue;
    if (op->factor == 0 || IsRepeated(table, o)) continue;
    PetscCall(MpmMapsGet(maps, op, &line.map));
    PetscCall(MpmStepProgramAppend(program, line));
    while (out < r.nout && r.out[out] != line.dst) out++;
    r.out[out] = line.dst;
    r.nout     = PetscMax(r.nout, out + 1);
  }
  program->registers = r;
  *map               = NULL;
  if (r.nout) PetscCall(MpmStepProgramAssemble(program, PETSC_FALSE, map));
  PetscCall(MpmStepProgramDestroy(&program));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmModesNullity(const MpmOperator *op, PetscInt *nullity)
{
  const MpmTable *table = op->scheme->table;
  MpmSlab         slab;
  MpmMaps         maps = {.slab = &slab};

  PetscFunctionBegin;
  *nullity = 0;
  PetscCall(MpmSlabOf(PetscObjectComm((PetscObject)op->A), op->layout, op->scheme, &op->step, &slab));
  for (PetscInt f = 0, n; f < table->nstate; f += n) {
    PetscInt unseen = 0;
    Mat      map;

    n = 1;
    while (f + n < table->nstate && table->field[f] != MPM_NONE && table->field[f + n] == table->field[f]) n++;
    if (table->filtered[f]) continue;
    PetscCall(MapOfField(&maps, f, n, &map));
    if (map)
      PetscCall(MpmDenseNullity(map, RANK, &unseen));
    else
      unseen = n * (PetscInt)op->layout->particles;
    PetscCall(MatDestroy(&map));
    *nullity += unseen;
  }
  PetscCall(MpmMapsDestroy(&maps));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- Bloch modes ---- */

/*
   Where the layout is uniform, eigenvectors of the operator are Bloch modes. They need no factorisation: the symbol
   says which are leading, and a product with the operator says whether they are eigenvectors of it.
*/
#define MODES (MPM_BLOCH_VECTORS / 2)

/* The cell of a particle of a scene, and its site in it. */
static void AtOfLayout(const void *of, PetscInt64 id, PetscInt64 cell[], PetscInt *site)
{
  const MpmLayout *layout = of;

  MpmLayoutSites(layout, id, cell);
  *site = 0;
  for (PetscInt a = layout->dim - 1; a >= 0; a--) {
    *site = *site * layout->ppc[a] + (PetscInt)(cell[a] % layout->ppc[a]);
    cell[a] /= layout->ppc[a];
  }
}

/* Fills a state, real and imaginary part, with a Bloch mode. q: the numbers of the cell at the origin. */
static PetscErrorCode Fill(const MpmBlochCells *c, PetscInt dim, const PetscReal beta[], const double complex q[],
                           Vec mode[2])
{
  PetscInt   begin, end;
  PetscReal *x[2];

  PetscFunctionBegin;
  PetscCall(VecGetOwnershipRange(mode[0], &begin, &end));
  for (int part = 0; part < 2; part++) PetscCall(VecGetArrayWrite(mode[part], &x[part]));
  for (PetscInt64 id = begin / c->fields; id < end / c->fields; id++) {
    PetscInt64 cell[MPM_MAX_DIM];
    PetscInt   j;
    PetscReal  angle = 0;

    c->at(c->of, id, cell, &j);
    for (PetscInt a = 0; a < dim; a++) angle += beta[a] * (PetscReal)cell[a];
    for (PetscInt f = 0; f < c->fields; f++) {
      const double complex value = cexp(I * angle) * q[c->fields * j + f];

      x[0][c->fields * id + f - begin] = creal(value);
      x[1][c->fields * id + f - begin] = cimag(value);
    }
  }
  for (int part = 0; part < 2; part++) PetscCall(VecRestoreArrayWrite(mode[part], &x[part]));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/*
   The eigenvector of a phase's matrix for a factor; the same on every rank. bloch: NULL where the cells have a source.
*/
static PetscErrorCode Vector(MPI_Comm comm, MpmBloch *bloch, const MpmBlochCells *cells, const MpmSymbol *s,
                             const MpmSymbolFactor *c, const PetscReal beta[], MpmSmallEigen *small, PetscInt *nearest)
{
  PetscMPIInt count;
  PetscInt    exponent;

  PetscFunctionBegin;
  if (bloch)
    PetscCall(MpmBlochMatrices(bloch, 1, &s->step.courant, beta, PETSC_FALSE, small->matrix, &exponent));
  else
    PetscCall(MpmSourceMatrix(&cells->source, beta, small->matrix, &exponent));
  PetscCall(MpmSmallEigenSolve(small, PETSC_TRUE));
  PetscCall(PetscMPIIntCast(2 * (PetscInt64)s->size * s->size, &count));
  PetscCallMPI(MPI_Bcast(small->right, count, MPI_DOUBLE, 0, comm));
  PetscCallMPI(MPI_Bcast(small->value, (PetscMPIInt)(2 * s->size), MPI_DOUBLE, 0, comm));
  *nearest = 0;
  for (PetscInt j = 1; j < s->size; j++) {
    const double complex sought = (c->re + I * c->im) * scalbn(1, -(int)exponent);

    if (cabs(small->value[j] - sought) < cabs(small->value[*nearest] - sought)) *nearest = j;
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochModesCreate(const MpmOperator *op, const MpmSymbol *s, const MpmBlochCells *cells, PetscInt *n,
                                   Vec **vectors)
{
  const MPI_Comm  comm   = PetscObjectComm((PetscObject)op->A);
  MpmBlochCells   layout = {.fields = op->fields, .of = op->layout, .at = AtOfLayout};
  MpmSymbolFactor best[MODES];
  MpmBloch        bloch;
  MpmSmallEigen   small;
  Vec             x;

  PetscFunctionBegin;
  PetscCall(MpmSymbolLeading(comm, s, 0, MODES, best));
  *n = 0;
  while (*n < 2 * MODES && best[*n / 2].size >= 0) *n += 2;
  PetscCall(MatCreateVecs(op->A, &x, NULL));
  PetscCall(VecDuplicateVecs(x, MPM_BLOCH_VECTORS, vectors));
  PetscCall(VecDestroy(&x));
  if (!cells) PetscCall(MpmBlochCreate(op->layout, op->scheme, s->step.drift, &bloch));
  PetscCall(MpmSmallEigenCreate(s->size, &small));
  for (PetscInt m = 0; m < *n / 2; m++) {
    PetscReal beta[MPM_MAX_DIM];
    PetscInt  j = 0;

    MpmSymbolBeta(s, (PetscInt)best[m].phase, beta);
    PetscCall(Vector(comm, cells ? NULL : &bloch, cells, s, &best[m], beta, &small, &j));
    PetscCall(Fill(cells ? cells : &layout, s->dim, beta, small.right + j * s->size, *vectors + 2 * m));
    for (int part = 0; part < 2 && cells && op->unit; part++)
      PetscCall(VecPointwiseMult((*vectors)[2 * m + part], (*vectors)[2 * m + part], op->unit));
  }
  PetscCall(MpmSmallEigenDestroy(&small));
  if (!cells) PetscCall(MpmBlochDestroy(&bloch));
  PetscFunctionReturn(PETSC_SUCCESS);
}
