/*
   A table applied to one Bloch mode. On the mode

     q_p = e^(i beta.n) q^_j    (particle j of cell n),    g_i = e^(i beta.i) g^

   an operation of the table is a product of small matrices:

     particle -> node       g^  = a sum_j sum_d phi_jd e^(-i beta.d) q^_j / mass
     node -> particle       q^_j += a sum_d phi_jd e^(i beta.d) g^
     node -> node           g^  = a sum_s stencil_s e^(i beta_a s) f^    (a: the axis of the operation)

   d is the place of the node relative to the cell's node. DIV and GRAD have h dphi/dx for phi. SOLVE divides f^ by the
   symbol of P2G G2P. In more dimensions the sum over d is a product of sums along the directions.
*/
#include "base/hash.h"
#include "base/power_of_two.h"
#include "linalg/complex_inline.h"
#include "symbol/bloch_nodal.h"
#include <mpmstab/verdict.h>
#include <math.h>

#define KINDS MPM_OP_KINDS
#define SINGULAR 1e-12 /* a symbol of P2G G2P below this is taken for 0 */
#define RESCALE_AT 200 /* powers of two */
#define MODERATE 256   /* Courant number; up to here a step multiplies by less than 2^100, */
#define SELDOM 8       /* and only after so many steps a matrix may have to be divided */
#define BLOCK 4        /* numbers that are added at once; rows are filled up with zeros to a multiple of it */

/*
   Finds the kinds whose weights the maps of a scheme have along some direction. Every table has a P2G, whose weights give
   the masses. SOLVE needs G2P too.
*/
static void FindUsed(const MpmScheme *scheme, PetscBool used[])
{
  const MpmTable *t = scheme->table;

  for (PetscInt o = 0; o < t->nops; o++) {
    const MpmOp      *op     = &t->ops[o];
    const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

    if (op->kind == MPM_SOLVE) used[MPM_G2P] = PETSC_TRUE;
    if (traits.src == traits.dst) continue;
    for (PetscInt a = 0; a < t->dim; a++) used[MpmKindAlong(op->kind, op->axis, a)] = PETSC_TRUE;
  }
}

static PetscInt FullWidth(PetscInt columns)
{
  return (columns + BLOCK - 1) / BLOCK * BLOCK;
}

static PetscInt GreatestCommonDivisor(PetscInt a, PetscInt b)
{
  return b ? GreatestCommonDivisor(b, a % b) : a;
}

