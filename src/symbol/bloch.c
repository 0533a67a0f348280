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
#include "symbol/bloch.h"
#include <mpmstab/verdict.h>
#include <math.h>

#define KINDS MPM_OP_KINDS
#define SINGULAR 1e-12 /* a symbol of P2G G2P below this is taken for 0 */
#define RESCALE_AT 200 /* powers of two */

/* Every table has a P2G, whose weights give the masses. SOLVE needs G2P too. */
static PetscBool IsUsed(const MpmScheme *scheme, MpmOpKind kind)
{
  if (!scheme->basis->kernel[kind]) return PETSC_FALSE;
  if (kind == MPM_G2P && MpmTableHas(scheme->table, MPM_SOLVE)) return PETSC_TRUE;
  return MpmTableHas(scheme->table, kind);
}

PetscErrorCode MpmBlochCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction drift[], MpmBloch *b)
{
  const MpmTable *table = scheme->table;
  MpmStep         step  = {.courant = 0};

  PetscFunctionBegin;
  *b = (MpmBloch){.layout = layout, .scheme = scheme, .fields = table->nstate, .ppc = MpmLayoutPpc(layout)};
  for (PetscInt a = 0; a < layout->dim; a++) step.drift[a] = drift[a];
  PetscCall(MpmStepPeriod(&step, &b->period));
  b->size = b->fields * b->ppc;
  PetscCall(PetscMalloc2(table->nparticles * b->ppc * b->size, &b->particle, table->nnodes * b->size, &b->nodes));
  PetscCall(PetscMalloc2(table->nops, &b->traits, table->nops, &b->values));
  for (PetscInt o = 0; o < table->nops; o++) b->traits[o] = MpmOpTraitsOf(table->ops[o].kind);
  for (PetscInt kind = 0; kind < KINDS; kind++) b->used[kind] = IsUsed(scheme, (MpmOpKind)kind);
  for (PetscInt a = 0; a < layout->dim; a++) {
    PetscCall(MpmTiesCreate(layout, scheme, a, &drift[a], b->used, &b->ties[a]));
    PetscCall(PetscMalloc1(KINDS * layout->ppc[a], &b->tie[a]));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochDestroy(MpmBloch *b)
{
  PetscFunctionBegin;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    PetscCall(MpmTiesDestroy(&b->ties[a]));
    PetscCall(PetscFree(b->tie[a]));
  }
  PetscCall(PetscFree2(b->particle, b->nodes));
  PetscCall(PetscFree2(b->traits, b->values));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The symbols of the maps along each direction at a step, and the nodal mass. */
static void SetTies(MpmBloch *b, PetscInt step)
{
  b->mass = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    const MpmTies *ties = &b->ties[a];

    b->mass *= ties->masses[step % ties->period];
    for (PetscInt kind = 0; kind < KINDS; kind++)
      for (PetscInt j = 0; j < ties->n && b->used[kind]; j++)
        b->tie[a][kind * ties->n + j] = MpmTie(ties, step, (MpmOpKind)kind, j, b->wave[a]);
  }
}

/* The symbol of a map along an axis at particle j: the map's own along the axis, and phi's along the others. */
static double complex Tie(const MpmBloch *b, MpmOpKind kind, PetscInt axis, PetscInt j)
{
  const PetscInt *ppc = b->layout->ppc;
  double complex  product;

  if (b->layout->dim == 1) return b->tie[0][kind * ppc[0] + j];
  product = 1;
  for (PetscInt a = 0; a < b->layout->dim; a++) {
    product *= b->tie[a][(a == axis ? kind : MPM_P2G) * ppc[a] + j % ppc[a]];
    j /= ppc[a];
  }
  return product;
}

/* dst += factor src, for rows of n numbers. */
static void AddRow(PetscInt n, double complex factor, const double complex *restrict src, double complex *restrict dst)
{
  const PetscReal re = creal(factor), im = cimag(factor);

  for (PetscInt c = 0; c < n; c++)
    dst[c] += CMPLX(re * creal(src[c]) - im * cimag(src[c]), re * cimag(src[c]) + im * creal(src[c]));
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
    const double complex tie = Tie(b, MPM_G2P, 0, j);

    alpha += (creal(tie) * creal(tie) + cimag(tie) * cimag(tie)) / b->mass;
  }
  return alpha > SINGULAR ? 1 / alpha : 0;
}

