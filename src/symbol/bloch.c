/*
   The program of a table on rows of one Bloch mode. On the mode

     q_p = e^(i beta.n) q^_j    (particle j of cell n),    g_i = e^(i beta.i) g^

   the map of an operation is a product of small matrices:

     particle -> node       g^  = a sum_j sum_d phi_jd e^(-i beta.d) q^_j / mass
     node -> particle       q^_j += a sum_d phi_jd e^(i beta.d) g^
     node -> node           g^  = a sum_s stencil_s e^(i beta_a s) f^    (a: the axis of the operation)

   d is the place of the node relative to the cell's node. DIV and GRAD have h dphi/dx for phi. SOLVE divides f^ by the
   symbol of P2G G2P. In more dimensions the sum over d is a product of sums along the directions.
*/
#include "base/hash.h"
#include "base/power_of_two.h"
#include "linalg/lapack_names.h"
#include "symbol/bloch.h"
#include <mpmstab/verdict.h>
#include <math.h>

#define KINDS MPM_OP_KINDS
#define SINGULAR 1e-12        /* a symbol of P2G G2P below this is taken for 0 */
#define RESCALE_AT 200        /* powers of two */
#define BLOCK MPM_BLOCH_LANES /* numbers that are added at once; rows are filled up with zeros to a multiple of it */

/* The symbols of the maps along a direction at the first steps of a period. They stay while the phase does. */
static void SetPhase(MpmBloch *b, PetscInt a, PetscReal beta, PetscInt steps)
{
  const MpmTies *ties = &b->ties[a];

  if (b->beta[a] != beta) {
    b->beta[a]  = beta;
    b->known[a] = 0;
    MpmTiesWave(ties, beta, b->wave[a]);
  }
  for (; b->known[a] < PetscMin(steps, ties->period); b->known[a]++)
    for (PetscInt kind = 0; kind < KINDS; kind++) {
      if (!b->used[kind]) continue;
      for (PetscInt j = 0; j < ties->n; j++)
        b->tie[a][(kind * ties->period + b->known[a]) * ties->n + j] =
            MpmTie(ties, b->known[a], (MpmOpKind)kind, j, b->wave[a]);
    }
}

void MpmBlochSetStep(MpmBloch *b, PetscInt step)
{
  b->mass = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    const MpmTies *ties = &b->ties[a];
    const PetscInt at   = step % ties->period;

    b->mass *= ties->masses[at];
    b->now[a] = b->tie[a] + at * ties->n;
  }
}

double complex MpmBlochTie(const MpmBloch *b, const MpmOp *op, PetscInt j, const PetscBool along[])
{
  const PetscInt *ppc     = b->layout->ppc;
  double complex  product = 1;

  if (b->layout->dim == 1 && !along) return b->now[0][op->kind * b->ties[0].period * ppc[0] + j];
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    if (!along || along[a])
      product *= b->now[a][MpmKindAlong(op->kind, op->axis, a) * b->ties[a].period * ppc[a] + j % ppc[a]];
    j /= ppc[a];
  }
  return product;
}

/* A factor for each number of a block: of every lane, or the same for a block of columns. */
typedef struct {
  PetscReal re[BLOCK], im[BLOCK];
} Factor;

static inline Factor Times(const PetscReal a[BLOCK], double complex z)
{
  Factor f;

  for (PetscInt i = 0; i < BLOCK; i++) {
    f.re[i] = a[i] * creal(z);
    f.im[i] = a[i] * cimag(z);
  }
  return f;
}

/*
   dst += factor src, for rows of n numbers: first their real parts, then their imaginary ones. n is a multiple of
   BLOCK.
*/
static inline void AddRow(PetscInt n, const Factor *f, const PetscReal *restrict src, PetscReal *restrict dst)
{
  for (PetscInt c = 0; c < n; c += BLOCK)
    for (PetscInt i = 0; i < BLOCK; i++) {
      const PetscReal re = f->re[i] * src[c + i] - f->im[i] * src[n + c + i],
                      im = f->re[i] * src[n + c + i] + f->im[i] * src[c + i];

      dst[c + i] += re;
      dst[n + c + i] += im;
    }
}

static inline void ScaleRows(PetscInt n, const PetscReal factor[BLOCK], PetscReal row[])
{
  for (PetscInt c = 0; c < 2 * n; c += BLOCK)
    for (PetscInt i = 0; i < BLOCK; i++) row[c + i] *= factor[i];
}

static double complex Stencil(const MpmOpTraits *traits, PetscReal beta)
{
  double complex sum = 0;

  for (PetscInt s = -1; s <= 1; s++) sum += traits->stencil[s + 1] * cexp(I * (beta * s));
  return sum;
}

