/*
   The nodes and slopes of particles: products over the directions of phi and of its slope, or what is left of them near
   walls.
*/
#include "march/stencils.h"
#include "scheme/kernels.h"
#include "scheme/maps.h"

/*
   The weights of a particle along a direction: phi (0) and its slope (1), the places of its nodes and each component's
   sign.
*/
typedef struct {
  PetscInt  place[MPM_MAX_REACH], number[MPM_MAX_REACH]; /* in a local array; in the grid */
  PetscReal weight[2][MPM_MAX_REACH], sign[MPM_MAX_DIM][MPM_MAX_REACH];
  PetscBool twice; /* a node may be there twice */
} Along;

/* The most nodes that SlopesAt finds. */
static PetscInt SlopesMost(const MpmSlopes *s)
{
  PetscInt n = 1;

  for (PetscInt a = 0; a < s->layout->dim; a++) n *= MpmMapReach(s->basis);
  return n;
}

static PetscBool IsFixed(const MpmDirection *direction, PetscInt node, MpmParity parity)
{
  return (node == 0 && (MpmEndImposes(direction->ends[0], parity) || direction->ends[0] == MPM_FIXED_REACTION)) ||
                 (node == direction->nodes - 1 &&
                  (MpmEndImposes(direction->ends[1], parity) || direction->ends[1] == MPM_FIXED_REACTION))
             ? PETSC_TRUE
             : PETSC_FALSE;
}

PetscBool MpmSlopesFix(const MpmSlopes *s, PetscInt component, const PetscInt at[])
{
  for (PetscInt a = 0; a < s->layout->dim; a++)
    if (!s->grid->axis[a].periodic && IsFixed(&s->layout->grid[a], at[a], s->parity[component][a])) return PETSC_TRUE;
  return PETSC_FALSE;
}

static void RowAlong(const MpmSlopes *s, PetscInt a, PetscInt cell, PetscReal xi, Along *along)
{
  const MpmGridAxis  *axis = &s->grid->axis[a];
  const MpmDirection *grid = &s->layout->grid[a];
  PetscInt            wall[2];

  MpmDirectionWalls(grid, axis->first + cell, wall);
  MpmMapRow(s->basis, MPM_P2G, xi, s->layout->half_width[a], wall, along->weight[0]);
  MpmMapRow(s->basis, s->kind, xi, s->layout->half_width[a], wall, along->weight[1]);
  along->twice = axis->periodic && axis->cells < MpmMapReach(s->basis) ? PETSC_TRUE : PETSC_FALSE;
  for (PetscInt d = 0; d < MpmMapReach(s->basis); d++) {
    const PetscInt node = cell - s->basis->reach_left + d;
    PetscReal      sign;

    along->number[d] = MpmDirectionImage(grid, axis->first + node, MPM_EVEN, &sign);
    along->place[d]  = (axis->periodic ? node : along->number[d] - axis->first) * axis->stride;
    if (!axis->periodic && along->number[d] != axis->first + node) along->twice = PETSC_TRUE;
    for (PetscInt c = 0; c < s->layout->dim; c++) {
      along->sign[c][d] = 1;
      if (axis->periodic) continue;
      (void)MpmDirectionImage(grid, axis->first + node, s->parity[c][a], &along->sign[c][d]);
      if (IsFixed(grid, along->number[d], s->parity[c][a])) along->sign[c][d] = 0;
    }
  }
}

/* Adds up what a node has twice. number: of the nodes in the grid. */
static PetscInt Merge(PetscInt components, PetscInt n, const PetscInt number[], PetscInt node[], PetscReal shape[],
                      PetscReal slope[])
{
  PetscInt kept = 0, of[MPM_MAX_REACH * MPM_MAX_REACH * MPM_MAX_REACH];

  for (PetscInt i = 0; i < n; i++) {
    PetscInt j = 0;

    while (j < kept && number[of[j]] != number[i]) j++;
    if (j == kept) {
      of[kept++] = i;
      node[j]    = node[i];
      shape[j]   = shape[i];
      for (PetscInt c = 0; c < components; c++) slope[j * components + c] = slope[i * components + c];
      continue;
    }
    shape[j] += shape[i];
    for (PetscInt c = 0; c < components; c++) slope[j * components + c] += slope[i * components + c];
  }
  return kept;
}