static PetscInt FloorOver(PetscInt a, PetscInt b)
{
  return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/*
   A turn is over when every particle has the place that some particle of a cell had at the start: after a whole number
   of the distances between them, 1 / ppc.
*/
static PetscErrorCode FindTurn(const MpmFraction drift[], MpmBloch *b)
{
  const PetscInt *ppc = b->layout->ppc;

  PetscFunctionBegin;
  b->turn = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    const PetscInt steps =
        drift[a].value == 0 ? 1 : (PetscInt)drift[a].den / GreatestCommonDivisor((PetscInt)drift[a].den, ppc[a]);

    b->turn *= steps / GreatestCommonDivisor(b->turn, steps);
  }
  PetscCall(PetscMalloc2(b->ppc, &b->place, b->ppc, &b->beyond));
  for (PetscInt j = 0; j < b->ppc; j++) {
    PetscInt stride = 1, rest = j;

    b->place[j] = 0;
    for (PetscInt a = 0; a < b->layout->dim; a++) {
      const PetscInt moved = drift[a].value == 0 ? 0 : (PetscInt)(drift[a].num * b->turn * ppc[a] / drift[a].den),
                     to    = rest % ppc[a] + moved;

      b->beyond[j][a] = FloorOver(to, ppc[a]);
      b->place[j] += stride * (to - ppc[a] * b->beyond[j][a]);
      stride *= ppc[a];
      rest /= ppc[a];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Particles that move take the smaller matrix of a turn where there is one. */
static PetscErrorCode FindTaken(MpmBloch *b)
{
  PetscFunctionBegin;
  b->turn_size = b->size;
  if (b->period == 1) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(MpmTakenFind(b->scheme->table, &b->taken));
  if (b->taken) b->turn_size = b->taken->numbers + b->taken->left * b->ppc;
  if (b->taken && b->turn_size < b->size) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(PetscFree(b->taken));
  b->turn_size = b->size;
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction drift[], MpmBloch *b)
{
  const MpmTable *table = scheme->table;
  MpmStep         step  = {.courant = 0};

  PetscFunctionBegin;
  PetscCall(MpmTableRequireLinear(table));
  *b = (MpmBloch){.layout = layout, .scheme = scheme, .fields = table->nstate, .ppc = MpmLayoutPpc(layout)};
  for (PetscInt a = 0; a < layout->dim; a++) step.drift[a] = drift[a];
  PetscCall(MpmStepPeriod(&step, &b->period));
  b->size = b->fields * b->ppc;
  PetscCall(FindTurn(drift, b));
  PetscCall(FindTaken(b));
  PetscCall(PetscMalloc2(2 * table->nparticles * b->ppc * FullWidth(b->size), &b->particle,
                         2 * table->nnodes * FullWidth(b->size), &b->nodes));
  PetscCall(PetscMalloc2(table->nops, &b->traits, table->nops, &b->values));
  for (PetscInt o = 0; o < table->nops; o++) b->traits[o] = MpmOpTraitsOf(table->ops[o].kind);
  FindUsed(scheme, b->used);
  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscCall(MpmTiesCreate(layout, scheme, a, &drift[a], b->used, &b->ties[a]));
    PetscCall(PetscMalloc1(b->ties[a].period * KINDS * layout->ppc[a], &b->tie[a]));
    b->beta[a] = NAN;
  }
  PetscCall(MpmBlochNodalCreate(b, &b->nodal));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochDestroy(MpmBloch *b)
{
  PetscFunctionBegin;
  PetscCall(MpmBlochNodalDestroy(&b->nodal));
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    PetscCall(MpmTiesDestroy(&b->ties[a]));
    PetscCall(PetscFree(b->tie[a]));
  }
  PetscCall(PetscFree2(b->particle, b->nodes));
  PetscCall(PetscFree2(b->place, b->beyond));
  PetscCall(PetscFree(b->taken));
  PetscCall(PetscFree2(b->traits, b->values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

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
        b->tie[a][(b->known[a] * KINDS + kind) * ties->n + j] =
            MpmTie(ties, b->known[a], (MpmOpKind)kind, j, b->wave[a]);
    }
}

/* Sets what the maps of a step are, and the nodal mass. */
static void SetStep(MpmBloch *b, PetscInt step)
{
  b->mass = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    const MpmTies *ties = &b->ties[a];
    const PetscInt at   = step % ties->period;

    b->mass *= ties->masses[at];
    b->now[a] = b->tie[a] + at * KINDS * ties->n;
  }
}

double complex MpmBlochTie(const MpmBloch *b, MpmOpKind kind, PetscInt axis, PetscInt j)
{
  const PetscInt *ppc = b->layout->ppc;
  double complex  product;

  if (b->layout->dim == 1) return b->now[0][kind * ppc[0] + j];
  product = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    product = MpmTimes(product, b->now[a][MpmKindAlong(kind, axis, a) * ppc[a] + j % ppc[a]]);
    j /= ppc[a];
  }
  return product;
}

/* dst += factor src, for rows of n numbers: first their real parts, then their imaginary ones. n is a multiple of BLOCK. */
static inline void AddRow(PetscInt n, double complex factor, const PetscReal *restrict src, PetscReal *restrict dst)
{
  const PetscReal re = creal(factor), im = cimag(factor);

  for (PetscInt c = 0; c < n; c += BLOCK)
    for (PetscInt i = c; i < c + BLOCK; i++) {
      dst[i] += re * src[i] - im * src[n + i];
      dst[n + i] += re * src[n + i] + im * src[i];
    }
}

static inline void ScaleRows(PetscInt n, PetscReal factor, PetscReal row[])
{
  for (PetscInt c = 0; c < 2 * n; c++) row[c] *= factor;
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
  PetscReal alpha = 0;

  for (PetscInt j = 0; j < b->ppc; j++) {
    const double complex tie = MpmBlochTie(b, MPM_G2P, 0, j);

    alpha += (creal(tie) * creal(tie) + cimag(tie) * cimag(tie)) / b->mass;
  }
  return alpha > SINGULAR ? 1 / alpha : 0;
}

double complex MpmBlochOfNodes(const MpmBloch *b, const MpmOp *op, const PetscReal beta[])
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  return op->kind == MPM_SOLVE ? Inverse(b) : Stencil(&traits, beta[op->axis]);
}