/* The inverse of the symbol of P2G G2P; 0 where that is 0. */
static PetscReal Inverse(const MpmBloch *b)
{
  const MpmOp phi   = {.kind = MPM_G2P};
  PetscReal   alpha = 0;

  for (PetscInt j = 0; j < b->ppc; j++) {
    const double complex tie = MpmBlochTie(b, &phi, j, NULL);

    alpha += (creal(tie) * creal(tie) + cimag(tie) * cimag(tie)) / b->mass;
  }
  return alpha > SINGULAR ? 1 / alpha : 0;
}

double complex MpmBlochOfNodes(const MpmBloch *b, const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  return op->kind == MPM_SOLVE ? Inverse(b) : Stencil(&traits, b->beta[op->axis]);
}

void MpmBlochSetPhase(MpmBloch *b, const PetscReal beta[])
{
  for (PetscInt a = 0; a < b->layout->dim; a++) SetPhase(b, a, beta[a], 1);
  MpmBlochSetStep(b, 0);
}

typedef double complex Small[MPM_MAX_DIM][MPM_MAX_DIM];

/* The lines of a table of K are gathers to scratch, and then sums of scratch. */
static void Stiffness(const MpmBloch *b, const MpmTable *k, Small K)
{
  for (PetscInt c = 0; c < k->dim; c++)
    for (PetscInt a = 0; a < k->dim; a++) K[c][a] = 0;
  for (const MpmOp *grad = k->ops; grad < k->ops + k->nops; grad++)
    for (const MpmOp *div = grad + 1; div < k->ops + k->nops && MpmOpIsGather(grad); div++) {
      const MpmOpTraits traits = MpmOpTraitsOf(div->kind);

      if (traits.src != MPM_ON_PARTICLES || traits.dst != MPM_ON_NODES || div->src != grad->dst) continue;
      for (PetscInt j = 0; j < b->ppc; j++)
        K[div->dst - k->image][grad->src - k->solved] +=
            div->factor * grad->factor / b->mass * conj(MpmBlochTie(b, div, j, NULL)) * MpmBlochTie(b, grad, j, NULL);
    }
}

/* The inverse of 1 + a K, by LAPACK's elimination; the transposes of both, by columns, are these by rows. */
static void Invert(PetscInt n, Small K, PetscReal a, Small inverse)
{
  const PetscBLASInt order = (PetscBLASInt)n, rows = MPM_MAX_DIM;
  PetscBLASInt       pivot[MPM_MAX_DIM], info;
  Small              A;

  for (PetscInt i = 0; i < n; i++)
    for (PetscInt j = 0; j < n; j++) {
      A[i][j]       = (i == j) + a * K[i][j];
      inverse[i][j] = i == j;
    }
  MPM_ZGESV(&order, &order, A[0], &rows, pivot, inverse[0], &rows, &info);
}

/*
   IMPLICIT: the vector of a node becomes (1 + a K)^-1 times it, with a number a for each lane. K is a matrix of dim x
   dim at each phase:

     K_ca = the sum over GRAD of component a to a stress, and DIV of this stress to component c, of their symbols'
     product
*/
static void Implicit(MpmBloch *b, const MpmOp *op, const PetscReal a[])
{
  const MpmTable *k = MpmTableStiffness(b->scheme->table, op);
  const PetscInt  n = k->dim, width = b->width;
  Small           K, inverse[MPM_BLOCH_LANES];
  PetscReal      *row[MPM_MAX_DIM];

  Stiffness(b, k, K);
  for (PetscInt lane = 0; lane < b->lanes; lane++) Invert(n, K, a[lane], inverse[lane]);
  for (PetscInt c = 0; c < n; c++) row[c] = MpmBlochRow(b, op->dst + c);
  for (PetscInt i = 0; i < width; i++) {
    double complex sum[MPM_MAX_DIM] = {0};

    for (PetscInt c = 0; c < n; c++)
      for (PetscInt d = 0; d < n; d++) sum[c] += inverse[i % b->lanes][c][d] * CMPLX(row[d][i], row[d][width + i]);
    for (PetscInt c = 0; c < n; c++) {
      row[c][i]         = creal(sum[c]);
      row[c][width + i] = cimag(sum[c]);
    }
  }
}

/* ---- the algebra of rows, in the present step ---- */

/* The factors of a line in each lane. */
static const PetscReal *Values(const MpmBloch *b, const MpmLine *line)
{
  return b->values + (line - b->program->line) * BLOCK;
}