/*
   The nodes of a particle in a local cell of the grid, at xi there. Returns how many there are. With merge none is there
   twice: two of a particle's nodes may be one and the same, at a wall or in a short periodic grid.

   Output Parameters:
+  node  - indices in a local array, from its node 0
.  shape - phi of each node
-  slope - slope[(node dim + component) dim + direction], in units of 1 / h
*/
static PetscInt SlopesAt(const MpmSlopes *s, PetscBool merge, const PetscInt cell[], const PetscReal xi[],
                         PetscInt node[], PetscReal shape[], PetscReal slope[])
{
  const PetscInt dim = s->layout->dim, reach = MpmMapReach(s->basis), n = SlopesMost(s);
  PetscInt       number[MPM_MAX_REACH * MPM_MAX_REACH * MPM_MAX_REACH];
  Along          along[MPM_MAX_DIM];
  PetscBool      twice = PETSC_FALSE;

  for (PetscInt a = 0; a < dim; a++) {
    RowAlong(s, a, cell[a], xi[a], &along[a]);
    if (along[a].twice) twice = merge;
  }
  for (PetscInt i = 0; i < n; i++) {
    PetscReal value[MPM_MAX_DIM] = {1, 1, 1}, sign[MPM_MAX_DIM] = {1, 1, 1};
    PetscInt  stride = 1;

    node[i] = number[i] = 0;
    shape[i]            = 1;
    for (PetscInt a = 0, rest = i; a < dim; a++, rest /= reach) {
      const PetscInt d = rest % reach;

      node[i] += along[a].place[d];
      number[i] += stride * along[a].number[d];
      stride *= s->layout->grid[a].nodes;
      shape[i] *= along[a].weight[0][d];
      for (PetscInt b = 0; b < dim; b++) {
        value[b] *= along[a].weight[a == b][d];
        sign[b] *= along[a].sign[b][d];
      }
    }
    for (PetscInt c = 0; c < dim; c++)
      for (PetscInt b = 0; b < dim; b++) slope[(i * dim + c) * dim + b] = sign[c] * value[b];
  }
  return twice ? Merge(dim * dim, n, number, node, shape, slope) : n;
}

/* ---- several particles at a time ---- */

static const MpmParity vectors[MPM_MAX_DIM][MPM_MAX_DIM] = {{MPM_NORMAL, MPM_TANGENTIAL, MPM_TANGENTIAL},
                                                            {MPM_TANGENTIAL, MPM_NORMAL, MPM_TANGENTIAL},
                                                            {MPM_TANGENTIAL, MPM_TANGENTIAL, MPM_NORMAL}};

/* Whether a particle's nodes, and those of its nodes' other particles, are away from walls and none is there twice. */
static PetscBool IsInside(const MpmStencils *s, PetscInt p)
{
  const PetscInt reach = MpmMapReach(s->slopes.basis);

  for (PetscInt a = 0; a < s->dim; a++) {
    const MpmGridAxis *axis = &s->march->grid->axis[a];
    const PetscInt     cell = axis->first + s->at.cell[a][p] + s->at.whole[0][a];

    if (axis->periodic ? axis->cells < reach : cell < 2 * reach || cell >= axis->cells - 2 * reach) return PETSC_FALSE;
  }
  return PETSC_TRUE;
}

/*
   Of particles inside, one direction after another: nodes d further along one have the products so far times its
   weights.
*/
static inline __attribute__((always_inline)) void FillInside(const PetscInt dim, MpmStencils *s,
                                                             PetscInt in[][MPM_STENCILS], PetscReal at[][MPM_STENCILS])
{
  const MpmBasis *basis = s->slopes.basis;
  PetscReal       weight[2][MPM_MOST_NODES * MPM_STENCILS];
  MpmBlock        block;

  s->nodes = s->components = 1;
  for (PetscInt q = 0; q < MPM_STENCILS; q++) {
    s->node[q] = 0;
    s->S[q]    = 1;
    for (PetscInt b = 0; b < dim; b++) s->g[b * MPM_STENCILS + q] = 1;
  }
  for (PetscInt a = 0; a < dim; a++, s->nodes *= basis->nodes) {
    for (PetscInt q = s->n; q < MPM_STENCILS; q++) {
      in[a][q] = in[a][0];
      at[a][q] = at[a][0];
    }
    MpmBlockPlace(basis, MPM_STENCILS, in[a], at[a], s->march->layout->half_width[a], MpmNoWalls, &block);
    basis->weights[MPM_P2G](&block, MPM_STENCILS, weight[0]);
    basis->weights[s->slopes.kind](&block, MPM_STENCILS, weight[1]);
    for (PetscInt d = basis->nodes - 1; d >= 0; d--) /* the first nodes are read last */
      for (PetscInt i = 0; i < s->nodes; i++) {
        const PetscInt to = (d * s->nodes + i) * MPM_STENCILS, from = i * MPM_STENCILS,
                       stride = s->march->grid->axis[a].stride;
        const PetscReal *phi = weight[0] + d * MPM_STENCILS, *slope = weight[1] + d * MPM_STENCILS;
        PetscReal       *S = s->S, *g = s->g;
        PetscInt        *node = s->node;

#pragma omp simd
        for (PetscInt q = 0; q < MPM_STENCILS; q++) {
          node[to + q] = node[from + q] + (block.first[q] + d) * stride;
          S[to + q]    = S[from + q] * phi[q];
        }
        for (PetscInt b = 0; b < dim; b++) {
          const PetscReal *times = b == a ? slope : phi;
          const PetscInt   at_b  = b * MPM_STENCILS;

#pragma omp simd
          for (PetscInt q = 0; q < MPM_STENCILS; q++) g[dim * to + at_b + q] = g[dim * from + at_b + q] * times[q];
        }
      }
  }
}