void MpmBlochSetPhase(MpmBloch *b, const PetscReal beta[])
{
  for (PetscInt a = 0; a < b->layout->dim; a++) SetPhase(b, a, beta[a], 1);
  SetStep(b, 0);
}

/* The rows of a register of particles, and the row of one of nodes. */
static inline PetscReal *Rows(const MpmBloch *b, PetscInt field)
{
  return b->particle + field * b->ppc * 2 * b->width;
}

static inline PetscReal *Row(const MpmBloch *b, PetscInt field)
{
  return b->nodes + field * 2 * b->width;
}

static void ApplyOp(MpmBloch *b, PetscInt o, const PetscReal beta[])
{
  const MpmOp      *op     = &b->scheme->table->ops[o];
  const MpmOpTraits traits = b->traits[o];
  const PetscReal   a      = b->values[o];
  const PetscInt    ppc = b->ppc, n = b->width;
  PetscReal        *dst;

  if (traits.dst == MPM_NOWHERE) return;
  if (op->kind == MPM_SCALE || (op->kind == MPM_ADD && op->dst == op->src)) {
    ScaleRows(ppc * n, op->kind == MPM_ADD ? 1 + a : a, Rows(b, op->dst));
    return;
  }
  if (op->kind == MPM_ADD) {
    AddRow(ppc * n, a, Rows(b, op->src), Rows(b, op->dst));
    return;
  }
  if (traits.dst == MPM_ON_PARTICLES) {
    for (PetscInt j = 0; j < ppc; j++)
      AddRow(n, MpmScaled(a, MpmBlochTie(b, op->kind, op->axis, j)), Row(b, op->src), Rows(b, op->dst) + j * 2 * n);
    return;
  }
  dst = Row(b, op->dst);
  if (traits.dst == traits.src && op->dst == op->src) {
    ScaleRows(n, a, dst);
    return;
  }
  if (!op->accumulates)
    for (PetscInt c = 0; c < 2 * n; c++) dst[c] = 0;
  if (traits.src == MPM_ON_PARTICLES) {
    const PetscReal share = a / b->mass;

    for (PetscInt j = 0; j < ppc; j++)
      AddRow(n, MpmScaled(share, conj(MpmBlochTie(b, op->kind, op->axis, j))), Rows(b, op->src) + j * 2 * n, dst);
  } else
    AddRow(n, a * MpmBlochOfNodes(b, op, beta), Row(b, op->src), dst);
}

/* Divides the state's registers by a power of two when they would leave the range of doubles; returns its exponent. */
static PetscInt Rescale(MpmBloch *b)
{
  const PetscInt n           = 2 * b->size * b->width;
  PetscReal      most[BLOCK] = {0}, largest = 0;
  PetscInt       shift;

  for (PetscInt i = 0; i < n; i += BLOCK)
    for (PetscInt j = 0; j < BLOCK; j++) most[j] = PetscMax(fabs(b->particle[i + j]), most[j]);
  for (PetscInt j = 0; j < BLOCK; j++) largest = PetscMax(largest, most[j]);
  shift = MpmPowerToTakeOut(largest, RESCALE_AT);
  for (PetscInt i = 0; i < n && shift; i++) b->particle[i] = scalbn(b->particle[i], -(int)shift);
  return shift;
}

/* Moves every number by up to MPM_ROUNDING, relative. The random numbers are the same at any phase and on any rank. */
static void Disturb(MpmBloch *b, PetscInt step)
{
  const PetscInt n = b->size, width = b->width;

  for (PetscInt row = 0; row < n; row++)
    for (PetscInt c = 0; c < n; c++) {
      const PetscReal factor = 1 + MPM_ROUNDING * (2 * MpmHash(step, row * n + c) - 1);

      b->particle[2 * row * width + c] *= factor;
      b->particle[(2 * row + 1) * width + c] *= factor;
    }
}