/* The rows of a register, and how many numbers they have, real or imaginary. */
static PetscReal *Register(const MpmBloch *b, PetscInt reg, PetscInt *n)
{
  const PetscInt particles = b->program->registers.n[0];

  *n = reg < particles ? b->ppc * b->width : b->width;
  return reg < particles ? MpmBlochRows(b, reg) : MpmBlochRow(b, reg - particles);
}

static PetscErrorCode Zero(void *mode, PetscInt dst)
{
  PetscInt   n;
  PetscReal *rows = Register(mode, dst, &n);

  PetscFunctionBegin;
  PetscCall(PetscArrayzero(rows, 2 * n));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Scale(void *mode, const MpmLine *line)
{
  PetscInt   n;
  PetscReal *rows = Register(mode, line->dst, &n);

  PetscFunctionBegin;
  ScaleRows(n, Values(mode, line), rows);
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Add(void *mode, const MpmLine *line, PetscBool back)
{
  const MpmBloch  *b = mode;
  const PetscReal *a = Values(b, line);
  const PetscInt   n = b->width, to = MpmRegisterPlace(&b->program->registers, line->dst);
  PetscInt         numbers;
  PetscReal       *src = Register(b, line->src, &numbers), *dst = Register(b, line->dst, &numbers), share[BLOCK];
  Factor           f;

  PetscFunctionBegin;
  PetscCheck(!back, PETSC_COMM_SELF, PETSC_ERR_SUP, "a program runs backwards on vectors alone");
  if (to != MpmRegisterPlace(&b->program->registers, line->src)) {
    for (PetscInt i = 0; i < BLOCK; i++) share[i] = to ? a[i] / b->mass : a[i];
    for (PetscInt j = 0; j < b->ppc; j++) {
      const double complex tie = MpmBlochTie(b, line->op, j, NULL);

      f = Times(share, to ? conj(tie) : tie);
      AddRow(n, &f, src + (to ? 2 * j * n : 0), dst + (to ? 0 : 2 * j * n));
    }
  } else if (!line->op && dst == src) {
    for (PetscInt i = 0; i < BLOCK; i++) share[i] = 1 + a[i];
    ScaleRows(numbers, share, dst);
  } else {
    f = Times(a, line->op ? MpmBlochOfNodes(b, line->op) : 1);
    AddRow(numbers, &f, src, dst);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode Solve(void *mode, const MpmLine *line, PetscBool back)
{
  PetscFunctionBegin;
  PetscCheck(!back, PETSC_COMM_SELF, PETSC_ERR_SUP, "a program runs backwards on vectors alone");
  Implicit(mode, line->op, Values(mode, line));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const MpmAlgebra row_algebra = {.zero = Zero, .scale = Scale, .add = Add, .solve = Solve};

/* ---- steps ---- */

/* The largest abs in each lane, of n numbers. */
static void Largest(PetscInt n, const PetscReal number[], PetscReal most[BLOCK])
{
  for (PetscInt i = 0; i < n; i += BLOCK)
    for (PetscInt j = 0; j < BLOCK; j++) {
      const PetscReal size = fabs(number[i + j]);

      most[j] = size < most[j] ? most[j] : size;
    }
}

/*
   Divides the state's registers, and n numbers beside them, by a power of two, in each lane, when they would leave the
   range of doubles. Adds to the exponents of the lanes.
*/
static void Rescale(MpmBloch *b, PetscInt n, PetscReal beside[], PetscInt exponent[])
{
  const PetscInt numbers     = 2 * b->size * b->width;
  PetscReal      most[BLOCK] = {0};

  Largest(numbers, b->particle, most);
  Largest(n, beside, most);
  for (PetscInt lane = 0; lane < b->lanes; lane++) {
    PetscReal largest = 0;
    PetscInt  shift;

    for (PetscInt j = lane; j < BLOCK; j += b->lanes) largest = PetscMax(largest, most[j]);
    shift = MpmPowerToTakeOut(largest, RESCALE_AT);
    for (PetscInt i = lane; i < numbers && shift; i += b->lanes) b->particle[i] = scalbn(b->particle[i], -(int)shift);
    for (PetscInt i = lane; i < n && shift; i += b->lanes) beside[i] = scalbn(beside[i], -(int)shift);
    exponent[lane] += shift;
  }
}

/* Moves every number by up to MPM_ROUNDING, relative: the same at any phase, in any lane and on any rank. */
static void Disturb(MpmBloch *b, PetscInt step)
{
  const PetscInt n = b->size, lanes = b->lanes;

  for (PetscInt row = 0; row < n; row++) {
    PetscReal *re = b->particle + 2 * row * b->width, *im = re + b->width;

    for (PetscInt c = 0; c < n; c++) {
      const PetscReal factor = 1 + MPM_ROUNDING * (2 * MpmHash(step, row * n + c) - 1);

      for (PetscInt i = c * lanes; i < (c + 1) * lanes; i++) {
        re[i] *= factor;
        im[i] *= factor;
      }
    }
  }
}

PetscErrorCode MpmBlochBegin(MpmBloch *b, PetscInt n, const PetscReal courant[], const PetscReal beta[], PetscInt steps,
                             PetscInt columns)
{
  const MpmStepProgram *p = b->program;

  PetscFunctionBegin;
  b->lanes = n == 1 ? 1 : MPM_BLOCH_LANES;
  b->width = MpmBlochFullWidth(columns * b->lanes);
  for (PetscInt a = 0; a < b->layout->dim; a++) SetPhase(b, a, beta[a], steps);
  for (PetscInt l = 0; l < p->n; l++)
    for (PetscInt i = 0; i < BLOCK; i++)
      b->values[l * BLOCK + i] = i < n ? MpmLineValue(&p->line[l], courant[i]) : b->values[l * BLOCK + n - 1];
  PetscCall(PetscArrayzero(b->particle, 2 * p->registers.n[0] * b->ppc * b->width));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds to the rows of what nodes give in a step what a line is the first to read. */
static void Note(const MpmBloch *b, const MpmTaken *taken, const MpmLine *line, PetscReal numbers[])
{
  PetscReal one[BLOCK];

  for (PetscInt i = 0; i < BLOCK; i++) one[i] = 1;
  for (PetscInt g = 0; g < taken->ngifts; g++) {
    const MpmTakenGift *gift = &taken->gift[g];
    const Factor        f    = Times(one, gift->times);

    if (line->op == b->scheme->table->ops + gift->at)
      AddRow(b->width, &f, MpmBlochRow(b, gift->src), numbers + gift->number * 2 * b->width);
  }
}

PetscErrorCode MpmBlochRunStep(MpmBloch *b, PetscInt step, const MpmTaken *taken, PetscReal numbers[])
{
  PetscFunctionBegin;
  MpmBlochSetStep(b, step);
  for (PetscInt l = 0; l < b->program->n; l++) {
    if (taken) Note(b, taken, &b->program->line[l], numbers);
    PetscCall(MpmLineRun(&b->program->line[l], &row_algebra, b, PETSC_FALSE));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochStep(MpmBloch *b, PetscReal courant, const PetscReal beta[], PetscInt step,
                            double complex state[])
{
  PetscFunctionBegin;
  PetscCall(MpmBlochBegin(b, 1, &courant, beta, step + 1, 1));
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < b->ppc; j++) {
      MpmBlochRows(b, field)[2 * j * b->width]       = creal(state[b->fields * j + field]);
      MpmBlochRows(b, field)[(2 * j + 1) * b->width] = cimag(state[b->fields * j + field]);
    }
  PetscCall(MpmBlochRunStep(b, step, NULL, NULL));
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < b->ppc; j++)
      state[b->fields * j + field] =
          CMPLX(MpmBlochRows(b, field)[2 * j * b->width], MpmBlochRows(b, field)[(2 * j + 1) * b->width]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Sets number c of a row to a number, in all lanes. */
static inline void SetAll(const MpmBloch *b, PetscReal row[], PetscInt c, PetscReal number)
{
  for (PetscInt lane = 0; lane < b->lanes; lane++) row[c * b->lanes + lane] = number;
}

/* Number c of a row, in a lane. */
static inline double complex At(const MpmBloch *b, const PetscReal row[], PetscInt c, PetscInt lane)
{
  return CMPLX(row[c * b->lanes + lane], row[b->width + c * b->lanes + lane]);
}

double complex MpmBlochPhaseBeyond(const MpmBloch *b, const PetscReal beta[], PetscInt j)
{
  PetscReal angle = 0;

  for (PetscInt a = 0; a < b->layout->dim; a++) angle -= beta[a] * (PetscReal)b->beyond[j][a];
  return angle == 0 ? 1 : cexp(I * angle);
}

/*
   Sets the registers at the start of a turn. The nodes gave their numbers at the step before, when particles stood as
   at the last step of a turn, but for the places that they have taken since.
*/
static void SpreadTaken(MpmBloch *b, const PetscReal beta[], PetscInt n, const PetscReal courant[])
{
  const MpmTaken *t = b->taken;

  MpmBlochSetStep(b, b->turn - 1);
  for (PetscInt j = 0; j < b->ppc; j++) {
    const double complex wave = MpmBlochPhaseBeyond(b, beta, j);

    for (PetscInt y = 0; y < t->numbers; y++) {
      const MpmTakenGift *gift = &t->gift[t->first[y]];

      for (PetscInt i = 0; i < gift->parts; i++) {
        const MpmOp         *part = &gift->part[i];
        PetscReal           *row  = MpmBlochRows(b, part->dst) + 2 * b->place[j] * b->width + y * b->lanes;
        const double complex tie  = wave * MpmBlochTie(b, part, j, NULL);

        for (PetscInt lane = 0; lane < n; lane++) {
          const double complex given = MpmOpValue(part, courant[lane]) * tie;

          row[lane] += creal(given);
          row[b->width + lane] += cimag(given);
        }
      }
    }
  }
}

/*
   The matrices of a period, or those of a turn, of up to so many Courant numbers as there are lanes. t: those of the
   numbers that are taken, and of the registers that are left; NULL: of all registers.
*/
static PetscErrorCode Whole(MpmBloch *b, const MpmTaken *t, PetscInt n, const PetscReal courant[],
                            const PetscReal beta[], PetscBool turn, PetscBool noisy, double complex G[],
                            PetscInt exponent[])
{
  const PetscInt numbers = t ? t->numbers : 0, left = t ? t->left : b->fields, size = numbers + left * b->ppc,
                 steps = turn ? b->turn : b->period;
  PetscReal *given;

  PetscFunctionBegin;
  PetscCall(MpmBlochBegin(b, n, courant, beta, steps, size));
  PetscCall(PetscCalloc1(numbers * 2 * b->width, &given));
  if (t) SpreadTaken(b, beta, n, courant);
  for (PetscInt j = 0, column = numbers; j < b->ppc; j++)
    for (PetscInt r = 0; r < b->fields; r++)
      if (!t || !t->taken[r]) SetAll(b, MpmBlochRows(b, r) + 2 * j * b->width, column++, 1);
  for (PetscInt step = 0; step < steps; step++) {
    PetscCall(MpmBlochRunStep(b, step, step == steps - 1 ? t : NULL, given));
    if (noisy) Disturb(b, step);
    Rescale(b, numbers * 2 * b->width, given, exponent);
  }
  for (PetscInt y = 0; y < numbers; y++)
    for (PetscInt lane = 0; lane < n; lane++)
      for (PetscInt c = 0; c < size; c++) G[(lane * size + c) * size + y] = At(b, given + 2 * y * b->width, c, lane);
  for (PetscInt j = 0; j < b->ppc; j++) {
    const double complex wave = turn ? MpmBlochPhaseBeyond(b, beta, j) : 1;
    PetscInt             to   = numbers + left * (turn ? b->place[j] : j);

    for (PetscInt r = 0; r < b->fields; r++) {
      if (t && t->taken[r]) continue;
      for (PetscInt lane = 0; lane < n; lane++)
        for (PetscInt c = 0; c < size; c++)
          G[(lane * size + c) * size + to] = wave * At(b, MpmBlochRows(b, r) + 2 * j * b->width, c, lane);
      to++;
    }
  }
  PetscCall(PetscFree(given));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The same of any number of Courant numbers. */
static PetscErrorCode Many(MpmBloch *b, const MpmTaken *t, PetscInt size, PetscInt n, const PetscReal courant[],
                           const PetscReal beta[], PetscBool turn, PetscBool noisy, double complex G[],
                           PetscInt exponent[])
{
  PetscFunctionBegin;
  for (PetscInt first = 0, some; first < n; first += some) {
    PetscInt powers[MPM_BLOCH_LANES] = {0};

    some = PetscMin(b->most, n - first);
    PetscCall(Whole(b, t, some, courant + first, beta, turn, noisy, G + first * size * size, powers));
    PetscCall(PetscArraycpy(exponent + first, powers, some));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochMatrices(MpmBloch *b, PetscInt n, const PetscReal courant[], const PetscReal beta[],
                                PetscBool noisy, double complex G[], PetscInt exponent[])
{
  PetscFunctionBegin;
  PetscCall(Many(b, NULL, b->size, n, courant, beta, PETSC_FALSE, noisy, G, exponent));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochTurns(MpmBloch *b, PetscInt n, const PetscReal courant[], const PetscReal beta[],
                             double complex G[], PetscInt exponent[])
{
  PetscFunctionBegin;
  PetscCall(Many(b, b->taken, b->turn_size, n, courant, beta, PETSC_TRUE, PETSC_FALSE, G, exponent));
  PetscFunctionReturn(PETSC_SUCCESS);
}
