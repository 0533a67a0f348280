/*
   The algebra of plans on small dense matrices. A slot is, for each image and each power of the Courant number, a
   multiple of the identity plus a matrix. In most plans every map meets a multiple of the identity, and no product of
   matrices is made.
*/
#include "linalg/lapack_names.h"
#include "operator/nodal.h"

#define ZGEMM MPM_LAPACK(zgemm, ZGEMM)

extern void ZGEMM(const char *transa, const char *transb, const PetscBLASInt *m, const PetscBLASInt *n,
                  const PetscBLASInt *k, const double complex *alpha, const double complex *a, const PetscBLASInt *lda,
                  const double complex *b, const PetscBLASInt *ldb, const double complex *beta, double complex *c,
                  const PetscBLASInt *ldc);

typedef struct {
  PetscReal       multiple;
  double complex *matrix; /* NULL: 0 */
} Block;

typedef struct {
  const MpmNodalPlan *plan;
  PetscInt            nodes, powers; /* the number of powers, 0 and up */
  double complex     *map;           /* of all maps, one after another */
  Block              *block;
} Run;

static Block *BlockOf(const Run *r, PetscInt slot, PetscInt image, PetscInt power)
{
  return &r->block[(slot * r->plan->nimages + image) * r->powers + power];
}

static PetscErrorCode Matrix(const Run *r, Block *b)
{
  PetscFunctionBegin;
  if (!b->matrix) PetscCall(PetscCalloc1(r->nodes * r->nodes, &b->matrix));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static void Add(PetscInt n, PetscReal factor, const double complex src[], double complex dst[])
{
  for (PetscInt i = 0; i < n; i++) dst[i] += factor * src[i];
}

/* dst += factor (map of src) */
static PetscErrorCode AddBlock(const Run *r, const MpmLine *line, const Block *src, Block *dst)
{
  const PetscInt        square = r->nodes * r->nodes;
  const double complex *map = line->key == MPM_NONE ? NULL : r->map + line->key * square, alpha = line->factor, one = 1;
  PetscBLASInt          n;

  PetscFunctionBegin;
  if (!map) {
    dst->multiple += line->factor * src->multiple;
    if (src->matrix) {
      PetscCall(Matrix(r, dst));
      Add(square, line->factor, src->matrix, dst->matrix);
    }
    PetscFunctionReturn(PETSC_SUCCESS);
  }
  if (src->multiple == 0 && !src->matrix) PetscFunctionReturn(PETSC_SUCCESS);
  PetscCall(Matrix(r, dst));
  if (src->multiple != 0) Add(square, line->factor * src->multiple, map, dst->matrix);
  if (src->matrix) {
    PetscCall(PetscBLASIntCast(r->nodes, &n));
    ZGEMM("N", "N", &n, &n, &n, &alpha, map, &n, src->matrix, &n, &one, dst->matrix, &n);
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddLine(void *registers, const MpmLine *line, PetscBool back)
{
  const Run *r = registers;

  PetscFunctionBegin;
  PetscCheck(!back, PETSC_COMM_SELF, PETSC_ERR_SUP, "a program runs backwards on vectors alone");
  for (PetscInt g = 0; g < r->plan->nimages; g++)
    for (PetscInt j = 0; j + line->power < r->powers; j++)
      PetscCall(AddBlock(r, line, BlockOf(r, line->src, g, j), BlockOf(r, line->dst, g, j + line->power)));
  PetscFunctionReturn(PETSC_SUCCESS);
}

static const MpmAlgebra block_algebra = {.add = AddLine};

/* Block (g, h) of what multiplies k^power in the step goes to the coefficient of k^(power + weight[g] - weight[h]). */
static void Gather(const Run *r, PetscInt g, PetscInt h, PetscInt power, double complex *const coefficient[])
{
  const MpmNodalPlan *plan  = r->plan;
  const Block        *b     = BlockOf(r, plan->next[g], h, power);
  const PetscInt      nodes = r->nodes, n = plan->nimages * nodes;
  double complex     *at;

  if (b->multiple == 0 && !b->matrix) return;
  at = coefficient[(power + plan->weight[g] - plan->weight[h]) / plan->stride] + h * nodes * n + g * nodes;
  for (PetscInt c = 0; c < nodes; c++) {
    at[c * n + c] += b->multiple;
    for (PetscInt i = 0; b->matrix && i < nodes; i++) at[c * n + i] += b->matrix[c * nodes + i];
  }
}

/* One more than the largest power in any slot. */
static PetscInt PowersOf(const MpmNodalPlan *plan)
{
  PetscInt powers = 0;

  for (PetscInt i = 0; i < plan->nslots * plan->nimages; i++)
    while (plan->powers[i] >> powers) powers++;
  return powers;
}

PetscErrorCode MpmNodalRun(const MpmNodalPlan *plan, PetscInt nodes, MpmNodalMapMatrix map, void *context,
                           double complex *const coefficient[])
{
  const PetscInt square = nodes * nodes, all = plan->nimages * plan->nimages * square;
  Run            r = {.plan = plan, .nodes = nodes, .powers = PowersOf(plan)};

  PetscFunctionBegin;
  PetscCall(PetscCalloc1(plan->nmaps * square, &r.map));
  for (PetscInt m = 0; m < plan->nmaps; m++) PetscCall(map(context, &plan->map[m], r.map + m * square));
  for (PetscInt j = 0; j <= plan->degree; j++) PetscCall(PetscArrayzero(coefficient[j], all));
  PetscCall(PetscCalloc1(plan->nslots * plan->nimages * r.powers, &r.block));
  for (PetscInt g = 0; g < plan->nimages; g++) BlockOf(&r, g, g, 0)->multiple = 1;
  PetscCall(MpmStepProgramRun(plan->program, &block_algebra, &r, PETSC_FALSE));
  for (PetscInt g = 0; g < plan->nimages; g++)
    for (PetscInt h = 0; h < plan->nimages; h++)
      for (PetscInt j = 0; j < r.powers; j++) Gather(&r, g, h, j, coefficient);
  for (PetscInt i = 0; i < plan->nslots * plan->nimages * r.powers; i++) PetscCall(PetscFree(r.block[i].matrix));
  PetscCall(PetscFree(r.block));
  PetscCall(PetscFree(r.map));
  PetscFunctionReturn(PETSC_SUCCESS);
}