/* Makes ready for the first steps of a period, of so many columns. All registers are 0. */
static PetscErrorCode Begin(MpmBloch *b, PetscReal courant, const PetscReal beta[], PetscInt steps, PetscInt columns)
{
  const MpmTable *t = b->scheme->table;

  PetscFunctionBegin;
  b->width = FullWidth(columns);
  for (PetscInt a = 0; a < b->layout->dim; a++) SetPhase(b, a, beta[a], steps);
  for (PetscInt o = 0; o < t->nops; o++) b->values[o] = MpmOpValue(&t->ops[o], courant);
  PetscCall(PetscArrayzero(b->particle, 2 * t->nparticles * b->ppc * b->width));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Step(MpmBloch *b, PetscInt step, const PetscReal beta[])
{
  SetStep(b, step);
  for (PetscInt o = 0; o < b->scheme->table->nops; o++) ApplyOp(b, o, beta);
}

PetscErrorCode MpmBlochStep(MpmBloch *b, PetscReal courant, const PetscReal beta[], PetscInt step,
                            double complex state[])
{
  PetscFunctionBegin;
  PetscCall(Begin(b, courant, beta, step + 1, 1));
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < b->ppc; j++) {
      Rows(b, field)[2 * j * b->width]       = creal(state[b->fields * j + field]);
      Rows(b, field)[(2 * j + 1) * b->width] = cimag(state[b->fields * j + field]);
    }
  Step(b, step, beta);
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < b->ppc; j++)
      state[b->fields * j + field] = CMPLX(Rows(b, field)[2 * j * b->width], Rows(b, field)[(2 * j + 1) * b->width]);
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The steps of a period, or of a turn, from all states of a cell at once. */
static PetscErrorCode Steps(MpmBloch *b, PetscReal courant, const PetscReal beta[], PetscInt steps, PetscBool noisy,
                            PetscInt *exponent)
{
  const PetscInt ppc = b->ppc, n = b->size, every = courant <= MODERATE ? SELDOM : 1;

  PetscFunctionBegin;
  *exponent = 0;
  PetscCall(Begin(b, courant, beta, steps, n));
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < ppc; j++) Rows(b, field)[2 * j * b->width + b->fields * j + field] = 1;
  for (PetscInt step = 0; step < steps; step++) {
    Step(b, step, beta);
    if (noisy) Disturb(b, step);
    if (step % every == every - 1 || step == steps - 1) *exponent += Rescale(b);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochMatrix(MpmBloch *b, PetscReal courant, const PetscReal beta[], PetscBool noisy,
                              double complex G[], PetscInt *exponent)
{
  const PetscInt n = b->size;

  PetscFunctionBegin;
  PetscCall(Steps(b, courant, beta, b->period, noisy, exponent));
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < b->ppc; j++) {
      const PetscReal *row = Rows(b, field) + 2 * j * b->width;

      for (PetscInt c = 0; c < n; c++) G[c * n + b->fields * j + field] = CMPLX(row[c], row[b->width + c]);
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The phase factor of what goes from particle j to the one whose place it has taken, for the cells in between. */
static double complex PhaseBeyond(const MpmBloch *b, const PetscReal beta[], PetscInt j)
{
  PetscReal angle = 0;

  for (PetscInt a = 0; a < b->layout->dim; a++) angle -= beta[a] * (PetscReal)b->beyond[j][a];
  return angle == 0 ? 1 : cexp(I * angle);
}

static PetscErrorCode WholeTurn(MpmBloch *b, PetscReal courant, const PetscReal beta[], double complex G[],
                                PetscInt *exponent)
{
  const PetscInt n = b->size;

  PetscFunctionBegin;
  PetscCall(Steps(b, courant, beta, b->turn, PETSC_FALSE, exponent));
  for (PetscInt j = 0; j < b->ppc; j++) {
    const double complex wave = PhaseBeyond(b, beta, j);

    for (PetscInt field = 0; field < b->fields; field++) {
      const PetscReal *row = Rows(b, field) + 2 * j * b->width;

      for (PetscInt c = 0; c < n; c++)
        G[c * n + b->fields * b->place[j] + field] = MpmTimes(wave, CMPLX(row[c], row[b->width + c]));
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- a turn of what particles take from nodes, and of the rest ---- */

/*
   Sets the registers at the start of a turn. The nodes gave their numbers at the step before, when particles stood as at the
   last step of a turn, but for the places that they have taken since.
*/
static void SpreadTaken(MpmBloch *b, const PetscReal beta[], PetscReal courant)
{
  const MpmTaken *t   = b->taken;
  PetscInt        col = t->numbers;

  SetStep(b, b->turn - 1);
  for (PetscInt j = 0; j < b->ppc; j++) {
    const double complex wave = PhaseBeyond(b, beta, j);

    for (PetscInt n = 0; n < t->numbers; n++) {
      const MpmTakenGift *gift = &t->gift[t->first[n]];

      for (PetscInt i = 0; i < gift->parts; i++) {
        const MpmTakenPart  *part = &gift->part[i];
        PetscReal           *row  = Rows(b, part->dst) + 2 * b->place[j] * b->width;
        const double complex tie  = MpmScaled(part->factor * PetscPowRealInt(courant, part->power),
                                              MpmTimes(wave, MpmBlochTie(b, part->kind, part->axis, j)));

        row[n] += creal(tie);
        row[b->width + n] += cimag(tie);
      }
    }
  }
  for (PetscInt j = 0; j < b->ppc; j++)
    for (PetscInt r = 0; r < b->fields; r++)
      if (!t->taken[r]) Rows(b, r)[2 * j * b->width + col++] = 1;
}

/* The last step of a turn: the nodes' numbers, rows of 2 x width, are noted before they are given to particles. */
static void LastStep(MpmBloch *b, const PetscReal beta[], PetscReal numbers[])
{
  const MpmTaken *t = b->taken;

  for (PetscInt i = 0; i < t->numbers * 2 * b->width; i++) numbers[i] = 0;
  SetStep(b, b->turn - 1);
  for (PetscInt o = 0; o < b->scheme->table->nops; o++) {
    for (PetscInt g = 0; g < t->ngifts; g++)
      if (t->gift[g].at == o)
        AddRow(b->width, t->gift[g].times, Row(b, t->gift[g].src), numbers + t->gift[g].number * 2 * b->width);
    ApplyOp(b, o, beta);
  }
}

static PetscErrorCode SmallerTurn(MpmBloch *b, PetscReal courant, const PetscReal beta[], double complex G[],
                                  PetscInt *exponent)
{
  const MpmTaken *t = b->taken;
  const PetscInt  n = b->turn_size, every = courant <= MODERATE ? SELDOM : 1;
  PetscReal      *numbers;

  PetscFunctionBegin;
  *exponent = 0;
  PetscCall(Begin(b, courant, beta, b->turn, n));
  PetscCall(PetscMalloc1(t->numbers * 2 * b->width, &numbers));
  SpreadTaken(b, beta, courant);
  for (PetscInt step = 0; step < b->turn - 1; step++) {
    Step(b, step, beta);
    if (step % every == every - 1) *exponent += Rescale(b);
  }
  *exponent += Rescale(b);
  LastStep(b, beta, numbers);
  for (PetscInt y = 0; y < t->numbers; y++)
    for (PetscInt c = 0; c < n; c++)
      G[c * n + y] = CMPLX(numbers[2 * y * b->width + c], numbers[(2 * y + 1) * b->width + c]);
  for (PetscInt j = 0; j < b->ppc; j++) {
    const double complex wave = PhaseBeyond(b, beta, j);
    PetscInt             to   = t->numbers + t->left * b->place[j];

    for (PetscInt r = 0; r < b->fields; r++) {
      const PetscReal *row = Rows(b, r) + 2 * j * b->width;

      if (t->taken[r]) continue;
      for (PetscInt c = 0; c < n; c++) G[c * n + to] = MpmTimes(wave, CMPLX(row[c], row[b->width + c]));
      to++;
    }
  }
  PetscCall(PetscFree(numbers));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochTurn(MpmBloch *b, PetscReal courant, const PetscReal beta[], double complex G[],
                            PetscInt *exponent)
{
  PetscFunctionBegin;
  PetscCall((b->taken ? SmallerTurn : WholeTurn)(b, courant, beta, G, exponent));
  PetscFunctionReturn(PETSC_SUCCESS);
}
