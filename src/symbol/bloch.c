/*
   A table applied to one Bloch mode. On the mode

     q_p = e^(i beta n) q^_j    (particle j of cell n),    g_i = e^(i beta i) g^

   an operation of the table is a product of small matrices:

     particle -> node       g^  = a sum_j sum_d phi_jd e^(-i beta d) q^_j / mass
     node -> particle       q^_j += a sum_d phi_jd e^(i beta d) g^
     node -> node           g^  = a sum_s stencil_s e^(i beta s) f^

   d is the place of the node relative to the cell's node. DIV and GRAD have h dphi/dx for phi. SOLVE divides f^ by the
   symbol of P2G G2P.
*/
#include "base/hash.h"
#include "base/power_of_two.h"
#include "symbol/bloch.h"
#include "scene/layout.h"
#include <mpmstab/verdict.h>
#include <math.h>

#define KINDS MPM_OP_KINDS
#define SINGULAR 1e-12 /* a symbol of P2G G2P below this is taken for 0 */
#define RESCALE_AT 200 /* powers of two */

static const PetscReal *RowOf(const MpmBloch *b, PetscInt step, PetscInt kind, PetscInt j)
{
  return b->rows + ((step * KINDS + kind) * b->layout->ppc[0] + j) * MPM_MAX_REACH;
}

/* Every table has a P2G, whose weights give the masses. SOLVE needs G2P too. */
static PetscBool IsUsed(const MpmScheme *scheme, MpmOpKind kind)
{
  if (!scheme->basis->kernel[kind]) return PETSC_FALSE;
  if (kind == MPM_G2P && MpmTableHas(scheme->table, MPM_SOLVE)) return PETSC_TRUE;
  return MpmTableHas(scheme->table, kind);
}

PetscErrorCode MpmBlochCreate(const MpmLayout *layout, const MpmScheme *scheme, const MpmFraction *drift, MpmBloch *b)
{
  const PetscInt period = (PetscInt)drift->den;
  const PetscInt ppc = layout->ppc[0], reach = MpmMapReach(scheme->basis);
  PetscInt       lowest = PETSC_MAX_INT, highest = -PETSC_MAX_INT;

  PetscFunctionBegin;
  *b      = (MpmBloch){.layout = layout, .scheme = scheme, .fields = scheme->table->nstate, .period = period};
  b->size = b->fields * ppc;
  PetscCall(PetscMalloc3(period * ppc, &b->node, period * KINDS * ppc * MPM_MAX_REACH, &b->rows, period, &b->masses));
  PetscCall(PetscMalloc3(scheme->table->nparticles * ppc * b->size, &b->particle, scheme->table->nnodes * b->size,
                         &b->nodes, KINDS * ppc, &b->tie));
  PetscCall(PetscMalloc2(scheme->table->nops, &b->traits, scheme->table->nops, &b->values));
  for (PetscInt o = 0; o < scheme->table->nops; o++) b->traits[o] = MpmOpTraitsOf(scheme->table->ops[o].kind);
  for (PetscInt kind = 0; kind < KINDS; kind++) b->used[kind] = IsUsed(scheme, (MpmOpKind)kind);
  for (PetscInt step = 0; step < period; step++) {
    b->masses[step] = 0;
    for (PetscInt j = 0; j < ppc; j++) {
      PetscInt  cell;
      PetscReal xi;

      MpmLayoutPlaceAt(layout, drift, j, step, &cell, &xi);
      b->node[step * ppc + j] = cell - scheme->basis->reach_left;
      for (PetscInt kind = 0; kind < KINDS; kind++)
        if (b->used[kind])
          MpmMapRow(scheme->basis, (MpmOpKind)kind, xi, layout->half_width[0], (PetscReal *)RowOf(b, step, kind, j));
      for (PetscInt d = 0; d < reach; d++) b->masses[step] += RowOf(b, step, MPM_P2G, j)[d];
      lowest  = PetscMin(lowest, b->node[step * ppc + j]);
      highest = PetscMax(highest, b->node[step * ppc + j]);
    }
  }
  b->lowest = lowest;
  b->seen   = highest - lowest + reach;
  PetscCall(PetscMalloc1(b->seen, &b->wave));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochDestroy(MpmBloch *b)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(b->node, b->rows, b->masses));
  PetscCall(PetscFree3(b->particle, b->nodes, b->tie));
  PetscCall(PetscFree2(b->traits, b->values));
  PetscCall(PetscFree(b->wave));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* The phase factor of each node of a cell's particles in any step: wave[i] = e^(i beta (lowest + i)). */
