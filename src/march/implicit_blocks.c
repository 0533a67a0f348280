/*
   What the preconditioner of an implicit step is made of: M + a M K, of which most preconditioners need the block of
   each node alone.

   The block of nodes i and j is the sum over particles of V E T_cb,ad g_i,cb g_j,ad, with the slopes g_i,cb along b of
   the weight of component c at node i. T is the term of K or, at finite deformation, a particle's tangent.
*/
#include "march/implicit_solve.h"
#include "march/stencils.h"
#include "scheme/maps.h"

/* sum: of the blocks on the diagonal, in local arrays. */
typedef struct {
  MpmStencils at;
  PetscReal  *sum[MPM_MAX_DIM * MPM_MAX_DIM];
} Blocks;

/* The slopes of component c's weights at the i-th nodes. */
static const PetscReal *SlopesOf(const Blocks *b, PetscInt i, PetscInt c)
{
  return b->at.g + (i * b->at.components + PetscMin(c, b->at.components - 1)) * b->at.dim * MPM_STENCILS;
}

/* The parts of nodes i and j, component c of i and a of j. */
static void Part(const MpmImplicitSolve *s, const Blocks *b, PetscInt i, PetscInt j, PetscInt c, PetscInt a,
                 PetscReal part[])
{
  const PetscInt   dim = b->at.dim, n = dim * dim;
  const PetscReal *to = SlopesOf(b, i, c), *from = SlopesOf(b, j, a);

  for (PetscInt q = 0; q < b->at.n; q++) part[q] = 0;
  for (PetscInt x = 0; x < dim; x++)
    for (PetscInt y = 0; y < dim; y++) {
      const PetscReal  term = s->term[c][x][a][y];
      const PetscReal *tangent =
          s->snes ? s->tangent + (n * (a * dim + y) + c * dim + x) * s->room + b->at.begin : NULL;

      if (tangent)
        for (PetscInt q = 0; q < b->at.n; q++)
          part[q] += tangent[q] * to[x * MPM_STENCILS + q] * from[y * MPM_STENCILS + q];
      else if (term != 0)
        for (PetscInt q = 0; q < b->at.n; q++) part[q] += term * to[x * MPM_STENCILS + q] * from[y * MPM_STENCILS + q];
    }
}