static void ApplyOp(MpmBloch *b, PetscInt o, const PetscReal beta[])
{
  const MpmOp      *op     = &b->scheme->table->ops[o];
  const MpmOpTraits traits = b->traits[o];
  const PetscReal   a      = b->values[o];
  const PetscInt    ppc = b->ppc, n = b->columns;
  double complex   *dst;

  if (traits.dst == MPM_NOWHERE) return;
  if (op->kind == MPM_SCALE || (op->kind == MPM_ADD && op->dst == op->src)) {
    for (PetscInt c = 0; c < ppc * n; c++) b->particle[op->dst * ppc * n + c] *= op->kind == MPM_ADD ? 1 + a : a;
    return;
  }
  if (op->kind == MPM_ADD) {
    AddRow(ppc * n, a, b->particle + op->src * ppc * n, b->particle + op->dst * ppc * n);
    return;
  }
  if (traits.dst == MPM_ON_PARTICLES) {
    for (PetscInt j = 0; j < ppc; j++)
      AddRow(n, a * Tie(b, op->kind, op->axis, j), b->nodes + op->src * n, b->particle + (op->dst * ppc + j) * n);
    return;
  }
  dst = b->nodes + op->dst * n;
  if (traits.dst == traits.src && op->dst == op->src) {
    for (PetscInt c = 0; c < n; c++) dst[c] *= a;
    return;
  }
  if (!op->accumulates)
    for (PetscInt c = 0; c < n; c++) dst[c] = 0;
  if (traits.src == MPM_ON_PARTICLES) {
    const PetscReal share = a / b->mass;

    for (PetscInt j = 0; j < ppc; j++)
      AddRow(n, share * conj(Tie(b, op->kind, op->axis, j)), b->particle + (op->src * ppc + j) * n, dst);
  } else
    AddRow(n, a * (op->kind == MPM_SOLVE ? Inverse(b) : Stencil(&traits, beta[op->axis])), b->nodes + op->src * n, dst);
}

/* Divides the state's registers by a power of two when they would leave the range of doubles; returns its exponent. */
static PetscInt Rescale(MpmBloch *b)
{
  const PetscInt n       = b->size * b->columns;
  PetscReal      largest = 0;
  PetscInt       shift;

  for (PetscInt i = 0; i < n; i++)
    largest = PetscMax(largest, PetscMax(fabs(creal(b->particle[i])), fabs(cimag(b->particle[i]))));
  shift = MpmPowerToTakeOut(largest, RESCALE_AT);
  for (PetscInt i = 0; i < n && shift; i++) b->particle[i] *= scalbn(1, -(int)shift);
  return shift;
}

/* Moves every number by up to MPM_ROUNDING, relative. The random numbers are the same at any phase and on any rank. */
static void Disturb(MpmBloch *b, PetscInt step)
{
  const PetscInt n = b->size * b->size;

  for (PetscInt i = 0; i < n; i++) b->particle[i] *= 1 + MPM_ROUNDING * (2 * MpmHash(step, i) - 1);
}

/* Makes ready for steps of so many columns. All registers are 0. */
static PetscErrorCode Begin(MpmBloch *b, PetscReal courant, const PetscReal beta[], PetscInt columns)
{
  const MpmTable *t = b->scheme->table;

  PetscFunctionBegin;
  b->columns = columns;
  for (PetscInt a = 0; a < b->layout->dim; a++) MpmTiesWave(&b->ties[a], beta[a], b->wave[a]);
  for (PetscInt o = 0; o < t->nops; o++) b->values[o] = MpmOpValue(&t->ops[o], courant);
  PetscCall(PetscArrayzero(b->particle, t->nparticles * b->ppc * columns));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Step(MpmBloch *b, PetscInt step, const PetscReal beta[])
{
  SetTies(b, step);
  for (PetscInt o = 0; o < b->scheme->table->nops; o++) ApplyOp(b, o, beta);
}

PetscErrorCode MpmBlochStep(MpmBloch *b, PetscReal courant, const PetscReal beta[], PetscInt step,
                            double complex state[])
{
  PetscFunctionBegin;
  PetscCall(Begin(b, courant, beta, 1));
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < b->ppc; j++) b->particle[field * b->ppc + j] = state[b->fields * j + field];
  Step(b, step, beta);
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < b->ppc; j++) state[b->fields * j + field] = b->particle[field * b->ppc + j];
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochMatrix(MpmBloch *b, PetscReal courant, const PetscReal beta[], PetscBool noisy,
                              double complex G[], PetscInt *exponent)
{
  const PetscInt ppc = b->ppc, n = b->size;

  PetscFunctionBegin;
  *exponent = 0;
  PetscCall(Begin(b, courant, beta, n));
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < ppc; j++) b->particle[(field * ppc + j) * n + b->fields * j + field] = 1;
  for (PetscInt step = 0; step < b->period; step++) {
    Step(b, step, beta);
    if (noisy) Disturb(b, step);
    *exponent += Rescale(b);
  }
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < ppc; j++)
      for (PetscInt c = 0; c < n; c++) G[c * n + b->fields * j + field] = b->particle[(field * ppc + j) * n + c];
  PetscFunctionReturn(PETSC_SUCCESS);
}