/* Near walls, particle by particle. Where one has fewer nodes the rest have weight 0. */
static void FillAtWall(MpmStencils *s, PetscInt in[][MPM_STENCILS], PetscReal at[][MPM_STENCILS])
{
  const PetscInt most = SlopesMost(&s->slopes), each = s->dim * s->dim;
  PetscInt       node[MPM_MAX_REACH * MPM_MAX_REACH * MPM_MAX_REACH];
  PetscReal     *shape = s->memory, *slope = s->memory + most;

  s->nodes      = most;
  s->components = s->dim;
  for (PetscInt q = 0; q < MPM_STENCILS; q++) {
    PetscInt  cell[MPM_MAX_DIM], n = 0;
    PetscReal xi[MPM_MAX_DIM];

    for (PetscInt a = 0; a < s->dim; a++) {
      cell[a] = in[a][q];
      xi[a]   = at[a][q];
    }
    if (q < s->n) n = SlopesAt(&s->slopes, PETSC_TRUE, cell, xi, node, shape, slope);
    for (PetscInt i = 0; i < most; i++) {
      s->S[i * MPM_STENCILS + q]    = i < n ? shape[i] : 0;
      s->node[i * MPM_STENCILS + q] = i < n ? node[i] : node[0];
      for (PetscInt k = 0; k < each; k++) s->g[(i * each + k) * MPM_STENCILS + q] = i < n ? slope[i * each + k] : 0;
    }
  }
}

PetscBool MpmStencilsNext(MpmStencils *s)
{
  const PetscInt count = s->march->particles->count;
  PetscInt       in[MPM_MAX_DIM][MPM_STENCILS];
  PetscReal      at[MPM_MAX_DIM][MPM_STENCILS];

  s->begin += s->n;
  s->n = 0;
  if (s->begin == count) {
    s->begin = 0;
    return PETSC_FALSE;
  }
  s->inside = s->all || IsInside(s, s->begin) ? PETSC_TRUE : PETSC_FALSE;
  s->n      = s->all ? PetscMin(MPM_STENCILS, count - s->begin) : 0;
  while (!s->all && s->n < MPM_STENCILS && s->begin + s->n < count && IsInside(s, s->begin + s->n) == s->inside) s->n++;
  for (PetscInt a = 0; a < s->dim; a++)
    MpmMarchPlaces(&s->at, a, s->n, s->at.cell[a] + s->begin, s->at.xi[a] + s->begin, 0, in[a], at[a]);
  if (s->inside)
    s->dim == 1 ? FillInside(1, s, in, at) : s->dim == 2 ? FillInside(2, s, in, at) : FillInside(3, s, in, at);
  else
    FillAtWall(s, in, at);
  return PETSC_TRUE;
}

PetscErrorCode MpmStencilsCreate(MpmMarch *march, PetscInt64 step, MpmStencils *s)
{
  PetscInt most;

  PetscFunctionBegin;
  *s     = (MpmStencils){.march  = march,
                         .at     = {.march = march},
                         .dim    = march->layout->dim,
                         .slopes = {.layout = march->layout,
                                    .basis  = march->scheme->basis,
                                    .grid   = march->grid,
                                    .kind   = march->scheme->space.gradient == MPM_GRADIENT_MLS ? MPM_DIV_MLS : MPM_DIV,
                                    .parity = vectors}};
  s->all = MpmLayoutIsPeriodic(march->layout);
  for (PetscInt a = 0; a < s->dim; a++)
    if (march->grid->axis[a].cells < MpmMapReach(s->slopes.basis)) s->all = PETSC_FALSE;
  most = SlopesMost(&s->slopes);
  PetscCall(PetscMalloc4(MPM_STENCILS * most, &s->node, MPM_STENCILS * most, &s->S,
                         MPM_STENCILS * most * s->dim * s->dim, &s->g, (1 + s->dim * s->dim) * most, &s->memory));
  PetscCall(MpmMarchGetArrays(march, step, &s->at));
  PetscFunctionReturn(PETSC_SUCCESS);
}

PetscErrorCode MpmStencilsDestroy(MpmStencils *s)
{
  PetscFunctionBegin;
  PetscCall(MpmMarchRestoreArrays(s->march, &s->at));
  PetscCall(PetscFree4(s->node, s->S, s->g, s->memory));
  PetscFunctionReturn(PETSC_SUCCESS);
}