/* Adds the parts of a few particles at nodes i and j. */
static PetscErrorCode AddPair(const MpmImplicitSolve *s, const Blocks *b, PetscInt i, PetscInt j,
                              const PetscReal times[])
{
  const PetscInt  dim = b->at.dim, origin = s->march->grid->origin;
  const PetscInt *row = b->at.node + i * MPM_STENCILS, *column = b->at.node + j * MPM_STENCILS;
  PetscReal       part[MPM_MAX_DIM * MPM_MAX_DIM][MPM_STENCILS];

  PetscFunctionBegin;
  for (PetscInt k = 0; k < dim * dim; k++) {
    Part(s, b, i, j, k / dim, k % dim, part[k]);
    for (PetscInt q = 0; q < b->at.n; q++) part[k][q] *= times[q];
    for (PetscInt q = 0; q < b->at.n && !s->whole; q++) b->sum[k][row[q]] += part[k][q];
  }
  for (PetscInt q = 0; q < b->at.n && s->whole; q++) {
    const PetscInt to = row[q] + origin, from = column[q] + origin;
    PetscReal      block[MPM_MAX_DIM * MPM_MAX_DIM];

    for (PetscInt k = 0; k < dim * dim; k++) block[k] = part[k][q];
    PetscCall(MatSetValuesBlockedLocal(s->blocks, 1, &to, 1, &from, block, ADD_VALUES));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

static PetscErrorCode AddParticles(const MpmImplicitSolve *s, Blocks *b)
{
  const MpmStencils *at = &b->at;
  PetscReal          times[MPM_STENCILS];

  PetscFunctionBegin;
  while (MpmStencilsNext(&b->at)) {
    const PetscReal *volume = at->at.weight[MPM_VOLUME], *stiffness = s->snes ? NULL : at->at.weight[MPM_STIFFNESS];

    for (PetscInt q = 0; q < at->n; q++)
      times[q] = s->a * (volume ? volume[at->begin + q] : 1) * (stiffness ? stiffness[at->begin + q] : 1);
    for (PetscInt i = 0; i < at->nodes; i++)
      for (PetscInt j = s->whole ? 0 : i; j < (s->whole ? at->nodes : i + 1); j++)
        PetscCall(AddPair(s, b, i, j, times));
  }
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* Adds to the block of each node of this rank its mass, 1 where there is none, and the sums of the diagonal. */
static PetscErrorCode AddNodes(const MpmImplicitSolve *s, const Blocks *b)
{
  const MpmGrid   *grid = s->march->grid;
  const MpmGridBox box  = MpmGridBoxOf(grid, 0);
  const PetscInt   dim  = grid->dim;
  PetscInt         row;

  PetscFunctionBegin;
  PetscCall(MatGetOwnershipRange(s->blocks, &row, NULL));
  row /= dim;
  for (PetscInt r = 0; r < MpmGridRows(&box); r++)
    for (PetscInt i = 0; i < box.hi[0]; i++, row++) {
      const PetscInt  node    = MpmGridRow(grid, &box, r) + i;
      const PetscReal inverse = b->at.at.sum[MPM_MASSES][node];
      PetscReal       block[MPM_MAX_DIM * MPM_MAX_DIM];

      for (PetscInt k = 0; k < dim * dim; k++)
        block[k] = (s->whole ? 0 : b->sum[k][node]) + (k % (dim + 1) ? 0 : inverse > 0 ? 1 / inverse : 1);
      PetscCall(MatSetValuesBlocked(s->blocks, 1, &row, 1, &row, block, ADD_VALUES));
    }
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmImplicitBlocksFill(MpmImplicitSolve *s)
{
  const PetscInt dim = s->k->dim, size = MpmGridSize(s->march->grid);
  Blocks         b;
  PetscReal     *sums = NULL;

  PetscFunctionBegin;
  PetscCall(MpmStencilsCreate(s->march, s->step, &b.at));
  b.at.slopes.kind   = s->slope;
  b.at.slopes.parity = s->k->parity + s->k->solved;
  if (!s->whole) PetscCall(PetscCalloc1(dim * dim * size, &sums));
  for (PetscInt k = 0; k < dim * dim && !s->whole; k++) b.sum[k] = sums + k * size + s->march->grid->origin;
  PetscCall(MatZeroEntries(s->blocks));
  PetscCall(AddParticles(s, &b));
  if (!s->whole) PetscCall(MpmGridSum(s->march->grid, dim * dim, b.sum));
  PetscCall(AddNodes(s, &b));
  PetscCall(PetscFree(sums));
  PetscCall(MpmStencilsDestroy(&b.at));
  PetscCall(MatAssemblyBegin(s->blocks, MAT_FINAL_ASSEMBLY));
  PetscCall(MatAssemblyEnd(s->blocks, MAT_FINAL_ASSEMBLY));
  PetscFunctionReturn(PETSC_SUCCESS);
}

/* ---- set-up ---- */

/* The terms of K: a gather to scratch, and each sum of that scratch. */
static void FindTerms(MpmImplicitSolve *s)
{
  const MpmTable *k = s->k;

  for (const MpmOp *grad = k->ops; grad < k->ops + k->nops; grad++) {
    const MpmOpTraits to = MpmOpTraitsOf(grad->kind);

    if (to.src != MPM_ON_NODES || to.dst != MPM_ON_PARTICLES) continue;
    s->slope = grad->kind;
    for (const MpmOp *div = grad + 1; div < k->ops + k->nops; div++) {
      const MpmOpTraits from = MpmOpTraitsOf(div->kind);

      if (from.src == MPM_ON_PARTICLES && from.dst == MPM_ON_NODES && div->src == grad->dst)
        s->term[div->dst - k->image][div->axis][grad->src - k->solved][grad->axis] += div->factor * grad->factor;
    }
  }
}

PetscErrorCode MpmImplicitBlocksCreate(MpmImplicitSolve *s)
{
  const PetscInt         dim = s->march->layout->dim, own = MpmGridNodes(s->march->grid);
  const PetscInt         reach = MpmMapReach(s->march->scheme->basis);
  PetscInt               width = 1, all;
  ISLocalToGlobalMapping nodes, map;
  const PetscInt        *index;
  PetscInt               n;

  PetscFunctionBegin;
  FindTerms(s);
  for (PetscInt a = 0; a < dim && s->whole; a++) width *= 2 * reach - 1;
  all   = MpmLayoutNodes(s->march->layout);
  width = PetscMin(width, all);
  PetscCall(MatCreate(PetscObjectComm((PetscObject)s->march->grid->da), &s->blocks));
  PetscCall(MatSetSizes(s->blocks, dim * own, dim * own, PETSC_DETERMINE, PETSC_DETERMINE));
  PetscCall(MatSetBlockSize(s->blocks, dim));
  PetscCall(MatSetType(s->blocks, s->whole ? MATAIJ : MATBAIJ));
  PetscCall(MatXAIJSetPreallocation(s->blocks, dim, NULL, NULL, NULL, NULL));
  PetscCall(MatSeqAIJSetPreallocation(s->blocks, dim * width, NULL));
  PetscCall(MatMPIAIJSetPreallocation(s->blocks, dim * width, NULL, s->whole ? dim * width : 0, NULL));
  PetscCall(MatSeqBAIJSetPreallocation(s->blocks, dim, width, NULL));
  PetscCall(MatMPIBAIJSetPreallocation(s->blocks, dim, width, NULL, 0, NULL));
  PetscCall(MatSetOption(s->blocks, MAT_NEW_NONZERO_ALLOCATION_ERR, PETSC_FALSE));
  PetscCall(DMGetLocalToGlobalMapping(s->march->grid->da, &nodes));
  PetscCall(ISLocalToGlobalMappingGetSize(nodes, &n));
  PetscCall(ISLocalToGlobalMappingGetIndices(nodes, &index));
  PetscCall(
      ISLocalToGlobalMappingCreate(PetscObjectComm((PetscObject)s->blocks), dim, n, index, PETSC_COPY_VALUES, &map));
  PetscCall(ISLocalToGlobalMappingRestoreIndices(nodes, &index));
  PetscCall(MatSetLocalToGlobalMapping(s->blocks, map, map));
  PetscCall(ISLocalToGlobalMappingDestroy(&map));
  PetscFunctionReturn(PETSC_SUCCESS);
}
