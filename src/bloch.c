/*
   The symbol reader: on the mode q_p = e^(i beta n) q^_j (particle j of cell n), g_i = e^(i beta i) g^ an operation of
   the table is a product of small matrices.

     particle -> node       g^  = sum_j sum_d phi_jd e^(-i beta d) q^_j / mass      d: the node seen from the cell
     node -> particle       q^_j += a sum_d phi_jd e^(i beta d) g^                  or h dphi/dx for phi
     node -> node           g^  = a sum_s stencil_s e^(i beta s) f^
*/
#include <mpmstab/bloch.h>
#include <mpmstab/layout.h>
#include <mpmstab/verdict.h>
#include <math.h>

#define KINDS (MPM_DRIFT + 1)
#define RESCALE_AT 200 /* powers of two */

static const PetscReal *RowOf(const MpmBloch *b, PetscInt step, PetscInt kind, PetscInt j)
{
  return b->rows + ((step * KINDS + kind) * b->scene->ppc + j) * MPM_MAX_REACH;
}

static PetscBool IsUsed(const MpmFormulation *f, MpmOpKind kind)
{
  for (PetscInt o = 0; o < f->nops; o++)
    if (f->ops[o].kind == kind) return PETSC_TRUE;
  return PETSC_FALSE;
}

PetscErrorCode MpmBlochCreate(const MpmScene *scene, PetscInt period, MpmBloch *b)
{
  const MpmFormulation *f   = scene->formulation;
  const PetscInt        ppc = scene->ppc, reach = MpmMapReach(scene->basis);

  PetscFunctionBegin;
  *b      = (MpmBloch){.scene = scene, .fields = MpmFormulationParticleFields(f), .period = period};
  b->size = b->fields * ppc;
  PetscCall(PetscMalloc3(period * ppc, &b->node, period * KINDS * ppc * MPM_MAX_REACH, &b->rows, period, &b->masses));
  PetscCall(PetscMalloc3(b->fields * ppc * b->size, &b->particle, MPM_MAX_FIELDS * b->size, &b->nodes,
                         ppc * MPM_MAX_REACH, &b->shift));
  for (PetscInt step = 0; step < period; step++) {
    b->masses[step] = 0;
    for (PetscInt j = 0; j < ppc; j++) {
      PetscInt  cell;
      PetscReal xi;

      MpmLayoutPlaceAt(scene, j, step, &cell, &xi);
      b->node[step * ppc + j] = cell - scene->basis->reach_left;
      for (PetscInt kind = 0; kind < KINDS; kind++)
        if (MpmMapKernel(scene->basis, (MpmOpKind)kind) && IsUsed(f, (MpmOpKind)kind))
          MpmMapRow(scene->basis, (MpmOpKind)kind, xi, (PetscReal *)RowOf(b, step, kind, j));
      for (PetscInt d = 0; d < reach; d++) b->masses[step] += RowOf(b, step, MPM_P2G, j)[d];
    }
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmBlochDestroy(MpmBloch *b)
{
  PetscFunctionBegin;
  PetscCall(PetscFree3(b->node, b->rows, b->masses));
  PetscCall(PetscFree3(b->particle, b->nodes, b->shift));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* e^(i beta d) at the nodes that the particles of a cell see at a step. */
static void Shift(MpmBloch *b, PetscInt step, PetscReal beta)
{
  const PetscInt ppc = b->scene->ppc, reach = MpmMapReach(b->scene->basis);

  for (PetscInt j = 0; j < ppc; j++) {
    double complex at = cexp(I * (beta * b->node[step * ppc + j]));

    for (PetscInt d = 0; d < reach; d++, at *= cexp(I * beta)) b->shift[j * reach + d] = at;
  }
}

/* The number that ties particle j's mode to the node's: sum_d row_d e^(i beta d). */
static double complex Tie(const MpmBloch *b, PetscInt step, MpmOpKind kind, PetscInt j)
{
  const PetscReal *row   = RowOf(b, step, kind, j);
  const PetscInt   reach = MpmMapReach(b->scene->basis);
  double complex   sum   = 0;

  for (PetscInt d = 0; d < reach; d++) sum += row[d] * b->shift[j * reach + d];
  return sum;
}

/* dst += factor src, over the columns of the registers. */
static void AddRow(PetscInt n, double complex factor, const double complex *restrict src, double complex *restrict dst)
{
  const PetscReal re = creal(factor), im = cimag(factor);

  for (PetscInt c = 0; c < n; c++)
    dst[c] += (re * creal(src[c]) - im * cimag(src[c])) + I * (re * cimag(src[c]) + im * creal(src[c]));
}

static void ApplyOp(MpmBloch *b, const MpmOp *op, PetscInt step, PetscReal beta)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);
  const PetscReal   a      = MpmCoefficientValue(op->coefficient, b->scene->courant);
  const PetscInt    ppc = b->scene->ppc, n = b->size;
  double complex   *dst;

  if (traits.dst == MPM_NOWHERE) return;
  if (traits.dst == MPM_ON_PARTICLES) {
    for (PetscInt j = 0; j < ppc; j++)
      AddRow(n, a * Tie(b, step, op->kind, j), b->nodes + op->src * n, b->particle + (op->dst * ppc + j) * n);
    return;
  }
  dst = b->nodes + op->dst * n;
  if (!traits.accumulates)
    for (PetscInt c = 0; c < n; c++) dst[c] = 0;
  if (traits.src == MPM_ON_PARTICLES) {
    for (PetscInt j = 0; j < ppc; j++)
      AddRow(n, conj(Tie(b, step, op->kind, j)) / b->masses[step], b->particle + (op->src * ppc + j) * n, dst);
  } else {
    double complex stencil = 0;

    for (PetscInt s = -1; s <= 1; s++) stencil += traits.stencil[s + 1] * cexp(I * (beta * s));
    AddRow(n, a * stencil, b->nodes + op->src * n, dst);
  }
}

/* Keeps the product in range. */
static PetscInt Rescale(MpmBloch *b)
{
  const PetscInt n       = b->size * b->size;
  PetscReal      largest = 0;
  PetscInt       shift;

  for (PetscInt i = 0; i < n; i++) largest = PetscMax(largest, cabs(b->particle[i]));
  if (!isnormal(largest) || PetscAbsInt(ilogb(largest)) < RESCALE_AT) return 0;
  shift = ilogb(largest);
  for (PetscInt i = 0; i < n; i++) b->particle[i] *= scalbn(1, -(int)shift);
  return shift;
}

/* Moves every number by up to MPM_ROUNDING, relative; the same at any phase and on any rank. */
static void Disturb(MpmBloch *b, PetscInt step)
{
  for (PetscInt i = 0; i < b->size * b->size; i++) b->particle[i] *= 1 + MPM_ROUNDING * (2 * MpmHash(step, i) - 1);
}

PetscErrorCode MpmBlochMatrix(MpmBloch *b, PetscReal beta, PetscBool noisy, double complex G[], PetscInt *exponent)
{
  const MpmFormulation *f   = b->scene->formulation;
  const PetscInt        ppc = b->scene->ppc, n = b->size;

  PetscFunctionBegin;
  *exponent = 0;
  PetscCall(PetscArrayzero(b->particle, n * n));
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < ppc; j++) b->particle[(field * ppc + j) * n + b->fields * j + field] = 1;
  for (PetscInt step = 0; step < b->period; step++) {
    Shift(b, step, beta);
    for (PetscInt o = 0; o < f->nops; o++) ApplyOp(b, &f->ops[o], step, beta);
    if (noisy) Disturb(b, step);
    *exponent += Rescale(b);
  }
  for (PetscInt field = 0; field < b->fields; field++)
    for (PetscInt j = 0; j < ppc; j++)
      for (PetscInt c = 0; c < n; c++) G[c * n + b->fields * j + field] = b->particle[(field * ppc + j) * n + c];
  PetscFunctionReturn(PETSC_SUCCESS);
}