static void SetPhase(MpmBloch *b, PetscReal beta)
{
  for (PetscInt i = 0; i < b->seen; i++) b->wave[i] = cexp(I * (beta * (b->lowest + i)));
}

/* The symbols of the maps at each particle and a step: sum_d row_d e^(i beta d). */
static void SetTies(MpmBloch *b, PetscInt step)
{
  const PetscInt ppc = b->layout->ppc[0], reach = MpmMapReach(b->scheme->basis);

  for (PetscInt kind = 0; kind < KINDS; kind++) {
    if (!b->used[kind]) continue;
    for (PetscInt j = 0; j < ppc; j++) {
      const PetscReal      *row  = RowOf(b, step, kind, j);
      const double complex *wave = b->wave + b->node[step * ppc + j] - b->lowest;
      PetscReal             re = 0, im = 0;

      for (PetscInt d = 0; d < reach; d++) {
        re += row[d] * creal(wave[d]);
        im += row[d] * cimag(wave[d]);
      }
      b->tie[kind * ppc + j] = CMPLX(re, im);
    }
  }
}

static double complex Tie(const MpmBloch *b, MpmOpKind kind, PetscInt j)
{
  return b->tie[kind * b->layout->ppc[0] + j];
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
static PetscReal Inverse(const MpmBloch *b, PetscInt step)
{
  PetscReal alpha = 0;

  for (PetscInt j = 0; j < b->layout->ppc[0]; j++) {
    const double complex tie = Tie(b, MPM_G2P, j);

    alpha += (creal(tie) * creal(tie) + cimag(tie) * cimag(tie)) / b->masses[step];
  }
  return alpha > SINGULAR ? 1 / alpha : 0;
}

static void ApplyOp(MpmBloch *b, PetscInt o, PetscInt step, PetscReal beta)
{
  const MpmOp      *op     = &b->scheme->table->ops[o];
  const MpmOpTraits traits = b->traits[o];
  const PetscReal   a      = b->values[o];
  const PetscInt    ppc = b->layout->ppc[0], n = b->size;
  double complex   *dst;

  if (traits.dst == MPM_NOWHERE) return;
  if (op->kind == MPM_SCALE) {
    for (PetscInt c = 0; c < ppc * n; c++) b->particle[op->dst * ppc * n + c] *= a;
    return;
  }
  if (traits.dst == MPM_ON_PARTICLES) {
    for (PetscInt j = 0; j < ppc; j++)
      AddRow(n, a * Tie(b, op->kind, j), b->nodes + op->src * n, b->particle + (op->dst * ppc + j) * n);
    return;
  }
  dst = b->nodes + op->dst * n;
  if (!op->accumulates)
    for (PetscInt c = 0; c < n; c++) dst[c] = 0;
  if (traits.src == MPM_ON_PARTICLES) {
    const PetscReal share = a / b->masses[step];

    for (PetscInt j = 0; j < ppc; j++)
      AddRow(n, share * conj(Tie(b, op->kind, j)), b->particle + (op->src * ppc + j) * n, dst);
  } else
    AddRow(n, a * (op->kind == MPM_SOLVE ? Inverse(b, step) : Stencil(&traits, beta)), b->nodes + op->src * n, dst);
}

/* Divides the state's registers by a power of two when they would leave the range of doubles; returns its exponent. */
static PetscInt Rescale(MpmBloch *b)
{
  const PetscInt n       = b->size * b->size;
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

PetscErrorCode MpmBlochMatrix(MpmBloch *b, PetscReal courant, PetscReal beta, PetscBool noisy, double complex G[],
                              PetscInt *exponent)
{
  const MpmTable *t   = b->scheme->table;
  const PetscInt  ppc = b->layout->ppc[0], n = b->size;

  PetscFunctionBegin;
  *exponent = 0;
  SetPhase(b, beta);
  for (PetscInt o = 0; o < t->nops; o++) b->values[o] = MpmOpValue(&t->ops[o], courant);
  PetscCall(PetscArrayzero(b->particle, t->nparticles * ppc * n));
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < ppc; j++) b->particle[(field * ppc + j) * n + b->fields * j + field] = 1;
  for (PetscInt step = 0; step < b->period; step++) {
    SetTies(b, step);
    for (PetscInt o = 0; o < t->nops; o++) ApplyOp(b, o, step, beta);
    if (noisy) Disturb(b, step);
    *exponent += Rescale(b);
  }
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < ppc; j++)
      for (PetscInt c = 0; c < n; c++) G[c * n + b->fields * j + field] = b->particle[(field * ppc + j) * n + c];
  PetscFunctionReturn(PETSC_SUCCESS);
}
