/*
   IMPLICIT of one Bloch mode: the vector of a node becomes (1 + a K)^-1 times it, K a matrix of dim x dim at each phase.

     K_ca = the sum over GRAD of component a to a stress, and DIV of this stress to component c, of their symbols' product
*/
#include "linalg/lapack_names.h"
#include "symbol/bloch.h"

#define ZGESV MPM_LAPACK(zgesv, ZGESV)

extern void ZGESV(const PetscBLASInt *n, const PetscBLASInt *nrhs, double complex *a, const PetscBLASInt *lda,
                  PetscBLASInt *ipiv, double complex *b, const PetscBLASInt *ldb, PetscBLASInt *info);

typedef double complex Small[MPM_MAX_DIM][MPM_MAX_DIM];

static PetscBool IsGather(const MpmOp *op)
{
  const MpmOpTraits traits = MpmOpTraitsOf(op->kind);

  return traits.src == MPM_ON_NODES && traits.dst == MPM_ON_PARTICLES ? PETSC_TRUE : PETSC_FALSE;
}

/* The lines of a table of K are gathers to scratch, and then sums of scratch. */
static void Stiffness(const MpmBloch *b, const MpmTable *k, Small K)
{
  for (PetscInt c = 0; c < k->dim; c++)
    for (PetscInt a = 0; a < k->dim; a++) K[c][a] = 0;
  for (const MpmOp *grad = k->ops; grad < k->ops + k->nops; grad++)
    for (const MpmOp *div = grad + 1; div < k->ops + k->nops && IsGather(grad); div++) {
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
  ZGESV(&order, &order, A[0], &rows, pivot, inverse[0], &rows, &info);
}

void MpmBlochImplicit(MpmBloch *b, const MpmOp *op, const PetscReal a[])
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
